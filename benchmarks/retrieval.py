"""Finding a room by exact graph edit distance, against networkx' own search for the same distance in the same run."""

from __future__ import annotations

import time
from typing import Any

import networkx as nx

from benchmarks.figure import Figure
from benchmarks.stories import timed
from planner_service.stories import Studio
from scene_graphs.costs import CostTable
from scene_graphs.distance import exact_distance
from scene_graphs.graph import FurnitureGraph, graph_from_layout, graph_from_uses

USES = (
    *[("sofa", 1), ("coffee_table", 1), ("tv_stand", 1), ("sofa", 1), ("bookshelf", 1), ("armchair", 1)],
    *[("floor_lamp", 1), ("cabinet", 1), ("table", 1), ("chair", 1), ("sofa", 2)],
)
"""What a long story uses of its living room, in order: ten pieces, ten relations."""
NEEDS = [["sit"], *[["touch"]] * 2, ["lie"], ["touch"], ["sit"], *[["touch"]] * 3, ["sit"], ["sit"]]
ROOM_TYPE = "living_room"
ROOMS = 4
PATIENCE = 3.0
"""Seconds networkx gets for one room."""
REPEATS = 20
FORBIDDEN = 100_000
"""A cost that no mapping pays."""


def retrieval_figures(studio: Studio) -> list[Figure]:
    """A query over all rooms, and the same few rooms done by both."""
    query = graph_from_uses(USES, NEEDS)
    index = studio.shelves.layouts()
    _, all_rooms = timed(lambda: [index.search(query, 5, ROOM_TYPE) for _ in range(REPEATS)])
    rooms = [layout for layout in index.layouts if layout.room_type == ROOM_TYPE]
    by_size = sorted(rooms, key=lambda layout: (len(layout.objects), layout.id))
    few = [by_size[round(share * (len(by_size) - 1) / (ROOMS - 1))] for share in range(ROOMS)]
    graphs = [graph_from_layout(layout) for layout in few]
    exact, ours = timed(lambda: [exact_distance(query, room) for room in graphs])
    baseline = [_by_networkx(query, room) for room in graphs]
    theirs = sum(seconds for _, seconds in baseline)
    costs = [(match.cost, cost) for match, (cost, _) in zip(exact, baseline, strict=True)]
    if any(cost > other for cost, other in costs):
        raise AssertionError(f"networkx finds a smaller distance than the exact one: {costs}")
    sizes = f"{min(map(len, graphs))}–{max(map(len, graphs))}"
    same = f"same distance in {sum(cost == other for cost, other in costs)} of {ROOMS}, else dearer"
    told = f"{ROOMS} rooms of {sizes} objects: {1000 * ours:.1f} ms to {1000 * theirs:.0f} ms; {same}"
    return [
        Figure("retrieval, 5 nearest rooms", 1000 * all_rooms / REPEATS, "ms", note=f"of {len(rooms)} living rooms"),
        Figure("against networkx.graph_edit_distance", theirs / ours, "×", note=told, digits=0),
    ]


def _by_networkx(query: FurnitureGraph, room: FurnitureGraph) -> tuple[float, float]:
    """The distance networkx ends with, which is not always the least, and its seconds."""
    costs = CostTable()

    def substitute(asked: dict[str, Any], there: dict[str, Any]) -> float:
        cost = costs.substitution(asked["category"], there["category"])
        if cost is None or not asked["needs"] <= there["offers"]:
            return FORBIDDEN
        return cost

    started = time.perf_counter()
    cost = nx.graph_edit_distance(
        _with_categories(query),
        _with_categories(room),
        node_subst_cost=substitute,
        node_del_cost=lambda asked: costs.of(asked["category"]).delete,
        node_ins_cost=lambda there: costs.of(there["category"]).insert,
        edge_del_cost=lambda _: costs.lost_edge,
        edge_ins_cost=lambda _: costs.extra_edge,
        timeout=PATIENCE,
    )
    return float(cost), time.perf_counter() - started


def _with_categories(graph: FurnitureGraph) -> FurnitureGraph:
    """A copy whose nodes carry their category as an attribute, which is all that networkx shows to a cost."""
    copy = graph.copy()
    nx.set_node_attributes(copy, {node: node.category for node in graph}, "category")
    return copy
