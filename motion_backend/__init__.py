"""A body and what moves it. May import `scene_graphs`, never the planner.

What a program needs that moves a body, or brings a backend of its own, stands here by name; everything is loaded when
it is first asked for.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from motion_backend.backend_protocol import BodyState, MotionBackend, Part, PartKind
    from motion_backend.backends import backend_names, load_backend
    from motion_backend.director import Director
    from motion_backend.formats import write_motion
    from motion_backend.formats.npz import read_npz
    from motion_backend.mocap.readers import read_clips
    from motion_backend.motion import (
        Action,
        Character,
        ContactGoal,
        Motion,
        Posture,
        Skill,
        join,
    )
    from motion_backend.skeleton import Skeleton, build_skeleton

__all__ = [
    "Action",
    "BodyState",
    "Character",
    "ContactGoal",
    "Director",
    "Motion",
    "MotionBackend",
    "Part",
    "PartKind",
    "Posture",
    "Skeleton",
    "Skill",
    "backend_names",
    "build_skeleton",
    "join",
    "load_backend",
    "read_clips",
    "read_npz",
    "write_motion",
]
_ROOMS = {
    "Action": "motion",
    "BodyState": "backend_protocol",
    "Character": "motion",
    "ContactGoal": "motion",
    "Director": "director",
    "Motion": "motion",
    "MotionBackend": "backend_protocol",
    "Part": "backend_protocol",
    "PartKind": "backend_protocol",
    "Posture": "motion",
    "Skeleton": "skeleton",
    "Skill": "motion",
    "backend_names": "backends",
    "build_skeleton": "skeleton",
    "join": "motion",
    "load_backend": "backends",
    "read_clips": "mocap.readers",
    "read_npz": "formats.npz",
    "write_motion": "formats",
}
"""Where each of them is defined, below this package."""


def __getattr__(name: str) -> object:
    """One of `__all__`, loaded with the module that defines it."""
    if name not in _ROOMS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_ROOMS[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
