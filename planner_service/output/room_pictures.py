"""One room as a picture: from above, with its graph, its surfaces and standing points, and a path from the door."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np

from planner_service.grounding.room_report import cell_of, survey
from scene_graphs.affordances.affordances import Spot
from scene_graphs.furniture import group_of
from scene_graphs.layout import Array, Layout, Point2

_RANK = {"lie": 0, "sit": 1, "touch": 2}


@dataclass(frozen=True)
class Shown:
    """What is drawn over the furniture."""

    graph: bool = True
    spots: bool = True
    path: bool = True
    to: str | None = None
    """The object the path leads to; otherwise a bed, a seat, or what can be touched."""


def picture(layout: Layout, shown: Shown, file: Path | IO[bytes], ending: str | None = None) -> None:
    """Write the picture of a room; `ending`, svg or png, is that of the file's name if it has one."""
    from scene_graphs.plots.floor_plan import draw_layout, save_figure

    looked = survey(layout)
    nodes = looked.graph.nodes
    edges = [(str(nodes[a]["object_id"]), str(nodes[b]["object_id"])) for a, b in looked.graph.edges]
    best: dict[tuple[str, str], Spot] = {}
    for spot, usable in looked.spots:
        if usable:
            best.setdefault((spot.object_id, spot.affordance), spot)
    route = _route(layout, list(best.values()), shown.to) if shown.path else None
    spots = best.values() if shown.spots else ()
    save_figure(draw_layout(layout, spots=spots, edges=edges if shown.graph else (), route=route), file, ending)


def _route(layout: Layout, spots: list[Spot], to: str | None) -> Array | None:
    """The way from the door to where the body stands before it lies down, sits or touches; None if there is none."""
    from scene_graphs.home import home_from_layouts
    from scene_graphs.navigation.path_planner import NoPath, Walkable

    wanted = [spot for spot in spots if to is None or spot.object_id == to]
    if not wanted:
        return None
    soft = {placed.id for placed in layout.objects if group_of(placed.category) in ("sit", "bed")}
    goal = min(wanted, key=lambda spot: (_RANK[spot.affordance], spot.object_id not in soft)).standing
    walkable = Walkable(home_from_layouts([layout], 0), cell=cell_of(layout))
    try:
        start = _start(layout, walkable.random_point(np.random.default_rng(0), 0))
        return walkable.path(start, goal)
    except NoPath:
        return None


def _start(layout: Layout, otherwise: Point2) -> Point2:
    """The middle of the first door, moved a step into the room."""
    if not layout.doors:
        return otherwise
    (ax, az), (bx, bz) = layout.doors[0].segment
    center = np.mean(np.asarray(layout.floor_polygon), axis=0)
    middle = np.array([(ax + bx) / 2, (az + bz) / 2])
    inward = (center - middle) / max(float(np.hypot(*(center - middle))), 1e-6)
    x, z = middle + 0.35 * inward
    return (float(x), float(z))
