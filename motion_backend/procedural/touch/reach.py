"""Bringing a hand onto a surface: the least bent posture that gets there, and the way to it and back.

The numbers are rows of data/transitions/reach.toml.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.inverse_kinematics import two_bone
from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import Bearing, arm_arrays
from motion_backend.procedural.held_poses import UP, bend, shoulders, upright
from motion_backend.procedural.pose import Pose, interpolate, settle_from, smooth
from motion_backend.procedural.pose_solver import chest_frame, released, trunk_and_legs
from motion_backend.procedural.sit.sit_transition import knees_over_feet
from motion_backend.procedural.touch.hand_actions import Way, deed, pulled
from motion_backend.procedural.touch.hand_captions import Laid
from motion_backend.procedural.touch.hand_contacts import is_top
from motion_backend.procedural.touch.hand_placement import Depth, grip_of, lifted_off, placed
from motion_backend.procedural.touch.kneel import down_on_knees, prone
from motion_backend.procedural.touch.reach_keys import (
    Approach,
    ReachEffort,
    ReachGaze,
    ReachingHand,
    ReachSearch,
    ReachTable,
    ReachVariation,
    ThighHand,
)
from motion_backend.procedural.touch.step_in import Step, shifted, step_before, stepped
from motion_backend.procedural.touch.touch_keys import Prone, TouchKeys
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.rotations import Array
from motion_backend.skeleton import ARM_LENGTH, INDEX, Skeleton

TRIES: Final = 8
"""So many postures are drawn by chance, of which the first is taken from which the hands get to their goals."""
BUSY: Final = frozenset({"stir", "pour", "wash", "rotate", "knock"})
"""What is done at a thing for a while."""
LOWERED: Final = 0.1
"""A pelvis that is lower than upright by more than this (metres at 1.70 m) is behind the feet."""
LIFTED = 1e-6
"""A pelvis that rises by less than this (metres) stays on flat feet."""


@dataclass(frozen=True)
class Manner:
    """How something is touched."""

    bearing: Bearing
    hold: float
    """Seconds the hand stays."""
    doing: str = ""
    """What the hand does there, see `hand_captions.Handled`."""
    prone: bool = False
    """Whether one kneels down and bends forwards to it."""
    feet: tuple[int, ...] = (0, 1)
    """Those that may step up to it: 0 left, 1 right."""


def touch(
    start: Pose, laid: Laid, manner: Manner, skeleton: Skeleton, depth: Depth, keys: TouchKeys, rng: np.random.Generator
) -> Pose:
    """Bring a hand from outside onto a surface, keep it there, and come back to standing.

    `depth` says how deep points (N, 3) are in furniture.
    """
    way = way_to(start, laid, manner, skeleton, depth, keys, rng)
    whole = lifted_off(deed(way, keys), way.laid, skeleton)
    return _along(start, whole, manner.prone, keys)


def pull(
    start: Pose,
    ends: tuple[Laid, Laid],
    way: tuple[Array, bool],
    manner: Manner,
    skeleton: Skeleton,
    depth: Depth,
    keys: TouchKeys,
    rng: np.random.Generator,
) -> Pose:
    """Bring a hand onto a handle, take that along a `way` of wrists (N, 3), and back by it or not, and come back to
    standing. `ends` are how it is laid first and last on that way; `depth` as of `touch`."""
    still = replace(manner, feet=())
    first, last = (way_to(start, laid, still, skeleton, depth, keys, rng) for laid in ends)
    return _along(start, pulled(first, last, *way, keys), manner.prone, keys)


def _along(start: Pose, whole: Pose, prone: bool, keys: TouchKeys) -> Pose:
    """Frames of a touch from a pose on: knees over feet, and hands that go along with the body on its way up."""
    row = keys.reach.approach
    whole = replace(whole, knees=whole.knees if prone else knees_over_feet(whole))
    if not prone:
        # A body on its way up takes the hand along before the arm is straight.
        whole = replace(whole, reaching=whole.reaching**row.goes_along_power)
    return settle_from(start, whole, FPS, seconds=row.settle_s)


def way_to(
    start: Pose, laid: Laid, manner: Manner, skeleton: Skeleton, depth: Depth, keys: TouchKeys, rng: np.random.Generator
) -> Way:
    """The poses from outside onto a surface, as `touch` goes through them."""
    row, varied = keys.reach.approach, keys.reach.variation
    yaw, down = float(yaw_of(start.hips)), down_on_knees(start, skeleton, keys.kneel) if manner.prone else []
    tempo = manner.bearing.tempo * float(np.exp(varied.tempo_share * np.clip(rng.normal(), -2.0, 2.0)))
    pace, over = 1 / tempo, row.over_m * float(1 + varied.over_share * np.clip(rng.normal(), -2.0, 2.0))
    step, raised = Step(0, np.zeros(3)), False
    if manner.prone:
        bent = prone(down[-1], laid.wrist, laid.hands[0][0], skeleton, keys.kneel.prone)
        pace *= row.kneeling_ratio
    else:
        raised = float(laid.wrist[1]) > keys.reach.hand.raised_from_m * skeleton.scale
        feet = () if raised else _feet(laid, manner, skeleton, keys.reach)
        step = step_before(start, feet, skeleton, depth, keys.reach.step, rng) if feet else step
        there = shifted(start, step, keys.reach.step)
        bent = _reaching(there, laid, skeleton, depth, keys.reach, manner.doing in BUSY)
        bent = _varied(bent, laid, yaw, skeleton, keys.reach, rng)
        # A hand on a thigh lies where the foot's step has taken it.
        bent = replace(_free_arm(step.taken(bent), laid, manner.doing, skeleton, keys.reach), ankles=bent.ankles)
        bent = _free_hand_varied(bent, laid, keys.reach.variation, rng)
        # A deep bend takes its time, however hurried.
        pace *= max(1.0, float(start.pelvis[1] - bent.pelvis[1]) / (row.deep_m * skeleton.scale))
    # A raised arm is near the end of its range.
    poles = float(not raised) * varied.elbow_ratio * rng.normal(size=(2, 3))
    elbows = _prone_elbows(laid, keys.kneel.prone) if manner.prone else _elbows(laid, skeleton, keys.reach) + poles
    laid = placed(bent, laid, elbows, depth, skeleton, keys.reach.placement)

    def hand(off: float, tilt: float) -> Pose:
        return _hand_at(bent, laid.tilted(tilt), off, yaw, skeleton, keys.reach)

    above, reached = hand(over, 0.0), hand(0.0, 0.0)
    away = replace(start, reach=above.reach, palms=above.palms)
    kneeling = tuple(replace(key, reach=above.reach, palms=above.palms) for key in down)
    lead, looks = _looking_there(away, reached, row, keys.reach.arriving.looks_rad)
    if raised:
        kneeling = (_folded(lead, above, laid, row),)
    step_s = row.folding_s if raised else row.kneeling_step_s
    times = manner.hold, tempo, pace, step_s, manner.doing, max(looks, 1 / FPS)
    grip = partial(grip_of, laid=laid, skeleton=skeleton, row=keys.held.rotate)
    step_in = partial(stepped, step=step, row=keys.reach.step)
    luck = float(rng.normal()) if manner.doing == "strike" else 0.0
    return Way(away, lead, kneeling, hand, laid, *times, grip, step_in, row.goes_along_power, luck)


def _feet(laid: Laid, manner: Manner, skeleton: Skeleton, keys: ReachTable) -> tuple[int, ...]:
    """The feet that may step up to the thing: down low not the one whose knee would be in the hand's way."""
    low = float(laid.wrist[1]) < keys.hand.low_m * skeleton.scale
    return tuple(foot for foot in manner.feet if not (low and foot == laid.hands[0][0]))


