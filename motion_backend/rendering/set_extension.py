"""What goes on of a room where a film leaves a wall away: its floor and its ceiling, and the walls beside the gap.

A camera that looks through a gap has the same room before it and behind it, and no edge of it in the picture.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.rendering.renderer import Solid
from motion_backend.rotations import Array
from motion_backend.walls import Side

if TYPE_CHECKING:
    from scene_graphs.home import Home

Paint = Sequence[float] | NDArray[np.floating]
FAR: Final = 6.0
"""Metres beyond a gap up to which all goes on."""
LOWER: Final = 0.004
"""Metres that a floor beyond its room lies lower than floors."""
JOINED: Final = 0.2
"""Metres between the ends of two walls that meet."""
ALONG: Final = 0.5
"""The cosine from which on a wall already goes the way in which another would go on."""
CEILING: Final = (1.35, 1.34, 1.32)
"""Brighter than white, as what lamps shine at from below: no light of the sky reaches it."""


@dataclass(frozen=True)
class SetExtension:
    """One room and what of it may go on."""

    home: Home
    room: int
    sides: tuple[Side, ...]
    """Its walls."""
    floor: tuple[Solid, ...]
    """A floor like its own that reaches `FAR` beyond it."""

    @staticmethod
    def of(home: Home, room: int) -> SetExtension:
        """That of a room of a home."""
        from scene_graphs.meshes.interior_mesh import wide_floor_meshes

        found = (side for wall in home.walls if (side := Side.of(wall, home)) is not None)
        floor = [
            Solid(mesh.vertices - np.array([0.0, LOWER, 0.0], dtype=np.float32), mesh.faces, mesh.color, casts=False)
            for mesh in wide_floor_meshes(home, room, FAR)
        ]
        return SetExtension(home, room, tuple(side for side in found if side.room == room), tuple(floor))

    @cached_property
    def height(self) -> float:
        """Of the room (metres)."""
        return float(self.home.rooms[self.room].layout.height)

    def beyond(self, gaps: Sequence[Side], paint: Paint) -> Iterator[Solid]:
        """What goes on where some walls of the room are left away; what stands of it has a paint."""
        for solid in self.floor:
            middles = solid.vertices[solid.faces].mean(axis=1)[:, [0, 2]]
            out = np.any([_is_beyond(side, middles) for side in gaps] or [np.zeros(len(middles), bool)], axis=0)
            if out.any():
                yield Solid(solid.vertices, solid.faces[out], solid.color, casts=False)
        for gap in gaps:
            for end in (gap.start, gap.end):
                if not self._goes_on(end, gap, gaps):
                    yield _upright(end, end + FAR * gap.outward, self.height, paint)

    def ceiling(self, gaps: Sequence[Side]) -> Solid:
        """That of the room and of what goes on of it."""
        from scene_graphs.meshes.mesh_primitives import flat, merge

        shapes = [flat(self.home.room_polygon(self.room), self.height)]
        for gap in gaps:
            along = (gap.end - gap.start) / np.linalg.norm(gap.end - gap.start)
            one, other = gap.start - FAR * along, gap.end + FAR * along
            out = FAR * gap.outward
            shapes.append(flat(np.array([one, other, other + out, one + out]), self.height + LOWER))
        return Solid(*merge(shapes), CEILING, casts=False)

    def _goes_on(self, end: Array, gap: Side, gaps: Sequence[Side]) -> bool:
        """Whether at one end of a gap there is another gap, or a wall that goes that way by itself."""
        for side in self.sides:
            there = [point for point in (side.start, side.end) if np.linalg.norm(point - end) < JOINED]
            if _same(side, gap) or not there:
                continue
            way = side.start + side.end - there[0] - there[0]
            if any(_same(side, other) for other in gaps) or way @ gap.outward > ALONG * np.linalg.norm(way):
                return True
        return False


def _same(one: Side, other: Side) -> bool:
    return np.array_equal(one.start, other.start) and np.array_equal(one.end, other.end)


def _is_beyond(side: Side, points: Array) -> Array:
    """Which points (N, 2) lie on the far side of a wall's line, or nearly. (N,)."""
    return np.asarray((points - side.start) @ side.outward > -0.9)


def _upright(start: Array, end: Array, height: float, paint: Paint) -> Solid:
    corners = np.array([(*point, y) for y in (0.0, height) for point in (start, end)])[:, [0, 2, 1]]
    return Solid(corners, np.array([[0, 1, 3], [0, 3, 2]]), paint, casts=False)
