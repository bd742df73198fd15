"""The simplified graph edit distance of SIMS 3.2: what a room lacks, replaces and adds for a script's furniture.

    d(Q -> R) = min over partial injections f, inside groups, of
                sub(mapped) + delete(unmapped) + insert(room nodes not hit)
                + lost_edge * query edges not kept + extra_edge * room edges without a query edge

It is a hemimetric: 0 from a graph to itself, a triangle inequality, not symmetric.
"""

from __future__ import annotations

from dataclasses import dataclass

from scene_graphs.branching import NODE_LIMIT, UNMAPPED, CodedQuery, CodedRoom, search
from scene_graphs.costs import CostTable, GroupCosts, Level, Term, edge_terms, level_between, node_terms
from scene_graphs.furniture import Furniture
from scene_graphs.graph import FurnitureGraph

__all__ = ["CostTable", "GroupCosts", "Level", "Match", "Pair", "exact_distance", "lower_bound", "pairs_of"]

MOST_NODES = 52
"""A query with more nodes is refused: no script uses that much furniture, and the search would not end."""


@dataclass(frozen=True)
class Pair:
    """A query node, the room node that stands in for it, and how near the two are."""

    query: Furniture
    room: Furniture
    level: Level


@dataclass(frozen=True)
class Match:
    """The cheapest mapping of a query into a room."""

    cost: int
    exact: bool
    """False if the node limit was met: the cost is then an upper bound."""
    lower_bound: int
    pairs: tuple[Pair, ...]
    missing: tuple[Furniture, ...]
    """Query nodes nothing in the room stands in for."""
    extra: tuple[Furniture, ...]
    """Room nodes the query does not use."""


def lower_bound(
    query: FurnitureGraph, room: FurnitureGraph, costs: CostTable | None = None, *, strict: bool = False
) -> int:
    """A distance that `exact_distance` never falls below; equal to it without edges and needs."""
    table = costs or CostTable()
    return bound_of(CodedQuery.of(query, table, strict), CodedRoom.of(room))


def exact_distance(
    query: FurnitureGraph,
    room: FurnitureGraph,
    costs: CostTable | None = None,
    *,
    strict: bool = False,
    limit: int = NODE_LIMIT,
) -> Match:
    """The distance from a query to a room, and the mapping that attains it.

    A query node is only mapped to a room node that offers what it needs. `strict` forbids substitutions. ValueError if
    the query has more than 52 nodes.
    """
    check_size(query)
    coded, coded_room = CodedQuery.of(query, costs or CostTable(), strict), CodedRoom.of(room)
    found = search(coded, coded_room, None, limit)
    if found.cost is None:
        raise AssertionError("a search without an upper bound ends with a mapping")
    pairs, missing, extra = pairs_of(coded, coded_room, found.images)
    return Match(found.cost, not found.capped, bound_of(coded, coded_room), pairs, missing, extra)


def check_size(query: FurnitureGraph) -> None:
    """ValueError if a query is too large to be searched for."""
    if len(query) > MOST_NODES:
        raise ValueError(f"a query may have at most {MOST_NODES} pieces of furniture, got {len(query)}; split it")


def all_terms(query: CodedQuery) -> list[Term]:
    """The terms of the bound on the whole distance: nodes and edges."""
    words = query.words
    edges = [(words[a], words[b]) for a, b in query.edges]
    return node_terms(words, query.costs, query.strict) + edge_terms(edges, query.costs)


def bound_of(query: CodedQuery, room: CodedRoom) -> int:
    """The lower bound for one room."""
    constant = sum(query.deletes) + query.costs.lost_edge * len(query.edges)
    saved = int(sum(term.saved(room.count, min) for term in all_terms(query)))
    return room.base(query.costs) + constant - saved


def pairs_of(
    query: CodedQuery, room: CodedRoom, images: tuple[int, ...]
) -> tuple[tuple[Pair, ...], tuple[Furniture, ...], tuple[Furniture, ...]]:
    """The pairs of a mapping, the query nodes it misses and the room nodes it leaves over."""
    pairs, missing = [], []
    for node, word, image in zip(query.nodes, query.words, images, strict=True):
        if image == UNMAPPED:
            missing.append(node)
            continue
        level = level_between(word, room.categories[image])
        if level is None:
            raise AssertionError("nothing is mapped across groups")
        pairs.append(Pair(node, room.nodes[image], level))
    extra = tuple(node for index, node in enumerate(room.nodes) if index not in images)
    return tuple(sorted(pairs, key=lambda pair: pair.query)), tuple(sorted(missing)), extra
