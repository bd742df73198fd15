"""The guide to scripts does what it says: its blocks are run in order in one process, their output compared."""

from __future__ import annotations

import contextlib
import io
import os
from pathlib import Path

import pytest
from guides import BLOCK, said_as, typed
from typer.testing import CliRunner

from motion_backend.language.sentence_encoder import load_encoder
from planner_service.cli import app

GUIDE = Path(__file__).resolve().parents[3] / "docs" / "scripts.md"


def carry_out(words: list[str], shown: list[str], patch: pytest.MonkeyPatch) -> None:
    if words[0] == "export":
        patch.setenv(*words[1].split("=", 1))
        return
    assert words[0] == "sims"
    done = CliRunner().invoke(app, words[1:])
    # `check` ends with 1 where something is to be repaired.
    assert done.exit_code == (words[1:3] == ["scripts", "check"]), (words, done.output, done.exception)
    said_as(shown, done.stdout)


@pytest.mark.sweep
def test_the_guide_to_scripts_is_true(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if load_encoder().name == "hashing":
        pytest.skip("the guide was written with the sentence encoder installed")
    for name in [name for name in os.environ if name.startswith(("SIMS_", "COLUMNS"))]:
        monkeypatch.delenv(name)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SIMS_DATA_DIR", str(tmp_path / "data"))
    names: dict[str, object] = {}
    printed, met = "", []
    for kind, file, block in BLOCK.findall(GUIDE.read_text(encoding="utf-8")):
        met.append(kind)
        if file:
            (tmp_path / file).write_text(block, encoding="utf-8")
        elif kind == "python":
            with contextlib.redirect_stdout(io.StringIO()) as stream:
                exec(compile(block, GUIDE.name, "exec"), names)
            printed = stream.getvalue()
        elif kind == "text":
            said_as(block.splitlines(), printed)
        for words, shown in typed(block) if kind == "console" else ():
            carry_out(words, shown, monkeypatch)
    assert {*met} == {"python", "text", "json", "console", "srt"}
