"""The rooms that together have what a script needs: the best pair exactly, three and four rooms by a beam (SIMS 3.2).

Homes grow room by room: bounds for all of them at once, an exact search for those that can be among the best.

    cost(Q, R1 .. Rn) = d(Q -> R1 and .. and Rn side by side) + 50 * (n - 1)

Taking rooms one by one for what is left over is poor: a room that is second best alone may be best beside another.
"""

from __future__ import annotations

from bisect import insort
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from scene_graphs.furniture import Furniture
from scene_graphs.graph.branch_and_bound import UNMAPPED, CodedQuery, Found
from scene_graphs.graph.edit_distance import check_size
from scene_graphs.graph.furniture_graph import FurnitureGraph
from scene_graphs.graph.substitution_costs import Key, Level, level_between
from scene_graphs.home import MAX_ROOMS
from scene_graphs.retrieval.layout_index import LayoutIndex

ANOTHER_ROOM: Final = 50
"""What every room after the first costs: half a missing key object."""
MAX_PAIRED: Final = 1000
"""Of more rooms the nearest of each type are taken, and what that may have missed is not called exact."""
_BLOCK: Final = 1 << 20

Rooms = tuple[int, ...]
"""Numbers of different rooms of an index, rising."""
Sets = NDArray[np.intp]
"""Homes of one size, a row each. (homes, rooms)."""
_Column = NDArray[np.int32]


class Grown(NamedTuple):
    """A home that was searched; homes are ordered by this."""

    cost: int
    size: int
    bound: int
    rooms: Rooms


