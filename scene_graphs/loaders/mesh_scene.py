"""Plain 3D scenes, .glb and .obj: one room out of nodes that are named or labelled as furniture.

Front of a piece: where its node is turned to. A file in which no node is turned has its turns baked into the points:
then boxes are fitted, and the front is where the backrest is not, else the likeliest (`front_direction`).

The frame of a user's scene file: which axis is up, how long a unit is, and which way furniture faces in it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import atan2, isfinite, pi, prod
from typing import Final, NamedTuple

import numpy as np

from scene_graphs.boxes import Part, Point3
from scene_graphs.furniture import affordances, class_of
from scene_graphs.geometry.mesh_decomposition import front_of_mesh, shape_of
from scene_graphs.json_fields import MAX_COORDINATE, LayoutError
from scene_graphs.layout import MAX_SIZE, Array, Layout, Placed, wrap
from scene_graphs.loaders.doors_and_windows import distinct, gap_around, gaps_of_rooms
from scene_graphs.loaders.floor_polygon import floor_around, floor_of_scene
from scene_graphs.loaders.front_direction import faced
from scene_graphs.loaders.furniture_names import exact_category, furniture_named, likely_room, rooms_served
from scene_graphs.loaders.gltf_reader import nodes_of_gltf
from scene_graphs.loaders.obj_reader import nodes_of_obj
from scene_graphs.loaders.plan_boxes import THINNEST, box_around
from scene_graphs.loaders.room_builder import Intake, RoomIntake
from scene_graphs.loaders.scene_nodes import MAX_BYTES, Building, Finds, Node, Piece, Triangles, find_pieces, joined
from scene_graphs.loaders.scene_source import Options, Source

_FRONTS: Final = {"+z": 0.0, "+x": pi / 2, "-z": pi, "-x": -pi / 2}
_Z_UP: Final = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
_UPRIGHT: Final = 0.99
"""Cosine of the largest tilt at which a node's turn about the vertical is a turn."""


class Frame(NamedTuple):
    """How the file's frame lies in ours."""

    axes: Array
    unit: float
    front: float
    """Yaw of the pieces' fronts in their own frame."""

    def points(self, points: Array) -> Array:
        """Points of the file in our frame, in metres. (N, 3)."""
        moved: Array = points @ self.axes.T * self.unit
        return moved

    def heading(self, turn: Array) -> float | None:
        """The yaw of a piece whose node is turned so; None if it is tilted."""
        own = self.axes @ turn @ self.axes.T
        if own[1, 1] >= _UPRIGHT:
            forward = own[:, 2]
        elif own[1, 2] >= _UPRIGHT:
            # Modelled with z up and turned upright by its node: then the front is -y.
            forward = -own[:, 1]
        else:
            return None
        return wrap(atan2(forward[0], forward[2]) + self.front)


def frame_of(options: Options) -> Frame:
    """The frame that the options name. LayoutError if they name none."""
    if options.up not in ("y", "z") or options.front not in _FRONTS:
        raise LayoutError(f"up must be y or z, and front one of {', '.join(_FRONTS)}")
    if not (isinstance(options.unit, int | float) and isfinite(options.unit) and 1e-6 <= options.unit <= 1e6):
        raise LayoutError(f"unit must be metres a unit, such as 0.01 for centimetres, got {options.unit!r:.60}")
    return Frame(_Z_UP if options.up == "z" else np.eye(3), float(options.unit), _FRONTS[options.front])


MAX_PIECES: Final = 500
MAX_MEASURED: Final = 100
"""Pieces whose shape is taken from their mesh, at up to 0.05 s each; of more it is that of their category."""
_TURNED: Final = 0.01
_SAT_AT: Final = frozenset({"dining_table", "desk", "dressing_table"})
"""Tables that have room for knees, also those that are one solid block in a file."""
_SOLID: Final = 0.9
"""The share of its box from which a piece is a block."""


def read_glb(source: Source, intake: Intake) -> list[Layout]:
    """The room in a .glb (or a .gltf that holds its own data); options `up`, `front`, `unit` and `room_type`."""
    return _room(nodes_of_gltf(_small(source).read(), source.name), source, intake)