def _folded(lead: Pose, above: Pose, laid: Laid, row: Approach) -> Pose:
    """Half-way to a raised hand, which comes up before the body: a straight arm would swing into what is there."""
    arms, elbows = arm_arrays(row.folded, row.folded)
    half = interpolate([-1.0, 1.0], [lead, above], 1).at(0)
    for index in (0, 1):
        if index not in [one for one, *_ in laid.hands]:
            arms[index], elbows[index] = half.arms[index], half.elbows[index]
    return replace(half, arms=arms, elbows=elbows)


def _looking_there(away: Pose, reached: Pose, row: Approach, looks_rad: float) -> tuple[Pose, float]:
    """Standing with the eyes on the thing: they go first, and the body has just begun to bend; and how much of the time
    for it they need. A body whose eyes are almost there has no time to begin in."""
    head = row.eyes_there_share * reached.head + row.eyes_kept_share * away.head
    looks = min(float(np.linalg.norm(head - away.head)) / looks_rad, 1.0)
    # In a squat the hand comes past the knees before they rise.
    share = looks * row.begun_share * max(1 - float(away.pelvis[1] - reached.pelvis[1]) / row.deep_m, 0.0)
    turn = rotations.slerp(away.hips, reached.hips, share)
    lead = replace(
        away,
        head=head,
        pelvis=away.pelvis + share * (reached.pelvis - away.pelvis),
        spine=away.spine + share * (reached.spine - away.spine),
        hips=turn,
    )
    return lead, looks


