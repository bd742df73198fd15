"""Down onto the floor to lie there and up from it, as people go: one knee, both, hands and knees, a side."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.body.capsules import SOLE
from motion_backend.inverse_kinematics import two_bone
from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import Bearing, arm_arrays
from motion_backend.procedural.held_poses import UP, bend, both_sides, standing, upright
from motion_backend.procedural.lie.lie_keys import (
    BothKnees,
    HandsAndKnees,
    LieKeys,
    LieOnFloor,
    LiePose,
    OneKnee,
    OnHip,
    OverOneKnee,
    Pushing,
    RiseFromFloor,
    SatBack,
    Step,
    Stood,
)
from motion_backend.procedural.lie.lie_legs import HIP, SHANK, THIGH
from motion_backend.procedural.lie.lie_pose import Bed, lying
from motion_backend.procedural.lie.lie_styles import Lying
from motion_backend.procedural.lie.lie_transition import freed
from motion_backend.procedural.pose import Pose, concatenate, interpolate, smooth
from motion_backend.procedural.touch.hand_contacts import palm_on
from motion_backend.rotations import Array
from motion_backend.skeleton import HAND_REST, Skeleton

KNEE: Final = 0.06
"""Height of a knee that is knelt on (metres at 1.70 m)."""
ANKLE, ON_TOES, CURLED = 0.165, 1.30, 1.20
"""A foot on its toes behind a knee: height of the ankle (metres at 1.70 m), tilt and bend of the toes (radians)."""
AHEAD: Final = 0.27
"""How far before the knees the other foot is put to stand up (metres at 1.70 m)."""
LIFT, ROUND, TAKEOFF, STARTS = (0.16, 0.10), (0.0, 0.12), 0.30, 0.18
"""How high the left and the right foot are lifted, how far they go round (metres at 1.70 m); in which share of a step,
and after which share a foot moves on.

