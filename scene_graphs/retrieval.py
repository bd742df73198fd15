"""Which room has the furniture a script needs: the exact nearest of many by graph edit distance (SIMS 3.2)."""

from __future__ import annotations

from bisect import insort
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graphs.branching import NODE_LIMIT, CodedQuery, CodedRoom, Found, search
from scene_graphs.costs import CostTable, Key, Level
from scene_graphs.distance import all_terms, check_size, pairs_of
from scene_graphs.furniture import Furniture, canonical_room, display_name, is_minor
from scene_graphs.graph import FurnitureGraph, graph_from_layout
from scene_graphs.grounding import Offers
from scene_graphs.layouts import Layout

VARIETY: Final = 4
"""With a seed, rooms this little farther than the nearest are as good: four pieces of unused furniture."""
_VARIANTS: Final = 12

Column = NDArray[np.int64]
_Worst = Callable[[], int | None]
_Kept = tuple[int, int, int, Found]
"""Cost, lower bound, place of the id in order, what the search found."""


class NoSuitableRoom(ValueError):  # noqa: N818
    """No room has what a script needs; `missing` names the pieces, empty if there is no room of the kind at all."""

    def __init__(self, message: str, missing: tuple[Furniture, ...] = ()) -> None:
        super().__init__(message)
        self.missing = missing


@dataclass(frozen=True)
class LayoutMatch:
    """How well one room has what a query asks for."""

    layout_id: str
    distance: int
    exact: bool
    """Whether distance and rank are proven; False if the node limit was met here or in a room that might be nearer."""
    mapping: tuple[tuple[Furniture, str, Level], ...]
    """(query node, object id, how near the two are: same, class or group)."""
    missing: tuple[Furniture, ...]
    """Query nodes that nothing in the room stands in for, or only things without what they need."""
    extra: tuple[str, ...]
    """Ids of objects that the query does not use."""
    lower_bound: int = 0