def arriving(walked: Pose, hand: str, keys: ReachTable) -> Pose:
    """The frames (T,) of a walk up to a thing with the hand on its way: what `touch` goes on from without a pause."""
    row, index = keys.arriving, 0 if hand == "left" else 1
    left = (len(walked) - np.arange(1, len(walked) + 1)) / FPS
    share = row.hand_share * smooth(1 - left / row.hand_s)[:, None]
    wrists, poles = arm_arrays(row.hand, row.hand)
    arms, elbows = walked.arms.copy(), walked.elbows.copy()
    arms[:, index] += share * (wrists[index] - arms[:, index])
    elbows[:, index] += share * (poles[index] - elbows[:, index])
    return replace(walked, arms=arms, elbows=elbows)


def _varied(bent: Pose, laid: Laid, yaw: float, skeleton: Skeleton, keys: ReachTable, rng: np.random.Generator) -> Pose:
    """The posture as it is this time, from which the hands still get there: nobody bends twice in the same way."""
    row = keys.variation
    deep = float(bent.pelvis[1]) < keys.free_arm.low_share * skeleton.standing_height
    size = row.deep_share if deep else 1.0
    turned = rotations.rotate(rotations.yaw_to_quat(yaw), np.array([1.0, 0.0, 1.0]) * rng.normal(size=(TRIES, 3)))
    tries = replace(
        bent.repeat(TRIES),
        pelvis=bent.pelvis + size * row.pelvis_m * skeleton.scale * turned,
        spine=bent.spine + size * row.spine_rad * rng.normal(size=(TRIES, 3)),
        head=bent.head + size * row.head_rad * rng.normal(size=(TRIES, 3)),
    )
    miss = _misses(tries, laid, skeleton, lambda points: np.full(len(points), -np.inf), keys.search)
    within = np.flatnonzero(miss <= row.misses_m)
    return tries.at(int(within[0])) if len(within) else bent


def _free_hand_varied(bent: Pose, laid: Laid, row: ReachVariation, rng: np.random.Generator) -> Pose:
    """The other hand held a little elsewhere."""
    aside = row.wrist_arms * rng.normal(size=(2, 3))
    aside[[index for index, *_ in laid.hands]] = 0.0
    return replace(bent, arms=bent.arms + aside)


