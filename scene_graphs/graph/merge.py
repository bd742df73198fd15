"""One graph for many scripts: node categorization, edge integration, greedy node consolidation (SIMS 3.2)."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, permutations, product
from math import perm, prod
from typing import Final, Literal

import networkx as nx

from scene_graphs.furniture import Furniture, canonical, is_minor
from scene_graphs.graph.furniture_graph import FurnitureGraph, needs_of

Instances = dict[Furniture, Furniture]
_ALL_TRIED: Final = 5040
"""Renamings of one script that are all tried; beyond, categories are aligned one after the other."""


@dataclass(frozen=True, eq=False)
class Merged:
    """The graph of all scripts, and where every script's own pieces went in it."""

    graph: FurnitureGraph
    instance_maps: tuple[Instances, ...]
    """One a script: its nodes to nodes of `graph`; injective, and every relation of the script is one of `graph`."""


def merge(graphs: Sequence[FurnitureGraph], method: Literal["canonical", "aligned"] = "canonical") -> Merged:
    """Merge script graphs into one with, for every category, as many instances as the script that uses most.

    "canonical" numbers each script's pieces in their order and unites the edges, as in the paper: the order of the
    scripts does not matter, nor how they are grouped. "aligned" renames each script's instances so that it reuses most
    edges: fewer relations are invented, but merge all scripts at once, never a result with one more.
    """
    if method not in ("canonical", "aligned"):
        raise ValueError(f"method must be canonical or aligned, got {method!r}")
    first = [categorised(graph) for graph in graphs]
    renamed = [nx.relabel_nodes(graph, names) for graph, names in zip(graphs, first, strict=True)]
    second = _align(renamed) if method == "aligned" else [{node: node for node in graph} for graph in renamed]
    merged: FurnitureGraph = nx.Graph()
    for graph, names in zip(renamed, second, strict=True):
        _integrate(merged, graph, names)
    maps = tuple(
        {old: names[middle] for old, middle in numbers.items()} for numbers, names in zip(first, second, strict=True)
    )
    return Merged(merged, maps)


def side_by_side(rooms: Mapping[int, FurnitureGraph]) -> FurnitureGraph:
    """The graphs of a home's rooms, by their numbers, as one: relations never cross a wall.

    Instances are counted on from room to room, and objects have the ids they have in a home, "room number/object id".
    """
    union: FurnitureGraph = nx.Graph()
    counts: Counter[str] = Counter()
    for room, graph in rooms.items():
        names = {node: Furniture(node[0], node[1] + counts[node[0]]) for node in graph}
        for node, data in graph.nodes(data=True):
            union.add_node(names[node], **data | {"object_id": f"{room}/{data.get('object_id')}"})
        union.add_edges_from((names[a], names[b]) for a, b in graph.edges)
        for category, instance in graph:
            counts[category] = max(counts[category], names[Furniture(category, instance)].instance)
    return union


def categorised(graph: FurnitureGraph) -> Instances:
    """New names of a script's nodes: the canonical category, instances 1..n in the order of the old ones."""
    by_category: dict[str, list[Furniture]] = defaultdict(list)
    for node in graph:
        by_category[canonical(node[0])].append(node)
    return {
        old: Furniture(category, number)
        for category, nodes in by_category.items()
        for number, old in enumerate(sorted(nodes, key=lambda node: (node[1], node[0])), start=1)
    }


def _integrate(merged: FurnitureGraph, graph: FurnitureGraph, names: Mapping[Furniture, Furniture]) -> None:
    """Add a script's nodes and edges under their new names; needs are united, and nothing is joined to itself."""
    for node in sorted(graph):
        new = names[node]
        needs = needs_of(graph, node) | (needs_of(merged, new) if new in merged else frozenset())
        merged.add_node(new, needs=needs, offers=frozenset(), object_id=None, minor=is_minor(new.category))
    merged.add_edges_from(sorted((names[a], names[b]) for a, b in graph.edges if a != b))


def _align(graphs: Sequence[FurnitureGraph]) -> list[Instances]:
    """For each script the renaming of its instances that reuses most edges, largest script first."""
    merged: FurnitureGraph = nx.Graph()
    chosen: list[Instances] = [{} for _ in graphs]
    for index in sorted(range(len(graphs)), key=lambda i: _order(graphs[i])):
        chosen[index] = _best_renaming(graphs[index], merged)
        _integrate(merged, graphs[index], chosen[index])
    return chosen


def _order(graph: FurnitureGraph) -> tuple[object, ...]:
    """Sort key that depends on what a graph is and not on where it stands: larger graphs first."""
    edges = sorted(tuple(sorted(edge)) for edge in graph.edges)
    needs = [(node, tuple(sorted(needs_of(graph, node)))) for node in sorted(graph)]
    return -len(graph), -len(edges), needs, edges


def _best_renaming(graph: FurnitureGraph, merged: FurnitureGraph) -> Instances:
    categories = sorted({node.category for node in graph})
    own = {c: sorted(node for node in graph if node.category == c) for c in categories}
    slots = {c: max(len(own[c]), sum(node.category == c for node in merged)) for c in categories}
    if prod(perm(slots[c], len(own[c])) for c in categories) <= _ALL_TRIED:
        parts = [list(_renamings(own[c], slots[c])) for c in categories]
        renamings: Iterator[Instances] = (_union(choice) for choice in product(*parts))
        return max(renamings, key=lambda names: _reused(graph, merged, names))
    # The names as they are count too, so that aligning never invents more edges than not aligning.
    unchanged: Instances = {node: node for node in graph}
    best = dict(unchanged)
    for c in categories:
        options = ({**best, **names} for names in islice(_renamings(own[c], slots[c]), _ALL_TRIED))
        best = max(options, key=lambda names: _reused(graph, merged, names))
    return max((unchanged, best), key=lambda names: _reused(graph, merged, names))


def _renamings(nodes: Sequence[Furniture], slots: int) -> Iterator[Instances]:
    """All ways to give the instances of one category different numbers up to `slots`, the present one first."""
    for numbers in permutations(range(1, slots + 1), len(nodes)):
        yield {node: Furniture(node.category, number) for node, number in zip(nodes, numbers, strict=True)}


def _union(parts: Sequence[Instances]) -> Instances:
    return {old: new for part in parts for old, new in part.items()}


def _reused(graph: FurnitureGraph, merged: FurnitureGraph, names: Instances) -> int:
    return sum(merged.has_edge(names[a], names[b]) for a, b in graph.edges)
