"""Legs of a lying body: flat, bent with the feet on the mattress, crossed, drawn up, over an armrest, one foot down."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.held_poses import UP
from motion_backend.procedural.pose import Pose
from motion_backend.skeleton import Skeleton

THIGH, SHANK, HIP = 0.4165, 0.418, 0.088
"""Lengths, and how far a hip is from the middle (metres at 1.70 m)."""
KNEE: Final = 0.09
"""Half a knee and a little (metres)."""
BEYOND: Final = 0.07
"""How far outside the edge of a bed a foot stands beside it (metres)."""


@dataclass(frozen=True)
class Leg:
    """A left leg: ankle in the pelvis frame (left, towards the head, forwards; metres), and how the foot is turned."""

    ankle: tuple[float, float, float]
    pitch: float
    """0 looks forwards, positive tips the toes away from the head (radians)."""
    knee_out: float = 0.12
    """How far outwards the knee points, against forwards."""
    foot_out: float = 0.0
    """How far the toes fall outwards (radians)."""


FLAT = Leg((0.11, -0.822, -0.035), 0.35)
LOOSE = Leg((0.155, -0.815, -0.035), 0.5, knee_out=0.45, foot_out=0.55)
BENT = Leg((0.12, -0.47, -0.020), 1.45)
OVER = Leg((-0.02, -0.81, 0.062), 0.35)
UNDER = Leg((-0.015, -0.822, -0.035), 0.35)
ASIDE = Leg((0.24, -0.40, -0.020), 1.45, knee_out=0.75, foot_out=0.35)
BACK: Final[dict[str, tuple[Leg, Leg]]] = {
    "straight": (FLAT, FLAT),
    "loose": (LOOSE, LOOSE),
    "left_bent": (BENT, FLAT),
    "right_bent": (FLAT, BENT),
    "bent": (BENT, BENT),
    "crossed": (OVER, UNDER),
    "left_down": (ASIDE, FLAT),
    "right_down": (FLAT, ASIDE),
}
"""Left and right leg of who lies on the back."""


@dataclass(frozen=True)
class Fold:
    """A leg of who lies on a side: bends at hip and knee, plantar flexion (degrees), ankle to the left (metres)."""

    hip: float
    knee: float
    across: float
    plantar: float = 20.0

    def leg(self, room: float) -> Leg:
        """The leg with its knee no farther forwards than there is room for (metres at 1.70 m)."""
        most = np.arcsin(np.clip((room - KNEE) / THIGH, 0.3, 1.0))
        thigh = min(np.radians(self.hip), most) if most < 1.5 else np.radians(self.hip)
        shin = thigh - np.radians(self.knee)
        y = -THIGH * np.cos(thigh) - SHANK * np.cos(shin)
        z = THIGH * np.sin(thigh) + SHANK * np.sin(shin)
        return Leg((self.across, float(y), float(z)), float(np.radians(self.plantar) - shin), knee_out=0.0)


SIDE: Final[dict[str, tuple[Fold, Fold]]] = {
    "straight": (Fold(14, 22, 0.058), Fold(20, 34, 0.045)),
    "bent": (Fold(48, 78, 0.058), Fold(56, 86, 0.045)),
    "tucked": (Fold(96, 122, 0.058), Fold(104, 126, 0.040)),
    "gathered": (Fold(36, 82, 0.058), Fold(46, 92, 0.045)),
    "left_bent": (Fold(48, 78, 0.058), Fold(12, 20, 0.045)),
    "right_bent": (Fold(12, 20, 0.058), Fold(56, 86, 0.045)),
    "crossed": (Fold(3, 12, 0.055, 26), Fold(18, 10, 0.030, 26)),
}
"""The leg below and the leg above of who lies on a side; each as if it were the left one of its own side."""


def on_the_back(pose: Pose, legs: str, skeleton: Skeleton) -> Pose:
    """Legs of who lies on the back."""
    return _placed(pose, BACK.get(legs, BACK["straight"]), skeleton)


def on_a_side(pose: Pose, legs: str, side: str, room: float, skeleton: Skeleton) -> Pose:
    """Legs of who lies on the left or right side, one upon the other, with `room` metres before the body."""
    below, above = (fold.leg(room / skeleton.scale) for fold in SIDE.get(legs, SIDE["straight"]))
    return _placed(pose, (below, above) if side == "left" else (above, below), skeleton)


def shortened(pose: Pose, room: tuple[float, float], skeleton: Skeleton) -> Pose:
    """Straight legs where the place to lie is short: over what ends it if that is low, else with the knees up.

    `room` is the distance from pelvis to that end and its height above the mattress (metres).
    """
    length, height = room
    scale = skeleton.scale
    local = rotations.rotate(rotations.inverse(pose.hips), pose.ankles - pose.pelvis)
    feet, knees = pose.feet.copy(), pose.knees.copy()
    for index, side in enumerate((1.0, -1.0)):
        heel = -float(local[index, 1])
        if heel + 0.09 * scale < length:
            continue
        if 0.0 < height < 0.34:
            local[index] = (0.09 * side * scale, -0.80 * scale, height - 0.045)
            pitch = 0.15
        else:
            local[index, 1:] = -max(length - 0.20 * scale, 0.42 * scale), -0.02 * scale
            pitch = 1.45
        feet[index] = rotations.compose(pose.hips, rotations.rotvec_to_quat(np.array([pitch, 0.0, 0.0])))
        knees[index] = rotations.rotate(pose.hips, np.array([0.12 * side, 0.0, 1.0]))
    return replace(pose, ankles=pose.pelvis + rotations.rotate(pose.hips, local), feet=feet, knees=knees)


def foot_down(pose: Pose, index: int, edge: tuple[float, float], skeleton: Skeleton) -> Pose:
    """One leg over the side of a bed, its foot on the floor there; `edge` is the distance to it and its yaw.

    The body moves over to the edge by as much as the leg is short.
    """
    distance, outward = edge
    scale = skeleton.scale
    out = np.array([np.sin(outward), 0.0, np.cos(outward)])
    down_the_bed = rotations.rotate(pose.hips, np.array([0.0, -1.0, 0.0])) * [1.0, 0.0, 1.0]
    hip = pose.pelvis + rotations.rotate(pose.hips, np.array([HIP * (1 - 2 * index), 0.0, 0.0]) * scale)
    drop = hip[1] - (skeleton.ankle_height + SHANK * scale)
    span = float(np.sqrt(max((0.985 * THIGH * scale) ** 2 - drop**2, 0.01)))
    aside = distance + BEYOND - HIP * scale
    moved = max(aside - 0.72 * span, 0.0)
    aside -= moved
    along = float(np.sqrt(max(span**2 - aside**2, 0.02)))
    ankle = hip + moved * out + aside * out + along * down_the_bed
    ankle[1] = skeleton.ankle_height
    ankles, feet, knees = pose.ankles + moved * out, pose.feet.copy(), pose.knees.copy()
    ankles[index] = ankle
    toes = rotations.normalize(0.8 * out + 0.6 * down_the_bed)
    feet[index] = rotations.yaw_to_quat(float(np.arctan2(toes[0], toes[2])))
    knees[index] = toes + 0.9 * UP
    planted = np.array([1.0 - index, float(index)])
    return replace(pose, pelvis=pose.pelvis + moved * out, ankles=ankles, feet=feet, knees=knees, planted=planted)


def _placed(pose: Pose, legs: tuple[Leg, Leg], skeleton: Skeleton) -> Pose:
    ankles, feet, knees = [], [], []
    for leg, way in zip(legs, (1.0, -1.0), strict=True):
        local = np.array(leg.ankle) * [way, 1.0, 1.0] * skeleton.scale
        ankles.append(pose.pelvis + rotations.rotate(pose.hips, local))
        turn = rotations.compose(
            rotations.rotvec_to_quat(np.array([0.0, way * leg.foot_out, 0.0])),
            rotations.rotvec_to_quat(np.array([leg.pitch, 0.0, 0.0])),
        )
        feet.append(rotations.compose(pose.hips, turn))
        knees.append(rotations.rotate(pose.hips, np.array([way * leg.knee_out, 0.0, 1.0])))
    return replace(pose, ankles=np.stack(ankles), feet=np.stack(feet), knees=np.stack(knees), toes=np.zeros(2))
