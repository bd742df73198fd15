"""Legs of a lying body: flat, bent with the feet on the mattress, crossed, drawn up, over an armrest, one foot down."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.held_poses import UP
from motion_backend.procedural.lie.lie_keys import BeforeEnd, Fold, FootDown, LyingLeg, OverEnd, SideLegs
from motion_backend.procedural.lie.lie_own import OwnWay
from motion_backend.procedural.pose import Pose
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton

THIGH, SHANK, HIP = 0.4165, 0.418, 0.088
"""Lengths, and how far a hip is from the middle (metres at 1.70 m)."""
KNEE: Final = 0.09
"""Half a knee and a little (metres)."""
FORWARDS: Final = 1.5
"""A thigh that may fold so far (radians) has all the room it needs."""
MIN_FOLD: Final = 0.3
"""Sine of how far a thigh folds at least, however little room there is."""
BEYOND: Final = 0.07
"""How far outside the edge of a bed a foot stands beside it (metres)."""
MIN_SPAN: Final = 0.01
MIN_ALONG: Final = 0.02
"""Squares of how far a thigh reaches level over the side of a bed at least, and down along it (metres)."""
SOLE: Final = 0.09
"""From an ankle to the sole of a foot with its toes up, and a little (metres at 1.70 m)."""
MAX_END: Final = 0.34
"""Legs go over an end that is no higher over the mattress than this (metres)."""
STRETCHED: Final = -0.75
"""An ankle that is farther down the bed is that of a stretched leg (metres at 1.70 m)."""
MIN_KNEE, DRAWN_UP = 6.0, 80.0
"""Knees of who lies on a side are bent at least so far, and hips so far where knees are drawn up (degrees)."""
BELOW, ABOVE_KNEE = (0.062, 0.045), 0.17
"""How high knee and ankle of the leg below, and the knee of the one above, are over what a body lies on a side on
(metres at 1.70 m)."""
BACK: Final[dict[str, tuple[str, str]]] = {
    "straight": ("flat", "flat"),
    "loose": ("loose", "loose"),
    "left_bent": ("bent", "flat"),
    "right_bent": ("flat", "bent"),
    "bent": ("bent", "bent"),
    "crossed": ("over", "under"),
    "left_down": ("aside", "flat"),
    "right_down": ("flat", "aside"),
}
"""Left and right leg of who lies on the back: rows of the table."""


@dataclass(frozen=True)
class SideBed:
    """What of a place legs of who lies on a side need to know."""

    surface: float
    """Height of the mattress (metres)."""
    room: float
    """How far it is before the body to what is in the way (metres)."""


def on_the_back(pose: Pose, legs: str, skeleton: Skeleton, rows: tuple[LyingLeg, ...], own: OwnWay) -> Pose:
    """Legs of who lies on the back."""
    left, right = BACK.get(legs, BACK["straight"])
    named = {row.name: row for row in rows}
    crossed = legs == "crossed"
    return _placed(pose, (_owned(named[left], own, 0, crossed), _owned(named[right], own, 1, crossed)), skeleton)


def _owned(leg: LyingLeg, own: OwnWay, index: int, crossed: bool) -> LyingLeg:
    """The leg as it lies this time: both go aside together where they cross, stretched ones stay so."""
    out, up, ahead = leg.ankle_m
    aside = own.ankle_aside[0] * (1 - 2 * index) if crossed else own.ankle_aside[index]
    along = own.ankle_along[index] if up > STRETCHED else 0.0
    return replace(
        leg,
        ankle_m=(out + float(aside), up + float(along), ahead),
        foot_out_rad=leg.foot_out_rad + float(own.foot_out[index]),
        knee_out_ratio=leg.knee_out_ratio + float(own.knee_out[index]),
    )


def on_a_side(pose: Pose, legs: SideLegs, side: str, bed: SideBed, skeleton: Skeleton, own: OwnWay) -> Pose:
    """Legs of who lies on the left or right side: the one below on the mattress, the other upon it."""
    folds = (_own_fold(fold, own) for fold in (legs.below, legs.above))
    below, above = (_folded(fold, bed.room / skeleton.scale) for fold in folds)
    folded = (below, above) if side == "left" else (above, below)
    pose = _placed(pose, (folded[0][0], folded[1][0]), skeleton)
    ankles, knees = pose.ankles.copy(), pose.knees.copy()
    for index, (_, knee) in enumerate(folded):
        high = BELOW if folded[index] is below else (ABOVE_KNEE, legs.above_ankle_up_m)
        ankles[index], knees[index] = _let_down(pose, knee, index, bed.surface, high, skeleton)
    return replace(pose, ankles=ankles, knees=knees)


def _let_down(
    pose: Pose, knee: Array, index: int, surface: float, high: tuple[float, float], skeleton: Skeleton
) -> tuple[Array, Array]:
    """Ankle and direction of the knee of a folded leg that swings aside about the trunk until knee and ankle are so
    `high` over the surface. (3,) each, in the world.

    Pelvis and trunk are not turned over by a whole right angle: knees before them would be in the air.
    """
    scale, way = skeleton.scale, 1.0 - 2.0 * index
    hip = np.array([way * HIP * scale, 0.0, 0.0])
    back = rotations.inverse(pose.hips)
    up = rotations.rotate(back, UP)

    def lowered(point: Array, height: float) -> Array:
        aside = (surface + height * scale - float(pose.pelvis[1]) - float(up[1:] @ point[1:])) / float(up[0])
        return np.array([aside, point[1], point[2]])

    ankle = lowered(rotations.rotate(back, pose.ankles[index] - pose.pelvis), high[1])
    leg, bent = rotations.normalize(ankle - hip), lowered(scale * knee, high[0]) - hip
    # Off the leg alone: a direction along it would swing a knee round it on its way there.
    aside = rotations.normalize(bent - (bent @ leg) * leg)
    return pose.pelvis + rotations.rotate(pose.hips, ankle), rotations.rotate(pose.hips, aside)


def _own_fold(fold: Fold, own: OwnWay) -> Fold:
    """The leg as it is bent this time; knees that are drawn up are no farther up than the table has them."""
    hip, knee = own.side_hip, own.side_knee
    if fold.hip_deg > DRAWN_UP:
        hip, knee = -abs(hip), -abs(knee)
    return replace(fold, hip_deg=fold.hip_deg + hip, knee_deg=max(fold.knee_deg + knee, MIN_KNEE))


def _folded(fold: Fold, room: float) -> tuple[LyingLeg, Array]:
    """The leg with its knee no farther forwards than there is room for (metres at 1.70 m), and where that knee is from
    the pelvis (3,)."""
    most = np.arcsin(np.clip((room - KNEE) / THIGH, MIN_FOLD, 1.0))
    thigh = min(np.radians(fold.hip_deg), most) if most < FORWARDS else np.radians(fold.hip_deg)
    shin = thigh - np.radians(fold.knee_deg)
    y = -THIGH * np.cos(thigh) - SHANK * np.cos(shin)
    z = THIGH * np.sin(thigh) + SHANK * np.sin(shin)
    pitch = float(np.radians(fold.plantar_deg) - shin)
    leg = LyingLeg("folded", (0.0, float(y), float(z)), pitch, knee_out_ratio=0.0, foot_out_rad=0.0)
    return leg, np.array([0.0, -THIGH * np.cos(thigh), THIGH * np.sin(thigh)])


def shortened(
    pose: Pose, room: tuple[float, float], skeleton: Skeleton, over_end: OverEnd, before_end: BeforeEnd
) -> Pose:
    """Straight legs where the place to lie is short: over what ends it if that is low, else with the knees up.

    `room` is the distance from pelvis to that end and its height above the mattress (metres).
    """
    length, height = room
    scale = skeleton.scale
    local = rotations.rotate(rotations.inverse(pose.hips), pose.ankles - pose.pelvis)
    feet, knees = pose.feet.copy(), pose.knees.copy()
    over = 0.0 < height < MAX_END
    row = over_end if over else before_end
    for index, side in enumerate((1.0, -1.0)):
        if -float(local[index, 1]) + SOLE * scale < length:
            continue
        if over:
            out, down = over_end.foot_out_m * side * scale, over_end.heel_down_m * scale
            local[index] = (out, -down, height - over_end.under_ankle_m)
        else:
            down = max(length - before_end.short_of_end_m * scale, before_end.min_heel_down_m * scale)
            local[index, 1:] = -down, -before_end.behind_m * scale
        pitch = rotations.rotvec_to_quat(np.array([row.foot_pitch_rad, 0.0, 0.0]))
        feet[index] = rotations.compose(pose.hips, pitch)
        knees[index] = rotations.rotate(pose.hips, np.array([row.knee_out_ratio * side, 0.0, 1.0]))
    return replace(pose, ankles=pose.pelvis + rotations.rotate(pose.hips, local), feet=feet, knees=knees)


def foot_down(pose: Pose, index: int, edge: tuple[float, float], skeleton: Skeleton, row: FootDown) -> Pose:
    """One leg over the side of a bed, its foot on the floor there; `edge` is the distance to it and its yaw.

    The body moves over to the edge by as much as the leg is short.
    """
    distance, outward = edge
    scale = skeleton.scale
    out = np.array([np.sin(outward), 0.0, np.cos(outward)])
    down_the_bed = rotations.rotate(pose.hips, np.array([0.0, -1.0, 0.0])) * [1.0, 0.0, 1.0]
    hip = pose.pelvis + rotations.rotate(pose.hips, np.array([HIP * (1 - 2 * index), 0.0, 0.0]) * scale)
    drop = hip[1] - (skeleton.ankle_height + SHANK * scale)
    span = float(np.sqrt(max((row.thigh_share * THIGH * scale) ** 2 - drop**2, MIN_SPAN)))
    aside = distance + BEYOND - HIP * scale
    moved = max(aside - row.out_share * span, 0.0)
    aside -= moved
    along = float(np.sqrt(max(span**2 - aside**2, MIN_ALONG)))
    ankle = hip + moved * out + aside * out + along * down_the_bed
    ankle[1] = skeleton.ankle_height
    ankles, feet, knees = pose.ankles + moved * out, pose.feet.copy(), pose.knees.copy()
    ankles[index] = ankle
    toes = rotations.normalize(row.toes_out_share * out + row.toes_along_share * down_the_bed)
    feet[index] = rotations.yaw_to_quat(float(np.arctan2(toes[0], toes[2])))
    knees[index] = toes + row.knee_up_ratio * UP
    planted = np.array([1.0 - index, float(index)])
    return replace(pose, pelvis=pose.pelvis + moved * out, ankles=ankles, feet=feet, knees=knees, planted=planted)


def _placed(pose: Pose, legs: tuple[LyingLeg, LyingLeg], skeleton: Skeleton) -> Pose:
    ankles, feet, knees = [], [], []
    for leg, way in zip(legs, (1.0, -1.0), strict=True):
        local = np.array(leg.ankle_m) * [way, 1.0, 1.0] * skeleton.scale
        ankles.append(pose.pelvis + rotations.rotate(pose.hips, local))
        turn = rotations.compose(
            rotations.rotvec_to_quat(np.array([0.0, way * leg.foot_out_rad, 0.0])),
            rotations.rotvec_to_quat(np.array([leg.foot_pitch_rad, 0.0, 0.0])),
        )
        feet.append(rotations.compose(pose.hips, turn))
        knees.append(rotations.rotate(pose.hips, np.array([way * leg.knee_out_ratio, 0.0, 1.0])))
    return replace(pose, ankles=np.stack(ankles), feet=np.stack(feet), knees=np.stack(knees), toes=np.zeros(2))
