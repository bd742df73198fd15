"""Sitting down and standing up, as key poses with planted feet between them."""

from __future__ import annotations

from dataclasses import replace
from math import ceil
from typing import NamedTuple

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import Bearing, arm_arrays
from motion_backend.procedural.held_poses import BENT_LEG, UP, Seat, bend, both_sides, part_way, standing, upright
from motion_backend.procedural.pose import Pose, concatenate, interpolate, smooth
from motion_backend.procedural.pose_solver import released
from motion_backend.procedural.sit.sit_keys import (
    Look,
    Lower,
    Lowered,
    Move,
    Ready,
    Risen,
    Settling,
    SitDown,
    SitKeys,
    StandUp,
)
from motion_backend.procedural.sit.sit_legs import at_front
from motion_backend.procedural.sit.sit_pose import Place, seated
from motion_backend.procedural.sit.sit_styles import Manner, Seated
from motion_backend.procedural.touch.hand_rests import Holds, at_rest, follow
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

ARM = 0.54
"""Shoulder to wrist at the reference height (metres)."""
NOTHING: Holds = (None, None)
AROUND, ROUND_THIGHS = 0.4, (1.0, 0.0, -0.5)
"""How far hands come out on their way down to the seat (arm lengths), and which way the left one does."""
LEAVES, ARRIVES = 0.3, 0.35
"""Shares of their way in which hands let go of what they held, and from which on they take hold of the next thing."""
OVER, RISES = 0.14, 0.6
"""How much higher than half-way a foot goes at most that is laid over the other leg (metres), and for how much rise."""
MAX_LIFT, LIFT = 0.08, 0.28
"""How high a foot is lifted in a step at most (metres), and for how long a step."""
STEP = 1.8
"""Seconds a foot takes for a metre, where that is longer than a small step."""
WAITS, WAITS_TO_STAND = 0.75, 0.9
"""Shares of a step after which the other foot leaves: a foot that leaves the floor waits until the other stands."""
STRAIGHT, SLOWLY = (0.93, 0.10), 0.5
"""A leg longer than such a share of its length is near straight, and the straighter the more slowly its foot sets out,
up to such a power of its share of the way."""
HOPS = 0.03
"""A leg that is too short by more than this does not stretch for the floor (metres)."""
SLIDES = 0.05
"""A pelvis that moves by more while feet are taken elsewhere slides on its seat (metres)."""
BEHIND = 0.02
"""A foot that is so much nearer to the pelvis lies behind the other's shin (metres)."""
SINK = 0.014
"""How deep one who plumps down sinks into the seat before it gives back (metres)."""
MIN_GLANCE = 0.2
"""Who would look back less than this (see `Manner`) does not look."""
SEAT_DROP, MIN_DEPTH, MAX_DEPTH = 0.4, 0.6, 2.0
"""How far a pelvis comes down to an ordinary seat (metres at 1.70 m), and the bounds of other depths against that."""
ANY_DEPTH, EACH_DEPTH = 0.7, 0.3
"""Shares of the time down and up that every seat takes, and that grows with its depth."""
KNEES_TURN = 0.5
"""How long knees take to come over the feet (seconds)."""
KNEES_UP, LEVEL_KNEES_UP, STEEP = 0.25, 1.5, 0.6
"""How far bent knees point up, against ahead, and how much farther in level legs; legs are, little by little, that rise
to the pelvis by less than this (sine)."""


def sit_down(
    start: Pose, place: Place, style: Seated, felt: Holds, skeleton: Skeleton, keys: SitKeys
) -> tuple[Pose, Holds]:
    """From standing with the back to a seat: look, hips back, lower, touch down, settle; then the way of sitting.

    `felt` is what the hands feel for on the way down. Returned with it is what they lie on in the end.
    """
    pace = 1 / style.bearing.tempo
    ready = _looking_back(start, style.manner, pace, keys.down.look)
    before = start if ready is None else ready.at(len(ready) - 1)
    front = at_front(place.seat, skeleton.scale)
    down = lower_onto(before, front, style, felt, skeleton, keys.down)
    landed = down.at(len(down) - 1)
    settle = _settling(landed, front, style, pace, keys.down.settle)
    moved, holds = settle_in(settle.at(len(settle) - 1), place, style, skeleton, keys)
    return concatenate([part for part in (ready, down, settle, moved) if part is not None]), holds