class LayoutIndex:
    """Rooms ready to be searched: one clipped-count column for every category, class, group and pair of groups."""

    def __init__(
        self,
        layouts: Sequence[Layout],
        costs: CostTable | None = None,
        *,
        limit: int = NODE_LIMIT,
        first_stage: int = 64,
        known: LayoutIndex | None = None,
        usable: Mapping[str, Offers] | None = None,
    ) -> None:
        """Index rooms; what an earlier index `known` made of the same rooms is used again.

        `usable` overrules, by the ids of rooms and objects, what objects can be used for, such as when one stands where
        nobody gets to.

        ValueError if two share an id, or `first_stage`, the rooms verified at first, is below 1.
        """
        if first_stage < 1:
            raise ValueError(f"first_stage must be at least 1, got {first_stage}")
        # In the order of ids, so that a room's number decides ties.
        self.layouts = tuple(sorted(layouts, key=lambda layout: layout.id))
        self._numbers = {layout.id: number for number, layout in enumerate(self.layouts)}
        if len(self._numbers) < len(self.layouts):
            raise ValueError("layouts must have different ids; give every room its own")
        self.costs = costs or CostTable()
        self.limit, self.first_stage = limit, first_stage
        coded = [
            (None if known is None else known._coded_of(layout)) or _coded(layout, (usable or {}).get(layout.id, {}))
            for layout in self.layouts
        ]
        self._graphs, self._rooms = [graph for graph, _ in coded], [room for _, room in coded]
        self._columns = _count_columns(self._rooms)
        self._bases = np.array([room.base(self.costs) for room in self._rooms], dtype=np.int64)

    def layout(self, layout_id: str) -> Layout:
        """The room of that id; KeyError if there is none."""
        if layout_id not in self._numbers:
            raise KeyError(f"no layout {layout_id!r} among the {len(self.layouts)} that are indexed")
        return self.layouts[self._numbers[layout_id]]

    def _coded_of(self, layout: Layout) -> tuple[FurnitureGraph, CodedRoom] | None:
        """What was made of a room, if it is this very room that is indexed."""
        number = self._numbers.get(layout.id)
        if number is None or self.layouts[number] is not layout:
            return None
        return self._graphs[number], self._rooms[number]

    def of_type(self, room_type: str | None) -> NDArray[np.intp]:
        """Numbers of the rooms that can serve as a room type. NoSuitableRoom if there are none."""
        wanted = None if room_type is None else canonical_room(room_type)
        fitting = [
            number
            for number, layout in enumerate(self.layouts)
            if wanted is None or wanted == layout.room_type or wanted in layout.tags
        ]
        if not fitting:
            known = ", ".join(sorted({layout.room_type for layout in self.layouts})) or "none"
            raise NoSuitableRoom(f"no room of type {wanted or 'any'} is indexed; there are: {known}")
        return np.array(fitting, dtype=np.intp)

    def first(self, room_type: str, seed: int = 0) -> Layout:
        """A room of a type for a script that uses no furniture, chosen by the seed."""
        numbers = self.of_type(room_type)
        return self.layouts[int(np.random.default_rng(seed).choice(numbers)) if seed else int(numbers[0])]

    def search(
        self,
        graph: FurnitureGraph,
        k: int = 1,
        room_type: str | None = None,
        *,
        strict: bool = False,
        limit: int | None = None,
    ) -> list[LayoutMatch]:
        """The k nearest rooms, nearest first, ordered by (distance, lower bound, id); fewer if there are fewer.

        With `strict` furniture is first matched by the very category or kind; only if the nearest room then misses
        something, the search is repeated with substitutions, as in the paper. `limit` is that of this search alone.
        NoSuitableRoom if no room is of the type; ValueError for an empty or too large query.
        """
        if k < 1:
            raise ValueError(f"k must be at least 1, got {k}")
        if not len(graph):
            raise ValueError("the query has no furniture: every keyframe is on the floor; ask for a room by its type")
        check_size(graph)
        numbers = self.of_type(room_type)
        if strict:
            matches = self._nearest(CodedQuery.of(graph, self.costs, strict=True), k, numbers, limit)
            if not matches[0].missing:
                return matches
        return self._nearest(CodedQuery.of(graph, self.costs), k, numbers, limit)

    def bounds(self, query: CodedQuery) -> Column:
        """The lower bound of every room, in one pass over the columns the query touches. (rooms,)."""
        constant = sum(query.deletes) + query.costs.lost_edge * len(query.edges)
        saved = np.zeros(len(self._rooms), dtype=np.int64)
        for term in all_terms(query):
            saved += term.saved(self._count, np.minimum)
        bounds: Column = self._bases + constant - saved
        return bounds

    def _count(self, keys: Sequence[Key]) -> Column:
        total = np.zeros(len(self._rooms), dtype=np.int64)
        for key in keys:
            if (column := self._columns.get(key)) is not None:
                total += column
        return total

    def _nearest(self, query: CodedQuery, k: int, numbers: NDArray[np.intp], limit: int | None) -> list[LayoutMatch]:
        """The k best of the rooms with these numbers: verify in the order of bounds until no bound is below the worst.

        Stopping at a bound equal to the worst kept is exact because ties are broken by (bound, id): a later room of
        equal cost loses.
        """
        bounds = self.bounds(query)
        kept: list[_Kept] = []
        doubtful = []
        for number in self._by_bound(bounds, numbers, lambda: kept[-1][0] if len(kept) == k else None):
            upper = kept[-1][0] if len(kept) == k else None
            found = search(query, self._rooms[number], upper, limit or self.limit)
            if found.capped:
                doubtful.append(int(bounds[number]))
            if found.cost is not None:
                insort(kept, (found.cost, int(bounds[number]), number, found), key=lambda entry: entry[:3])
                del kept[k:]
        least_doubtful = min(doubtful, default=None)
        return [self._match(query, entry, least_doubtful) for entry in kept]

    def _by_bound(self, bounds: Column, numbers: NDArray[np.intp], worst: _Worst) -> Iterator[int]:
        """Rooms by (bound, id) while they can be among the best: a first stage, then what else is needed."""
        own = bounds[numbers]
        size = min(self.first_stage, len(numbers))
        limit = int(np.partition(own, size - 1)[size - 1])
        for stage in (own <= limit, own > limit):
            inside = numbers[stage if (known := worst()) is None else stage & (own < known)]
            for number in inside[np.argsort(bounds[inside], kind="stable")]:
                known = worst()
                if known is not None and bounds[number] >= known:
                    return
                yield int(number)

    def _match(self, query: CodedQuery, entry: _Kept, least_doubtful: int | None) -> LayoutMatch:
        cost, bound, number, found = entry
        nodes = self._graphs[number].nodes
        pairs, missing, extra = pairs_of(query, self._rooms[number], found.images)
        return LayoutMatch(
            layout_id=self.layouts[number].id,
            distance=cost,
            exact=not found.capped and (least_doubtful is None or least_doubtful >= cost),
            mapping=tuple((pair.query, str(nodes[pair.room]["object_id"]), pair.level) for pair in pairs),
            missing=missing,
            extra=tuple(str(nodes[node]["object_id"]) for node in extra),
            lower_bound=bound,
        )


