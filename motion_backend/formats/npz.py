"""Motions as NPZ: every array exactly, with the skeleton, and the same bytes for the same motion."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from motion_backend.motion import ContactGoal, Motion, Note, Part, Phase
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
        "phase_parts": np.array([phase.part.value for phase in motion.phases], dtype=np.str_),
        "phase_frames": np.array([(phase.start, phase.stop) for phase in motion.phases], dtype=np.int32).reshape(-1, 2),
        "note_keyframes": np.array([note.keyframe for note in motion.notes], dtype=np.int32),
        "note_words": np.array([note.words for note in motion.notes], dtype=np.str_),
    }
    return archive(arrays)


def archive(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """An npz of arrays by name: the same bytes for the same arrays."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as entries:
        for name, array in arrays.items():
            entry = zipfile.ZipInfo(name + ".npy", _LONG_AGO)
            entry.compress_type = zipfile.ZIP_DEFLATED
            content = io.BytesIO()
            np.lib.format.write_array(content, np.ascontiguousarray(array).reshape(array.shape), allow_pickle=False)
            entries.writestr(entry, content.getvalue(), compresslevel=1)
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
        phases = zip(data["phase_parts"], data["phase_frames"].tolist(), strict=True) if "phase_parts" in data else ()
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
            phases=tuple(Phase(Part(part), start, stop) for part, (start, stop) in phases),
            notes=tuple(Note(keyframe, str(words)) for keyframe, words in notes),
        )
