"""Furniture as graphs: "nodes represent furniture items", edges what belongs or stands together (SIMS 3.2)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import networkx as nx
import numpy as np
import shapely

from scene_graphs.affordances.affordances import spots
from scene_graphs.boxes import Part
from scene_graphs.furniture import Furniture, affordances, canonical, class_of, is_known, is_minor
from scene_graphs.layout import NEAR, Layout, Placed, Point3

if TYPE_CHECKING:
    FurnitureGraph: TypeAlias = nx.Graph[Furniture]
else:
    FurnitureGraph = nx.Graph
"""Undirected and unweighted. Nodes are `Furniture`; every node has

    needs      frozenset of affordances a script wants there (in a room: empty)
    offers     frozenset of affordances it has (in a script: empty)
    object_id  id of the room's object (in a script: None)
    minor      whether it is a less important node
"""

FLOOR: Final = "floor"
_OUT_OF_REACH: Final = 1.5
"""Objects whose underside is higher offer nothing, in metres."""
_TOUCHING: Final = 0.02
_HARDLY: Final = 1e-6
_LINES: Final = 1000
"""Lines between objects that are looked at together: what stands on them is a list of up to as many times objects."""
_MEASURED: Final = ("seat", "sofa", "bed")


def graph_from_uses(uses: Sequence[tuple[str, int]], needs: Sequence[Iterable[str]] = ()) -> FurnitureGraph:
    """The graph of the furniture a script uses, in order: an edge joins two pieces used one right after the other.

    `needs` are the affordances each use asks for (none if left out). The floor is no node; a use of it in between
    parts its neighbours. Words are made canonical, so ("couch", 1) and ("sofa", 1) are one piece.
    """
    if needs and len(needs) != len(uses):
        raise ValueError(f"needs must have one entry a use, got {len(needs)} for {len(uses)} uses")
    graph: FurnitureGraph = nx.Graph()
    nodes = [Furniture(canonical(word), instance) for word, instance in uses]
    for node, need in zip(nodes, needs or [()] * len(nodes), strict=True):
        if node.category != FLOOR:
            _add(graph, node, graph.nodes[node]["needs"] | frozenset(need) if node in graph else frozenset(need))
    for first, second in pairwise(nodes):
        if FLOOR not in (first.category, second.category) and first != second:
            graph.add_edge(first, second)
    return graph


def put_beside(graph: FurnitureGraph, node: Furniture, other: Furniture) -> None:
    """Join two pieces by an edge; the other one comes in, wanted for nothing, where the graph has none."""
    if other not in graph:
        _add(graph, other, frozenset())
    graph.add_edge(node, other)


def graph_from_parts(
    nodes: Sequence[Furniture], edges: Iterable[tuple[int, int]], needs: Sequence[Iterable[str]] = ()
) -> FurnitureGraph:
    """The graph of pieces and of pairs of places among them; `needs` are those of each piece (none if left out)."""
    graph: FurnitureGraph = nx.Graph()
    for node, need in zip(nodes, needs or [()] * len(nodes), strict=True):
        _add(graph, node, frozenset(need))
    graph.add_edges_from((nodes[first], nodes[second]) for first, second in edges)
    return graph


def graph_from_layout(layout: Layout) -> FurnitureGraph:
    """The graph of a room: an edge joins objects within `NEAR` of each other "and not obstructed by other items".

    Instances are counted in the layout's order. Small unknown things standing on others are left out.
    """
    return graph_from_objects(layout.objects)


def graph_from_objects(objects: Iterable[Placed]) -> FurnitureGraph:
    """The graph of objects that stand in one room."""
    graph: FurnitureGraph = nx.Graph()
    shown = [placed for placed in objects if placed.parent is None or is_known(placed.category)]
    counts: Counter[str] = Counter()
    nodes = []
    for placed in shown:
        category = canonical(placed.category)
        counts[category] += 1
        nodes.append(Furniture(category, counts[category]))
        _add(graph, nodes[-1], frozenset(), offers(placed), placed.id)
    for i, j in _neighbours(shown):
        graph.add_edge(nodes[i], nodes[j])
    return graph


def offers(placed: Placed) -> frozenset[str]:
    """What a body can do at an object: its category's affordances, sitting and lying measured from its shape."""
    if placed.position[1] > _OUT_OF_REACH:
        return frozenset()
    category = canonical(placed.category)
    if class_of(category) not in _MEASURED:
        return affordances(category)
    return _measured(category, placed.size, placed.shape)


def graph_to_dict(graph: FurnitureGraph) -> dict[str, Any]:
    """Nodes as [category, instance] and edges between their places in the list; what else a node knows is left out."""
    nodes = sorted(graph)
    numbers = {node: number for number, node in enumerate(nodes)}
    edges = sorted(sorted((numbers[a], numbers[b])) for a, b in graph.edges)
    return {"nodes": [[node.category, node.instance] for node in nodes], "edges": edges}


def graph_from_dict(row: Mapping[str, Any]) -> FurnitureGraph:
    """The graph that `graph_to_dict` wrote."""
    return graph_from_parts([Furniture(*node) for node in row["nodes"]], [(a, b) for a, b in row["edges"]])


def needs_of(graph: FurnitureGraph, node: Furniture) -> frozenset[str]:
    """The affordances a script wants at a node."""
    needs: frozenset[str] = graph.nodes[node].get("needs", frozenset())
    return needs


@lru_cache(maxsize=8192)
def _measured(category: str, size: Point3, shape: tuple[Part, ...]) -> frozenset[str]:
    alone = Placed(category, category, (0.0, 0.0, 0.0), size, shape=shape)
    may_lie = class_of(category) != "seat" or category == "bench"
    asked = ("sit", "lie") if may_lie else ("sit",)
    return frozenset(affordance for affordance in asked if spots(alone, affordance)) | {"touch"}


def _add(
    graph: FurnitureGraph,
    node: Furniture,
    needs: frozenset[str],
    offered: frozenset[str] = frozenset(),
    object_id: str | None = None,
) -> None:
    graph.add_node(node, needs=needs, offers=offered, object_id=object_id, minor=is_minor(node.category))


def _neighbours(objects: Sequence[Placed]) -> list[tuple[int, int]]:
    """Pairs of objects that stand near each other with no third key object between them."""
    prints = np.array([shapely.Polygon(placed.footprint) for placed in objects], dtype=object)
    near = shapely.STRtree(prints).query(prints, predicate="dwithin", distance=NEAR + _HARDLY)
    pairs = near.T[near[0] < near[1]]
    lines = shapely.shortest_line(prints[pairs[:, 0]], prints[pairs[:, 1]])
    within = shapely.length(lines) <= NEAR
    pairs, lines = pairs[within], lines[within]
    # Shrunk, so that touching a corner is no obstruction; a key object is solid furniture that stands on the floor.
    solid = [
        number
        for number, placed in enumerate(objects)
        if not is_minor(placed.category) and placed.parent is None and placed.position[1] < _OUT_OF_REACH
    ]
    tree = shapely.STRtree(shapely.buffer(prints[solid], -_TOUCHING))
    blocked = np.zeros(len(pairs), dtype=bool)
    for start in range(0, len(pairs), _LINES):
        line, place = tree.query(lines[start : start + _LINES], predicate="intersects")
        third = (np.array(solid, dtype=np.intp)[place, None] != pairs[start + line]).all(axis=1)
        blocked[start + line[third]] = True
    return [(int(i), int(j)) for i, j in sorted(map(tuple, pairs[~blocked]))]
