"""Recordings of others, none of which is in this repository: every one is read, and its body stands as it should."""

from __future__ import annotations

import csv
import os
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from for_each import for_each
from layers import sampled

from motion_backend.mocap.clip import Clip, ClipError
from motion_backend.mocap.clip_captions import Label, Labels
from motion_backend.mocap.dataset_builder import Kept, read_folder
from motion_backend.mocap.joint_map import find_map
from motion_backend.mocap.near_duplicates import near_copies
from motion_backend.mocap.readers import read_clips

MOTION = Path(os.environ.get("SIMS_TEST_DATA", ".")) / "motion"
JUMPING = {"07_12": 2, "08_07": 7, "16_15": 3}
"""Trials of CMU whose data jump, and how many frames are dropped for it."""
WHOLE = pytest.mark.parametrize("whole", sampled([False, True], 2))
pytestmark = pytest.mark.skipif(not (MOTION / "manifest.csv").is_file(), reason="SIMS_TEST_DATA holds no motion")


@cache
def rows() -> list[dict[str, str]]:
    with (MOTION / "manifest.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


@cache
def clips(file: str) -> tuple[Clip, ...]:
    return read_clips(MOTION / file)


def of_kind(*kinds: str) -> list[str]:
    return [row["file"] for row in rows() if row["kind"] in kinds]


def cmu(whole: bool) -> list[str]:
    """CMU's recordings in BVH: all, or one of every subject and those whose data jump."""
    files = [file for file in of_kind("real mocap") if file.startswith("cmu_bvh/")]
    firsts = {file[8:10]: file for file in reversed(files)}
    return [file for file in files if whole or file in firsts.values() or file[8:13] in JUMPING]


def places(clip: Clip, positions, *joints: str):
    """Positions (..., joints, 3) of our joints."""
    names = find_map(clip.bones.names)[1]
    return positions[..., [clip.bones.index(names[joint]) for joint in joints], :]


def strided(clip: Clip, frames: int = 40):
    """World positions of a few frames. (T, J, 3)."""
    step = max(1, len(clip) // frames)
    return clip.bones.forward_kinematics(clip.root_positions[::step], clip.local_rotations[::step])[0]


def leg(clip: Clip) -> float:
    bent = places(clip, clip.tpose_kinematics()[0], "left_hip", "left_knee", "left_ankle")
    return float(np.linalg.norm(np.diff(bent, axis=0), axis=-1).sum())


@pytest.mark.sweep
def test_every_recording_is_read():
    counts = {
        kind: sum(len(clips(file)) for file in of_kind(kind))
        for kind in ("real mocap", "hand-keyed", "model-generated")
    }
    assert counts == {"real mocap": 91, "hand-keyed": 157, "model-generated": 6}
    seconds = sum(clip.duration for file in of_kind("real mocap") for clip in clips(file))
    assert seconds == pytest.approx(659, abs=5)


def test_what_is_no_motion_says_so():
    for file in of_kind("labels", "skeleton", "licence"):
        with pytest.raises(ClipError, match=Path(file).name.replace(".", r"\.")):
            clips(file)


@pytest.mark.sweep
def test_every_t_pose_faces_forward_with_arms_out_and_legs_down():
    for file in of_kind("real mocap", "hand-keyed", "model-generated"):
        clip = clips(file)[0]
        joints = find_map(clip.bones.names)[1]
        pose = clip.tpose_kinematics()[0]
        chain = places(clip, pose, "left_shoulder", "left_wrist", "left_hip", "left_ankle")
        arm, down = chain[1] - chain[0], chain[3] - chain[2]
        assert arm[0] > 0.95 * np.linalg.norm(arm), file
        assert down[1] < -0.95 * np.linalg.norm(down), file
        head = places(clip, pose, "head" if "head" in joints else "neck")[0]
        assert head[1] > chain[2][1] + 0.3, file
        if "left_foot" in joints:
            toes = places(clip, pose, "left_foot")[0] - chain[3]
            assert toes[2] > 0.7 * np.linalg.norm(toes), file


@pytest.mark.sweep
def test_bodies_walk_the_way_they_face():
    for file in of_kind("real mocap"):
        (clip,) = clips(file)
        travelled = np.linalg.norm(clip.root_positions[-1] - clip.root_positions[0])
        if "loco" not in next(row["skill"] for row in rows() if row["file"] == file) or travelled < 1.0:
            continue
        positions = strided(clip)
        hips = places(clip, positions, "left_hip", "right_hip")
        forward = np.cross(hips[:, 0] - hips[:, 1], [0.0, 1.0, 0.0])[:-1]
        path = np.diff(positions[:, 0], axis=0)
        assert np.einsum("ij,ij->", forward, path) > 0, file


@WHOLE
def test_cmu_bodies_have_the_sizes_that_were_measured(whole):
    legs = {}
    for file in cmu(whole):
        (clip,) = clips(file)
        legs[file[8:10]] = leg(clip)
        assert any("CMU's unit" in note for note in clip.notes)
    assert np.mean(list(legs.values())) == pytest.approx(0.83, abs=0.02)
    assert np.std(list(legs.values())) == pytest.approx(0.04, abs=0.02)
    assert all(abs(length - 0.83) < 0.08 for length in legs.values())


@WHOLE
def test_only_the_t_pose_is_dropped_but_where_the_data_jump(whole):
    dropped = {}
    for file in cmu(whole):
        (clip,) = clips(file)
        (note,) = (note for note in clip.notes if "dropped" in note)
        dropped[file[8:13]] = int(note.split()[0])
        positions = clip.part(0, 20).joint_positions()
        assert np.linalg.norm(np.diff(positions, axis=0), axis=-1).max() * clip.fps < 15
    assert {name: count for name, count in dropped.items() if count != 1} == JUMPING


@for_each(
    ("file", "lowest", "highest"),
    [
        ("deepmimic/humanoid3d_getup_faceup.txt", 0.12, 0.84),
        ("cmu_amc/13_29.amc", 0.41, 1.18),
        ("cmu_amc/14_14.amc", 0.39, 1.13),
        ("cmu_bvh/02_01.bvh", 0.93, 1.01),
        ("mit_bvh/fair1_zombie.bvh", 0.88, 0.97),
        ("kimodo_gen/05_root_path.npz", 0.93, 0.99),
    ],
)
def test_roots_sink_and_rise_as_was_measured(file, lowest, highest):
    (clip,) = clips(file)
    heights = clip.root_positions[:, 1]
    assert (heights.min(), heights.max()) == pytest.approx((lowest, highest), abs=0.04)


def test_exponential_maps_stand_on_the_skeleton_of_the_same_subject():
    (clip,) = read_clips(MOTION / "cmu_expmap/washwindow_1.txt", skeleton_file=MOTION / "cmu_bvh/14_08.bvh")
    ankles = clip.joint_positions()[:, [clip.bones.index(f"{side}Foot") for side in ("Left", "Right")], 1]
    assert np.median(ankles) == pytest.approx(0.09, abs=0.02)
    hand = clip.joint_positions()[:, clip.bones.index("RightHand"), 1]
    assert hand.max() == pytest.approx(1.70, abs=0.03)


def test_one_walk_read_from_two_formats_bends_its_knees_alike():
    """amp_humanoid_walk is the BVH trial 08_02 carried over to another body, at half the rate."""

    def knees(clip: Clip):
        chain = np.stack(
            [places(clip, clip.joint_positions(), f"{s}_hip", f"{s}_knee", f"{s}_ankle") for s in ("left", "right")]
        )
        bones = np.diff(chain, axis=2)
        bones /= np.linalg.norm(bones, axis=-1, keepdims=True)
        return np.degrees(np.arccos(np.clip(np.einsum("stk,stk->ts", bones[:, :, 0], bones[:, :, 1]), -1, 1)))

    amp, bvh = knees(clips("amp15/amp_humanoid_walk.npy")[0]), knees(clips("cmu_bvh/08_02.bvh")[0])[::2]
    assert len(amp) <= len(bvh)
    assert min(np.abs(bvh[start : start + len(amp)] - amp).mean() for start in range(len(bvh) - len(amp) + 1)) < 3.0


def test_one_walk_on_two_bodies_is_a_near_copy_and_other_subjects_walks_are_none():
    files = ["amp15/amp_humanoid_walk.npy", "cmu_bvh/08_02.bvh", "cmu_bvh/07_01.bvh", "cmu_bvh/16_15.bvh"]
    labels: Labels = {(file, ""): (Label(),) for file in files}
    entries = [one.entry for one in read_folder(MOTION, labels) if isinstance(one, Kept)]
    assert [(copy.clip, copy.of) for copy in near_copies(entries)] == [tuple(files[:2])]


def test_a_squat_is_cut_out_of_a_row_of_exercises():
    labels: Labels = {("cmu_amc/13_29.amc", ""): (Label(skill="squat", start=31.7, stop=38.3),)}
    (found,) = (one for one in read_folder(MOTION, labels) if isinstance(one, Kept))
    heights = found.entry.motion.root_positions[:, 1]
    assert (found.entry.name, found.report.accepted) == ("cmu_amc/13_29.amc@31.7-38.3", True)
    assert heights.max() > 0.85 > 0.55 > heights.min()


@pytest.mark.sweep
def test_toy_bodies_keep_their_own_size():
    assert clips("cc0_keyed/kaykit_rogue_hooded.glb")[0].bones.names[0] == "hips"
    assert leg(clips("cc0_keyed/kaykit_rogue_hooded.glb")[0]) < 0.4
    assert leg(clips("cc0_keyed/quaternius_human_base.glb")[0]) == pytest.approx(0.83, abs=0.02)
