"""Rooms as HTTP shows them: in a list, or whole with problems, spots and graph."""

from __future__ import annotations

from collections import Counter
from urllib.parse import quote

from planner_service.routes.layout_graphs import edges_of
from planner_service.schemas.stories import Json
from planner_service.shelves import Shelves
from planner_service.surveying import survey
from scene_graphs.layouts import Layout, layout_to_dict
from scene_graphs.surfaces import Spot


def path_of(layout_id: str) -> str:
    """The address of a room."""
    return f"/v1/layouts/{quote(layout_id)}"


def _kept(shelves: Shelves, layout: Layout) -> Json:
    path = path_of(layout.id)
    return {
        "built_in": shelves.is_fixed_room(layout),
        "area": round(layout.area, 2),
        "links": {"self": path, "scene": f"{path}/scene.glb", "drawing": f"{path}/drawing.svg"},
    }


def room_summary(shelves: Shelves, layout: Layout) -> Json:
    """A room in a list."""
    counts = Counter(placed.category for placed in layout.objects)
    return {
        "id": layout.id,
        "room_type": layout.room_type,
        "tags": list(layout.tags),
        "source": layout.source,
        "licence": layout.licence,
        "objects": len(layout.objects),
        "furniture": dict(sorted(counts.items())),
        **_kept(shelves, layout),
    }


def room_shown(shelves: Shelves, layout: Layout) -> Json:
    """A room whole, with what was found when it was looked over."""
    looked = survey(layout)
    graph, nodes = looked.graph, list(looked.graph)
    places = {node: place for place, node in enumerate(nodes)}
    shown = [
        {
            "category": node.category,
            "instance": node.instance,
            "object_id": graph.nodes[node]["object_id"],
            "minor": graph.nodes[node]["minor"],
        }
        for node in nodes
    ]
    return {
        **layout_to_dict(layout),
        **_kept(shelves, layout),
        "problems": list(looked.problems),
        "spots": [_spot(spot, usable) for spot, usable in looked.spots],
        "graph": {"nodes": shown, "edges": edges_of(graph, places)},
    }


def _spot(spot: Spot, usable: bool) -> Json:
    return {
        "object_id": spot.object_id,
        "affordance": spot.affordance,
        "point": [round(value, 4) for value in spot.point],
        "normal": [round(value, 4) for value in spot.normal],
        "facing": round(spot.facing, 4),
        "standing": [round(value, 4) for value in spot.standing],
        "approach": round(spot.approach, 4),
        "height": spot.height,
        "usable": usable,
    }
