"""Going to a seat, sitting down on it and standing up from it: the performers of sitdown and of leaving a seat."""

from __future__ import annotations

import numpy as np

from motion_backend.motion import FPS, Action, Posture
from motion_backend.procedural.body import Body, spot_of
from motion_backend.procedural.gestures import gesture
from motion_backend.procedural.going import go
from motion_backend.procedural.handholds import Pair, handholds
from motion_backend.procedural.resting_hands import HOLDS, Hold, Holds, follow, on_thing
from motion_backend.procedural.seated import Place
from motion_backend.procedural.sit_styles import sit_style
from motion_backend.procedural.sitting import sit_down, stand_up
from motion_backend.procedural.stances import Seat, idle
from motion_backend.procedural.styles import Bearing

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
    place = Place(seat, around, _leg_room(body, seat))
    under = around.behind if seat.is_low(body.skeleton.scale) else around.beside
    felt = _grips(around.armrests, under, seat, style.manner.hands)
    down, holds = sit_down(body.pose, place, style, felt, body.skeleton)
    body.add(down)
    held = idle(body.pose, action.hold, style.bearing.restless, body.rng, FPS)
    body.add(gesture(follow(held, body.pose, holds, body.skeleton), style.doing))
    body.posture, body.rest = Posture.SEATED, spot


def leave_seat(body: Body, seat: Seat, bearing: Bearing) -> None:
    """From sitting to standing: hands push off from armrests or seat, those of the slow from their knees."""
    around = handholds(seat, body.scene.obstacles, body.skeleton.scale)
    push: Holds = (None, None)
    if bearing.tempo < SLOW:
        push = HOLDS["knees"], HOLDS["knees"]
    elif bearing.tempo < QUICK:
        push = _grips(around.armrests, around.beside, seat, (True, True))
    body.add(stand_up(body.pose, seat, seat.standing_point(body.skeleton.scale), bearing, body.skeleton, push))
    body.posture, body.rest = Posture.STANDING, None


def _grips(armrests: Pair, under: Pair, seat: Seat, hands: tuple[bool, bool]) -> Holds:
    """What the hands that are wanted take hold of: armrests, else what is under them."""
    found: list[Hold | None] = []
    for index, side in enumerate((1, -1)):
        point = armrests[index] if armrests[index] is not None else under[index]
        if point is None or not hands[index]:
            found.append(None)
        else:
            found.append(on_thing(point, seat.yaw, side * 0.2, (1.0, 0.0, -0.5)))
    return found[0], found[1]


def _leg_room(body: Body, seat: Seat) -> tuple[float, float]:
    """How far ahead of the pelvis each foot may go before it meets something (metres)."""
    ahead = np.arange(0.44, 0.86, 0.02)
    room = []
    for side in (1, -1):
        points = np.array([seat.to_world((side * 0.12, up, a + 0.16)) for a in ahead for up in (0.06, 0.22)])
        hit = body.scene.obstacles.solid().depth(points).reshape(len(ahead), -1).max(axis=1) > -0.03
        room.append(float(ahead[np.argmax(hit)] - 0.02) if hit.any() else float(ahead[-1]))
    return room[0], room[1]
