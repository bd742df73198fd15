"""The simplified graph edit distance of SIMS 3.2: what a room lacks, replaces and adds for a script's furniture.

    d(Q -> R) = min over partial injections f, inside groups, of
                sub(mapped) + delete(unmapped) + insert(room nodes not hit)
                + lost_edge * query edges not kept + extra_edge * room edges without a query edge

It is a hemimetric: 0 from a graph to itself, a triangle inequality, not symmetric.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scene_graphs.furniture import Furniture, canonical
from scene_graphs.graph.branch_and_bound import NODE_LIMIT, UNMAPPED, CodedQuery, Hunt
from scene_graphs.graph.furniture_graph import FurnitureGraph
from scene_graphs.graph.packed_graphs import PackedRooms
from scene_graphs.graph.substitution_costs import CostTable, GroupCosts, Level, level_between

__all__ = ["CostTable", "GroupCosts", "Level", "Match", "Pair", "check_size", "exact_distance", "lower_bound"]

MAX_NODES = 52
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
    """A distance that `exact_distance` never falls below; equal to it without edges and needs. ValueError as there."""
    check_size(query)
    return int(Hunt(CodedQuery.of(query, costs or CostTable(), strict), PackedRooms.of([room])).bounds()[0])


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
    the query has more than 52 nodes, or a node of either is joined with itself.
    """
    check_size(query)
    hunt = Hunt(CodedQuery.of(query, costs or CostTable(), strict), PackedRooms.of([room]))
    found = hunt.search([0], limit=limit)
    if found.cost is None:
        raise AssertionError("a search without an upper bound ends with a mapping")
    pairs, missing, extra = _pairs(hunt.query, sorted(room), found.images)
    return Match(found.cost, not found.capped, int(hunt.bounds()[0]), pairs, missing, extra)


def check_size(query: FurnitureGraph) -> None:
    """ValueError if a query is too large to be searched for."""
    if len(query) > MAX_NODES:
        raise ValueError(f"a query may have at most {MAX_NODES} pieces of furniture, got {len(query)}; split it")


def _pairs(
    query: CodedQuery, nodes: Sequence[Furniture], images: tuple[int, ...]
) -> tuple[tuple[Pair, ...], tuple[Furniture, ...], tuple[Furniture, ...]]:
    """The pairs of a mapping, the query nodes it misses and the room nodes it leaves over."""
    pairs, missing = [], []
    for node, word, image in zip(query.nodes, query.words, images, strict=True):
        if image == UNMAPPED:
            missing.append(node)
            continue
        level = level_between(word, canonical(nodes[image][0]))
        if level is None:
            raise AssertionError("nothing is mapped across groups")
        pairs.append(Pair(node, nodes[image], level))
    extra = tuple(node for index, node in enumerate(nodes) if index not in images)
    return tuple(sorted(pairs, key=lambda pair: pair.query)), tuple(sorted(missing)), extra
