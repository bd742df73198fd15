"""Which tests run which lines: worked out once for every test file, and kept until it or the packages change."""

from __future__ import annotations

import ast
import gzip
import hashlib
import json
import re
import sys
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import Any, Final

import pytest

from mutants.bug import Bug
from mutants.scratch_tree import ScratchTree
from mutants.watched_session import OPTIONS, Watched, child, load_ours

PACKAGES: Final = ("prompts", "scene_graphs", "motion_backend", "planner_service")
APART: Final = ("tests/web/", "tests/mutants/")
"""Tests of the page and of this command. (Files at the top of tests/ are about the tree, not about what it does.)"""
FILE_SECONDS: Final = 400.0
"""Processor time that the tests of one file may take while they are watched."""

KERNEL: Final = "scene_graphs/graph/branch_and_bound_kernel.py"
OF_KERNEL: Final = tuple(
    f"tests/scene_graphs/{name}.py" for name in ("graph/test_edit_distance", "retrieval/test_layout_index")
)
"""What sees its bugs."""
JIT: Final = "from scene_graphs.jit import"
RECORDED: Final = "/test_recorded_"
"""Files whose tests see most."""
UNCOMPILED: Final = 10.0
"""Times as long a test takes."""
IMPORTED: Final = re.compile(r"^\s*(?:from|import) (\w+)", re.MULTILINE)
CTRACE: Final = {"COVERAGE_CORE": "ctrace"}
"""The tracer that can tell tests apart."""


@dataclass(frozen=True)
class TimedTest:
    """One test of one file."""

    name: str
    """pytest's node id."""
    file: str
    seconds: float


@dataclass(frozen=True)
class Watching:
    """What one test file runs."""

    file: str
    imports: float
    """Seconds until its tests are collected."""
    tests: dict[str, float]
    """Seconds of each test that passes."""
    lines: dict[str, dict[str, list[int]]]
    """Per test, and for `Watched.IMPORTS`: lines of each module."""

    @property
    def seconds(self) -> float:
        """Of all tests."""
        return self.imports + sum(self.tests.values())

    def runs(self, context: str, bug: Bug) -> bool:
        """Whether a test, or the imports, run a line of a bug."""
        return any(bug.first <= line <= bug.last for line in self.lines.get(context, {}).get(bug.path, ()))


def test_files(root: Path) -> list[str]:
    """Of the quick layer."""
    found = (path.relative_to(root).as_posix() for path in (root / "tests").glob("*/**/test_*.py"))
    return sorted(name for name in found if not name.startswith(APART))


def watch(root: Path, kept: Path, trees: list[ScratchTree]) -> list[Watching]:
    """All test files; anew those that changed, or whose helpers or modules did. `trees` work side by side."""
    kept.mkdir(parents=True, exist_ok=True)
    names = test_files(root)
    missing = [name for name in names if not _is_fresh(root, _place(kept, name))]
    if missing:
        print(f"· watching which lines {len(missing)} of {len(names)} test files run", file=sys.stderr)
    shares = [missing[start :: len(trees)] for start in range(len(trees))]
    with ThreadPoolExecutor(len(trees)) as pool:
        list(pool.map(lambda tree, share: _look(tree, share, kept), trees, shares))
    return [_read(name, _place(kept, name)) for name in names]


def _place(kept: Path, name: str) -> Path:
    return kept / (name.removesuffix(".py").replace("/", ".") + ".json.gz")


def _is_fresh(root: Path, path: Path) -> bool:
    if not path.exists():
        return False
    digests: dict[str, str] = json.loads(gzip.decompress(path.read_bytes()))["digests"]
    return all((root / name).exists() and _digest(root / name) == digest for name, digest in digests.items())


def helpers(root: Path, name: str) -> set[str]:
    """A test file, and the modules beside tests that it imports, and that those import."""
    known = {path.stem: path for path in (root / "tests").rglob("*.py") if not path.name.startswith("test_")}
    found, ahead = {name}, [root / name]
    while ahead:
        for word in IMPORTED.findall(ahead.pop().read_text(encoding="utf-8")):
            if word in known and (helper := known[word].relative_to(root).as_posix()) not in found:
                found.add(helper)
                ahead.append(known[word])
    return found


def _look(tree: ScratchTree, names: list[str], kept: Path) -> None:
    """Every file in a process of its own, forked from one that has imported the packages."""
    if not names:
        return

    def each() -> int:
        load_ours()
        # What is compiled at the first use would count as the time of the test that comes first.
        child(tree.folder, _compiled, tree.out, FILE_SECONDS, {})
        for name in names:
            code = child(tree.folder, partial(_watched, tree, name, _place(kept, name)), tree.out, FILE_SECONDS, CTRACE)
            if code:
                print(f"{name} cannot be watched (exit code {code}); see {tree.out}", file=sys.stderr)
                return 1
        return 0

    if child(tree.folder, each, tree.out.with_suffix(".each"), FILE_SECONDS * (1 + len(names)), {}):
        raise RuntimeError(tree.out.with_suffix(".each").read_text(encoding="utf-8"))


def _compiled() -> int:
    import install

    exec(install.COMPILE)
    return 0


def _watched(tree: ScratchTree, name: str, to: Path) -> int:
    watched = Watched(tree.folder, PACKAGES)
    pytest.main([*OPTIONS, name], plugins=[watched])
    lines = watched.lines()
    modules = helpers(tree.folder, name) | {module for ran in lines.values() for module in ran}
    digests = {module: _digest(tree.folder / module) for module in sorted(modules)}
    found = {"seconds": watched.seconds, "bad": sorted(watched.bad), "lines": lines, "digests": digests}
    part = to.with_suffix(".part")
    part.write_bytes(gzip.compress(json.dumps(found).encode(), 3))
    part.rename(to)
    return 0


