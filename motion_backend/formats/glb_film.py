"""Motions, homes and films as GLB: the skinned mannequin with its animation, what it holds, and furniture around it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.body.cast import PLAIN, Role
from motion_backend.body.character_mesh import build_character
from motion_backend.body.face_track import expression, face_track
from motion_backend.body.skinning import Morphs, SkinnedMesh
from motion_backend.formats.glb_props import add_props, bends
from motion_backend.formats.gltf_document import ARRAY_BUFFER, Animation, Document
from motion_backend.motion import Emotion, Motion
from motion_backend.props import prop_tracks, replaced
from scene_graphs.json_fields import Json

if TYPE_CHECKING:
    from scene_graphs.home import Home

GROUPS = ("floor", "wall", "ceiling", "door", "window", "rug")
"""Meshes whose names begin so are merged into a node of that name; all others into "furniture"."""


class StaticMesh(Protocol):
    """What stands still: `scene_graphs.meshes.furniture_mesh.Mesh`, or anything alike."""

    @property
    def name(self) -> str: ...

    @property
    def vertices(self) -> NDArray[np.floating]:
        """(V, 3) in the world."""
        ...

    @property
    def faces(self) -> NDArray[np.integer]:
        """(F, 3)."""
        ...

    @property
    def color(self) -> tuple[float, ...]:
        """RGBA, 0 to 1, sRGB."""
        ...

    @property
    def roughness(self) -> float: ...


def body_glb(motion: Motion, role: Role = PLAIN) -> bytes:
    """The animated character alone."""
    document, animation = Document(), Animation()
    roots = _add_body(document, animation, motion, role)
    return _finished(document, animation, motion, roots)


def props_glb(motion: Motion, role: Role) -> bytes:
    """What is in the hands alone, animated; empty where that is nothing."""
    document, animation = Document(), Animation()
    roots = add_props(document, animation, prop_tracks(motion, role), motion)
    return _finished(document, animation, motion, roots) if roots else b""


def scene_glb(home: Home, role: Role = PLAIN) -> bytes:
    """The home alone, standing still; what moves of it in a role is left out."""
    return meshes_to_glb(home_meshes_of(home, role))


def film_glb(home: Home, motion: Motion, role: Role = PLAIN) -> bytes:
    """The home and the character acting in it, with what is in the hands, in one file."""
    document, animation = Document(), Animation()
    still = _add_meshes(document, home_meshes_of(home, role))
    body = _add_body(document, animation, motion, role)
    props = add_props(document, animation, prop_tracks(motion, role), motion)
    return _finished(document, animation, motion, [*still, *body, *props])


def _finished(document: Document, animation: Animation, motion: Motion, roots: list[int]) -> bytes:
    extras: Json = {"fps": motion.fps, "keyframes": _spans(motion)}
    document.add("animations", animation.to_dict() | {"extras": extras})
    return document.to_glb(roots)


def meshes_to_glb(meshes: Iterable[StaticMesh]) -> bytes:
    """Any meshes in the world as one still scene."""
    document = Document()
    return document.to_glb(_add_meshes(document, meshes))


def home_meshes_of(home: Home, role: Role = PLAIN) -> Sequence[StaticMesh]:
    """All that stands still in a film with that role."""
    from scene_graphs.meshes.furniture_mesh import home_meshes

    gone = replaced(role)
    return [mesh for mesh in home_meshes(home) if mesh.name not in gone]


def _add_meshes(document: Document, meshes: Iterable[StaticMesh]) -> list[int]:
    """Merge meshes by group and look, a node a group; few draw calls, and walls can be hidden at once."""
    nodes = []
    for group, looks in groups_of(meshes).items():
        primitives = []
        for (color, roughness), members in looks.items():
            vertices, faces = merged(members)
            primitives.append(
                {
                    # Without normals a viewer shades flat, which suits boxes and keeps the file small.
                    "attributes": {"POSITION": document.accessor(vertices, ARRAY_BUFFER, bounds=True)},
                    "indices": document.indices(faces),
                    "material": document.material(members[0].name, color, roughness),
                }
            )
        mesh_index = document.add("meshes", {"name": group, "primitives": primitives})
        nodes.append(document.add("nodes", {"name": group, "mesh": mesh_index}))
    return nodes


def groups_of(meshes: Iterable[StaticMesh]) -> dict[str, dict[tuple[tuple[float, ...], float], list[StaticMesh]]]:
    """Meshes by group, and in each by colour and roughness."""
    groups: dict[str, dict[tuple[tuple[float, ...], float], list[StaticMesh]]] = {}
    for mesh in meshes:
        group = next((g for g in GROUPS if mesh.name.startswith(g)), "furniture")
        groups.setdefault(group, {}).setdefault((tuple(mesh.color), mesh.roughness), []).append(mesh)
    return groups


def merged(meshes: Sequence[StaticMesh]) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Several as one: vertices (V, 3) and triangles (F, 3)."""
    starts = np.cumsum([0, *(len(m.vertices) for m in meshes[:-1])])
    vertices = np.concatenate([np.asarray(m.vertices, dtype=np.float32) for m in meshes])
    return vertices, np.concatenate([m.faces + start for m, start in zip(meshes, starts, strict=True)])


def _add_body(document: Document, animation: Animation, motion: Motion, role: Role) -> list[int]:
    """The nodes of the body and of its face, and its pelvis's node."""
    joints = _add_joints(document, motion)
    inverse_bind = np.tile(np.eye(4, dtype=np.float32), (len(joints), 1, 1))
    inverse_bind[:, 3, :3] = -motion.skeleton.rest_positions  # rows here are columns in the file
    skin = document.add(
        "skins",
        {"joints": joints, "skeleton": joints[0], "inverseBindMatrices": document.accessor(inverse_bind)},
    )
    mesh = build_character(motion.skeleton, role.look)
    body, face = (
        document.add("nodes", {"name": name, "mesh": _add_skinned_mesh(document, mesh, name), "skin": skin})
        for name in ("body", "face")
    )
    _animate(document, animation, motion, joints)
    if len(motion) > 1:
        _animate_face(document, animation, motion, face, face_track(motion, role))
    return [body, face, joints[0]]