def _free_arm(bent: Pose, laid: Laid, doing: str, skeleton: Skeleton, keys: ReachTable) -> Pose:
    """The other hand lives: it steadies itself on a thigh, balances a high reach, or waits before the body."""
    if laid.other is not None:
        return bent
    row, index = keys.free_arm, 1 - laid.hands[0][0]
    tilt = float(rotations.rotate(chest_frame(bent.repeat(1), skeleton)[0][0], UP)[1])
    if float(bent.pelvis[1]) < row.low_share * skeleton.standing_height or tilt < row.bent_over_cos:
        return _hand_on_thigh(bent, index, skeleton, keys.thigh)
    name = row.high if float(laid.wrist[1]) > row.high_m * skeleton.scale else row.doing[doing]
    wrists, poles = arm_arrays(name, name)
    arms, elbows = bent.arms.copy(), bent.elbows.copy()
    arms[index], elbows[index] = wrists[index], poles[index]
    return replace(bent, arms=arms, elbows=elbows)


def _hand_on_thigh(bent: Pose, index: int, skeleton: Skeleton, row: ThighHand) -> Pose:
    """A hand (0 left, 1 right) laid on the thigh of its side, fingers towards the knee."""
    side = ("left", "right")[index]
    hip = bent.pelvis + rotations.rotate(bent.hips, skeleton.offsets[INDEX[f"{side}_hip"]])
    lengths = (-float(skeleton.offsets[INDEX[f"{side}_knee"], 1]), -float(skeleton.offsets[INDEX[f"{side}_ankle"], 1]))
    along = two_bone(hip, bent.ankles[index], bent.knees[index], lengths).upper
    out = rotations.normalize(UP - (UP @ along) * along)
    reach, reaching = bent.reach.copy(), np.zeros(2)
    reach[index] = hip + row.along_share * lengths[0] * along + row.over_m * skeleton.scale * out
    reaching[index] = 1.0
    palms, elbows = bent.palms.copy(), bent.elbows.copy()
    x = along if index == 0 else -along
    elbows[index] = row.elbow.of(index)
    palms[index] = rotations.basis_to_quat(x, out, rotations.cross(x, out))
    return replace(bent, reach=reach, reaching=reaching, palms=palms, elbows=elbows, pressing=reaching.copy())


def _hand_at(bent: Pose, laid: Laid, off: float, yaw: float, skeleton: Skeleton, keys: ReachTable) -> Pose:
    """A bent posture with the hands on the surface, or `off` metres out from it."""
    row = keys.hand
    reaching, pressing = bent.reaching.copy(), bent.pressing.copy()
    reach, palms, elbows = bent.reach.copy(), bent.palms.copy(), bent.elbows.copy()
    # Onto a top the hand comes over its edge from the body's side.
    behind = row.behind_share + row.behind_raised_share * _raised(laid, skeleton, row)
    back = off * laid.normal[1] * behind * np.array([np.sin(yaw), 0.0, np.cos(yaw)])
    for index, wrist, palm in laid.hands:
        reaching[index], reach[index], palms[index] = 1.0, wrist + off * laid.normal - back, palm
        pressing[index] = 1.0 if off == 0.0 else row.pressing_share
        elbows[index] = laid.elbows[index]
    posed = replace(bent, reach=reach, reaching=reaching, palms=palms, pressing=pressing, elbows=elbows)
    # The same place held from the chest, so that the arm swings there round its shoulder.
    return replace(posed, arms=released(posed, skeleton).arms)


def _raised(laid: Laid, skeleton: Skeleton, row: ReachingHand) -> float:
    """How far a hand is raised, 0 to 1."""
    return float(np.clip((laid.wrist[1] / skeleton.scale - row.raised_from_m) / row.raised_within_m, 0.0, 1.0))