def retrieve_rooms(
    index: LayoutIndex, graphs: Mapping[str, FurnitureGraph], *, seed: int | None = None, complete: bool = False
) -> dict[str, LayoutMatch]:
    """One match a room type, for the merged graph of the scripts that play there; strict first, then classes.

    A room type with an empty graph gets any room of its type. With a seed, the choice is among the rooms that miss
    nothing more than the nearest and are at most `VARIETY` farther. NoSuitableRoom if there is no room of a type, or,
    where it must be `complete`, if even the nearest room misses a key piece of furniture.
    """
    matches = {}
    for room_type, graph in graphs.items():
        if not len(graph):
            layout = index.first(room_type, seed or 0)
            extra = tuple(placed.id for placed in layout.objects)
            matches[room_type] = LayoutMatch(layout.id, 0, True, (), (), extra)
            continue
        found = index.search(graph, 1 if seed is None else _VARIANTS, room_type, strict=True)
        match = found[0] if seed is None else _varied(found, seed)
        lacking = tuple(node for node in match.missing if not is_minor(node.category))
        if complete and lacking:
            names = ", ".join(display_name(node.category) for node in lacking)
            raise NoSuitableRoom(f"no {room_type.replace('_', ' ')} has all of: {names}; leave them out", lacking)
        matches[room_type] = match
    return matches


def _varied(found: Sequence[LayoutMatch], seed: int) -> LayoutMatch:
    """One of the matches that are as good as the first, chosen by the seed."""
    best = found[0]
    good = [m for m in found if m.distance <= best.distance + VARIETY and len(m.missing) <= len(best.missing)]
    return good[int(np.random.default_rng(seed).integers(len(good)))]


def _coded(layout: Layout, usable: Offers) -> tuple[FurnitureGraph, CodedRoom]:
    graph = graph_from_layout(layout)
    for _, node in graph.nodes(data=True):
        node["offers"] = usable.get(str(node["object_id"]), node["offers"])
    return graph, CodedRoom.of(graph)


def _count_columns(rooms: Sequence[CodedRoom]) -> dict[Key, NDArray[np.uint8]]:
    """For everything that can be counted, how often each room has it; a count stops at 255, above any query's."""
    keys = {key for room in rooms for key in (*room.masks, *room.edges)}
    columns = {key: np.zeros(len(rooms), dtype=np.uint8) for key in sorted(keys)}
    for number, room in enumerate(rooms):
        for key in (*room.masks, *room.edges):
            columns[key][number] = min(room.count((key,)), 255)
    return columns
