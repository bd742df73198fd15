"""Settled on a seat: the trunk against the back or on its elbows, the legs, and the hands on what they lie on."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.emotion_style import arm_arrays
from motion_backend.procedural.held_poses import Seat, bend, upright
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.pose_solver import folded_within, solve
from motion_backend.procedural.sit.sit_keys import SitPose, Surface, Trunk
from motion_backend.procedural.sit.sit_legs import Room, bends_a_leg, seated_legs
from motion_backend.procedural.sit.sit_own import NOBODY
from motion_backend.procedural.sit.sit_styles import Seated
from motion_backend.procedural.touch.hand_rests import HOLDS, Hold, Holds, at_rest, hold_of, lay_hands, on_thing
from motion_backend.procedural.touch.handholds import Handholds, Pair
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

ON_THIGH = 0.105
"""Elbow above the middle of the thigh it lies on (metres at 1.70 m)."""
ELBOW = 0.045
"""Elbow above the table it lies on (metres at 1.70 m)."""
TO_TABLE = np.radians(np.arange(2.0, 48.0, 1.0))
"""Leans forward that are tried until the elbows of hands on a table are bent enough."""
EASY_TABLE = 0.70
"""A table's edge is no farther from the pelvis for hands that do something on it (metres at 1.70 m)."""
EASY_ELBOW = np.radians(116.0)
"""How far an elbow is open at most whose hand is on a table."""
HEAD_ON_ARMS = 0.13
"""The joint of a head that lies on arms, above the table these lie on (metres at 1.70 m)."""
AS_GOOD = 0.02
"""Elbows that are no farther off lie as well (metres at 1.70 m, of both)."""
LEANS = np.radians(np.arange(8.0, 76.0, 1.0))
"""Leans of the trunk that are tried until the elbows lie."""
LEANT_FORWARD = np.radians(26.0)
"""Who leans on the thighs is seen to lean: by so much at least."""
BEHIND_PELVIS = 0.12
"""From the pelvis joint to the skin of the back (metres)."""
BACKREST = 0.42
"""Above the seat, how high a trunk that leans back meets its backrest, measured along the trunk (metres)."""
MAX_SINE = 0.9
"""Sine of the lean that a backrest allows at most, however far behind it is."""
GIVES = 0.03
"""How far a backrest gives way (radians)."""


@dataclass(frozen=True)
class Place:
    """A seat with what is about it."""

    seat: Seat
    around: Handholds
    room: tuple[Room, Room]
    """Of the left and the right foot."""


def holds_of(style: Seated, place: Place, skeleton: Skeleton, keys: SitPose) -> Holds:
    """What the hands of a way of sitting lie on here; a surface that is not there is replaced by the thighs."""
    own = NOBODY if style.on_elbows else style.own
    left, right = (
        own.of_hand(_hold(name, index, place, skeleton.scale, keys), index) for index, name in enumerate(style.arms)
    )
    return left, right


def _hold(name: str, index: int, place: Place, scale: float, keys: SitPose) -> Hold | None:
    if name in SURFACES:
        return _on_surface(keys.surface_of(name), index, place, scale) or HOLDS[INSTEAD.get(name, "thighs")]
    return hold_of(name)


def _on_surface(row: Surface, index: int, place: Place, scale: float) -> Hold | None:
    """A hand on a surface that belongs to no body; None where it is not there."""
    if row.name in BUSY_ON_TABLE and not _reaches_table(place, scale):
        return None
    if row.name in ON_TABLE:
        points = place.around.on_table(place.seat, _inwards(row, place, scale), row.apart_m * scale)
    else:
        points = _palms(row.name, index, place.around)
    point = points[index]
    if point is None:
        return None
    return on_thing(point, place.seat.yaw, (1, -1)[index] * row.fingers_out_rad, row.elbow_direction)


def _reaches_table(place: Place, scale: float) -> bool:
    """Whether hands can do something on a table with bent elbows."""
    return place.around.table is not None and place.around.table <= EASY_TABLE * scale


def _palms(name: str, index: int, around: Handholds) -> Pair:
    """Where palms lie but on a table; beside the hips if that hand has no room behind them or at the edge."""
    match name:
        case "armrest":
            return around.armrests
        case "behind" | "propped" if around.behind[index] is not None:
            return around.behind
        case "edge" if around.edge[index] is not None:
            return around.edge
        case _:
            return around.beside


