"""How true a retargeted clip is to its source: feet, floor, the directions of limbs, and whether to use it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from motion_backend import rotations
from motion_backend.metrics.joint_speed import joint_speeds
from motion_backend.mocap.foot_contacts import BALLS, Feet
from motion_backend.mocap.rest_pose import LIMBS, Rest, Source, shortest_turn
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

LEVEL = 0.02
"""Metres by which the lowest point of an accepted clip may miss the floor."""
SLACK = (1.15, 1.5)
"""Times, and cm/s beyond, that its feet may slide as fast as the source's: a few frames more or less near the floor
move the mean by as much."""
MAX_JOINT_TURN_RATE = 20.0
"""Radians a second that no joint turns faster, but for toes: at 12 Hz those of who walks snap down with 23."""
AWAY = 6.5
"""Degrees between limbs of source and copy, on average: a straight leg bends by six when its foot, which hovered half
a centimetre, is put down."""
_TRUNK = ("left_hip", "right_hip", "left_shoulder", "right_shoulder")
_HALVES = {"thigh": "hip", "shank": "knee", "upper arm": "shoulder", "forearm": "elbow"}


@dataclass(frozen=True)
class Fidelity:
    """Figures of one clip, its own beside the source's."""

    name: str
    source: str
    """Format it was read from."""
    family: str
    """Table of joint names that fitted, or "given"."""
    frames: int
    seconds: float
    source_fps: float
    ratio: float
    """Our leg's length over the source's."""
    skate: float
    """cm/s: mean horizontal speed of sole corners lower than 1 cm."""
    source_skate: float | None
    """The same of the source's ankles, at our size, carrying our soles; None for a toy, whose path says nothing."""
    depth: float
    """Mean depth of the lowest sole corner under the floor, metres."""
    source_depth: float | None
    lowest: float
    """Height of the lowest point of the skin over the whole clip, metres."""
    limbs: Mapping[str, tuple[float, float]]
    """Mean and largest degrees between the directions of a limb of the source and ours."""
    fastest: float
    """Radians a second of the fastest joint."""
    beyond_limits: float
    """Share of frames with a joint clearly beyond its range."""
    refused: tuple[str, ...]
    """Why the clip should not be used; empty if it may."""
    conversions: tuple[str, ...]
    """Everything that was changed, in words."""

    @property
    def accepted(self) -> bool:
        """Whether the clip may be used."""
        return not self.refused

    @property
    def limb_mean(self) -> float:
        """Degrees, over all limbs."""
        return float(np.mean([mean for mean, _ in self.limbs.values()]))

    @property
    def limb_max(self) -> float:
        """Degrees of the worst limb in the worst frame."""
        return max(most for _, most in self.limbs.values())

    def to_dict(self) -> dict[str, Any]:
        """Plain values, rounded for reading."""
        rounded = {key: round(value, 4) if isinstance(value, float) else value for key, value in asdict(self).items()}
        limbs = {name: {"mean": round(mean, 2), "max": round(most, 2)} for name, (mean, most) in self.limbs.items()}
        return rounded | {"limbs": limbs, "accepted": self.accepted}


def limb_differences(source: Source, rest: Rest, positions: Array) -> dict[str, tuple[float, float]]:
    """Mean and largest angle in degrees between limbs of the source and ours; positions (T, 22, 3) are ours.

    The trunk is the line from between the hips to between the shoulders. Bodies differ in where hips lie under an
    upright trunk, so the source's is turned by what its rest, which is upright, differs from ours.
    """
    found: dict[str, tuple[float, float]] = {}
    for name, part in _HALVES.items():
        chosen = [limb for limb in LIMBS if limb[0].endswith(part)]
        angles = [
            _angle(source.at(far)[:, 0] - source.at(near)[:, 0], positions[:, INDEX[far]] - positions[:, INDEX[near]])
            for near, far in chosen
        ]
        found[name] = (float(np.mean(angles)), float(np.max(angles)))
    pelvis = source.places["pelvis"]
    since_rest = rotations.compose(source.turns[:, pelvis], rotations.inverse(rest.source[pelvis]))
    upright = shortest_turn(rotations.normalize(rest.trunk), np.array([0.0, 1.0, 0.0]))
    theirs = rotations.rotate(rotations.inverse(since_rest), _trunk(source.at(*_TRUNK)))
    theirs = rotations.rotate(since_rest, rotations.rotate(upright, theirs))
    lean = _angle(theirs, _trunk(positions[:, [INDEX[joint] for joint in _TRUNK]]))
    found["trunk"] = (float(lean.mean()), float(lean.max()))
    return found


def _trunk(ends: Array) -> Array:
    return np.asarray((ends[:, 2:] - ends[:, :2]).mean(axis=1))


def _angle(a: Array, b: Array) -> Array:
    cosine = np.sum(rotations.normalize(a) * rotations.normalize(b), axis=-1)
    return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


def fastest_turn(local: Array, fps: float) -> float:
    """Radians a second of the fastest joint but the toes. (T, 22, 4)."""
    if len(local) < 2:
        return 0.0
    return float(np.delete(joint_speeds(local, fps), BALLS, axis=1).max())


def faults(
    feet: Feet, source_skate: float, lowest: float, limbs: Mapping[str, tuple[float, float]], fastest: float
) -> tuple[str, ...]:
    """What speaks against a clip."""
    skate, away = feet.skate(), max(mean for mean, _ in limbs.values())
    found = {
        f"its lowest point is {100 * lowest:+.1f} cm from the floor": abs(lowest) > LEVEL,
        f"feet slide at {skate:.1f} cm/s, the source's at {source_skate:.1f}": skate
        > SLACK[0] * source_skate + SLACK[1],
        f"a joint turns at {fastest:.0f} rad/s": fastest > MAX_JOINT_TURN_RATE,
        f"a limb points {away:.1f} degrees away from the source's": away > AWAY,
    }
    return tuple(text for text, true in found.items() if true)