def read_obj(source: Source, intake: Intake) -> list[Layout]:
    """The room in an .obj; the same options. Its material file is not opened."""
    return _room(nodes_of_obj(_small(source).text(), source.name), source, intake)


def _small(source: Source) -> Source:
    return replace(source, most_bytes=min(source.most_bytes, MAX_BYTES))


def _room(nodes: list[Node], source: Source, intake: Intake) -> list[Layout]:
    stem = source.name.split(".")[0]
    finds = find_pieces(nodes)
    category = furniture_named(stem)
    if not finds.pieces and finds.loose and category:
        # A file that is one piece of furniture is often named and its nodes are not.
        finds = Finds([Piece(stem, category, joined([mesh for _, mesh in finds.loose]), np.eye(3))], finds.building)
    if not finds.pieces and not finds.loose and not finds.building:
        raise LayoutError(f"{source.name} has no triangles")
    layout = _Scene(finds, frame_of(intake.options), intake).room(stem).finish()
    return [] if layout is None else [layout]


@dataclass(frozen=True)
class _Scene:
    """The pieces and the building of one scene."""

    finds: Finds
    frame: Frame
    intake: Intake

    def room(self, stem: str) -> RoomIntake:
        """The room, filled."""
        for name, _ in self.finds.loose:
            self.intake.drop("its name is no furniture we know; name or label its node", name)
        for piece in self.finds.pieces[MAX_PIECES:]:
            self.intake.drop(f"a room holds at most {MAX_PIECES} objects", piece.name)
        pieces = self.finds.pieces[:MAX_PIECES]
        points = [self.frame.points(piece.mesh.points) for piece in pieces]
        ground = self._ground(points)
        floor = floor_of_scene(self._plan("floor"), self._plan("wall"))
        room_type = self.intake.options.room_type or likely_room(stem, [piece.category for piece in pieces])
        room = self.intake.room(stem, room_type, floor, source="user", height=self._height(ground))
        self._furnish(room, pieces, [own - (0.0, ground, 0.0) for own in points])
        self._open(room, ground)
        room.tags = rooms_served(room.tags[0], [placed.category for placed in room.objects])
        return room

    @cached_property
    def _building(self) -> dict[Building, list[Triangles]]:
        found: dict[Building, list[Triangles]] = {}
        for kind, mesh in self.finds.building:
            found.setdefault(kind, []).append(Triangles(self.frame.points(mesh.points), mesh.corners))
        return found

    def _plan(self, kind: Building) -> Array:
        """The triangles of a part of the building, seen from above. (M, 3, 2)."""
        mesh = joined(self._building.get(kind, []))
        return mesh.points[:, [0, 2]][mesh.corners]

    def _ground(self, pieces: list[Array]) -> float:
        """Height of the floor's surface; without one, of the lowest piece."""
        if floors := self._building.get("floor"):
            return float(np.median([mesh.points[:, 1].max() for mesh in floors]))
        return min((float(own[:, 1].min()) for own in pieces), default=0.0)

    def _height(self, ground: float) -> float | None:
        above = self._building.get("ceiling") or self._building.get("wall")
        return max(float(mesh.points[:, 1].max()) for mesh in above) - ground if above else None

    def _furnish(self, room: RoomIntake, pieces: list[Piece], points: list[Array]) -> None:
        """Add the pieces, turned to the front of their nodes or, where that is unknown, to the likeliest."""
        sources: dict[str, tuple[Piece, Array]] = {}
        names: dict[str, str] = {}
        unknown: set[str] = set()
        for piece, own, heading in zip(pieces, points, self._headings(pieces), strict=True):
            placed = self._add(room, piece, own, heading, names.get(piece.on or ""))
            if placed is None:
                continue
            names.setdefault(piece.name, placed.id)
            sources[placed.id] = (piece, own)
            if heading is None:
                self.intake.guess("front")
                front = _front(placed.to_local(own), piece)
                if front is None:
                    unknown.add(placed.id)
                else:
                    room.objects[-1] = _turned(placed, own, front)
        floor = room.floor or (floor_around(room.objects) if room.objects else [])
        room.objects = faced(room.objects, floor, unknown)
        used = [place for place, placed in enumerate(room.objects) if affordances(placed.category)]
        for place in used[:MAX_MEASURED]:
            placed = room.objects[place]
            room.objects[place] = replace(placed, shape=_shape(placed, *sources[placed.id]))
            if not room.objects[place].shape and (placed.category in _SAT_AT or class_of(placed.category) == "seat"):
                self.intake.guess("legs of a table or seat that is one solid block in the file")
        for _ in used[MAX_MEASURED:]:
            self.intake.guess("shape")

    def _headings(self, pieces: list[Piece]) -> list[float | None]:
        """The yaw of each piece; None for all of a file in which no node is turned."""
        headings = [self.frame.heading(piece.turn) for piece in pieces]
        turns = [wrap(heading - self.frame.front) for heading in headings if heading is not None]
        is_baked = len(pieces) > 1 and all(abs(turn) <= _TURNED for turn in turns)
        return [None] * len(pieces) if is_baked else headings

    def _add(self, room: RoomIntake, piece: Piece, own: Array, heading: float | None, on: str | None) -> Placed | None:
        """Add one piece; one without a heading gets the box that fits it best."""
        if not _is_in_a_room(own):
            self.intake.drop(f"it is larger than {MAX_SIZE:g} m or far away; is the unit right?", piece.name)
            return None
        if not _has_surface(own, piece):
            self.intake.drop("its triangles have no surface", piece.name)
            return None
        yaw = box_around(own).yaw if heading is None else heading
        middle, size = _box(own, yaw)
        return room.add(piece.name, exact_category(piece.category, size, middle[1]), middle, size, yaw, on)

    def _open(self, room: RoomIntake, ground: float) -> None:
        """Cut the doors and windows into the walls."""
        gaps = distinct(
            [
                gap
                for kind in ("door", "window")
                for mesh in self._building.get(kind, [])
                if _is_in_a_room(mesh.points)
                and (gap := gap_around(mesh.points - (0.0, ground, 0.0), kind == "door")) is not None
            ]
        )
        room.open(gaps_of_rooms(gaps, [room.floor])[0])


