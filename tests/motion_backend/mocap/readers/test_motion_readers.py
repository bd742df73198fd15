"""Tiny files of each format with joint positions worked out by hand, and files that are broken."""

from __future__ import annotations

import json
import zipfile
from collections import OrderedDict
from pathlib import Path

import numpy as np
import pytest
from examples import tries
from hypothesis import given
from hypothesis import strategies as st
from recorded import agrees
from sample_motions import tumbling

from motion_backend.formats.npz import write_npz
from motion_backend.mocap.clip import ClipError, make_bones, make_clip
from motion_backend.mocap.readers import FORMATS, read_clips
from motion_backend.mocap.readers.expmap import WIDTH

HALF = np.sqrt(0.5)
INCH = 0.0254
ASF = """# made by hand
:version 1.10
:units
  mass 1.0
  length 0.45
  angle deg
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name thigh
     direction 0 -2 0
     length 8
     axis 0 0 90  XYZ
    dof rx rz
    limits (-160.0 20.0)
           (-70.0 70.0)
  end
  begin
     id 2
     name shin
     direction 0 -1 0
     length 7
     axis 0 0 0  XYZ
  end
:hierarchy
  begin
    root thigh
    thigh shin
  end
"""
AMC = """#!OML:ASF
:FULLY-SPECIFIED
:DEGREES
1
root 0 16 0 0 0 0
thigh 0 0
2
root 1 16 2 0 90 0
thigh 90 0
"""


def written(path: Path, content: str | bytes) -> Path:
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def changed(text: str, change: tuple[str, str] | None) -> str:
    return text if change is None else text.replace(*change, 1)


def at(clip, *joints):
    """Positions over time. (T, joints, 3)."""
    return clip.joint_positions()[:, [clip.bones.index(joint) for joint in joints]]


# Acclaim


def acclaim(folder: Path, asf: str = ASF, amc: str = AMC):
    written(folder / "02.asf", asf)
    return read_clips(written(folder / "02_01.amc", amc))[0]


def test_acclaim_bones_turn_about_their_near_ends_in_their_own_axes(tmp_path):
    """The thigh's x is the world's y, so that turning a downward bone about it moves nothing but the root does."""
    clip = acclaim(tmp_path)
    unit = INCH / 0.45
    assert clip.bones.names == ("root", "thigh", "shin")
    assert clip.fps == 120.0
    np.testing.assert_allclose(at(clip, "root", "thigh", "shin")[0] / unit, [[0, 16, 0], [0, 16, 0], [0, 8, 0]])
    np.testing.assert_allclose(at(clip, "shin")[1, 0] / unit, [1, 8, 2], atol=1e-9)
    sideways = acclaim(tmp_path, amc=AMC.replace("thigh 90 0", "thigh 0 90"))
    np.testing.assert_allclose(at(sideways, "shin")[1, 0] / unit, [1, 16, 2 - 8], atol=1e-9)


def test_acclaim_applies_the_angle_listed_first_first(tmp_path):
    """About x a bone that points down comes forward negative; about z it then goes to the side, not before."""
    asf = ASF.replace("axis 0 0 90", "axis 0 0 0")
    clip = acclaim(
        tmp_path, asf, AMC.replace("root 1 16 2 0 90 0", "root 0 16 0 0 0 0").replace("thigh 90 0", "thigh 90 90")
    )
    np.testing.assert_allclose(at(clip, "shin")[1, 0] * 0.45 / INCH, [0, 16, -8], atol=1e-9)


def test_acclaim_reads_radians_and_skips_bones_without_angles(tmp_path):
    clip = acclaim(tmp_path, amc=AMC.replace(":DEGREES", ":RADIANS").replace(" 90 ", f" {np.pi / 2} "))
    degrees = acclaim(tmp_path)
    np.testing.assert_allclose(clip.joint_positions(), degrees.joint_positions(), atol=1e-9)


