"""Sitting down on a seat, staying there and standing up from it: the performers of sitting and of leaving a seat.

Where on a seat one sits for what hands are to lie on: beside an armrest, or in front, within reach of a table.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from motion_backend.backend_protocol import Part
from motion_backend.body.scene_collision import Obstacles
from motion_backend.motion import FPS, Action, Emotion, PhaseKind, Posture
from motion_backend.procedural.body_state import Body, Point, spot_of
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import SHIN_REACH, Seat, idle
from motion_backend.procedural.sit.sit_keys import sit_keys
from motion_backend.procedural.sit.sit_legs import THIGH as THIGH_LONG
from motion_backend.procedural.sit.sit_legs import Room, at_front, feet_hang, is_to_be_straight, perch, straight_reach
from motion_backend.procedural.sit.sit_own import in_own_way, own_seat
from motion_backend.procedural.sit.sit_pose import LEANS_BACK, ON_TABLE, Place, back_for, lacking
from motion_backend.procedural.sit.sit_styles import Seated, sit_style
from motion_backend.procedural.sit.sit_transition import settle_in, sit_down, stand_up
from motion_backend.procedural.touch.gestures import gesture
from motion_backend.procedural.touch.hand_rests import BACK, HOLDS, Hold, Holds, follow, on_thing, sliding
from motion_backend.procedural.touch.handholds import TABLE_REACH, Pair, handholds, table_before
from motion_backend.procedural.walk.walk_skill import go
from motion_backend.rotations import Array
from scene_graphs.affordances.affordances import Spot
from scene_graphs.affordances.sit_and_lie import EDGE

LEAST = 0.5
"""How restless hands are at least."""
SHIN = 0.05
"""Half as wide as a shin is (metres)."""
THIGH = 0.05
"""Half as wide as a thigh is that may press against something a little (metres at 1.70 m)."""
LEG, TOES = 0.12, 0.16
"""From the middle to a foot on either side, and from an ankle on to where toes end (metres)."""
AHEAD, ASIDE, STEP = (0.44, 0.86), (0.12, 0.40), 0.02
"""Where room for feet is looked for, ahead of the pelvis and to the side, and how finely (metres)."""
OF_FOOT, OF_SHIN = (0.06, 0.22), (0.06, 0.22, 0.36)
"""Heights at which something is in the way of a foot, and of a shin (metres)."""
NEARLY = 0.03
"""Points that are so near to something are as good as in it (metres)."""
GRIP_OUT = 0.2
"""How far the fingers of a hand that takes hold are turned outwards (radians)."""
GRIP_ELBOW = (1.0, 0.0, -0.5)
"""Where its elbow points, on an armrest."""
SLOW, QUICK = 0.76, 1.25
"""Tempos below and above which one rises with the hands on the knees, and with none."""


def before_seat(body: Body, action: Action) -> tuple[Point, float]:
    """Where to stand so that shins will be upright once seated, and the yaw with the back to the seat."""
    seat = at_front(Seat.of(spot_of(action)), body.skeleton.scale)
    return seat.standing_point(body.skeleton.scale), seat.yaw


def sit(body: Body, part: Part) -> None:
    """From standing: down onto the seat, and into the way of sitting; or only into it, for who sits there."""
    action = part.action
    own = own_seat(sit_keys().spread, body.seed, body.rng)
    style = replace(sit_style(action.emotion, action.caption), own=own)
    seat = Seat.of(spot_of(action))
    keys = in_own_way(sit_keys(), own, seat.is_low(body.skeleton.scale))
    if body.posture is Posture.STANDING:
        body.enter(PhaseKind.WALK)
        go(body, *before_seat(body, action), action)
    body.enter(PhaseKind.SITDOWN)
    around = handholds(seat, body.scene.obstacles, body.skeleton.scale)
    place = Place(seat, around, leg_room(body.scene.obstacles, seat, body.skeleton.scale))
    if body.posture is not Posture.STANDING:
        down, body.holds = settle_in(body.pose, place, style, body.skeleton, keys)
    else:
        under = around.behind if seat.is_low(body.skeleton.scale) else around.beside
        felt = _grips(around.armrests, under, seat, style.manner.hands)
        down, body.holds = sit_down(body.pose, place, style, felt, body.skeleton, keys)
    body.add(down)
    body.note(*lacking(style, place, body.skeleton, sit_keys().pose))


def stay_seated(body: Body, part: Part) -> None:
    """Sit for a while and do what is done there."""
    style = sit_style(part.action.emotion, part.action.caption)
    held = idle(body.pose, part.hold, style.bearing.restless, body.rng, FPS)
    laid = follow(held, body.pose, body.holds, body.skeleton)
    slid = sliding(laid, body.holds, body.rng, max(style.bearing.restless, LEAST))
    body.add(gesture(slid, style.doing, rng=body.rng))


def leave_seat(body: Body, seat: Seat, bearing: Bearing) -> None:
    """From sitting to standing: hands push off from armrests or seat, those of the slow from their knees."""
    push: Holds = (None, None)
    if bearing.tempo < SLOW and not seat.is_low(body.skeleton.scale):
        push = HOLDS["knees"], HOLDS["knees"]
    elif bearing.tempo < QUICK:
        around = handholds(seat, body.scene.obstacles, body.skeleton.scale)
        push = _grips(around.armrests, around.beside, seat, (True, True))
    own = own_seat(sit_keys().spread, body.seed, body.rng)
    keys = in_own_way(sit_keys(), own, seat.is_low(body.skeleton.scale))
    body.add(stand_up(body.pose, seat, bearing, push, body.skeleton, keys.up))
    body.holds = (None, None)


def _grips(armrests: Pair, under: Pair, seat: Seat, hands: tuple[bool, bool]) -> Holds:
    """What the hands that are wanted take hold of: armrests, else what is under them."""
    found: list[Hold | None] = []
    for index, side in enumerate((1, -1)):
        armrest, beside = armrests[index], under[index]
        if armrest is not None and hands[index]:
            found.append(on_thing(armrest, seat.yaw, side * GRIP_OUT, GRIP_ELBOW))
        elif beside is not None and hands[index]:
            found.append(on_thing(beside, seat.yaw, side * GRIP_OUT, BACK))
        else:
            found.append(None)
    return found[0], found[1]


def leg_room(obstacles: Obstacles, seat: Seat, scale: float) -> tuple[Room, Room]:
    """How far each foot may go before it meets something."""
    near = obstacles.solid()
    ahead, aside = np.arange(*AHEAD, STEP), np.arange(*ASIDE, STEP) * scale
    # Before the seat's own front, where shins and feet of a sitter are.
    front = max(SHIN_REACH * scale, seat.edge) + SHIN
    room = []
    # And beside the seat's front edge, where thighs pass that lead to such feet.
    at_edge = [0.5 * LEG + (a - 0.5 * LEG) * min(seat.edge / front, 1.0) + THIGH * scale for a in aside]
    for side in (1, -1):
        points = np.array([seat.to_world((side * LEG, up, a + TOES)) for a in ahead for up in OF_FOOT])
        places = [
            (*((side * a, up, front) for up in OF_SHIN), (side * thigh, float(seat.pelvis[1]), seat.edge))
            for a, thigh in zip(aside, at_edge, strict=True)
        ]
        beside = np.concatenate([seat.to_world(some) for some in places])
        room.append(Room(_before(ahead, near.depth(points), STEP), _before(aside, near.depth(beside), SHIN)))
    return room[0], room[1]


def _before(places: Array, depth: Array, clear: float) -> float:
    """The last of the distances, so much before the first at which one of its points is in something, or nearly."""
    hit = depth.reshape(len(places), -1).max(axis=1) > -NEARLY
    return float(places[np.argmax(hit)] - clear) if hit.any() else float(places[-1])


HOLLOW = 0.035
"""From the hollow of a knee that is bent over an edge to the middle of the knee (metres)."""
MIN_EDGE = 0.065
"""Thighs rest on so much of a seat at least (metres)."""
FARTHEST_BACK = 45.0
"""Who leans back on stretched legs does so by as much at most (degrees)."""
AT_EASE = 0.42
"""Distance of a table's edge from the pelvis to which nobody draws nearer (metres)."""
ABOUT = 1.4
"""A table in reach is within this distance of the pelvis (metres)."""


