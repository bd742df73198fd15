"""The body in MuJoCo: the product's joints and back, what it weighs, and what stands around it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from acted import Body, lain, sat, touched
from simulated import HOME, NOTHING, WALK, empty_room, walk
from small_home import DIRECTOR, after, small_home

from motion_backend.body.scene_collision import Obstacles
from motion_backend.body.segment_masses import centres_of_mass
from motion_backend.body.zero_moment import GRAVITY
from motion_backend.motion import Motion
from motion_backend.physics.contact_forces import ContactReader, root_force
from motion_backend.physics.engine import EngineError, engine, require_version
from motion_backend.physics.generalized_coordinates import fold, unfold
from motion_backend.physics.mjcf_character import NQ, NU, NV, SIMULATED, mass_of
from motion_backend.physics.mjcf_scene import SLOTS, models_of, near_way
from motion_backend.physics.mpc import Controller, moment_of
from motion_backend.physics.reference import Doing, Reference
from motion_backend.physics.task import plan_of
from motion_backend.procedural.lie.lie_on_floor import KNEE
from motion_backend.scene import scene_of
from motion_backend.skeleton import HAND_REST, INDEX

FEET = [INDEX[f"{side}_{joint}"] for side in ("left", "right") for joint in ("ankle", "foot")]
OTHERS = [
    index for name, index in INDEX.items() if "shoulder" not in name and "elbow" not in name and index not in FEET
]


def motions() -> list[Motion]:
    others = (sat("chair", "sitting still"), lain("bed", "lying still"), touched("shelf", "high", "touch high height"))
    return [walk(), *(one.motion for one in others)]


def test_a_plan_becomes_the_simulated_body_and_comes_back() -> None:
    for motion in motions():
        reference = Reference.of(replace(plan_of(motion), contacts=np.ones((len(motion), 4))), motion.skeleton)
        found = motion.skeleton.forward_kinematics(*unfold(reference.qpos, reference.wrists))[0]
        away = np.linalg.norm(found - motion.joint_positions(), axis=-1)
        assert away[:, FEET].max() < 0.001
        assert away[:, OTHERS].max() < 0.01
        # Arms without collars begin elsewhere, and end where they did.
        assert away.max() < 0.05


def test_simulated_joints_are_where_ours_are() -> None:
    motion, mujoco = walk(), engine()
    model = empty_room().fine
    data = mujoco.MjData(model)
    qpos = fold(motion.root_positions, motion.local_rotations)
    places = motion.joint_positions()
    for frame in range(0, len(motion), 20):
        data.qpos[:] = qpos[frame]
        mujoco.mj_kinematics(model, data)
        for side in ("left", "right"):
            for body, joint in (("foot", "ankle"), ("toe", "foot"), ("shin", "knee"), ("hand", "wrist")):
                np.testing.assert_allclose(
                    data.body(f"{side}_{body}").xpos, places[frame, INDEX[f"{side}_{joint}"]], atol=0.001
                )


@pytest.mark.parametrize("height", [1.2, 1.7, 2.0])
def test_a_body_weighs_what_its_segments_do(height: float) -> None:
    model = models_of(height, NOTHING).fine
    assert (model.nq, model.nv, model.nu) == (NQ, NV, NU)
    assert model.body_mass.sum() == pytest.approx(mass_of(height), rel=1e-3)
    for joint in SIMULATED:
        own = model.joint(joint.name)
        assert (own.qposadr[0], own.dofadr[0]) == (joint.qpos, joint.qvel)


def test_the_centre_of_mass_is_that_of_the_kinematic_body() -> None:
    motion, mujoco = walk(), engine()
    model = empty_room().fine
    data = mujoco.MjData(model)
    data.qpos[:] = fold(motion.root_positions, motion.local_rotations)[40]
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    positions, world = motion.skeleton.forward_kinematics(motion.root_positions[40:41], motion.local_rotations[40:41])
    ours = centres_of_mass(motion.skeleton, positions.astype(np.float64), world)[0]
    np.testing.assert_allclose(data.body("pelvis").subtree_com, ours, atol=0.01)


def test_of_many_boxes_the_nearest_are_met_and_none_has_to_have_a_size() -> None:
    rng = np.random.default_rng(0)
    centers = rng.uniform([-2, 0, -2], [2, 1, 2], (500, 3))
    halves = rng.uniform(0, 0.3, (500, 3)) * (rng.random((500, 1)) > 0.2)
    many = Obstacles(centers, halves, rng.uniform(-3, 3, 500), ("box",) * 500, np.zeros(500, dtype=bool))
    way = np.full((4, 2, 3), 0.5)
    near = near_way(way, many)
    assert len(near.owners) == SLOTS
    gaps = [-many.inside(way[0, :1], index)[0] for index in range(500)]
    tops = many.centers[:, 1] + many.halves[:, 1]
    farthest = max(-near.inside(way[0, :1], index)[0] for index in range(SLOTS))
    assert sorted(np.array(gaps)[tops > 0.04])[SLOTS - 1] == pytest.approx(farthest)
    assert models_of(1.7, near).fine.ngeom == empty_room().fine.ngeom


def test_nothing_pushes_the_pelvis() -> None:
    model = empty_room().fine
    # Every actuator drives a joint, and none of them is the free joint of the pelvis.
    assert (model.actuator_trnid[:, 0] != model.joint("root").id).all()
    assert model.nu == NU
    assert not model.neq


@pytest.mark.parametrize("version", ["3.16.4", "3.18.0", "4.17.0", "2.3", "abc", ""])
def test_another_engine_is_refused_with_the_remedy(version: str) -> None:
    with pytest.raises(EngineError, match=r"3\.17 was.*mujoco>=3\.17,<3\.18"):
        require_version(version)
    require_version("3.17.3")


def test_whatever_pushes_the_pelvis_besides_weight_and_contacts_is_seen() -> None:
    mujoco, model = engine(), empty_room().fine
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data)
    assert root_force(data) == 0
    for forces in (data.xfrc_applied[3], data.qfrc_applied):
        forces[1] = 5.0
        mujoco.mj_step(model, data)
        assert root_force(data) == 5
        forces[1] = 0.0


def test_arms_that_swing_through_the_floor_are_led_over_it_and_others_left_alone() -> None:
    motion = walk()
    plan, skeleton = plan_of(motion), motion.skeleton
    arms = [INDEX[f"{side}_{joint}"] for side in ("left", "right") for joint in ("elbow", "wrist")]
    # As if the floor were as high as the hands.
    lowest = skeleton.forward_kinematics(plan.roots, plan.local)[0][:, arms, 1].min()
    low = replace(plan, roots=plan.roots - np.array([0.0, lowest, 0.0]))
    before = skeleton.forward_kinematics(low.roots, low.local)[0][:, arms, 1]
    reference = Reference.of(low, skeleton)
    roots, local = unfold(reference.qpos, reference.wrists)
    after = skeleton.forward_kinematics(roots, local)[0][:, arms, 1]
    assert before.min() < 0.03
    assert after.min() > 0.04
    turned = np.abs(np.diff(reference.qpos[:, 7:], axis=0)).max(axis=0)
    assert turned.max() < 0.3, "an arm jumps"
    high = Reference.of(plan, skeleton)
    np.testing.assert_allclose(high.qpos[:, :3], plan.roots)


def test_knees_and_hands_that_a_plan_bears_on_touch_the_floor_and_are_not_in_it() -> None:
    motion, mujoco, model = lain("floor", "lying still").motion, engine(), empty_room().fine
    data = mujoco.MjData(model)
    places = motion.joint_positions()
    qpos = Reference.of(plan_of(motion), motion.skeleton).qpos
    for side in ("left", "right"):
        for joint, ball, height in (("knee", "knee", KNEE), ("wrist", "hand", HAND_REST)):
            bears = np.flatnonzero(np.abs(places[:, INDEX[f"{side}_{joint}"], 1] - height) < 0.002)
            assert len(bears) > 10
            for frame in bears:
                data.qpos[:] = qpos[frame]
                mujoco.mj_kinematics(model, data)
                own = model.geom(f"{side}_{ball}").id
                # Hands are a little aside where arms reach without their collars.
                assert data.geom_xpos[own, 1] - model.geom_size[own, 0] == pytest.approx(0.0, abs=0.016)


def test_who_kneels_is_followed_as_who_goes_down_and_who_stands_or_sits_on_a_floor_is_not() -> None:
    prays = replace(WALK, goal=None, caption="praying while kneeling, palms together", hold=3.0)
    kneels = DIRECTOR.act(HOME, prays, after(HOME))[0]
    low = kneels.joint_positions()[:, [INDEX["left_knee"], INDEX["right_knee"]], 1].min(axis=1) < 0.1
    does = plan_of(kneels).doing
    assert low.sum() > 10
    assert (does[low] == Doing.GOES_DOWN).all()
    assert does[np.flatnonzero(low)[0] - 5] == Doing.GOES_DOWN, "on the way down"
    first = int(np.flatnonzero(low)[0])
    assert (plan_of(kneels.part(first, first + 5)).doing == Doing.GOES_DOWN).all(), "a few frames"
    for motion in (sat("floor", "sitting still").motion, touched("shelf", "high", "touch high height").motion, walk()):
        assert Doing.GOES_DOWN not in plan_of(motion).doing


@pytest.mark.parametrize(
    ("rests", "caption", "under"), [(sat, "sitting still", "chair"), (lain, "lying still", "bed")], ids=["sits", "lies"]
)
def test_what_rests_stays_where_it_is_planned_and_presses_with_its_weight_on_what_is_under_it(
    rests: Callable[[str, str], Body], caption: str, under: str
) -> None:
    resting = rests(under, caption)
    # Its servos alone hold it as the plan ends.
    frames, skeleton = 75, resting.motion.skeleton
    plan = plan_of(resting.motion).last(frames + 1)
    joints = skeleton.forward_kinematics(plan.roots[:1], plan.local[:1])[0].astype(np.float64)
    boxes = near_way(joints, scene_of(small_home()).obstacles)
    models, reference = models_of(1.70, boxes), Reference.of(plan, skeleton)
    reader = ContactReader.of(models.fine, skeleton.scale)
    controller = Controller(models, engine().MjData(models.fine), reference, reader)
    moments, pressures = controller.play(moment_of(reference, 0), 0, np.zeros((frames, NU)))
    sunk = reference.qpos[0, 1] - moments[-1].state.qpos[1]
    assert abs(sunk) < 0.025, "the pelvis is lower or higher than planned"
    things, floor = (sum(getattr(one, name) for one in pressures[-15:]) / 15 for name in ("things", "floor"))
    weight = mass_of(1.70) * GRAVITY
    assert (things + floor).sum() == pytest.approx(weight, rel=0.05)
    assert things.sum() > 0.7 * weight
    assert np.mean([one.up[0] for one in pressures[-15:]]) == pytest.approx(weight, rel=0.05)
