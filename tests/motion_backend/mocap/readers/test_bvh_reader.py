"""Other people's BVH: channel orders, axes, units, stray frames and broken texts."""

from __future__ import annotations

import itertools
import re
from functools import cache

import numpy as np
import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from sample_motions import tumbling
from scipy.spatial.transform import Rotation

from motion_backend import rotations
from motion_backend.formats.bvh import write_bvh
from motion_backend.mocap.clip import ClipError
from motion_backend.mocap.joint_map import find_map
from motion_backend.mocap.readers import read_clips
from motion_backend.mocap.readers.bvh_reader import euler_to_quat, read_bvh_clip

CHAIN = """HIERARCHY
ROOT base
{
 OFFSET 0 0 0
 CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
 JOINT tip
 {
  OFFSET 0 150 0
  CHANNELS 3 Zrotation Xrotation Yrotation
  End Site
  {
   OFFSET 0 10 0
  }
 }
}
MOTION
Frames: 2
Frame Time: 0.0083333
0 100 0 0 0 0 0 0 0
0 100 0 30 0 0 0 0 0
"""
ORDERS = list(itertools.permutations((0, 1, 2)))
OURS = np.eye(3)
Z_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Ours to axes with Z up and facing -Y."""


def body(frames, turn=OURS, metres=100.0, order="ZXY", own=None) -> str:
    """A BVH of a plain body with Mixamo's names; frames are lists of (root place, root angles, left upper-leg angles).

    turn: from our axes to the file's; own: axes of a joint's own, in which what hangs on it is told.
    """
    places: dict[str, tuple[str | None, tuple[float, float, float]]] = {
        "Hips": (None, (0, 0, 0)),
        "Spine": ("Hips", (0, 0.11, 0)), "Spine1": ("Spine", (0, 0.12, 0)), "Spine2": ("Spine1", (0, 0.12, 0)),
        "Neck": ("Spine2", (0, 0.2, 0)), "Head": ("Neck", (0, 0.1, 0)),
    }  # fmt: skip
    for side, x in (("Left", 1.0), ("Right", -1.0)):
        places |= {
            f"{side}UpLeg": ("Hips", (0.09 * x, 0, 0)), f"{side}Leg": (f"{side}UpLeg", (0, -0.4, 0)),
            f"{side}Foot": (f"{side}Leg", (0, -0.4, 0)), f"{side}ToeBase": (f"{side}Foot", (0, -0.04, 0.12)),
            f"{side}Shoulder": ("Spine2", (0.05 * x, 0.13, 0)), f"{side}Arm": (f"{side}Shoulder", (0.13 * x, 0, 0)),
            f"{side}ForeArm": (f"{side}Arm", (0.29 * x, 0, 0)), f"{side}Hand": (f"{side}ForeArm", (0.25 * x, 0, 0)),
        }  # fmt: skip
    lines, columns = ["HIERARCHY"], []
    axes = {name: (own or {}).get(name, Rotation.identity()) for name in [*places, None]}

    def write(name: str) -> None:
        above, offset = places[name]
        x, y, z = turn @ axes[above].inv().apply(offset) * metres
        moves = "" if above else "Xposition Yposition Zposition "
        lines.extend([f"{'JOINT' if above else 'ROOT'} {name}", "{", f"OFFSET {x} {y} {z}"])
        lines.append(f"CHANNELS {3 if above else 6} {moves}{' '.join(axis + 'rotation' for axis in order)}")
        columns.append(name)
        for child, (parent, _) in places.items():
            if parent == name:
                write(child)
        lines.append("}")

    write("Hips")
    lines += ["MOTION", f"Frames: {len(frames)}", "Frame Time: 0.0333333"]
    for place, root, leg in frames:
        row = list(turn @ np.array(place) * metres)
        for name in columns:
            local = Rotation.from_euler("XYZ", {"Hips": root, "LeftUpLeg": leg}.get(name, (0, 0, 0)), degrees=True)
            local = axes[places[name][0]].inv() * local * axes[name]
            turned = Rotation.from_matrix(turn @ local.as_matrix() @ turn.T)
            row += turned.as_euler(order, degrees=True).tolist()
        lines.append(" ".join(f"{value:.6f}" for value in row))
    return "\n".join(lines) + "\n"


STEPS = [((0.0, 0.88, 0.02 * step), (0, 10 * step, 0), (-5 * step, 0, 0)) for step in range(6)]


def placed(clip, *joints):
    """Positions of our joints over time."""
    names = find_map(clip.bones.names)[1]
    return clip.joint_positions()[:, [clip.bones.index(names[joint]) for joint in joints]]


def test_a_chain_stands_where_a_hand_would_put_it():
    clip = read_bvh_clip(CHAIN, "chain")
    assert clip.fps == 120.0
    assert clip.bones.names == ("base", "tip")
    tilted = [-1.5 * np.sin(np.pi / 6), 1.0 + 1.5 * np.cos(np.pi / 6), 0.0]
    np.testing.assert_allclose(clip.joint_positions()[:, 1], [[0.0, 2.5, 0.0], tilted], atol=1e-9)
    assert any("centimetres" in note for note in clip.notes)
    assert any("no family" in note for note in clip.notes)


@pytest.mark.parametrize("order", ORDERS)
@given(angles=st.lists(st.floats(-7, 7), min_size=3, max_size=3))
@tries(10)
def test_euler_angles_of_any_order_turn_as_scipy_says(order, angles):
    ours = euler_to_quat(np.array(angles), order)
    scipys = Rotation.from_euler("".join("XYZ"[axis] for axis in order), angles).as_quat()
    assert abs(float(ours @ scipys)) > 1 - 1e-9


def test_a_map_of_joints_tells_unit_and_axes_where_names_do_not(tmp_path):
    text = body(STEPS, turn=Z_UP, metres=39.37)
    strange = {name: f"bone{number}" for number, name in enumerate(re.findall(r"(?:ROOT|JOINT) (\w+)", text))}
    given_map = {ours: strange[theirs] for ours, theirs in find_map(strange)[1].items()}
    (tmp_path / "walk.bvh").write_text(re.sub(r"(?<=ROOT |OINT )\w+", lambda found: strange[found[0]], text))
    (clip,) = read_clips(tmp_path / "walk.bvh", joints=given_map)
    known = read_bvh_clip(text, "walk")
    np.testing.assert_array_equal(clip.joint_positions(), known.joint_positions())
    assert clip.notes == known.notes
    assert any("no family" in note for note in read_clips(tmp_path / "walk.bvh")[0].notes)


@cache
def plain():
    return read_bvh_clip(body(STEPS), "walk")


@for_each("order", ["ZXY", "XYZ", "YZX"])
@for_each(("metres", "unit"), [(100.0, "centimetres"), (1.0, "metres"), (0.45 / 0.0254, "CMU"), (1e3, "milli")])
def test_units_and_channel_orders_make_no_difference(order, metres, unit):
    clip = read_bvh_clip(body(STEPS, metres=metres, order=order), "walk")
    np.testing.assert_allclose(clip.joint_positions(), plain().joint_positions(), atol=1e-5)
    assert any(unit in note for note in clip.notes)


def test_a_unit_that_nobody_uses_is_told_by_the_legs():
    clip = read_bvh_clip(body(STEPS, metres=25.0), "walk")
    leg = np.linalg.norm(np.diff(placed(clip, "left_hip", "left_knee", "left_ankle"), axis=1), axis=-1).sum(axis=1)
    np.testing.assert_allclose(leg, 0.833, atol=1e-6)
    assert any("fit no unit" in note for note in clip.notes)


@pytest.mark.parametrize("turn", [Z_UP, np.roll(np.eye(3), 1, axis=0), np.roll(np.eye(3), 2, axis=0)])
def test_axes_of_any_kind_are_turned_into_ours(turn):
    clip = read_bvh_clip(body(STEPS, turn=turn), "walk")
    np.testing.assert_allclose(clip.joint_positions(), plain().joint_positions(), atol=1e-5)
    np.testing.assert_allclose(clip.tpose_kinematics()[0], plain().tpose_kinematics()[0], atol=1e-9)
    assert any(note.startswith("axes turned") for note in clip.notes)


def test_a_skeleton_that_rests_in_other_axes_than_it_moves_in_is_stood_up():
    """Every joint rests Z up, and the root's own rotation stands it on the Y axis."""
    upright = Rotation.from_matrix(Z_UP.T)
    lines = body(STEPS, turn=Z_UP, order="XYZ").splitlines()
    start = next(number for number, line in enumerate(lines) if line.startswith("Frame Time")) + 1
    for number, (place, root, _) in enumerate(STEPS):
        row = lines[start + number].split()
        world = Rotation.from_euler("XYZ", root, degrees=True) * upright
        row[:6] = [f"{value:.6f}" for value in (*(np.array(place) * 100), *world.as_euler("XYZ", degrees=True))]
        lines[start + number] = " ".join(row)
    clip = read_bvh_clip("\n".join(lines), "walk")
    np.testing.assert_allclose(clip.joint_positions(), plain().joint_positions(), atol=1e-5)
    np.testing.assert_allclose(clip.tpose_kinematics()[0], plain().tpose_kinematics()[0], atol=1e-6)