def test_an_acclaim_skeleton_is_looked_for_beside_the_motion(tmp_path):
    motion = written(tmp_path / "13_29.amc", AMC)
    with pytest.raises(ClipError, match=r"13_29\.amc.*\.asf"):
        read_clips(motion)
    written(tmp_path / "a.asf", ASF.replace("length 8", "length 9"))
    (clip,) = read_clips(motion)
    assert at(clip, "shin")[0, 0, 1] == pytest.approx(7 * INCH / 0.45)
    assert "on the skeleton a.asf, whose name is of another subject" in clip.notes
    written(tmp_path / "13.asf", ASF)
    (clip,) = read_clips(motion)
    assert at(clip, "shin")[0, 0, 1] == pytest.approx(8 * INCH / 0.45)
    assert not any("another subject" in note for note in clip.notes)
    given = read_clips(motion, skeleton_file=tmp_path / "a.asf")[0]
    assert at(given, "shin")[0, 0, 1] == pytest.approx(7 * INCH / 0.45)


@pytest.mark.parametrize(
    ("asf", "amc", "fault"),
    [
        (("root thigh", "root leg"), None, "'leg'|leg"),
        (("root thigh", "thigh shin"), None, "two parents|tree|hangs"),
        (("root thigh", "shin thigh"), None, "tree"),
        (("    thigh shin\n", ""), None, "'shin' hangs"),
        (("name shin", "name thigh"), None, "two bones one name"),
        (("length 8", "length long"), None, "length of thigh"),
        (("direction 0 -2 0", "direction 0 -2"), None, "direction of 3"),
        (("dof rx rz", "dof rx rw"), None, "dof"),
        (("axis 0 0 90  XYZ", "axis 0 0 90"), None, "axis of thigh"),
        (("  end\n:hierarchy", ":hierarchy"), None, "cut off"),
        (("length 0.45", "length 0"), None, ":units length"),
        (None, ("thigh 90 0", "thigh 90"), "cut off|numbered"),
        (None, ("thigh 90 0", "shin 90 0"), "same bones"),
        (None, ("thigh 0 0", "knee 0 0"), "cut off|numbered|none"),
        (None, ("\n2\n", "\n3\n"), "numbered"),
        (None, ("root 1", "root one"), "root must have numbers"),
        (None, ("root 1", "root nan"), "not finite"),
        (None, ("1\nroot", "0\nroot"), "numbered from 1"),
    ],
)
def test_broken_acclaim_says_what_is_wrong(tmp_path, asf, amc, fault):
    for change, text in ((asf, ASF), (amc, AMC)):
        assert change is None or change[0] in text
    with pytest.raises(ClipError, match=fault):
        acclaim(tmp_path, changed(ASF, asf), changed(AMC, amc))


def test_a_skeleton_alone_is_no_motion(tmp_path):
    with pytest.raises(ClipError, match=r"\.amc"):
        read_clips(written(tmp_path / "02.asf", ASF))


# DeepMimic

STILL = [1.0, 0.0, 0.0, 0.0]


def deepmimic_row(seconds=0.1, root=(0.0, 0.85, 0.0), turn=STILL, knee=0.0, elbow=0.0) -> list[float]:
    leg, arm = [*STILL, knee, *STILL], [*STILL, elbow]
    return [seconds, *root, *turn, *STILL, *STILL, *leg, *arm, *leg, *arm]


def deepmimic(folder: Path, rows, name="walk.txt"):
    return read_clips(written(folder / name, json.dumps({"Loop": "wrap", "Frames": rows})))[0]


def test_a_deepmimic_body_faces_z_with_its_left_on_x_and_bends_where_people_bend(tmp_path):
    clip = deepmimic(
        tmp_path, [deepmimic_row(), deepmimic_row(root=(1.0, 0.85, -0.5), knee=-np.pi / 2, elbow=np.pi / 2)]
    )
    assert clip.fps == 10.0
    np.testing.assert_allclose(clip.root_positions[1], [0.5, 0.85, 1.0])
    hip, knee, ankle = at(clip, "left_hip", "left_knee", "left_ankle")[1]
    np.testing.assert_allclose(hip, [0.585, 0.85, 1.0], atol=1e-9)
    np.testing.assert_allclose(ankle - knee, [0, 0, -0.41], atol=1e-9)
    shoulder, elbow, wrist = at(clip, "left_shoulder", "left_elbow", "left_wrist")[1]
    np.testing.assert_allclose(shoulder - [0.5, 0.85, 1.0], [0.183, 0.48, -0.024], atol=1e-9)
    np.testing.assert_allclose(wrist - elbow, [0, 0, 0.259], atol=1e-9)
    places = dict(zip(clip.bones.names, clip.tpose_kinematics()[0], strict=True))
    np.testing.assert_allclose(places["left_wrist"] - places["left_shoulder"], [0.534, 0, 0], atol=1e-9)