def settle_in(touched: Pose, place: Place, style: Seated, skeleton: Skeleton, keys: SitKeys) -> tuple[Pose, Holds]:
    """From the seat that is sat on into the way of sitting, and what the hands then lie on."""
    pace, take = 1 / style.bearing.tempo, keys.down.take
    landed = released(touched, skeleton)
    settled, holds = seated(landed, place, style, skeleton, keys.pose)
    poses = [landed, replace(settled, ankles=landed.ankles, feet=landed.feet)]
    low = place.seat.is_low(skeleton.scale)
    seconds = hands_take(landed, settled, take, skeleton) * pace * (ROUND_KNEES if low else 1.0)
    moved = interpolate([0.0, seconds], poses, FPS)
    moved = follow(place_feet(moved, landed, settled, take, skeleton), settled, holds, skeleton)
    return _taken(moved, landed, holds), holds


def hands_take(start: Pose, end: Pose, move: Move, skeleton: Skeleton) -> float:
    """Seconds that hands take from pose to pose at tempo 1: from the head longer than from the lap."""
    travel = float(np.linalg.norm(end.arms - start.arms, axis=1).max()) * ARM * skeleton.scale
    return max(move.min_time_s, move.time_per_m_s * travel)


ROUND_KNEES = 1.4
"""Hands take so much longer on the floor: they go round knees that are up."""


def _depth(stood: Pose, seat: Seat, scale: float) -> float:
    """How deep a seat is below a standing body, against an ordinary one."""
    return float(np.clip((stood.pelvis[1] - seat.pelvis[1]) / (SEAT_DROP * scale), MIN_DEPTH, MAX_DEPTH))


def _taken(moved: Pose, start: Pose, holds: Holds) -> Pose:
    """Hands that leave what they held and turn to what they go to; late on the way they hold on to it."""
    share = np.linspace(0.0, 1.0, len(moved))
    turned, late = smooth(share)[:, None], smooth((share - ARRIVES) / (1 - ARRIVES))[:, None]
    wanted = np.array([0.0 if hold is None else 1.0 for hold in holds])
    return replace(
        moved,
        palms=rotations.slerp(start.palms[None], moved.palms, turned),
        reaching=late * wanted,
        pressing=(1 - smooth(share / LEAVES)[:, None]) * start.pressing + late * wanted,
    )


def _looking_back(start: Pose, manner: Manner, pace: float, look: Look) -> Pose | None:
    """A look over the shoulder at the seat; None for who does not look."""
    if manner.glance < MIN_GLANCE:
        return None
    turned = replace(
        start,
        head=start.head + bend(look.head_pitch_rad * manner.glance, turn=look.head_turn_rad * manner.glance),
        spine=start.spine + bend(look.spine_pitch_rad, turn=look.spine_turn_rad * manner.glance),
    )
    return interpolate([0.0, look.time_s * pace], [start, turned], FPS)


class _WayDown(NamedTuple):
    """What the key poses down to one seat have in common, for one body."""

    seat: Seat
    aside: Array
    """Sway to the side (metres). (3,)."""
    lean: float
    """Forwards (radians)."""
    tuck: float
    """The share of it that hips do not take for being folded."""
    arms: Array
    """Wrists where they balance, as `Pose.arms`. (2, 3)."""
    elbows: Array


def lower_onto(start: Pose, seat: Seat, style: Seated, felt: Holds, skeleton: Skeleton, keys: SitDown) -> Pose:
    """Standing to first contact with the seat, a hand or two feeling for it."""
    depth = _depth(start, seat, skeleton.scale)
    way = _way_down(seat, style, depth, keys.lower, seat.is_low(skeleton.scale))
    poses = [_in_reach(_lowered(row, start, way), skeleton) for row in keys.pose]
    contact = at_rest(poses[-1], felt, skeleton)
    before = [
        _feeling(pose, contact, row.felt_share, felt, skeleton)
        for pose, row in zip(poses[:-1], keys.pose[:-1], strict=True)
    ]
    seconds = keys.lower.time_s * (1 / style.bearing.tempo) * (ANY_DEPTH + EACH_DEPTH * depth)
    times = [0.0, *(row.time_share * seconds for row in keys.pose)]
    down = interpolate(times, [start, *before, contact], FPS)
    over, turned = knees_over_feet(down), smooth(np.arange(1, len(down) + 1) / (KNEES_TURN * FPS))
    return replace(down, knees=start.knees + turned[:, None, None] * (over - start.knees))