@dataclass
class Effort:
    """What may still be spent on searching."""

    limit: int
    steps: int
    budget: int

    def __post_init__(self) -> None:
        self.homes = self.budget

    def limit_for(self, rooms: int) -> int:
        """Search nodes for the next home, of so many rooms."""
        # Which three are nearest is not proven anyway: looking at more of them gains more than looking for long.
        return max(1, min(self.limit if rooms < 3 else self.limit // 10, self.steps))

    def spend(self, rooms: int, expanded: int) -> None:
        """A home was searched; single rooms are not counted among the homes."""
        self.steps -= expanded
        self.homes -= rooms > 1


class Homes:
    """The k best homes so far, and the least bound of any home that was not properly looked at."""

    def __init__(
        self, index: LayoutIndex, query: CodedQuery, numbers: NDArray[np.intp], k: int, effort: Effort
    ) -> None:
        self.index, self.query, self.numbers = index, query, numbers
        self.k, self.effort = k, effort
        self.kept: list[Grown] = []
        self.doubt = np.inf
        self.known: dict[Rooms, _Known] = {}
        self._hunt = index.hunt(query)
        self._terms = [*query.node_terms, *query.edge_terms]
        self._constant = sum(query.deletes) + query.costs.lost_edge * len(query.edges)
        self._columns: dict[Key, _Column] = {}
        self._bases = self._hunt.bases
        self._changes = self._hunt.bounds() - self._constant
        """What each room adds to the bound of a home, at least."""

    @property
    def worst(self) -> float:
        """What a home must cost less than to be among the k best."""
        return self.kept[-1].cost if len(self.kept) == self.k else np.inf

    def best(self, homes: Sets, width: int = 0) -> Sets:
        """Add every room to every home, keep the k best of what comes of it, and return the `width` best.

        A home is searched, in the order of bounds, as long as it can be among the one or the other.
        """
        beam: list[Grown] = []
        for bound, rooms in self._grown(homes, np.inf if width else self.worst):
            unfilled = len(beam) < width
            upper = np.inf if unfilled else max([self.worst, *(entry.cost for entry in beam[-1:])])
            if bound >= upper:
                break
            if not self.effort.homes and len(rooms) > 1 and rooms not in self.known:
                self.doubt = min(self.doubt, bound)
                break
            if (entry := self._entry(bound, rooms, upper)) is not None:
                for entries, most in ((self.kept, self.k), (beam, width)):
                    if entry not in entries:
                        insort(entries, entry)
                        del entries[most:]
        return np.array([entry.rooms for entry in beam], dtype=np.intp).reshape(len(beam), homes.shape[1] + 1)

    def grow(self, homes: Sets, width: int, most: int) -> None:
        """Add rooms one after the other until homes have `most` of them, going on with the `width` best."""
        while len(homes) and homes.shape[1] < most:
            homes = self.best(homes, width if homes.shape[1] + 1 < most else 0)

    def exchange(self, size: int) -> None:
        """Put another room in the place of one of the best home of a size, as long as that helps."""
        entries = (known.entry for known in self.known.values() if known.entry is not None)
        best = min((entry for entry in entries if entry.size == size), default=None)
        while best is not None:
            rooms = best.rooms
            without = [[room for room in rooms if room != left_out] for left_out in rooms]
            swapped = self.best(np.array(without, dtype=np.intp), 1)
            found = self.known[tuple(swapped[0].tolist())].entry if len(swapped) else None
            best = found if found is not None and found < best else None

    def worthwhile(self, most: int) -> int:
        """The largest number of rooms, up to `most`, with which a home might be among the k best."""
        return max((size for size in range(2, most + 1) if self._floor(size) < self.worst), default=1)

    def narrow(self, most: int) -> None:
        """Prepare for homes of 2 to `most` rooms: of too many rooms choose the nearest of each type in turn."""
        self.doubt = min([self.doubt, *(self._floor(size) for size in range(3, most + 1))])
        changes = self._changes[self.numbers]
        if len(changes) <= MAX_PAIRED:
            return
        turns: Counter[str] = Counter()
        ranked = []
        for rank, place in enumerate(np.argsort(changes, kind="stable")):
            room_type = self.index.rooms.room_type(int(self.numbers[place]))
            turns[room_type] += 1
            ranked.append((turns[room_type], rank, place))
        chosen = np.sort([place for *_, place in sorted(ranked)[:MAX_PAIRED]])
        hidden = self._constant + _fare(2) + np.delete(changes, chosen).min() + changes.min()
        self.doubt = min(self.doubt, float(hidden))
        self.numbers = self.numbers[chosen]

    def _floor(self, size: int) -> float:
        """A distance that no home of that many rooms falls below."""
        if len(self.numbers) < size:
            return np.inf
        saved = sum(t.coefficient * (len(t.places) + sum(len(own) for _, own in t.parts)) for t in self._terms)
        least = np.sort(self._bases[self.numbers])[:size].sum() - saved
        return float(self._constant + _fare(size) + max(least, np.sort(self._changes[self.numbers])[:size].sum()))

    def _grown(self, homes: Sets, ceiling: float) -> Iterator[tuple[int, Rooms]]:
        """Every home with every room it has not, by (bound, rooms), as far as bounds are below the ceiling."""
        size = homes.shape[1] + 1
        # A home can be grown from as many smaller ones as it has rooms; one more than are searched shows what is cut.
        most = len(self.numbers) if size == 1 else size * (self.effort.budget + 1)
        bounds, grown = np.empty(0, dtype=np.int32), np.empty((0, size), dtype=np.intp)
        rows = max(1, _BLOCK // len(self.numbers))
        for start in range(0, len(homes), rows):
            block = homes[start : start + rows]
            values = self._bounds(block)
            new = (block[:, :, None] != self.numbers).all(axis=1) & (values < ceiling)
            home, place = np.nonzero(new)
            bounds = np.concatenate([bounds, values[home, place]])
            grown = np.concatenate([grown, np.column_stack([block[home], self.numbers[place]])])
            if len(bounds) > most:
                least = np.argpartition(bounds, most - 1)[:most]
                bounds, grown = bounds[least], grown[least]
        grown.sort(axis=1)
        order = np.lexsort((*grown.T[::-1], bounds))
        before: Rooms = ()
        for number in order:
            if (rooms := tuple(map(int, grown[number]))) != before:
                yield int(bounds[number]), rooms
            before = rooms

    def _bounds(self, homes: Sets) -> _Column:
        """The lower bound of every home with every room added. (homes, rooms)."""

        def together(column: _Column) -> _Column:
            joined: _Column = column[homes].sum(axis=1, dtype=np.int32)[:, None] + column[self.numbers]
            return joined

        bounds: _Column = together(self._bases) + (self._constant + _fare(homes.shape[1] + 1))
        for term in self._terms:
            asked = np.full(bounds.shape, len(term.places), dtype=np.int32)
            for key, places in term.parts:
                asked += np.minimum(together(self._column(key)), len(places))
            bounds -= term.coefficient * np.minimum(together(self._column(term.key)), asked)
        return bounds

    def _column(self, key: Key) -> _Column:
        if key not in self._columns:
            self._columns[key] = self.index.counts.column(key)
        return self._columns[key]

    def _entry(self, bound: int, rooms: Rooms, upper: float) -> Grown | None:
        """What a home costs, unless that is at least the upper bound."""
        known = self.known.get(rooms)
        if known is None or (known.entry is None and known.below < upper):
            fare = _fare(len(rooms))
            below = None if upper == np.inf else int(upper) - fare
            found = self._hunt.search(rooms, below, self.effort.limit_for(len(rooms)))
            self.effort.spend(len(rooms), found.expanded)
            entry = None if found.cost is None else Grown(found.cost + fare, len(rooms), bound, rooms)
            known = self.known[rooms] = _Known(upper, entry, found)
            if found.capped:
                self.doubt = min(self.doubt, bound)
        return known.entry


@dataclass(frozen=True)
class _Known:
    """What the search of a home came to."""

    below: float
    entry: Grown | None
    """None if the cost is not below."""
    found: Found


def _fare(rooms: int) -> int:
    return ANOTHER_ROOM * (rooms - 1)


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