def _add_joints(document: Document, motion: Motion) -> list[int]:
    """One node a joint; the body stands as in the first frame where no animation is played."""
    skeleton = motion.skeleton
    nodes = []
    for joint, name in enumerate(skeleton.names):
        offset = motion.root_positions[0] if skeleton.parents[joint] < 0 else skeleton.offsets[joint]
        rotation = rotations.normalize(motion.local_rotations[0, joint].astype(np.float64))
        nodes.append(
            document.add("nodes", {"name": name, "translation": _numbers(offset), "rotation": _numbers(rotation)})
        )
    for joint, node in enumerate(nodes):
        children = [nodes[c] for c, parent in enumerate(skeleton.parents) if parent == joint]
        if children:
            document.update("nodes", node, {"children": children})
    return nodes


def _numbers(values: NDArray[np.floating]) -> list[float]:
    return [round(float(v), 6) for v in values]


def _add_skinned_mesh(document: Document, mesh: SkinnedMesh, name: str) -> int:
    """The part of a mesh that moves with the joints alone, "body", or the one that also does by itself, "face"."""
    assert mesh.morphs is not None
    faced, morphs = name == "face", mesh.morphs
    primitives = []
    for index, look in enumerate(mesh.materials):
        own = mesh.faces[mesh.face_materials == index]
        used, faces = np.unique(own[(own[:, 0] >= morphs.first) == faced], return_inverse=True)
        if not len(used):
            continue
        shares = _shares(mesh.weights[used])
        holders = np.where(shares > 0, mesh.joints[used], 0).astype(np.uint8)
        attributes = {
            "POSITION": document.accessor(mesh.vertices[used], ARRAY_BUFFER, bounds=True),
            "NORMAL": document.accessor(mesh.normals[used], ARRAY_BUFFER),
            "JOINTS_0": document.accessor(holders, ARRAY_BUFFER),
            "WEIGHTS_0": document.accessor(shares, ARRAY_BUFFER, normalized=True),
        }
        material = document.material(look.name, look.color, look.roughness)
        primitive: Json = {"attributes": attributes, "indices": document.indices(faces), "material": material}
        if faced:
            primitive["targets"] = _targets(document, morphs, used - morphs.first)
        primitives.append(primitive)
    part: Json = {"name": name, "primitives": primitives}
    if faced:
        part |= {
            "weights": [0.0] * len(morphs.names),
            "extras": {"targetNames": list(morphs.names), "expressions": _expressions()},
        }
    return document.add("meshes", part)


def _expressions() -> dict[str, list[float]]:
    """The weights of every emotion, for players that have their own clock."""
    return {emotion.value: expression(emotion).tolist() for emotion in Emotion}


def _targets(document: Document, morphs: Morphs, used: NDArray[np.integer]) -> list[dict[str, int]]:
    """What moves some vertices of a face, by unit; those that do not share zeros, which take no room."""
    zeros = document.zeros(len(used))
    return [
        {"POSITION": document.accessor(offsets, ARRAY_BUFFER, bounds=True) if np.any(offsets) else zeros}
        for offsets in morphs.offsets[:, used]
    ]


def _shares(weights: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Weights (V, 4) that sum to 1 as 255ths that sum to 255: what rounding leaves over goes to the first, largest."""
    shares = np.rint(weights * 255).astype(np.int64)
    shares[:, 0] += 255 - shares.sum(axis=1)
    return np.asarray(shares, dtype=np.uint8)


def _animate(document: Document, animation: Animation, motion: Motion, joints: list[int]) -> None:
    """Every frame a key: the pelvis's way and the turn of every joint that turns at all.

    Turns are 16-bit, which halves the file and moves no joint by more than 0.2 mm.
    """
    times = document.accessor(np.arange(len(motion), dtype=np.float32) / np.float32(motion.fps), bounds=True)
    way = document.accessor(motion.root_positions.astype(np.float32))
    animation.animate(joints[0], "translation", times, way)
    turns = rotations.continuous(rotations.normalize(motion.local_rotations.astype(np.float64)))
    steps = np.rint(turns * np.iinfo(np.int16).max).astype(np.int16)
    for joint, node in enumerate(joints):
        if joint == 0 or (steps[:, joint] != steps[0, joint]).any():
            animation.animate(node, "rotation", times, document.accessor(steps[:, joint], normalized=True))


def _animate_face(
    document: Document, animation: Animation, motion: Motion, face: int, track: NDArray[np.floating]
) -> None:
    """What the face does, in 16 bits, as seldom as lines between keys allow."""
    kept = bends(track)
    seconds = document.accessor((kept / motion.fps).astype(np.float32), bounds=True)
    shares = np.rint(np.clip(track[kept], -1, 1) * np.iinfo(np.int16).max).astype(np.int16)
    animation.animate(face, "weights", seconds, document.accessor(shares.reshape(-1), normalized=True))


def _spans(motion: Motion) -> list[dict[str, Any]]:
    """When each keyframe is served, in seconds, so that a player can show captions."""
    starts = np.flatnonzero(np.diff(motion.actions, prepend=motion.actions[0] - 1))
    stops = [*starts[1:], len(motion)]
    return [
        {"keyframe": int(motion.actions[a]), "start": round(a / motion.fps, 4), "end": round(b / motion.fps, 4)}
        for a, b in zip(starts.tolist(), stops, strict=True)
    ]
