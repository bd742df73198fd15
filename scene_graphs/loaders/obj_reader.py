"""Geometry of Wavefront OBJ: points, faces and the names of objects (`o`) and groups (`g`), and no other file."""

from __future__ import annotations

import io
from array import array
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, Final

import numpy as np

from scene_graphs.json_fields import LayoutError
from scene_graphs.layout import Array
from scene_graphs.loaders.scene_nodes import MAX_NODES, MAX_TRIANGLES, NOTHING, Node, Triangles

MAX_LINES: Final = 4_000_000
"""Of one file, its normals and texture points among them."""
_MAX_COORDINATE: Final = 1e7
_MAX_CORNERS: Final = 10_000
"""Of one face."""


def nodes_of_obj(text: str, name: str) -> list[Node]:
    """One node for every object, with one below it for every named group of it; points in the file's frame and unit.

    Faces are cut into triangles as fans; materials, textures and normals are passed over. LayoutError, naming the line,
    for what is no number or a point that is not there.
    """
    scene = _Scene(name)
    for number, line in enumerate(io.StringIO(text.replace("\\\n", " "), newline=None), start=1):
        if number > MAX_LINES:
            raise LayoutError(f"{name} has more than {MAX_LINES} lines", "simplify it")
        scene.read(line, number)
    if not scene.faces:
        raise LayoutError(f"{name} has no faces", "is it an .obj?")
    points = np.array(scene.points).reshape(-1, 3)
    own: dict[str, Triangles] = {}
    groups: dict[str, list[Node]] = {}
    for (object_name, group), corners in scene.faces.items():
        below = groups.setdefault(object_name, [])
        if group:
            below.append(Node(group, np.eye(3), _mesh(points, corners)))
        else:
            own[object_name] = _mesh(points, corners)
    return [Node(name, np.eye(3), own.get(name, NOTHING), tuple(below)) for name, below in groups.items()]


@dataclass
class _Scene:
    """One file being read, line by line."""

    name: str
    points: array[float] = field(default_factory=lambda: array("d"))
    faces: dict[tuple[str, str], array[int]] = field(default_factory=dict)
    """Corners of triangles by object and group, three numbers of points each."""
    _triangles: int = 0
    _within: tuple[str, str] = ("", "")

    def read(self, line: str, number: int) -> None:
        word, _, rest = line.strip().partition(" ")
        if word == "v":
            self.points.extend(self._point(rest, number))
        elif word == "f":
            self._add_face(rest, number)
        elif word == "o":
            self._within = (rest.strip(), "")
        elif word == "g":
            self._within = (self._within[0], rest.strip())

    def _point(self, text: str, number: int) -> list[float]:
        try:
            point = [float(word) for word in text.split(None, 3)[:3]]
        except ValueError:
            point = []
        if len(point) != 3:
            raise LayoutError(f"{self.name} line {number}: v must be followed by three numbers, got {text!r:.60}")
        if not all(abs(value) <= _MAX_COORDINATE for value in point):
            raise LayoutError(f"{self.name} line {number}: a point beyond any room, {text!r:.60}")
        return point

    def _add_face(self, text: str, number: int) -> None:
        words = text.split()
        if len(words) > _MAX_CORNERS:
            raise LayoutError(f"{self.name} line {number}: a face has more than {_MAX_CORNERS} corners")
        corners = [self._corner(word, number) for word in words]
        self._triangles += max(0, len(corners) - 2)
        if self._triangles > MAX_TRIANGLES:
            raise LayoutError(f"{self.name} has more than {MAX_TRIANGLES} triangles", "simplify it")
        if self._within not in self.faces:
            if len(self.faces) >= MAX_NODES:
                raise LayoutError(f"{self.name} has more than {MAX_NODES} groups", "join what belongs together")
            self.faces[self._within] = array("q")
        for second, third in pairwise(corners[1:]):
            self.faces[self._within].extend((corners[0], second, third))

    def _corner(self, word: str, number: int) -> int:
        """The point of a corner; numbers count from 1, negative ones from the last point backwards."""
        count = len(self.points) // 3
        try:
            index = int(word.partition("/")[0])
        except ValueError as error:
            raise LayoutError(
                f"{self.name} line {number}: f must be followed by numbers of points, got {word!r:.60}"
            ) from error
        place = index - 1 if index > 0 else count + index
        if index == 0 or not 0 <= place < count:
            raise LayoutError(f"{self.name} line {number}: there is no point {word!r:.20} of {count}")
        return place


def _mesh(points: Array, corners: array[Any]) -> Triangles:
    used, own = np.unique(np.array(corners, dtype=np.int64), return_inverse=True)
    return Triangles(points[used], own.reshape(-1, 3))
