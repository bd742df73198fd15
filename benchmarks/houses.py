"""Invented houses in the form of 3D-FRONT's JSON, as untidy as real ones; nothing in them is theirs."""

from __future__ import annotations

from itertools import count
from math import cos, pi, sin
from typing import Any, Final

import numpy as np

from scene_graphs.furniture import typical_size

Json = dict[str, Any]

TYPES: Final = (
    "LivingDiningRoom",
    "MasterBedroom",
    "SecondBedroom",
    "Library",
    "Kitchen",
    "Bathroom",
    "KidsRoom",
    "Balcony",
)
MODELS: Final = {
    "King-size Bed": "double_bed",
    "table/night table": "nightstand",
    "Wardrobe": "wardrobe",
    "Three-Seat / Multi-seat Sofa": "multi_seat_sofa",
    "Coffee Table": "coffee_table",
    "TV Stand": "tv_stand",
    "Dining Table": "dining_table",
    "Dining Chair": "dining_chair",
    "Desk": "desk",
    "Bookcase / jewelry Armoire": "bookshelf",
    "Pendant Lamp": "pendant_lamp",
}
"""Their words for a few models, and ours."""
HEIGHT: Final = 2.8
THICK: Final = 0.2
"""Of the walls between rooms."""
_TRIM: Final = 30
"""Meshes of a room that are neither floor nor wall: skirtings, cornices, tiles."""


def synthetic_house(seed: int, rooms: int = 8, pieces: int = 41) -> Json:
    """A house of that many rooms in a row with that many pieces of furniture each placed once.

    As in real ones a quarter of the pieces is listed with another room than they stand in, a tenth of the models is
    not valid, some children point at nothing, and the floor is a mesh of several triangles.
    """
    rng = np.random.default_rng(seed)
    house = _House(rng)
    left = 0.0
    for number in range(rooms):
        w, d = rng.uniform(3.0, 6.0, 2)
        house.add_room(TYPES[number % len(TYPES)], number, left, float(w), float(d))
        left += float(w) + THICK
    for _ in range(pieces):
        house.add_piece()
    return house.json(f"house-{seed}")


