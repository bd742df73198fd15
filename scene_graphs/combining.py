"""The rooms that together have what a script needs: the best pair exactly, three and four rooms by a beam (SIMS 3.2).

    cost(Q, R1 .. Rn) = d(Q -> R1 and .. and Rn side by side) + 50 * (n - 1)

Taking rooms one by one for what is left over is poor: a room that is second best alone may be best beside another.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from scene_graphs.branching import UNMAPPED, CodedQuery
from scene_graphs.costs import Level, level_between
from scene_graphs.distance import check_size
from scene_graphs.furniture import Furniture
from scene_graphs.graph import FurnitureGraph
from scene_graphs.growing import Effort, Grown, Homes
from scene_graphs.homes import MAX_ROOMS
from scene_graphs.retrieval import LayoutIndex

BEAM: Final = 20
"""Homes of one size that are grown by another room."""
BUDGET: Final = 20_000
"""Homes of more than one room that are searched."""
EFFORT: Final = 20_000_000
"""Search nodes expanded for all homes: some seconds."""


@dataclass(frozen=True)
class HomeMatch:
    """How well some rooms together have what a query asks for."""

    layout_ids: tuple[str, ...]
    """In the order of the ids; an object of the first is "0/its id", as in a home of these rooms."""
    distance: int
    exact: bool
    """Whether the distance is proven and no node limit, budget or choice of rooms can have hidden a nearer home; one
    just as near may come before it by its rooms."""
    mapping: tuple[tuple[Furniture, str, Level], ...]
    """(query node, home-wide object id, how near the two are)."""
    missing: tuple[Furniture, ...]
    extra: tuple[str, ...]
    """Home-wide ids of objects that the query does not use."""
    lower_bound: int = 0


def retrieve_home(
    index: LayoutIndex,
    query: FurnitureGraph,
    max_rooms: int = MAX_ROOMS,
    k: int = 1,
    room_types: Sequence[str] = (),
    *,
    limit: int | None = None,
    budget: int = BUDGET,
    effort: int = EFFORT,
) -> list[HomeMatch]:
    """The k nearest homes of 1 to `max_rooms` different rooms, by (distance, number of rooms, lower bound, ids).

    Homes of one and two rooms are the nearest there are. For three and four, homes are grown from the best pairs and
    from the best rooms, `BEAM` at a time, and the best of each size is improved by exchanging single rooms: never worse
    than a plain beam, nor than taking rooms greedily. `room_types` are those to choose from; none: all.

    `limit` is the search's node limit for one home and `effort` that for all together: homes left after that get the
    first mapping there is. `budget` is how many homes of several rooms are searched. A match that any of them may have
    spoilt is not `exact`. NoSuitableRoom if no room is of a type; ValueError for an empty or too large query.
    """
    if not 1 <= max_rooms <= MAX_ROOMS:
        raise ValueError(f"max_rooms must be 1 to {MAX_ROOMS}, got {max_rooms}")
    if min(k, budget, effort, 1 if limit is None else limit) < 1:
        raise ValueError(f"k, limit, budget and effort must be at least 1, got {k}, {limit}, {budget} and {effort}")
    if not len(query):
        raise ValueError("the query has no furniture: every keyframe is on the floor; ask for a room by its type")
    check_size(query)
    kinds: Sequence[str | None] = room_types or [None]
    numbers = np.unique(np.concatenate([index.of_type(kind) for kind in kinds]))
    homes = Homes(index, CodedQuery.of(query, index.costs), numbers, k, Effort(limit or index.limit, effort, budget))
    homes.best(none := np.empty((1, 0), dtype=np.intp))
    if (most := homes.worthwhile(max_rooms)) > 1:
        homes.narrow(most)
        homes.best(alone := homes.numbers[:, None])
    # Size after size, so that to allow one room more only goes on where it stopped before.
    for size in range(3, most + 1):
        if size == 3:
            rooms, pairs = homes.best(none, BEAM), homes.best(alone, BEAM)
        for start, width in ((rooms[:1], 1), (rooms, BEAM), (pairs, BEAM)):
            homes.grow(start, width, size)
        homes.exchange(size)
    return [_match(index, homes, entry) for entry in homes.kept]


def _match(index: LayoutIndex, homes: Homes, entry: Grown) -> HomeMatch:
    query, found = homes.query, homes.known[entry.rooms].found
    ids = [
        (f"{place}/{index.rooms.object_ids[node]}", index.rooms.word(int(index.rooms.categories[node])))
        for place, room in enumerate(entry.rooms)
        for node in index.rooms.nodes(room)
    ]
    mapping = []
    for node, word, image in zip(query.nodes, query.words, found.images, strict=True):
        if image != UNMAPPED and (level := level_between(word, ids[image][1])) is not None:
            mapping.append((node, ids[image][0], level))
    return HomeMatch(
        layout_ids=tuple(index.rooms.ids[room] for room in entry.rooms),
        distance=entry.cost,
        exact=not found.capped and homes.doubt >= entry.cost,
        mapping=tuple(sorted(mapping)),
        missing=tuple(sorted(set(query.nodes) - {node for node, *_ in mapping})),
        extra=tuple(name for image, (name, _) in enumerate(ids) if image not in found.images),
        lower_bound=entry.bound,
    )
