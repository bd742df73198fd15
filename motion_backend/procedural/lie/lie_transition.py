"""Lying down and getting up, as key poses over the edge of what is lain on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import FOOT_SPLAY, SHIN_REACH, UP, Seat, bend, both_sides, upright
from motion_backend.procedural.lie.lie_keys import BearingHand, LegsUp, LieKeys, OnEdge, Rolled, SittingUp
from motion_backend.procedural.lie.lie_pose import Bed, lying
from motion_backend.procedural.lie.lie_styles import Lying
from motion_backend.procedural.pose import Pose, interpolate
from motion_backend.procedural.pose_solver import released
from motion_backend.procedural.touch.hand_contacts import palm_on
from motion_backend.procedural.walk.footsteps import home_ankle
from motion_backend.rotations import Array
from motion_backend.skeleton import HAND_REST, Skeleton

LIFTED = 0.10
"""How high a leg is lifted over the other one or over the edge (metres)."""
ASIDE, HIGHER = 0.10, 0.03
"""How far it goes aside to come off the other one, and towards the head (metres)."""
CROSSED = 0.07
"""Ankles nearer to each other from side to side are crossed (metres)."""
HURRIED = 1.35
"""Who is quicker than this gets up straight ahead."""
ON_EDGE = 0.12
"""Who sits on the edge of a bed sits so far inside it at least (metres)."""
SOFT = 0.01
"""How much lower the pelvis is that sits on what it would lie on (metres)."""
PAST_HAND = 0.12
"""A hand is so far from the end of a bed at least (metres)."""


def edge_seat(bed: Bed, standing_point: tuple[float, float], outward: float, edge: float, scale: float) -> Seat:
    """Where one sits on the edge of a bed before lying down, facing `outward` (yaw)."""
    out = np.array([np.sin(outward), 0.0, np.cos(outward)])
    stand = np.array([standing_point[0], 0.0, standing_point[1]])
    from_bed = float((stand - bed.pelvis) @ out)
    inside = float(np.clip(from_bed - SHIN_REACH * scale, -np.inf, edge - ON_EDGE))
    along = stand - bed.pelvis - from_bed * out
    along[1] = 0.0
    pelvis = bed.pelvis + inside * out + along
    pelvis[1] = bed.pelvis[1] - SOFT
    return Seat(pelvis, outward, np.inf)


def lie_down(landed: Pose, seat: Seat, bed: Bed, style: Lying, skeleton: Skeleton, keys: LieKeys) -> Pose:
    """From the edge: lean towards the head end on an arm, swing the legs up, lower the trunk; only then settle."""
    first, second, third, fourth = keys.down.pose
    sat = _on_edge(first, landed, seat, bed)
    leaning = _leaning(second, sat, seat, bed, skeleton, keys.down.hand)
    landed, sat = _bound_for(leaning, landed), _bound_for(leaning, sat)
    middle = _half_way(third, leaning, seat, bed, skeleton, keys.down.hand)
    over = _legs_over(fourth, middle, seat, bed, skeleton, keys.down.hand)
    end = lying(landed, bed, style, skeleton, keys.pose)
    # Hands are turned to what they lie on only as they get there.
    bent = replace(lying(landed, bed, gathered(style), skeleton, keys.pose), palms=end.palms, pressing=np.zeros(2))
    lifted, settle = freed(end, bed), keys.down.settle
    waits = [row.wait_s for row in keys.down.pose] + [settle.bent_wait_s] + [settle.lifted_wait_s] * len(lifted)
    waits.append(settle.end_after_lifted_wait_s if lifted else settle.end_wait_s)
    return _through([landed, sat, leaning, middle, over, bent, *lifted, end], waits, style.bearing)


def rise_to_edge(start: Pose, seat: Seat, bed: Bed, bearing: Bearing, skeleton: Skeleton, keys: LieKeys) -> Pose:
    """From lying to sitting on the edge: roll to it with bent knees, legs over it, push up on an arm."""
    first, second, third, fourth, last = keys.up.pose
    sat = _sitting(last, start, seat, skeleton)
    leaning = _leaning(fourth, sat, seat, bed, skeleton, keys.up.hand)
    sat = _bound_for(leaning, sat)
    middle = _half_way(third, leaning, seat, bed, skeleton, keys.up.hand)
    flat = Lying(bearing=bearing, legs="bent", arms=("belly", "belly"))
    rolled = _rolled(first, lying(start, bed, flat, skeleton, keys.pose), start.palms, bed, bearing, skeleton)
    over = _legs_over(second, middle, seat, bed, skeleton, keys.up.hand)
    lifted = freed(start, bed)
    waits = [keys.up.leave.lifted_wait_s] * len(lifted) + [row.wait_s for row in keys.up.pose]
    return _through([start, *lifted, rolled, over, middle, leaning, sat], waits, bearing)


def _through(poses: list[Pose], waits: list[float], bearing: Bearing) -> Pose:
    """From pose to pose, with the time each takes from the one before at tempo 1 (seconds)."""
    times = np.concatenate([[0.0], np.cumsum(waits)]) * (1 / bearing.tempo)
    return interpolate(times.tolist(), poses, FPS)


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
    local[index] += [ASIDE if index == 0 else -ASIDE, HIGHER, LIFTED]
    ankles[index] = pose.pelvis + rotations.rotate(pose.hips, local[index])
    return [replace(pose, ankles=ankles)]


def _head_side(seat: Seat, bed: Bed) -> float:
    """1 where the head end is to the left of who sits on the edge, -1 to the right."""
    return 1.0 if np.sin(bed.head_yaw - seat.yaw) > 0 else -1.0


def _sitting(row: SittingUp, start: Pose, seat: Seat, skeleton: Skeleton) -> Pose:
    """Upright on the edge with both feet down."""
    out = np.array([np.sin(seat.yaw), np.cos(seat.yaw)])
    feet_at = seat.pelvis[[0, 2]] + SHIN_REACH * skeleton.scale * out
    return replace(
        start,
        pelvis=seat.pelvis,
        hips=upright(seat.yaw, row.hip_pitch_rad),
        spine=bend(row.spine_pitch_rad),
        head=bend(row.head_pitch_rad),
        ankles=np.stack([home_ankle(feet_at, seat.yaw, index, row.foot_out_m, skeleton) for index in (0, 1)]),
        feet=np.stack([rotations.yaw_to_quat(seat.yaw + side * FOOT_SPLAY) for side in (1, -1)]),
        toes=np.zeros(2),
        knees=np.stack([np.array([out[0], row.knee_up_ratio, out[1]])] * 2),
        arms=both_sides(row.wrist_ratio),
        elbows=both_sides(row.elbow_direction),
        reaching=np.zeros(2),
        pressing=np.zeros(2),
        planted=np.ones(2),
    )


def _on_edge(row: OnEdge, sat: Pose, seat: Seat, bed: Bed) -> Pose:
    """Sitting on the edge, turned or bent towards the head end."""
    way = _head_side(seat, bed)
    roll = rotations.rotvec_to_quat(np.array([0.0, 0.0, row.hip_roll_rad * way]))
    return replace(
        sat,
        hips=rotations.compose(upright(seat.yaw, row.hip_pitch_rad), roll),
        spine=bend(row.spine_pitch_rad, side=row.spine_side_rad * way),
        head=bend(row.head_pitch_rad, turn=row.head_turn_rad * way),
    )


def _leaning(row: OnEdge, sat: Pose, seat: Seat, bed: Bed, skeleton: Skeleton, hand: BearingHand) -> Pose:
    """Sitting on the edge, leaning towards the head end on that hand."""
    return _on_a_hand(_on_edge(row, sat, seat, bed), seat, bed, skeleton, hand)


def _bound_for(leaning: Pose, pose: Pose) -> Pose:
    """The same pose with hands that are free bound for where they bear, so that they go there by the shortest way."""
    free = pose.reaching[:, None] <= 0
    reach, palms = np.where(free, leaning.reach, pose.reach), np.where(free, leaning.palms, pose.palms)
    return replace(pose, reach=reach, palms=palms)


def _on_a_hand(pose: Pose, seat: Seat, bed: Bed, skeleton: Skeleton, hand: BearingHand) -> Pose:
    """The hand on the side of the head end on the mattress beside the edge, the other before the body."""
    way, scale = _head_side(seat, bed), skeleton.scale
    index = 0 if way > 0 else 1
    up = np.array([np.sin(bed.head_yaw), 0.0, np.cos(bed.head_yaw)])
    inward = -np.array([np.sin(seat.yaw), 0.0, np.cos(seat.yaw)])
    room = bed.back - float((seat.pelvis - bed.pelvis) @ up) - PAST_HAND
    headwards = float(np.clip(room, hand.min_headwards_m * scale, hand.max_headwards_m * scale))
    place = seat.pelvis + headwards * up + hand.inwards_m * scale * inward
    place[1] = bed.surface + HAND_REST
    arms, elbows = pose.arms.copy(), pose.elbows.copy()
    reach, palms = pose.reach.copy(), pose.palms.copy()
    reaching, pressing = np.zeros(2), np.zeros(2)
    reach[index], reaching[index], pressing[index] = place, 1.0, hand.pressing_share
    palms[index] = palm_on(UP, bed.head_yaw - hand.fingers_out_rad * way, ("left", "right")[index])
    elbows[index] = both_sides(hand.elbow_direction)[index]
    arms[1 - index] = both_sides(hand.free_wrist_ratio)[1 - index]
    elbows[1 - index] = both_sides(hand.free_elbow_direction)[1 - index]
    posed = replace(pose, reach=reach, reaching=reaching, palms=palms, pressing=pressing, arms=arms, elbows=elbows)
    arms[index] = released(posed, skeleton).arms[index]
    return replace(posed, arms=arms)


def _half_way(row: LegsUp, leaning: Pose, seat: Seat, bed: Bed, skeleton: Skeleton, hand: BearingHand) -> Pose:
    """Leaning on one arm with the legs just off the floor."""
    hips = rotations.slerp(upright(seat.yaw, 0.0), bed.hips("back"), row.lain_share)
    pelvis = seat.pelvis + row.pelvis_share * (bed.pelvis - seat.pelvis) + row.pelvis_up_m * UP
    pose = _legs_up(row, leaning, pelvis, hips, skeleton.scale)
    spine = bend(row.spine_pitch_rad, side=row.spine_side_rad * _head_side(seat, bed))
    return _on_a_hand(replace(pose, spine=spine), seat, bed, skeleton, hand)


def _legs_over(row: LegsUp, middle: Pose, seat: Seat, bed: Bed, skeleton: Skeleton, hand: BearingHand) -> Pose:
    """Legs over the edge and above the bed, trunk nearly down, the hand that bore it free."""
    support = middle.reaching[:, None] > 0
    hips = rotations.slerp(middle.hips, bed.hips("back"), row.lain_share)
    pelvis = middle.pelvis + row.pelvis_share * (bed.pelvis - middle.pelvis) + row.pelvis_up_m * UP
    return replace(
        _legs_up(row, middle, pelvis, hips, skeleton.scale),
        spine=bend(row.spine_pitch_rad, side=row.spine_side_rad * _head_side(seat, bed)),
        arms=np.where(support, both_sides(hand.after_wrist_ratio), middle.arms),
        elbows=np.where(support, both_sides(hand.after_elbow_direction), middle.elbows),
        reaching=np.zeros(2),
        pressing=np.zeros(2),
    )


def _legs_up(row: LegsUp | Rolled, pose: Pose, pelvis: Array, hips: Array, scale: float) -> Pose:
    """Both legs off what they were on, as a row has them against the pelvis."""
    foot = rotations.compose(hips, rotations.rotvec_to_quat(np.array([row.foot_pitch_rad, 0.0, 0.0])))
    return replace(
        pose,
        pelvis=pelvis,
        hips=hips,
        head=bend(row.head_pitch_rad),
        ankles=pelvis + rotations.rotate(hips, both_sides(row.ankle_m) * scale),
        feet=np.stack([foot, foot]),
        knees=rotations.rotate(hips, both_sides(row.knee_direction)),
        planted=np.zeros(2),
    )


def _rolled(row: Rolled, flat: Pose, palms: Array, bed: Bed, bearing: Bearing, skeleton: Skeleton) -> Pose:
    """On the way to the side of the edge from lying flat with bent knees; who is in a hurry hardly rolls."""
    roll = row.hurried_roll_rad if bearing.tempo > HURRIED else row.roll_rad
    way = 1.0 if bed.edge_side == "left" else -1.0
    hips = rotations.compose(flat.hips, rotations.rotvec_to_quat(np.array([0.0, roll * way, 0.0])))
    return replace(
        _legs_up(row, flat, flat.pelvis, hips, skeleton.scale),
        pelvis=flat.pelvis + row.pelvis_up_m * UP,
        palms=palms,
        spine=bend(row.spine_pitch_rad, side=row.spine_side_ratio * roll * way),
        head=bend(row.head_pitch_rad, turn=row.head_turn_rad * way),
        arms=both_sides(row.wrist_ratio),
        elbows=both_sides(row.elbow_direction),
        pressing=np.zeros(2),
    )
