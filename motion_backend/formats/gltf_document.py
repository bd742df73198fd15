"""A glTF 2.0 document under construction: arrays go into one buffer, the rest is plain JSON; out comes a GLB.

Frame: as everywhere here, right-handed, Y up, metres, quaternions xyzw; glTF's own conventions, so nothing is turned.
"""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scene_graphs.json_fields import Json

_COMPONENTS = {"uint8": 5121, "int16": 5122, "uint16": 5123, "uint32": 5125, "float32": 5126}
_WIDTHS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
_MAGIC, _JSON_CHUNK, _BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942


class Animation:
    """What is animated of a document, node by node."""

    def __init__(self) -> None:
        self.samplers: list[Json] = []
        self.channels: list[Json] = []

    def animate(self, node: int, path: str, times: int, output: int) -> None:
        """Have a node's "translation", "rotation", "scale" or "weights" follow an accessor at the times of another."""
        self.samplers.append({"input": times, "output": output})
        self.channels.append({"sampler": len(self.samplers) - 1, "target": {"node": node, "path": path}})

    def to_dict(self) -> Json:
        """As the document has it."""
        return {"name": "motion", "samplers": self.samplers, "channels": self.channels}


class Document:
    """Collects the parts of one glTF; every `add` answers the index other parts refer to."""

    def __init__(self) -> None:
        self._parts: dict[str, list[Json]] = {}
        self._binary = bytearray()
        self._materials: dict[tuple[float, ...], int] = {}

    def add(self, collection: str, part: Json) -> int:
        """Append to "nodes", "meshes", "skins", "animations" … and answer its index."""
        parts = self._parts.setdefault(collection, [])
        parts.append(part)
        return len(parts) - 1

    def update(self, collection: str, index: int, part: Json) -> None:
        """Set further properties of a part that is already there."""
        self._parts[collection][index].update(part)

    def accessor(
        self, array: NDArray[Any], target: int | None = None, bounds: bool = False, normalized: bool = False
    ) -> int:
        """Store an array (N,) or (N, 1..4) or (N, 16).

        `bounds` writes the smallest and largest value a component; `normalized` says that whole numbers stand for
        shares of their type's largest.
        """
        array = np.ascontiguousarray(array)
        self._binary.extend(b"\0" * (-len(self._binary) % 4))
        view: Json = {"buffer": 0, "byteOffset": len(self._binary), "byteLength": array.nbytes}
        if target is not None:
            view["target"] = target
        self._binary.extend(array.astype(array.dtype.newbyteorder("<"), copy=False).tobytes())
        rows = array.reshape(len(array), -1)
        part: Json = {
            "bufferView": self.add("bufferViews", view),
            "componentType": _COMPONENTS[array.dtype.name],
            "count": len(rows),
            "type": _WIDTHS[rows.shape[1]],
        }
        if normalized:
            part["normalized"] = True
        if bounds:
            part |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        return self.add("accessors", part)

    def zeros(self, count: int) -> int:
        """So many vectors that are nought: an accessor without data, by the format's rule."""
        part: Json = {"componentType": _COMPONENTS["float32"], "count": count, "type": "VEC3"}
        return self.add("accessors", part | {"min": [0.0] * 3, "max": [0.0] * 3})

    def indices(self, faces: NDArray[np.integer]) -> int:
        """Store triangles (F, 3) in the smallest index type that holds them."""
        flat = np.asarray(faces).reshape(-1)
        return self.accessor(flat.astype(np.uint16 if flat.max() < 0xFFFF else np.uint32), ELEMENT_ARRAY_BUFFER)

    def material(self, name: str, color: tuple[float, ...], roughness: float) -> int:
        """A matt material of an sRGB colour with or without alpha, which shines where it is brighter than 1; equal ones
        are shared."""
        key = (*(round(float(c), 4) for c in color), round(roughness, 3))
        if key not in self._materials:
            alpha = float(color[3]) if len(color) == 4 else 1.0
            light = [min(_to_linear(float(c)), 1.0) for c in color[:3]]
            look: Json = {
                "name": name,
                "pbrMetallicRoughness": {
                    "baseColorFactor": [*light, alpha],
                    "metallicFactor": 0.0,
                    "roughnessFactor": roughness,
                },
            }
            if max(color[:3]) > 1:
                look["emissiveFactor"] = light
            if alpha < 1:
                look |= {"alphaMode": "BLEND"}
            self._materials[key] = self.add("materials", look)
        return self._materials[key]

    def to_glb(self, roots: list[int]) -> bytes:
        """The whole file, with those nodes at the root of its scene."""
        document = {
            "asset": {"version": "2.0", "generator": "sims-stories"},
            "scene": 0,
            "scenes": [{"nodes": roots}],
            **self._parts,
            "buffers": [{"byteLength": len(self._binary)}],
        }
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        binary = bytes(self._binary) + b"\0" * (-len(self._binary) % 4)
        return b"".join(
            [
                struct.pack("<III", _MAGIC, 2, 28 + len(text) + len(binary)),
                struct.pack("<II", len(text), _JSON_CHUNK),
                text,
                struct.pack("<II", len(binary), _BINARY_CHUNK),
                binary,
            ]
        )


def read_glb(data: bytes) -> tuple[Json, bytes]:
    """The JSON and the binary buffer of a GLB; ValueError when it is none."""
    if len(data) < 28 or struct.unpack_from("<II", data) != (_MAGIC, 2):
        raise ValueError("not a glTF 2.0 binary (.glb): the first bytes must be 'glTF', version 2")
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def _to_linear(value: float) -> float:
    return round(value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4, 5)
