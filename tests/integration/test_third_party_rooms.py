"""Rooms that other people made, in our native format: read, used by a body, and played in (needs SIMS_TEST_DATA)."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import pytest
from encoded import encoded

from planner_service.library.library import Shelves
from planner_service.pipeline import Pipeline, StoryRequest
from scene_graphs.affordances.affordances import spots
from scene_graphs.affordances.usable_furniture import count_uses
from scene_graphs.furniture import affordances
from scene_graphs.layout import Layout, layout_from_dict, layout_to_dict, read_layouts

DATA = os.environ.get("SIMS_TEST_DATA")
ROOMS = Path(DATA or ".") / "layouts" / "rooms"
pytestmark = pytest.mark.skipif(DATA is None or not ROOMS.is_dir(), reason="SIMS_TEST_DATA holds no layouts/rooms")
CHAIRS = {"dining_chair", "office_chair"}
BEDS_AND_SOFAS = {
    *("double_bed", "single_bed", "multi_seat_sofa", "loveseat_sofa", "l_shaped_sofa", "chaise_longue_sofa", "armchair")
}
THEMES = {
    "living_room": "He is tired, comes home and rests on the sofa, then watches TV.",
    "bedroom": "She feels sad, walks around the bedroom and lies down on the bed.",
}


@lru_cache(maxsize=1)
def rooms() -> tuple[Layout, ...]:
    return tuple(layout for path in sorted(ROOMS.glob("*.jsonl.gz")) for layout in read_layouts(path))


@pytest.mark.parametrize("step", [7, pytest.param(1, marks=pytest.mark.sweep)])
def test_every_room_is_read_and_survives_being_written(step: int) -> None:
    assert len(rooms()) > 500
    for layout in rooms()[::step]:
        assert layout_from_dict(layout_to_dict(layout)) == layout


@pytest.mark.parametrize(("need", "share"), [("sit", 0.93), ("lie", 0.93)])
def test_what_affords_it_has_a_place_for_a_body(need: str, share: float) -> None:
    pieces = [o for layout in rooms() for o in layout.objects if o.parent is None and need in affordances(o.category)]
    found = sum(bool(spots(placed, need)) for placed in pieces)
    assert found >= share * len(pieces)


def share(counts: Mapping[tuple[str, str], Counter[str]], categories: Collection[str], *verdicts: str) -> float:
    """Of the pieces of some categories, for all that is done with them, those with one of the verdicts."""
    chosen = [count for (category, _), count in counts.items() if category in categories]
    assert chosen
    return sum(count[verdict] for count in chosen for verdict in verdicts) / sum(map(Counter.total, chosen))


@pytest.mark.parametrize("step", [11, pytest.param(1, marks=pytest.mark.sweep)])
def test_beds_sofas_and_armchairs_can_be_used_as_they_stand(step: int) -> None:
    kept = [
        replace(layout, objects=tuple(o for o in layout.objects if o.parent is not None or o.category not in CHAIRS))
        for layout in rooms()[::step]
    ]
    assert share(count_uses(kept), BEDS_AND_SOFAS, "as placed") >= 0.97


@pytest.mark.sweep
@pytest.mark.parametrize("step", [9])
def test_chairs_that_a_table_blocks_can_be_pulled_out(step: int) -> None:
    counts = count_uses(rooms()[::step])
    assert share(counts, CHAIRS, "as placed", "pulled out") >= 0.95
    # Most are pushed under a table: between its edge and the backrest there is no room to stand up.
    assert 0.05 <= share(counts, CHAIRS, "as placed") <= 0.4


@pytest.mark.sweep
def test_stories_are_played_in_them() -> None:
    playable = [layout for layout in rooms() if layout.room_type in THEMES]
    pipeline, keyframes, reached = Pipeline(Shelves(cache=encoded())), 0, 0
    sample = playable[:: len(playable) // 9]
    for layout in sample:
        request = StoryRequest(THEMES[layout.room_type], rooms=(layout.room_type,), layouts=(layout,), seed=1)
        story = pipeline.make(request)
        keyframes += story.report["keyframes"]
        reached += story.report["reached"]
    assert reached >= 0.95 * keyframes
