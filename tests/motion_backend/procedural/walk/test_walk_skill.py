"""Walks: feet that step as real ones do, a performance of its own for every caption and mood, and detours."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from functools import cache
from importlib.resources import files
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from small_home import small_home

from motion_backend import rotations
from motion_backend.body.joint_limits import beyond_limits
from motion_backend.body.self_collision import overlaps, pairs
from motion_backend.metrics.foot_skate import skate_ratio
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.smoothness import jerk_against_real
from motion_backend.mocap.readers import read_clips
from motion_backend.mocap.retarget import retarget
from motion_backend.motion import FPS, Action, Emotion, Motion, Skill
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose_solver import solve
from motion_backend.procedural.walk.foot_trajectory import HEEL_RISE, SETTLE, Swing
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.procedural.walk.gait import walk
from motion_backend.procedural.walk.root_path import evenly
from motion_backend.procedural.walk.walk_skill import asks_for_haste, curved, to_and_fro
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.skeleton import INDEX, JOINTS, build_skeleton
from scene_graphs.navigation.path_planner import Walkable

CAPTIONS: list[str] = json.loads(files("planner_service").joinpath("data/captions.json").read_text())["loco"]
STAYING = [caption for caption in CAPTIONS if walk_style(Emotion.NEUTRAL, caption).stays]
WALKS = [caption for caption in CAPTIONS if caption not in STAYING]
SKATE_RATIO = 0.16
"""Of recorded walks, whose feet swing as low as these do; slip itself is held by the metrics of stories."""
FAR = 4.0
SKELETON = build_skeleton()
WALKABLE = Walkable(small_home())


@cache
def walked(
    caption: str,
    emotion: Emotion = Emotion.NEUTRAL,
    seed: int = 0,
    end_yaw: float | None = None,
    goal: tuple[float, float] = (0.0, FAR),
) -> Motion:
    """From the origin, facing +Z, straight to [x, z] on an empty floor."""
    start = standing((0.0, 0.0), 0.0, Bearing(), SKELETON)
    style, path = walk_style(emotion, caption), np.array([(0.0, 0.0), goal])
    pose = walk(start, path, end_yaw, style, SKELETON, np.random.default_rng(seed))
    root, local = solve(pose, SKELETON)
    contacts = np.repeat(pose.planted, 2, axis=1).astype(np.float32)
    actions = np.zeros(len(pose), dtype=np.int32)
    return Motion(root.astype(np.float32), local.astype(np.float32), contacts, SKELETON, actions)


def joints(motion: Motion) -> dict[str, np.ndarray]:
    positions = motion.joint_positions().astype(np.float64)
    return {name: positions[:, index] for index, name in enumerate(JOINTS)}


def flexion(at: dict[str, np.ndarray], side: str) -> np.ndarray:
    """Degrees a knee is bent."""
    thigh = rotations.normalize(at[f"{side}_knee"] - at[f"{side}_hip"])
    shin = rotations.normalize(at[f"{side}_ankle"] - at[f"{side}_knee"])
    return np.degrees(np.arccos(np.clip(np.sum(thigh * shin, axis=1), -1, 1)))


def on_the_way(motion: Motion) -> slice:
    """The frames between start and stop."""
    return slice(int(0.3 * len(motion)), int(0.75 * len(motion)))


@for_each("caption", WALKS)
def test_every_caption_is_walked_cleanly_to_its_end(caption: str) -> None:
    motion = walked(caption)
    body = Kinematics.of(motion)
    place = motion.root_positions[-1, [0, 2]]
    assert np.hypot(*(place - [0.0, FAR])) < 0.05
    assert motion.contacts[-1].min() == 1
    assert body.soles[..., 1].min() > -0.005
    assert skate_ratio(body) <= SKATE_RATIO
    assert np.degrees(beyond_limits(motion.local_rotations)).max() < 15
    steps = np.linalg.norm(np.diff(body.positions, axis=0), axis=-1)
    assert steps.max() * FPS < 9.0


def overlaps_of(motion: Motion) -> rotations.Array:
    """How deep the parts of the body are in each other. (T, P) metres."""
    positions, world = SKELETON.forward_kinematics(motion.root_positions, motion.local_rotations)
    return overlaps(SKELETON, positions.astype(np.float64), world)


@for_each("caption", WALKS)
def test_arms_keep_out_of_the_trunk_and_legs_out_of_each_other(caption: str) -> None:
    motion = walked(caption)
    deep = overlaps_of(motion)
    arms = [index for index, pair in enumerate(pairs()) if "arm" in pair[0] and pair[1] in ("torso", "pelvis", "head")]
    legs = [index for index, pair in enumerate(pairs()) if "thigh" in pair[0] or "shin" in pair[0]]
    assert deep[:, arms].max() < 0.03
    assert deep[:, legs].max() < 0.05


SHORT_WAYS = {
    "turning round": ((0.0, -0.03), np.pi),
    "aside, turning away": ((0.3, 0.05), -0.5),
    "forwards, turning far": ((0.0, 0.34), -2.2),
    "there and facing as before": ((0.3, -1.5), 0.0),
}
LEGS = [index for index, (part, _) in enumerate(pairs()) if part.endswith(("thigh", "shin", "foot"))]


@for_each("way", SHORT_WAYS)
def test_legs_keep_out_of_each_other_in_turns_and_on_short_ways(way: str) -> None:
    goal, end_yaw = SHORT_WAYS[way]
    motion = walked("steadily walking forward", end_yaw=end_yaw, goal=goal)
    deep = overlaps_of(motion)
    assert deep[:, LEGS].max() < 0.037


@pytest.mark.parametrize("side", [0, 1])
def test_the_foot_on_the_side_one_steps_to_goes_first(side: int) -> None:
    aside = 0.3 if side == 0 else -0.3
    planted = walked("steadily walking forward", end_yaw=0.0, goal=(aside, 0.0)).contacts[:, [0, 2]] > 0
    assert np.argmin(planted[:, side]) < np.argmin(planted[:, 1 - side])


@given(st.integers(1, 300))
def test_a_turn_goes_on_at_one_rate(frames: int) -> None:
    share = evenly(frames, FPS)
    steps = np.diff(share, prepend=0.0)
    assert share[-1] == pytest.approx(1.0)
    assert steps.min() >= 0.0
    assert steps.max() * max(frames - 0.5 * FPS, 1) < 1.5


@pytest.mark.parametrize(("degrees", "within"), [(45, 1.0), (90, 1.2), (-90, 1.2), (135, 1.5), (180, 1.5)])
def test_who_turns_on_the_spot_steps_round_and_soon_stands(degrees: int, within: float) -> None:
    start = standing((0.0, 0.0), 0.0, Bearing(), SKELETON)
    style, rng = walk_style(Emotion.NEUTRAL, "walk"), np.random.default_rng(0)
    turned = walk(start, np.zeros((2, 2)), np.radians(degrees), style, SKELETON, rng)
    lifts = int((np.diff(turned.planted, axis=0) < 0).sum())
    assert 2 <= lifts <= 4
    assert (np.flatnonzero(turned.planted.min(axis=1) < 1)[-1] + 2) / FPS <= within


def test_arms_hang_down_from_a_bent_trunk() -> None:
    def behind(caption: str) -> float:
        """How far an upper arm points back in the mean, as a slope."""
        at, middle = joints(walked(caption)), on_the_way(walked(caption))
        upper = (at["left_elbow"] - at["left_shoulder"])[middle].mean(axis=0)
        return float(upper[2] / upper[1])

    upright, bent = behind("steadily walking forward"), behind("head bowed and body bent while walking")
    assert abs(bent - upright) < 0.3


def features(motion: Motion) -> np.ndarray:
    """Where joints are about the pelvis and how far they swing, and how fast the body goes."""
    positions = motion.joint_positions().astype(np.float64)
    hips = positions[:, INDEX["left_hip"]] - positions[:, INDEX["right_hip"]]
    turn = rotations.yaw_to_quat(np.arctan2(hips[:, 2], hips[:, 0]))
    local = rotations.rotate(turn[:, None], positions - positions[:, :1] * [1.0, 0.0, 1.0])
    around = np.concatenate([local.mean(axis=0).ravel(), 2 * local.std(axis=0).ravel()])
    speed = np.linalg.norm(np.diff(positions[:, 0, [0, 2]], axis=0), axis=1) * FPS
    heading = np.unwrap(np.arctan2(hips[:, 2], hips[:, 0]))
    return np.concatenate([around, [0.3 * speed.mean(), 0.3 * speed.max(), 0.1 * np.ptp(heading)]])


def share_told_apart(styles: list[tuple[str, str]]) -> float:
    """Share of (caption, emotion) whose walk of another seed is nearest to its own."""
    known = np.array([features(walked(caption, emotion)) for caption, emotion in styles])
    seen = np.array([features(walked(caption, emotion, seed=1)) for caption, emotion in styles])
    gaps = np.linalg.norm(seen[:, None] - known[None], axis=-1)
    return float((gaps.argmin(axis=1) == np.arange(len(styles))).mean())


@pytest.mark.sweep
def test_captions_are_told_apart() -> None:
    assert share_told_apart([(caption, "neutral") for caption in WALKS]) >= 0.95


def test_moods_are_told_apart() -> None:
    assert share_told_apart([("steadily walking forward", mood) for mood in Emotion]) == 1.0


def test_two_walks_are_not_the_same() -> None:
    first, second = walked("walking quickly"), walked("walking quickly", seed=1)
    assert len(first) != len(second) or not np.array_equal(first.contacts, second.contacts)


def test_a_neutral_walk_has_the_measures_of_a_real_one() -> None:
    motion = walked("steadily walking forward")
    middle, at = on_the_way(motion), joints(walked("steadily walking forward"))
    for side in ("left", "right"):
        knee = flexion(at, side)[middle]
        assert 55 < knee.max() < 82
        assert 3 < knee.min() < 18
    assert 0.02 < np.ptp(at["pelvis"][middle, 1]) < 0.06
    assert 0.02 < np.ptp(at["pelvis"][middle, 0]) < 0.09
    aside = np.abs(at["left_ankle"] - at["right_ankle"])[middle, 0]
    assert 0.06 < np.median(aside) < 0.14
    assert 0.5 < motion.contacts[middle].mean() < 0.7
    pace = jerk_against_real(Kinematics.of(motion))
    assert pace is not None
    assert 0.5 <= pace <= 1.5


def test_feet_come_down_heel_first_and_leave_toe_last() -> None:
    motion = walked("steadily walking forward")
    soles = Kinematics.of(motion).soles[:, 0, :2, 1]  # heel and tip of the left foot
    planted = motion.contacts[:, 0] > 0
    landing = np.flatnonzero(planted[1:] & ~planted[:-1])[1]
    leaving = np.flatnonzero(~planted[1:] & planted[:-1])[1]
    assert soles[landing, 1] > soles[landing, 0] + 0.03
    assert soles[leaving, 0] > soles[leaving, 1] + 0.06


def test_knees_are_high_in_marching_and_low_in_shuffling() -> None:
    def lift(caption: str) -> float:
        at = joints(walked(caption))
        return float((at["left_knee"] - at["left_hip"])[on_the_way(walked(caption)), 1].max())

    assert lift("marching with swinging arms") > -0.2
    assert lift("shuffling sleepily forward") < -0.35


def test_who_skips_hops_on_the_same_foot() -> None:
    planted = walked("skip steps running").contacts[:, [0, 2]] > 0
    landed = [(frame, foot) for foot in (0, 1) for frame in np.flatnonzero(np.diff(planted[:, foot].astype(int)) > 0)]
    feet = [foot for _, foot in sorted(landed)]
    middle = feet[2:-3]
    assert any(a == b for a, b in pairwise(middle))
    assert len(set(middle)) == 2
    assert (~planted.any(axis=1)).any()


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_who_runs_flies_between_steps_lands_on_a_bent_knee_and_pushes_off_behind(seed: int) -> None:
    motion = walked("run", seed=seed, goal=(0.0, 10.0))
    body = Kinematics.of(motion.part(on_the_way(motion).start, on_the_way(motion).stop))
    speed = np.linalg.norm(np.diff(body.positions[:, 0, [0, 2]], axis=0), axis=1) * FPS
    assert np.quantile(speed, 0.9) >= 2.2
    flags = body.motion.contacts.any(axis=1)
    assert 0.25 <= 1 - flags.mean() <= 0.45
    assert (body.soles[..., 1].min(axis=(1, 2)) > 0.01).mean() >= 0.15
    at, landed = joints(body.motion), np.flatnonzero(np.diff(body.motion.contacts[:, 0]) > 0) + 1
    lifted = np.flatnonzero(np.diff(body.motion.contacts[:, 0]) < 0)
    assert (flexion(at, "left")[landed] > 20).all()
    assert (at["left_ankle"][lifted, 2] < at["pelvis"][lifted, 2] - 0.25).all()
    assert np.ptp(body.positions[:, 0, 1]) > 0.06


def test_who_sidesteps_faces_across_the_way() -> None:
    motion = walked("sidestepping")
    at = joints(motion)
    hips = (at["left_hip"] - at["right_hip"])[on_the_way(motion)]
    assert np.abs(hips[:, 2] / np.linalg.norm(hips, axis=1)).min() > 0.9


def test_who_walks_backwards_looks_where_it_came_from() -> None:
    start = standing((0.0, 0.0), 0.0, Bearing(), SKELETON)
    path, style = np.array([[0.0, 0.0], [0.0, -2.5]]), walk_style(Emotion.NEUTRAL, "walking backwards")
    pose = walk(start, path, 0.0, style, SKELETON, np.random.default_rng(0))
    assert np.abs(yaw_of(pose.hips)).max() < 0.3
    assert pose.pelvis[-1, 2] == pytest.approx(-2.5, abs=0.05)


def test_a_tiptoeing_heel_stays_off_the_floor() -> None:
    motion = walked("walk on tiptoes")
    assert Kinematics.of(motion).soles[on_the_way(motion), :, 0, 1].min() > 0.03


def test_the_head_turns_to_the_side_a_walk_leads_to() -> None:
    for side, sign in (("left", 1), ("right", -1)):
        motion = walked(f"walk to the front {side}")
        turn = motion.local_rotations[on_the_way(motion), INDEX["head"], 1].astype(np.float64)
        assert sign * np.median(turn) > 0.05


STEP = st.builds(
    Swing,
    start=st.just(np.zeros(3)),
    end=st.tuples(st.floats(-0.3, 0.3), st.just(0.0), st.floats(-1.2, 1.2)).map(np.array),
    start_yaw=st.floats(-3, 3),
    end_yaw=st.floats(-3, 3),
    side=st.sampled_from([1, -1]),
    window=st.floats(0.0, 5.0).map(lambda lift: (lift, lift + 0.8)),
    clearance=st.floats(0.02, 0.3),
    heel_off=st.floats(0.0, 1.3),
    heel_strike=st.floats(0.0, 0.5),
)


@given(STEP)
def test_a_foot_is_flat_before_and_after_a_step(swing: Swing) -> None:
    lift, land = swing.window
    around = np.array([-1.0, lift - HEEL_RISE, land + SETTLE, land + 3.0])
    np.testing.assert_allclose(swing.pitch(around), 0.0, atol=1e-6)


@given(STEP, st.floats(0.0, 1.0))
def test_a_step_back_is_a_step_forward_played_backwards(swing: Swing, share: float) -> None:
    lift, land = swing.window
    way = land - lift
    # A frame long before, so that the heel has all the time it wants to rise.
    there, back = (np.array([-1.0, lift + s * way]) for s in (share, 1 - share))
    forwards, backwards = swing.pitch(there)[1], replace(swing, backwards=True).pitch(back)[1]
    assert backwards == pytest.approx(forwards, abs=1e-6)


STRAIGHT = np.array([[1.2, 3.1], [4.4, 3.1]])


@pytest.mark.parametrize("left", [True, False])
def test_a_curve_bends_to_its_side_and_keeps_its_ends(left: bool) -> None:
    curve = curved(STRAIGHT, left, WALKABLE)
    np.testing.assert_allclose(curve[[0, -1]], STRAIGHT, atol=1e-9)
    assert len(curve) > 2, "the small home has no room for the curve"
    first, last = curve[5] - curve[0], curve[-1] - curve[-6]
    # Yaw grows to the left: x towards z on the floor plan.
    turn = rotations.wrap(np.arctan2(last[0], last[1]) - np.arctan2(first[0], first[1]))
    assert (turn > 0.2) == left
    assert (turn < -0.2) != left
    assert all(WALKABLE.is_free((float(x), float(z))) for x, z in curve)


def test_pacing_goes_there_and_back_and_there() -> None:
    ways = to_and_fro(STRAIGHT, WALKABLE)
    assert len(ways) == 3
    for way, following in pairwise(ways):
        np.testing.assert_allclose(way[-1], following[0])
    np.testing.assert_allclose(ways[-1][-1], STRAIGHT[-1])
    assert np.linalg.norm(ways[1][-1] - ways[1][0]) > 1.0


def test_one_paces_back_most_of_a_short_way_and_two_metres_and_a_half_of_a_long_one() -> None:
    for length, back in ((1.5, 0.9 * 1.5), (3.2, 2.4)):
        ways = to_and_fro(np.array([[1.2, 3.1], [1.2 + length, 3.1]]), WALKABLE)
        assert np.linalg.norm(ways[1][-1] - ways[1][0]) == pytest.approx(back, abs=0.12)


def test_a_short_way_is_paced_once() -> None:
    short = np.array([[1.2, 3.1], [1.6, 3.1]])
    assert len(to_and_fro(short, WALKABLE)) == 1


@pytest.mark.skipif(not os.environ.get("SIMS_TEST_DATA"), reason="SIMS_TEST_DATA is not set: no recorded walks")
@pytest.mark.parametrize("name", ["16_31", "35_01"])
def test_legs_bend_as_far_as_those_of_a_recorded_walk(name: str) -> None:
    clip = read_clips(Path(os.environ["SIMS_TEST_DATA"]) / "motion" / "cmu_bvh" / f"{name}.bvh")[0]
    real, ours = joints(retarget(clip).motion), joints(walked("steadily walking forward"))
    for side in ("left", "right"):
        theirs = np.quantile(flexion(real, side), [0.1, 0.5, 0.97])
        mine = np.quantile(flexion(ours, side)[on_the_way(walked("steadily walking forward"))], [0.1, 0.5, 0.97])
        np.testing.assert_allclose(mine, theirs, atol=13)


def test_haste_is_asked_for_by_a_walk_of_its_own_and_not_by_one_that_leads_to_a_thing() -> None:
    def asks(caption: str, object_id: str | None, skill: Skill = Skill.LOCO) -> bool:
        return asks_for_haste(Action(skill, caption, Emotion.STRESSED, object_id=object_id))

    assert asks("rush anxiously forward", None)
    assert not asks("rush anxiously forward", "0/sofa")
    assert not asks("steadily walking forward", None), "who is quick in a mood alone"
    assert not asks("run", None, Skill.TOUCH)
