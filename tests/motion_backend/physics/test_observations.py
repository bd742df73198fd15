"""What a policy sees is told in the body's own frame, and is what is there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_motions import standing_still, tumbling
from small_home import contact, rise, small_home, to

from motion_backend import rotations
from motion_backend.body.capsules import BODIES
from motion_backend.contact_goals import contact_goals
from motion_backend.mocap.augmentation import mirror
from motion_backend.motion import Action, Emotion, Motion, Skill
from motion_backend.physics.observations import (
    GOAL_BODIES,
    GOAL_SIZE,
    NEAR,
    STATE_FLOOR,
    STATE_SIZE,
    BodyMoment,
    away_from,
    goal,
    goal_places,
    heightmap,
    leaning_of,
    mirror_state,
    moments_of,
    state,
)
from motion_backend.rotations import Array
from motion_backend.scene import scene_of
from motion_backend.skeleton import INDEX, build_skeleton

NAMES = [body.name for body in BODIES]
SCENE = scene_of(small_home())


def moved(motion: Motion, yaw: float, by: Array) -> Motion:
    """The same motion elsewhere on the floor, heading elsewhere."""
    turn = rotations.yaw_to_quat(yaw)
    turns = motion.local_rotations.astype(np.float64)
    turns[:, 0] = rotations.compose(turn, turns[:, 0])
    roots = rotations.rotate(turn, motion.root_positions.astype(np.float64)) + by
    return replace(motion, root_positions=roots.astype(np.float32), local_rotations=turns.astype(np.float32))


def standing_at(x: float, z: float, yaw: float = 0.0) -> BodyMoment:
    still = standing_still(2)
    return moments_of(moved(still, yaw, np.array([x, 0.0, z])))


def test_the_state_does_not_change_with_place_and_heading() -> None:
    motion = tumbling()
    here, there = state(moments_of(motion)), state(moments_of(moved(motion, 2.1, np.array([3.0, 0.0, -1.0]))))
    assert here.shape == (40, STATE_SIZE)
    assert STATE_FLOOR.shape == (STATE_SIZE,)
    np.testing.assert_allclose(here, there, atol=2e-3)


def test_the_state_of_the_mirrored_body_is_the_mirrored_state() -> None:
    motion = tumbling(seed=4)
    np.testing.assert_allclose(state(moments_of(mirror(motion))), mirror_state(state(moments_of(motion))), atol=1e-3)
    np.testing.assert_array_equal(mirror_state(mirror_state(state(moments_of(motion)))), state(moments_of(motion)))


def test_a_body_that_walks_ahead_has_its_speed_along_its_heading() -> None:
    way = np.linspace(0, 1, 31)[:, None] * [1.5, 0.0, 0.0]
    motion = standing_still(root=way)
    turned = moved(motion, np.pi / 2, np.zeros(3))  # it faces +X and moves along -Z: to its left
    told = state(moments_of(turned))[3]
    np.testing.assert_allclose(told[7:10], [1.5, 0.0, 0.0], atol=1e-3)
    assert told[0] == pytest.approx(motion.root_positions[0, 1])


def test_spins_are_those_of_the_joints() -> None:
    motion = standing_still(10)
    angle = np.arange(10)[:, None] * np.array([0.0, 0.0, 0.05])
    turns = motion.local_rotations.astype(np.float64)
    turns[:, INDEX["left_elbow"]] = rotations.rotvec_to_quat(angle)
    moment = moments_of(replace(motion, local_rotations=turns.astype(np.float32)))
    np.testing.assert_allclose(moment.spins[:, INDEX["left_elbow"]], np.tile([0.0, 0.0, 1.5], (10, 1)), atol=1e-3)


def test_bodies_of_every_size_are_told_alike() -> None:
    tall, small = (state(moments_of(standing_still(2, height=height))) for height in (1.9, 1.3))
    np.testing.assert_allclose(tall, small, atol=1e-5)


def test_one_frame_stands_still() -> None:
    assert not moments_of(tumbling(1)).velocity.any()


def test_the_heightmap_is_the_target_alone_in_the_heading_frame() -> None:
    bed = small_home().object("0/bed")
    moment = standing_at(1.2, 3.0, np.pi)  # a metre and a half off, looking at the bed
    seen = heightmap(SCENE, "0/bed", moment)[0] + moment.root[0, 1]
    assert seen.shape == (25, 25)
    assert seen[12, -1] > 0.3, "the bed is straight ahead"
    assert not seen[:, :12].any(), "and nothing is behind"
    assert seen.max() <= bed.size[1] + 1e-5
    assert not (heightmap(SCENE, "0/shelf", moment)[0] + moment.root[0, 1]).any()


def test_a_target_that_is_far_is_not_seen() -> None:
    bed = small_home().object("0/bed")
    near, far = standing_at(1.2, 1.2 + 1.1 + NEAR - 0.01), standing_at(1.2, 1.2 + 1.1 + NEAR + 0.01)
    assert away_from(bed, near.root)[0] == pytest.approx(NEAR - 0.01)
    np.testing.assert_array_equal(heightmap(SCENE, "0/bed", far), np.full((2, 25, 25), -far.root[0, 1]))
    np.testing.assert_array_equal(heightmap(SCENE, None, near), heightmap(SCENE, "0/bed", far))
    both = BodyMoment(
        np.concatenate([near.positions, far.positions]),
        np.concatenate([near.world, far.world]),
        np.concatenate([near.local, far.local]),
        np.concatenate([near.velocity, far.velocity]),
        np.concatenate([near.spins, far.spins]),
    )
    np.testing.assert_array_equal(heightmap(SCENE, "0/bed", both)[0], heightmap(SCENE, "0/bed", near)[0])


def test_every_skill_uses_the_contacts_of_the_paper() -> None:
    sit, touch = (
        contact(small_home(), Skill.SITDOWN, "chair", "sitting still"),
        contact(small_home(), Skill.TOUCH, "shelf", "touch medium height"),
    )
    expected = {to(sit): ["pelvis"], sit: ["pelvis"], rise(sit): ["pelvis"], touch: ["right_hand"]}
    for action, bodies in expected.items():
        _, mask = goal_places(action, build_skeleton())
        assert [NAMES[row] for row in np.flatnonzero(mask)] == bodies
    assert set(GOAL_BODIES) == set(Skill)


def test_walks_and_rises_bring_the_pelvis_to_standing_height() -> None:
    skeleton = build_skeleton()
    walk = Action(Skill.LOCO, "walk", Emotion.NEUTRAL, goal=(2.0, 3.0))
    places, _ = goal_places(walk, skeleton)
    np.testing.assert_allclose(places[0], [2.0, skeleton.standing_height, 3.0])
    sit = contact(small_home(), Skill.SITDOWN, "chair", "sitting still")
    assert sit.spot is not None
    assert goal_places(rise(sit), skeleton)[0][0] == pytest.approx(
        [sit.spot.standing[0], skeleton.standing_height, sit.spot.standing[1]]
    )
    np.testing.assert_allclose(goal_places(sit, skeleton)[0][0], contact_goals(sit)[0].position)


def test_goals_are_told_from_the_pelvis_in_the_heading_frame() -> None:
    moment = standing_at(1.0, 1.0, np.pi / 2)
    places, mask = np.zeros((15, 3)), np.zeros(15, dtype=bool)
    places[NAMES.index("left_hand")], mask[NAMES.index("left_hand")] = moment.root[0] + [2.0, 0.1, 0.0], True
    told = goal(places, mask, moment)
    assert told.shape == (2, GOAL_SIZE)
    row = 3 * NAMES.index("left_hand")
    np.testing.assert_allclose(told[0, row : row + 3], [0.0, 0.1, 2.0], atol=1e-6)
    assert np.count_nonzero(told[0, :45].round(6)) == 2
    assert told[0, 45:].sum() == 1


def test_a_hand_that_leans_on_furniture_in_a_plan_becomes_a_goal() -> None:
    side_of_shelf, hand = 3.2 - 0.9 / 2, 0.80  # a T-pose has the middle of its left hand 0.80 m to its left
    leans, free = (
        moved(standing_still(5), 0.0, np.array([side_of_shelf - hand - gap, 0.0, 0.2])) for gap in (0.03, 0.10)
    )
    (one,) = leaning_of(leans, SCENE.obstacles)
    assert one.joint == "left_wrist"
    assert leaning_of(free, SCENE.obstacles) == ()
    sit = contact(small_home(), Skill.SITDOWN, "chair", "sitting still")
    places, mask = goal_places(sit, leans.skeleton, [one])
    assert [NAMES[row] for row in np.flatnonzero(mask)] == ["pelvis", "left_hand"]
    np.testing.assert_allclose(places[NAMES.index("left_hand")], one.position)
    walk = Action(Skill.LOCO, "walk", Emotion.NEUTRAL, goal=(2.0, 3.0))
    assert goal_places(walk, leans.skeleton, [one])[1].sum() == 1, "a walk leans on nothing"
