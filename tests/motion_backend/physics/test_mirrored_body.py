"""What a simulated body does and sees in the mirror: the same, with its sides swapped."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from policy_episodes import episode
from simulated import empty_room

from motion_backend.physics.contact_forces import ContactReader
from motion_backend.physics.engine import engine
from motion_backend.physics.generalized_coordinates import fold, unfold
from motion_backend.physics.linear_model import State
from motion_backend.physics.mirrored_body import CONTROLS, OFF, PLAN, SPEEDS, mirrored_observation
from motion_backend.physics.mjcf_character import NU
from motion_backend.physics.mpc import Controller, Moment
from motion_backend.physics.policies import PLAN_SIZE, PolicyName
from motion_backend.physics.policy_view import View
from motion_backend.physics.reference import Reference
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, JOINTS, other_side

FRAMES = 8
ACROSS, TURNED = np.array([-1.0, 1.0, 1.0]), np.array([1.0, -1.0, -1.0, 1.0])
SWAPPED = [INDEX[other_side(name)] for name in JOINTS]


def in_mirror(qpos: Array, wrists: Array) -> Array:
    """Positions (T, 45) of the body in the mirror x = 0, by way of its joints."""
    roots, local = unfold(qpos, wrists)
    return np.asarray(fold(roots * ACROSS, local[:, SWAPPED] * TURNED))


def mirrored_view(view: View) -> View:
    """The plan in the mirror, among nothing that is seen."""
    plan = view.task.reference
    other = Reference(
        in_mirror(plan.qpos, plan.wrists), SPEEDS(plan.qvel), CONTROLS(plan.controls), plan.planted[:, [2, 3, 0, 1]],
        plan.wrists[:, ::-1] * TURNED, plan.doing,
    )  # fmt: skip
    task = replace(view.task)
    task.__dict__["reference"] = other
    hands = np.arange(15)
    swapped = np.array([0, 1, 2, *(hands[3:].reshape(-1, 2)[:, ::-1].ravel())])
    return replace(view, task=task, places=(view.places * ACROSS)[swapped], mask=view.mask[swapped])


@pytest.mark.parametrize("mirror", [SPEEDS, CONTROLS, OFF, PLAN])
def test_a_mirror_in_a_mirror_shows_what_there_is(mirror: object) -> None:
    rows = np.random.default_rng(0).normal(size=(3, len(mirror.order)))  # type: ignore[attr-defined]
    assert not np.array_equal(mirror(rows), rows)  # type: ignore[operator]
    np.testing.assert_array_equal(mirror(mirror(rows)), rows)  # type: ignore[operator]


def test_answers_in_the_mirror_answer_to_what_is_seen_there() -> None:
    rng = np.random.default_rng(1)
    answer, off = rng.normal(size=(NU, len(OFF.order))), rng.normal(size=len(OFF.order))
    np.testing.assert_allclose(CONTROLS.answers(answer, OFF) @ OFF(off), CONTROLS(answer @ off), atol=1e-12)


def test_a_body_in_the_mirror_moves_as_its_image_does() -> None:
    plan = episode(FRAMES).view.task.reference.part(slice(0, FRAMES + 1))
    models = empty_room()
    image_plan = in_mirror(plan.qpos, plan.wrists), SPEEDS(plan.qvel), CONTROLS(plan.controls)
    ends = []
    for qpos, qvel, controls in ((plan.qpos, plan.qvel, plan.controls), image_plan):
        own = replace(plan, qpos=qpos, qvel=qvel, controls=controls)
        player = Controller(models, engine().MjData(models.fine), own, ContactReader.of(models.fine, 1.0))
        start = Moment(State(qpos[0].copy(), qvel[0].copy()), np.zeros(qvel.shape[1]), controls[0])
        moments, _ = player.play(start, 0, np.zeros((FRAMES, NU)))
        ends.append(moments[-1].state)
    there, image = ends[1], in_mirror(ends[0].qpos[None], plan.wrists[-1:])[0]
    np.testing.assert_allclose(there.qpos, image, atol=1e-5)
    np.testing.assert_allclose(there.qvel, SPEEDS(ends[0].qvel), atol=1e-3)


def test_a_body_in_the_mirror_sees_what_its_image_sees() -> None:
    view = replace(episode(FRAMES).view, target=None, z=np.zeros(0))
    other, plan, frames = mirrored_view(view), view.task.reference, np.arange(FRAMES)
    rng = np.random.default_rng(2)
    qpos, qvel = plan.qpos[frames + 1], plan.qvel[frames] + rng.normal(0, 0.1, (FRAMES, plan.qvel.shape[1]))
    held = plan.controls[frames] + rng.normal(0, 0.1, (FRAMES, NU))
    seen = view.observe(qpos, qvel, held, frames)
    there = other.observe(in_mirror(qpos, plan.wrists[frames]), SPEEDS(qvel), CONTROLS(held), frames)
    np.testing.assert_allclose(mirrored_observation(seen, PolicyName.REACH), there, atol=1e-6)


def test_heights_of_a_target_on_the_left_are_seen_on_the_right_in_the_mirror() -> None:
    size = 25
    seen = np.zeros((1, 217 + NU + PLAN_SIZE + size * size + 60))
    heights = seen[0, 217 + NU + PLAN_SIZE :][: size * size].reshape(size, size)
    heights[20, 3] = 1.0
    there = mirrored_observation(seen, PolicyName.REACH)[0, 217 + NU + PLAN_SIZE :][: size * size].reshape(size, size)
    assert there[4, 3] == 1.0
    assert there.sum() == 1.0