class _House:
    def __init__(self, rng: np.random.Generator) -> None:
        self._rng, self._numbers = rng, count()
        self._rooms: list[Json] = []
        self._bounds: list[tuple[float, float, float]] = []
        self._furniture: list[Json] = []
        self._meshes: list[Json] = []
        self._doors: list[Json] = []

    def add_room(self, kind: str, number: int, left: float, w: float, d: float) -> None:
        """A rectangle from `left`, with a door to the room before it and a window at its far side."""
        name = f"{kind}-{number}"
        room = {"type": kind, "instanceid": name, "size": w * d, "empty": 0, "children": [], **_pose()}
        self._rooms.append(room)
        self._bounds.append((left, w, d))
        self._add_mesh(room, "Floor", *_grid(left, w, d))
        self._add_mesh(room, "Ceiling", *_grid(left, w, d, HEIGHT))
        for x0, z0, x1, z1 in ((0, 0, w, 0), (w, 0, w, d), (w, d, 0, d), (0, d, 0, 0)):
            self._add_mesh(room, "WallInner", *_panel(left + x0, z0, left + x1, z1, 0.0, HEIGHT, 6))
        for _ in range(_TRIM):
            x, z = left + self._rng.uniform(0, w), self._rng.uniform(0, d)
            self._add_mesh(room, "Baseboard", *_panel(x, z, x + 0.5, z, 0.0, 0.1, 12))
        middle = left + w / 2
        self._add_mesh(room, "Window", *_panel(middle - 0.6, d + 0.1, middle + 0.6, d + 0.1, 0.9, 2.1, 2))
        if number:
            near = left - THICK / 2
            door = self._add_mesh(room, "Door", *_panel(near, 1.0, near, 1.9, 0.0, 2.1, 2))
            self._doors.append({"type": "interiorDoor", "roomId": name, "dir": 0, "ref": [door]})
        for lost in range(6):
            room["children"].append({"ref": f"lost/{lost}", "instanceid": f"furniture/lost{lost}", **_pose()})

    def add_piece(self) -> None:
        """One piece of a model of its own, somewhere in a room."""
        rng = self._rng
        title = str(rng.choice(list(MODELS)))
        w, h, d = (extent * float(rng.uniform(0.9, 1.1)) for extent in typical_size(MODELS[title]))
        uid = f"{next(self._numbers)}/model"
        entry: Json = {"uid": uid, "jid": f"jid-{uid}", "title": title if "/" in title else f"any/{title}"}
        entry["valid"] = bool(rng.random() > 0.1)
        if rng.random() < 0.5:
            entry |= {"size": [w, d, h], "bbox": [w, d, h]}
        else:
            entry |= {"bbox": [w, h, d], "category": title}
        self._furniture.append(entry)
        room = int(rng.integers(len(self._rooms)))
        left, wide, deep = self._bounds[room]
        turn = float(rng.choice([0.0, pi / 2, pi, -pi / 2]))
        pose = _pose(left + float(rng.uniform(0.3, wide - 0.3)), float(rng.uniform(0.3, deep - 0.3)), turn)
        listed = room if rng.random() > 0.24 else int(rng.integers(len(self._rooms)))
        self._rooms[listed]["children"].append({"ref": uid, "instanceid": f"furniture/{uid}", **pose})

    def json(self, uid: str) -> Json:
        """The whole file."""
        return {
            "uid": uid,
            "version": "2.0",
            "north_vector": [0, 1, 0],
            "furniture": self._furniture,
            "mesh": self._meshes,
            "material": [],
            "extension": {"door": self._doors},
            "scene": {"room": self._rooms},
        }

    def _add_mesh(self, room: Json, kind: str, points: list[float], faces: list[int]) -> str:
        uid = f"{next(self._numbers)}/0"
        normal, uv = [0.0, 1.0, 0.0] * (len(points) // 3), [0.25, 0.75] * (len(points) // 3)
        mesh = {"uid": uid, "jid": "", "type": kind, "xyz": points, "normal": normal, "uv": uv, "faces": faces}
        self._meshes.append(mesh)
        room["children"].append({"ref": uid, "instanceid": f"mesh/{uid}", **_pose()})
        return uid


def _pose(x: float = 0.0, z: float = 0.0, yaw: float = 0.0) -> Json:
    return {"pos": [x, 0.0, z], "rot": [0.0, sin(yaw / 2), 0.0, cos(yaw / 2)], "scale": [1.0, 1.0, 1.0]}


def _grid(left: float, w: float, d: float, y: float = 0.0, steps: int = 3) -> tuple[list[float], list[int]]:
    """A rectangle on the floor or ceiling in triangles, every one with points of its own."""
    points: list[float] = []
    for i in range(steps):
        for j in range(steps):
            x0, x1, z0, z1 = left + w * i / steps, left + w * (i + 1) / steps, d * j / steps, d * (j + 1) / steps
            points += [x0, y, z0, x1, y, z1, x1, y, z0, x0, y, z0, x0, y, z1, x1, y, z1]
    return points, list(range(len(points) // 3))


def _panel(
    x0: float, z0: float, x1: float, z1: float, low: float, high: float, steps: int
) -> tuple[list[float], list[int]]:
    """An upright rectangle between two points of the floor in triangles."""
    points: list[float] = []
    for step in range(steps):
        (ax, az), (bx, bz) = ((x0 + (x1 - x0) * s / steps, z0 + (z1 - z0) * s / steps) for s in (step, step + 1))
        points += [ax, low, az, bx, low, bz, bx, high, bz, ax, low, az, bx, high, bz, ax, high, az]
    return points, list(range(len(points) // 3))