def test_a_skeleton_whose_rest_pose_is_no_pose_is_told_by_where_it_stands():
    """Some exporters tell every bone along its own axis, so that without rotations all lie in one line."""
    turns = {"Hips": (1.4, 0.3, 0.1), "Spine": (1.5, 0.2, 0.0), "Neck": (1.3, 0.2, 0.2), "LeftArm": (0.3, 1.0, 0.2)}
    for side in ("Left", "Right"):
        turns |= {f"{side}UpLeg": (-1.5, 0.1, 0.2), f"{side}Leg": (-1.6, 0.0, 0.2)}
    own = {name: Rotation.from_euler("ZYX", angles) for name, angles in turns.items()}
    clip = read_bvh_clip(body(STEPS, own=own), "walk")
    assert any("rests in no pose" in note for note in clip.notes)
    np.testing.assert_allclose(clip.joint_positions(), plain().joint_positions(), atol=1e-5)
    np.testing.assert_allclose(clip.tpose_kinematics()[0], plain().tpose_kinematics()[0], atol=1e-5)


def test_a_body_that_lies_all_the_while_is_not_stood_up():
    lying = [((0.3, 0.1, 0.01 * step), (-85, 0, 0), (0, 0, 0)) for step in range(5)]
    clip = read_bvh_clip(body(lying), "lie")
    assert np.ptp(clip.joint_positions()[..., 1]) < 0.3