def _elbows(laid: Laid, skeleton: Skeleton, keys: ReachTable) -> Array:
    """Where elbows point by themselves: below a raised hand and before a front, else behind. (2, 3)."""
    poles, raised = keys.elbow, _raised(laid, skeleton, keys.hand)
    if is_top(laid.normal) and raised > 0:
        return np.stack([poles.over_edge.of(index) for index in (0, 1)])
    if laid.wrist[1] < keys.hand.low_m * skeleton.scale:
        return np.stack([poles.low.of(index) for index in (0, 1)])
    # The hand on its way to a front is close before the body: an elbow behind would take the forearm through it.
    hangs = raised if is_top(laid.normal) else 1.0
    return np.stack([poles.behind.of(index) + hangs * poles.raised_by.of(index) for index in (0, 1)])


def _prone_elbows(laid: Laid, row: Prone) -> Array:
    """The same of who is prone: out to their sides, and below a hand on a front. (2, 3)."""
    pole = row.top_elbow if is_top(laid.normal) else row.front_elbow
    return np.stack([pole.of(index) for index in (0, 1)])


def _reaching(start: Pose, laid: Laid, skeleton: Skeleton, depth: Depth, keys: ReachTable, busy: bool) -> Pose:
    """The least bent posture from which the hands get to their goals: a search over lean and crouch."""
    row, yaw = keys.search, float(yaw_of(start.hips))
    leans = np.radians(np.arange(0, row.lean_below_deg, row.lean_step_deg))
    crouches = np.arange(-row.rise_max_m, row.crouch_below_m, row.crouch_step_m)
    lean, crouch = (grid.reshape(-1, 1) for grid in np.meshgrid(leans, crouches))
    crouch = crouch * skeleton.scale
    ahead = np.array([np.sin(yaw), 0.0, np.cos(yaw)])
    turn = 0.0 if laid.other is not None else row.turn_rad if laid.hand == "right" else -row.turn_rad
    back = row.back_lean_m * np.sin(lean) + row.back_crouch_share * crouch
    bent, turned = row.spine_share * lean + row.spine_rad, turn * np.minimum(lean / row.turn_within_rad, 1.0)
    tries = replace(
        start.repeat(len(lean)),
        pelvis=start.pelvis - crouch * UP - back * ahead,
        hips=upright(yaw, row.hips_share * lean[:, 0]),
        spine=np.concatenate([bent, turned, 0 * lean], axis=1),
    )
    miss = _misses(tries, laid, skeleton, depth, row)
    row_of_effort = keys.effort if not busy else replace(keys.effort, lean_per_rad2=keys.effort.busy_lean_per_rad2)
    effort = _effort(miss, (lean[:, 0], crouch[:, 0]), laid, skeleton, row_of_effort)
    chosen = int(np.argmin(effort))
    best = _on_toes(tries.at(chosen), -float(crouch[chosen, 0]), skeleton, keys.approach)
    return replace(best, head=_looking(best, laid.wrist, float(lean[chosen, 0]), yaw, skeleton, keys.gaze))


def _misses(tries: Pose, laid: Laid, skeleton: Skeleton, depth: Depth, row: ReachSearch) -> Array:
    """How far hands are from their goals in T postures, and heads and knees in what is touched. (T,) metres."""
    arm = ARM_LENGTH * skeleton.scale
    miss = np.zeros(len(tries))
    for index, wrist, _ in laid.hands:
        way = wrist - shoulders(tries, skeleton)[:, index]
        gap = np.linalg.norm(way, axis=1)
        # A shoulder comes up with its arm.
        longest = (row.arm_max_share + row.arm_raised_share * np.clip(way[:, 1] / arm, 0.0, 1.0) ** 2) * arm
        miss = miss + np.maximum(gap - longest, 0.0) + np.maximum(row.arm_min_share * arm - gap, 0.0)
    # The head stays clear of what is touched: before a front one bends the knees instead.
    chest, place = chest_frame(tries, skeleton)
    head = place + rotations.rotate(chest, np.array([0.0, row.head_up_m, row.head_ahead_m]) * skeleton.scale)
    miss = miss + np.maximum(depth(head) + row.head_room_m, 0.0)
    joints, _ = skeleton.forward_kinematics(tries.pelvis, trunk_and_legs(tries, skeleton))
    for name in ("left_knee", "right_knee"):
        miss = miss + np.maximum(depth(joints[:, INDEX[name]].astype(np.float64)) + row.knee_room_m, 0.0)
    lower = np.maximum(tries.pelvis[:, 1].max() - tries.pelvis[:, 1], 0.0) > LOWERED * skeleton.scale
    back = tries.pelvis - row.behind_m * skeleton.scale * rotations.rotate(tries.hips, np.array([0.0, 0.0, 1.0]))
    miss = miss + lower * np.maximum(depth(back) + row.behind_room_m * skeleton.scale, 0.0)
    return np.asarray(miss)


