"""Exact search for the cheapest way to find a query's furniture in one room: depth first, branch and bound."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from scene_graphs.costs import CostTable, Key, Term, edge_key, node_terms
from scene_graphs.furniture import Furniture, canonical, class_of, group_of
from scene_graphs.graph import FurnitureGraph

NODE_LIMIT: Final = 100_000
"""Search nodes expanded for one room before the best mapping so far is taken, marked as not exact."""
UNMAPPED: Final = -1

Masks = list[tuple[int, int, int, list[tuple[int, int]]]]
"""Terms of one room: coefficient, mask of members, generic count, (mask, count) of the parts."""


@dataclass(frozen=True, eq=False)
class CodedRoom:
    """A room's graph as bit masks over its nodes (Python integers, so that no number of nodes is too many)."""

    nodes: tuple[Furniture, ...]
    categories: tuple[str, ...]
    offers: tuple[frozenset[str], ...]
    neighbours: tuple[int, ...]
    """For every node the mask of its neighbours."""
    masks: dict[Key, int]
    """The nodes of every category, class and group."""
    edges: dict[Key, int]
    """How many edges join each pair of groups."""

    @classmethod
    def of(cls, graph: FurnitureGraph) -> CodedRoom:
        """Code a room's graph; nodes are put in order, so that the order they were added in does not matter."""
        nodes = sorted(graph)
        number = {node: index for index, node in enumerate(nodes)}
        categories = tuple(canonical(node[0]) for node in nodes)
        masks: dict[Key, int] = defaultdict(int)
        for index, category in enumerate(categories):
            for key in _keys(category):
                masks[key] |= 1 << index
        edges: dict[Key, int] = defaultdict(int)
        for a, b in graph.edges:
            edges[edge_key(categories[number[a]], categories[number[b]])] += 1
        offers = tuple(frozenset(graph.nodes[node].get("offers", frozenset())) for node in nodes)
        neighbours = tuple(sum(1 << number[other] for other in graph[node]) for node in nodes)
        return cls(tuple(nodes), categories, offers, neighbours, dict(masks), dict(edges))

    @cached_property
    def by_category(self) -> dict[str, list[int]]:
        """The nodes of every category."""
        found: dict[str, list[int]] = defaultdict(list)
        for index, category in enumerate(self.categories):
            found[category].append(index)
        return found

    def mask(self, keys: Sequence[Key]) -> int:
        """The nodes that any of the keys names."""
        joined = 0
        for key in keys:
            joined |= self.masks.get(key, 0)
        return joined

    def count(self, keys: Sequence[Key]) -> int:
        """How many nodes, or edges, the keys name."""
        return sum(self.edges.get(key, 0) for key in keys) + self.mask(keys).bit_count()

    def base(self, costs: CostTable) -> int:
        """The cost of the room if nothing of it is used."""
        return sum(costs.of(c).insert for c in self.categories) + costs.extra_edge * sum(self.edges.values())


@dataclass(frozen=True, eq=False)
class CodedQuery:
    """A query's graph in the order in which its nodes are placed."""

    nodes: tuple[Furniture, ...]
    words: tuple[str, ...]
    needs: tuple[frozenset[str], ...]
    edges: tuple[tuple[int, int], ...]
    """Pairs of positions, the earlier first."""
    twins: tuple[int, ...]
    """For every node the last one before it that it could change places with, or -1."""
    deletes: tuple[int, ...]
    suffixes: tuple[tuple[Term, ...], ...]
    """For every position the bound's terms for the nodes from there on."""
    costs: CostTable
    strict: bool

    @classmethod
    def of(cls, graph: FurnitureGraph, costs: CostTable, strict: bool = False) -> CodedQuery:
        """Code a query: nodes with most placed neighbours first, then the dearer, then those with more edges."""
        nodes = _placing_order(graph, costs)
        number = {node: index for index, node in enumerate(nodes)}
        words = tuple(canonical(node[0]) for node in nodes)
        needs = tuple(frozenset(graph.nodes[node].get("needs", frozenset())) for node in nodes)
        pairs = sorted(sorted((number[a], number[b])) for a, b in graph.edges)
        around = [frozenset(number[other] for other in graph[node]) for node in nodes]
        twins = tuple(_twin(i, words, needs, around) for i in range(len(nodes)))
        suffixes = tuple(tuple(node_terms(words[i:], costs, strict)) for i in range(len(nodes) + 1))
        deletes = tuple(costs.of(word).delete for word in words)
        edges = tuple((a, b) for a, b in pairs)
        return cls(tuple(nodes), words, needs, edges, twins, deletes, suffixes, costs, strict)


@dataclass(frozen=True)
class Found:
    """What a search came to."""

    cost: int | None
    """None if it is proven to be at least the upper bound that was given."""
    images: tuple[int, ...]
    """The room's node for every query node, or `UNMAPPED`."""
    capped: bool
    """Whether the node limit ended the search."""


def search(query: CodedQuery, room: CodedRoom, upper: int | None = None, limit: int = NODE_LIMIT) -> Found:
    """The cheapest mapping of the query into the room that costs less than `upper`, if there is one.

    At the limit the best mapping so far is returned, at worst a greedy one.
    """
    if limit < 1:
        raise ValueError(f"the node limit must be at least 1, got {limit}")
    run = _Search(query, room, upper, limit)
    run.descend(0, run.root, (1 << len(room.nodes)) - 1)
    if run.capped and run.best_images is None:
        greedy = _Search(query, room, None, len(query.nodes) + 1)
        greedy.descend(0, greedy.root, (1 << len(room.nodes)) - 1)
        return Found(greedy.best, greedy.best_images or (), True)
    if run.best_images is None:
        return Found(None, (), run.capped)
    return Found(run.best, run.best_images, run.capped)