def _inwards(row: Surface, place: Place, scale: float) -> float:
    """From a table's edge to the palm (metres)."""
    inwards = row.inwards_m * scale
    if row.min_inwards_m is None:
        return inwards
    return float(np.clip(inwards - (place.around.table or 0.0), row.min_inwards_m, row.max_inwards_m))


def lacking(style: Seated, place: Place, skeleton: Skeleton, keys: SitPose) -> tuple[str, ...]:
    """What a way of sitting needs and is not there, and what is done instead (`Note.words`)."""
    said = _hands_lacking(style, place, skeleton)
    if style.legs == "held" and place.seat.is_low(skeleton.scale):
        said = (*said, "nothing to hang from: the right foot stands on the floor")
    if bends_a_leg(place.seat, style.legs, skeleton, place.room, keys.legs):
        said = (*said, "no room to stretch the legs: legs bent")
    if style.recline >= LEANS_BACK and _recline(replace(style, own=NOBODY), place, keys.trunk) < LEANT * np.radians(
        style.recline
    ):
        said = (*said, "nothing to lean back against: upright")
    return said


def _hands_lacking(style: Seated, place: Place, skeleton: Skeleton) -> tuple[str, ...]:
    """What the hands of a way of sitting were to be on and is not there, and where they are instead."""
    left, right = (_lost(name, index, place, skeleton.scale) for index, name in enumerate(style.arms))
    if left is not None and left == right:
        return (f"no {left[0]}: each hand {left[1]}",)
    sides = zip(("left", "right"), (left, right), strict=True)
    return tuple(f"no {lost[0]} on the {side}: {side} hand {lost[1]}" for side, lost in sides if lost is not None)


def _lost(name: str, index: int, place: Place, scale: float) -> tuple[str, str] | None:
    """What is not there for one hand, and where that is instead."""
    if name == "keys":
        return LACKED[name], "in the air"
    low = place.seat.is_low(scale)
    if name not in SURFACES:
        return (LACKED[name], WHERE[ON_THE_FLOOR[name]]) if low and name in LACKED else None
    on_table, around = name in ON_TABLE, place.around
    if name in BUSY_ON_TABLE and around.table is not None and not _reaches_table(place, scale):
        return "table in easy reach", WHERE["lap"]
    there = around.table is not None if on_table else _palms(name, index, around)[index] is not None
    if name == "behind" and there and not low:
        return LACKED[name], "on the seat"
    if low and name in ON_THE_FLOOR:
        return LACKED[name], WHERE[ON_THE_FLOOR[name]]
    return None if there else (LACKED[name], WHERE[INSTEAD.get(name, "thighs")])