def seat_for(found: Sequence[Spot], emotion: Emotion, caption: str, obstacles: Obstacles, scale: float = 1.0) -> Spot:
    """The first of the sit spots, and the place on it, where the most hands have what they are to lie on.

    Who is smaller (`scale`) sits nearer to its front, for knees to bend over the edge.
    Chairs stand so far from their tables that a body can get between: at a table one sits on the front of the seat.
    """
    style = sit_style(emotion, caption)
    found = [_slid(spot, spot.edge - _edge_for(spot, scale)) for spot in found] if scale < 1.0 else found
    if set(ON_TABLE) & set(style.arms):
        return next((near for spot in found if (near := _drawn_up(spot, obstacles))), found[0])
    if any(is_to_be_straight(style.legs)):
        return next((ahead for spot in found if (ahead := _perched(spot, style, obstacles))), found[0])
    if "armrest" not in style.arms:
        return _slid(found[0], _slouch(found[0], style))
    # The first of those that are as good as any.
    return max(found, key=lambda spot: _armrests(spot, obstacles))


def _edge_for(spot: Spot, scale: float) -> float:
    """How far behind a seat's front edge a small body sits: whose feet hang with the hollows of its knees at the edge,
    as far back as its thighs are long."""
    return THIGH_LONG * scale - HOLLOW if feet_hang(Seat.of(spot), scale) else EDGE * scale


