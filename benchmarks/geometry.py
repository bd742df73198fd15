"""Ways through a home of four rooms, and what a body in it sees around itself."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

import numpy as np

from benchmarks.figure import Figure
from benchmarks.stories import timed
from scene_graphs.doorways import doorway_sites
from scene_graphs.furniture import ROOM_TYPES
from scene_graphs.geometry.egocentric_heightmap import TOKENHSI, SceneHeights
from scene_graphs.geometry.occupancy_grid import occupancy_pair
from scene_graphs.home import random_home
from scene_graphs.layout import Array
from scene_graphs.layout_library import built_in_layouts
from scene_graphs.navigation.path_planner import Walkable

QUERIES = 50
REPEATS = 5
"""Each is the best of so many, so that one pause of the machine is no figure."""


def geometry_figures(seed: int = 0) -> list[Figure]:
    """One home of the four room types: joined, measured, walked through and looked at from fifty places."""
    layouts, rng = built_in_layouts(), np.random.default_rng(seed)
    home = random_home(layouts, ROOM_TYPES, seed)
    walkable, heights = Walkable(home), SceneHeights(home)
    rooms = rng.integers(0, len(home.rooms), (QUERIES, 2))
    places = [(walkable.random_point(rng, int(a)), walkable.random_point(rng, int(b))) for a, b in rooms]
    yaws = rng.uniform(-np.pi, np.pi, QUERIES)
    walkable.path(*places[0])

    def join() -> None:
        doorway_sites.cache_clear()
        random_home(layouts, ROOM_TYPES, seed)

    def build() -> None:
        Walkable(home).reachable(*places[0])

    roots = [((x, 0.9, z), yaw) for ((x, z), _), yaw in zip(places, yaws, strict=True)]
    ways = _milliseconds(partial(walkable.path, *pair) for pair in places)
    maps = _milliseconds(partial(heights.egocentric, root, yaw, TOKENHSI) for root, yaw in roots)
    grids = _milliseconds(
        partial(occupancy_pair, heights, here, yaw, goal) for (here, goal), yaw in zip(places, yaws, strict=True)
    )
    joining, building, raster = _milliseconds([join, build, partial(SceneHeights, home)])
    pieces = f"{len(home.objects)} objects in {len(home.rooms)} rooms"
    worst = f"of {QUERIES}, each the best of {REPEATS}"
    return [
        Figure("home of four rooms, joined at random", float(joining), "ms", 300, note=pieces),
        Figure("walkable floor of it, built once", float(building), "ms", note="clearance, cells and regions"),
        Figure("way through it, mean", float(ways.mean()), "ms", 20, note=worst),
        Figure("way through it, worst", float(ways.max()), "ms", 20, note=worst),
        Figure("raster of it, built once", float(raster), "ms", note=f"cells of {heights.raster.cell:g} m"),
        Figure("egocentric heightmap, 25 × 25", 1000 * float(maps.max()), "µs", 100, note=f"worst {worst}", digits=0),
        Figure("two occupancy grids, 32³", float(grids.max()), "ms", 1, note=f"worst {worst}", digits=2),
    ]


def _milliseconds(works: Iterable[Callable[[], object]]) -> Array:
    """The best time of each of several works. (N,)."""
    return np.array([1000 * min(timed(work)[1] for _ in range(REPEATS)) for work in works])
