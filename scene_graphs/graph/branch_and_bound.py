"""Exact search for the cheapest way to find a query's furniture in a room: a query is put in order, laid out for a set
of packed rooms, and searched for by `branch_and_bound_kernel`, depth first, branch and bound."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from scene_graphs.furniture import Furniture, canonical
from scene_graphs.graph.count_table import Counts
from scene_graphs.graph.furniture_graph import FurnitureGraph
from scene_graphs.graph.packed_graphs import (
    FAR,
    LEVELS,
    Ints,
    PackedRooms,
    flags,
    levels,
    refuse_loops,
    vocabulary,
)
from scene_graphs.graph.substitution_costs import CostTable, Key, Term, edge_terms, node_terms

if TYPE_CHECKING:
    from scene_graphs.graph import branch_and_bound_kernel

NODE_LIMIT: Final = 100_000
"""Search nodes expanded for one room before the best mapping so far is taken, marked as not exact."""
EFFORT: Final = 20 * NODE_LIMIT
"""Search nodes expanded for all rooms of one search; rooms left after that get the first mapping there is."""
UNMAPPED: Final = -1
Costs = NDArray[np.int32]
_SLOTS: Final = {"part": 0, "category": 1, "kind": 1, "class": 2, "group": 3}
"""A room's node is counted at most once as each."""
_NOTHING: Final = np.empty(0, dtype=np.int64)


@dataclass(frozen=True, eq=False)
class CodedQuery:
    """A query's graph in the order in which its nodes are placed."""

    nodes: tuple[Furniture, ...]
    words: tuple[str, ...]
    needs: tuple[frozenset[str], ...]
    edges: tuple[tuple[int, int], ...]
    """Pairs of positions, the earlier first, in the order of the later."""
    twins: tuple[int, ...]
    """For every node the last one before it that it could change places with, or -1."""
    deletes: tuple[int, ...]
    costs: CostTable
    strict: bool

    @classmethod
    def of(cls, graph: FurnitureGraph, costs: CostTable, strict: bool = False) -> CodedQuery:
        """Code a query: nodes with most placed neighbours first, then the dearer, then those with more edges.

        ValueError if a node is joined with itself.
        """
        refuse_loops(graph)
        nodes = _placing_order(graph, costs)
        number = {node: index for index, node in enumerate(nodes)}
        words = tuple(canonical(node[0]) for node in nodes)
        needs = tuple(frozenset(graph.nodes[node].get("needs", ())) for node in nodes)
        around = [frozenset(number[other] for other in graph.adj[node]) for node in nodes]
        edges = tuple((a, b) for b in range(len(nodes)) for a in sorted(around[b]) if a < b)
        twins = tuple(_twin(i, words, needs, around) for i in range(len(nodes)))
        return cls(tuple(nodes), words, needs, edges, twins, tuple(costs.of(w).delete for w in words), costs, strict)

    @cached_property
    def node_terms(self) -> list[Term]:
        """The terms of the bound that nodes make, those that the last nodes ask for first."""
        return sorted(node_terms(self.words, self.costs, self.strict), key=lambda term: -term.last)

    @cached_property
    def edge_terms(self) -> list[Term]:
        """The terms of the bound that edges make."""
        return edge_terms([(self.words[a], self.words[b]) for a, b in self.edges], self.costs)


@dataclass(frozen=True)
class Found:
    """What a search came to."""

    cost: int | None
    """None if it is proven to be at least the upper bound that was given."""
    images: tuple[int, ...]
    """For every query node the place of its image among the nodes of all rooms searched, or `UNMAPPED`."""
    capped: bool
    """Whether the node limit ended the search."""
    expanded: int = 0
    """Search nodes, where that was counted."""


class Ranked(NamedTuple):
    """A room that was found."""

    cost: int
    bound: int
    number: int
    found: Found