def _slouch(spot: Spot, style: Seated) -> float:
    """How far from its backrest a pelvis slides for the trunk to lean back against it (metres)."""
    if np.isinf(spot.back) or style.recline < LEANS_BACK:
        return 0.0
    return float(np.clip(back_for(style.recline) - spot.back, 0.0, max(spot.edge - MIN_EDGE, 0.0)))


def _perched(spot: Spot, style: Seated, obstacles: Obstacles) -> Spot | None:
    """The same seat sat on so far to the front that legs are straight on the floor; None where they have no room."""
    seat = Seat.of(spot)
    forward = max(perch(seat, 1.0), _slouch(spot, style))
    if style.recline >= LEANS_BACK and np.isfinite(spot.back):
        # Still within reach of the backrest: legs are less straight then.
        forward = min(forward, back_for(FARTHEST_BACK) - spot.back)
    ahead = _slid(spot, forward)
    placed = Seat.of(ahead)
    rooms = zip(is_to_be_straight(style.legs), leg_room(obstacles, placed, 1.0), strict=True)
    enough = all(room.ahead >= straight_reach(placed, 1.0) for straight, room in rooms if straight)
    return ahead if enough else None


def _slid(spot: Spot, ahead: float) -> Spot:
    """The same seat sat on so far farther to the front (metres)."""
    if ahead <= 0.0:
        return spot
    x, y, z = spot.point
    point = (x + ahead * float(np.sin(spot.facing)), y, z + ahead * float(np.cos(spot.facing)))
    return replace(spot, point=point, edge=spot.edge - ahead, back=spot.back + ahead)


def _drawn_up(spot: Spot, obstacles: Obstacles) -> Spot | None:
    """The same seat sat on so far to the front that the table before it is near; None where no table is in reach."""
    seat, forward = Seat.of(spot), max(spot.edge - MIN_EDGE, 0.0)
    near = obstacles.near(seat.pelvis - ABOUT, seat.pelvis + ABOUT)
    table = table_before(seat, near, 1.0, TABLE_REACH + forward)
    if table is None:
        return None
    place = _slid(spot, float(np.clip(table[0] - AT_EASE, 0.0, forward)))
    return place if table_before(Seat.of(place), near, 1.0) is not None else None


def _armrests(spot: Spot, obstacles: Obstacles) -> int:
    return sum(rest is not None for rest in handholds(Seat.of(spot), obstacles, 1.0).armrests)
