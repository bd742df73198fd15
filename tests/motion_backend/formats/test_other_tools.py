"""What others read out of our files is what the motion says: three.js, pybvh, whoever reads AMASS."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from sample_motions import tumbling
from scipy.spatial.transform import Rotation

from motion_backend import rotations
from motion_backend.formats import write_motion
from motion_backend.motion import Motion
from motion_backend.skeleton import build_skeleton

GLTF = Path(__file__).parents[2] / "gltf"
FRAMES = (0, 7, 21, 39)
SMPL = [
    "pelvis", "left_hip", "right_hip", "spine1", "left_knee", "right_knee", "spine2", "left_ankle",
    "right_ankle", "spine3", "left_foot", "right_foot", "neck", "left_collar", "right_collar", "head",
    "left_shoulder", "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist",
]  # fmt: skip
"""The first 22 joints of SMPL, as its papers and code name and order them."""
needs_three = pytest.mark.skipif(
    shutil.which("node") is None or not (GLTF / "node_modules" / "three").is_dir(),
    reason="three.js is not installed: npm ci in tests/gltf",
)


def standing(frames: int) -> Motion:
    """The rest pose on its feet, the pelvis above the origin."""
    skeleton = build_skeleton()
    return Motion(
        root_positions=np.tile(np.array([0, skeleton.standing_height, 0], dtype=np.float32), (frames, 1)),
        local_rotations=np.tile(rotations.IDENTITY.astype(np.float32), (frames, 22, 1)),
        contacts=np.ones((frames, 4), dtype=np.float32),
        skeleton=skeleton,
        actions=np.zeros(frames, dtype=np.int32),
    )


@pytest.mark.service
@needs_three
@pytest.mark.parametrize(("suffix", "unit"), [("glb", 1.0), ("bvh", 0.01)])
def test_three_js_plays_the_joints_where_the_motion_has_them(suffix: str, unit: float, tmp_path):
    motion = tumbling(40, height=1.8)
    path = write_motion(motion, tmp_path / f"motion.{suffix}")
    times = [str(frame / motion.fps) for frame in FRAMES]
    done = subprocess.run(
        ["node", str(GLTF / "read_with_three.mjs"), str(path), *times],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    theirs = json.loads(done.stdout)
    assert theirs["duration"] == pytest.approx((len(motion) - 1) / motion.fps, abs=1e-5)
    for frame, world in zip(FRAMES, theirs["positions"], strict=True):
        positions = np.array([world[name] for name in motion.skeleton.names]) * unit
        np.testing.assert_allclose(positions, motion.joint_positions()[frame], atol=1e-3)


@pytest.mark.parametrize("height", [1.5, 1.7])
def test_pybvh_finds_the_joints_where_the_motion_has_them(height: float, tmp_path):
    pybvh = pytest.importorskip("pybvh")
    motion = tumbling(6, height=height)
    clip = pybvh.read_bvh_file(str(write_motion(motion, tmp_path / "motion.bvh")))
    theirs, names = np.asarray(clip.joint_positions()), list(clip.joint_names)
    order = [names.index(name) for name in motion.skeleton.names]
    np.testing.assert_allclose(theirs[:, order] * 0.01, motion.joint_positions(), atol=1e-4)


def test_whoever_knows_amass_alone_finds_the_joints_where_the_motion_has_them(tmp_path):
    motion = tumbling(30, height=1.6)
    with np.load(write_motion(motion, tmp_path / "motion.amass.npz"), allow_pickle=False) as data:
        assert float(data["mocap_framerate"]) == motion.fps
        turns = Rotation.from_rotvec(data["poses"].reshape(-1, 3)).as_matrix().reshape(len(motion), -1, 3, 3)
        world: list[np.ndarray] = []
        positions: list[np.ndarray] = []
        for joint, parent in enumerate(data["joint_parents"]):
            world.append(turns[:, joint] if parent < 0 else world[parent] @ turns[:, joint])
            shift = data["joint_offsets"][joint]
            positions.append(data["trans"] if parent < 0 else positions[parent] + world[parent] @ shift)
        z_up = np.stack(positions, axis=1)
        assert data["joint_names"].tolist() == SMPL
    np.testing.assert_allclose(z_up[..., [0, 2, 1]] * [1, 1, -1], motion.joint_positions(), atol=1e-4)


def test_a_body_that_stands_is_upright_and_faces_forward_in_amass(tmp_path):
    motion = standing(4)
    with np.load(write_motion(motion, tmp_path / "motion.amass.npz"), allow_pickle=False) as data:
        np.testing.assert_allclose(
            data["trans"], np.tile([0.0, 0.0, motion.skeleton.standing_height], (4, 1)), atol=1e-6
        )
        # As a capture of AMASS at rest: a quarter turn about x, and nothing else.
        np.testing.assert_allclose(data["poses"][0], [np.pi / 2, *[0.0] * 65], atol=1e-6)
