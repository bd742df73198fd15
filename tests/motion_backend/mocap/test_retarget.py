"""Retargeting: whatever a source's proportions, axes of its joints and rest pose, limbs point the same way on ours."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from for_each import for_each
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt
from small_home import small_home
from strange_clips import GIANT, stranger

from motion_backend import rotations
from motion_backend.director import Director
from motion_backend.mocap.clip import ClipError, make_bones, make_clip
from motion_backend.mocap.foot_contacts import ANKLES, BALLS, Feet, no_faster, runs, travel
from motion_backend.mocap.foot_lock import from_nothing, locked, standing
from motion_backend.mocap.joint_map import FAMILIES, checked_map, find_map, read_map
from motion_backend.mocap.readers import clip_of_motion, read_clips
from motion_backend.mocap.resampling import low_pass, sample_rotations, sample_times
from motion_backend.mocap.rest_pose import LIMBS, shortest_turn
from motion_backend.mocap.retarget import Retargeted, retarget
from motion_backend.motion import Action, Character, Emotion, Motion, Skill
from motion_backend.procedural.backend import ProceduralBackend
from motion_backend.skeleton import INDEX, JOINTS, PARENTS, build_skeleton

Array = NDArray[np.float64]
DATA = os.environ.get("SIMS_TEST_DATA")
with_data = pytest.mark.skipif(not DATA, reason="third-party motion: set SIMS_TEST_DATA to the folder that has motion/")


def directions(motion: Motion) -> dict[str, Array]:
    positions = motion.joint_positions().astype(np.float64)
    return {near: rotations.normalize(positions[:, INDEX[far]] - positions[:, INDEX[near]]) for near, far in LIMBS}


def angle(a: Array, b: Array) -> Array:
    return np.asarray(np.degrees(np.arccos(np.clip(np.sum(a * b, axis=-1), -1, 1))))


@pytest.fixture(scope="module")
def walk() -> Motion:
    backend, home = Director(ProceduralBackend()), small_home()
    state = backend.begin(home, Character(), 3)
    way = Action(Skill.LOCO, "steadily walking forward", Emotion.NEUTRAL, goal=(2.6, 1.4))
    _, state = backend.act(home, way, state)
    back = Action(Skill.LOCO, "steadily walking forward", Emotion.NEUTRAL, goal=(4.0, 3.4))
    return backend.act(home, back, state)[0]


@for_each(("rest", "twist"), [("t", 0.0), ("n", 0.0), ("t", 2.0), ("n", 2.0)])
def test_a_stranger_with_our_motion_moves_our_body_alike(walk: Motion, rest: str, twist: float) -> None:
    found = retarget(stranger(walk, rest, twist=twist))
    assert found.report.family == "Mixamo"
    assert found.report.ratio == pytest.approx(1 / GIANT, abs=1e-3)
    given, made = directions(walk), directions(found.motion)
    worst = {near: float(angle(given[near], made[near]).mean()) for near in given}
    assert max(worst.values()) < 1.5, worst
    path = found.motion.root_positions - walk.root_positions
    np.testing.assert_allclose(np.ptp(path[:, [0, 2]], axis=0), 0, atol=0.02)


def test_our_own_motion_comes_back_nearly_as_it_was(walk: Motion) -> None:
    found = retarget(clip_of_motion(walk, "own"))
    turned = 2 * np.arccos(np.clip(np.abs(np.sum(found.motion.local_rotations * walk.local_rotations, -1)), 0, 1))
    assert np.degrees(turned).mean() < 2.0
    assert found.report.accepted, found.report.refused


def test_the_figures_of_a_true_copy_are_small(walk: Motion) -> None:
    report = retarget(stranger(walk, "t")).report
    assert report.limb_mean < 1.5
    assert abs(report.lowest) < 0.02
    assert report.source_skate is not None
    assert report.skate <= 1.15 * report.source_skate + 1.5
    assert report.fastest < 20
    assert set(report.limbs) == {"thigh", "shank", "upper arm", "forearm", "trunk"}
    assert report.to_dict()["accepted"] is True


def test_a_faster_recording_comes_out_at_our_rate_with_the_same_duration(walk: Motion) -> None:
    clip = stranger(walk, "t")
    double = stranger(walk, "t", fps=60.0)
    made = retarget(double).motion
    assert made.fps == 30
    assert made.duration == pytest.approx(clip.duration / 2, abs=0.05)


@pytest.mark.parametrize(("frames", "fps", "says"), [(5, 1000.0, "less than two frames"), (2100, 1.0, "35 minutes")])
def test_a_clip_that_is_too_short_or_too_long_at_our_rate_is_refused(
    walk: Motion, frames: int, fps: float, says: str
) -> None:
    clip = stranger(walk, "t")
    times = np.arange(frames) % len(clip)
    with pytest.raises(ClipError, match=says):
        retarget(
            replace(
                clip, root_positions=clip.root_positions[times], local_rotations=clip.local_rotations[times], fps=fps
            )
        )


def test_the_same_clip_gives_the_same_bytes(walk: Motion) -> None:
    one, two = (retarget(stranger(walk, "n", twist=1.0)) for _ in range(2))
    assert one.motion.local_rotations.tobytes() == two.motion.local_rotations.tobytes()
    assert one.report == two.report


def test_a_floor_that_climbs_is_taken_out_and_told(walk: Motion) -> None:
    clip = stranger(walk, "t")
    slope = np.outer(np.linspace(0, 0.15, len(clip)), [0.0, 1.0, 0.0])
    tilted = make_clip("hill", clip.bones, clip.root_positions + slope, clip.local_rotations, clip.tpose, 30.0, "bvh")
    report = retarget(tilted).report
    assert any("climbed" in note for note in report.conversions)
    assert abs(report.lowest) < 0.02


def test_a_walk_on_the_spot_gets_its_way_back(walk: Motion) -> None:
    clip = stranger(walk, "t")
    roots = clip.root_positions.copy()
    roots[:, [0, 2]] = roots[0, [0, 2]]
    still = make_clip("spot", clip.bones, roots, clip.local_rotations, clip.tpose, clip.fps, "glb")
    found = retarget(still)
    went = np.linalg.norm(found.motion.root_positions[-1, [0, 2]] - found.motion.root_positions[0, [0, 2]])
    meant = np.linalg.norm(walk.root_positions[-1, [0, 2]] - walk.root_positions[0, [0, 2]])
    assert went == pytest.approx(meant, rel=0.2)
    assert any("on the spot" in note for note in found.report.conversions)


def test_a_prefix_of_names_is_ignored_and_the_fullest_family_wins() -> None:
    assert find_map([f"ns:{name}" for name in JOINTS])[0] == "SMPL-X and this project"
    for family in FAMILIES:
        name, joints = find_map(family.joints().values())
        assert len(joints) >= len(family.joints()), (name, family.name)


def test_unknown_names_say_what_is_missing_and_how_to_give_a_map(walk: Motion) -> None:
    own = clip_of_motion(walk, "own")
    bones, order = make_bones([f"b{i}" for i in range(22)], PARENTS, own.bones.offsets)
    clip = make_clip("odd", bones, own.root_positions, own.local_rotations[:, order], own.tpose, 30.0, "bvh")
    with pytest.raises(ClipError, match="--map"):
        retarget(clip)
    given = {name: f"b{INDEX[name]}" for name in JOINTS}
    assert retarget(clip, joints=given).report.family == "given"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[]", "one object"),
        ("{", "not a JSON"),
        ('{"tail": "x"}', "tail"),
        ('{"pelvis": 3}', "names"),
        ('{"pelvis": "Hips", "head": 3}', "names"),
    ],
)
def test_a_bad_map_is_named(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "map.json"
    path.write_text(text)
    with pytest.raises(ClipError, match=says):
        read_map(path)


def test_a_map_must_tell_a_body_and_name_joints_that_are_there() -> None:
    full = {joint: joint for joint in JOINTS}
    with pytest.raises(ClipError, match="left_knee"):
        checked_map({joint: joint for joint in JOINTS if joint != "left_knee"}, JOINTS)
    with pytest.raises(ClipError, match="tail"):
        checked_map(full | {"head": "tail"}, JOINTS)
    with pytest.raises(ClipError, match="more than one"):
        checked_map(full | {"head": "neck"}, JOINTS)


def test_a_body_without_legs_is_refused(walk: Motion) -> None:
    own = clip_of_motion(walk, "own")
    offsets = own.bones.offsets.copy()
    for name in ("left_knee", "right_knee", "left_ankle", "right_ankle"):
        offsets[own.bones.index(name)] = 0
    bones, _ = make_bones(own.bones.names, own.bones.parents, offsets)
    with pytest.raises(ClipError, match=r"length|legs"):
        retarget(make_clip("flat", bones, own.root_positions, own.local_rotations, own.tpose, 30.0, "sims"))


def test_legs_of_a_few_centimetres_are_asked_for_their_units(walk: Motion) -> None:
    own = clip_of_motion(walk, "own")
    offsets = own.bones.offsets.copy()
    for name in ("left_knee", "right_knee", "left_ankle", "right_ankle"):
        offsets[own.bones.index(name)] /= 17
    bones, _ = make_bones(own.bones.names, own.bones.parents, offsets)
    with pytest.raises(ClipError, match="are the units right"):
        retarget(make_clip("tiny", bones, own.root_positions, own.local_rotations, own.tpose, 30.0, "sims"))


def standing_feet(hover: float = 0.0, slide: float = 0.0, frames: int = 60) -> tuple[Feet, np.ndarray]:
    """Two feet side by side, the left one over the floor and sliding forward, and the pelvis above them."""
    skeleton = build_skeleton()
    ankles = np.tile([[0.09, skeleton.ankle_height, 0.0], [-0.09, skeleton.ankle_height, 0.0]], (frames, 1, 1))
    ankles[:, 0, 1] += hover
    ankles[:, 0, 2] += np.linspace(0, slide, frames)
    turns = np.tile(rotations.IDENTITY, (frames, 2, 1))
    return Feet(ankles, turns, turns, skeleton, 30.0), np.tile([0.0, 0.9, 0.0], (frames, 1))


@for_each(("slide", "left"), [(0.02, 0.0), (0.1, 0.0), (0.25, 0.13)])
def test_a_standing_foot_that_slides_is_held_over_its_middle_but_moved_by_six_centimetres_at_most(
    slide: float, left: float
) -> None:
    feet, pelvis = standing_feet(slide=slide)
    shift, _ = locked(feet, pelvis)
    held = feet.ankles + shift
    assert np.ptp(held[:, 0, 2]) == pytest.approx(left, abs=0.005)
    assert np.linalg.norm(shift, axis=-1).max() < 0.062
    np.testing.assert_allclose(shift[:, 1], 0.0, atol=1e-9)
    assert held[:, 0, 2].mean() == pytest.approx(slide / 2, abs=0.005)


def test_a_hovering_foot_is_put_down_and_the_pelvis_comes_half_way_where_the_other_stands() -> None:
    feet, pelvis = standing_feet(hover=0.02)
    shift, carried = locked(feet, pelvis)
    np.testing.assert_allclose(shift[:, 0, 1], -0.02, atol=1e-4)
    np.testing.assert_allclose(carried[:, 1], -0.01, atol=1e-4)
    assert not carried[:, [0, 2]].any()


@for_each(
    ("speed", "grounded", "stands"), [(0.2, False, True), (0.6, False, False), (0.6, True, True), (1.0, True, False)]
)
def test_who_is_grounded_stands_on_the_slowest_low_foot_unless_that_swings(
    speed: float, grounded: bool, stands: bool
) -> None:
    """The left foot slides on the floor while the right one is up: people's would stand."""
    feet, pelvis = standing_feet(slide=2 * speed)
    feet.ankles[:, 1, 1] += 0.2
    heels, balls = standing(feet, pelvis, grounded)
    assert bool((heels | balls)[5:-5, 0].all()) == stands
    assert bool((heels | balls)[5:-5, 0].any()) == stands
    assert not (heels | balls)[:, 1].any()