def _is_in_a_room(points: Array) -> bool:
    return bool(np.ptp(points, axis=0).max() <= MAX_SIZE and np.abs(points).max() <= MAX_COORDINATE)


def _has_surface(points: Array, piece: Piece) -> bool:
    a, b, c = points[piece.mesh.corners].swapaxes(0, 1)
    return bool(np.abs(np.cross(b - a, c - a)).max(initial=0.0) > 0.0)


def _box(points: Array, yaw: float) -> tuple[Point3, Point3]:
    """Centre of the bottom face and size of the upright box around points, turned by a yaw."""
    here = Placed("", "", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), yaw)
    local = here.to_local(points)
    low, high = local.min(axis=0), local.max(axis=0)
    middle = here.to_world(((low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2))
    w, h, d = (max(float(extent), THINNEST) for extent in high - low)
    return (float(middle[0]), float(middle[1]), float(middle[2])), (w, h, d)


def _turned(placed: Placed, points: Array, turn: float) -> Placed:
    """The same piece with its front elsewhere."""
    yaw = wrap(placed.yaw + turn)
    position, size = _box(points, yaw)
    return replace(placed, yaw=yaw, position=position, size=size)


def _front(local: Array, piece: Piece) -> float | None:
    """Where the backrest is not, as a yaw in the frame of the points; None if there is none."""
    try:
        return front_of_mesh(local, piece.mesh.corners, piece.category)
    except LayoutError:
        return None


def _shape(placed: Placed, piece: Piece, points: Array) -> tuple[Part, ...]:
    """The solid boxes of a piece, in its own frame; none for what has no volume, or stands there as one block."""
    try:
        shape = shape_of(placed.to_local(points), piece.mesh.corners, placed.category)
    except LayoutError:
        return ()
    if placed.category in _SAT_AT and sum(prod(part.size) for part in shape) >= _SOLID * prod(placed.size):
        return ()
    return shape if len(shape) > 1 else ()
