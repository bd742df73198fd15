"""Motion to features and back, for bodies anywhere and of any size; frames in between."""

from __future__ import annotations

import numpy as np
import pytest
from sample_motions import tumbling

from motion_backend import rotations
from motion_backend.diffusion.motion_features import (
    CONTACTS,
    FEATURES,
    PLACES,
    ROOT,
    HeadingFrame,
    Poses,
    from_features,
    six_to_quat,
    smoothly_joined,
    thinned,
    to_features,
    twist,
)

AWAY = np.array([3.0, 0.0, -8.0])


@pytest.mark.parametrize("height", [1.4, 1.7, 2.0])
def test_features_and_back_is_the_same_motion(height: float) -> None:
    motion = tumbling(48, height=height)
    poses = thinned(motion)
    frame = HeadingFrame.of(poses, motion.skeleton.scale)
    found = from_features(to_features(poses, frame, motion.skeleton), frame)
    assert np.allclose(found.roots, poses.roots, atol=1e-6)
    assert np.allclose(found.contacts, poses.contacts)
    turned = rotations.compose(rotations.inverse(found.local), poses.local)
    assert np.abs(rotations.quat_to_rotvec(turned)).max() < 1e-5


def test_features_do_not_tell_where_in_the_world_a_body_is_nor_how_tall() -> None:
    motion = tumbling(48)
    poses = thinned(motion)
    features = to_features(poses, HeadingFrame.of(poses), motion.skeleton)
    assert features.shape == (16, FEATURES)
    yaw = rotations.yaw_to_quat(2.5)
    local = poses.local.copy()
    local[:, 0] = rotations.compose(yaw, local[:, 0])
    elsewhere = Poses(rotations.rotate(yaw, poses.roots) + AWAY, local, poses.contacts)
    assert np.allclose(to_features(elsewhere, HeadingFrame.of(elsewhere), motion.skeleton), features, atol=1e-5)
    tall = tumbling(48, height=2.04)
    larger = Poses(poses.roots * 1.2, poses.local, poses.contacts)
    assert np.allclose(to_features(larger, HeadingFrame.of(larger, 1.2), tall.skeleton), features, atol=1e-5)


def test_the_last_known_frame_is_the_origin() -> None:
    motion = tumbling(48)
    poses = thinned(motion)
    features = to_features(poses, HeadingFrame.of(poses), motion.skeleton)
    assert np.allclose(features[1, ROOT], [0.0, poses.roots[1, 1], 0.0], atol=1e-9)
    assert twist(six_to_quat(features[1, 3:9])) == pytest.approx(0.0, abs=1e-6)
    places = motion.skeleton.forward_kinematics(poses.roots, poses.local)[0]
    assert np.allclose(features[:, PLACES].reshape(16, 21, 3)[..., 1], places[:, 1:, 1], atol=1e-5)
    assert np.array_equal(features[:, CONTACTS], poses.contacts)


def test_a_body_on_its_back_has_the_heading_it_lay_down_with() -> None:
    back = rotations.rotvec_to_quat(np.array([-np.pi / 2, 0.0, 0.0]))
    for yaw in (-2.0, 0.3, 3.0):
        assert twist(rotations.compose(rotations.yaw_to_quat(yaw), back)) == pytest.approx(yaw)


def test_rotations_are_made_of_any_two_columns() -> None:
    found = six_to_quat(np.random.default_rng(0).normal(size=(20, 6)))
    assert np.allclose(np.linalg.norm(found, axis=-1), 1)


def test_thirty_frames_go_through_ten_and_are_smooth_in_velocity() -> None:
    times = np.arange(91) / 30
    way = np.stack([np.sin(5 * times), np.cos(4 * times), times], axis=1)
    motion = tumbling(91)
    found = smoothly_joined(Poses(way[::3], thinned(motion).local, thinned(motion).contacts))
    assert len(found) == 91
    assert np.allclose(found.roots[::3], way[::3], atol=1e-9)
    assert np.abs(found.roots - way)[6:-6].max() < 0.003
    straight = np.stack([np.interp(np.arange(91) / 3, np.arange(31), way[::3, axis]) for axis in range(3)], 1)
    jerk = [np.abs(np.diff(roots, 3, axis=0))[6:-6].mean() for roots in (found.roots, straight)]
    assert jerk[0] < 0.5 * jerk[1]
