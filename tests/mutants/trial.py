"""Whether the tests see a bug."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import pytest

from mutants.bug import Bug
from mutants.coverage_map import Selection, TimedTest, is_compiled
from mutants.scratch_tree import ScratchTree
from mutants.watched_session import OPTIONS, Chosen, child

PATIENCE: Final = 4.0
"""A bug under which tests take so many times as long does not end: it is seen."""
LEAST: Final = 20.0
"""Seconds that tests may take at least: the packages are imported anew."""


@dataclass(frozen=True)
class Verdict:
    """What became of one bug."""

    bug: Bug
    seen: bool
    by: str
    """The first test that fails, or why there is none."""


def attempt(bug: Bug, tree: ScratchTree, selection: Selection) -> Verdict:
    """Run the tests that a bug may be seen by, until one fails."""
    tests = selection.tests(bug)
    if not tests:
        return Verdict(bug, False, "no test of the quick layer runs it")
    with tree.with_bug(bug):
        code, failed = _run(tree, tests, uncompiled=is_compiled(tree.folder, bug.path))
    if code == 124:
        return Verdict(bug, True, "(it does not end)")
    if code not in (0, 1, 2):
        return Verdict(bug, True, failed or f"(pytest ends with {code})")
    return Verdict(bug, code != 0, failed or f"{len(tests)} tests pass")


def _run(tree: ScratchTree, tests: list[TimedTest], uncompiled: bool) -> tuple[int, str]:
    note = tree.out.with_suffix(".failed")
    note.unlink(missing_ok=True)
    files = list(dict.fromkeys(test.file for test in tests))
    by_file = [test.name for file in files for test in tests if test.file == file]

    def work() -> int:
        if uncompiled:
            import numba

            vars(numba.config)["DISABLE_JIT"] = True
        chosen = Chosen(by_file)
        code = pytest.main([*OPTIONS, "-x", *files], plugins=[chosen])
        note.write_text(chosen.failed, encoding="utf-8")
        return int(code)

    usual = sum(test.seconds for test in tests)
    code = child(tree.folder, work, tree.out, LEAST + PATIENCE * usual, {})
    return code, note.read_text(encoding="utf-8") if note.exists() else ""


def line_of(bug: Bug, root: Path) -> int:
    """Where a bug stands."""
    return (root / bug.path).read_text(encoding="utf-8").count("\n", 0, bug.start) + 1
