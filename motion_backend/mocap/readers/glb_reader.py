"""Animated characters as glTF (.glb, .gltf with its data inside): every animation of the first skin is one clip.

Y up, facing +Z, metres. The skin's joints from where the body branches are the bones; nodes that only steer (IK
targets, foot controls) are left out, and what stands above the hips goes into their path.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.mocap.clip import MAX_JOINTS, MAX_TURNS, Bones, Clip, ClipError, make_bones, make_clip
from motion_backend.mocap.joint_map import JointMap
from motion_backend.mocap.resampling import resampled_positions, resampled_rotations, uniform_times
from motion_backend.mocap.rest_pose import t_posed
from motion_backend.rotations import Array
from scene_graphs.errors import FieldPath
from scene_graphs.loaders.gltf_reader import Document, list_of, numbers_of

MAX_ANIMATIONS: Final = 1_000
_MAX_NODES: Final = 20_000
_STEERS: Final = re.compile(r"IK(?![a-z])|^(control|ctrl)|pole", re.ASCII)
_STRETCH: Final = 0.01
"""Metres by which a bone's far end may move before it is said that it stays."""
_USUAL_RATES: Final = (10.0, 240.0)
_RATE: Final = 30.0
_WIDTHS: Final = {"translation": "VEC3", "rotation": "VEC4"}
_REST: Final = {"translation": [0.0, 0.0, 0.0], "rotation": [0.0, 0.0, 0.0, 1.0], "scale": [1.0, 1.0, 1.0]}


class Track(NamedTuple):
    """The keys of one property of one node."""

    times: Array
    """(K,) seconds, rising."""
    values: Array
    """(K, 3) or (K, 4)."""
    stepped: bool

    def at(self, wanted: Array) -> Array:
        """Values at those times. (T, 3) or (T, 4)."""
        if (self.values == self.values[0]).all():
            return np.broadcast_to(self.values[0], (len(wanted), self.values.shape[1]))
        sample = resampled_rotations if self.values.shape[1] == 4 else resampled_positions
        return sample(self.times, self.values, wanted, self.stepped)


Tracks = dict[tuple[int, str], Track]
"""By node and property."""


@dataclass(frozen=True)
class Rig:
    """The part of a document that moves."""

    document: Document
    above: tuple[int, ...]
    """Nodes from the top of the scene to the one over the root bone."""
    nodes: tuple[int, ...]
    """The node of each bone."""
    bones: Bones
    scale: float
    """Of the nodes above."""
    notes: tuple[str, ...]


def read_glb_clips(data: bytes, name: str, joints: JointMap | None = None) -> tuple[Clip, ...]:
    """One clip an animation, in the file's order. ClipError or LayoutError says what is wrong with the file."""
    document = Document.of(data, name)
    animations = list_of(document.json, "animations", document.at)
    if not 0 < len(animations) <= MAX_ANIMATIONS:
        raise ClipError(f"has {len(animations)} animations", f"1 to {MAX_ANIMATIONS} can be read", at=document.at)
    rig = _rig(document)
    rest = t_posed(rig.bones, _pose(rig, {}, np.zeros(1))[1][0], joints)
    clips, left = [], MAX_TURNS
    for number in range(len(animations)):
        clip, read = _clip(rig, number, rest, left)
        clips.append(clip)
        left -= read
    return tuple(clips)


def _clip(rig: Rig, number: int, rest: Array, left: int) -> tuple[Clip, int]:
    """An animation, and how many keys and rotations were read for it: no more than are left."""
    row = rig.document.item("animations", number)
    name = str(row.get("name") or f"animation {number}")
    tracks, notes = _tracks(rig.document, row, name, {*rig.above, *rig.nodes}, left)
    keys = [track.times for track in tracks.values()]
    if not keys:
        raise ClipError(f"animation {name!r} moves no bone")
    longest = max(keys, key=len)
    gap = float(np.median(np.diff(longest))) if len(longest) > 2 else 0.0
    fps = float(round(1 / gap)) if gap > 0 and _USUAL_RATES[0] <= round(1 / gap) <= _USUAL_RATES[1] else _RATE
    span = np.array([min(times[0] for times in keys), max(times[-1] for times in keys)])
    wanted = uniform_times(span, fps)
    if len(wanted) == 1:
        wanted = np.repeat(wanted, 2)
        notes.append("a pose, held for two frames")
    read = sum(len(times) for times in keys) + len(wanted) * len(rig.bones.names)
    if read > left:
        raise _too_many(rig.document)
    roots, turns, stretched = _moved(rig, tracks, wanted)
    if stretched:
        notes.append(f"translations of {stretched} bones dropped: bones keep their length")
    notes.append(f"keys resampled to {fps:g} frames a second")
    return make_clip(name, rig.bones, roots, turns, rest, fps, "glb", (*rig.notes, *notes)), read


