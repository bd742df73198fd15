"""`sims clips sheet` of our own body: one caption, or all of a skill, and what it cannot draw."""

from __future__ import annotations

from itertools import chain
from pathlib import Path

import pytest
from matplotlib.image import imread
from typer.testing import CliRunner, Result

from motion_backend.motion import Skill
from motion_backend.rendering.contact_sheet import CELL, GAP, HEAD
from planner_service.cli import app
from planner_service.output import caption_sheets
from planner_service.output.caption_sheets import vocabulary_sheets
from planner_service.pipeline import RequestError
from planner_service.scripts.captions import captions

ROW = HEAD + 2 * CELL[1] + GAP


def run(*words: object) -> Result:
    return CliRunner().invoke(app, ["clips", "sheet", *map(str, words)])


@pytest.mark.sweep
def test_a_caption_is_acted_and_drawn_in_a_row(tmp_path: Path) -> None:
    out = tmp_path / "sheet.png"
    done = run("--caption", "crossing arms", "--room", "living-room-0002", "--out", out)
    assert done.exit_code == 0, done.output
    assert imread(out).shape[0] == ROW


def test_all_captions_are_drawn_eight_a_page_and_each_once(monkeypatch: pytest.MonkeyPatch) -> None:
    pages = []
    monkeypatch.setattr(caption_sheets, "_page", lambda trials: pages.append([one.caption for one in trials]))
    names = [name for name, _ in vocabulary_sheets([Skill.STANDUP, Skill.LOCO], None, 0)]
    known = captions()
    assert sorted(chain(*pages)) == sorted(known["standup"] + known["loco"])
    assert max(map(len, pages)) == 8
    assert len(set(names)) == len(names)


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ((), "give one of FILE, --caption and --all"),
        (("--caption", "crossing arms", "--all", "x"), "give one of FILE, --caption and --all"),
        (("--caption", "crossing arms"), "--out: say where"),
        (("--caption", "moonwalk", "--out", "x.png"), "--caption: 'moonwalk' is not a known one; give --skill"),
        (
            ("--caption", "crossing arms", "--room", "attic", "--out", "x.png"),
            "--room: the library has no room 'attic'",
        ),
    ],
)
def test_what_cannot_be_drawn_is_told(
    words: tuple[str, ...], why: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = run(*words)
    assert isinstance(done.exception, RequestError)
    assert why in str(done.exception)
    assert not list(tmp_path.iterdir())