def test_a_shift_sets_out_from_frames_that_are_not_shifted_without_a_step() -> None:
    shift = np.full((60, 2, 3), 0.03) + np.linspace(0, 0.02, 60)[:, None, None]
    found = from_nothing(shift, 20, 30.0)
    assert not found[:20].any()
    assert np.abs(np.diff(found, 2, axis=0)).max() < 0.006  # a step would be 0.03
    np.testing.assert_allclose(found[45:], shift[45:], atol=1e-3)
    assert from_nothing(shift, 0, 30.0) is shift


@for_each(
    ("feet_back", "pelvis_on", "walks"),
    [(0.6, 0.0, True), (0.6, 0.08, True), (0.6, 0.12, False), (0.28, 0.0, True), (0.22, 0.0, False)],
)
def test_who_treads_backwards_faster_than_25_cm_a_second_and_hardly_gets_on_walks_on_the_spot(
    feet_back: float, pelvis_on: float, walks: bool
) -> None:
    """On a treadmill; the pelvis may drift by 10 cm a second."""
    feet, pelvis = standing_feet(frames=90)
    seconds = np.arange(90) / 30
    for side in range(2):
        stands = (np.arange(90) // 15) % 2 == side
        feet.ankles[:, side, 1] += np.where(stands, 0.0, 0.1)
    feet.ankles[:, :, 2] -= feet_back * seconds[:, None]
    pelvis[:, 2] += pelvis_on * seconds
    found = travel(feet, pelvis)
    assert (found is not None) == walks
    if found is not None:
        assert found[-1, 2] == pytest.approx(feet_back * seconds[-1], rel=0.1)


def test_a_foot_in_the_air_goes_smoothly_from_one_stance_to_the_next() -> None:
    feet, pelvis = standing_feet(hover=0.02, frames=90)
    feet.ankles[30:60, 0, 1] += 0.2
    feet.ankles[60:, 0, 1] -= 0.01
    feet.ankles[45:, 0, 2] += 0.6
    shift, _ = locked(feet, pelvis)
    assert shift[10, 0, 1] == pytest.approx(-0.02, abs=1e-3)
    assert shift[80, 0, 1] == pytest.approx(-0.01, abs=1e-3)
    assert np.abs(np.diff(shift[:, 0, 1])).max() < 0.001


def test_the_shortest_turn_takes_one_vector_to_the_other_even_if_they_are_opposite() -> None:
    vectors = rotations.normalize(np.random.default_rng(0).normal(size=(50, 3)))
    for others in (vectors[::-1], -vectors, vectors):
        np.testing.assert_allclose(rotations.rotate(shortest_turn(vectors, others), vectors), others, atol=1e-6)


def test_smoothing_keeps_slow_movement_and_delays_nothing() -> None:
    times = np.arange(240) / 120
    slow, fast = np.sin(2 * np.pi * times), 0.1 * np.sin(2 * np.pi * 25 * times)
    kept = low_pass((slow + fast)[:, None], 120.0)[:, 0]
    assert np.abs(kept - slow)[20:-20].max() < 0.02


@for_each(("frames", "fps", "cutoff"), [(2, 120.0, 12.0), (40, 60.0, 4.0), (300, 30.0, 12.0)])
def test_movement_is_smoothed_as_scipy_smooths_it(frames: int, fps: float, cutoff: float) -> None:
    values = np.random.default_rng(0).normal(size=(frames, 22, 3)).cumsum(0)
    padding = min(frames - 1, round(fps / 2))
    theirs = sosfiltfilt(butter(2, cutoff, fs=fps, output="sos"), values, axis=0, padlen=padding)
    np.testing.assert_allclose(low_pass(values, fps, cutoff), theirs, atol=1e-10)


def test_samples_at_the_frames_themselves_are_the_frames() -> None:
    turns = rotations.normalize(np.random.default_rng(1).normal(size=(9, 2, 4)))
    assert sample_rotations(turns, sample_times(9, 30.0, 30.0)).tobytes() == turns.tobytes()
    assert sample_times(9, 120.0, 30.0).tolist() == [0.0, 4.0, 8.0]


def test_a_limited_curve_lies_above_and_is_no_steeper() -> None:
    values = np.abs(np.random.default_rng(2).normal(size=200))
    found = no_faster(values, 0.1)
    assert (found >= values).all()
    assert np.abs(np.diff(found)).max() <= 0.1 + 1e-9


def test_a_toys_own_feet_are_not_told_of(walk: Motion) -> None:
    clip = stranger(walk.part(0, 60), "t")
    short = np.array([0.4 if "Leg" in name or "Foot" in name else 1.0 for name in clip.bones.names])
    bones = replace(clip.bones, offsets=clip.bones.offsets * short[:, None])
    toy, plain = (retarget(one).report for one in (replace(clip, bones=bones), clip))
    assert toy.source_skate is None
    assert toy.source_depth is None
    assert plain.source_skate is not None
    assert any("toy" in note for note in toy.conversions)


def test_planted_feet_are_found_where_a_walk_of_ours_says(walk: Motion) -> None:
    positions, world = walk.skeleton.forward_kinematics(walk.root_positions, walk.local_rotations)
    feet = Feet(positions[:, ANKLES].astype(float), world[:, ANKLES], world[:, BALLS], walk.skeleton, 30)
    both = (feet.contacts()[:, [1, 3]] > 0.5) == (walk.contacts[:, [1, 3]] > 0.5)
    assert both.mean() > 0.85
    assert all(stop - start >= 3 for start, stop in runs(feet.contacts()[:, 1] > 0.5))


@with_data
@for_each(
    ("file", "legs"),
    [
        ("cmu_bvh/02_01.bvh", "CMU trials as BVH"),
        ("cmu_amc/13_31.amc", "Acclaim bones"),
        ("deepmimic/humanoid3d_getup_faceup.txt", "DeepMimic"),
        ("amp15/amp_humanoid_hop.npy", "AMP bodies"),
        ("mit_bvh/fair1_zombie.bvh", "MIT trials as BVH"),
        ("kimodo_gen/04_ee_constraint.npz", "Kimodo"),
        ("cmu_expmap/washwindow_1.txt", "CMU trials as BVH"),
    ],
)
def test_a_real_clip_of_every_source_is_true_to_it(file: str, legs: str) -> None:
    clip = read_clips(Path(str(DATA)) / "motion" / file)[0]
    found: Retargeted = retarget(clip.part(0, min(len(clip), 1200)))
    assert found.report.family == legs
    assert all(mean <= 5.0 for mean, _ in found.report.limbs.values())
    assert abs(found.report.lowest) <= 0.02
    assert found.report.source_skate is not None
    assert found.report.skate <= 1.15 * found.report.source_skate + 1.5
