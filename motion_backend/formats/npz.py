"""Motions as arrays: NPZ with every array exactly, AMASS's layout, and raw float32. The same bytes for the same motion.

Motions as AMASS lays them out: rotation vectors a frame, Z up, in an npz that readers of AMASS open.

The joints have SMPL's first 22 names, parents and order, and SMPL's rest pose: a T-pose that faces +Z with Y up, which
the pelvis's rotation stands up in a world with Z up. The bones are ours: `joint_offsets` says how long they are, and a
SMPL body put on these poses has feet and hands elsewhere by the difference. `trans` is the pelvis itself, where a SMPL
model adds its own rest pelvis to what it is given; take that away first.

Motions as bare numbers: world joint positions, (T, 22, 3) float32, little-endian, nothing before or after.
"""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.formats.motion_json import dict_to_simulated
from motion_backend.motion import ContactGoal, Floats, Motion, Note, Phase, PhaseKind, Simulated
from motion_backend.skeleton import Skeleton

VERSION = 1
_LONG_AGO = (1980, 1, 1, 0, 0, 0)
"""The zip format's zero: a real date would make equal motions differ."""


def write_npz(motion: Motion, path: Path | str) -> None:
    """Save a motion."""
    Path(path).write_bytes(npz_bytes(motion))


def npz_bytes(motion: Motion) -> bytes:
    """A motion for `numpy.load`, without pickle: arrays as in `Motion`, and the skeleton's beside them."""
    arrays: dict[str, NDArray[Any]] = {
        "version": np.array(VERSION),
        "fps": np.array(motion.fps),
        "root_positions": motion.root_positions,
        "local_rotations": motion.local_rotations,
        "contacts": motion.contacts,
        "actions": motion.actions,
        "joint_names": np.array(motion.skeleton.names),
        "joint_parents": np.array(motion.skeleton.parents, dtype=np.int32),
        "joint_offsets": motion.skeleton.offsets,
        "goal_joints": np.array([goal.joint for goal in motion.goals], dtype=np.str_),
        "goal_positions": np.array([goal.position for goal in motion.goals], dtype=np.float64).reshape(-1, 3),
        "completed": np.array(motion.completed),
        "reason": np.array(motion.reason),
        "phase_parts": np.array([phase.kind.value for phase in motion.phases], dtype=np.str_),
        "phase_backends": np.array([phase.backend for phase in motion.phases], dtype=np.str_),
        "phase_fallbacks": np.array([phase.fallback for phase in motion.phases], dtype=np.str_),
        "phase_frames": np.array([(phase.start, phase.stop) for phase in motion.phases], dtype=np.int32).reshape(-1, 2),
        "note_keyframes": np.array([note.keyframe for note in motion.notes], dtype=np.int32),
        "note_words": np.array([note.words for note in motion.notes], dtype=np.str_),
        "simulated": np.array([json.dumps(asdict(one)) for one in motion.simulated], dtype=np.str_),
    }
    if any(phase.reacts for phase in motion.phases):
        arrays["phase_reacts"] = np.array([phase.reacts for phase in motion.phases], dtype=np.str_)
    return archive(arrays)


