"""Models of 3D-FUTURE, as a 3D-FRONT house lists them: what each is, how large it is, and its mesh where one is there.

Axes: an entry with `size` stores it as width, depth, height; one with only `bbox` stores that as width, height, depth.
The mesh's own box goes before both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from scene_graphs.boxes import Part, box, inside
from scene_graphs.furniture import canonical
from scene_graphs.geometry.mesh_decomposition import shape_of
from scene_graphs.json_fields import LayoutError, Row
from scene_graphs.layout import MAX_SIZE, Point3
from scene_graphs.loaders.frames import Pose, numbers
from scene_graphs.loaders.obj_reader import nodes_of_obj
from scene_graphs.loaders.plan_boxes import UprightBox
from scene_graphs.loaders.scene_nodes import Triangles, joined
from scene_graphs.loaders.scene_source import Source

UNKNOWN: Final = "unknown"
_WORDS: Final = {
    "three-seat / multi-seat sofa": "multi_seat_sofa",
    "three-seat / multi-person sofa": "multi_seat_sofa",
    "double sofa": "loveseat_sofa",
    "single sofa": "armchair",
    "corner/side table": "corner_side_table",
    "lounge chair / book-chair / computer chair": "lounge_chair",
    "sideboard / side cabinet / console": "console_table",
    "wine cooler": "wine_cabinet",
    "bar chair": "barstool",
    "lightings": "lamp",
}
"""Names of theirs whose last word says less than the whole."""
_MODEL_FILES: Final = ("3D-FUTURE-model/{}/raw_model.obj", "{}/raw_model.obj")
_INFO_FILES: Final = ("model_info.json", "3D-FUTURE-model/model_info.json")


@dataclass(frozen=True)
class Model:
    """One model that a house may place several times."""

    word: str
    """What it is, in the source's words."""
    size: Point3
    """Width x, height y, depth z of its box."""
    bottom: Point3 = (0.0, 0.0, 0.0)
    """The centre of its box's bottom face, in its own frame."""
    mesh: str | None = None
    """The model's 3D-FUTURE id, if its file is there."""
    shape: tuple[Part, ...] = ()
    """Solid boxes measured from its mesh, in the frame of its box: origin at `bottom`."""

    def placed(self, pose: Pose) -> tuple[UprightBox, tuple[Part, ...]]:
        """The box as it stands in a scene, and the shape in the box's own frame, front +Z."""
        x, y, z = (float(number) for number in pose.to_world(np.array([self.bottom]))[0])
        w, h, d = (extent * abs(factor) for extent, factor in zip(self.size, pose.scale, strict=True))
        # A front that a negative scale turns round takes the left side with it.
        right = pose.scale[0] if pose.scale[2] > 0 else -pose.scale[0]
        factors = (right, abs(pose.scale[1]), abs(pose.scale[2]))
        shape = inside([_scaled(part, factors) for part in self.shape], (w, h, d))
        return UprightBox((x, y, z), (w, h, d), pose.yaw), shape


class Models:
    """The models of the file or folder a house lies in."""

    def __init__(self, source: Source, info: Source | None) -> None:
        self._source = source
        listed = info or source.beside(*_INFO_FILES)
        self._categories = _categories(listed) if listed else {}
        self._meshes: dict[str, Triangles | None] = {}

    def word(self, entry: Row) -> str:
        """What an entry of a house's `furniture` is: by model_info.json, its `category`, the end of its `title`."""
        jid, title = entry.get("jid"), entry.get("title")
        told = self._categories.get(jid) if isinstance(jid, str) else None
        for word in (told, entry.get("category"), title):
            if isinstance(word, str) and (name := _name(word)):
                return name
        return UNKNOWN

    def model(self, entry: Row) -> Model | None:
        """The model of an entry; None if nothing gives its size."""
        jid = entry.get("jid")
        mesh = self._mesh(jid) if isinstance(jid, str) and jid else None
        if mesh is not None:
            return _measured(self.word(entry), mesh, str(jid))
        size = _box(entry)
        return None if size is None else Model(self.word(entry), size)

    def _mesh(self, jid: str) -> Triangles | None:
        """A model's mesh in its own frame."""
        if jid not in self._meshes:
            file = self._source.beside(*(name.format(jid) for name in _MODEL_FILES))
            nodes = [] if file is None else nodes_of_obj(file.text(), f"{jid}/{file.name}")
            self._meshes[jid] = (
                joined([part.own for node in nodes for part in (node, *node.children)]) if nodes else None
            )
        return self._meshes[jid]


def _name(word: str) -> str:
    """The last of "table/night table"; "Bookcase / jewelry Armoire" is one name."""
    stripped = word.strip()
    return _WORDS.get(stripped.lower()) or (stripped if " / " in stripped else stripped.rsplit("/", 1)[-1].strip())


def _box(entry: Row) -> Point3 | None:
    """Width, height, depth by the axis rule above."""
    if (size := numbers(entry.get("size"), 3, MAX_SIZE)) is not None:
        return (size[0], size[2], size[1])
    if (bbox := numbers(entry.get("bbox"), 3, MAX_SIZE)) is not None:
        return (bbox[0], bbox[1], bbox[2])
    return None


def _measured(word: str, mesh: Triangles, jid: str) -> Model:
    """The model whose box and shape are its mesh's own."""
    low, high = mesh.points[mesh.corners].min(axis=(0, 1)), mesh.points[mesh.corners].max(axis=(0, 1))
    (x, y, z), (w, h, d) = ((low + high) / 2).tolist(), (high - low).tolist()
    bottom = (x, y - h / 2, z)
    try:
        shape = shape_of(mesh.points - bottom, mesh.corners, canonical(word))
    except LayoutError:
        # Something flat or far too large: the box says what there is to say.
        shape = ()
    return Model(word, (w, h, d), bottom, jid, shape)


def _scaled(part: Part, factors: Point3) -> Part:
    x, y, z = (sorted((low * f, high * f)) for low, high, f in zip(part.low, part.high, factors, strict=True))
    return box(part.role, (x[0], x[1]), (y[0], y[1]), (z[0], z[1]))


def _categories(file: Source) -> Mapping[str, str]:
    """The category of every model in model_info.json."""
    rows: Any = file.json()
    if not isinstance(rows, list):
        raise LayoutError(f"{file.name} must be 3D-FUTURE's list of models with model_id and category")
    return {
        row["model_id"]: row["category"]
        for row in rows
        if isinstance(row, dict) and isinstance(row.get("model_id"), str) and isinstance(row.get("category"), str)
    }