class _Search:
    """One depth-first search. A query node is decided at every level: given a node of the room, or left out."""

    def __init__(self, query: CodedQuery, room: CodedRoom, upper: int | None, limit: int) -> None:
        costs = query.costs
        self.query, self.room, self.limit = query, room, limit
        self.saved = costs.lost_edge + costs.extra_edge
        self.root = room.base(costs) + costs.lost_edge * len(query.edges)
        most = self.root + sum(query.deletes) + 1
        self.best = most if upper is None else upper
        self.best_images: tuple[int, ...] | None = None
        self.images = [UNMAPPED] * len(query.nodes)
        self.expanded, self.capped = 0, False
        self.options = [self._options(index) for index in range(len(query.nodes))]
        self.candidates = [sum(1 << r for _, r in options) for options in self.options]
        self.left_out = [sum(query.deletes[i:]) for i in range(len(query.nodes) + 1)]
        self.suffixes: list[Masks] = [self._masks(terms) for terms in query.suffixes]
        self.placed = [[a for a, b in query.edges if b == i] for i in range(len(query.nodes))]
        self.ahead = [
            [(a, b, a >= i and self._consistent(a, b)) for a, b in query.edges if b >= i]
            for i in range(len(query.nodes) + 1)
        ]

    def descend(self, depth: int, cost: int, free: int) -> None:
        """Decide the node at this depth, given what the nodes before it cost and which room nodes are left."""
        if self.expanded >= self.limit:
            self.capped = True
            return
        self.expanded += 1
        if depth == len(self.images):
            if cost < self.best:
                self.best, self.best_images = cost, tuple(self.images)
            return
        if cost + self._nodes_ahead(depth, free) - self.saved * self._edges_ahead(depth, free) >= self.best:
            return
        self._map(depth, cost, free)
        self.images[depth] = UNMAPPED
        self.descend(depth + 1, cost + self.query.deletes[depth], free)

    def _map(self, depth: int, cost: int, free: int) -> None:
        """Try every room node for the query node at this depth, cheapest first."""
        anchors = [self.images[a] for a in self.placed[depth] if self.images[a] != UNMAPPED]
        rest = self._nodes_ahead(depth + 1, free) - self.saved * self._edges_ahead(depth + 1, free, depth)
        twin = self.query.twins[depth]
        above = self.images[twin] if twin >= 0 else -1
        if twin >= 0 and above == UNMAPPED:
            return
        for change, r in self.options[depth]:
            if cost + change - self.saved * len(anchors) + rest >= self.best:
                break
            if r <= above or not free >> r & 1:
                continue
            kept = sum(self.room.neighbours[image] >> r & 1 for image in anchors)
            self.images[depth] = r
            self.descend(depth + 1, cost + change - self.saved * kept, free & ~(1 << r))

    def _nodes_ahead(self, depth: int, free: int) -> int:
        """At least what the undecided nodes add, edges aside, by clipped counts over the room's free nodes."""
        bound = self.left_out[depth]
        for coefficient, members, generic, parts in self.suffixes[depth]:
            wanted = generic
            for mask, number in parts:
                wanted += min(number, (mask & free).bit_count())
            bound -= coefficient * min(wanted, (members & free).bit_count())
        return bound

    def _edges_ahead(self, depth: int, free: int, deciding: int = -1) -> int:
        """At most how many undecided edges can still be kept; those of the node `deciding` may all be."""
        kept = 0
        for a, b, both_ahead in self.ahead[depth]:
            if a >= depth:
                kept += both_ahead
            elif a == deciding:
                kept += 1
            elif (image := self.images[a]) != UNMAPPED:
                kept += (self.room.neighbours[image] & self.candidates[b] & free) != 0
        return kept

    def _options(self, index: int) -> list[tuple[int, int]]:
        """(change of cost, room node) for every room node that may stand in for a query node, cheapest first."""
        query, found = self.query, []
        for category, members in self.room.by_category.items():
            cost = query.costs.substitution(query.words[index], category, query.strict)
            if cost is not None:
                change = cost - query.costs.of(category).insert
                found += [(change, r) for r in members if query.needs[index] <= self.room.offers[r]]
        return sorted(found)

    def _consistent(self, a: int, b: int) -> bool:
        """Whether any candidates of two query nodes are neighbours in the room."""
        return any(self.room.neighbours[r] & self.candidates[b] for _, r in self.options[a])

    def _masks(self, terms: Sequence[Term]) -> Masks:
        mask = self.room.mask
        return [(t.coefficient, mask(t.members), t.generic, [(mask((k,)), n) for k, n in t.parts]) for t in terms]


def _keys(category: str) -> tuple[Key, ...]:
    return ("category", category), ("class", class_of(category)), ("group", group_of(category))


def _placing_order(graph: FurnitureGraph, costs: CostTable) -> list[Furniture]:
    order: list[Furniture] = []
    left = sorted(graph)
    while left:
        best = min(
            left,
            key=lambda node: (
                -sum(other in graph[node] for other in order),
                -costs.of(node[0]).delete,
                -len(graph[node]),
                node,
            ),
        )
        order.append(best)
        left.remove(best)
    return order


def _twin(index: int, words: Sequence[str], needs: Sequence[frozenset[str]], around: Sequence[frozenset[int]]) -> int:
    """The last earlier node with the same word, needs and neighbours (each other aside); -1 if there is none."""
    for other in range(index - 1, -1, -1):
        same = words[other] == words[index] and needs[other] == needs[index]
        if same and around[other] - {index} == around[index] - {other}:
            return other
    return -1