def _read(name: str, path: Path) -> Watching:
    found: dict[str, Any] = json.loads(gzip.decompress(path.read_bytes()))
    seconds, bad = dict(found["seconds"]), set(found["bad"])
    imports = seconds.pop(Watched.IMPORTS, 0.0)
    return Watching(name, imports, {test: s for test, s in seconds.items() if test not in bad}, found["lines"])


@cache
def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


class Selection:
    """The tests to try on each bug."""

    def __init__(self, root: Path, watchings: Iterable[Watching], seconds: float) -> None:
        self._root, self._watchings, self._most = root, list(watchings), seconds
        self._readers = cache(self._lines_that_read)

    def tests(self, bug: Bug) -> list[TimedTest]:
        """Those that compare with what was recorded, those of files that mirror the module, then others that run its
        line, then the rest of their files.

        Of a file all tests are tried, since what it makes once and keeps is seen to run in the first of them alone.
        Quick files go first, and what comes after `seconds` is left out.
        """
        if is_compiled(self._root, bug.path):
            ranked = [(one, list(one.tests)) for one in self._watchings if _sees_compiled(one.file, bug.path)]
            chosen = self._within(sorted(ranked, key=lambda one: one[0].seconds))
            return [replace(one, seconds=UNCOMPILED * one.seconds) for one in chosen if "compile" not in one.name]
        shown = [bug] if not bug.names else list(self._readers(bug.path, bug.names)) or [bug]
        near, direct, rest = [], [], []
        readers = self._tests_that_read(bug)
        for watching in sorted(self._watchings, key=lambda one: (RECORDED not in one.file, one.seconds)):
            first = [test for test in watching.tests if any(watching.runs(test, one) for one in shown)]
            imports = bug in shown and watching.runs(Watched.IMPORTS, bug)
            if first or imports or watching.file in readers:
                others = [test for test in watching.tests if test not in set(first)]
                if RECORDED in watching.file or _mirrors(watching.file, bug.path) or watching.file in readers:
                    near.append((watching, [*first, *others]))
                else:
                    direct.append((watching, first))
                    rest.append((watching, others))
        return self._within([*near, *direct, *rest])

    def _within(self, ranked: list[tuple[Watching, list[str]]]) -> list[TimedTest]:
        chosen: list[TimedTest] = []
        spent, files = 0.0, set()
        for watching, tests in ranked:
            for test in tests:
                seconds = watching.tests[test] + (0.0 if watching.file in files else watching.imports)
                if not chosen or spent + seconds <= self._most:
                    chosen.append(TimedTest(test, watching.file, seconds))
                    files.add(watching.file)
                    spent += seconds
        return chosen

    def _lines_that_read(self, path: str, names: tuple[str, ...]) -> list[Bug]:
        """Inside functions of its package and of those above it: where names of a module are read, as bugs there."""
        found = []
        of_module = (self._root / path).read_text(encoding="utf-8")
        names = _passed_on(of_module, names)
        for package in PACKAGES[PACKAGES.index(path.split("/")[0]) :]:
            for module in sorted((self._root / package).rglob("*.py")):
                here = module.relative_to(self._root).as_posix()
                text = of_module if here == path else module.read_text(encoding="utf-8")
                if here == path or any(name in text for name in names):
                    found += [Bug(here, 0, 0, "", line, line, "") for line in _readers(text, names)]
        return found

    def _tests_that_read(self, bug: Bug) -> set[str]:
        """Test files that import a name of its module which the bug gives another value."""
        module = bug.path.removesuffix(".py").replace("/", ".")
        named = re.compile(rf"from {re.escape(module)} import [^=]*?\b(?:{'|'.join(map(re.escape, bug.names))})\b")
        files = (watching.file for watching in self._watchings)
        return {file for file in files if bug.names and named.search((self._root / file).read_text(encoding="utf-8"))}


def _sees_compiled(test: str, module: str) -> bool:
    return test in OF_KERNEL if module == KERNEL else _mirrors(test, module)


@cache
def is_compiled(root: Path, path: str) -> bool:
    """Whether a module is compiled when it is called: no watching sees its lines, and its bugs are tried uncompiled."""
    return JIT in (root / path).read_text(encoding="utf-8")


def _mirrors(test: str, module: str) -> bool:
    """Whether a test file stands where a module does."""
    return Path(test).parent == Path("tests") / Path(module).parent


def _passed_on(text: str, names: tuple[str, ...]) -> tuple[str, ...]:
    """Names of a module, and those that are made of them outside all functions."""
    found = set(names)
    for node in ast.parse(text).body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            read = {one.id for one in ast.walk(node.value) if isinstance(one, ast.Name)}
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            if read & found:
                found |= {one.id for target in targets for one in ast.walk(target) if isinstance(one, ast.Name)}
    return tuple(sorted(found))


def _readers(text: str, names: tuple[str, ...]) -> set[int]:
    """Lines inside functions that read one of some names."""
    functions = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]
    lines: set[int] = set()
    for function in functions:
        first = function.body[0].lineno
        for node in ast.walk(function):
            if (isinstance(node, ast.Name) and node.id in names) or (
                isinstance(node, ast.Attribute) and node.attr in names
            ):
                # What is read for an argument that is not given counts wherever the function is called.
                whole = range(first, (function.end_lineno or first) + 1)
                lines |= {node.lineno} if node.lineno >= first else set(whole)
    return lines
