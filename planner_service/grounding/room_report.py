"""What a body can do in a room: problems of the room, and every spot to sit, lie or touch with its standing point."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from math import sqrt
from typing import Final

from scene_graphs.affordances.affordances import Spot, spots
from scene_graphs.affordances.room_validation import OUT_OF_REACH, RoomCheck
from scene_graphs.furniture import AFFORDANCES
from scene_graphs.graph.furniture_graph import FurnitureGraph, graph_from_layout, offers
from scene_graphs.layout import Layout

MAX_CELLS: Final = 150_000
"""Cells of the map of a floor: 375 square metres at 5 cm; a larger room is looked at more coarsely."""
MAX_SPOTS: Final = 8
"""Of one object for one affordance, the usable ones first."""
_CELL: Final = 0.05


@dataclass(frozen=True, eq=False)
class Survey:
    """A room looked over once."""

    problems: tuple[str, ...]
    """One sentence each: outside the walls, overlaps, blocked doors, what nobody can get to."""
    spots: tuple[tuple[Spot, bool], ...]
    """Where a body could sit, lie or touch, object after object, and whether it gets there from the door."""
    graph: FurnitureGraph
    """Not to be changed."""

    @property
    def usable(self) -> dict[str, frozenset[str]]:
        """What each object can really be used for, by its id."""
        found = {str(node["object_id"]): set[str]() for _, node in self.graph.nodes(data=True)}
        for spot, usable in self.spots:
            if usable and spot.object_id in found:
                found[spot.object_id].add(spot.affordance)
        return {name: frozenset(affordances) for name, affordances in found.items()}


@lru_cache(maxsize=256)
def survey(layout: Layout) -> Survey:
    """Look a room over; about 0.1 s for an ordinary one, and remembered."""
    check = RoomCheck(layout, cell_of(layout))
    return Survey(tuple(check.problems()), tuple(_spots(check)), graph_from_layout(layout))


def cell_of(layout: Layout) -> float:
    """The cells of a map of its floor, in metres: coarser ones for a larger room."""
    return max(_CELL, sqrt(layout.area / MAX_CELLS))


def _spots(check: RoomCheck) -> Iterator[tuple[Spot, bool]]:
    for placed in check.layout.objects:
        if placed.position[1] >= OUT_OF_REACH:
            continue
        # Only what a piece is for: a side table has the height of a stool, and is no seat.
        for affordance in (one for one in AFFORDANCES if one in offers(placed)):
            found = [(spot, check.is_usable(spot)) for spot in spots(placed, affordance)]
            yield from sorted(found, key=lambda one: not one[1])[:MAX_SPOTS]
