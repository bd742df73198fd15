"""Which room has the furniture a script needs: the exact nearest of many by graph edit distance (SIMS 3.2)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graphs.errors import UserError
from scene_graphs.furniture import Furniture, canonical_room, display_name, is_minor
from scene_graphs.graph.branch_and_bound import NODE_LIMIT, UNMAPPED, CodedQuery, Hunt, Ranked
from scene_graphs.graph.count_table import Counts
from scene_graphs.graph.edit_distance import check_size, exact_distance
from scene_graphs.graph.furniture_graph import FurnitureGraph, graph_from_layout
from scene_graphs.graph.packed_graphs import Ints, PackedRooms
from scene_graphs.graph.script_objects import Offers
from scene_graphs.graph.substitution_costs import CostTable, Level, level_between
from scene_graphs.layout import Layout

VARIETY: Final = 4
"""With a seed, rooms this little farther than the nearest are as good: four pieces of unused furniture."""
_VARIANTS: Final = 12
FIRST_STAGE: Final = 256
"""Rooms that are put in order by their bounds at first; the others only if there may be nearer ones among them."""


class NoSuitableRoom(UserError):  # noqa: N818
    """No room has what a script needs; `missing` names the pieces, empty if there is no room of the kind at all."""

    def __init__(self, fault: str, remedy: str = "", missing: tuple[Furniture, ...] = ()) -> None:
        super().__init__(fault, remedy)
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
    """Rooms ready to be searched: their packed graphs, and the counts that bound every room's distance at once."""

    def __init__(
        self,
        layouts: Sequence[Layout],
        costs: CostTable | None = None,
        *,
        limit: int = NODE_LIMIT,
        first_stage: int = FIRST_STAGE,
        known: LayoutIndex | None = None,
        usable: Mapping[str, Offers] | None = None,
    ) -> None:
        """Index rooms; what an earlier index `known` made of the same rooms is used again.

        `usable` overrules, by the ids of rooms and objects, what objects can be used for, such as when one stands where
        nobody gets to.

        ValueError if two share an id, or `first_stage`, the rooms verified at first, is below 1.
        """
        # In the order of ids, so that a room's number decides ties.
        ordered = tuple(sorted(layouts, key=lambda layout: layout.id))
        for first, second in pairwise(ordered):
            if first.id == second.id:
                raise ValueError(f"layouts must have different ids, two have {first.id!r}; give every room its own")
        self._set_up(ordered, _packed(ordered, known, usable or {}), costs, limit, first_stage)

    @classmethod
    def of_packed(
        cls,
        rooms: PackedRooms,
        layouts: Sequence[Layout],
        costs: CostTable | None = None,
        *,
        limit: int = NODE_LIMIT,
        first_stage: int = FIRST_STAGE,
    ) -> LayoutIndex:
        """Index packed rooms, in the order of their ids. `layouts` has the same rooms in that order, and need not have
        read them; it is only asked for single ones."""
        if len(rooms) != len(layouts):
            raise ValueError(f"there must be as many layouts as packed rooms, got {len(layouts)} and {len(rooms)}")
        index = cls.__new__(cls)
        index._set_up(layouts, rooms, costs, limit, first_stage)
        return index

    def _set_up(
        self, layouts: Sequence[Layout], rooms: PackedRooms, costs: CostTable | None, limit: int, first_stage: int
    ) -> None:
        if first_stage < 1:
            raise ValueError(f"first_stage must be at least 1, got {first_stage}")
        if limit < 1:
            raise ValueError(f"the node limit must be at least 1, got {limit}")
        self.layouts, self.rooms = layouts, rooms
        self.costs = costs or CostTable()
        self.limit, self.first_stage = limit, first_stage
        self.counts, self.bases = Counts(rooms), rooms.bases(self.costs)
        self._types: dict[str | None, tuple[Ints, NDArray[np.uint8]]] = {}

    def layout(self, layout_id: str) -> Layout:
        """The room of that id; KeyError if there is none."""
        return self.layouts[self.number(layout_id)]

    def number(self, layout_id: str) -> int:
        """The place of a room in the order of ids; KeyError if there is none."""
        number = self.rooms.ids.find(layout_id)
        if number is None:
            raise KeyError(f"no layout {layout_id!r} among the {len(self.layouts)} that are indexed")
        return number

    def graph(self, layout_id: str) -> FurnitureGraph:
        """The graph that room is searched as, with what its objects can really be used for; KeyError if there is
        none."""
        return self.rooms.graph(self.number(layout_id))

    def of_type(self, room_type: str | None) -> Ints:
        """Numbers of the rooms that can serve as a room type, rising. NoSuitableRoom if there are none."""
        return self._chosen(room_type)[0]

    def _chosen(self, room_type: str | None) -> tuple[Ints, NDArray[np.uint8]]:
        """The numbers of the rooms of a type, and a 1 for each of them among all."""
        wanted = None if room_type is None else canonical_room(room_type)
        if wanted in self._types:
            return self._types[wanted]
        numbers = np.arange(len(self.rooms)) if wanted is None else self.rooms.of_type(wanted)
        if not len(numbers):
            known = ", ".join(self.rooms.room_types) or "none"
            raise NoSuitableRoom(f"no room of type {wanted or 'any'} is indexed", f"there are: {known}")
        among = np.zeros(len(self.rooms), dtype=np.uint8)
        among[numbers] = 1
        self._types[wanted] = numbers, among
        return numbers, among

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
        if k < 1 or (limit is not None and limit < 1):
            raise ValueError(f"k and limit must be at least 1, got {k} and {limit}")
        if not len(graph):
            raise ValueError("the query has no furniture: every keyframe is on the floor; ask for a room by its type")
        check_size(graph)
        if strict:
            matches = self._nearest(CodedQuery.of(graph, self.costs, strict=True), k, room_type, limit)
            if not matches[0].missing:
                return matches
        return self._nearest(CodedQuery.of(graph, self.costs), k, room_type, limit)

    def hunt(self, query: CodedQuery) -> Hunt:
        """A query laid out for these rooms."""
        return Hunt(query, self.rooms, self.counts, self.bases)

    def bounds(self, query: CodedQuery) -> NDArray[np.int32]:
        """The lower bound of every room, in one pass over the counts the query touches. (rooms,)."""
        return self.hunt(query).bounds()

    @property
    def nbytes(self) -> int:
        """Memory of what is searched: graphs, counts and costs, without the layouts."""
        return self.rooms.nbytes + self.counts.nbytes + self.bases.nbytes

    def _nearest(self, query: CodedQuery, k: int, room_type: str | None, limit: int | None) -> list[LayoutMatch]:
        numbers, among = self._chosen(room_type)
        most = min(k, len(numbers))
        found, least_doubtful = self.hunt(query).nearest(among, most, self.first_stage, limit or self.limit)
        return [self._match(query, entry, least_doubtful) for entry in found]

    def _match(self, query: CodedQuery, entry: Ranked, least_doubtful: int) -> LayoutMatch:
        nodes = self.rooms.nodes(entry.number)
        ids = self.rooms.object_ids[nodes.start : nodes.stop]
        categories = self.rooms.categories[nodes.start : nodes.stop].tolist()
        mapping: list[tuple[Furniture, str, Level]] = []
        missing: list[Furniture] = []
        for node, word, image in zip(query.nodes, query.words, entry.found.images, strict=True):
            if image == UNMAPPED:
                missing.append(node)
            elif (level := level_between(word, self.rooms.word(categories[image]))) is not None:
                mapping.append((node, ids[image], level))
        used = set(entry.found.images)
        return LayoutMatch(
            layout_id=self.rooms.ids[entry.number],
            distance=entry.cost,
            # The least doubtful bound is that of this room too, if the limit was met here. A room of the same bound
            # and cost may come first by its id.
            exact=least_doubtful > entry.cost or (least_doubtful == entry.cost > entry.bound),
            mapping=tuple(sorted(mapping)),
            missing=tuple(sorted(missing)),
            extra=tuple([object_id for place, object_id in enumerate(ids) if place not in used]),
            lower_bound=entry.bound,
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
            own = index.graph(layout.id)
            cost = exact_distance(graph, own, index.costs).cost
            extra = tuple(str(name) for _, name in own.nodes(data="object_id"))
            matches[room_type] = LayoutMatch(layout.id, cost, True, (), (), extra, cost)
            continue
        found = index.search(graph, 1 if seed is None else _VARIANTS, room_type, strict=True)
        match = found[0] if seed is None else _varied(found, seed)
        lacking = tuple(node for node in match.missing if not is_minor(node.category))
        if complete and lacking:
            names = ", ".join(display_name(node.category) for node in lacking)
            raise NoSuitableRoom(f"no {room_type.replace('_', ' ')} has all of: {names}", "leave them out", lacking)
        matches[room_type] = match
    return matches


def _varied(found: Sequence[LayoutMatch], seed: int) -> LayoutMatch:
    """One of the matches that are as good as the first, chosen by the seed."""
    best = found[0]
    good = [m for m in found if m.distance <= best.distance + VARIETY and len(m.missing) <= len(best.missing)]
    return good[int(np.random.default_rng(seed).integers(len(good)))]


def _packed(layouts: Sequence[Layout], known: LayoutIndex | None, usable: Mapping[str, Offers]) -> PackedRooms:
    """The graphs of rooms, those that an index knows already taken from there."""
    old = [None if known is None else _place(known, layout) for layout in layouts]
    new = [layout for layout, place in zip(layouts, old, strict=True) if place is None]
    made = pack([_graph(layout, usable.get(layout.id, {})) for layout in new], new)
    if known is None:
        return made
    taken = known.rooms.take(np.array([place for place in old if place is not None], dtype=np.int64))
    # Both lots are in the order of ids; put them into one.
    places = np.array([place is None for place in old])
    order = np.where(places, len(taken) + np.cumsum(places) - 1, np.cumsum(~places) - 1)
    return PackedRooms.join([taken, made]).take(order)


def pack(graphs: Sequence[FurnitureGraph], layouts: Sequence[Layout]) -> PackedRooms:
    """The graphs of rooms with the rooms' ids and types."""
    types = [(layout.room_type, *layout.tags) for layout in layouts]
    return PackedRooms.of(graphs, [layout.id for layout in layouts], types)


def _place(index: LayoutIndex, layout: Layout) -> int | None:
    """The number of a room in an index, if it is this very room that is there."""
    number = index.rooms.ids.find(layout.id)
    return number if number is not None and index.layouts[number] is layout else None


def _graph(layout: Layout, usable: Offers) -> FurnitureGraph:
    graph = graph_from_layout(layout)
    for _, node in graph.nodes(data=True):
        node["offers"] = usable.get(str(node["object_id"]), node["offers"])
    return graph
