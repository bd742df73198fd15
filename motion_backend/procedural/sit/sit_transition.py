"""Sitting down and standing up, as key poses with planted feet between them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.collision_avoidance.body_collision import arms_inside, hands_round_body
from motion_backend.procedural.emotion_style import Bearing, arm_arrays
from motion_backend.procedural.held_poses import UP, Seat, bend, standing, upright
from motion_backend.procedural.pose import Pose, concatenate, interpolate, smooth
from motion_backend.procedural.pose_solver import released
from motion_backend.procedural.sit.sit_pose import Place, seated
from motion_backend.procedural.sit.sit_styles import Manner, Seated
from motion_backend.procedural.touch.hand_rests import Holds, at_rest, follow
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton

ARM = 0.54
"""Shoulder to wrist at the reference height (metres)."""
NOTHING: Holds = (None, None)
AROUND, ROUND, OVER_KNEES = 0.4, 0.16, 0.5
"""How far hands come out on their way down to the seat, up from it, and over knees that are up (arm lengths)."""
BEGINS = 7
"""Frames in which arms come in where there is little room beside a seat."""
OVER = 0.14
"""How much higher than half-way a foot goes at most that is laid over the other leg (metres)."""
STEP = 1.8
"""Seconds a foot takes for a metre, where that is longer than a small step."""
SINK = 0.014
"""How deep one who plumps down sinks into the seat before it gives back (metres)."""


def sit_down(start: Pose, place: Place, style: Seated, felt: Holds, skeleton: Skeleton) -> tuple[Pose, Holds]:
    """From standing with the back to a seat: look, hips back, lower, touch down, settle; then the way of sitting.

    `felt` is what the hands feel for on the way down. Returned with it is what they lie on in the end.
    """
    pace = 1 / style.bearing.tempo
    ready = _looking_back(start, style.manner, pace)
    before = start if ready is None else ready.at(len(ready) - 1)
    down = lower_onto(before, place.seat, style.bearing, skeleton, style.manner, felt)
    landed = down.at(len(down) - 1)
    settle = _settling(landed, place.seat, style, pace)
    touched = settle.at(len(settle) - 1)
    landed = released(touched, skeleton)
    settled, holds = seated(landed, place, style, skeleton)
    travel = float(np.linalg.norm(settled.arms - landed.arms, axis=1).max()) * ARM * skeleton.scale
    keys = [landed, replace(settled, ankles=landed.ankles, feet=landed.feet)]
    moved = interpolate([0.0, max(0.75, 1.1 * travel) * pace], keys, FPS)
    moved = follow(_place_feet(moved, landed, settled, first=0.15, each=0.42), settled, holds, skeleton)
    moved = _taken(moved, landed, holds)
    moved = _round_the_thighs(moved, touched.reaching, place.seat.is_low(skeleton.scale))
    share = smooth(np.arange(len(moved)) / BEGINS)
    moved = arms_inside(moved, place.seat, place.elbows, skeleton, share)
    whole = concatenate([part for part in (ready, down, settle, moved) if part is not None])
    return hands_round_body(whole, skeleton), holds


def _round_the_thighs(moved: Pose, hands: Array, low: bool) -> Pose:
    """Hands on their way between lap and seat come out and up; `hands` (2,) says whether they go there.

    On a low seat knees are up, and both hands go over them.
    """
    size = OVER_KNEES if low else ROUND * hands[:, None]
    out = size * np.sin(np.pi * smooth(np.linspace(0.0, 1.0, len(moved))))[:, None, None]
    return replace(moved, arms=moved.arms + out * np.array([[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]))


def _taken(moved: Pose, start: Pose, holds: Holds) -> Pose:
    """Hands that leave what they held and turn to what they go to; late on the way they hold on to it."""
    share = np.linspace(0.0, 1.0, len(moved))
    turned, late = smooth(share)[:, None], smooth((share - 0.35) / 0.65)[:, None]
    wanted = np.array([0.0 if hold is None else 1.0 for hold in holds])
    return replace(
        moved,
        palms=rotations.slerp(start.palms[None], moved.palms, turned),
        reaching=late * wanted,
        pressing=(1 - smooth(share / 0.3)[:, None]) * start.pressing + late * wanted,
    )


def _looking_back(start: Pose, manner: Manner, pace: float) -> Pose | None:
    """A look over the shoulder at the seat; None for who does not look."""
    if manner.glance < 0.2:
        return None
    turned = replace(
        start,
        head=start.head + bend(0.18 * manner.glance, -0.75 * manner.glance),
        spine=start.spine + bend(0.06, -0.20 * manner.glance),
    )
    return interpolate([0.0, 0.55 * pace], [start, turned], FPS)


def lower_onto(
    start: Pose,
    seat: Seat,
    bearing: Bearing,
    skeleton: Skeleton,
    manner: Manner | None = None,
    felt: Holds = NOTHING,
) -> Pose:
    """Standing to first contact with the seat, a hand or two feeling for it."""
    pace, scale = 1 / bearing.tempo, skeleton.scale
    depth = float(np.clip((start.pelvis[1] - seat.pelvis[1]) / (0.4 * scale), 0.6, 2.0))
    drop, back = seat.pelvis[1] - start.pelvis[1], seat.pelvis - start.pelvis
    aside = (manner.sway if manner else 0.0) * rotations.rotate(rotations.yaw_to_quat(seat.yaw), np.array([1.0, 0, 0]))
    # Whatever the arms were doing, they come forward for balance.
    arms, elbows = arm_arrays("hang", "hang")
    arms = arms * [1.0, 0.86, 1.0] + [0.0, 0.0, 0.35]
    forward = 0.30 + 0.16 * depth
    # Hips that fold no further let the back do it, and arms go round the knees.
    tucked = 0.45 if seat.is_low(scale) else 0.0
    arms = arms + (tucked > 0) * np.array([[0.35, 0.1, 0.0], [-0.35, 0.1, 0.0]])
    hinge = replace(
        start,
        pelvis=start.pelvis + back * [0.42, 0.0, 0.42] + [0, 0.22 * drop, 0] + aside,
        hips=upright(seat.yaw, 0.55 * forward),
        spine=bend(0.5 * forward),
        head=bend(0.1),
        arms=0.5 * (start.arms + arms),
        elbows=elbows,
        reaching=np.zeros(2),
        pressing=np.zeros(2),
    )
    low = replace(
        hinge,
        pelvis=start.pelvis + back * [0.86, 0.0, 0.86] + [0, 0.74 * drop, 0] - 0.5 * aside,
        hips=upright(seat.yaw, (0.75 - tucked) * forward),
        spine=bend((0.75 + 0.6 * tucked) * forward),
        arms=arms,
    )
    contact = replace(
        low,
        pelvis=seat.pelvis,
        hips=upright(seat.yaw, (0.45 - 1.6 * tucked) * forward),
        spine=bend((0.55 + 0.9 * tucked) * forward),
    )
    contact = at_rest(contact, felt, skeleton)
    hinge, low = _feeling(hinge, contact), _feeling(low, contact)
    low = replace(low, arms=at_rest(low, felt, skeleton).arms, reaching=0.7 * contact.reaching)
    seconds = 1.35 * pace * (0.7 + 0.3 * depth)
    down = interpolate([0.0, 0.42 * seconds, 0.8 * seconds, seconds], [start, hinge, low, contact], FPS)
    return replace(down, knees=knees_over_feet(down))


def _feeling(pose: Pose, contact: Pose) -> Pose:
    """Hands that will hold on come out to the side on their way round the thighs."""
    outwards = AROUND * contact.reaching[:, None] * np.array([[1.0, 0.0, -0.5], [-1.0, 0.0, -0.5]])
    return replace(pose, arms=pose.arms + outwards, reach=contact.reach, palms=contact.palms)


def _settling(landed: Pose, seat: Seat, style: Seated, pace: float) -> Pose:
    """The weight comes down: the seat gives and gives back, the trunk comes up over it."""
    sink = SINK * style.manner.plump
    deep = replace(landed, pelvis=seat.pelvis - sink * UP, head=landed.head + bend(0.12 * style.manner.plump))
    up = replace(deep, pelvis=seat.pelvis + 0.3 * sink * UP, spine=0.75 * landed.spine)
    still = replace(up, pelvis=seat.pelvis, spine=0.6 * landed.spine, head=landed.head)
    return interpolate([0.0, 0.14, 0.30, 0.30 + 0.18 * pace], [landed, deep, up, still], FPS)


def knees_over_feet(pose: Pose) -> Array:
    """Knees point where their feet point, a little up, so that deep bends stay in plane. (T, 2, 3)."""
    forward = rotations.rotate(rotations.yaw_to_quat(yaw_of(pose.feet)), np.array([0.0, 0.0, 1.0]))
    return np.asarray(forward + 0.25 * UP)


def _place_feet(pose: Pose, before: Pose, after: Pose, first: float, each: float) -> Pose:
    """Move the feet one after the other in small lifted steps from where they were to where they go."""
    ankles, feet, planted, knees = pose.ankles.copy(), pose.feet.copy(), pose.planted.copy(), pose.knees.copy()
    time = np.arange(1, len(pose) + 1) / FPS
    # A foot that leaves the floor waits until the other stands.
    wait = 0.5 * each if after.planted.all() else 0.9 * each
    for order, index in enumerate(_first_foot(after)):
        gap = float(np.linalg.norm(after.ankles[index] - before.ankles[index]))
        share = np.clip((time - first - order * wait) / max(each, STEP * gap), 0.0, 1.0)
        way = smooth(share)[:, None]
        ankles[:, index] = before.ankles[index] + way * (after.ankles[index] - before.ankles[index])
        rise = float(after.ankles[index, 1] - before.ankles[index, 1])
        # A foot that goes onto the other knee goes over it.
        ankles[:, index, 1] += max(min(0.08, 0.28 * gap), min(0.6 * rise, OVER)) * np.sin(np.pi * share)
        feet[:, index] = rotations.slerp(before.feet[index], after.feet[index], way[:, 0])
        knees[:, index] = before.knees[index] + way * (after.knees[index] - before.knees[index])
        stands = np.where(share <= 0, before.planted[index], np.where(share >= 1, after.planted[index], 0.0))
        planted[:, index] = stands
    last = {"ankles": ankles, "feet": feet, "planted": planted, "knees": knees}
    far = float(np.linalg.norm(after.ankles - before.ankles, axis=1).max())
    short = max(round((first + wait + max(each, STEP * far)) * FPS) - len(pose), 0)
    if short:
        # The feet take longer than the trunk: hold the trunk until both are placed.
        held = pose.at(slice(len(pose) - 1, len(pose)))
        longer = concatenate([pose, *([held] * short)])
        return _place_feet(longer, before, after, first, each)
    return replace(pose, **last)


def _first_foot(after: Pose) -> tuple[int, int]:
    """Which foot goes first: one that will stand, else one that comes to lie behind the other's shin."""
    away = np.linalg.norm((after.ankles - after.pelvis)[:, [0, 2]], axis=1)
    left = after.planted[0] > after.planted[1] or (not after.planted.any() and away[0] < away[1] - 0.02)
    return (0, 1) if left else (1, 0)


