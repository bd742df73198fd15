"""A home has the walls, ways, heights and uses that it had when somebody last looked at it."""

from __future__ import annotations

from itertools import pairwise
from typing import Any, Final

import numpy as np
from recorded import agrees

from scene_graphs.affordances.room_validation import RoomCheck
from scene_graphs.affordances.usable_furniture import count_uses, pulled_out
from scene_graphs.geometry.egocentric_heightmap import SIMS, TOKENHSI, UNIHSI, SceneHeights
from scene_graphs.geometry.occupancy_grid import LINGO, TRUMANS, occupancy, occupancy_pair
from scene_graphs.graph.furniture_graph import graph_from_layout
from scene_graphs.home import Home, home_from_layouts, home_to_dict
from scene_graphs.layout import Layout
from scene_graphs.layout_library import built_in_index
from scene_graphs.meshes.convex_shapes import convex_shapes
from scene_graphs.navigation.path_planner import Walkable

ROOMS: Final = ("living-room-0021", "bedroom-0007", "dining-room-0012")


def test_a_home_is_as_recorded() -> None:
    home = home_from_layouts([built_in_index().layout(name) for name in ROOMS], 1)
    agrees(
        "home",
        {"rows": rows(home), "ways": ways(home), "heights": heights(home), "uses": uses(home), "graphs": graphs()},
    )


def rows(home: Home) -> dict[str, Any]:
    """The file of the home, without what stands in its rooms."""
    told = home_to_dict(home)
    rooms = [{**room, "layout": room["layout"]["id"]} for room in told.pop("rooms")]
    return {**told, "rooms": rooms, "objects": [[*placed.position, placed.yaw] for placed in home.objects]}


def graphs() -> dict[str, list[str]]:
    """What is near what in every room."""
    graphs = {name: graph_from_layout(built_in_index().layout(name)) for name in ROOMS}
    return {
        name: sorted(" - ".join(sorted(f"{node.category} {node.instance}" for node in edge)) for edge in graph.edges)
        for name, graph in graphs.items()
    }


def ways(home: Home) -> dict[str, Any]:
    """Paths from a place of every room, and from a piece of furniture, to a place of the next, in metres."""
    walkable, rng = Walkable(home), np.random.default_rng(0)
    places = [walkable.random_point(rng, index) for index in range(len(home.rooms))]
    places += [(placed.position[0], placed.position[2]) for placed in home.objects[::9]]
    paths = [walkable.path(start, goal) for start, goal in pairwise(places) if walkable.reachable(start, goal)]
    return {
        "places": [[round(x, 3), round(z, 3), round(walkable.clearance((x, z)), 3)] for x, z in places],
        "free": [walkable.nearest_free(place) for place in places],
        "paths": [[round(float(number), 3) for number in path[::6].ravel()] for path in paths],
    }


def heights(home: Home) -> dict[str, Any]:
    """What a body sees around it, in the middle of every room, in sums."""
    scene = SceneHeights(home)
    found: dict[str, Any] = {}
    for index, room in enumerate(home.rooms):
        x, z = home.room_polygon(index).mean(axis=0)
        target = next(placed.id for placed in home.objects if placed.id.startswith(f"{index}/"))
        maps = [scene.egocentric((x, 0.9, z), 0.7, spec, target) for spec in (SIMS, TOKENHSI, UNIHSI)]
        boxes = [occupancy(scene, (x, z), 0.7, spec) for spec in (LINGO, TRUMANS)]
        pair = occupancy_pair(scene, (x, z), 0.7, (x + 1.5, z - 0.5), walking=True)
        found[room.layout.id] = {
            "maps": [[round(float(number), 2) for number in (*grid.sum(axis=0), *grid.sum(axis=1))] for grid in maps],
            "solid": [int(box.sum()) for box in (*boxes, *pair)],
        }
    return found


def uses(home: Home) -> dict[str, Any]:
    """What can be used, where chairs are pulled to, and what a body would walk into."""
    layouts = [room.layout for room in home.rooms]
    counts = count_uses(layouts)
    shapes = convex_shapes(home, 0.02)
    return {
        "uses": {" ".join(key): dict(count) for key, count in sorted(counts.items())},
        "pulled": {layout.id: pulls(layout) for layout in layouts},
        "carried": {layout.id: RoomCheck(layout).carried for layout in layouts},
        "solids": [len(shapes), round(float(np.sum([shape.high - shape.low for shape in shapes])), 2)],
    }


def pulls(layout: Layout) -> dict[str, float]:
    found = {placed.id: pulled_out(layout, placed.id) for placed in layout.objects if "chair" in placed.category}
    return {name: round(pull.distance, 3) for name, pull in found.items() if pull is not None}