def test_deepmimic_quaternions_are_wxyz_in_the_formats_axes(tmp_path):
    """A quarter turn about the format's Y: what faced +X (ours +Z) faces -Z (ours +X)."""
    row = deepmimic_row(turn=[HALF, 0.0, HALF, 0.0])
    clip = deepmimic(tmp_path, [row, row])
    hip = at(clip, "left_hip")[0, 0] - clip.root_positions[0]
    np.testing.assert_allclose(hip, [0, 0, -0.085], atol=1e-9)


def test_frames_of_unequal_length_are_resampled(tmp_path):
    rows = [deepmimic_row(seconds, (x, 0.85, 0.0)) for seconds, x in ((0.1, 0.0), (0.1, 0.1), (0.2, 0.2), (0.0, 0.4))]
    clip = deepmimic(tmp_path, rows)
    np.testing.assert_allclose(clip.root_positions[:, 2], [0, 0.1, 0.2, 0.3, 0.4], atol=1e-6)
    assert "frames of unequal length resampled" in clip.notes


@pytest.mark.parametrize(
    ("rows", "fault"),
    [
        ([[1.0] * 43, [1.0] * 43], r"Frames\[0\] has 43"),
        ([deepmimic_row(), "row"], "lists of numbers"),
        ([deepmimic_row(), [*deepmimic_row()[:-1], "x"]], "not a number"),
        ([deepmimic_row(), [*deepmimic_row()[:-1], None]], "not finite|not a number"),
        ([deepmimic_row(), [*deepmimic_row()[:-1], float("nan")]], "not finite"),
        ([deepmimic_row(0.0), deepmimic_row()], "seconds to the next"),
        ([deepmimic_row(turn=[0, 0, 0, 0]), deepmimic_row()], "unit length"),
        ([deepmimic_row()], "1 frames; a clip has 2"),
        ([], "0 frames"),
        ({}, "lists of numbers"),
    ],
)
def test_a_broken_deepmimic_text_says_what_is_wrong(tmp_path, rows, fault):
    with pytest.raises(ClipError, match=fault):
        deepmimic(tmp_path, rows)


def test_json_nested_without_end_is_refused(tmp_path):
    with pytest.raises(ClipError, match="not JSON"):
        read_clips(written(tmp_path / "deep.json", '{"Frames":' + "[" * 100_000))


# Exponential maps


def expmap(folder: Path, rows):
    return read_clips(written(folder / "wash.txt", "\n".join(",".join(f"{v:g}" for v in row) for row in rows)))[0]


def test_exponential_maps_turn_the_other_way_round(tmp_path):
    rows = np.zeros((3, WIDTH))
    rows[:, 1] = 17.0
    rows[1:, 3:6] = [0.0, 0.1, 0.0]
    clip = expmap(tmp_path, rows)
    assert len(clip.bones.names) == 31
    np.testing.assert_allclose(clip.root_positions[:, 1], 17 * INCH / 0.45)
    left, right = (at(clip, name)[1, 0] for name in ("LeftUpLeg", "RightUpLeg"))
    np.testing.assert_allclose((left - right) / np.linalg.norm(left - right), [np.cos(0.1), 0, np.sin(0.1)], atol=1e-9)
    assert any("our own lengths" in note for note in clip.notes)