def stand_up(
    start: Pose,
    seat: Seat,
    where: tuple[float, float],
    bearing: Bearing,
    skeleton: Skeleton,
    push: Holds = NOTHING,
) -> Pose:
    """From a seat to standing at [x, z]: feet under, lean forward, push off with the hands, rise over the feet."""
    end = standing(where, seat.yaw, bearing, skeleton)
    under = replace(start, ankles=end.ankles, feet=end.feet, knees=end.knees + 0.25 * UP, planted=np.ones(2))
    pace = 1 / bearing.tempo
    depth = float(np.clip((end.pelvis[1] - seat.pelvis[1]) / (0.4 * skeleton.scale), 0.6, 2.0))
    forward = 0.34 + 0.20 * depth
    folded = 0.55 if seat.is_low(skeleton.scale) else 0.0
    ready = replace(
        under,
        hips=upright(seat.yaw, (0.5 - folded) * forward),
        spine=bend((0.75 + folded) * forward),
        head=bend(0.0),
        pelvis=seat.pelvis,
        toes=np.zeros(2),
        arms=end.arms + np.array([0.0, 0.16, 0.34]),
        elbows=end.elbows,
        reaching=np.zeros(2),
        pressing=np.zeros(2),
    )
    ready = at_rest(ready, push, skeleton)
    # Hands that come down from the head need longer than hands on the lap.
    travel = float(np.linalg.norm(ready.arms - start.arms, axis=1).max()) * ARM * skeleton.scale
    seconds = max(0.62, 1.1 * travel) * pace
    gather = interpolate([0.0, seconds], [start, replace(ready, ankles=start.ankles, feet=start.feet)], FPS)
    gather = follow(_place_feet(gather, start, ready, first=0.0, each=0.36), ready, push, skeleton)
    gather = _round_the_thighs(_taken(gather, start, push), ready.reaching, seat.is_low(skeleton.scale))
    ready = gather.at(len(gather) - 1)
    up = _rising(ready, end, seat, (forward, 1.25 * pace * (0.7 + 0.3 * depth)))
    up = follow(replace(up, knees=knees_over_feet(up)), ready, push, skeleton)
    return hands_round_body(concatenate([gather, up]), skeleton)