def _too_many(document: Document) -> ClipError:
    return ClipError(f"has more than {MAX_TURNS} keys and rotations", "cut it into several files", at=document.at)


def _moved(rig: Rig, tracks: Tracks, wanted: Array) -> tuple[Array, Array, int]:
    roots, turns = _pose(rig, tracks, wanted)
    stretched = 0
    for node in rig.nodes[1:]:
        track = tracks.get((node, "translation"))
        stretched += track is not None and float(np.ptp(track.values, axis=0).max()) * rig.scale > _STRETCH
    return roots, turns, stretched


def _pose(rig: Rig, tracks: Tracks, wanted: Array) -> tuple[Array, Array]:
    """Root positions (T, 3) and local rotations (T, J, 4) at those times; the root's in the world."""
    place, turn, scale = np.zeros((len(wanted), 3)), np.tile(rotations.IDENTITY, (len(wanted), 1)), 1.0
    for node in (*rig.above, rig.nodes[0]):
        place = place + rotations.rotate(turn, scale * _values(rig.document, tracks, node, "translation", wanted))
        turn = rotations.compose(turn, _values(rig.document, tracks, node, "rotation", wanted))
        scale *= _scale(rig.document, node)
    turns = np.empty((len(wanted), len(rig.nodes), 4))
    turns[:, 0] = turn
    for joint, node in enumerate(rig.nodes[1:], start=1):
        turns[:, joint] = _values(rig.document, tracks, node, "rotation", wanted)
    return place, turns


def _values(document: Document, tracks: Tracks, node: int, path: str, wanted: Array) -> Array:
    """A node's property at those times, its rest value where nothing moves it. (T, 3 or 4)."""
    track = tracks.get((node, path))
    if track is not None:
        return track.at(wanted)
    value = _own(document, node, path)
    return np.broadcast_to(value, (len(wanted), len(value)))


def _own(document: Document, node: int, path: str) -> Array:
    row = document.item("nodes", node)
    if row.get("matrix") is not None:
        raise ClipError("has a matrix", "export bones with translation and rotation", at=document.at / "nodes" / node)
    where = document.at / "nodes" / node
    value = numbers_of(row, path, len(_REST[path]), where) if path in row else np.array(_REST[path])
    return _unit(value, where) if path == "rotation" else value


def _scale(document: Document, node: int) -> float:
    """The size of a node, alike along all axes."""
    sizes = _own(document, node, "scale")
    if not (np.abs(sizes - sizes[0]) < 0.01 * np.abs(sizes[0])).all() or not sizes[0] > 0:
        raise ClipError(
            f"is scaled by {sizes.tolist()}", "bones scale alike along all axes", at=document.at / "nodes" / node
        )
    return float(sizes[0])


def _unit(quaternions: Array, where: FieldPath) -> Array:
    lengths = np.linalg.norm(quaternions, axis=-1, keepdims=True)
    if not (np.abs(lengths - 1) < 0.1).all():
        raise ClipError("has a rotation that is no unit quaternion", at=where)
    return np.asarray(quaternions / lengths)


def _rig(document: Document) -> Rig:
    """The first skin's bones."""
    skin = document.item("skins", 0)
    joints = list_of(skin, "joints", document.at / "skins" / 0)
    rows = [document.item("nodes", joint) for joint in joints]
    if len(set(joints)) < len(joints) or not 0 < len(joints) <= MAX_JOINTS:
        raise ClipError(f"must have 1 to {MAX_JOINTS} joints, each once", at=document.at / "skins" / 0)
    named = {joint: str(row.get("name") or f"node {joint}") for joint, row in zip(joints, rows, strict=True)}
    bones = [joint for joint in joints if not _STEERS.search(named[joint])]
    parents = _parents(document)
    children: dict[int, list[int]] = {}
    for joint in bones:
        children.setdefault(parents.get(joint, -1), []).append(joint)
    tops = [joint for joint in bones if parents.get(joint, -1) not in bones]
    if len(tops) != 1:
        raise ClipError(f"has {len(tops)} root bones", "a body has one", at=document.at / "skins" / 0)
    root = tops[0]
    while len(children.get(root, [])) == 1:
        root = children[root][0]
    if root not in children:
        root = tops[0]
    above = tuple(reversed(list(_chain(parents, root))))
    kept = [joint for joint in bones if joint == root or root in _chain(parents, joint)]
    scale = float(np.prod([_scale(document, node) for node in above]))
    offsets = np.stack([scale * _own(document, joint, "translation") for joint in kept])
    numbers = {joint: place for place, joint in enumerate(kept)}
    tree = [-1 if joint == root else numbers.get(parents[joint], -2) for joint in kept]
    if -2 in tree:
        raise ClipError(f"{document.name}: bone {named[kept[tree.index(-2)]]!r} hangs on a node that is no bone")
    ordered, order = make_bones([named[joint] for joint in kept], tree, offsets)
    steering = len(joints) - len(bones)
    notes = (f"{steering} nodes left out that only steer (IK and controls)",) if steering else ()
    return Rig(document, above, tuple(kept[old] for old in order), ordered, scale, notes)


