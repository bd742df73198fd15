"""Where the legs of a sitter go: flat on the floor, stretched, crossed, spread, folded, one held up."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from motion_backend import rotations
from motion_backend.inverse_kinematics import leg_rotations, two_bone
from motion_backend.procedural.held_poses import FLOOR_REACH, FOOT_SPLAY, SHIN_REACH, UP, Seat, upright
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

HANGING: Final = 0.72
"""Above this pelvis height over the ankle feet hang (metres at 1.70 m)."""
HEEL: Final = 0.055
"""Ankle to heel along the sole (metres at 1.70 m)."""
EASY_ANKLE: Final = 0.45
"""A foot that rests on its heel points so far down from square to the shin (radians)."""
AHEAD: Final = 0.60
"""Seated pelvis to the ankle of a leg that carries the other on its knee (metres at 1.70 m): the lower that knee is,
the less the hip of the other has to turn outwards."""
ON_KNEE: Final = 0.09
"""Ankle over the knee it is laid on (metres at 1.70 m)."""
WAYS: Final[dict[str, tuple[str, str]]] = {
    "rest": ("rest", "rest"),
    "together": ("together", "together"),
    "slouched": ("slouched", "slouched"),
    "open": ("open", "open"),
    "straight": ("straight", "straight"),
    "left_straight": ("straight", "rest"),
    "right_straight": ("rest", "straight"),
    "feet_crossed": ("over", "under"),
    "crossed": ("ahead", "on_knee"),
    "held": ("straight", "held"),
    "drawn": ("drawn", "drawn"),
}
"""What the left and the right leg do in each way of sitting."""


@dataclass(frozen=True)
class Legs:
    """Handles of both legs, as in a `Pose`."""

    ankles: Array
    feet: Array
    knees: Array
    planted: Array


class Room(NamedTuple):
    """How far a foot may go before it meets something, from the middle of the seat (metres)."""

    ahead: float
    aside: float
    """Outwards: where the shin still has room beside it."""


class _Leg(NamedTuple):
    """One leg: its ankle to the side (outwards), up from the floor and ahead of the pelvis, and where its knee goes."""

    outwards: float
    up: float
    ahead: float
    knee_out: float = 0.10
    """Yaw of the knee outwards (radians)."""
    knee_up: float = 0.25
    foot: str = "flat"
    """flat, heel (toes up as the shin leans) or free (square to the shin, a little pointed)."""


def seated_legs(seat: Seat, legs: str, skeleton: Skeleton, room: tuple[Room, Room]) -> Legs:
    """Both legs on a seat, where the left and the right foot have that much room."""
    ways = ("tailor", "tailor") if legs == "crossed" and seat.is_low(skeleton.scale) else WAYS[legs]
    hung = seat.pelvis[1] - skeleton.ankle_height > HANGING * skeleton.scale
    solved: list[tuple[Array, Array, Array, float]] = []
    for index, way in enumerate(ways):
        leg = _leg(way, index, seat, skeleton, room[index].ahead)
        if leg.outwards > room[index].aside:
            share = (room[index].aside / leg.outwards) ** 2
            leg = leg._replace(outwards=room[index].aside, knee_out=share * leg.knee_out)
        if hung and leg.foot != "free":
            leg = leg._replace(up=seat.pelvis[1] - 0.36 * skeleton.scale, foot="free", knee_up=0.4)
        solved.append(_placed(leg, index, seat, skeleton, solved))
    ankles, feet, knees, planted = (np.stack(values) for values in zip(*solved, strict=True))
    return Legs(ankles, feet, knees, planted)


def _leg(way: str, index: int, seat: Seat, skeleton: Skeleton, room: float) -> _Leg:
    scale, floor = skeleton.scale, skeleton.ankle_height
    low = seat.is_low(skeleton.scale)
    shin = (FLOOR_REACH if low else SHIN_REACH) * scale
    far = float(np.clip(_stretch(seat, seat.pelvis[1] - floor, scale), 0.2, max(room, SHIN_REACH * scale)))
    match way:
        case "straight":
            return _Leg(0.10 * scale, floor, far, foot="heel")
        case "slouched":
            return _Leg(0.13 * scale, floor, min(0.5 * (shin + far), room), foot="heel", knee_out=0.2)
        case "under":
            return _Leg(-0.02 * scale, floor, far - 0.05 * scale, foot="heel")
        case "over":
            return _Leg(-0.06 * scale, floor + 0.12 * scale, far + 0.05 * scale, knee_up=0.4, foot="heel")
        case "open":
            return _Leg((0.34 if low else 0.28) * scale, floor, shin, knee_out=0.6)
        case "ahead":
            return _Leg(0.10 * scale, floor, float(np.clip(AHEAD * scale, shin, max(room, shin))))
        case "together":
            return _Leg(0.06 * scale, floor, shin, knee_out=0.0)
        case "drawn":
            return _Leg(0.09 * scale, floor, (0.34 if low else 0.30) * scale)
        case "tailor":
            near = 0.24 if index == 0 else 0.33
            return _Leg(-0.09 * scale, 0.055 * scale, near * scale, knee_out=1.0, knee_up=0.6, foot="free")
        case "held":
            ahead = max(seat.edge + 0.08, 0.38 * scale)
            up, foot = (floor, "flat") if low else (seat.pelvis[1] - 0.14 * scale, "free")
            return _Leg(0.06 * scale, up, ahead, knee_out=0.0, knee_up=1.0, foot=foot)
        case "on_knee":
            return _Leg(-0.14 * scale, 0.0, 0.33 * scale, knee_out=1.1, knee_up=0.7, foot="free")
        case _:
            return _Leg((0.12 if low else 0.10) * scale, floor, shin)


def _placed(
    leg: _Leg, index: int, seat: Seat, skeleton: Skeleton, other: list[tuple[Array, Array, Array, float]]
) -> tuple[Array, Array, Array, float]:
    """Ankle, foot, knee direction and whether the foot stands."""
    side, name = (1, "left") if index == 0 else (-1, "right")
    lengths = (-float(skeleton.offsets[INDEX["left_knee"], 1]), -float(skeleton.offsets[INDEX["left_ankle"], 1]))
    yaw = rotations.yaw_to_quat(seat.yaw)
    hip = seat.pelvis + rotations.rotate(yaw, skeleton.offsets[INDEX[f"{name}_hip"]])
    way = seat.yaw + side * leg.knee_out
    pole = np.array([np.sin(way), 0.0, np.cos(way)]) + leg.knee_up * UP
    ankle = seat.to_world((side * leg.outwards, leg.up, leg.ahead))
    if leg.up == 0.0:
        ankle = _on_the_knee(other[0], hip, lengths, skeleton, seat)
    limb = two_bone(hip, ankle, pole, lengths)
    if leg.foot == "free":
        _, shin = leg_rotations(limb)
        pointed = rotations.rotvec_to_quat(np.array([0.5 * EASY_ANKLE, 0.0, 0.0]))
        return ankle, rotations.compose(shin, pointed), pole, 0.0
    lean = float(np.arctan2(np.hypot(limb.lower[0], limb.lower[2]), -limb.lower[1]))
    pitch = float(np.clip(lean - EASY_ANKLE, 0.0, 1.25)) if leg.foot == "heel" else 0.0
    # The ankle of a foot on its heel: the lowest point of the sole is the heel's corner.
    over_floor = skeleton.ankle_height * np.cos(pitch) + HEEL * skeleton.scale * np.sin(pitch)
    ankle = ankle + (over_floor - skeleton.ankle_height) * UP
    return ankle, upright(seat.yaw + side * FOOT_SPLAY, -pitch), pole, float(leg.up <= skeleton.ankle_height)


def _on_the_knee(
    other: tuple[Array, Array, Array, float], hip: Array, lengths: tuple[float, float], skeleton: Skeleton, seat: Seat
) -> Array:
    """The ankle laid over the other knee: shin on thigh."""
    left = hip + rotations.rotate(rotations.yaw_to_quat(seat.yaw), 2 * skeleton.offsets[INDEX["left_hip"]])
    thigh = two_bone(left, other[0], other[2], lengths).upper
    return np.asarray(left + lengths[0] * thigh + ON_KNEE * skeleton.scale * UP)


def _stretch(seat: Seat, drop: float, scale: float) -> float:
    """How far ahead a stretched foot goes: as far as the thigh clears the seat's front edge (metres)."""
    thigh, shank = 0.4165 * scale, 0.418 * scale
    for ahead in np.arange(0.80, SHIN_REACH, -0.01) * scale:
        reach = float(np.hypot(ahead, drop))
        if reach > 0.80 * scale:
            continue
        # The knee lies above the line from hip to ankle: the thigh's slope follows from the triangle they make.
        inner = np.arccos(np.clip((thigh**2 + reach**2 - shank**2) / (2 * thigh * reach), -1.0, 1.0))
        sinks = np.tan(np.arctan2(drop, ahead) - inner) * seat.edge
        if sinks < 0.055 * scale:
            return float(ahead)
    return SHIN_REACH * scale