def test_a_skeleton_without_the_joints_of_the_rows_is_refused(tmp_path):
    motion = written(tmp_path / "wash.txt", "\n".join([",".join(["0"] * WIDTH)] * 3))
    bones = "HIERARCHY\nROOT a {\nOFFSET 0 0 0\nCHANNELS 0\nJOINT b {\nOFFSET 0 1 0\nCHANNELS 0\n}\n}\nMOTION\n"
    with pytest.raises(ClipError, match="31 joints"):
        read_clips(motion, skeleton_file=written(tmp_path / "a.bvh", bones))


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("1,2,3,4,5,6,7,8,9,10,11,12", "row 1 has 12"),
        ("," * 120, "row 1 has 121"),
        ("," * 116, "none left out"),
        ("x" + ",0" * 116, "not a number"),
        ("nan" + ",0" * 116, "row 1 holds a number that is not finite"),
    ],
)
def test_rows_of_the_wrong_kind_are_refused(tmp_path, text, fault):
    with pytest.raises(ClipError, match=fault):
        read_clips(written(tmp_path / "wash.txt", text))


# Archives


def archive(path: Path, **arrays) -> Path:
    np.savez(path, **arrays)
    return path


def amass(frames=4, joints=52, **other):
    """A body that stands in Z-up axes and walks along -Y, its left elbow bent in the second frame."""
    poses = np.zeros((frames, 3 * joints))
    poses[:, 0] = np.pi / 2
    poses[1, 3 * 18 + 1] = np.pi / 2
    trans = np.stack([np.zeros(frames), -0.1 * np.arange(frames), np.full(frames, 0.95)], axis=1)
    return {"poses": poses, "trans": trans, "mocap_framerate": np.array(60.0), "betas": np.zeros(16)} | other


@pytest.mark.parametrize("rate", ["mocap_framerate", "mocap_frame_rate"])
def test_amass_is_stood_up_and_faces_where_it_walks(tmp_path, rate):
    arrays = amass()
    arrays[rate] = arrays.pop("mocap_framerate")
    (clip,) = read_clips(archive(tmp_path / "walk.npz", **arrays))
    assert clip.fps == 60.0
    np.testing.assert_allclose(clip.root_positions[3], [0, 0.95, 0.3], atol=1e-9)
    head, toes = at(clip, "head", "left_foot")[0] - clip.root_positions[0]
    assert head[1] > 0.5
    assert toes[2] > 0.1
    assert toes[0] > 0.05
    elbow, wrist = at(clip, "left_elbow", "left_wrist")[1]
    np.testing.assert_allclose(wrist - elbow, [0, 0, -0.248], atol=1e-9)
    assert any("30 joints" in note for note in clip.notes)
    assert any("shape is not used" in note for note in clip.notes)


def test_smplx_with_y_up_and_parts_of_its_own_is_left_as_it_stands(tmp_path):
    trans = np.tile([0.0, 0.95, 0.0], (3, 1))
    arrays = {"root_orient": np.zeros((3, 3)), "pose_body": np.zeros((3, 63)), "trans": trans, "fps": np.array([30])}
    (clip,) = read_clips(archive(tmp_path / "stand.npz", **arrays))
    np.testing.assert_allclose(clip.root_positions, trans)
    assert at(clip, "head")[0, 0, 1] > 1.4


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"poses": np.zeros((4, 60))}, "66 numbers"),
        ({"poses": np.zeros((4, 67))}, "three a joint"),
        ({"trans": np.zeros((3, 3))}, "trans must be"),
        ({"mocap_framerate": np.array("fast")}, "frames a second"),
        ({"mocap_framerate": np.array(5000.0)}, "frames a second"),
        ({"poses": np.full((4, 66), np.nan)}, "not finite"),
        ({"poses": np.array(["a"] * 4)}, "numbers"),
        ({"trans": np.full((4, 3), np.inf)}, "not finite"),
        ({"poses": np.zeros((1, 66)), "trans": np.zeros((1, 3))}, "1 frame"),
    ],
)
def test_a_broken_amass_archive_says_what_is_wrong(tmp_path, change, fault):
    with pytest.raises(ClipError, match=fault):
        read_clips(archive(tmp_path / "walk.npz", **(amass() | change)))