class Hunt:
    """A query laid out for a set of rooms; the rooms' `counts` and `bases` are made here unless they are there."""

    def __init__(
        self, query: CodedQuery, rooms: PackedRooms, counts: Counts | None = None, bases: Costs | None = None
    ) -> None:
        self.query, self.rooms = query, rooms
        self.counts = counts or Counts(rooms)
        self.bases = rooms.bases(query.costs) if bases is None else bases
        self._arrays = _rooms_of(rooms)
        self._asked, self._rare = _laid_out(query, rooms, self.counts)

    def bounds(self) -> Costs:
        """The lower bound of every room. (rooms,)."""
        from scene_graphs.graph import branch_and_bound_kernel

        return branch_and_bound_kernel.bounds_of(self._asked, self.counts.table, self._rare, self.bases)

    def search(self, numbers: Sequence[int], upper: int | None = None, limit: int = NODE_LIMIT) -> Found:
        """The cheapest mapping into rooms side by side that costs less than `upper`, if there is one.

        At the limit the best mapping so far is returned, at worst the first that the search comes to.
        """
        from scene_graphs.graph import branch_and_bound_kernel

        if limit < 1:
            raise ValueError(f"the node limit must be at least 1, got {limit}")
        images = np.empty(len(self.query.nodes), dtype=np.int64)
        chosen = np.array(numbers, dtype=np.int64)
        most = branch_and_bound_kernel.ENDLESS if upper is None else upper
        base = int(self.bases[chosen].sum())
        cost, expanded, capped = branch_and_bound_kernel.search(
            self._asked, self._arrays, chosen, base, most, limit, images
        )
        if cost == branch_and_bound_kernel.NONE:
            return Found(None, (), bool(capped), int(expanded))
        return Found(int(cost), tuple(images.tolist()), bool(capped), int(expanded))

    def nearest(
        self, among: NDArray[np.uint8], k: int, first_stage: int, limit: int = NODE_LIMIT, effort: int = EFFORT
    ) -> tuple[list[Ranked], int]:
        """The k best of the rooms that are not 0 in `among`, and the least bound of one whose search a limit ended."""
        from scene_graphs.graph import branch_and_bound_kernel

        best, doubtful = branch_and_bound_kernel.nearest(
            self._asked, self._arrays, self.bases, self.bounds(), among, k, first_stage, limit, effort
        )
        cost, bound, place, capped, images = (array.tolist() for array in best)
        found = [
            Ranked(cost[i], bound[i], place[i], Found(cost[i], tuple(images[i]), capped[i]))
            for i in range(k)
            if place[i] != UNMAPPED
        ]
        return found, int(doubtful)


def _rooms_of(rooms: PackedRooms) -> branch_and_bound_kernel.Rooms:
    from scene_graphs.graph import branch_and_bound_kernel

    return branch_and_bound_kernel.Rooms(
        rooms.categories, rooms.offers, rooms.node_starts, rooms.neighbours, rooms.neighbour_starts
    )


