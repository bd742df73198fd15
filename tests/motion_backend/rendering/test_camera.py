"""Shots show the telling frame, and cameras stand where nothing hides the body."""

from __future__ import annotations

import numpy as np
import pytest
from for_each import for_each

from motion_backend import rotations
from motion_backend.motion import Motion, Skill
from motion_backend.rendering.camera import STRIDE, Shot, choose_camera, choose_frames, visible_share
from motion_backend.rendering.motion_figures import around, home_props
from motion_backend.rendering.rasterizer import orbit
from motion_backend.skeleton import INDEX, build_skeleton
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout, Placed

WARDROBE = Placed("wardrobe", "wardrobe", (2.0, 0.0, 1.0), (1.6, 2.2, 0.6))
ROOM = Layout("room", "bedroom", ((0, 0), (0, 4), (4, 4), (4, 0)), objects=(WARDROBE,))
HOME = home_from_layouts([ROOM], 0)


def moving(roots, turns=None) -> Motion:
    frames = len(roots)
    still = np.tile(rotations.IDENTITY, (frames, 22, 1)) if turns is None else turns
    return Motion(
        np.asarray(roots, dtype=np.float32),
        still.astype(np.float32),
        np.ones((frames, 4), dtype=np.float32),
        build_skeleton(),
        np.zeros(frames, dtype=np.int32),
    )


def choose(motion: Motion, skill: Skill) -> Shot:
    return choose_frames(motion, motion.joint_positions(), 0, len(motion), skill)


def test_a_walk_is_shown_a_stride_apart_around_its_middle():
    motion = moving(np.linspace([0, 0.9, 0], [3, 0.9, 0], 91))
    shot = choose(motion, Skill.LOCO)
    places = motion.root_positions[sorted([shot.frame, *shot.ghosts]), 0]
    assert shot.frame == pytest.approx(45, abs=1)
    np.testing.assert_allclose(np.diff(places), STRIDE, atol=0.04)


def test_standing_around_has_no_ghosts():
    assert choose(moving(np.tile([0, 0.9, 0], (20, 1))), Skill.LOCO).ghosts == ()


@pytest.mark.parametrize(("skill", "down"), [(Skill.SITDOWN, True), (Skill.STANDUP, False)])
def test_a_change_of_posture_shows_its_end_and_two_moments_before(skill: Skill, down: bool):
    height = np.concatenate([np.full(30, 0.9), np.linspace(0.9, 0.5, 30), np.full(40, 0.5)])
    roots = np.stack([np.zeros(100), height if down else height[::-1], np.zeros(100)], axis=1)
    shot = choose(moving(roots), skill)
    assert roots[shot.frame, 1] == (0.5 if down else 0.9)
    assert len(shot.ghosts) == 2
    assert all(0.5 < roots[ghost, 1] < 0.9 for ghost in shot.ghosts)
    assert max(shot.ghosts) < shot.frame


def test_a_touch_is_shown_at_full_reach():
    turns = np.tile(rotations.IDENTITY, (60, 22, 1))
    for joint, sign in (("left_shoulder", -1), ("right_shoulder", 1)):
        turns[:, INDEX[joint]] = rotations.rotvec_to_quat(np.array([0.0, 0.0, sign * 1.4]))
    lifted = rotations.rotvec_to_quat(np.array([0.0, 1.4, 0.0]))
    turns[25:40, INDEX["right_shoulder"]] = lifted
    shot = choose(moving(np.tile([0, 0.9, 0], (60, 1)), turns), Skill.TOUCH)
    assert 25 <= shot.frame < 40


def test_a_wardrobe_hides_what_is_behind_it_and_only_that():
    behind = np.array([[2.0, 1.0, 0.3], [2.0, 1.5, 0.4]])
    assert visible_share([WARDROBE], (2.0, 1.4, 4.0), behind) == 0.0
    assert visible_share([WARDROBE], (2.0, 1.4, 4.0), behind + np.array([0, 0, 2.0])) == 1.0
    assert visible_share([], (2.0, 1.4, 4.0), behind) == 1.0


def test_the_camera_stands_where_the_body_is_seen():
    motion = moving(np.tile([2.0, 0.9, 1.9], (10, 1)))
    joints = motion.joint_positions()
    camera = choose_camera(HOME, motion, joints, Shot(5), 4 / 3)
    assert visible_share(HOME.objects, camera.eye, joints[5].astype(float)) > 0.9


@for_each("turn", [0.0, 0.7, 1.9, 3.5])
def test_no_camera_stands_where_curtains_hang(turn):
    turns = np.tile(rotations.IDENTITY, (10, 22, 1))
    turns[:, 0] = rotations.yaw_to_quat(turn)
    for place in ([0.6, 0.9, 2.6], [3.0, 0.9, 2.0], [3.1, 0.9, 3.0], [1.0, 0.9, 1.8]):
        motion = moving(np.tile(place, (10, 1)), turns)
        eye = np.array(choose_camera(HOME, motion, motion.joint_positions(), Shot(5), 4 / 3).eye)[[0, 2]]
        within = np.minimum(eye, 4.0 - eye).min()
        assert not 0.0 <= within < 0.2


def test_every_joint_of_every_pose_is_in_the_picture():
    motion = moving(np.linspace([0, 0.9, 0], [2, 0.9, 1], 61))
    joints = motion.joint_positions()
    shot = choose(motion, Skill.LOCO)
    camera = choose_camera(None, motion, joints, shot, 4 / 3)
    shown = joints[[shot.frame, *shot.ghosts]].astype(float)
    x, y, near = np.moveaxis(camera.project(camera.view(shown), (320, 240)), -1, 0)
    assert (near > 0).all()
    assert ((x > 0) & (x < 320) & (y > 0) & (y < 240)).all()


def test_a_standing_body_is_seen_from_its_front_side():
    motion = moving(np.tile([0.0, 0.9, 0.0], (10, 1)))
    camera = choose_camera(None, motion, motion.joint_positions(), Shot(5), 4 / 3)
    assert camera.eye[2] > 0.5 * np.hypot(camera.eye[0], camera.eye[2])


def test_an_orbit_keeps_its_distance():
    camera = orbit((1.0, 2.0, 3.0), 4.0, 0.7, 0.4)
    assert np.linalg.norm(np.subtract(camera.eye, camera.target)) == pytest.approx(4.0)


def test_a_lamp_that_hangs_before_a_body_is_left_away_and_one_behind_it_is_not():
    lamp = Placed("lamp", "pendant_lamp", (2.0, 1.4, 1.0), (0.5, 1.2, 0.5))
    home = home_from_layouts([Layout("room", "bedroom", ((0, 0), (0, 4), (4, 4), (4, 0)), objects=(lamp,))], 0)
    x, _, z = home.objects[0].position
    props, body = home_props(home), np.array([[x, 1.5, z + 1.0]])
    hung = {prop.name for prop in props if prop.hung is not None}
    assert len(hung) >= 2, "shade and cord go together"
    for yaw, there in ((0.0, True), (np.pi, False)):
        shown = around(props, orbit((x, 1.5, z + 1.0), 3.0, yaw, 0.0), body)
        assert all(any(prop.solid is solid for solid in shown) is there for prop in props if prop.name in hung)
