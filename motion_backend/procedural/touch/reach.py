"""Bringing a hand onto a surface: the least bent posture that gets there, and the way to it and back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from motion_backend import rotations
from motion_backend.inverse_kinematics import two_bone
from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import Bearing, arm_arrays
from motion_backend.procedural.held_poses import UP, bend, shoulders, upright
from motion_backend.procedural.pose import Pose, settle_from
from motion_backend.procedural.pose_solver import chest_frame, released
from motion_backend.procedural.sit.sit_transition import knees_over_feet
from motion_backend.procedural.touch.hand_actions import OVER, Way, deed
from motion_backend.procedural.touch.hand_captions import Laid
from motion_backend.procedural.touch.kneel import down_on_knees, elbows_out, prone
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

Depth = Callable[[Array], Array]


SLOWLY = 1.1
"""Who kneels down takes so much longer."""
KNEELING = 0.5
"""Seconds for each step of getting down on the knees."""
BENT_OVER = 0.82
"""Cosine of the chest's tilt from which the free hand is laid on a thigh."""
LOW, HIGH = 0.72, 1.35
"""Below this share of the standing height a pelvis is low; a hand above this (metres at 1.70 m) is high."""
FREE_ARM = {"pick": "bent", "put": "counter", "rotate": "carry", "press": "hips"}
"""What the other arm does meanwhile."""
ON_THIGH = 0.112
"""A wrist above the middle of the thigh its hand lies on (metres at 1.70 m)."""
DEEP = 0.30
"""Lowering the pelvis by more than this (metres) slows a reach down."""
POINTS_DOWN = 0.4
"""Fingers whose direction has this much of down in it point down."""
HEAD_ROOM = 0.13
"""Distance of the middle of the head to furniture that a reaching body keeps (metres)."""


@dataclass(frozen=True)
class Manner:
    """How something is touched."""

    bearing: Bearing
    hold: float
    """Seconds the hand stays."""
    doing: str = ""
    """What the hand does there, a word of `handling.HANDLINGS`, "" for a plain touch."""
    prone: bool = False
    """Whether one kneels down and bends forwards to it."""


def touch(start: Pose, laid: Laid, manner: Manner, skeleton: Skeleton, depth: Depth) -> Pose:
    """Bring a hand from outside onto a surface, keep it there, and come back to standing.

    `depth` says how deep points (N, 3) are in furniture.
    """
    pace = 1 / manner.bearing.tempo
    down = down_on_knees(start, skeleton) if manner.prone else []
    if manner.prone:
        bent = prone(down[-1], laid.wrist, laid.hands[0][0], skeleton)
        pace *= SLOWLY
    else:
        bent = _free_arm(_reaching(start, laid, skeleton, depth), laid, manner.doing, skeleton)
        # A deep bend takes its time, however hurried.
        pace *= max(1.0, float(start.pelvis[1] - bent.pelvis[1]) / (DEEP * skeleton.scale))

    def hand(off: float, tilt: float) -> Pose:
        posed = _hand_at(start, bent, laid.tilted(tilt), off, skeleton)
        return elbows_out(posed, laid) if manner.prone else posed

    over, reached = hand(OVER, 0.0), hand(0.0, 0.0)
    away = replace(start, reach=over.reach, palms=over.palms)
    # The eyes go first.
    lead = replace(away, head=0.85 * reached.head + 0.15 * start.head)
    kneeling = tuple(replace(key, reach=over.reach, palms=over.palms) for key in down)
    whole = deed(Way(away, lead, kneeling, hand, laid, manner.hold, manner.bearing.tempo, pace, KNEELING), manner.doing)
    knees = whole.knees if manner.prone else knees_over_feet(whole)
    return settle_from(start, replace(whole, knees=knees), FPS, seconds=0.3)


def _free_arm(bent: Pose, laid: Laid, doing: str, skeleton: Skeleton) -> Pose:
    """The other hand lives: it steadies itself on a thigh, balances a high reach, or waits before the body."""
    if laid.other is not None:
        return bent
    index = 1 - laid.hands[0][0]
    tilt = float(rotations.rotate(chest_frame(bent.repeat(1), skeleton)[0][0], UP)[1])
    if float(bent.pelvis[1]) < LOW * skeleton.standing_height or tilt < BENT_OVER:
        return _hand_on_thigh(bent, index, skeleton)
    high = float(laid.wrist[1]) > HIGH * skeleton.scale
    name = "counter" if high else FREE_ARM.get(doing, "beside")
    wrists, poles = arm_arrays(name, name)
    arms, elbows = bent.arms.copy(), bent.elbows.copy()
    arms[index], elbows[index] = wrists[index], poles[index]
    return replace(bent, arms=arms, elbows=elbows)


def _hand_on_thigh(bent: Pose, index: int, skeleton: Skeleton) -> Pose:
    """A hand (0 left, 1 right) laid on the thigh of its side, fingers towards the knee."""
    side = ("left", "right")[index]
    hip = bent.pelvis + rotations.rotate(bent.hips, skeleton.offsets[INDEX[f"{side}_hip"]])
    lengths = (-float(skeleton.offsets[INDEX[f"{side}_knee"], 1]), -float(skeleton.offsets[INDEX[f"{side}_ankle"], 1]))
    along = two_bone(hip, bent.ankles[index], bent.knees[index], lengths).upper
    out = rotations.normalize(UP - (UP @ along) * along)
    reach, reaching = bent.reach.copy(), np.zeros(2)
    reach[index], reaching[index] = hip + 0.78 * lengths[0] * along + ON_THIGH * skeleton.scale * out, 1.0
    palms, elbows = bent.palms.copy(), bent.elbows.copy()
    x = along if index == 0 else -along
    elbows[index] = np.array([1.0 if index == 0 else -1.0, -0.2, -0.4])
    palms[index] = rotations.basis_to_quat(x, out, rotations.cross(x, out))
    return replace(bent, reach=reach, reaching=reaching, palms=palms, elbows=elbows, pressing=reaching.copy())


