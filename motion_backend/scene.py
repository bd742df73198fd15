"""A home with what is worked out about it once and shared by all that move bodies in it."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from threading import Lock
from typing import Final

import numpy as np

from motion_backend.body.scene_collision import Obstacles
from motion_backend.rotations import Array
from scene_graphs.geometry.egocentric_heightmap import SceneHeights
from scene_graphs.home import Home
from scene_graphs.meshes.convex_shapes import shapes_of
from scene_graphs.navigation.path_planner import Walkable

_KEPT: Final = 8
"""Homes whose scenes are kept at hand."""
UPPER: Final = 0.75
"""Of its height: where a piece is looked at."""
SILL, EYES = 0.2, 1.5
"""What opens lower than this is a door; how high the face is of who comes in (metres)."""
UNSEEN: Final = frozenset({"rug", "ceiling_lamp"})
"""What nobody looks at."""


@dataclass(frozen=True)
class Scene:
    """A home as bodies meet it; each thing is made when it is first asked for."""

    home: Home

    @cached_property
    def walkable(self) -> Walkable:
        """Where one can walk."""
        return Walkable(self.home)

    @cached_property
    def first_free(self) -> tuple[float, float]:
        """A free place of the first room, always the same, [x, z]: whatever is to be used is walked to from there."""
        return self.walkable.random_point(np.random.default_rng(0), 0)

    def beginning(self, seed: int) -> tuple[tuple[float, float], float]:
        """Where a body begins, [x, z], and its yaw: a free place of the first room that the seed chooses."""
        rng = np.random.default_rng([seed, 0])
        return self.walkable.random_point(rng, 0), float(rng.uniform(-np.pi, np.pi))

    @cached_property
    def obstacles(self) -> Obstacles:
        """Furniture and walls as boxes."""
        return Obstacles.of_home(self.home)

    def depth_about(self, object_id: str) -> Callable[[Array], Array]:
        """How deep points (N, 3) are in furniture and walls, and in one piece as it is drawn: with what stands in it.

        The depth (N,) is negative or -inf outside.
        """
        solid = self.obstacles.solid()
        drawn = [shape for placed in self.home.objects if placed.id == object_id for shape in shapes_of(placed)]

        def depth(points: Array) -> Array:
            found, low, high = solid.depth(points), points.min(axis=0), points.max(axis=0)
            for shape in drawn:
                if ((shape.low < high) & (shape.high > low)).all():
                    found = np.maximum(found, shape.depth(points))
            return np.asarray(found)

        return depth

    def sights(self, room: int | None) -> Array:
        """What eyes rest on in a room: the upper half of its furniture, its windows and doors. (N, 3)."""
        return self._sights.get(room, np.zeros((0, 3)))

    def doors(self, room: int | None) -> Array:
        """Where one looks for who comes in: the doors of a room, as high as eyes. (N, 3)."""
        openings = [opening for wall in self.home.walls for opening in wall.openings if opening.bottom < SILL]
        middles = [np.mean(opening.segment, axis=0) for opening in openings]
        found = [(x, EYES, z) for x, z in middles if self.home.room_at((float(x), float(z))) == room]
        return np.array(found).reshape(-1, 3)

    @cached_property
    def _sights(self) -> dict[int | None, Array]:
        found: dict[int | None, list[tuple[float, float, float]]] = {}
        for placed in self.home.objects:
            x, y, z = placed.position
            if placed.category not in UNSEEN:
                found.setdefault(int(placed.id.partition("/")[0]), []).append((x, y + UPPER * placed.size[1], z))
        for wall in self.home.walls:
            for opening in wall.openings:
                (x0, z0), (x1, z1) = opening.segment
                middle = ((x0 + x1) / 2, (opening.bottom + opening.top) / 2, (z0 + z1) / 2)
                found.setdefault(self.home.room_at((middle[0], middle[2])), []).append(middle)
        return {room: np.array(points) for room, points in found.items()}

    @cached_property
    def heights(self) -> SceneHeights:
        """How high everything is: egocentric heightmaps (SIMS 3.3) and occupancy (LINGO A.2) are looked up in it."""
        return SceneHeights(self.home)


_scenes: OrderedDict[int, Scene] = OrderedDict()
_changing: Final = Lock()


def scene_of(home: Home) -> Scene:
    """The scene of a home, the same for all who ask while it is at hand."""
    with _changing:
        found = _scenes.get(id(home))
        if found is None:
            # The scene holds its home, so that no other home gets the same id while it is kept.
            found = _scenes[id(home)] = Scene(home)
        _scenes.move_to_end(id(home))
        while len(_scenes) > _KEPT:
            _scenes.popitem(last=False)
        return found