def _parents(document: Document) -> dict[int, int]:
    """Each node's parent. ClipError if a node has two."""
    rows = list_of(document.json, "nodes", document.at)
    if len(rows) > _MAX_NODES:
        raise ClipError(f"has more than {_MAX_NODES} nodes", at=document.at)
    parents: dict[int, int] = {}
    for number in range(len(rows)):
        for child in list_of(document.item("nodes", number), "children", document.at / "nodes" / number):
            document.item("nodes", child)
            if child in parents:
                raise ClipError("has two parents", "the nodes must be a tree", at=document.at / "nodes" / child)
            parents[child] = number
    return parents


def _chain(parents: dict[int, int], node: int) -> Iterator[int]:
    """The nodes above one, nearest first. ClipError if they run in a circle."""
    for _ in range(_MAX_NODES):
        if node not in parents:
            return
        node = parents[node]
        yield node
    raise ClipError("the nodes must be a tree; they run in a circle")


def _tracks(document: Document, row: dict[str, Any], name: str, nodes: set[int], left: int) -> tuple[Tracks, list[str]]:
    """How an animation moves those nodes, and notes; no more keys are read than are left."""
    where = document.at / f"animation {name!r}"
    samplers, tracks, notes = list_of(row, "samplers", where), Tracks(), set()
    timelines: dict[int, Array] = {}
    for channel in list_of(row, "channels", where):
        target = channel.get("target") if isinstance(channel, dict) else None
        if not isinstance(target, dict) or not isinstance(channel.get("sampler"), int):
            raise ClipError("has a channel without target or sampler", at=where)
        path, node = target.get("path"), target.get("node")
        if not isinstance(path, str) or not isinstance(node, int) or path not in _WIDTHS or node not in nodes:
            continue
        if not 0 <= channel["sampler"] < len(samplers) or not isinstance(samplers[channel["sampler"]], dict):
            raise ClipError(f"names sampler {channel['sampler']}, of which there are {len(samplers)}", at=where)
        if (node, path) in tracks:
            raise ClipError(f"moves the {path} of nodes[{node}] twice", at=where)
        sampler = samplers[channel["sampler"]]
        keys = document.accessor(sampler.get("input"), "SCALAR", where)
        if sampler["input"] not in timelines:
            timelines[sampler["input"]] = _key_times(keys, where)
        times = timelines[sampler["input"]]
        values = document.accessor(sampler.get("output"), _WIDTHS[path], where).astype(np.float64)
        if sampler.get("interpolation") == "CUBICSPLINE":
            values = values[1::3]
            notes.add("smooth curves between keys taken as straight")
        left -= len(times)
        if left < 0:
            raise _too_many(document)
        tracks[node, path] = _track(times, values, sampler.get("interpolation") == "STEP", where)
    return tracks, sorted(notes)


def _key_times(keys: NDArray[Any], where: FieldPath) -> Array:
    times = keys[:, 0].astype(np.float64)
    if not np.isfinite(times).all() or (times[1:] < times[:-1]).any():
        raise ClipError("has keys that are not finite or not in the order of time", at=where)
    return times


def _track(times: Array, values: Array, stepped: bool, where: FieldPath) -> Track:
    if len(times) != len(values) or not len(times):
        raise ClipError(f"has {len(times)} key times for {len(values)} values", at=where)
    if not np.isfinite(values).all():
        raise ClipError("has keys that are not finite or not in the order of time", at=where)
    return Track(times, _unit(values, where) if values.shape[1] == 4 else values, stepped)
