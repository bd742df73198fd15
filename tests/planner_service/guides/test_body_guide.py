"""The guide to the body does what it says: its blocks are run in order in an empty folder, their output compared."""

from __future__ import annotations

import contextlib
import io
import os
from pathlib import Path

import pytest
from guides import BLOCK, said_as, typed
from typer.testing import CliRunner

from planner_service.cli import app

GUIDE = Path(__file__).resolve().parents[3] / "docs" / "body.md"


@pytest.mark.sweep
def test_the_guide_to_the_body_is_true(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in os.environ if name.startswith(("SIMS_", "COLUMNS"))]:
        monkeypatch.delenv(name)
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    printed, met = "", []
    for kind, _, block in BLOCK.findall(GUIDE.read_text(encoding="utf-8")):
        met.append(kind)
        if kind == "python":
            with contextlib.redirect_stdout(io.StringIO()) as stream:
                exec(compile(block, GUIDE.name, "exec"), names)
            printed = stream.getvalue()
        elif kind == "text":
            said_as(block.splitlines(), printed)
        for words, shown in typed(block) if kind == "console" else ():
            assert words[0] == "sims"
            done = CliRunner().invoke(app, words[1:])
            # A sample may miss a limit, and then ends with 1.
            assert done.exit_code in ((0, 1) if words[1] == "evaluate" else (0,)), (words, done.output, done.exception)
            said_as(shown, done.stdout)
    assert {*met} == {"python", "text", "console"}
    assert {"arms", "tiptoes.png", "walk.png", "clips.npz"} <= {path.name for path in tmp_path.iterdir()}
