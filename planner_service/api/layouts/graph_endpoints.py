"""Layout graphs: the furniture of several scripts merged into one graph, by which a room is then looked for."""

from __future__ import annotations

from typing import Final

from fastapi import APIRouter

from planner_service.api.errors import Unprocessable
from planner_service.api.layouts.schemas import GraphAsk, MergeAsk, Merged
from scene_graphs.furniture import Furniture, is_minor
from scene_graphs.graph.furniture_graph import FurnitureGraph, graph_from_parts, needs_of
from scene_graphs.graph.merge import merge
from scene_graphs.json_fields import Json

layout_graphs_router = APIRouter(prefix="/v1/layout-graphs", tags=["layout graphs"])
MAX_EDGES: Final = 300
"""Of all graphs together: aligning tries thousands of renamings on each."""


@layout_graphs_router.post("/merge", response_model=Merged)
def merge_graphs(ask: MergeAsk) -> Json:
    """Merge the graphs of scripts: of every category as many pieces as the script has that uses most (SIMS 3.2)."""
    if sum(len(graph.edges) for graph in ask.graphs) > MAX_EDGES:
        raise Unprocessable("/graphs", f"at most {MAX_EDGES} edges in all graphs together")
    graphs = [graph_of(graph, f"/graphs/{number}") for number, graph in enumerate(ask.graphs)]
    merged = merge(graphs, ask.method)
    nodes = sorted(merged.graph)
    places = {node: place for place, node in enumerate(nodes)}
    shown = [
        {
            "category": node.category,
            "instance": node.instance,
            "needs": sorted(needs_of(merged.graph, node)),
            "minor": is_minor(node.category),
        }
        for node in nodes
    ]
    maps = [
        [places[names[node]] for node in nodes_of(graph)]
        for graph, names in zip(ask.graphs, merged.instance_maps, strict=True)
    ]
    return {"graph": {"nodes": shown, "edges": edges_of(merged.graph, places)}, "instance_maps": maps}


def nodes_of(ask: GraphAsk) -> list[Furniture]:
    """The pieces of a graph as they were sent."""
    return [Furniture(node.category, node.instance) for node in ask.nodes]


def graph_of(ask: GraphAsk, pointer: str) -> FurnitureGraph:
    """The graph that was sent. Unprocessable names a piece that occurs twice or an edge that leads nowhere."""
    nodes = nodes_of(ask)
    known: dict[Furniture, int] = {}
    for place, node in enumerate(nodes):
        if not node.category.strip() or not node.category.isprintable():
            raise Unprocessable(f"{pointer}/nodes/{place}/category", "a furniture word in printable letters")
        if known.setdefault(node, place) != place:
            twice = f"the same piece as node {known[node]}; give it another instance number"
            raise Unprocessable(f"{pointer}/nodes/{place}", twice)
    for place, (first, second) in enumerate(ask.edges):
        if first == second or max(first, second) >= len(nodes):
            wrong = f"must be two different places below {len(nodes)} in nodes"
            raise Unprocessable(f"{pointer}/edges/{place}", wrong)
    return graph_from_parts(nodes, [(first, second) for first, second in ask.edges], [node.needs for node in ask.nodes])


def edges_of(graph: FurnitureGraph, places: dict[Furniture, int]) -> list[tuple[int, int]]:
    """Edges as pairs of places, in order."""
    pairs = ((places[first], places[second]) for first, second in graph.edges)
    return sorted((min(pair), max(pair)) for pair in pairs)
