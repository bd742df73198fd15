"""The guide to rooms does what it says: its blocks are run in order in an empty folder, their output compared."""

from __future__ import annotations

import contextlib
import io
import os
from pathlib import Path

import pytest
from forking import Forked
from guides import BLOCK, said_as, typed

pytestmark = pytest.mark.service
GUIDE = Path(__file__).resolve().parents[3] / "docs" / "rooms.md"


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
            for words, shown in typed(block) if kind == "console" else ():
                assert words[0] == "sims"
                code, out, error = forked.run(words[1:], tmp_path, environment)
                assert code == 0, error.decode()
                said_as(shown, out.decode())
    assert {*met} == {"python", "text", "json", "console"}
