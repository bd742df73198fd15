"""The guide to rooms does what it says: its blocks are run in order in an empty folder, their output compared."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest
from forking import Forked

GUIDE = Path(__file__).resolve().parents[2] / "docs" / "rooms.md"
BLOCK = re.compile(r"^```(\w+) ?([\w.]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def as_pattern(shown: list[str]) -> str:
    """A line of … stands for any lines, … within a line for anything on it."""
    return "".join(
        "(?:.*\n)*?" if line.strip() == "…" else ".*".join(map(re.escape, line.rstrip().split("…"))) + "\n"
        for line in shown
    )


def said_as(shown: list[str], printed: str) -> None:
    bare = "".join(f"{line.rstrip()}\n" for line in printed.splitlines())
    assert re.fullmatch(as_pattern(shown), bare), "shown:\n" + "\n".join(shown) + f"\nprinted:\n{bare}"


def commands(block: str) -> Iterator[tuple[list[str], list[str]]]:
    """The words of each command of a block after `sims`, and the lines shown for it."""
    for one in re.split(r"^\$ sims ", block, flags=re.MULTILINE)[1:]:
        command, *shown = one.splitlines()
        yield shlex.split(command), shown


def test_the_guide_to_rooms_is_true(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    outside = {name: value for name, value in os.environ.items() if not name.startswith(("SIMS_", "COLUMNS"))}
    environment = outside | {"SIMS_DATA_DIR": str(tmp_path / "data")}
    names: dict[str, object] = {}
    printed, met = "", []
    with Forked() as forked:
        for kind, file, block in BLOCK.findall(GUIDE.read_text(encoding="utf-8")):
            met.append(kind)
            if kind == "json":
                (tmp_path / file).write_text(block)
            elif kind == "python":
                with contextlib.redirect_stdout(io.StringIO()) as stream:
                    exec(compile(block, GUIDE.name, "exec"), names)
                printed = stream.getvalue()
            elif kind == "text":
                said_as(block.splitlines(), printed)
            for words, shown in commands(block) if kind == "console" else ():
                code, out, error = forked.run(words, tmp_path, environment)
                assert code == 0, error.decode()
                said_as(shown, out.decode())
    assert {*met} == {"python", "text", "json", "console"}
