"""Rooms that other people made, in our native format: read, used by a body, and played in (needs SIMS_TEST_DATA)."""

from __future__ import annotations

import os
from functools import lru_cache
from pathlib import Path

import pytest

from planner_service.furnish import FurnishError
from planner_service.stories import StoryRequest, Studio
from scene_graphs.furniture import affordances
from scene_graphs.layouts import Layout, layout_from_dict, layout_to_dict, read_layouts
from scene_graphs.surfaces import spots

DATA = os.environ.get("SIMS_TEST_DATA")
ROOMS = Path(DATA or ".") / "layouts" / "rooms"
pytestmark = pytest.mark.skipif(DATA is None or not ROOMS.is_dir(), reason="SIMS_TEST_DATA holds no layouts/rooms")
THEMES = {
    "living_room": "He is tired, comes home and rests on the sofa, then watches TV.",
    "bedroom": "She feels sad, walks around the bedroom and lies down on the bed.",
}


@lru_cache(maxsize=1)
def rooms() -> tuple[Layout, ...]:
    return tuple(layout for path in sorted(ROOMS.glob("*.jsonl.gz")) for layout in read_layouts(path))


def test_every_room_is_read_and_survives_being_written() -> None:
    assert len(rooms()) > 500
    for layout in rooms():
        assert layout_from_dict(layout_to_dict(layout)) == layout


@pytest.mark.parametrize(("need", "share"), [("sit", 0.93), ("lie", 0.93)])
def test_what_affords_it_has_a_place_for_a_body(need: str, share: float) -> None:
    pieces = [o for layout in rooms() for o in layout.objects if o.parent is None and need in affordances(o.category)]
    found = sum(bool(spots(placed, need)) for placed in pieces)
    assert found >= share * len(pieces)


def test_stories_are_played_in_them_or_refused_by_name() -> None:
    playable = [layout for layout in rooms() if layout.room_type in THEMES]
    studio, made, keyframes, reached = Studio(), 0, 0, 0
    refusals: list[str] = []
    sample = playable[:: len(playable) // 20]
    for layout in sample:
        request = StoryRequest(THEMES[layout.room_type], rooms=(layout.room_type,), layouts=(layout,), seed=1)
        try:
            report = studio.make(request).report
        except FurnishError as error:
            refusals.append(str(error))
            continue
        made += 1
        keyframes += report["keyframes"]
        reached += report["reached"]
    assert all("has no" in refusal for refusal in refusals), refusals
    assert made >= 0.6 * len(sample)
    assert reached >= 0.95 * keyframes