def _way_down(seat: Seat, style: Seated, depth: float, lower: Lower, low: bool) -> _WayDown:
    arms, elbows = arm_arrays("hang", "hang")
    arms = arms * [1.0, lower.arms_down_share, 1.0] + [0.0, 0.0, lower.arms_ahead_ratio]
    if low:
        arms = arms + both_sides((lower.low_arms_out_ratio, lower.low_arms_up_ratio, 0.0))
    aside = style.manner.sway * rotations.rotate(rotations.yaw_to_quat(seat.yaw), np.array([1.0, 0.0, 0.0]))
    lean = lower.lean_rad + lower.lean_per_depth_rad * depth
    return _WayDown(seat, aside, lean, lower.low_tuck_share if low else 0.0, arms, elbows)


def _lowered(row: Lowered, start: Pose, way: _WayDown) -> Pose:
    """A key pose on the way down, hands not yet on what they feel for."""
    level = row.pelvis_back_share
    pelvis = part_way(start.pelvis, way.seat.pelvis, [level, row.pelvis_down_share, level])
    return replace(
        start,
        pelvis=pelvis + row.sway_ratio * way.aside,
        hips=upright(way.seat.yaw, (row.hip_pitch_share - row.hip_tuck_ratio * way.tuck) * way.lean),
        spine=bend((row.spine_pitch_share + row.spine_tuck_ratio * way.tuck) * way.lean),
        head=bend(row.head_pitch_rad),
        arms=(1 - row.arms_share) * start.arms + row.arms_share * way.arms,
        elbows=way.elbows,
        reaching=np.zeros(2),
        pressing=np.zeros(2),
    )


def _in_reach(pose: Pose, skeleton: Skeleton) -> Pose:
    """A key pose with feet off the floor where the seat is too high for its legs: one hops up, and down."""
    ankles, planted = pose.ankles.copy(), pose.planted.copy()
    for index, side in enumerate(("left", "right")):
        hip = pose.pelvis + rotations.rotate(pose.hips, skeleton.offsets[INDEX[f"{side}_hip"]])
        level = np.hypot(*(ankles[index] - hip)[[0, 2]])
        height = np.sqrt(max((BENT_LEG * skeleton.scale) ** 2 - level**2, 0.0))
        if hip[1] - ankles[index, 1] > height + HOPS:
            ankles[index, 1], planted[index] = hip[1] - height, 0.0
    return replace(pose, ankles=ankles, planted=planted)


def _feeling(pose: Pose, contact: Pose, share: float, felt: Holds, skeleton: Skeleton) -> Pose:
    """Hands that will hold on come out to the side on their way round the thighs, and are there so far already."""
    outwards = AROUND * contact.reaching[:, None] * both_sides(ROUND_THIGHS)
    pose = replace(pose, arms=pose.arms + outwards, reach=contact.reach, palms=contact.palms)
    if share == 0.0:
        return pose
    return replace(pose, arms=at_rest(pose, felt, skeleton).arms, reaching=share * contact.reaching)


def _settling(landed: Pose, seat: Seat, style: Seated, pace: float, rows: tuple[Settling, ...]) -> Pose:
    """The weight comes down: the seat gives and gives back, the trunk comes up over it."""
    plump = style.manner.plump
    poses = [
        replace(
            landed,
            pelvis=seat.pelvis - row.sink_ratio * (SINK * plump) * UP,
            spine=row.spine_share * landed.spine,
            head=landed.head + bend(row.head_pitch_rad * plump),
        )
        for row in rows
    ]
    times = [row.time_s + row.tempo_time_s * pace for row in rows]
    return interpolate([0.0, *times], [landed, *poses], FPS)


