"""Motions as JSON: what a browser or a script without numpy can read."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion_backend.motion import ContactGoal, Force, Motion, Note, Phase, PhaseKind, Simulated
from motion_backend.skeleton import Skeleton

DIGITS = 6
"""Decimals of every number: a micrometre, and about as much at the end of a limb."""

_NEEDED = ("fps", "joints", "parents", "offsets", "root_positions", "local_rotations")


def motion_to_dict(motion: Motion) -> dict[str, Any]:
    """Plain lists and numbers; metres, quaternions xyzw, each joint in its parent's frame."""
    return {
        "fps": motion.fps,
        "frames": len(motion),
        "joints": list(motion.skeleton.names),
        "parents": list(motion.skeleton.parents),
        "offsets": _rounded(motion.skeleton.offsets),
        "root_positions": _rounded(motion.root_positions),
        "local_rotations": _rounded(motion.local_rotations),
        "contacts": _rounded(motion.contacts),
        "actions": motion.actions.tolist(),
        "goals": [{"joint": goal.joint, "position": list(goal.position)} for goal in motion.goals],
        "completed": motion.completed,
        "reason": motion.reason,
        "phases": [phase_to_dict(phase) for phase in motion.phases],
        "notes": [{"keyframe": note.keyframe, "words": note.words} for note in motion.notes],
        "simulated": [asdict(one) for one in motion.simulated],
    }


def dict_to_motion(data: dict[str, Any]) -> Motion:
    """The inverse of `motion_to_dict`, to its digits; ValueError names the field that is missing."""
    missing = [field for field in _NEEDED if field not in data]
    if missing:
        raise ValueError(f"a motion needs {', '.join(missing)}")
    frames = len(data["root_positions"])
    goals = [(goal["joint"], goal["position"]) for goal in data.get("goals", [])]
    return Motion(
        root_positions=np.array(data["root_positions"], dtype=np.float32),
        local_rotations=np.array(data["local_rotations"], dtype=np.float32),
        contacts=np.array(data.get("contacts", np.zeros((frames, 4))), dtype=np.float32),
        skeleton=Skeleton(tuple(data["joints"]), tuple(data["parents"]), np.array(data["offsets"], dtype=np.float64)),
        actions=np.array(data.get("actions", [0] * frames), dtype=np.int32),
        fps=int(data["fps"]),
        goals=tuple(ContactGoal(joint, (x, y, z)) for joint, (x, y, z) in goals),
        completed=bool(data.get("completed", True)),
        reason=str(data.get("reason", "")),
        phases=tuple(_dict_to_phase(phase) for phase in data.get("phases", [])),
        notes=tuple(Note(note["keyframe"], str(note["words"])) for note in data.get("notes", [])),
        simulated=tuple(dict_to_simulated(row) for row in data.get("simulated", [])),
    )


def phase_to_dict(phase: Phase) -> dict[str, Any]:
    """What a body did in some frames, who made them, and why another backend than the one asked for."""
    row = {"part": phase.kind.value, "start": phase.start, "stop": phase.stop}
    who = {"backend": phase.backend, "fallback": phase.fallback or None}
    return row | who | ({"reacts": phase.reacts} if phase.reacts else {})


def _dict_to_phase(row: dict[str, Any]) -> Phase:
    kind, start, stop = PhaseKind(row["part"]), int(row["start"]), int(row["stop"])
    return Phase(kind, start, stop, str(row.get("backend", "")), str(row.get("fallback") or ""), row.get("reacts", ""))


def dict_to_simulated(row: dict[str, Any]) -> Simulated:
    """What a physics engine made of a part, from its fields as `dataclasses.asdict` has them."""
    return Simulated(**row | {"forces": tuple(Force(**force) for force in row["forces"])})


def json_bytes(motion: Motion) -> bytes:
    """The dictionary as UTF-8 text."""
    return json.dumps(motion_to_dict(motion), separators=(",", ":")).encode()


def read_json(data: bytes | str) -> Motion:
    """The motion of such a text."""
    return dict_to_motion(json.loads(data))


def _rounded(array: NDArray[np.floating]) -> list[Any]:
    # Through float64, since a rounded float32 would be written with all the digits of its error.
    return list(np.round(np.asarray(array, dtype=np.float64), DIGITS).tolist())
