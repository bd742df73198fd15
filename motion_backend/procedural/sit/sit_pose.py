"""Settled on a seat: the trunk against the back or on its elbows, the legs, and the hands on what they lie on."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from motion_backend.procedural.collision_avoidance.body_collision import arms_inside
from motion_backend.procedural.emotion_style import arm_arrays
from motion_backend.procedural.held_poses import Seat, bend, upright
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.pose_solver import solve
from motion_backend.procedural.sit.sit_legs import Room, seated_legs
from motion_backend.procedural.sit.sit_styles import Seated
from motion_backend.procedural.touch.hand_rests import (
    BACK,
    HOLDS,
    Handholds,
    Hold,
    Holds,
    Pair,
    at_rest,
    hold_of,
    lay_hands,
    on_thing,
)
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

ON_THIGH = 0.105
"""Elbow above the middle of the thigh it lies on (metres at 1.70 m)."""
ELBOW = 0.045
"""Elbow above the table it lies on (metres at 1.70 m)."""
NEAR_TABLE, FARTHER = 0.28, 70.0
"""Beyond this distance of a table's edge one leans towards it, so many degrees a metre."""
LEANS = np.radians(np.arange(8.0, 62.0, 1.0))
"""Leans of the trunk that are tried until the elbows lie."""


@dataclass(frozen=True)
class Place:
    """A seat with what is about it."""

    seat: Seat
    around: Handholds
    room: tuple[Room, Room]
    """Of the left and the right foot."""
    elbows: tuple[float, float] = (np.inf, np.inf)
    """How far to the left and to the right of the middle there is room for elbows (metres)."""


def holds_of(style: Seated, place: Place, skeleton: Skeleton) -> Holds:
    """What the hands of a way of sitting lie on here; a surface that is not there is replaced by the thighs."""
    left, right = (_hold(name, index, place, skeleton.scale) for index, name in enumerate(style.arms))
    return left, right


def _hold(name: str, index: int, place: Place, scale: float) -> Hold | None:
    if name in SURFACES:
        return _on_surface(name, index, place, scale) or HOLDS[INSTEAD.get(name, "thighs")]
    return hold_of(name)


def _on_surface(name: str, index: int, place: Place, scale: float) -> Hold | None:
    """A hand on a surface that belongs to no body; None where it is not there."""
    around, side, yaw = place.around, (1, -1)[index], place.seat.yaw
    beside, inwards = around.beside, np.clip(0.78 * scale - (around.table or 0.0), 0.12, 0.26)
    surfaces: dict[str, tuple[Pair, float, tuple[float, float, float]]] = {
        "armrest": (around.armrests, 0.0, (0.9, -0.3, -0.7)),
        "beside": (beside, 0.2, BACK),
        "behind": (around.behind if around.behind[index] is not None else beside, 0.6, (0.7, 0.1, -0.8)),
        "edge": (around.edge if around.edge[index] is not None else beside, 0.3, BACK),
        "table": (around.on_table(place.seat, 0.12 * scale, 0.30 * scale), -0.15, (0.7, -0.6, -0.3)),
        "desk": (around.on_table(place.seat, float(inwards), 0.20 * scale), -0.5, (0.9, -0.5, 0.0)),
    }
    points, turned, elbow = surfaces[name]
    point = points[index]
    return None if point is None else on_thing(point, yaw, side * turned, elbow)


def lacking(style: Seated, place: Place, skeleton: Skeleton) -> tuple[str, ...]:
    """What the hands of a way of sitting were to be on and is not there, and where they are instead (`Note.words`)."""
    left, right = (_lost(name, index, place, skeleton.scale) for index, name in enumerate(style.arms))
    if left is not None and left == right:
        return (f"no {left[0]}: each hand {left[1]}",)
    sides = zip(("left", "right"), (left, right), strict=True)
    return tuple(f"no {lost[0]} on the {side}: {side} hand {lost[1]}" for side, lost in sides if lost is not None)


def _lost(name: str, index: int, place: Place, scale: float) -> tuple[str, str] | None:
    """What is not there for one hand, and where that is instead."""
    if name == "keys":
        return LACKED[name], "in the air"
    if name not in SURFACES:
        return None
    low, there = place.seat.is_low(scale), _on_surface(name, index, place, scale) is not None
    if name == "behind" and there and not low:
        return LACKED[name], "on the seat"
    if low and name in ON_THE_FLOOR:
        return LACKED[name], WHERE[ON_THE_FLOOR[name]]
    return None if there else (LACKED[name], WHERE[INSTEAD.get(name, "thighs")])


def seated(start: Pose, place: Place, style: Seated, skeleton: Skeleton) -> tuple[Pose, Holds]:
    """Settled in a way of sitting, and what the hands lie on."""
    seat = place.seat
    if seat.is_low(skeleton.scale):
        style = _on_the_floor(style)
    legs = seated_legs(seat, style.legs, skeleton, place.room)
    wrists, elbows = arm_arrays(*style.arms)
    pose = replace(
        start,
        pelvis=seat.pelvis.copy(),
        head=bend(np.radians(style.head), np.radians(style.tilt)),
        ankles=legs.ankles,
        feet=legs.feet,
        toes=np.zeros(2),
        knees=legs.knees,
        arms=wrists,
        elbows=elbows,
        reach=legs.ankles,
        reaching=np.zeros(2),
        pressing=np.zeros(2),
        planted=legs.planted,
    )
    holds = holds_of(style, place, skeleton)
    if style.on_elbows:
        return _on_elbows(_leaning(pose, seat, -LEANS), place, holds, skeleton), holds
    rested = at_rest(_leaning(pose, seat, np.array([_recline(style, place)])).at(0), holds, skeleton)
    inside = arms_inside(rested.repeat(1), seat, place.elbows, skeleton, np.ones(1))
    return lay_hands(inside, holds, skeleton).at(0), holds