def test_objects_in_an_archive_are_left_out_not_unpickled(tmp_path):
    path = archive(tmp_path / "walk.npz", **amass(gender=np.array({"a": 1}, dtype=object)))
    assert len(read_clips(path)[0]) == 4


def kimodo(frames=3):
    """Everything at one place but for the root, turned a quarter to the left, and its left leg."""
    positions = np.zeros((frames, 30, 3), dtype=np.float32)
    positions[:, :, 1] = 0.9
    positions[:, 22] += [0.0, 0.0, -0.1]
    turned = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]], dtype=np.float32)
    return {"posed_joints": positions, "global_rot_mats": np.tile(turned, (frames, 30, 1, 1))}


def test_kimodo_places_come_back_from_turns_and_offsets(tmp_path):
    arrays = kimodo()
    (clip,) = read_clips(archive(tmp_path / "gen.npz", **arrays))
    np.testing.assert_allclose(clip.bones.offsets[clip.bones.index("LeftLeg")], [0.1, 0, 0], atol=1e-6)
    np.testing.assert_allclose(at(clip, "LeftLeg")[:, 0], arrays["posed_joints"][:, 22], atol=1e-6)


def test_broken_kimodo_archives_say_what_is_wrong(tmp_path):
    arrays = kimodo()
    with pytest.raises(ClipError, match=r"\(T, 30, 3\)"):
        read_clips(archive(tmp_path / "a.npz", **(arrays | {"posed_joints": np.zeros((3, 24, 3))})))
    with pytest.raises(ClipError, match="no rotation"):
        read_clips(archive(tmp_path / "b.npz", **(arrays | {"global_rot_mats": np.zeros((3, 30, 3, 3))})))
    with pytest.raises(ClipError, match="no rotation"):
        read_clips(archive(tmp_path / "c.npz", **(arrays | {"global_rot_mats": -arrays["global_rot_mats"]})))


def test_our_own_motions_come_back_exactly(tmp_path):
    motion = tumbling(9)
    write_npz(motion, tmp_path / "motion.npz")
    (clip,) = read_clips(tmp_path / "motion.npz")
    assert (clip.source, clip.fps) == ("sims", 30.0)
    order = [clip.bones.index(name) for name in motion.skeleton.names]
    np.testing.assert_allclose(clip.joint_positions()[:, order], motion.joint_positions(), atol=1e-6)


def test_an_archive_that_would_unpack_to_more_than_memory_is_refused(tmp_path):
    path = archive(tmp_path / "walk.npz", **amass())
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as packed:
        info = zipfile.ZipInfo("more.npy")
        packed.writestr(info, b"x")
        packed.infolist()[-1].file_size = (1 << 30) + 1
    with pytest.raises(ClipError, match="unpacks to more"):
        read_clips(path)


# AMP


def amp(folder: Path, change=None, **motion) -> Path:
    """Pelvis, torso and a thigh, Z up and facing X; in the second frame turned a quarter to the left."""
    context = {"context": {"dtype": "float32"}}
    turns = np.tile(np.array([0, 0, 0, 1], dtype=np.float32), (2, 3, 1))
    turns[1, 0] = [0, 0, HALF, HALF]
    tree = OrderedDict(
        node_names=["pelvis", "torso", "left_thigh"],
        parent_indices={"arr": np.array([-1, 0, 0]), **context},
        local_translation={"arr": np.array([[0, 0, 0], [0, 0, 0.25], [0, 0.1, 0]], dtype=np.float32), **context},
    )
    read = OrderedDict(
        rotation={"arr": turns, **context},
        root_translation={"arr": np.array([[0, 0, 0.9], [1, 2, 0.9]], dtype=np.float32), **context},
        skeleton_tree=tree,
        is_local=True,
        fps=np.array(60),
        __name__="SkeletonMotion",
    )
    read.update(motion)
    if change:
        change(read)
    np.save(folder / "walk.npy", np.array(read, dtype=object), allow_pickle=True)
    return folder / "walk.npy"