def seated(start: Pose, place: Place, style: Seated, skeleton: Skeleton, keys: SitPose) -> tuple[Pose, Holds]:
    """Settled in a way of sitting, and what the hands lie on."""
    seat = place.seat
    if seat.is_low(skeleton.scale):
        style = _on_the_floor(style)
    legs = seated_legs(seat, style.legs, skeleton, place.room, keys.legs, style.own)
    wrists, elbows = arm_arrays(*style.arms)
    pose = replace(
        start,
        pelvis=seat.pelvis.copy(),
        spine=style.own.of_trunk(style.on_elbows or bool(BUSY_ON_TABLE & set(style.arms))),
        head=_head(style),
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
    holds = holds_of(style, place, skeleton, keys)
    if _reaches_table(place, skeleton.scale) and BUSY_ON_TABLE & set(style.arms):
        return _up_to_table(_leaning(pose, seat, -TO_TABLE, skeleton, keys.trunk), style, holds, skeleton), holds
    if style.on_elbows and style.arms == PILLOWS and place.around.table is not None:
        return _head_on_arms(_leaning(pose, seat, -LEANS, skeleton, keys.trunk), place, holds, skeleton), holds
    if style.on_elbows:
        leans = LEANS if _on_table(holds) else LEANS[LEANS >= LEANT_FORWARD]
        return _on_elbows(_leaning(pose, seat, -leans, skeleton, keys.trunk), place, holds, skeleton), holds
    back = np.array([_recline(style, place, keys.trunk)])
    return at_rest(_leaning(pose, seat, back, skeleton, keys.trunk).at(0), holds, skeleton), holds


SURFACES = (
    "armrest",
    "beside",
    "behind",
    "propped",
    "edge",
    "table",
    "keyboard",
    "paper",
    "pen",
    "desk",
    "pillow",
    "pillow_over",
)
"""What hands may lie on besides the body: of `Handholds`, "desk" being the table with the forearms on it."""
PILLOWS = ("pillow", "pillow_over")
"""Arms on a table with the head on them."""
ON_TABLE = ("table", "keyboard", "paper", "pen", "desk", *PILLOWS)
"""Those of them that are on a table."""
BUSY_ON_TABLE = frozenset(ON_TABLE) - {"desk", *PILLOWS}
"""And those on which hands do something: elbows are bent for that."""
INSTEAD = {"desk": "clasped"} | dict.fromkeys(PILLOWS, "forehead") | dict.fromkeys(BUSY_ON_TABLE, "lap")
"""Where hands lie if a surface is not there, on the thighs otherwise: who leans on a table leans on the thighs, who
sleeps on it has the head in the hands."""
LACKED = {
    "armrest": "armrest",
    "beside": "room beside the hips",
    "behind": "floor in reach",
    "propped": "room behind the hips",
    "edge": "room beside the thighs",
    "keys": "piano",
    "clasped": "seat to lean from",
    "folded": "lap to fold hands in",
    "folded_over": "lap to fold hands in",
} | dict.fromkeys(ON_TABLE, "table before the seat")
"""What is not there, of what hands were to be on, in words."""
WHERE = {
    "thighs": "on its thigh",
    "knees": "on its knee",
    "lap": "in the lap",
    "own_shin": "on its shin",
    "clasped": "in the other, its elbow on the thigh",
    "forehead": "at the forehead, its elbow on the thigh",
}
"""Where a hand is instead, in words."""
ON_THE_FLOOR = {
    "thighs": "knees",
    "crossed_ankle": "knees",
    "belly": "knees",
    "folded": "own_shin",
    "folded_over": "own_shin",
    "clasped": "own_shin",
    "desk": "own_shin",
    "pillow": "own_shin",
    "pillow_over": "own_shin",
}
"""Where hands lie instead where knees are up."""


CLEAR_OF_KNEES, CLEAR_OF_LEGS, TO_OWN_FEET = 10.0, 4.0, 34.0
"""How far one leans back whose arms are crossed behind knees that are up, and how far ahead at most over crossed legs,
and to one's own feet (degrees)."""


def _on_the_floor(style: Seated) -> Seated:
    """The same on the floor: hands on the knees or round the shins; who does something sits tailorwise, and so does who
    has the hands on the thighs."""
    left, right = (ON_THE_FLOOR.get(name, name) for name in style.arms)
    busy = style.doing not in ("", "music", "doze") or {"forehead", "thighs"} & set(style.arms)
    legs = "crossed" if busy and style.legs in ("rest", "together") else style.legs
    shins = "own_shin" in (left, right)
    # Between trunk and knees there is little room for arms.
    ahead = TO_OWN_FEET if "ankle" in (left, right) else CLEAR_OF_LEGS
    recline = max(style.recline, CLEAR_OF_KNEES if {"crossed", "hugging"} & {left, right} else -ahead)
    return replace(style, arms=(left, right), legs=legs, recline=recline, on_elbows=style.on_elbows and not shins)


PROPPED = 0.6
"""Arms that prop a trunk up leave so large a share of what its lean has of its own."""
LEANS_BACK, LEANT = 15.0, 0.7
"""Who leans back by so much (degrees) leans back by such a share of it at least, or it is said."""


def back_for(recline: float) -> float:
    """How far behind a pelvis its backrest is at least for such a lean back (degrees; metres)."""
    return float(BEHIND_PELVIS + BACKREST * np.sin(np.radians(max(recline, 0.0)) - GIVES))


def _head(style: Seated) -> Array:
    """How the head is held against the chest. (3,)."""
    own = style.own
    return bend(np.radians(style.head) + own.head_forward, np.radians(style.tilt), own.head_turn)


def _recline(style: Seated, place: Place, trunk: Trunk) -> float:
    """Backward lean of the trunk, as far as there is a back to lean against, or arms (radians)."""
    seat = place.seat
    propped = {"behind", "propped", "beside"} & set(style.arms)
    own = style.own.recline if style.recline else style.own.upright_recline
    own *= PROPPED if propped else 1.0
    wanted, most = np.radians(style.recline + own), np.radians(trunk.max_back_deg)
    met = np.pi if np.isinf(seat.back) else np.arcsin(np.clip((seat.back - BEHIND_PELVIS) / BACKREST, 0.0, MAX_SINE))
    if not propped and style.recline >= LEANS_BACK and met < most:
        # Who leans back lets the backrest bear it.
        wanted = max(wanted, met)
    borne = met < most if style.recline >= LEANS_BACK else np.isfinite(seat.back)
    free = np.radians(trunk.max_propped_deg if propped else trunk.max_free_deg)
    return float(min(wanted, met + GIVES, most if borne else free))


def _leaning(pose: Pose, seat: Seat, back: Array, skeleton: Skeleton, trunk: Trunk) -> Pose:
    """The same pose with its trunk leaned back by each of N angles (radians, forwards negative)."""
    many = pose.repeat(len(back))
    hips = upright(seat.yaw, -np.where(back > 0, trunk.hips_back_share, trunk.hips_forward_share) * back)
    spine_shares = np.where(back > 0, trunk.spine_back_share, trunk.spine_forward_share)
    spine = many.spine + np.stack([bend(-share * lean) for share, lean in zip(spine_shares, back, strict=True)])
    head = many.head + np.stack([bend(trunk.head_ahead_share * max(lean, 0.0)) for lean in back])
    leaned = replace(many, hips=hips, spine=spine, head=head)
    return folded_within(leaned, skeleton) if seat.is_low(skeleton.scale) else leaned


def _up_to_table(leans: Pose, style: Seated, holds: Holds, skeleton: Skeleton) -> Pose:
    """The least of N leans towards a table in which both elbows are easily bent; the eyes where they were to look."""
    sides = (1.0, -1.0)
    poles = np.stack(
        [
            pole if h is None else np.asarray(h.elbow) * [s, 1, 1]
            for pole, h, s in zip(leans.elbows[0], holds, sides, strict=True)
        ]
    )
    down = np.radians(style.head) - TO_TABLE
    heads = _head(style) + np.stack([bend(pitch - np.radians(style.head)) for pitch in down])
    laid = np.array([0.0 if hold is None else 1.0 for hold in holds])
    many = replace(
        leans, head=heads, elbows=np.tile(poles, (len(leans), 1, 1)), reaching=np.tile(laid, (len(leans), 1))
    )
    _, local = solve(lay_hands(many, holds, skeleton), skeleton)
    bent = np.stack([rotations.quat_to_rotvec(local[:, INDEX[f"{side}_elbow"]]) for side in ("left", "right")], axis=1)
    opened = np.pi - np.linalg.norm(bent, axis=-1)
    easy = (opened <= EASY_ELBOW) | (laid == 0.0)
    chosen = int(np.argmax(easy.all(axis=1))) if easy.all(axis=1).any() else int(np.argmin(opened.max(axis=1)))
    return at_rest(many.at(chosen), holds, skeleton)


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
        if _on_table(holds):
            gap += np.abs(elbow[:, 1] - place.around.table_top - ELBOW * skeleton.scale)
        else:
            gap += np.abs(_from_bone(elbow, hip, knee) - ON_THIGH * skeleton.scale)
    # The least lean that is as good as any: farther down arms are between knees and trunk.
    return at_rest(leans.at(int(np.argmax(gap < gap.min() + AS_GOOD * skeleton.scale))), holds, skeleton)


def _on_table(holds: Holds) -> bool:
    """Whether hands lie on what is no part of the body."""
    return holds[0] is not None and holds[0].part == ""


def _head_on_arms(leans: Pose, place: Place, holds: Holds, skeleton: Skeleton) -> Pose:
    """The one of N leans in which the head lies on the arms on a table."""
    positions, _ = skeleton.forward_kinematics(*solve(leans, skeleton))
    over = positions[:, INDEX["head"], 1].astype(np.float64) - place.around.table_top
    return at_rest(leans.at(int(np.argmin(np.abs(over - HEAD_ON_ARMS * skeleton.scale)))), holds, skeleton)


def _from_bone(points: Array, start: Array, end: Array) -> Array:
    """Distance of each of N points from its bone. (N,)."""
    bone = end - start
    share = np.clip(np.sum((points - start) * bone, axis=1) / np.sum(bone**2, axis=1), 0.0, 1.0)
    return np.asarray(np.linalg.norm(points - start - share[:, None] * bone, axis=1))
