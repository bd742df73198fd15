"""Where the legs of a sitter go: flat on the floor, stretched, crossed, spread, folded, one held up."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from motion_backend import rotations
from motion_backend.inverse_kinematics import leg_rotations, two_bone
from motion_backend.procedural.held_poses import FLOOR_REACH, FOOT_SPLAY, SHIN_REACH, UP, Seat, upright
from motion_backend.procedural.sit.sit_keys import SeatedLeg, SeatedLegs
from motion_backend.procedural.sit.sit_own import NOBODY, OwnSeat
from motion_backend.rotations import Array
from motion_backend.skeleton import ANKLE_HEIGHT, INDEX, Skeleton

CLEARS, THIGH_UNDER = 0.17, 0.068
"""A thigh's middle line comes down no farther to a seat's front edge, from the hip, for feet to stand before it
(metres), less what is under that line (metres at 1.70 m): seats give, and so does flesh."""
HEEL: Final = 0.055
"""Ankle to heel along the sole (metres at 1.70 m)."""
EASY_ANKLE: Final = 0.45
"""A foot that rests on its heel points so far down from square to the shin (radians)."""
MAX_TOES_UP: Final = 1.25
"""How far a foot on its heel is pitched up at most (radians)."""
ON_KNEE: Final = 0.12
"""Ankle over the knee it is laid on (metres at 1.70 m)."""
PAST_EDGE: Final = 0.08
"""How far past the front of the seat the ankle of a leg is that hands hold (metres)."""
THIGH: Final = 0.4165
SHANK: Final = 0.418
"""Lengths of the bones of a leg (metres at 1.70 m)."""
MIN_STRETCH: Final = 0.2
MAX_STRETCH: Final = 0.828
STRETCH_STEP: Final = 0.005
"""How far ahead of the pelvis a stretched foot is tried, from afar (metres at 1.70 m); a leg is no longer either."""
ON_HEEL: Final = 0.016
"""How much higher the ankle of a stretched leg is, on its heel, than that of a foot that stands (metres at 1.70 m)."""
BENT: Final = 0.817
"""A leg that reaches less far than this is not straight (metres at 1.70 m): its knee has less than 156 degrees."""
MAX_SINK: Final = 0.055
"""How far a thigh's middle line comes down to the seat's front edge at most, from the hip (metres at 1.70 m)."""
PERCH: Final = 0.06
"""So much of a seat is under a pelvis at least that slides to its front to stretch the legs (metres)."""
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
    "folded": ("folded_near", "folded_far"),
    "held": ("straight", "held"),
    "drawn": ("drawn", "drawn"),
}
"""What the left and the right leg do in each way of sitting: rows of the table."""
FREE_TO_STAND: Final = ("rest", "together", "open", "slouched", "ahead")
"""Rows of legs that may as well stand a little elsewhere."""
FREE_ASIDE: Final = ("straight", "drawn")
"""Rows of legs that may be farther out or in."""
CROSSED: Final = ("over", "under", "folded_near", "folded_far")
"""Rows of legs that go to a side only both together."""
APART: Final = 0.08
"""An ankle nearer than this to the middle is to stand beside the other one (metres at 1.70 m)."""
BEFORE_SEAT, LEAST_OUTWARDS = 0.065, 0.045
"""An ankle is so far before the seat at least, and so far from the middle (metres at 1.70 m)."""
STRAIGHT: Final = ("straight", "over", "under")
"""Rows of legs that are straight."""


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
    """One leg here: its ankle to the side (outwards), up from the floor and ahead of the pelvis (m), and the rest."""

    outwards: float
    up: float
    ahead: float
    knee_out: float
    """Yaw of the knee outwards (radians)."""
    knee_up: float
    foot: str
    """flat, heel (toes up as the shin leans) or free (square to the shin, a little pointed)."""
    on_knee: bool
    """Whether the ankle lies on the other knee, wherever that is."""


def seated_legs(
    seat: Seat, legs: str, skeleton: Skeleton, room: tuple[Room, Room], keys: SeatedLegs, own: OwnSeat = NOBODY
) -> Legs:
    """Both legs on a seat, where the left and the right foot have that much room."""
    ways = WAYS["folded" if legs == "crossed" and seat.is_low(skeleton.scale) else legs]
    hung = feet_hang(seat, skeleton.scale)
    solved: list[tuple[Array, Array, Array, float]] = []
    for index, way in enumerate(ways):
        ahead = _room_ahead(keys.of(way), index, room)
        leg = _leg(keys.of(way), seat, skeleton, ahead)
        if way in FREE_TO_STAND:
            leg = _elsewhere(leg, own, index, seat, skeleton.scale, ahead)
        elif way in FREE_ASIDE:
            leg = _aside(leg, own, index, skeleton.scale)
        elif way in CROSSED:
            leg = leg._replace(outwards=leg.outwards + (1 - 2 * index) * skeleton.scale * float(own.foot_out[0]))
        if leg.outwards > room[index].aside:
            share = room[index].aside / leg.outwards
            leg = leg._replace(outwards=room[index].aside, knee_out=share * leg.knee_out)
        if hung and leg.foot != "free":
            up = seat.pelvis[1] - keys.hanging.below_seat_m * skeleton.scale
            ahead = max(leg.ahead, keys.hanging.ahead_m * skeleton.scale)
            leg = leg._replace(up=up, ahead=ahead, foot="free", knee_up=keys.hanging.knee_up_ratio)
        solved.append(_placed(leg, index, seat, skeleton, solved))
    ankles, feet, knees, planted = (np.stack(values) for values in zip(*solved, strict=True))
    return Legs(ankles, feet, knees, planted)


def _room_ahead(row: SeatedLeg, index: int, room: tuple[Room, Room]) -> float:
    """How far a foot may go: one that crosses to the other side finds what is there, too."""
    return room[index].ahead if row.outwards_m >= 0 else min(one.ahead for one in room)


def _elsewhere(leg: _Leg, own: OwnSeat, index: int, seat: Seat, scale: float, room: float) -> _Leg:
    """A foot that stands a little elsewhere: not under the seat, nor in what is before it."""
    nearest = min(leg.ahead, max(seat.edge, 0.0) + BEFORE_SEAT * scale)
    ahead = leg.ahead + scale * float(own.foot_ahead[index])
    ahead = float(np.clip(ahead, nearest, max(leg.ahead, room)))
    leg = leg._replace(ahead=ahead)
    return leg if leg.outwards < APART * scale else _aside(leg, own, index, scale)


def _aside(leg: _Leg, own: OwnSeat, index: int, scale: float) -> _Leg:
    """A foot that is a little farther out, or in."""
    outwards = leg.outwards + scale * float(own.foot_out[index])
    return leg._replace(outwards=max(outwards, min(leg.outwards, LEAST_OUTWARDS * scale)))


def _leg(row: SeatedLeg, seat: Seat, skeleton: Skeleton, room: float) -> _Leg:
    """A leg as its row has it, for a body of that size on that seat."""
    scale, low = skeleton.scale, seat.is_low(skeleton.scale)
    outwards = row.low_outwards_m if low and row.low_outwards_m is not None else row.outwards_m
    up, foot = _height(row, seat, skeleton)
    return _Leg(
        outwards * scale,
        up,
        _ahead(row, seat, skeleton, room),
        row.knee_out_rad,
        row.knee_up_ratio,
        foot,
        on_knee=row.name == "on_knee",
    )


def _height(row: SeatedLeg, seat: Seat, skeleton: Skeleton) -> tuple[float, str]:
    """Height of an ankle over the floor (metres), and how the foot is on it; on a low seat held legs stand."""
    scale = skeleton.scale
    if row.ankle_height_m is not None:
        return row.ankle_height_m * scale, row.foot
    if row.below_seat_m is None:
        return skeleton.ankle_height + row.lifted_m * scale, row.foot
    return (
        (skeleton.ankle_height, "flat") if seat.is_low(scale) else (seat.pelvis[1] - row.below_seat_m * scale, "free")
    )


def _ahead(row: SeatedLeg, seat: Seat, skeleton: Skeleton, room: float) -> float:
    """How far an ankle is ahead of the pelvis (metres), with so much room for it."""
    scale, low = skeleton.scale, seat.is_low(skeleton.scale)
    shin = (FLOOR_REACH if low else SHIN_REACH) * scale
    if row.ahead_m is not None:
        ahead = (row.low_ahead_m if low and row.low_ahead_m is not None else row.ahead_m) * scale
    else:
        stretched = _stretch(seat.edge, _drop(seat, scale), scale)
        far = float(np.clip(stretched, MIN_STRETCH, max(room, SHIN_REACH * scale)))
        ahead = (1 - row.stretched_share) * shin + row.stretched_share * far + row.beyond_m * scale
    match row.name:
        case "slouched":
            return min(ahead, room)
        case "ahead":
            clears = _stretch(seat.edge, _drop(seat, scale), scale)
            return float(np.clip(ahead, shin, max(min(room, clears), shin)))
        case "held":
            return max(seat.edge + PAST_EDGE, ahead)
        case _:
            return min(ahead, max(room, shin)) if row.beyond_m else ahead


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
    if leg.on_knee:
        ankle = _on_the_knee(other[0], hip, lengths, skeleton, seat)
    limb = two_bone(hip, ankle, pole, lengths)
    if leg.foot == "free":
        _, shin = leg_rotations(limb)
        pointed = rotations.rotvec_to_quat(np.array([0.5 * EASY_ANKLE, 0.0, 0.0]))
        return ankle, rotations.compose(shin, pointed), pole, 0.0
    lean = float(np.arctan2(np.hypot(limb.lower[0], limb.lower[2]), -limb.lower[1]))
    pitch = float(np.clip(lean - EASY_ANKLE, 0.0, MAX_TOES_UP)) if leg.foot == "heel" else 0.0
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


def _drop(seat: Seat, scale: float) -> float:
    """From the hip down to the ankle of a foot on its heel (metres)."""
    return float(seat.pelvis[1]) - (ANKLE_HEIGHT + ON_HEEL) * scale


def is_to_be_straight(legs: str) -> tuple[bool, bool]:
    """Whether the left and the right leg of a way of sitting are to be straight."""
    left, right = WAYS[legs]
    return left in STRAIGHT, right in STRAIGHT


def bends_a_leg(seat: Seat, legs: str, skeleton: Skeleton, room: tuple[Room, Room], keys: SeatedLegs) -> bool:
    """Whether a leg that is to be straight has no room for it, or the seat is too high or too deep."""
    scale = skeleton.scale
    least = straight_reach(seat, scale) - STRETCH_STEP
    rows = [keys.of(way) for way in WAYS[legs]]
    return any(
        straight
        and (
            feet_hang(seat, scale)
            or _ahead(row, seat, skeleton, _room_ahead(row, index, room)) - row.beyond_m * scale < least
        )
        for index, (straight, row) in enumerate(zip(is_to_be_straight(legs), rows, strict=True))
    )


def straight_reach(seat: Seat, scale: float) -> float:
    """How far ahead of the pelvis an ankle is at least for its leg to be straight (metres)."""
    return float(np.sqrt(max((BENT * scale) ** 2 - _drop(seat, scale) ** 2, (MIN_STRETCH * scale) ** 2)))


def perch(seat: Seat, scale: float) -> float:
    """How far to the front of its seat a pelvis slides for legs to be straight on the floor ahead (metres)."""
    for edge in np.arange(seat.edge, PERCH, -STRETCH_STEP):
        if _stretch(float(edge), _drop(seat, scale), scale) >= straight_reach(seat, scale):
            return float(seat.edge - edge)
    return max(seat.edge - PERCH, 0.0)


def at_front(seat: Seat, scale: float) -> Seat:
    """The seat as one gets onto it and off it, with feet on the floor: short legs would go through it but at its very
    front."""
    slope = _slope(seat.feet_ahead(scale), float(seat.pelvis[1]) - ANKLE_HEIGHT * scale, scale)
    clears = (CLEARS - THIGH_UNDER * scale) / np.tan(slope) if slope > 0 else np.inf
    ahead = seat.edge - float(clears)
    if ahead <= 0 or seat.is_low(scale):
        return seat
    way = np.array([np.sin(seat.yaw), 0.0, np.cos(seat.yaw)])
    return Seat(seat.pelvis + ahead * way, seat.yaw, seat.back + ahead, seat.edge - ahead)


def feet_hang(seat: Seat, scale: float) -> bool:
    """Whether feet of who sits there do not come down to the floor."""
    return at_front(seat, scale) is not seat


def _stretch(edge: float, drop: float, scale: float) -> float:
    """How far ahead a stretched foot goes: as far as the thigh clears the seat's front edge, so far ahead (metres)."""
    for ahead in np.arange(MAX_STRETCH, SHIN_REACH, -STRETCH_STEP) * scale:
        if np.hypot(ahead, drop) > MAX_STRETCH * scale:
            continue
        if np.tan(_slope(float(ahead), drop, scale)) * edge < MAX_SINK * scale:
            return float(ahead)
    return SHIN_REACH * scale


def _slope(ahead: float, drop: float, scale: float) -> float:
    """How steeply a thigh goes down whose ankle is so far ahead of its hip and below it (metres; radians)."""
    thigh, shank, reach = THIGH * scale, SHANK * scale, float(np.hypot(ahead, drop))
    # The knee lies above the line from hip to ankle: the thigh's slope follows from the triangle they make.
    inner = np.arccos(np.clip((thigh**2 + reach**2 - shank**2) / (2 * thigh * reach), -1.0, 1.0))
    return float(np.arctan2(drop, ahead) - inner)
