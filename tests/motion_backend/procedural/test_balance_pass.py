"""A body on its feet has its weight over them, and nothing that is where it should be is moved for it."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
from for_each import for_each

from motion_backend import rotations
from motion_backend.backend_protocol import HISTORY, History
from motion_backend.metrics.balance_figures import outside_soles
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Emotion, Motion, Phase, PhaseKind
from motion_backend.procedural.balance_pass import Before, balanced
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.pose_solver import solve
from motion_backend.procedural.walk.gait import walk
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, build_skeleton

SKELETON = build_skeleton(1.70)
FRAMES = 90
UPRIGHT = standing((1.0, 2.0), 0.7, Bearing(), SKELETON).repeat(FRAMES)
STILL = replace(UPRIGHT, pelvis=UPRIGHT.pelvis - np.array([0.0, 0.05, 0.0]))
"""On both feet, knees a little bent, so that legs reach when it leans."""
ON_FEET = (Phase(PhaseKind.TOUCH, 0, FRAMES),)


def leaning(seed: int) -> Pose:
    """Standing on both feet with the pelvis going wherever it likes within two hands, from rest to rest."""
    rng = np.random.default_rng(seed)
    steps = np.repeat(rng.uniform(-0.16, 0.16, (6, 3)) * [1.0, 0.0, 1.0], FRAMES // 6, axis=0)
    bell = np.exp(-0.5 * (np.arange(-20, 21) / 7) ** 2)
    way = np.stack([np.convolve(axis, bell / bell.sum(), mode="same") for axis in steps.T], axis=1)
    ends = smooth(np.minimum(np.arange(FRAMES), np.arange(FRAMES)[::-1]) / 20)
    return replace(STILL, pelvis=STILL.pelvis + ends[:, None] * way)


def seated(seed: int) -> Pose:
    """The same, but in the last third on a seat."""
    pose = leaning(seed)
    lowered = pose.pelvis - 0.3 * smooth((np.arange(FRAMES) - 30) / 30)[:, None] * [0.0, 1.0, 0.0]
    return replace(pose, pelvis=lowered)


def acted(pose: Pose) -> Kinematics:
    root, local = solve(pose, SKELETON)
    planted = np.repeat(pose.planted, 2, axis=1).astype(np.float32)
    served = np.zeros(len(pose), np.int32)
    return Kinematics.of(Motion(root.astype(np.float32), local.astype(np.float32), planted, SKELETON, served))


def shift(before: Pose, after: Pose) -> Array:
    """(T, 3) metres."""
    return after.pelvis - before.pelvis


def test_who_stands_in_balance_is_left_alone() -> None:
    assert np.abs(shift(STILL, balanced(STILL, ON_FEET, SKELETON))).max() < 1e-9


@for_each("seed", range(6))
def test_the_zero_moment_point_of_a_body_that_leans_comes_to_its_soles(seed: int) -> None:
    pose = leaning(seed)
    before, after = (outside_soles(acted(one)) for one in (pose, balanced(pose, ON_FEET, SKELETON)))
    assert before.mean() > 0.01
    assert after.mean() < 0.4 * before.mean()


@for_each("foot", [0, 1])
def test_who_lifts_a_foot_comes_over_the_other(foot: int) -> None:
    planted, ankles = STILL.planted.copy(), STILL.ankles.copy()
    up = smooth((np.arange(FRAMES) - 30) / 10) * smooth((60 - np.arange(FRAMES)) / 10)
    ankles[:, foot, 1] += 0.1 * up
    planted[30:60, foot] = 0
    pose = replace(STILL, ankles=ankles, planted=planted)
    moved = balanced(pose, ON_FEET, SKELETON)
    to = pose.ankles[45, 1 - foot] - pose.pelvis[45]
    assert shift(pose, moved)[45] @ (to * [1, 0, 1]) > 0
    before, after = (outside_soles(acted(one))[30:60].mean() for one in (pose, moved))
    assert before > 0.03
    assert after < 0.3 * before


@for_each("seed", range(3))
def test_feet_and_a_hand_on_its_goal_stay_where_they_are(seed: int) -> None:
    still = acted(STILL).positions[0, INDEX["right_wrist"]]
    reach = STILL.reach.copy()
    reach[:, 1] = still + np.array([0.0, 0.2, 0.0])
    pose = replace(leaning(seed), reach=reach, reaching=np.tile([0.0, 1.0], (FRAMES, 1)))
    before, after = acted(pose), acted(balanced(pose, ON_FEET, SKELETON))
    assert np.abs(after.soles - before.soles).max() < 1e-3
    wrist = after.positions[:, INDEX["right_wrist"]]
    assert np.abs(wrist - reach[:, 1]).max() < 1e-3


@for_each("seed", range(3))
def test_a_shift_is_smooth_begins_from_nothing_and_ends_in_nothing(seed: int) -> None:
    pose = leaning(seed)
    moved = balanced(pose, ON_FEET, SKELETON)
    by = shift(pose, moved)
    assert np.abs(by).max() > 0.01
    assert np.abs(by[[0, -1]]).max() < 1e-3
    assert np.abs(np.diff(by, axis=0)[[0, -1]]).max() * 30 < 0.05
    assert np.abs(np.diff(by, n=2, axis=0)).max() * 900 < 3
    level = [0, 2]
    jerk = [np.linalg.norm(np.diff(one.pelvis[:, level], n=3, axis=0), axis=1).mean() for one in (pose, moved)]
    assert jerk[1] < 1.3 * jerk[0]


@for_each("seed", range(3))
def test_a_leg_is_not_stretched_more_than_it_was(seed: int) -> None:
    pose = leaning(seed)
    bends = []
    for one in (pose, balanced(pose, ON_FEET, SKELETON)):
        local = solve(one, SKELETON)[1][:, [INDEX["left_knee"], INDEX["right_knee"]]]
        bends.append(rotations.length(rotations.quat_to_rotvec(local)).min())
    assert bends[1] > min(bends[0], 0.3) - 1e-3


@for_each("kind", [PhaseKind.SITDOWN, PhaseKind.LIEDOWN, PhaseKind.STANDUP])
def test_a_pelvis_that_rests_on_something_is_not_moved(kind: PhaseKind) -> None:
    pose = seated(1)
    if kind is PhaseKind.STANDUP:
        pose = pose.at(slice(None, None, -1))
    by = np.abs(shift(pose, balanced(pose, (Phase(kind, 0, FRAMES),), SKELETON))).max(axis=1)
    rests = pose.pelvis[:, 1] < pose.pelvis[:, 1].min() + 0.005
    assert by[rests].max() < 1e-6
    if kind is PhaseKind.LIEDOWN:
        assert by.max() == 0
    else:
        assert by.max() > 0.01


def test_a_knee_that_is_knelt_on_stays() -> None:
    down = smooth((np.arange(FRAMES) - 20) / 20) * smooth((70 - np.arange(FRAMES)) / 20)
    pose = leaning(2)
    ankles = pose.ankles.copy()
    ankles[:, 1] -= down[:, None] * (0.35 * rotations.rotate(pose.hips, np.array([0.0, 0.0, 1.0])))
    kneels = replace(pose, ankles=ankles, pelvis=pose.pelvis - 0.46 * down[:, None] * [0.0, 1.0, 0.0])
    knee = acted(kneels).positions[:, INDEX["right_knee"], 1]
    knelt = knee < 0.12
    assert knelt.any()
    by = np.abs(shift(kneels, balanced(kneels, ON_FEET, SKELETON))).max(axis=1)
    assert by[knelt].max() < 1e-6
    assert by.max() > 0.01


def test_nobody_is_moved_in_the_air_for_soles_that_do_not_carry() -> None:
    pose = replace(leaning(0), planted=np.zeros((FRAMES, 2)))
    assert (balanced(pose, ON_FEET, SKELETON).pelvis == pose.pelvis).all()


@for_each("frames", [1, 2, 3, 5])
def test_a_segment_of_few_frames_is_no_trouble(frames: int) -> None:
    pose = leaning(1).at(slice(30, 30 + frames))
    assert np.isfinite(balanced(pose, ON_FEET, SKELETON).pelvis).all()


def test_a_body_in_a_mirror_shifts_as_in_a_mirror() -> None:
    pose = leaning(4)
    there = shift(mirrored(pose), balanced(mirrored(pose), ON_FEET, SKELETON))
    assert np.abs(there - shift(pose, balanced(pose, ON_FEET, SKELETON)) * [-1, 1, 1]).max() < 1e-6


@for_each("cut", [60, 71, 78, 90])
def test_a_walk_that_goes_on_keeps_its_shift_across_the_seam(cut: int) -> None:
    start = standing((0.0, 0.0), 0.0, Bearing(), SKELETON)
    way = np.array([[0.0, 0.0], [0.0, 4.0]])
    steps = walk(start, way, None, walk_style(Emotion.NEUTRAL, "walk"), SKELETON, np.random.default_rng(0))
    walks = (Phase(PhaseKind.WALK, 0, len(steps)),)
    first, second = steps.at(slice(0, cut)), steps.at(slice(cut, None))
    begun = balanced(first, walks, SKELETON, beyond=second.at(slice(0, 24)))
    history = History.of(*solve(begun, SKELETON), np.repeat(begun.planted, 2, axis=1))
    before = Before.of(history, shift(first, begun)[-HISTORY:], SKELETON)
    on = balanced(second, walks, SKELETON, before)
    whole, seam = balanced(steps, walks, SKELETON), slice(cut - 10, cut + 10)
    carried = replace(steps, pelvis=np.concatenate([begun.pelvis, on.pelvis]))
    stopped = [balanced(part, walks, SKELETON).pelvis for part in (first, second)]
    alone = replace(steps, pelvis=np.concatenate(stopped))
    outside = [np.nanmean(outside_soles(acted(one))[seam]) for one in (whole, carried, alone)]
    assert outside[1] < outside[0] + 0.003
    assert outside[1] < outside[2]
    assert np.abs(np.diff(shift(steps, carried), n=2, axis=0)[seam]).max() < 0.005


def mirrored(pose: Pose) -> Pose:
    """Left and right changed, across the plane x = 0."""
    vectors, turns = np.array([-1.0, 1.0, 1.0]), np.array([1.0, -1.0, -1.0, 1.0])
    signs = {"hips": turns, "feet": turns, "palms": turns, "spine": -vectors, "head": -vectors}
    changed = {}
    for name in (field.name for field in fields(Pose)):
        values = getattr(pose, name)
        pair = values if name in ("pelvis", "hips", "spine", "head") else values[:, ::-1]
        alone = name in ("toes", "reaching", "pressing", "planted")
        changed[name] = pair if alone else pair * signs.get(name, vectors)
    return Pose(**changed)