def test_leading_frames_that_jump_are_dropped_and_the_t_pose_among_them_kept():
    far = [((5.0, 0.88, 0.0), (0, 0, 0), (0, 0, 0)), *STEPS]
    clip = read_bvh_clip(body(far), "walk")
    assert len(clip) == len(STEPS)
    assert any(note.startswith("1 leading frame dropped") for note in clip.notes)
    np.testing.assert_allclose(clip.root_positions[:, 2], [place[2] for place, _, _ in STEPS], atol=1e-6)


def test_the_t_pose_has_arms_out_and_legs_down_whatever_the_rest_pose():
    spread = body(STEPS).replace("OFFSET 0.0 -40.0 0.0", "OFFSET 20.0 -34.64 0.0", 2)
    clip = read_bvh_clip(spread, "walk")
    positions, _ = clip.tpose_kinematics()
    names = find_map(clip.bones.names)[1]
    hip, ankle = (positions[clip.bones.index(names[f"left_{joint}"])] for joint in ("hip", "ankle"))
    np.testing.assert_allclose(rotations.normalize(ankle - hip), [0, -1, 0], atol=1e-3)


@pytest.mark.parametrize("height", [1.3, 1.7, 2.1])
def test_what_we_write_comes_back_within_a_tenth_of_a_millimetre(tmp_path, height):
    motion = tumbling(height=height)
    write_bvh(motion, tmp_path / "motion.bvh")
    (clip,) = read_clips(tmp_path / "motion.bvh")
    assert clip.fps == motion.fps
    order = [clip.bones.index(name) for name in motion.skeleton.names]
    np.testing.assert_allclose(clip.joint_positions()[:, order], motion.joint_positions()[-len(clip) :], atol=1e-4)


@for_each(
    ("old", "new", "fault"),
    [
        ("HIERARCHY", "SCENE", "HIERARCHY"),
        ("MOTION", "MOVEMENT", "MOTION"),
        ("Frames: 2", "Frames: 3", "27 numbers, there are 18; is the file cut off"),
        ("Frames: 2", "Frames: 99999999", "too many"),
        ("Frame Time: 0.0083333", "Frame Time: 0", "above zero"),
        ("Frame Time: 0.0083333", "Frame Time: 90", "frames a second"),
        ("0 100 0 30 0 0 0 0 0", "0 100 0 nan 0 0 0 0 0", "not finite"),
        ("0 100 0 30 0 0 0 0 0", "0 100 0 x 0 0 0 0 0", "not a number"),
        ("0 100 0 30 0 0 0 0 0", "9e9 100 0 30 0 0 0 0 0", "units"),
        ("CHANNELS 3 Z", "CHANNELS 4 Z", "CHANNELS"),
        ("3 Zrotation Xrotation", "3 Zrotation Zrotation", "CHANNELS"),
        ("OFFSET 0 150 0", "OFFSET 0 high 0", "OFFSET of tip"),
        ("OFFSET 0 150 0", "OFFSET 0 0 0", "offset is zero"),
        ("JOINT tip", "JOINT base", "'base'"),
        ("JOINT tip", "BONE tip", "not a line"),
        ("}\nMOTION", "MOTION", "braces"),
    ],
)
def test_a_broken_text_says_what_is_wrong(old, new, fault):
    assert old in CHAIN
    with pytest.raises(ClipError, match=fault):
        read_bvh_clip(CHAIN.replace(old, new, 1), "chain")


def test_one_frame_is_no_clip():
    with pytest.raises(ClipError, match="1 frame"):
        read_bvh_clip(CHAIN.replace("Frames: 2", "Frames: 1").rsplit("\n", 2)[0], "chain")


def test_a_hierarchy_may_be_deep_but_not_endless():
    def nested(depth: int) -> str:
        joints = "".join(f"JOINT j{n} {{ \n OFFSET 0 1 0\n CHANNELS 0\n" for n in range(depth))
        head = f"HIERARCHY\nROOT r\n{{\nOFFSET 0 0 0\nCHANNELS 1 Xposition\n{joints}{'}' * (depth + 1)}\n"
        return head + "MOTION\nFrames: 2\nFrame Time: 0.1\n0\n0.1\n"

    assert len(read_bvh_clip(nested(500), "deep").bones.names) == 501
    with pytest.raises(ClipError, match="more than 512"):
        read_bvh_clip(nested(600), "deep")
