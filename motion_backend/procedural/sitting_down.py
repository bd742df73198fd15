"""Going to a seat, sitting down on it and standing up from it: the performers of sitdown and of leaving a seat."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion_backend.motion import FPS, Action, Posture
from motion_backend.procedural.body import Body, spot_of
from motion_backend.procedural.gestures import gesture
from motion_backend.procedural.going import go
from motion_backend.procedural.handholds import Pair, elbow_room, handholds
from motion_backend.procedural.resting_hands import BACK, HOLDS, Hold, Holds, follow, on_thing
from motion_backend.procedural.seated import Place, lacking
from motion_backend.procedural.seated_legs import Room
from motion_backend.procedural.sit_styles import sit_style
from motion_backend.procedural.sitting import sit_down, stand_up
from motion_backend.procedural.stances import SHIN_REACH, Seat, idle
from motion_backend.procedural.styles import Bearing

Array = NDArray[np.float64]
SHIN = 0.05
"""Half as wide as a shin is (metres)."""
SLOW, QUICK = 0.76, 1.25
"""Tempos below and above which one rises with the hands on the knees, and with none."""


def at_standing_point(body: Body, action: Action, seat: Seat) -> None:
    """Stand where shins will be upright once seated, back to the seat."""
    go(body, seat.standing_point(body.skeleton.scale), seat.yaw, action)


def sitdown(body: Body, action: Action) -> None:
    """From standing: to the seat, down onto it, and what is done there."""
    style = sit_style(action.emotion, action.caption)
    spot = spot_of(action)
    seat = Seat.of(spot)
    at_standing_point(body, action, seat)
    around = handholds(seat, body.scene.obstacles, body.skeleton.scale)
    elbows = elbow_room(seat, body.scene.obstacles.solid(), body.skeleton.scale)
    place = Place(seat, around, _leg_room(body, seat), elbows)
    under = around.behind if seat.is_low(body.skeleton.scale) else around.beside
    felt = _grips(around.armrests, under, seat, style.manner.hands)
    down, holds = sit_down(body.pose, place, style, felt, body.skeleton)
    body.add(down)
    body.note(*lacking(style, place, body.skeleton))
    held = idle(body.pose, action.hold, style.bearing.restless, body.rng, FPS)
    body.add(gesture(follow(held, body.pose, holds, body.skeleton), style.doing))
    body.posture, body.rest = Posture.SEATED, spot


def leave_seat(body: Body, seat: Seat, bearing: Bearing) -> None:
    """From sitting to standing: hands push off from armrests or seat, those of the slow from their knees."""
    push: Holds = (None, None)
    if bearing.tempo < SLOW and not seat.is_low(body.skeleton.scale):
        push = HOLDS["knees"], HOLDS["knees"]
    elif bearing.tempo < QUICK:
        around = handholds(seat, body.scene.obstacles, body.skeleton.scale)
        push = _grips(around.armrests, around.beside, seat, (True, True))
    body.add(stand_up(body.pose, seat, seat.standing_point(body.skeleton.scale), bearing, body.skeleton, push))
    body.posture, body.rest = Posture.STANDING, None


def _grips(armrests: Pair, under: Pair, seat: Seat, hands: tuple[bool, bool]) -> Holds:
    """What the hands that are wanted take hold of: armrests, else what is under them."""
    found: list[Hold | None] = []
    for index, side in enumerate((1, -1)):
        armrest, beside = armrests[index], under[index]
        if armrest is not None and hands[index]:
            found.append(on_thing(armrest, seat.yaw, side * 0.2, (1.0, 0.0, -0.5)))
        elif beside is not None and hands[index]:
            found.append(on_thing(beside, seat.yaw, side * 0.2, BACK))
        else:
            found.append(None)
    return found[0], found[1]


def _leg_room(body: Body, seat: Seat) -> tuple[Room, Room]:
    """How far each foot may go before it meets something."""
    near, scale = body.scene.obstacles.solid(), body.skeleton.scale
    ahead, aside = np.arange(0.44, 0.86, 0.02), np.arange(0.12, 0.40, 0.02) * scale
    # Before the seat's own front, where shins and feet of a sitter are.
    front = max(SHIN_REACH * scale, seat.edge) + SHIN
    room = []
    for side in (1, -1):
        points = np.array([seat.to_world((side * 0.12, up, a + 0.16)) for a in ahead for up in (0.06, 0.22)])
        beside = np.array([seat.to_world((side * a, up, front)) for a in aside for up in (0.06, 0.22, 0.36)])
        room.append(Room(_before(ahead, near.depth(points), 0.02), _before(aside, near.depth(beside), SHIN)))
    return room[0], room[1]


def _before(places: Array, depth: Array, clear: float) -> float:
    """The last of the distances, so much before the first at which one of its points is in something, or nearly."""
    hit = depth.reshape(len(places), -1).max(axis=1) > -0.03
    return float(places[np.argmax(hit)] - clear) if hit.any() else float(places[-1])