def knees_over_feet(pose: Pose) -> Array:
    """Knees point where their feet point, a little up, so that deep bends stay in plane; and up where legs are level,
    of which feet that look inwards would make knees that cross. (T, 2, 3)."""
    forward = rotations.rotate(rotations.yaw_to_quat(yaw_of(pose.feet)), np.array([0.0, 0.0, 1.0]))
    leg = pose.pelvis[:, None] - pose.ankles
    steep = leg[..., 1:2] / np.linalg.norm(leg, axis=-1, keepdims=True)
    level = np.clip((STEEP - steep) / STEEP, 0.0, 1.0)
    return np.asarray(forward + (KNEES_UP + LEVEL_KNEES_UP * level) * UP)


def place_feet(pose: Pose, before: Pose, after: Pose, move: Move, skeleton: Skeleton) -> Pose:
    """Move the feet one after the other in small lifted steps from where they were to where they go."""
    ankles, feet, planted, knees = pose.ankles.copy(), pose.feet.copy(), pose.planted.copy(), pose.knees.copy()
    time, first, second = np.arange(1, len(pose) + 1) / FPS, *_first_foot(before, after)
    takes = np.maximum(move.foot_time_s, STEP * np.linalg.norm(after.ankles - before.ankles, axis=1))
    wait = (WAITS if after.planted.all() else WAITS_TO_STAND) * float(takes[first])
    if float(np.linalg.norm(after.pelvis - before.pelvis)) > SLIDES:
        # Who slides back on a seat that is too high for the feet takes both along.
        wait = 0.0
    for index, begins in ((first, move.first_foot_s), (second, move.first_foot_s + wait)):
        gap = float(np.linalg.norm(after.ankles[index] - before.ankles[index]))
        share = np.clip((time - begins) / takes[index], 0.0, 1.0)
        begun = smooth(share) ** (1 + _straight(before, index, skeleton))
        way = 1 - (1 - begun[:, None]) ** (1 + _straight(after, index, skeleton))
        ankles[:, index] = before.ankles[index] + way * (after.ankles[index] - before.ankles[index])
        rise = float(after.ankles[index, 1] - before.ankles[index, 1])
        # A foot that goes onto the other knee goes over it.
        ankles[:, index, 1] += max(min(MAX_LIFT, LIFT * gap), min(RISES * rise, OVER)) * np.sin(np.pi * way[:, 0]) ** 2
        feet[:, index] = rotations.slerp(before.feet[index], after.feet[index], way[:, 0])
        knees[:, index] = before.knees[index] + way * (after.knees[index] - before.knees[index])
        stands = np.where(share <= 0, before.planted[index], np.where(share >= 1, after.planted[index], 0.0))
        planted[:, index] = stands
    short = max(ceil((move.first_foot_s + max(takes[first], wait + takes[second])) * FPS) - len(pose), 0)
    if short:
        # The feet take longer than the trunk: hold the trunk until both are placed.
        held = pose.at(slice(len(pose) - 1, len(pose)))
        return place_feet(concatenate([pose, *([held] * short)]), before, after, move, skeleton)
    return replace(pose, ankles=ankles, feet=feet, planted=planted, knees=knees)


def _straight(pose: Pose, index: int, skeleton: Skeleton) -> float:
    """How slowly the foot of a leg that is near straight sets out or arrives: its knee goes far as soon as it moves."""
    side = ("left", "right")[index]
    hip = pose.pelvis + rotations.rotate(pose.hips, skeleton.offsets[INDEX[f"{side}_hip"]])
    length = -float(skeleton.offsets[INDEX["left_knee"], 1] + skeleton.offsets[INDEX["left_ankle"], 1])
    share = float(np.linalg.norm(pose.ankles[index] - hip)) / length
    return float(np.clip((share - STRAIGHT[0]) / STRAIGHT[1], 0.0, SLOWLY))


def _first_foot(before: Pose, after: Pose) -> tuple[int, int]:
    """Which foot goes first: one that will stand, else one that comes to lie behind the other's shin; of two that
    stand the one with the longer way."""
    if before.planted.all() and after.planted.all():
        way = np.linalg.norm(after.ankles - before.ankles, axis=1)
        return (0, 1) if way[0] > way[1] else (1, 0)
    away = np.linalg.norm((after.ankles - after.pelvis)[:, [0, 2]], axis=1)
    left = after.planted[0] > after.planted[1] or (not after.planted.any() and away[0] < away[1] - BEHIND)
    return (0, 1) if left else (1, 0)