SURFACES = ("armrest", "beside", "behind", "edge", "table", "desk")
"""What hands may lie on besides the body: of `Handholds`, "desk" being the table with the forearms on it."""
INSTEAD = {"desk": "knees", "table": "lap"}
"""Where hands lie if a surface is not there; on the thighs otherwise."""
LACKED = {
    "armrest": "armrest",
    "beside": "room beside the hips",
    "behind": "floor in reach",
    "edge": "room beside the thighs",
    "table": "table before the seat",
    "desk": "table before the seat",
    "keys": "piano",
}
"""What is not there, of what hands were to be on, in words."""
WHERE = {
    "thighs": "on its thigh",
    "knees": "on its knee",
    "lap": "in the lap",
    "own_shin": "on its shin",
}
"""Where a hand is instead, in words."""
ON_THE_FLOOR = {
    "thighs": "knees",
    "crossed_ankle": "knees",
    "belly": "knees",
    "clasped": "own_shin",
    "desk": "own_shin",
}
"""Where hands lie instead where knees are up."""


CLEAR_OF_KNEES = 10.0
"""How far one leans back whose arms are crossed behind knees that are up (degrees)."""


def _on_the_floor(style: Seated) -> Seated:
    """The same on the floor: hands on the knees or round the shins; who does something sits tailorwise."""
    left, right = (ON_THE_FLOOR.get(name, name) for name in style.arms)
    busy = style.doing not in ("", "music") or "folded" in style.arms or "forehead" in style.arms
    legs = "crossed" if busy and style.legs in ("rest", "together") else style.legs
    shins = "own_shin" in (left, right)
    # Between trunk and knees there is little room for folded arms.
    recline = max(style.recline, CLEAR_OF_KNEES) if "crossed" in (left, right) else style.recline
    return replace(style, arms=(left, right), legs=legs, recline=recline, on_elbows=style.on_elbows and not shins)


def _recline(style: Seated, place: Place) -> float:
    """Backward lean of the trunk, as far as there is a back to lean against, or arms (radians)."""
    seat = place.seat
    limit = np.pi if np.isinf(seat.back) else np.arcsin(np.clip((seat.back - 0.12) / 0.42, 0.0, 0.9))
    propped = {"behind", "beside"} & set(style.arms)
    free = np.radians(24 if propped else 10)
    lean = style.recline
    if place.around.table is not None and "table" in style.arms:
        lean = min(lean, -FARTHER * (place.around.table - NEAR_TABLE))
    return float(min(np.radians(lean), float(limit) + 0.03, free if np.isinf(seat.back) else np.radians(40)))


def _leaning(pose: Pose, seat: Seat, back: Array) -> Pose:
    """The same pose with its trunk leaned back by each of N angles (radians, forwards negative)."""
    many = pose.repeat(len(back))
    hips = upright(seat.yaw, -np.where(back > 0, 0.6, 0.45) * back)
    spine = np.stack([bend(-(0.4 if lean > 0 else 0.55) * lean) for lean in back])
    # Who leans back still looks ahead, for the most part.
    head = many.head + np.stack([bend(0.5 * max(lean, 0.0)) for lean in back])
    return replace(many, hips=hips, spine=spine, head=head)


def _on_elbows(leans: Pose, place: Place, holds: Holds, skeleton: Skeleton) -> Pose:
    """The one of N leans in which the elbows lie on the thighs, or on the table where hands are on one; the arms of
    that one."""
    sides = (1.0, -1.0)
    poles = np.stack([np.asarray(h.elbow) * [s, 1, 1] for h, s in zip(holds, sides, strict=True) if h])
    many = replace(leans, elbows=np.tile(poles, (len(leans), 1, 1)), reaching=np.ones_like(leans.reaching))
    positions, _ = skeleton.forward_kinematics(*solve(lay_hands(many, holds, skeleton), skeleton))
    joints = positions.astype(np.float64)
    gap = np.zeros(len(leans))
    for name in ("left", "right"):
        hip, knee, elbow = (joints[:, INDEX[f"{name}_{joint}"]] for joint in ("hip", "knee", "elbow"))
        if holds[0] is not None and holds[0].part == "":
            gap += np.abs(elbow[:, 1] - place.around.table_top - ELBOW * skeleton.scale)
        else:
            gap += np.abs(_from_bone(elbow, hip, knee) - ON_THIGH * skeleton.scale)
    return at_rest(leans.at(int(np.argmin(gap))), holds, skeleton)


def _from_bone(points: Array, start: Array, end: Array) -> Array:
    """Distance of each of N points from its bone. (N,)."""
    bone = end - start
    share = np.clip(np.sum((points - start) * bone, axis=1) / np.sum(bone**2, axis=1), 0.0, 1.0)
    return np.asarray(np.linalg.norm(points - start - share[:, None] * bone, axis=1))
