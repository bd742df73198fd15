"""Sitting down, standing up, lying down and getting up, as key poses with planted feet between them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.footsteps import home_ankle, yaw_of
from motion_backend.procedural.lie_styles import Lying
from motion_backend.procedural.lying import Bed, lying
from motion_backend.procedural.pose import Pose, concatenate, interpolate, smooth
from motion_backend.procedural.sit_styles import Seated
from motion_backend.procedural.stances import (
    FOOT_SPLAY,
    SHIN_REACH,
    UP,
    Seat,
    bend,
    hands_on_thighs,
    seated,
    standing,
    upright,
)
from motion_backend.procedural.styles import Bearing, arm_arrays
from motion_backend.skeleton import Skeleton

Array = NDArray[np.float64]
ARM = 0.54
"""Shoulder to wrist at the reference height (metres)."""


def sit_down(start: Pose, seat: Seat, style: Seated, skeleton: Skeleton, reach: tuple[float, float]) -> Pose:
    """From standing with the back to a seat: hips back, lower, touch down, lean into the way of sitting."""
    pace = 1 / style.bearing.tempo
    down = _lower(start, seat, style.bearing, skeleton)
    landed = down.at(len(down) - 1)
    settled = seated(landed, seat, style, skeleton, reach)
    travel = float(np.linalg.norm(settled.arms - landed.arms, axis=1).max()) * ARM * skeleton.scale
    moved = interpolate(
        [0.0, max(0.75, 1.1 * travel) * pace], [landed, replace(settled, ankles=landed.ankles, feet=landed.feet)], FPS
    )
    moved = _place_feet(moved, landed, settled, first=0.25, each=0.42)
    return hands_on_thighs(concatenate([down, moved]), skeleton)


def _lower(start: Pose, seat: Seat, bearing: Bearing, skeleton: Skeleton) -> Pose:
    """Standing to first contact with the seat."""
    pace = 1 / bearing.tempo
    depth = float(np.clip((start.pelvis[1] - seat.pelvis[1]) / (0.4 * skeleton.scale), 0.6, 2.0))
    drop, back = seat.pelvis[1] - start.pelvis[1], seat.pelvis - start.pelvis
    # Whatever the arms were doing, they come forward for balance.
    arms, elbows = arm_arrays("hang", "hang")
    arms = arms * [1.0, 0.86, 1.0] + [0.0, 0.0, 0.35]
    forward = 0.30 + 0.16 * depth
    hinge = replace(
        start,
        pelvis=start.pelvis + back * [0.42, 0.0, 0.42] + [0, 0.22 * drop, 0],
        hips=upright(seat.yaw, 0.55 * forward),
        spine=bend(0.5 * forward),
        head=bend(0.1),
        arms=0.5 * (start.arms + arms),
        elbows=elbows,
    )
    low = replace(
        hinge,
        pelvis=start.pelvis + back * [0.86, 0.0, 0.86] + [0, 0.74 * drop, 0],
        hips=upright(seat.yaw, 0.75 * forward),
        spine=bend(0.75 * forward),
        arms=arms,
    )
    contact = replace(low, pelvis=seat.pelvis, hips=upright(seat.yaw, 0.45 * forward), spine=bend(0.55 * forward))
    seconds = 1.35 * pace * (0.7 + 0.3 * depth)
    down = interpolate([0.0, 0.42 * seconds, 0.8 * seconds, seconds], [start, hinge, low, contact], FPS)
    return replace(down, knees=knees_over_feet(down))


def knees_over_feet(pose: Pose) -> Array:
    """Knees point where their feet point, a little up, so that deep bends stay in plane. (T, 2, 3)."""
    forward = rotations.rotate(rotations.yaw_to_quat(yaw_of(pose.feet)), np.array([0.0, 0.0, 1.0]))
    return np.asarray(forward + 0.25 * UP)


def _place_feet(pose: Pose, before: Pose, after: Pose, first: float, each: float) -> Pose:
    """Move the feet one after the other in small lifted steps from where they were to where they go."""
    ankles, feet, planted, knees = pose.ankles.copy(), pose.feet.copy(), pose.planted.copy(), pose.knees.copy()
    time = np.arange(1, len(pose) + 1) / FPS
    for order, index in enumerate((1, 0)):
        share = np.clip((time - first - order * 0.5 * each) / each, 0.0, 1.0)
        way = smooth(share)[:, None]
        gap = float(np.linalg.norm(after.ankles[index] - before.ankles[index]))
        ankles[:, index] = before.ankles[index] + way * (after.ankles[index] - before.ankles[index])
        ankles[:, index, 1] += min(0.05, 0.25 * gap) * np.sin(np.pi * share)
        feet[:, index] = rotations.slerp(before.feet[index], after.feet[index], way[:, 0])
        knees[:, index] = before.knees[index] + way * (after.knees[index] - before.knees[index])
        planted[:, index] = (share <= 0) | (share >= 1)
    last = {"ankles": ankles, "feet": feet, "planted": planted, "knees": knees}
    short = max(round((first + 1.5 * each) * FPS) - len(pose), 0)
    if short:
        # The feet take longer than the trunk: hold the trunk until both are placed.
        held = pose.at(slice(len(pose) - 1, len(pose)))
        longer = concatenate([pose, *([held] * short)])
        return _place_feet(longer, before, after, first, each)
    return replace(pose, **last)


def stand_up(start: Pose, seat: Seat, where: tuple[float, float], bearing: Bearing, skeleton: Skeleton) -> Pose:
    """From a seat to standing at [x, z]: feet under, lean forward, rise over them."""
    end = standing(where, seat.yaw, bearing, skeleton)
    under = replace(start, ankles=end.ankles, feet=end.feet, knees=end.knees + 0.25 * UP)
    pace = 1 / bearing.tempo
    depth = float(np.clip((end.pelvis[1] - seat.pelvis[1]) / (0.4 * skeleton.scale), 0.6, 2.0))
    forward = 0.34 + 0.20 * depth
    ready = replace(
        under,
        hips=upright(seat.yaw, 0.5 * forward),
        spine=bend(0.75 * forward),
        head=bend(0.0),
        pelvis=seat.pelvis,
        toes=np.zeros(2),
        arms=end.arms + np.array([0.0, 0.16, 0.34]),
        elbows=end.elbows,
        pressing=np.zeros(2),
    )
    # Hands that come down from the head need longer than hands on the lap.
    travel = float(np.linalg.norm(ready.arms - start.arms, axis=1).max()) * ARM * skeleton.scale
    gather = interpolate(
        [0.0, max(0.62, 1.1 * travel) * pace], [start, replace(ready, ankles=start.ankles, feet=start.feet)], FPS
    )
    gather = hands_on_thighs(_place_feet(gather, start, ready, first=0.0, each=0.36), skeleton)
    ready = gather.at(len(gather) - 1)
    rise, ahead = end.pelvis[1] - seat.pelvis[1], end.pelvis - seat.pelvis
    lift = replace(
        ready,
        pelvis=seat.pelvis + ahead * [0.45, 0.0, 0.45] + [0, 0.24 * rise, 0],
        hips=upright(seat.yaw, 0.7 * forward),
        spine=bend(0.8 * forward),
    )
    straighten = replace(
        lift,
        pelvis=seat.pelvis + ahead * [0.88, 0.0, 0.88] + [0, 0.78 * rise, 0],
        hips=upright(seat.yaw, 0.3 * forward),
        spine=bend(0.35 * forward),
        reaching=0.3 * ready.reaching,
        pressing=0.0 * ready.pressing,
        arms=0.5 * (ready.arms + end.arms),
    )
    seconds = 1.25 * pace * (0.7 + 0.3 * depth)
    end = replace(end, reach=ready.reach, palms=ready.palms)
    up = interpolate([0.0, 0.34 * seconds, 0.72 * seconds, seconds], [ready, lift, straighten, end], FPS)
    return concatenate([gather, replace(up, knees=knees_over_feet(up))])


def edge_seat(bed: Bed, standing_point: tuple[float, float], outward: float, edge: float, scale: float) -> Seat:
    """Where one sits on the edge of a bed before lying down, facing `outward` (yaw)."""
    out = np.array([np.sin(outward), 0.0, np.cos(outward)])
    stand = np.array([standing_point[0], 0.0, standing_point[1]])
    from_bed = float((stand - bed.pelvis) @ out)
    inside = float(np.clip(from_bed - SHIN_REACH * scale, -np.inf, edge - 0.12))
    along = stand - bed.pelvis - from_bed * out
    along[1] = 0.0
    pelvis = bed.pelvis + inside * out + along
    pelvis[1] = bed.pelvis[1] - 0.01
    return Seat(pelvis, outward, np.inf)


def lie_down(start: Pose, seat: Seat, bed: Bed, style: Lying, skeleton: Skeleton, pillow: float) -> Pose:
    """Sit on the edge, lean towards the head end on an arm, swing the legs up and settle."""
    down = _lower(start, seat, style.bearing, skeleton)
    landed = down.at(len(down) - 1)
    return concatenate([down, _recline(landed, seat, bed, style, skeleton, pillow)])


def _recline(landed: Pose, seat: Seat, bed: Bed, style: Lying, skeleton: Skeleton, pillow: float) -> Pose:
    """From sitting on the edge to lying."""
    pace = 1 / style.bearing.tempo
    end = lying(landed, bed, style, skeleton, pillow)
    middle = _half_way(landed, seat, bed, skeleton)
    over = _legs_over(middle, end, bed, skeleton)
    sat = replace(landed, hips=upright(seat.yaw, 0.05), spine=bend(0.2))
    times = [0.0, 0.45 * pace, 1.25 * pace, 1.9 * pace, 2.9 * pace]
    return interpolate(times, [landed, sat, middle, over, end], FPS)


def _half_way(landed: Pose, seat: Seat, bed: Bed, skeleton: Skeleton) -> Pose:
    """Leaning on one arm with the legs just off the floor."""
    scale = skeleton.scale
    hips = rotations.slerp(upright(seat.yaw, 0.0), bed.hips("back"), 0.42)
    pelvis = seat.pelvis + 0.35 * (bed.pelvis - seat.pelvis) + 0.02 * UP
    local = np.array([[0.10, -0.50, 0.47], [-0.10, -0.50, 0.47]]) * scale
    side = 0 if np.sin(bed.head_yaw - seat.yaw) > 0 else 1
    arms, elbows = landed.arms.copy(), landed.elbows.copy()
    mirror = np.array([1.0 if side == 0 else -1.0, 1.0, 1.0])
    arms[side], elbows[side] = np.array([0.45, -0.75, -0.2]) * mirror, np.array([0.6, 0.0, -1.0]) * mirror
    # The other arm is held out before the body, clear of the thighs that come up.
    arms[1 - side] = np.array([-0.20, -0.42, 0.52]) * mirror
    elbows[1 - side] = np.array([-0.15, -1.0, 0.1]) * mirror
    return replace(
        landed,
        pelvis=pelvis,
        hips=hips,
        spine=bend(0.45),
        head=bend(0.25),
        ankles=pelvis + rotations.rotate(hips, local),
        feet=np.repeat(rotations.compose(hips, rotations.rotvec_to_quat(np.array([0.35, 0, 0])))[None], 2, axis=0),
        knees=np.stack([rotations.rotate(hips, np.array([0.1 * s, 0.1, 1.0])) for s in (1, -1)]),
        arms=arms,
        elbows=elbows,
        planted=np.zeros(2),
    )


def _legs_over(middle: Pose, end: Pose, bed: Bed, skeleton: Skeleton) -> Pose:
    """Legs over the edge and above the bed, trunk nearly down."""
    hips = rotations.slerp(middle.hips, bed.hips("back"), 0.72)
    pelvis = middle.pelvis + 0.8 * (bed.pelvis - middle.pelvis) + 0.015 * UP
    local = np.array([[0.10, -0.52, 0.24], [-0.10, -0.52, 0.24]]) * skeleton.scale
    return replace(
        middle,
        pelvis=pelvis,
        hips=hips,
        spine=bend(0.35),
        head=bend(0.3),
        ankles=pelvis + rotations.rotate(hips, local),
        feet=np.repeat(rotations.compose(hips, rotations.rotvec_to_quat(np.array([0.4, 0, 0])))[None], 2, axis=0),
        knees=np.stack([rotations.rotate(hips, np.array([0.1 * s, 0.1, 1.0])) for s in (1, -1)]),
        arms=0.7 * middle.arms + 0.3 * end.arms,
    )


def rise_to_edge(start: Pose, seat: Seat, bed: Bed, bearing: Bearing, skeleton: Skeleton) -> Pose:
    """From lying to sitting on the edge: the way of lying down, backwards."""
    pace = 1 / bearing.tempo
    out = np.array([np.sin(seat.yaw), np.cos(seat.yaw)])
    feet_at = seat.pelvis[[0, 2]] + SHIN_REACH * skeleton.scale * out
    ankles = np.stack([home_ankle(feet_at, seat.yaw, index, 0.085, skeleton) for index in (0, 1)])
    sat = replace(
        start,
        pelvis=seat.pelvis,
        hips=upright(seat.yaw, 0.1),
        spine=bend(0.25),
        head=bend(0.1),
        ankles=ankles,
        feet=np.stack([rotations.yaw_to_quat(seat.yaw + side * FOOT_SPLAY) for side in (1, -1)]),
        knees=np.stack([np.array([out[0], 0.25, out[1]])] * 2),
        arms=np.array([[0.25, -0.9, -0.05], [-0.25, -0.9, -0.05]]),
        elbows=np.array([[0.5, 0.0, -1.0], [-0.5, 0.0, -1.0]]),
        planted=np.ones(2),
    )
    middle = _half_way(sat, seat, bed, skeleton)
    over = _legs_over(middle, start, bed, skeleton)
    times = [0.0, 0.95 * pace, 1.55 * pace, 2.35 * pace]
    return interpolate(times, [start, over, middle, sat], FPS)