def test_amp_faces_z_with_its_left_on_x(tmp_path):
    (clip,) = read_clips(amp(tmp_path))
    assert clip.fps == 60.0
    np.testing.assert_allclose(clip.root_positions, [[0, 0.9, 0], [2, 0.9, 1]], atol=1e-6)
    np.testing.assert_allclose(at(clip, "torso")[:, 0, 1], 1.15, atol=1e-6)
    np.testing.assert_allclose(at(clip, "left_thigh")[0, 0], np.array([0.1, 0.9, 0]), atol=1e-6)
    np.testing.assert_allclose(at(clip, "left_thigh")[1, 0] - clip.root_positions[1], np.array([0, 0, -0.1]), atol=1e-6)


def test_world_rotations_of_amp_are_made_local(tmp_path):
    turns = np.tile(np.array([0, 0, HALF, HALF]), (2, 3, 1))
    (clip,) = read_clips(amp(tmp_path, rotation={"arr": turns}, is_local=False))
    np.testing.assert_allclose(clip.local_rotations[:, 1:], np.tile([0, 0, 0, 1.0], (2, 2, 1)), atol=1e-9)


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (lambda read: read.pop("rotation"), "'rotation'"),
        (lambda read: read.pop("skeleton_tree"), "skeleton_tree"),
        (lambda read: read.pop("fps"), "fps"),
        (lambda read: read["skeleton_tree"].update(node_names=["a", "b"]), "2 whole numbers"),
        (lambda read: read["skeleton_tree"].update(node_names=3), "node_names"),
        (lambda read: read["skeleton_tree"].update(parent_indices=np.array([-1, 2, 1])), "tree"),
        (lambda read: read["skeleton_tree"].update(local_translation=np.zeros((3, 2))), "local_translation"),
        (lambda read: read["skeleton_tree"].update(local_translation=np.zeros((3, 3))), "offset is zero"),
        (lambda read: read.update(rotation=np.zeros((3, 4))), "one pose"),
        (lambda read: read.update(rotation=np.zeros((2, 3, 4))), "unit length"),
        (lambda read: read.update(root_translation=np.zeros((5, 3))), "root_translation"),
    ],
)
def test_a_broken_amp_motion_says_what_is_wrong(tmp_path, change, fault):
    with pytest.raises(ClipError, match=fault):
        read_clips(amp(tmp_path, change))


# All of them


@pytest.mark.parametrize("suffix", [".bvh", ".amc", ".npy", ".npz", ".glb", ".gltf", ".txt", ".json"])
@given(data=st.binary(max_size=300))
@tries(25)
def test_random_bytes_end_in_an_error_that_names_the_file(tmp_path_factory, suffix, data):
    folder = tmp_path_factory.getbasetemp() / "random"
    folder.mkdir(exist_ok=True)
    written(folder / "02.asf", ASF)
    with pytest.raises(ClipError, match="noise"):
        read_clips(written(folder / f"noise{suffix}", data))


@pytest.mark.parametrize("make", ["walk.npy", "walk.npz", "gen.npz", "walk.txt", "02_01.amc"])
@given(data=st.data())
@tries(25)
def test_a_damaged_file_ends_in_an_error_or_in_a_clip(tmp_path_factory, make, data):
    folder = tmp_path_factory.getbasetemp() / "damaged"
    folder.mkdir(exist_ok=True)
    if not (folder / "02.asf").exists():
        amp(folder)
        archive(folder / "walk.npz", **amass())
        archive(folder / "gen.npz", **kimodo())
        deepmimic(folder, [deepmimic_row(), deepmimic_row()])
        acclaim(folder)
    whole = (folder / make).read_bytes()
    place = data.draw(st.integers(0, len(whole) - 1))
    if data.draw(st.booleans()):
        broken = whole[:place]
    else:
        broken = whole[:place] + data.draw(st.binary(min_size=1, max_size=4)) + whole[place + 1 :]
    path = written(folder / f"x{Path(make).suffix}", broken)
    try:
        (clip,) = read_clips(path, skeleton_file=folder / "02.asf")
    except ClipError:
        return
    assert np.isfinite(clip.joint_positions()).all()


