"""Every format gives back what it was given, or says what is wrong."""

from __future__ import annotations

import io
import json

import numpy as np
import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from sample_motions import tumbling

from motion_backend import rotations
from motion_backend.body.capsules import SOLE
from motion_backend.formats import FORMATS, encode, write_motion
from motion_backend.formats.bvh import bvh_text, quats_to_zxy
from motion_backend.formats.motion_json import json_bytes, read_json
from motion_backend.formats.npz import npz_bytes, raw_bytes, read_npz, read_raw
from motion_backend.mocap.readers.bvh_reader import read_bvh
from motion_backend.skeleton import INDEX, build_skeleton

ANGLES = st.floats(-np.pi, np.pi)
AXES = np.eye(3)


def test_npz_keeps_every_bit():
    motion = tumbling()
    again = read_npz(io.BytesIO(npz_bytes(motion)))
    for name in ("root_positions", "local_rotations", "contacts", "actions"):
        np.testing.assert_array_equal(getattr(again, name), getattr(motion, name))
        assert getattr(again, name).dtype == getattr(motion, name).dtype
    np.testing.assert_array_equal(again.skeleton.offsets, motion.skeleton.offsets)
    assert (again.skeleton.names, again.skeleton.parents) == (motion.skeleton.names, motion.skeleton.parents)
    assert (again.fps, again.goals, again.completed, again.reason) == (
        motion.fps,
        motion.goals,
        motion.completed,
        motion.reason,
    )


def test_equal_motions_give_equal_npz_bytes():
    assert npz_bytes(tumbling(seed=3)) == npz_bytes(tumbling(seed=3))
    assert npz_bytes(tumbling(seed=3)) != npz_bytes(tumbling(seed=4))


def test_an_npz_that_is_no_motion_is_refused():
    file = io.BytesIO()
    np.savez(file, something=np.zeros(3))
    file.seek(0)
    with pytest.raises(ValueError, match="version"):
        read_npz(file)


def test_a_pickle_in_an_npz_is_not_loaded(tmp_path):
    arrays = dict(np.load(io.BytesIO(npz_bytes(tumbling()))))
    called = tmp_path / "called"

    class Harm:
        def __reduce__(self):
            return called.touch, ()

    np.savez(tmp_path / "harm.npz", **(arrays | {"contacts": np.array([Harm()], dtype=object)}), allow_pickle=True)
    with pytest.raises(ValueError, match="pickle"):
        read_npz(tmp_path / "harm.npz")
    assert not called.exists()


@pytest.mark.parametrize("height", [1.5, 1.9])
def test_bvh_positions_come_back_within_a_tenth_of_a_millimetre(height: float):
    motion = tumbling(height=height)
    again = read_bvh(bvh_text(motion))
    assert again.skeleton.names == motion.skeleton.names
    assert again.fps == motion.fps
    np.testing.assert_allclose(again.joint_positions(), motion.joint_positions(), atol=1e-4)


def test_the_tips_of_a_bvh_are_those_of_the_body():
    """Crown, toes and fingers end the body's height, its soles and its reach; both sides are alike."""
    tips, joint = {}, ""
    for line in bvh_text(tumbling(1, height=1.7), unit=1.0).splitlines():
        words = line.split()
        if words[:1] == ["JOINT"]:
            joint = words[1]
        elif words[:2] == ["End", "Site"]:
            joint = f"{joint} tip"
        elif words[:1] == ["OFFSET"] and joint.endswith("tip"):
            tips[joint.removesuffix(" tip")] = np.array(words[1:], dtype=float)
            joint = ""
    skeleton = build_skeleton(1.7)
    ends = {name: skeleton.rest_positions[INDEX[name]] + tip for name, tip in tips.items()}
    assert ends["head"][1] + skeleton.standing_height == pytest.approx(1.70, abs=0.02)
    assert ends["left_wrist"][0] - ends["right_wrist"][0] == pytest.approx(1.70, abs=0.12)
    for side in ("left", "right"):
        ankle = skeleton.rest_positions[INDEX[f"{side}_ankle"]]
        assert ends[f"{side}_foot"][2] - ankle[2] == pytest.approx(SOLE[1, 2], abs=0.01)
    for name in ("wrist", "foot"):
        np.testing.assert_allclose(tips[f"left_{name}"], tips[f"right_{name}"] * [-1, 1, 1], atol=1e-9)


def test_bvh_in_metres_says_the_same_as_in_centimetres():
    motion = tumbling(5)
    metres = read_bvh(bvh_text(motion, unit=1.0), unit=1.0)
    np.testing.assert_allclose(metres.joint_positions(), motion.joint_positions(), atol=1e-4)


@given(ANGLES, st.floats(-np.pi / 2, np.pi / 2), ANGLES)
@tries(60)
def test_euler_angles_describe_the_same_rotation(z: float, x: float, y: float):
    def turned(angles):
        about_z, about_x, about_y = (rotations.rotvec_to_quat(angles[i] * AXES[k]) for i, k in enumerate((2, 0, 1)))
        return rotations.compose(rotations.compose(about_z, about_x), about_y)

    q = turned((z, x, y))
    again = turned(quats_to_zxy(q))
    assert abs(float(np.dot(q, again))) > 1 - 1e-9


@for_each(
    ("text", "fault"),
    [
        ("", "HIERARCHY"),
        ("HIERARCHY\nROOT hips\n{\n", "MOTION"),
        ("HIERARCHY\nROOT hips\n{\nSURPRISE\n}\nMOTION\nFrames: 1\nFrame Time: 0.1\n", "SURPRISE"),
        ("HIERARCHY\nROOT hips\n{\nCHANNELS 1 Xposition\n}\nMOTION\nFrames: 2\nFrame Time: 0.1\n1\n", "2 numbers"),
    ],
)
def test_a_broken_bvh_says_what_is_wrong(text: str, fault: str):
    with pytest.raises(ValueError, match=fault):
        read_bvh(text)


def test_raw_is_the_positions_little_endian():
    motion = tumbling(7)
    data = raw_bytes(motion)
    assert len(data) == 7 * 22 * 3 * 4
    np.testing.assert_array_equal(read_raw(data), motion.joint_positions())
    with pytest.raises(ValueError, match="whole number"):
        read_raw(data[:-4])


def test_json_agrees_to_a_tenth_of_a_millimetre():
    motion = tumbling(9)
    again = read_json(json_bytes(motion))
    np.testing.assert_allclose(again.joint_positions(), motion.joint_positions(), atol=1e-4)
    np.testing.assert_array_equal(again.actions, motion.actions)
    assert again.goals == motion.goals
    assert not again.completed


def test_json_without_a_field_names_it():
    with pytest.raises(ValueError, match="local_rotations"):
        read_json(json.dumps({"fps": 30, "joints": [], "parents": [], "offsets": [], "root_positions": []}))


@pytest.mark.parametrize("name", sorted(FORMATS))
def test_a_file_is_written_in_the_format_its_name_ends_with(name: str, tmp_path):
    motion = tumbling(4)
    path = write_motion(motion, tmp_path / f"motion{FORMATS[name].suffix}")
    assert path.read_bytes() == encode(motion, name)


def test_an_unknown_format_lists_the_known_ones():
    with pytest.raises(ValueError, match="npz, bvh, glb, json, amass, f32"):
        encode(tumbling(2), "fbx")


def test_a_file_of_an_unknown_ending_is_not_written(tmp_path):
    with pytest.raises(ValueError, match=r"\.amass\.npz"):
        write_motion(tumbling(2), tmp_path / "motion.fbx")
    assert not list(tmp_path.iterdir())
