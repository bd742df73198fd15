"""Lying down and getting up, as key poses over the edge of what is lain on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import FOOT_SPLAY, SHIN_REACH, UP, Seat, bend, upright
from motion_backend.procedural.lie.lie_pose import Bed, lying
from motion_backend.procedural.lie.lie_styles import Lying
from motion_backend.procedural.pose import Pose, interpolate
from motion_backend.procedural.pose_solver import released
from motion_backend.procedural.touch.hand_contacts import palm_on
from motion_backend.procedural.walk.footsteps import home_ankle
from motion_backend.skeleton import HAND_REST, Skeleton

LIFTED = 0.10
"""How high a leg is lifted over the other one or over the edge (metres)."""
CROSSED = 0.07
"""Ankles nearer to each other from side to side are crossed (metres)."""
HURRIED = 1.35
"""Who is quicker than this gets up straight ahead."""


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


def lie_down(landed: Pose, seat: Seat, bed: Bed, style: Lying, skeleton: Skeleton) -> Pose:
    """From the edge: lean towards the head end on an arm, swing the legs up, lower the trunk; only then settle."""
    pace = 1 / style.bearing.tempo
    sat = replace(
        landed, hips=upright(seat.yaw, 0.05), spine=bend(0.2), head=bend(0.1, turn=0.7 * _head_side(seat, bed))
    )
    leaning = _leaning(sat, seat, bed, skeleton)
    landed, sat = _bound_for(leaning, landed), _bound_for(leaning, sat)
    middle = _half_way(leaning, seat, bed, skeleton)
    over = _legs_over(middle, bed, skeleton)
    end = lying(landed, bed, style, skeleton)
    # Hands are turned to what they lie on only as they get there.
    bent = replace(lying(landed, bed, gathered(style), skeleton), palms=end.palms, pressing=np.zeros(2))
    keys, waits = [sat, leaning, middle, over, bent, *freed(end, bed), end], [0.45, 0.45, 0.6, 0.65, 0.8]
    waits += [0.55] * (len(keys) - len(waits) - 1) + [0.75 if len(keys) == 6 else 0.5]
    times = np.concatenate([[0.0], np.cumsum(waits)]) * pace
    return interpolate(times.tolist(), [landed, *keys], FPS)


def rise_to_edge(start: Pose, seat: Seat, bed: Bed, bearing: Bearing, skeleton: Skeleton) -> Pose:
    """From lying to sitting on the edge: roll to it with bent knees, legs over it, push up on an arm."""
    pace = 1 / bearing.tempo
    sat = _sitting(start, seat, skeleton)
    leaning = _leaning(sat, seat, bed, skeleton)
    sat = _bound_for(leaning, sat)
    middle = _half_way(leaning, seat, bed, skeleton)
    rolled = _rolled(start, bed, bearing, skeleton)
    over = _legs_over(middle, bed, skeleton)
    keys = [start, *freed(start, bed), rolled, over, middle, leaning, sat]
    waits = [0.5] * (len(keys) - 6) + [0.85, 0.75, 0.65, 0.55, 0.45]
    times = np.concatenate([[0.0], np.cumsum(waits)]) * pace
    return interpolate(times.tolist(), keys, FPS)


def gathered(style: Lying) -> Lying:
    """The way of lying that a body comes down in: knees bent, arms over the trunk."""
    return Lying(bearing=style.bearing, side=style.side, legs="bent", arms=("chest", "belly"))


def freed(pose: Pose, bed: Bed) -> list[Pose]:
    """What comes between bent knees and legs that cross or hang over the edge: the leg is lifted over first."""
    local = rotations.rotate(rotations.inverse(pose.hips), pose.ankles - pose.pelvis)
    ankles, knees = pose.ankles.copy(), pose.knees.copy()
    if pose.planted.any():
        index = int(np.argmax(pose.planted))
        ankles[index, 1] = bed.surface + LIFTED
        return [replace(pose, ankles=ankles, knees=knees, planted=np.zeros(2))]
    if local[0, 0] - local[1, 0] > CROSSED:
        return []
    index = int(np.argmax(local[:, 2]))
    local[index] += [0.10 if index == 0 else -0.10, 0.03, LIFTED]
    ankles[index] = pose.pelvis + rotations.rotate(pose.hips, local[index])
    return [replace(pose, ankles=ankles)]


def _head_side(seat: Seat, bed: Bed) -> float:
    """1 where the head end is to the left of who sits on the edge, -1 to the right."""
    return 1.0 if np.sin(bed.head_yaw - seat.yaw) > 0 else -1.0


def _sitting(start: Pose, seat: Seat, skeleton: Skeleton) -> Pose:
    """Upright on the edge with both feet down."""
    out = np.array([np.sin(seat.yaw), np.cos(seat.yaw)])
    feet_at = seat.pelvis[[0, 2]] + SHIN_REACH * skeleton.scale * out
    return replace(
        start,
        pelvis=seat.pelvis,
        hips=upright(seat.yaw, 0.1),
        spine=bend(0.25),
        head=bend(0.1),
        ankles=np.stack([home_ankle(feet_at, seat.yaw, index, 0.085, skeleton) for index in (0, 1)]),
        feet=np.stack([rotations.yaw_to_quat(seat.yaw + side * FOOT_SPLAY) for side in (1, -1)]),
        toes=np.zeros(2),
        knees=np.stack([np.array([out[0], 0.25, out[1]])] * 2),
        arms=np.array([[0.25, -0.9, -0.05], [-0.25, -0.9, -0.05]]),
        elbows=np.array([[0.5, 0.0, -1.0], [-0.5, 0.0, -1.0]]),
        reaching=np.zeros(2),
        pressing=np.zeros(2),
        planted=np.ones(2),
    )


def _leaning(sat: Pose, seat: Seat, bed: Bed, skeleton: Skeleton) -> Pose:
    """Sitting on the edge, leaning towards the head end on that hand."""
    way = _head_side(seat, bed)
    tilted = rotations.compose(upright(seat.yaw, 0.12), rotations.rotvec_to_quat(np.array([0.0, 0.0, -0.22 * way])))
    pose = replace(
        sat, hips=tilted, spine=bend(0.22, side=-0.26 * way), head=bend(0.05, turn=0.35 * way), pressing=np.zeros(2)
    )
    return _on_a_hand(pose, seat, bed, skeleton, share=1.0)


def _bound_for(leaning: Pose, pose: Pose) -> Pose:
    """The same pose with hands that are free bound for where they bear, so that they go there by the shortest way."""
    free = pose.reaching[:, None] <= 0
    reach, palms = np.where(free, leaning.reach, pose.reach), np.where(free, leaning.palms, pose.palms)
    return replace(pose, reach=reach, palms=palms)


def _on_a_hand(pose: Pose, seat: Seat, bed: Bed, skeleton: Skeleton, share: float) -> Pose:
    """The hand on the side of the head end on the mattress beside the edge, the other before the body."""
    way = _head_side(seat, bed)
    index = 0 if way > 0 else 1
    up = np.array([np.sin(bed.head_yaw), 0.0, np.cos(bed.head_yaw)])
    inward = -np.array([np.sin(seat.yaw), 0.0, np.cos(seat.yaw)])
    room = bed.back - float((seat.pelvis - bed.pelvis) @ up) - 0.12
    place = (
        seat.pelvis
        + float(np.clip(room, 0.24 * skeleton.scale, 0.36 * skeleton.scale)) * up
        + 0.10 * skeleton.scale * inward
    )
    place[1] = bed.surface + HAND_REST
    mirror = np.array([way, 1.0, 1.0])
    arms, elbows = pose.arms.copy(), pose.elbows.copy()
    reach, palms = pose.reach.copy(), pose.palms.copy()
    reaching, pressing = np.zeros(2), np.zeros(2)
    reach[index], reaching[index], pressing[index] = place, share, 0.5 * share
    palms[index] = palm_on(UP, bed.head_yaw - 0.3 * way, ("left", "right")[index])
    elbows[index] = np.array([0.9, 0.1, -0.7]) * mirror
    arms[1 - index] = np.array([-0.20, -0.42, 0.52]) * mirror
    elbows[1 - index] = np.array([-0.15, -1.0, 0.1]) * mirror
    posed = replace(pose, reach=reach, reaching=reaching, palms=palms, pressing=pressing, arms=arms, elbows=elbows)
    arms[index] = released(posed, skeleton).arms[index]
    return replace(posed, arms=arms)


def _half_way(leaning: Pose, seat: Seat, bed: Bed, skeleton: Skeleton) -> Pose:
    """Leaning on one arm with the legs just off the floor."""
    hips = rotations.slerp(upright(seat.yaw, 0.0), bed.hips("back"), 0.42)
    pelvis = seat.pelvis + 0.35 * (bed.pelvis - seat.pelvis) + 0.02 * UP
    local = np.array([[0.10, -0.50, 0.47], [-0.10, -0.50, 0.47]]) * skeleton.scale
    pose = replace(
        leaning,
        pelvis=pelvis,
        hips=hips,
        spine=bend(0.45, side=-0.12 * _head_side(seat, bed)),
        head=bend(0.25),
        ankles=pelvis + rotations.rotate(hips, local),
        feet=np.repeat(rotations.compose(hips, rotations.rotvec_to_quat(np.array([0.35, 0, 0])))[None], 2, axis=0),
        knees=np.stack([rotations.rotate(hips, np.array([0.1 * s, 0.1, 1.0])) for s in (1, -1)]),
        planted=np.zeros(2),
    )
    return _on_a_hand(pose, seat, bed, skeleton, share=1.0)


def _legs_over(middle: Pose, bed: Bed, skeleton: Skeleton) -> Pose:
    """Legs over the edge and above the bed, trunk nearly down, the hand that bore it free."""
    support = middle.reaching[:, None] > 0
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
        arms=np.where(support, np.array([[0.50, -0.62, 0.22], [-0.50, -0.62, 0.22]]), middle.arms),
        elbows=np.where(support, np.array([[0.6, -0.4, -0.6], [-0.6, -0.4, -0.6]]), middle.elbows),
        reaching=np.zeros(2),
        pressing=np.zeros(2),
    )


def _rolled(start: Pose, bed: Bed, bearing: Bearing, skeleton: Skeleton) -> Pose:
    """On the way to the side of the edge, knees bent; who is in a hurry hardly rolls."""
    roll = 0.3 if bearing.tempo > HURRIED else 0.75
    way = 1.0 if bed.edge_side == "left" else -1.0
    flat = lying(start, bed, Lying(bearing=bearing, legs="bent", arms=("belly", "belly")), skeleton)
    turn = rotations.rotvec_to_quat(np.array([0.0, roll * way, 0.0]))
    hips = rotations.compose(flat.hips, turn)
    local = np.array([[0.10, -0.50, 0.10], [-0.10, -0.50, 0.10]]) * skeleton.scale
    return replace(
        flat,
        pelvis=flat.pelvis + 0.02 * UP,
        palms=start.palms,
        hips=hips,
        spine=bend(0.35, side=0.4 * roll * way),
        head=bend(0.35, turn=0.3 * way),
        ankles=flat.pelvis + rotations.rotate(hips, local),
        feet=rotations.compose(hips, rotations.rotvec_to_quat(np.array([[0.9, 0.0, 0.0]] * 2))),
        knees=np.stack([rotations.rotate(hips, np.array([0.1 * s, 0.0, 1.0])) for s in (1, -1)]),
        # Both hands go before the chest, that the arm below is not lain on.
        arms=np.array([[-0.08, -0.42, 0.52], [0.08, -0.42, 0.52]]),
        elbows=np.array([[0.1, -0.8, 0.3], [-0.1, -0.8, 0.3]]),
        pressing=np.zeros(2),
    )
