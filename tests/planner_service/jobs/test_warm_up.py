"""What a worker does before anything is asked for: it asks no language model, and no library of rooms stops it."""

from __future__ import annotations

from typing import cast

import pytest
from encoded import encoded

from motion_backend.director import Director
from planner_service.jobs.worker import warm_up
from planner_service.library.library import Shelves
from planner_service.llm.protocol import LanguageModel
from planner_service.pipeline import Pipeline
from scene_graphs.errors import UserError


class Unasked:
    """A model that nobody may use."""

    def __getattr__(self, name: str) -> object:
        raise AssertionError(f"a language model was asked for {name}")


def test_a_body_moves_by_rules_before_anybody_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    moved, act = [], Director.act

    def counted(*asked: object, **more: object) -> object:
        moved.append(act(*asked, **more))  # type: ignore[arg-type]
        return moved[-1]

    monkeypatch.setattr(Director, "act", counted)
    warm_up(Pipeline(Shelves(cache=encoded()), cast(LanguageModel, Unasked())))
    assert len(moved) == 1
    assert len(moved[0][0]) > 0


def test_a_library_that_furnishes_no_home_stops_no_worker(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object) -> None:
        raise UserError("no room has it")

    monkeypatch.setattr(Pipeline, "furnish", refused)
    warm_up(Pipeline(Shelves(cache=encoded())))


def test_a_story_in_which_nothing_is_left_to_do_stops_no_worker(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Pipeline, "act", lambda *_: ())
    warm_up(Pipeline(Shelves(cache=encoded())))
