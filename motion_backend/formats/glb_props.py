"""What is in the hands as nodes of a GLB: each follows the hands where it is there, and is of no size elsewhere."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.formats.gltf_document import ARRAY_BUFFER, Animation, Document
from motion_backend.motion import Motion
from motion_backend.props import PropShape, PropTrack
from motion_backend.rotations import Array
from scene_graphs.json_fields import Json

STRAIGHT: Final = 1e-3
"""A change of pace, a frame, that nobody sees."""
ROUGHNESS: Final = 0.7


def add_props(document: Document, animation: Animation, tracks: Iterable[PropTrack], motion: Motion) -> list[int]:
    """A node for every prop, "prop_cup_0"; one that comes again is the same node, two at once are two."""
    meshes: dict[str, int] = {}
    nodes = []
    for number, lane in enumerate(lanes(tracks)):
        name = lane[0].prop
        if name not in meshes:
            meshes[name] = _add_mesh(document, name, lane[0].shape)
        frames, positions, turns, sizes = prop_keys(lane, len(motion))
        node: Json = {
            "name": f"prop_{name}_{number}",
            "mesh": meshes[name],
            "translation": positions[0].round(6).tolist(),
            "rotation": turns[0].round(6).tolist(),
            "scale": [round(float(sizes[0]), 6)] * 3,
        }
        nodes.append(document.add("nodes", node))
        steps = np.rint(turns * np.iinfo(np.int16).max).astype(np.int16)
        kept = bends(sizes[:, None])
        times, grown = (
            document.accessor((some / motion.fps).astype(np.float32), bounds=True) for some in (frames, frames[kept])
        )
        animation.animate(nodes[-1], "translation", times, document.accessor(positions.astype(np.float32)))
        animation.animate(nodes[-1], "rotation", times, document.accessor(steps, normalized=True))
        scales = sizes[kept, None].repeat(3, axis=1).astype(np.float32)
        animation.animate(nodes[-1], "scale", grown, document.accessor(scales))
    return nodes


def lanes(tracks: Iterable[PropTrack]) -> list[list[PropTrack]]:
    """Tracks of one prop that follow one another, as few rows as they fit into."""
    found: list[list[PropTrack]] = []
    for track in sorted(tracks, key=lambda one: one.start):
        free = (lane for lane in found if lane[0].prop == track.prop and lane[-1].stop < track.start)
        lane = next(free, None)
        if lane is None:
            found.append([track])
        else:
            lane.append(track)
    return found


def prop_keys(lane: Sequence[PropTrack], frames: int) -> tuple[NDArray[np.int64], Array, Array, Array]:
    """The keys of tracks that follow one another: frames (K,), positions (K, 3), turns (K, 4), sizes (K,).

    Around each is a key of no size where the motion has a frame for it; while nothing of it changes it has keys at both
    ends of that alone.
    """
    rows = [_padded(track, frames) for track in lane]
    numbers, positions, turns, sizes = (np.concatenate(column) for column in zip(*rows, strict=True))
    turns = rotations.continuous(rotations.normalize(turns))
    changes = np.any(np.diff(np.column_stack([positions, turns, sizes]), axis=0) != 0, axis=1)
    kept = np.concatenate([[True], changes]) | np.concatenate([changes, [True]])
    return numbers[kept], positions[kept], turns[kept], sizes[kept]


def _padded(track: PropTrack, frames: int) -> tuple[NDArray[np.int64], Array, Array, Array]:
    first, last = max(track.start - 1, 0), min(track.stop, frames - 1)
    numbers = np.arange(first, last + 1)
    inside = np.clip(numbers - track.start, 0, len(track.positions) - 1)
    there = (numbers >= track.start) & (numbers < track.stop)
    return numbers, track.positions[inside], track.turns[inside], np.where(there, track.sizes[inside], 0.0)


def bends(track: NDArray[np.floating]) -> NDArray[np.integer]:
    """The frames between which a track (T, K) runs straight: those around every change of pace, the first, the last."""
    pace = np.diff(track, axis=0)
    bent = np.any(np.abs(np.diff(pace, axis=0)) > STRAIGHT, axis=1)
    return np.flatnonzero(np.concatenate([[True], bent, [True]])) if len(track) > 1 else np.arange(1)


def _add_mesh(document: Document, name: str, shape: PropShape) -> int:
    """A primitive a colour; flat, since corners are not shared."""
    primitives = [
        {
            "attributes": {"POSITION": document.accessor(vertices, ARRAY_BUFFER, bounds=True)},
            "indices": document.indices(np.arange(len(vertices)).reshape(-1, 3)),
            "material": document.material(name, color, ROUGHNESS),
        }
        for color, vertices in of_one_color(shape)
    ]
    return document.add("meshes", {"name": name, "primitives": primitives})


def of_one_color(shape: PropShape) -> Iterator[tuple[tuple[float, ...], NDArray[np.float32]]]:
    """The triangles of a prop by colour: sRGB (over 1 it shines), and corners (3 F, 3), three a triangle."""
    corners = shape.vertices.reshape(-1, 3, 3)
    colors, which = np.unique(shape.colors, axis=0, return_inverse=True)
    for number, color in enumerate(colors):
        yield tuple(color.tolist()), corners[which.reshape(-1) == number].reshape(-1, 3)