def test_what_cannot_be_read_is_named(tmp_path):
    with pytest.raises(ClipError, match=r"absent\.bvh cannot be read"):
        read_clips(tmp_path / "absent.bvh")
    with pytest.raises(ClipError, match="one of bvh, acclaim"):
        read_clips(tmp_path / "a.bvh", format="fbx")
    with pytest.raises(ClipError, match=r"a\.fbx: no motion we know"):
        read_clips(written(tmp_path / "a.fbx", "x"))
    with pytest.raises(ClipError, match="archive of something"):
        read_clips(archive(tmp_path / "a.npz", something=np.zeros(3)))
    assert set(FORMATS) == {"bvh", "acclaim", "deepmimic", "amp", "glb", "smplx", "kimodo", "expmap", "sims"}


def test_a_format_may_be_given_where_the_suffix_says_nothing(tmp_path):
    text = json.dumps({"Frames": [deepmimic_row(), deepmimic_row()]})
    assert len(read_clips(written(tmp_path / "walk.motion", text), format="deepmimic")[0]) == 2


def test_parts_of_a_clip_are_checked_in_one_place():
    offsets = [[0, 0, 0], [0, 1, 0]]
    bones, order = make_bones(["child", "root"], [1, -1], offsets[::-1])
    assert (bones.names, bones.parents, order) == (("root", "child"), (-1, 0), [1, 0])
    still = np.tile([0.0, 0.0, 0.0, 1.0], (3, 2, 1))
    clip = make_clip("still", bones, np.zeros((3, 3)), -still, still[0], 30.0, "sims")
    np.testing.assert_array_equal(clip.joint_positions()[:, 1], [[0, 1, 0]] * 3)
    assert len(clip.part(1, 3)) == 2
    with pytest.raises(ClipError, match="not two or more"):
        clip.part(2, 3)
    for names, parents, fault in (
        (["a", "b"], [1, 0], "among its own parents"),
        (["a", "b"], [-1, -1], "both roots"),
        (["a", "b"], [-1, 7], "parent 7"),
        (["a", "a"], [-1, 0], "two joints are named 'a'"),
        ([], [], "1 to 512"),
    ):
        with pytest.raises(ClipError, match=fault):
            make_bones(names, parents, np.ones((len(names), 3)))
    with pytest.raises(ClipError, match=r"shape \(3, 2, 4\)"):
        make_clip("still", bones, np.zeros((3, 3)), still[:, :1], still[0], 30.0, "sims")


# All of them


def test_the_tiny_files_are_read_as_recorded(tmp_path):
    """Bones, frames and notes of each format; joints in the second frame."""
    rows = np.zeros((3, WIDTH))
    rows[:, 1], rows[1:, 3:] = 17.0, 0.2 * np.cos(np.arange(WIDTH - 3))
    bent = [deepmimic_row(), deepmimic_row(root=(1.0, 0.85, -0.5), turn=[HALF, 0.0, HALF, 0.0], knee=-1.0, elbow=0.7)]
    found = {
        "acclaim": acclaim(tmp_path),
        "deepmimic": deepmimic(tmp_path, bent),
        "expmap": expmap(tmp_path, rows),
        "amass": read_clips(archive(tmp_path / "amass.npz", **amass()))[0],
        "amass with hands": read_clips(archive(tmp_path / "hands.npz", **amass(joints=55)))[0],
        "kimodo": read_clips(archive(tmp_path / "kimodo.npz", **kimodo()))[0],
        "amp": read_clips(amp(tmp_path))[0],
    }
    agrees("clips_read", {name: told(clip) for name, clip in found.items()})


def told(clip):
    spread = clip.joint_positions()[1]
    rest = clip.tpose_kinematics()[0]
    rows = np.column_stack([clip.bones.parents, spread, rest])
    return {
        "is": [clip.name, clip.source, clip.fps, len(clip), *clip.notes],
        "bones": {
            name: [round(float(number), 3) + 0.0 for number in row]
            for name, row in zip(clip.bones.names, rows, strict=True)
        },
    }