def _rising(ready: Pose, end: Pose, seat: Seat, way: tuple[float, float]) -> Pose:
    """From leaning over the feet to standing: how far the trunk leans, and the seconds it takes."""
    forward, seconds = way
    rise, ahead = end.pelvis[1] - seat.pelvis[1], end.pelvis - seat.pelvis
    # Hands that pushed off let go and come forward as the weight goes over the feet.
    forwards = 0.5 * (ready.arms + end.arms + [0.0, 0.12, 0.34])
    lift = replace(
        ready,
        pelvis=seat.pelvis + ahead * [0.45, 0.0, 0.45] + [0, 0.24 * rise, 0],
        hips=upright(seat.yaw, 0.7 * forward),
        spine=bend(0.8 * forward),
        arms=forwards,
        reaching=0.35 * ready.reaching,
        pressing=0.35 * ready.pressing,
    )
    straighten = replace(
        lift,
        pelvis=seat.pelvis + ahead * [0.88, 0.0, 0.88] + [0, 0.78 * rise, 0],
        hips=upright(seat.yaw, 0.3 * forward),
        spine=bend(0.35 * forward),
        reaching=np.zeros(2),
        pressing=np.zeros(2),
        arms=end.arms + 0.5 * (forwards - end.arms),
    )
    end = replace(end, reach=ready.reach, palms=ready.palms)
    return interpolate([0.0, 0.34 * seconds, 0.72 * seconds, seconds], [ready, lift, straighten, end], FPS)
