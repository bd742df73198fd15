"""`sims cast` says who plays, and draws them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from motion_backend.body.cast import GIVEN, cast
from planner_service.cli import app
from planner_service.output import cast_sheet


def test_all_members_and_words_are_listed() -> None:
    printed = CliRunner().invoke(app, ["cast"], env={"COLUMNS": "200"}).stdout
    assert all(f"\n{one.name} " in printed for one in cast().member)
    assert all(f"  {name}: {', '.join(cast().known(name))}" in printed for name in GIVEN[1:])


def test_the_picture_goes_where_it_is_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cast_sheet, "cast_sheet", lambda: np.full((8, 16, 3), 7, dtype=np.uint8))
    done = CliRunner().invoke(app, ["cast", "--out", str(tmp_path / "who" / "cast.png")])
    assert done.exit_code == 0, done.output
    with Image.open(tmp_path / "who" / "cast.png") as drawn:
        assert drawn.size == (16, 8)