The right one goes past the knee that is down.
"""
TURNED: Final = 0.85
"""In which share of its step a foot turns, while it is nearer to the toes it stands on behind."""
KNEES_DOWN, KNEES_OUT = 0.34, 0.30
"""From where the pelvis will lie to the middle of the knees: towards the feet, and out (metres at 1.70 m)."""
LANDS: Final = 0.2
"""So many seconds before a foot is down the weight begins to leave the knee, or the foot, that carries it."""
ON_THIGH, OVER_THIGH, FINGERS_IN = 0.25, 0.120, 0.5
"""A wrist on its thigh: from the hip along it, over its middle (metres at 1.70 m), fingers turned in (radians)."""
OVER_FLOOR, MOVES, COMES_UP = 0.065, 0.15, 4
"""How high over the floor soles are (metres at 1.70 m) of feet that move as fast as that (m/s), and in how many frames
they come up and go down."""
ON_SIDE: Final = Lying(side="left", legs="gathered", arms=("tucked", "before"))
"""How one comes onto the floor, and leaves it: with the left side down."""


@dataclass(frozen=True)
class Mat:
    """A place on the floor to lie on, and where knees, hands and feet go beside it; it is left over the left side."""

    bed: Bed
    skeleton: Skeleton

    @cached_property
    def up(self) -> Array:
        """Towards the head. (3,)."""
        return np.array([np.sin(self.bed.head_yaw), 0.0, np.cos(self.bed.head_yaw)])

    @cached_property
    def out(self) -> Array:
        """Where one looks who lies on the left side. (3,)."""
        return np.cross(self.up, UP)

    @cached_property
    def knees(self) -> Array:
        """Where the left and the right knee are knelt on. (2, 3)."""
        scale = self.skeleton.scale
        # A body that looks to its head's end with its back up has its left where one on the back has the right.
        ways = np.array([[-HIP], [HIP]]) * scale * self.out
        middle = self.bed.pelvis + scale * (-KNEES_DOWN * self.up + KNEES_OUT * self.out)
        middle[1] = KNEE * scale
        return np.asarray(middle + ways)

    @cached_property
    def ankles(self) -> Array:
        """Where ankles are behind the knees, on curled toes. (2, 3)."""
        scale = self.skeleton.scale
        back = float(np.sqrt(SHANK**2 - (ANKLE - KNEE) ** 2))
        return np.asarray(self.knees + scale * ((ANKLE - KNEE) * UP - back * self.up))

    def over_knees(self, aside: float, back: float) -> Array:
        """The pelvis on both knees, so far to the left and so far towards the heels (metres at 1.70 m). (3,)."""
        height = float(np.sqrt(THIGH**2 - aside**2 - back**2))
        return np.asarray(
            self.knees.mean(axis=0) + self.skeleton.scale * (height * UP - back * self.up - aside * self.out)
        )

    @property
    def standing_point(self) -> tuple[float, float]:
        """[x, z] of the pelvis standing before and after."""
        x, _, z = self.knees.mean(axis=0) + AHEAD * self.skeleton.scale * self.up
        return float(x), float(z)


def kneel_down(start: Pose, mat: Mat, bearing: Bearing, keys: LieOnFloor) -> Pose:
    """From standing to both knees: the left foot steps back and that knee goes down, then the other."""
    pace, (one, over, two, *_) = 1 / bearing.tempo, keys.pose
    both = _on_both_knees(two, start, mat)
    half = _on_one_knee(one, start, both, mat)
    left = _over_one_knee(over, half, mat)
    *begun, knelt = _times(keys.pose[:3], pace)
    lands = _seconds(keys.right_step, pace)[1] - LANDS * pace
    down = interpolate([*begun, lands, knelt], [start, half, left, left, both], FPS)
    down = _step(down, 0, _seconds(keys.left_step, pace), half, mat)
    return _step(down, 1, _seconds(keys.right_step, pace), both, mat)


def kneel_up(knelt: Pose, mat: Mat, bearing: Bearing, keys: RiseFromFloor) -> Pose:
    """From both knees to standing: the right foot is put forward, the left one follows as the body rises."""
    pace, (*_, over, one, push, stood) = 1 / bearing.tempo, keys.pose
    end = standing(mat.standing_point, mat.bed.head_yaw, bearing, mat.skeleton)
    half = _on_one_knee(one, end, knelt, mat)
    pushing = _pushing(push, half, mat)
    left, end = replace(_over_one_knee(over, knelt, mat), reach=half.reach), replace(end, reach=pushing.reach)
    begun, lifted, risen, pushed, ends = _times((over, one, push, stood), pace)
    lands, both = (_seconds(step, pace)[1] - LANDS * pace for step in (keys.right_step, keys.left_step))
    left, end = _bound_for(half, left), _bound_for(pushing, end)
    landing = replace(left, knees=np.stack([left.knees[0], half.knees[1]]))
    over_right = replace(end, pelvis=end.pelvis + mat.skeleton.scale * (stood.aside_m * mat.out - stood.down_m * UP))
    poses = [_bound_for(half, knelt), left, landing, half, pushing, over_right, end]
    up = interpolate([begun, lifted, lands, risen, pushed, both, ends], poses, FPS)
    up = _step(up, 1, _seconds(keys.right_step, pace), half, mat)
    return _step(up, 0, _seconds(keys.left_step, pace), end, mat)


def _bound_for(bearing: Pose, pose: Pose) -> Pose:
    """The same pose with hands that are free bound for where they bear, so that they go there by the shortest way."""
    return replace(pose, reach=bearing.reach, palms=bearing.palms, reaching=np.zeros(2), pressing=np.zeros(2))


def _times(rows: tuple[OneKnee | OverOneKnee | BothKnees | Pushing | Stood, ...], pace: float) -> list[float]:
    """When each pose is reached from the one before the first (seconds)."""
    return [0.0, *(np.cumsum([row.wait_s for row in rows]) * pace).tolist()]


def _seconds(step: Step, pace: float) -> tuple[float, float]:
    return step.begins_s * pace, step.ends_s * pace


def lie_down_from_knees(knelt: Pose, mat: Mat, style: Lying, keys: LieKeys) -> Pose:
    """From both knees to lying: hands down, the left hip and side, then over into the way of lying."""
    (*_, second, third, fourth), settle = keys.floor_down.pose, keys.floor_down.settle
    hands = _on_hands_and_knees(third, fourth, knelt, mat)
    back = _sat_back(second, hands, mat)
    side = _on_the_side(knelt, mat, keys.pose)
    end = lying(knelt, mat.bed, style, mat.skeleton, keys.pose)
    hip = _on_the_hip(fourth, hands, side, mat)
    side = _over_its_arm(side, hip)
    poses, waits = [side], [second.wait_s, third.wait_s, fourth.wait_s, settle.side_wait_s]
    if style.side != "left":
        poses.append(replace(_on_the_back(knelt, mat, keys.pose), palms=end.palms))
        waits.append(settle.back_wait_s)
    lifted = freed(end, mat.bed)
    waits += [settle.lifted_wait_s] * len(lifted) + [settle.end_wait_s]
    poses = [replace(pose, reach=hip.reach) for pose in (*poses, *lifted, end)]
    poses = [replace(knelt, reach=hands.reach, palms=hands.palms), back, hands, hip, *poses]
    times = np.cumsum([0.0, *waits]) / style.bearing.tempo
    return _on_the_knee(_feet_lifted(interpolate(times.tolist(), poses, FPS), mat), times[3:5], mat)


def rise_to_knees(start: Pose, mat: Mat, bearing: Bearing, keys: LieKeys) -> Pose:
    """From lying to both knees: over the left side onto hands and knees, and the trunk up."""
    (first, second, third, fourth, *_), leave = keys.floor_up.pose, keys.floor_up.leave
    if rotations.rotate(start.hips, np.array([0.0, 0.0, 1.0])) @ mat.out < -0.5:
        back = _on_the_back(start, mat, keys.pose)
        over = interpolate([0.0, leave.back_wait_s / bearing.tempo], [start, back], FPS)
        return concatenate([over, rise_to_knees(over.at(len(over) - 1), mat, bearing, keys)])
    knelt = _on_both_knees(fourth, start, mat)
    hands = _on_hands_and_knees(second, first, knelt, mat)
    back = _sat_back(third, hands, mat)
    side = replace(_on_the_side(start, mat, keys.pose), palms=start.palms)
    hip = _on_the_hip(first, hands, side, mat)
    side = _over_its_arm(side, hip)
    lifted = freed(start, mat.bed)
    before = [replace(pose, reach=hip.reach) for pose in (start, *lifted, side)]
    poses = [*before, hip, hands, back, replace(knelt, reach=hands.reach, palms=hands.palms)]
    waits = [leave.lifted_wait_s] * len(lifted) + [
        leave.side_wait_s,
        *(row.wait_s for row in (first, second, third, fourth)),
    ]
    times = np.cumsum([0.0, *waits]) / bearing.tempo
    return _on_the_knee(_feet_lifted(interpolate(times.tolist(), poses, FPS), mat), times[-4:-6:-1], mat)


def _on_both_knees(row: BothKnees, pose: Pose, mat: Mat) -> Pose:
    """Upright on both knees."""
    arms, elbows = arm_arrays("hang", "hang")
    yaw = mat.bed.head_yaw
    toes_down = rotations.compose(rotations.yaw_to_quat(yaw), rotations.rotvec_to_quat(np.array([ON_TOES, 0.0, 0.0])))
    return replace(
        pose,
        pelvis=mat.over_knees(0.0, row.pelvis_back_m),
        hips=upright(yaw, row.hip_pitch_rad),
        spine=bend(row.spine_pitch_rad),
        head=bend(row.head_pitch_rad),
        ankles=mat.ankles,
        feet=np.stack([toes_down, toes_down]),
        toes=np.full(2, CURLED),
        knees=np.repeat((mat.up - row.knee_down_ratio * UP)[None], 2, axis=0),
        arms=arms * [1.0, row.arms_down_share, 1.0] + [0.0, 0.0, row.arms_ahead_ratio],
        elbows=elbows,
        reaching=np.zeros(2),
        pressing=np.zeros(2),
        planted=np.ones(2),
    )


def _on_one_knee(row: OneKnee, stood: Pose, both: Pose, mat: Mat) -> Pose:
    """The left knee down, the right foot where it stands."""
    half = replace(
        both,
        pelvis=mat.over_knees(row.pelvis_aside_m, row.pelvis_back_m),
        hips=upright(mat.bed.head_yaw, row.hip_pitch_rad),
        spine=bend(row.spine_pitch_rad),
        ankles=np.stack([both.ankles[0], stood.ankles[1]]),
        feet=np.stack([both.feet[0], stood.feet[1]]),
        toes=np.array([CURLED, 0.0]),
        knees=np.stack([both.knees[0], mat.up + row.knee_up_ratio * UP]),
    )
    return _hand_on_thigh(_on_their_knees(half, mat), row.hand_share, mat)


def _on_their_knees(pose: Pose, mat: Mat) -> Pose:
    """The pose with knees that are knelt on, feet on their toes behind them, on their places."""
    aside = np.array([[HIP], [-HIP]]) * [1.0, 0.0, 0.0] * mat.skeleton.scale
    hips = pose.pelvis + rotations.rotate(pose.hips, aside)
    return replace(pose, knees=np.where(pose.toes[:, None] > 0, mat.knees - hips, pose.knees))


def _over_one_knee(row: OverOneKnee, pose: Pose, mat: Mat) -> Pose:
    """The weight over the left knee, feet where they are."""
    pelvis = mat.over_knees(row.pelvis_aside_m, row.pelvis_back_m)
    spine = bend(row.spine_pitch_rad, side=row.spine_side_rad)
    return _on_their_knees(replace(pose, pelvis=pelvis, spine=spine), mat)


def _hand_on_thigh(pose: Pose, share: float, mat: Mat) -> Pose:
    """The right hand on its thigh above the knee, as far as that share says."""
    scale = mat.skeleton.scale
    hip = pose.pelvis + rotations.rotate(pose.hips, np.array([-HIP * scale, 0.0, 0.0]))
    leg = two_bone(hip, pose.ankles[1], pose.knees[1], (THIGH * scale, SHANK * scale))
    normal = rotations.normalize(rotations.cross(leg.upper, mat.out))
    place = hip + scale * (ON_THIGH * leg.upper + OVER_THIGH * normal)
    reach, palms = pose.reach.copy(), pose.palms.copy()
    reach[1], palms[1] = place, palm_on(normal, mat.bed.head_yaw + FINGERS_IN, "right")
    shares = np.array([0.0, share])
    return replace(pose, reach=reach, palms=palms, reaching=shares, pressing=shares)


def _pushing(row: Pushing, half: Pose, mat: Mat) -> Pose:
    """Over the right foot, the left one pushing off on its toes."""
    scale, forward = mat.skeleton.scale, upright(mat.bed.head_yaw, row.hip_pitch_rad)
    # The left of a body that looks to its head's end is away from where it looks lying on the left side.
    moved = row.pelvis_ahead_m * mat.up + row.pelvis_up_m * UP - row.pelvis_aside_m * mat.out
    pushing = replace(half, pelvis=half.pelvis + scale * moved, hips=forward, spine=bend(row.spine_pitch_rad))
    return _hand_on_thigh(replace(pushing, head=bend(0.0)), row.hand_share, mat)


def _on_hands_and_knees(row: HandsAndKnees, hip: OnHip, knelt: Pose, mat: Mat) -> Pose:
    """Hands where they bear on the hip, so that none has to slide under its load."""
    hips, pelvis = upright(mat.bed.head_yaw, row.hip_pitch_rad), mat.over_knees(0.0, row.pelvis_back_m)
    pose = replace(knelt, pelvis=pelvis, hips=hips, spine=bend(row.spine_pitch_rad), head=bend(row.head_pitch_rad))
    return replace(_on_palms(pose, hip, mat), elbows=both_sides(row.elbow_direction))


def _sat_back(row: SatBack, hands: Pose, mat: Mat) -> Pose:
    """From hands and knees back over the heels: whoever lifted the hands there would fall onto them."""
    return replace(
        hands,
        pelvis=mat.over_knees(0.0, row.pelvis_back_m),
        hips=upright(mat.bed.head_yaw, row.hip_pitch_rad),
        spine=bend(row.spine_pitch_rad),
        head=bend(row.head_pitch_rad),
        arms=both_sides(row.wrist_ratio),
        reaching=np.array([0.0, 1.0]),
        pressing=np.array([0.0, 1.0]),
    )


def _on_the_hip(row: OnHip, hands: Pose, side: Pose, mat: Mat) -> Pose:
    """Half-way between hands and knees and lying on the side: the left hip nearly down, both hands and the left foot,
    which stays where it is, bearing."""
    scale, floor = mat.skeleton.scale, mat.bed.pelvis * [1.0, 0.0, 1.0]
    right_ankle = 0.5 * (hands.ankles[1] + side.ankles[1]) + row.right_ankle_up_m * UP
    return replace(
        hands,
        pelvis=floor + scale * (row.pelvis_out_m * mat.out + row.pelvis_up_m * UP),
        hips=rotations.slerp(hands.hips, side.hips, 0.5),
        spine=bend(row.spine_pitch_rad, side=row.spine_side_rad),
        head=bend(row.head_pitch_rad),
        ankles=np.stack([hands.ankles[0], right_ankle]),
        feet=np.stack([hands.feet[0], rotations.slerp(hands.feet[1], side.feet[1], 0.5)]),
        toes=np.array([hands.toes[0], row.toes_bend_rad]),
        knees=0.5 * (hands.knees + side.knees),
        elbows=np.array([row.left_elbow_direction, row.right_elbow_direction]),
        planted=np.array([1.0, 0.0]),
    )


def _over_its_arm(side: Pose, hip: Pose) -> Pose:
    """Lying on the side with the hand below where it bears on the hip, its elbow before the chest: an arm that lay
    anywhere else would have to be drawn out from under the trunk."""
    below = np.array([1.0, 0.0])
    elbows, palms = side.elbows.copy(), side.palms.copy()
    elbows[0], palms[0] = hip.elbows[0], hip.palms[0]
    return replace(side, reach=hip.reach, reaching=below, pressing=below, elbows=elbows, palms=palms)


def _on_palms(pose: Pose, row: OnHip, mat: Mat) -> Pose:
    """Both hands flat on the floor where a row has them."""
    left = row.left_hand_headwards_m * mat.up + row.left_hand_out_m * mat.out
    right = row.right_hand_headwards_m * mat.up + row.right_hand_out_m * mat.out
    places = mat.bed.pelvis * [1.0, 0.0, 1.0] + mat.skeleton.scale * np.array([left, right]) + HAND_REST * UP
    palms = np.stack([palm_on(UP, mat.bed.head_yaw, side) for side in ("left", "right")])
    return replace(pose, reach=places, reaching=np.ones(2), palms=palms, pressing=np.ones(2))


def _on_the_side(pose: Pose, mat: Mat, keys: LiePose) -> Pose:
    """Lying on the left side, knees bent, hands before the chest."""
    return replace(lying(pose, mat.bed, ON_SIDE, mat.skeleton, keys), pressing=np.zeros(2))


def _on_the_back(pose: Pose, mat: Mat, keys: LiePose) -> Pose:
    """On the back with the knees up, arms over the trunk."""
    way = Lying(legs="bent", arms=("chest", "belly"))
    return replace(lying(pose, mat.bed, way, mat.skeleton, keys), pressing=np.zeros(2))


def _step(pose: Pose, index: int, seconds: tuple[float, float], end: Pose, mat: Mat) -> Pose:
    """One foot taken from where it is at first to where it is at the end, in a stretch of the frames; lifted, then
    moved."""
    first, last = (round(at * FPS) for at in seconds)
    share = np.clip((np.arange(len(pose)) - first) / (last - first), 0.0, 1.0)
    here, there = pose.ankles[0, index].copy(), end.ankles[index]
    moved = smooth((share - STARTS) / (1 - 2 * STARTS))[:, None]
    lifted = smooth(share / TAKEOFF) * smooth((1 - share) / TAKEOFF)
    around = lifted[:, None] * (LIFT[index] * UP + ROUND[index] * mat.out) * mat.skeleton.scale
    ankles, feet, planted = pose.ankles.copy(), pose.feet.copy(), pose.planted.copy()
    ankles[:, index] = here + moved * (there - here) + around
    # Under the hip the sole looks back, whichever way the foot goes.
    turned = smooth(share / TURNED) if end.toes[index] > 0 else 1 - smooth((1 - share) / TURNED)
    feet[:, index] = rotations.slerp(feet[0, index][None], end.feet[index][None], turned)
    planted[:, index] = np.where((share > 0) & (share < 1), 0.0, 1.0)
    return replace(pose, ankles=ankles, feet=feet, planted=planted)


def _feet_lifted(pose: Pose, mat: Mat) -> Pose:
    """Feet off the floor while they move, so that none is drawn over it."""
    scale = mat.skeleton.scale
    soles = pose.ankles[:, :, None] + rotations.rotate(pose.feet[:, :, None], SOLE * scale)
    speed = np.linalg.norm(np.gradient(pose.ankles, axis=0)[..., [0, 2]], axis=-1) * FPS
    needed = OVER_FLOOR * scale * smooth(speed / MOVES) - soles[..., 1].min(axis=-1)
    ankles, frames = pose.ankles.copy(), np.arange(len(pose))
    # What comes before and after has feet where the first and the last pose have them.
    inside = smooth(np.minimum(frames, frames[::-1]) / (2 * COMES_UP))
    bell = np.hanning(2 * COMES_UP + 3)[1:-1]
    for index in (0, 1):
        some = np.pad(np.where(pose.planted[:, index] > 0, 0.0, np.maximum(needed[:, index], 0.0)), 2 * COMES_UP)
        most = np.lib.stride_tricks.sliding_window_view(some, 2 * COMES_UP + 1).max(axis=1)
        ankles[:, index, 1] += inside * np.convolve(most, bell / bell.sum(), "valid")
    return replace(pose, ankles=ankles)


def _on_the_knee(pose: Pose, times: Array, mat: Mat) -> Pose:
    """The left knee on its place, where the body goes down over it or up: hips turn round it.

    `times` are those of lying half on the hip, and of lying on the side (seconds).
    """
    hip, side = times
    at = np.arange(1, len(pose) + 1) / FPS
    share = smooth((at - side) / (hip - side))[:, None]
    joint = pose.pelvis + HIP * mat.skeleton.scale * rotations.rotate(pose.hips, np.array([1.0, 0.0, 0.0]))
    thigh = joint - mat.knees[0]
    length = np.linalg.norm(thigh, axis=1, keepdims=True)
    knees, ankles = pose.knees.copy(), pose.ankles.copy()
    knees[:, 0] += share * (-thigh / length - knees[:, 0])
    shank = rotations.normalize(ankles[:, 0] - mat.knees[0]) * SHANK * mat.skeleton.scale
    ankles[:, 0] += share * (mat.knees[0] + shank - ankles[:, 0])
    pelvis = pose.pelvis + share * (THIGH * mat.skeleton.scale / length - 1) * thigh
    return replace(pose, pelvis=pelvis, knees=knees, ankles=ankles)