def _laid_out(
    query: CodedQuery, rooms: PackedRooms, counts: Counts
) -> tuple[branch_and_bound_kernel.Asked, NDArray[np.uint8]]:
    """The arrays of a query for these rooms, and the counts that only it asks for."""
    from scene_graphs.graph import branch_and_bound_kernel

    size, costs, terms = len(query.nodes), query.costs, query.node_terms
    number, counts_of = vocabulary().number, vocabulary().counts
    known = len(number)
    parts = [part for term in terms for part in term.parts]
    keys: list[Key] = [term.key for term in terms] + [key for key, _ in parts]
    rare = {word: place for word in query.words if (place := rooms.number_of(word)) >= known}
    code_of = {word: known + 1 + place for place, word in enumerate(rare)}
    level = np.full((size, known + 1 + len(rare)), FAR, dtype=np.uint8)
    for place, word in enumerate(query.words):
        if word in number:
            level[place, :known] = levels()[number[word]]
        elif word in rare:
            level[place, code_of[word]] = 0
    counters = np.full((level.shape[1], 1 + max(_SLOTS.values())), -1, dtype=np.int64)
    for counter, key in enumerate(keys):
        slot = _SLOTS[key[0]] if counter < len(terms) else _SLOTS["part"]
        counters[code_of[key[1]] if key[1] in rare else counts_of.get(key, _NOTHING), slot] = counter
    rows, rare_counts = _rows([*keys, *(term.key for term in query.edge_terms)], counts)
    last = [term.last for term in terms]
    own = [costs.of(word) for word in query.words]
    seconds = [b for _, b in query.edges]
    asked = branch_and_bound_kernel.Asked(
        rare=_ints(rare.values()),
        known=known,
        level=level,
        change=_ints(cost - c.insert for c in own for cost in (0, c.sub_class, c.sub_group)).reshape(size, len(LEVELS)),
        most_level=1 if query.strict else len(LEVELS),
        needs=np.array([flags(needs) for needs in query.needs], dtype=np.uint8),
        delete=_ints(query.deletes),
        twin=_ints(query.twins),
        first=_ints(a for a, _ in query.edges),
        second=_ints(seconds),
        edge_starts=_ints(bisect_left(seconds, depth) for depth in range(size + 1)),
        lost=costs.lost_edge,
        saved=costs.lost_edge + costs.extra_edge,
        coefficient=_ints(term.coefficient for term in terms),
        live=_ints(sum(place >= depth for place in last) for depth in range(size + 1)),
        asked=_asked_from([term.places for term in terms], size),
        part_starts=_ints(accumulate((len(term.parts) for term in terms), initial=0)),
        part_asked=_asked_from([places for _, places in parts], size),
        counters=counters,
        rows=rows[: len(keys)],
        edge_rows=rows[len(keys) :],
        edge_asked=_ints(len(term.places) for term in query.edge_terms),
    )
    return asked, rare_counts


def _ints(values: Iterable[int]) -> Ints:
    return np.array(list(values), dtype=np.int64)


def _rows(keys: Sequence[Key], counts: Counts) -> tuple[Ints, NDArray[np.uint8]]:
    """The row of each key: in the table of counts, or after it in one that is made here."""
    counted = vocabulary().counted
    rare = list(dict.fromkeys(key for key in keys if key not in counted))
    row_of = {key: len(counted) + place for place, key in enumerate(rare)}
    rows = np.array([row_of[key] if key in row_of else counted[key] for key in keys], dtype=np.int64)
    made = np.zeros((len(rare), counts.table.shape[1]), dtype=np.uint8)
    for place, key in enumerate(rare):
        made[place] = counts.rare(key)
    return rows, made


def _asked_from(columns: Sequence[Sequence[int]], size: int) -> Ints:
    """How many of each list of positions are at a position or later. (size + 1, columns)."""
    places = [place * len(columns) + column for column, own in enumerate(columns) for place in own]
    there = np.bincount(_ints(places), minlength=(size + 1) * len(columns)).reshape(size + 1, len(columns))
    return np.ascontiguousarray(np.cumsum(there[::-1], axis=0)[::-1])


def _placing_order(graph: FurnitureGraph, costs: CostTable) -> list[Furniture]:
    placed = dict.fromkeys(graph, 0)
    rank = {node: (-costs.of(node[0]).delete, -len(graph.adj[node]), node) for node in graph}
    order: list[Furniture] = []
    while placed:
        order.append(min(placed, key=lambda node: (-placed[node], rank[node])))
        del placed[order[-1]]
        for other in graph.adj[order[-1]]:
            if other in placed:
                placed[other] += 1
    return order


def _twin(index: int, words: Sequence[str], needs: Sequence[frozenset[str]], around: Sequence[frozenset[int]]) -> int:
    """The last earlier node with the same word, needs and neighbours (each other aside); -1 if there is none."""
    for other in range(index - 1, -1, -1):
        same = words[other] == words[index] and needs[other] == needs[index]
        if same and around[other] - {index} == around[index] - {other}:
            return other
    return -1
