"""Which object every piece of a script's furniture is: each script mapped by itself onto the rooms of its home."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import networkx as nx

from scene_graphs.furniture import Furniture
from scene_graphs.graph.edit_distance import Match, exact_distance
from scene_graphs.graph.furniture_graph import FurnitureGraph, graph_from_layout
from scene_graphs.graph.merge import side_by_side
from scene_graphs.graph.substitution_costs import CostTable, Level
from scene_graphs.home import Home

Offers = Mapping[str, frozenset[str]]


@dataclass(frozen=True)
class Grounding:
    """The objects a script plays at."""

    objects: dict[Furniture, str]
    """Home-wide object ids."""
    levels: dict[Furniture, Level]
    """How near each object is to what was asked for."""
    missing: tuple[Furniture, ...]
    """What nothing in the home stands in for."""
    exact: bool


def ground_script(
    script: FurnitureGraph,
    home: Home,
    room: int | None = None,
    offers: Offers | None = None,
    costs: CostTable | None = None,
) -> Grounding:
    """Map one short script's graph onto a home's objects with the exact search that chose its rooms.

    "The merged graph chooses the room; the per-script maps choose the objects." With `room` its objects come first, and
    only what it lacks is looked for in the other rooms. `offers` overrules what objects (by home-wide id) can be used
    for, such as when one cannot be walked to. Pieces without an object are in `missing`; needs are never relaxed.
    """
    indices = range(len(home.rooms))
    own = _graph_of(home, indices if room is None else [room], offers or {})
    match = exact_distance(script, own, costs)
    objects, levels = _named(match, own)
    missing, exact = match.missing, match.exact
    if missing and room is not None and len(indices) > 1:
        others = _graph_of(home, [index for index in indices if index != room], offers or {})
        rest = exact_distance(nx.Graph(script.subgraph(missing)), others, costs)
        more, more_levels = _named(rest, others)
        objects, levels = objects | more, levels | more_levels
        missing, exact = rest.missing, exact and rest.exact
    return Grounding(objects, levels, missing, exact)


def _graph_of(home: Home, rooms: Iterable[int], offers: Offers) -> FurnitureGraph:
    graph = side_by_side({room: graph_from_layout(home.rooms[room].layout) for room in rooms})
    for _, node in graph.nodes(data=True):
        node["offers"] = offers.get(str(node["object_id"]), node["offers"])
    return graph


def _named(match: Match, graph: FurnitureGraph) -> tuple[dict[Furniture, str], dict[Furniture, Level]]:
    objects = {pair.query: str(graph.nodes[pair.room]["object_id"]) for pair in match.pairs}
    return objects, {pair.query: pair.level for pair in match.pairs}