def archive(arrays: Mapping[str, NDArray[Any]], level: int = 1) -> bytes:
    """An npz of arrays by name, compressed at a level of 1 to 9: the same bytes for the same arrays."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as entries:
        for name, array in arrays.items():
            entry = zipfile.ZipInfo(name + ".npy", _LONG_AGO)
            entry.compress_type = zipfile.ZIP_DEFLATED
            content = io.BytesIO()
            np.lib.format.write_array(content, np.ascontiguousarray(array).reshape(array.shape), allow_pickle=False)
            entries.writestr(entry, content.getvalue(), compresslevel=level)
    return file.getvalue()


def read_npz(file: Path | str | BinaryIO) -> Motion:
    """The motion that `write_npz` saved; ValueError for another version."""
    with np.load(file, allow_pickle=False) as data:
        if "version" not in data or int(data["version"]) != VERSION:
            raise ValueError(f"not a motion this version can read: its npz must have version = {VERSION}")
        skeleton = Skeleton(
            tuple(str(name) for name in data["joint_names"]),
            tuple(int(parent) for parent in data["joint_parents"]),
            data["joint_offsets"],
        )
        notes = zip(data["note_keyframes"].tolist(), data["note_words"], strict=True) if "note_words" in data else ()
        goals = zip(data["goal_joints"], data["goal_positions"].tolist(), strict=True)
        return Motion(
            root_positions=data["root_positions"],
            local_rotations=data["local_rotations"],
            contacts=data["contacts"],
            skeleton=skeleton,
            actions=data["actions"],
            fps=int(data["fps"]),
            goals=tuple(ContactGoal(str(joint), (x, y, z)) for joint, (x, y, z) in goals),
            completed=bool(data["completed"]),
            reason=str(data["reason"]),
            phases=_phases(data),
            notes=tuple(Note(keyframe, str(words)) for keyframe, words in notes),
            simulated=_simulated(data),
        )


def _simulated(data: Mapping[str, NDArray[Any]]) -> tuple[Simulated, ...]:
    """What a physics engine made; files of earlier versions have nothing of it."""
    rows = data["simulated"].tolist() if "simulated" in data else []
    return tuple(dict_to_simulated(json.loads(row)) for row in rows)


def _phases(data: Mapping[str, NDArray[Any]]) -> tuple[Phase, ...]:
    """The phases; files of earlier versions have none, or do not say who made them."""
    if "phase_parts" not in data:
        return ()
    kinds, nobody = data["phase_parts"].tolist(), [""] * len(data["phase_parts"])
    backends = data["phase_backends"].tolist() if "phase_backends" in data else nobody
    fallbacks = data["phase_fallbacks"].tolist() if "phase_fallbacks" in data else nobody
    reacts = data["phase_reacts"].tolist() if "phase_reacts" in data else nobody
    rows = zip(kinds, data["phase_frames"].tolist(), backends, fallbacks, reacts, strict=True)
    return tuple(
        Phase(PhaseKind(kind), start, stop, backend, why, how) for kind, (start, stop), backend, why, how in rows
    )


_STAND_UP = rotations.rotvec_to_quat(np.array([np.pi / 2, 0.0, 0.0]))
"""From a world with Y up to one with Z up: (x, y, z) becomes (x, -z, y)."""
_SHAPES = 16


def amass_bytes(motion: Motion) -> bytes:
    """poses (T, 66) radians, trans (T, 3) metres, mocap_framerate, and the skeleton they belong to.

    `betas` are zeros and `gender` neutral since readers ask for them; they say nothing about our body.
    """
    turns = motion.local_rotations.astype(np.float64)
    turns[:, 0] = rotations.compose(_STAND_UP, turns[:, 0])
    vectors = rotations.quat_to_rotvec(rotations.normalize(turns))
    return archive(
        {
            "poses": vectors.reshape(len(motion), -1).astype(np.float32),
            "trans": rotations.rotate(_STAND_UP, motion.root_positions.astype(np.float64)).astype(np.float32),
            "mocap_framerate": np.array(float(motion.fps)),
            "gender": np.array("neutral"),
            "betas": np.zeros(_SHAPES),
            "joint_names": np.array(motion.skeleton.names),
            "joint_parents": np.array(motion.skeleton.parents, dtype=np.int32),
            "joint_offsets": motion.skeleton.offsets,
        }
    )


def raw_bytes(motion: Motion) -> bytes:
    """World positions of all joints, frame by frame, metres."""
    return np.ascontiguousarray(motion.joint_positions(), dtype="<f4").tobytes()


def read_raw(data: bytes, joints: int = 22) -> Floats:
    """The positions (T, joints, 3); ValueError when the length is not a whole number of frames."""
    if len(data) % (12 * joints):
        raise ValueError(f"{len(data)} bytes are not a whole number of frames of {joints} joints (12 bytes each)")
    return np.frombuffer(data, dtype="<f4").reshape(-1, joints, 3).astype(np.float32)
