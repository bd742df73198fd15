"""Bringing a hand onto a surface: the least bent posture that gets there, and the way to it and back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.footsteps import yaw_of
from motion_backend.procedural.handling import CARRY, KEPT, Laid, carrying, empty, handled
from motion_backend.procedural.interactions import knees_over_feet
from motion_backend.procedural.pose import Pose, concatenate, interpolate, settle_from, smooth
from motion_backend.procedural.solving import chest_frame, released
from motion_backend.procedural.stances import (
    UP,
    bend,
    shoulders,
    upright,
)
from motion_backend.procedural.styles import Bearing
from motion_backend.skeleton import Skeleton

Array = NDArray[np.float64]

Depth = Callable[[Array], Array]


DEEP = 0.30
"""Lowering the pelvis by more than this (metres) slows a reach down."""
SLIDE = 0.025
"""How far a touching hand slides to each side (metres)."""
HEAD_ROOM = 0.13
"""Distance of the middle of the head to furniture that a reaching body keeps (metres)."""


def touch(
    start: Pose, laid: Laid, style: tuple[Bearing, float], skeleton: Skeleton, depth: Depth, doing: str = ""
) -> Pose:
    """Bring a hand from outside onto a surface, keep it there, and come back to standing.

    `style` is the bearing and the seconds to hold; `depth` says how deep points (N, 3) are in furniture; `doing` is
    what the hand does there, a word of `handling.HANDLINGS`, "" for a plain touch.
    """
    bearing, hold = style
    pace = 1 / bearing.tempo
    bent = _reaching(start, laid, skeleton, depth)
    # A deep bend takes its time, however hurried.
    pace *= max(1.0, float(start.pelvis[1] - bent.pelvis[1]) / (DEEP * skeleton.scale))
    reached = _hand_at(start, bent, laid, 0.0, skeleton)
    over = _hand_at(start, bent, laid, 0.12, skeleton)
    away = replace(start, reach=over.reach, palms=over.palms)
    lead = replace(away, head=0.7 * reached.head + 0.3 * start.head)
    frames = max(round(hold * FPS), 1)
    held = _feeling_about(reached.repeat(frames), laid, frames, sliding=not doing)
    held = handled(held, laid, doing)
    hands = [index for index, *_ in laid.hands]
    carried = carrying(away, hands)
    after = {"pick": carried, "put": empty(away, hands)}.get(doing, away)
    if doing == "put":
        lead = replace(lead, arms=carried.arms, elbows=carried.elbows)
        go = interpolate(
            [0.0, CARRY * pace, (CARRY + 0.3) * pace, (CARRY + 0.85) * pace, (CARRY + 1.2) * pace],
            [away, carried, lead, over, reached],
            FPS,
        )
    else:
        go = interpolate([0.0, 0.3 * pace, 0.85 * pace, 1.2 * pace], [away, lead, over, reached], FPS)
    back = interpolate([0.0, 0.3 * pace, 1.05 * pace], [reached, over, after], FPS)
    whole = concatenate([go, held, back, *([carried.repeat(KEPT)] if doing == "pick" else [])])
    return settle_from(start, replace(whole, knees=knees_over_feet(whole)), FPS, seconds=0.3)


def _feeling_about(held: Pose, laid: Laid, frames: int, sliding: bool) -> Pose:
    """A held touch, alive: breath, and the hand sliding a little to and fro along what it lies on."""
    time = np.arange(frames) / FPS
    breath = 0.02 * np.sin(2 * np.pi * 0.35 * time)
    along = rotations.rotate(laid.palm, np.array([0.0, 0.0, 1.0]))
    slide = SLIDE * np.sin(2 * np.pi * 0.55 * time) * smooth(time / 0.3) * smooth((time[-1] - time) / 0.3)
    reach = held.reach.copy()
    reach[:, laid.hands[0][0]] += float(sliding) * slide[:, None] * along
    look = np.stack([0.03 * breath / 0.02, 0.08 * np.sin(2 * np.pi * 0.3 * time), 0 * time], axis=1)
    look *= smooth(time / 0.4)[:, None]
    return replace(
        held, reach=reach, spine=held.spine + np.stack([breath, 0 * breath, 0 * breath], axis=1), head=held.head + look
    )


def _hand_at(start: Pose, bent: Pose, laid: Laid, off: float, skeleton: Skeleton) -> Pose:
    """A bent posture with the hands on the surface, or `off` metres out from it."""
    reaching = np.zeros(2)
    reach, palms, elbows = start.reach.copy(), start.palms.copy(), start.elbows.copy()
    yaw = float(yaw_of(start.hips))
    # A raised hand hangs its elbow below, a lowered one keeps it behind; over the edge of a top it is lifted aside.
    high = float(np.clip((laid.wrist[1] / skeleton.scale - 1.2) / 0.25, 0.0, 1.0))
    # Onto a top the hand comes over its edge from the body's side.
    back = off * laid.normal[1] * (0.3 + 0.9 * high) * np.array([np.sin(yaw), 0.0, np.cos(yaw)])
    for index, wrist, palm in laid.hands:
        side = 1.0 if index == 0 else -1.0
        reaching[index], reach[index], palms[index] = 1.0, wrist + off * laid.normal - back, palm
        elbows[index] = np.array([0.45 * side, -0.25 - 0.75 * high, -1.0 + 0.75 * high])
        if wrist[1] < 0.7 * skeleton.scale:
            # Down low it goes outwards: behind is the thigh.
            elbows[index] = np.array([1.0 * side, -0.1, -0.3])
        if laid.normal[1] > 0.7 and high > 0:
            elbows[index] = np.array([1.0 * side, 0.25, -0.3])
    pressing = reaching * (1.0 if off == 0.0 else 0.6)
    posed = replace(bent, reach=reach, reaching=reaching, palms=palms, pressing=pressing, elbows=elbows)
    # The same place held from the chest, so that the arm swings there round its shoulder.
    return replace(posed, arms=released(posed, skeleton).arms)


def _reaching(start: Pose, laid: Laid, skeleton: Skeleton, depth: Depth) -> Pose:
    """The least bent posture from which the hands get to their goals: a search over lean and crouch."""
    goal = laid.wrist
    yaw = float(yaw_of(start.hips))
    lean, crouch = (grid.ravel() for grid in np.meshgrid(np.radians(np.arange(0, 76, 5)), np.arange(0, 0.50, 0.05)))
    lean, crouch = lean[:, None], crouch[:, None] * skeleton.scale
    ahead = np.array([np.sin(yaw), 0.0, np.cos(yaw)])
    tries = start.repeat(len(lean))
    turn = 0.0 if laid.other is not None else 0.22 if laid.hand == "right" else -0.22
    back = 0.06 * np.sin(lean) + 0.25 * crouch
    tries = replace(
        tries,
        pelvis=start.pelvis - crouch * UP - back * ahead,
        hips=np.stack([upright(yaw, 0.45 * float(a[0])) for a in lean]),
        spine=np.concatenate([0.55 * lean + 0.02, turn * np.minimum(lean / 0.3, 1.0), 0 * lean], axis=1),
    )
    arm = 0.54 * skeleton.scale
    miss = np.zeros(len(lean))
    for index, wrist, _ in laid.hands:
        gap = np.linalg.norm(wrist - shoulders(tries, skeleton)[:, index], axis=1)
        miss = miss + np.maximum(gap - 0.955 * arm, 0.0) + np.maximum(0.45 * arm - gap, 0.0)
    # The head stays clear of what is touched: before a front one bends the knees instead.
    chest, place = chest_frame(tries, skeleton)
    head = place + rotations.rotate(chest, np.array([0.0, 0.38, 0.05]) * skeleton.scale)
    miss = miss + np.maximum(depth(head) + HEAD_ROOM, 0.0)
    # One bends over to a table and squats to a drawer.
    squat = 2.6 + 4.5 * float(np.clip((goal[1] / skeleton.scale - 0.6) / 0.2, 0.0, 1.0))
    if laid.normal[1] > 0.7 and goal[1] > 0.35 * skeleton.scale:
        squat = max(squat, 8.0)
    effort = 60.0 * miss + 0.6 * lean[:, 0] + 1.1 * lean[:, 0] ** 2 + squat * crouch[:, 0]
    best = tries.at(int(np.argmin(effort)))
    eyes = shoulders(best.repeat(1), skeleton)[0].mean(axis=0) + 0.2 * UP
    look = goal - eyes
    down = np.arctan2(-look[1], np.hypot(look[0], look[2]))
    sideways = float(rotations.wrap(np.arctan2(look[0], look[2]) - yaw))
    nod = float(np.clip(down - 0.7 * lean[int(np.argmin(effort)), 0], -0.5, 0.6))
    return replace(best, head=bend(nod, turn=float(np.clip(sideways, -0.6, 0.6))))
