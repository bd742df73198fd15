"""A long action asks now and then whether somebody still wants it."""

from __future__ import annotations

import time

import pytest
from sqlalchemy.exc import OperationalError

from planner_service.jobs import story_stages
from planner_service.store.story_store import StoryGone


def test_it_is_asked_at_once_and_then_only_after_some_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    now, asked = [100.0], []
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    between = story_stages._now_and_then(lambda: asked.append(now[0]))
    for passed in (0.0, 0.5, 1.0, 1.0, 5.0):
        now[0] += passed
        between()
    assert asked == [100.0, 102.5, 107.5]


def test_who_is_cancelled_stops_and_a_database_that_is_away_does_not() -> None:
    def gone() -> None:
        raise StoryGone("s")

    def away() -> None:
        raise OperationalError("select", {}, Exception())

    story_stages._now_and_then(away)()
    with pytest.raises(StoryGone):
        story_stages._now_and_then(gone)()