def _hand_at(start: Pose, bent: Pose, laid: Laid, off: float, skeleton: Skeleton) -> Pose:
    """A bent posture with the hands on the surface, or `off` metres out from it."""
    reaching, pressing = bent.reaching.copy(), bent.pressing.copy()
    reach, palms, elbows = bent.reach.copy(), bent.palms.copy(), bent.elbows.copy()
    yaw = float(yaw_of(start.hips))
    # A raised hand hangs its elbow below, a lowered one keeps it behind; over the edge of a top it is lifted aside.
    high = float(np.clip((laid.wrist[1] / skeleton.scale - 1.2) / 0.25, 0.0, 1.0))
    # Onto a top the hand comes over its edge from the body's side.
    back = off * laid.normal[1] * (0.3 + 0.9 * high) * np.array([np.sin(yaw), 0.0, np.cos(yaw)])
    for index, wrist, palm in laid.hands:
        side = 1.0 if index == 0 else -1.0
        reaching[index], reach[index], palms[index] = 1.0, wrist + off * laid.normal - back, palm
        pressing[index] = 1.0 if off == 0.0 else 0.6
        elbows[index] = np.array([0.45 * side, -0.25 - 0.75 * high, -1.0 + 0.75 * high])
        if wrist[1] < 0.7 * skeleton.scale:
            # Down low it goes outwards: behind is the thigh.
            elbows[index] = np.array([1.0 * side, -0.1, -0.3])
        if float(rotations.rotate(palm, np.array([side, 0.0, 0.0]))[1]) < -POINTS_DOWN:
            # The palm of a hand that points down a front looks forwards only with the elbow below.
            elbows[index] = np.array([0.3 * side, -1.0, -0.4])
        if laid.normal[1] > 0.7 and high > 0:
            elbows[index] = np.array([1.0 * side, 0.25, -0.3])
    posed = replace(bent, reach=reach, reaching=reaching, palms=palms, pressing=pressing, elbows=elbows)
    # The same place held from the chest, so that the arm swings there round its shoulder.
    return replace(posed, arms=released(posed, skeleton).arms)


def _reaching(start: Pose, laid: Laid, skeleton: Skeleton, depth: Depth) -> Pose:
    """The least bent posture from which the hands get to their goals: a search over lean and crouch."""
    goal = laid.wrist
    yaw = float(yaw_of(start.hips))
    lean, crouch = (grid.ravel() for grid in np.meshgrid(np.radians(np.arange(0, 76, 5)), np.arange(-0.06, 0.50, 0.03)))
    lean, crouch = lean[:, None], crouch[:, None] * skeleton.scale
    ahead = np.array([np.sin(yaw), 0.0, np.cos(yaw)])
    tries = start.repeat(len(lean))
    turn = 0.0 if laid.other is not None else 0.22 if laid.hand == "right" else -0.22
    back = 0.06 * np.sin(lean) + 0.25 * crouch
    tries = replace(
        tries,
        pelvis=start.pelvis - crouch * UP - back * ahead,
        hips=upright(yaw, 0.45 * lean[:, 0]),
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
    effort = 60.0 * miss + 0.6 * lean[:, 0] + 1.1 * lean[:, 0] ** 2
    # One rises on tiptoes only for what is out of reach otherwise.
    effort += np.where(crouch[:, 0] < -1e-6, 0.5 - 4.0 * crouch[:, 0], squat * crouch[:, 0])
    chosen = int(np.argmin(effort))
    best = _on_toes(tries.at(chosen), -float(crouch[chosen, 0]), skeleton)
    eyes = shoulders(best.repeat(1), skeleton)[0].mean(axis=0) + 0.2 * UP
    look = goal - eyes
    down = np.arctan2(-look[1], np.hypot(look[0], look[2]))
    sideways = float(rotations.wrap(np.arctan2(look[0], look[2]) - yaw))
    nod = float(np.clip(down - 0.7 * lean[chosen, 0], -0.5, 0.6))
    return replace(best, head=bend(nod, turn=float(np.clip(sideways, -0.6, 0.6))))


def _on_toes(pose: Pose, rise: float, skeleton: Skeleton) -> Pose:
    """Heels lifted so that the ankles rise by so much (metres) about the balls of the feet; as it is from 0 down."""
    if rise < 1e-6:
        return pose
    ball = skeleton.offsets[INDEX["left_foot"]]
    angle = 1.15 * float(np.arcsin(min(rise / ball[2], 0.8)))
    feet = rotations.compose(pose.feet, rotations.rotvec_to_quat(np.array([angle, 0.0, 0.0])))
    ankles = pose.ankles + rotations.rotate(pose.feet, ball) - rotations.rotate(feet, ball)
    return replace(pose, feet=feet, ankles=ankles, toes=np.full(2, angle))