def _effort(miss: Array, bent: tuple[Array, Array], laid: Laid, skeleton: Skeleton, row: ReachEffort) -> Array:
    """What postures cost that miss by so much, `bent` by leans (radians) and crouches (metres): one bends over to a
    table and squats to a drawer. (T,) each."""
    (lean, crouch), height = bent, float(laid.wrist[1])
    higher = float(np.clip((height / skeleton.scale - row.squat_below_m) / row.squat_within_m, 0.0, 1.0))
    squat = row.crouch_per_m + row.crouch_more_per_m * higher
    top = is_top(laid.normal) and row.top_above_m < height / skeleton.scale < row.top_below_m
    squat = max(squat, row.crouch_top_per_m) if top else squat
    effort = row.miss_per_m * miss + row.lean_per_rad * lean + row.lean_per_rad2 * lean**2
    # One rises on tiptoes only for what is out of reach otherwise, or overhead.
    above = float(np.clip((height / skeleton.scale - row.stretch_from_m) / row.stretch_within_m, 0.0, 1.0))
    rise = np.abs(crouch + above * row.stretch_m * skeleton.scale)
    tiptoe = np.where(crouch < -LIFTED, (1 - above) * row.tiptoe + row.tiptoe_per_m * rise, squat * rise)
    tiptoe = tiptoe + top * row.crouch_top_per_m2 * np.maximum(crouch, 0.0) ** 2
    return np.asarray(effort + tiptoe)


def _looking(pose: Pose, goal: Array, lean: float, yaw: float, skeleton: Skeleton, row: ReachGaze) -> Array:
    """The head of a body that leans so far (radians), its eyes on the goal. (3,)."""
    eyes = shoulders(pose.repeat(1), skeleton)[0].mean(axis=0) + row.eyes_up_m * UP
    look = goal - eyes
    down = np.arctan2(-look[1], np.hypot(look[0], look[2]))
    sideways = float(rotations.wrap(np.arctan2(look[0], look[2]) - yaw))
    nod = float(np.clip(down - row.leant_share * lean, row.nod_min_rad, row.nod_max_rad))
    return bend(nod, turn=float(np.clip(sideways, -row.turn_max_rad, row.turn_max_rad)))


def _on_toes(pose: Pose, rise: float, skeleton: Skeleton, way: Approach) -> Pose:
    """Heels lifted so that the ankles rise by so much (metres) about the balls of the feet; as it is from 0 down."""
    if rise < LIFTED:
        return pose
    ball = skeleton.offsets[INDEX["left_foot"]]
    angle = way.tiptoe_ratio * float(np.arcsin(min(rise / ball[2], way.tiptoe_max_share)))
    feet = rotations.compose(pose.feet, rotations.rotvec_to_quat(np.array([angle, 0.0, 0.0])))
    ankles = pose.ankles + rotations.rotate(pose.feet, ball) - rotations.rotate(feet, ball)
    return replace(pose, feet=feet, ankles=ankles, toes=np.full(2, angle))
