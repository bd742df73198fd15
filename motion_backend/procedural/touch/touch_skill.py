"""Laying a hand on a thing: the performer of reaching."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.backend_protocol import Part
from motion_backend.motion import FPS, Action, Handle, PhaseKind
from motion_backend.procedural.body_state import Body, Point, spot_of
from motion_backend.procedural.emotion_style import bearing_of
from motion_backend.procedural.held_poses import alive
from motion_backend.procedural.pose import interpolate
from motion_backend.procedural.touch.hand_captions import (
    Laid,
    carried_as,
    handling_of,
    holding,
    steadies,
    with_arms,
    with_both_hands,
)
from motion_backend.procedural.touch.hand_contacts import free_stroke, on_edge, other_hand, palm_on
from motion_backend.procedural.touch.hand_placement import lies_free
from motion_backend.procedural.touch.kneel import place_to_kneel
from motion_backend.procedural.touch.reach import Manner, arriving, pull, touch
from motion_backend.procedural.touch.touch_keys import touch_keys
from motion_backend.procedural.walk.walk_skill import go
from motion_backend.skeleton import HAND_REST
from scene_graphs.affordances.affordances import Spot

OVERHEAD: Final = 1.65
"""To what is lower nobody stretches (metres at 1.70 m)."""
CALM: Final = 0.5
"""How restless one is whose hand is on something, against the same mood with the hands free."""
MIN_HOLD: Final = 1.2
"""A hand stays at least so long (seconds)."""
STAYS: Final = 0.9
"""Who has opened or shut something does not stay with the hand on it for longer (seconds)."""
STEPS: Final = 33
"""Places of a handle on its way."""
CARRIES_S: Final = 0.4
"""How long the arm takes into the pose that something is carried in (seconds at tempo 1)."""
TURNS_ALONG: Final = 0.4
"""How much of a door's turn the hand on it goes along with: the rest turns in its grip."""
_HEIGHT: Final = re.compile(r"\b(?:low|medium|high)\b", re.IGNORECASE)


def before_thing(body: Body, action: Action) -> tuple[Point, float]:
    """Where to stand, and the yaw, to touch a thing, on the knees where the caption asks for it and there is room."""
    spot = _knelt_at(body, action) or spot_of(action)
    return spot.standing, spot.facing


def come_to_thing(body: Body, action: Action) -> None:
    """The end of the walk just made leads to a thing: the hand is on its way."""
    if body.frames:
        body.frames[-1] = arriving(body.frames[-1], action.hand, touch_keys().reach)
        body.pose = body.frames[-1].at(len(body.frames[-1]) - 1)


def reach(body: Body, part: Part) -> None:
    """From standing before a thing: the hand onto it, what the hand does there, and back."""
    action = part.action
    bearing = bearing_of(action.emotion, action.caption)
    spot, knelt = spot_of(action), _knelt_at(body, action)
    if action.handle is not None:
        body.enter(PhaseKind.WALK)
        go(body, spot.standing, spot.facing, action)
        body.enter(PhaseKind.TOUCH)
        _take_along(body, part, action.handle)
        return
    if "prone" in action.caption and knelt is None:
        body.note("no room to kneel: squats")
    asked = _HEIGHT.search(action.caption)
    if asked and asked[0].lower() != spot.height:
        body.note(f"nothing is there at {asked[0].lower()} height: it is done at {spot.height} height")
    elif asked and spot.height == "high" and spot.point[1] < OVERHEAD * body.skeleton.scale:
        body.note("nothing overhead: no stretch")
    spot, prone = knelt or spot, knelt is not None
    body.enter(PhaseKind.WALK)
    go(body, spot.standing, spot.facing, action)
    body.enter(PhaseKind.TOUCH)
    normal = np.asarray(spot.normal, dtype=np.float64)
    goal = np.asarray(spot.point) + HAND_REST * normal
    obstacles, scale = body.scene.obstacles, body.skeleton.scale
    doing, palm = handling_of(action.caption), palm_on(normal, spot.facing, action.hand)
    palm = on_edge(palm, action.hand) if doing == "knock" else palm
    both = with_both_hands(action.caption) or (steadies(action.caption) and not any(holding(body.pose)))
    seen = body.scene.depth_about(spot.object_id)
    is_free = partial(lies_free, side=-1.0 if action.hand == "left" else 1.0, seen=seen, scale=scale)
    other = other_hand(obstacles, spot, (goal, action.hand), scale, is_free) if both else None
    if with_both_hands(action.caption) and other is None:
        body.note("no room for both hands: one hand")
    laid = Laid(goal, palm, normal, action.hand, other)
    laid = replace(laid, stroke=free_stroke(obstacles, spot, laid))
    hold = max(part.hold, MIN_HOLD)
    manner = Manner(bearing, hold, doing, prone, _free_feet(body))
    touched = touch(body.pose, laid, manner, body.skeleton, seen, touch_keys(), body.rng)
    body.add(alive(touched, CALM * bearing.restless, body.rng, FPS))


def _take_along(body: Body, part: Part, handle: Handle) -> None:
    """The hand onto a handle, along with it, and back."""
    action, spot = part.action, spot_of(part.action)
    normal = np.asarray(spot.normal, dtype=np.float64)
    ends = (1.0, 0.0) if handle.does == "close" else (0.0, 1.0)
    way = handle.at(np.linspace(*ends, STEPS)) + HAND_REST * normal
    along = rotations.axis_to_quat("y", np.asarray(TURNS_ALONG * handle.turn))
    shut = palm_on(normal, spot.facing, action.hand)
    palms = {0.0: shut, 1.0: rotations.compose(along, shut)}
    first, last = (
        Laid(wrist, palms[end], rotations.rotate(along, normal) if end else normal, action.hand)
        for wrist, end in zip(way[[0, -1]], ends, strict=True)
    )
    bearing = bearing_of(action.emotion, action.caption)
    manner = Manner(bearing, min(part.hold, STAYS))
    seen = body.scene.depth_about(spot.object_id)
    goes = way, handle.does == "into"
    taken = pull(body.pose, (first, last), goes, manner, body.skeleton, seen, touch_keys(), body.rng)
    body.add(alive(taken, CALM * bearing.restless, body.rng, FPS))
    if handling_of(action.caption) == "pick" and handle.does == "into":
        carries = with_arms(body.pose, (int(action.hand == "right"),), carried_as(action.holds))
        body.add(interpolate([0.0, CARRIES_S / bearing.tempo], [body.pose, carries], FPS))


def _free_feet(body: Body) -> tuple[int, ...]:
    """The feet that may step: while the part before is still being done only one that steps in it anyway, the other one
    standing."""
    if body.tail is None:
        return (0, 1)
    moving = [foot for foot in (0, 1) if not body.tail.planted[:, foot].all()]
    return tuple(moving) if len(moving) < 2 else ()


def _knelt_at(body: Body, action: Action) -> Spot | None:
    """The spot as it is touched on the knees; None where it is not, or there is no room."""
    if "prone" not in action.caption or action.handle is not None:
        return None
    return place_to_kneel(spot_of(action), body.place, body.scene, body.skeleton.scale)