def stand_up(start: Pose, seat: Seat, bearing: Bearing, push: Holds, skeleton: Skeleton, keys: StandUp) -> Pose:
    """From a seat to standing before it: feet under, lean forward, push off with the hands, rise over the feet."""
    low, pace, seat = seat.is_low(skeleton.scale), 1 / bearing.tempo, at_front(seat, skeleton.scale)
    end = standing(seat.standing_point(skeleton.scale), seat.yaw, bearing, skeleton)
    depth = _depth(end, seat, skeleton.scale)
    lean = keys.rise.lean_rad + keys.rise.lean_per_depth_rad * depth
    ready, rows = keys.pose[0], keys.low_pose if low else keys.pose[1:]
    fold = keys.rise.low_fold_share if low else 0.0
    over = _over_the_feet(start, end, seat, keys.rise.gathered_share * lean, fold, ready)
    over = at_rest(_in_reach(over, skeleton), push, skeleton)
    seconds = hands_take(start, over, keys.gather, skeleton) * pace
    gather = interpolate([0.0, seconds], [start, replace(over, ankles=start.ankles, feet=start.feet)], FPS)
    gather = follow(place_feet(gather, start, over, keys.gather, skeleton), over, push, skeleton)
    gather = _taken(gather, start, push)
    over = gather.at(len(gather) - 1)
    seconds = keys.rise.time_s * pace * (ANY_DEPTH + EACH_DEPTH * depth) * (keys.rise.low_time_ratio if low else 1.0)
    times = [*(row.time_share * seconds for row in (ready, *rows)), seconds]
    leant = replace(
        over,
        pelvis=seat.pelvis
        + ready.pelvis_ahead_m * skeleton.scale * np.array([np.sin(seat.yaw), 0.0, np.cos(seat.yaw)]),
        **_lean(seat, lean, fold, ready),
    )
    over_feet = lean * (keys.rise.low_lean_ratio if low else 1.0)
    stands = replace(over, ankles=end.ankles, planted=end.planted)
    risen = [_in_reach(_risen(row, stands, end, seat, over_feet), skeleton) for row in rows]
    up = interpolate([0.0, *times], [over, leant, *risen, replace(end, reach=over.reach, palms=over.palms)], FPS)
    up = follow(replace(up, knees=knees_over_feet(up)), over, push, skeleton)
    return concatenate([gather, up])


def _over_the_feet(start: Pose, end: Pose, seat: Seat, lean: float, fold: float, row: Ready) -> Pose:
    """Still on the seat, feet under it and the trunk over them; `fold` is what the spine takes from the hips."""
    return replace(
        start,
        pelvis=seat.pelvis,
        **_lean(seat, lean, fold, row),
        head=bend(0.0),
        ankles=end.ankles,
        feet=end.feet,
        toes=np.zeros(2),
        knees=end.knees + KNEES_UP * UP,
        arms=end.arms + np.array([0.0, row.arms_up_ratio, row.arms_ahead_ratio]),
        elbows=end.elbows,
        reaching=np.zeros(2),
        pressing=np.zeros(2),
        planted=np.ones(2),
    )


def _lean(seat: Seat, lean: float, fold: float, row: Ready) -> dict[str, Array]:
    """Hips and spine of who leans over the feet; `fold` is what the spine takes from the hips."""
    return {
        "hips": upright(seat.yaw, (row.hip_pitch_share - fold) * lean),
        "spine": bend((row.spine_pitch_share + fold) * lean),
    }


def _risen(row: Risen, ready: Pose, end: Pose, seat: Seat, lean: float) -> Pose:
    """A key pose between leaning over the feet and standing."""
    # Hands that pushed off let go and come forward as the weight goes over the feet.
    forwards = 0.5 * (ready.arms + end.arms + [0.0, row.arms_up_ratio, row.arms_ahead_ratio])
    level = row.pelvis_ahead_share
    return replace(
        ready,
        pelvis=part_way(seat.pelvis, end.pelvis, [level, row.pelvis_up_share, level]),
        hips=upright(seat.yaw, row.hip_pitch_share * lean),
        spine=bend(row.spine_pitch_share * lean),
        arms=part_way(end.arms, forwards, row.arms_away_share),
        reaching=row.held_share * ready.reaching,
        pressing=row.held_share * ready.pressing,
    )
