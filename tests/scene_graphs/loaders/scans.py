"""An invented scanned room, Z up, as labelled boxes: what 3RScan and ScanNet files of it would hold."""

from __future__ import annotations

import json
from math import cos, sin
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
Json = dict[str, Any]


class Piece(NamedTuple):
    """A box as scans have it: middle, full lengths, heading about the vertical from +x."""

    label: str
    middle: tuple[float, float, float]
    lengths: tuple[float, float, float]
    heading: float = 0.0

    def points(self, steps: int = 4) -> Points:
        """A grid of points on and in the box. (steps ** 3, 3)."""
        ticks = np.linspace(-0.5, 0.5, steps)
        grid = np.stack(np.meshgrid(ticks, ticks, ticks, indexing="ij"), axis=-1).reshape(-1, 3) * self.lengths
        turn = np.array(
            [[cos(self.heading), -sin(self.heading), 0], [sin(self.heading), cos(self.heading), 0], [0, 0, 1]]
        )
        return np.asarray(grid @ turn.T + np.array(self.middle))


ROOM = (
    Piece("floor", (2.0, 1.5, 0.0), (4.0, 3.0, 0.02)),
    Piece("wall", (2.0, 3.0, 1.25), (4.0, 0.1, 2.5)),
    Piece("door", (2.0, 0.0, 1.0), (0.9, 0.1, 2.0)),
    Piece("window", (4.0, 1.5, 1.5), (0.1, 1.2, 1.0)),
    Piece("bed", (1.0, 2.4, 0.35), (2.0, 1.0, 0.5)),
    Piece("pillow", (0.3, 2.4, 0.65), (0.4, 0.6, 0.1)),
    Piece("desk", (3.4, 2.6, 0.55), (1.2, 0.6, 0.4)),
    Piece("office chair", (3.4, 2.0, 0.45), (0.5, 0.5, 0.9)),
    Piece("mug", (3.2, 2.6, 0.8), (0.08, 0.08, 0.1)),
)
"""In metres, walls along the axes, the floor at height 0; the desk's legs were not scanned."""


TURN = 0.5
"""The scan is turned by this; its axisAlignment turns it back."""
INFO = (
    "axisAlignment = "
    + " ".join(map(str, (cos(TURN), sin(TURN), 0, 0, -sin(TURN), cos(TURN), 0, 0)))
    + " 0 0 1 0.7 0 0 0 1\nnumDepthFrames = 5\nsceneType = Bedroom / Hotel\n"
)


def scan() -> tuple[dict[str, Any], dict[str, Any], Points]:
    """Aggregation, segments and points of the room; every piece is two segments, every fifth point is nobody's."""
    groups, segments, points = [], [], []
    for number, piece in enumerate(ROOM):
        cloud = piece.points()
        groups.append(
            {"id": number, "objectId": number, "label": piece.label, "segments": [2 * number, 2 * number + 1]}
        )
        segments += [2 * number + (index >= 32) for index in range(len(cloud))]
        points.append(cloud)
    cloud = np.concatenate(points) - (0, 0, 0.7)
    back = np.array([[cos(TURN), sin(TURN), 0], [-sin(TURN), cos(TURN), 0], [0, 0, 1]])
    stray = np.array([[1.0, 1.0, 1.0]] * 9)
    aggregation = {"sceneId": "scannet.scene1", "segGroups": groups, "segmentsFile": "x"}
    return aggregation, {"segIndices": [*segments, *[999] * 9]}, np.concatenate([cloud @ back, stray])


def ply(points: Points, kind: str = "binary_little_endian") -> bytes:
    header = f"ply\nformat {kind} 1.0\ncomment invented\nelement vertex {len(points)}\n"
    header += "property float x\nproperty float y\nproperty float z\nproperty uchar red\n"
    header += "element face 0\nproperty list uchar int vertex_indices\nend_header\n"
    if kind == "ascii":
        return (header + "".join(f"{x} {y} {z} 7\n" for x, y, z in points)).encode()
    order = "<" if "little" in kind else ">"
    rows = np.zeros(len(points), dtype=[("p", f"{order}f4", 3), ("c", "u1")])
    rows["p"] = points
    return header.encode() + rows.tobytes()


def write(folder: Path, aggregation: Any, segments: Any, mesh: bytes, info: str | None = INFO) -> Path:
    (folder / "scene1.aggregation.json").write_text(json.dumps(aggregation))
    (folder / "scene1_vh_clean_2.0.010000.segs.json").write_text(json.dumps(segments))
    (folder / "scene1_vh_clean_2.ply").write_bytes(mesh)
    if info is not None:
        (folder / "scene1.txt").write_text(info)
    return folder


OBJECTS: Json = {
    "scans": [
        {
            "scan": "s1",
            "objects": [
                {"id": "1", "label": "floor"},
                {"id": "2", "label": "couch table"},
                {"id": "10", "label": "sofa"},
                {"id": "3", "label": "sofa chair"},
                {"id": "4", "label": "cup"},
                {"id": "5", "label": "wall"},
                {"id": "6", "label": "sofa"},
                {"id": "7", "label": "harp"},
            ],
        },
        {"scan": "s2", "objects": [{"id": "1", "label": "bed"}]},
    ]
}
RELATIONSHIPS: Json = {
    "scans": [
        {"scan": "s1", "split": 0, "relationships": [[2, 1, 14, "standing on"], [4, 2, 14, "standing on"]]},
        {"scan": "s2", "relationships": [[1, 1, 5, "close by"]]},
        {"scan": "s1", "split": 1, "relationships": [[2, 10, 5, "close by"], [10, 3, 2, "left"], [3, 10, 3, "right"]]},
        {
            "scan": "s1",
            "split": 2,
            "relationships": [[6, 10, 7, "same as"], [6, 3, 8, "bigger than"], [7, 1, 1, "none"]],
        },
    ]
}


def semseg(*pieces: Piece) -> Json:
    """The boxes of a scan; the axes are given in another order every time, as scans do."""
    groups = []
    for number, piece in enumerate(pieces):
        c, s = cos(piece.heading), sin(piece.heading)
        axes = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        order = np.roll([0, 1, 2], number)
        obb = {
            "centroid": list(piece.middle),
            "axesLengths": [piece.lengths[axis] for axis in order],
            "normalizedAxes": (axes[order] * (1 if number % 2 else -1)).ravel().tolist(),
        }
        groups.append({"id": number, "objectId": number, "label": piece.label, "segments": [1], "obb": obb})
    return {"scan_id": "s1", "segGroups": groups}
