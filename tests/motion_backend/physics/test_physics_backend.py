"""The physics backend behind the director: parts in one simulation, what it remembers, and what it answers when it
cannot."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from simulated import HOME, WALK, standing_still
from small_home import DIRECTOR, after, contact, rise, to

from motion_backend.backend_protocol import BodyState, Part
from motion_backend.director import Director, segments_of, shares
from motion_backend.formats.motion_json import dict_to_motion, motion_to_dict
from motion_backend.metrics.contact_error import outcome
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Motion, Skill, join
from motion_backend.physics.backend import PhysicsBackend
from motion_backend.physics.contact_forces import Pressure
from motion_backend.physics.physics_options import Mode, PhysicsOptions, give_physics
from motion_backend.physics.physics_record import physics_of, weight_error
from motion_backend.procedural.backend import ProceduralBackend
from scene_graphs.home import Home

FRAMES = 6
"""More than one window of them, and hardly more."""


class Brief(ProceduralBackend):
    """Plans the first frames of everything."""

    def advance(self, home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> tuple[Motion, BodyState]:
        motion, after = super().advance(home, part, upcoming, state)
        return motion.part(0, FRAMES), after


def brief(between: Callable[[], None] = lambda: None) -> PhysicsBackend:
    backend = PhysicsBackend(between=between)
    backend._planner = Brief()
    return backend


def stood(backend: PhysicsBackend, state: BodyState) -> tuple[Motion, BodyState]:
    return backend.advance(HOME, standing_still(0.3)[0], (), state)


def test_a_part_goes_on_where_the_simulation_was_left_also_after_json() -> None:
    backend, (_, state) = brief(), standing_still(0.3)
    motion, left = stood(backend, state)
    again = BodyState.from_dict(json.loads(json.dumps(left.to_dict())))
    on, _ = stood(backend, left)
    same, _ = stood(brief(), again)
    np.testing.assert_array_equal(on.root_positions, same.root_positions)
    assert np.linalg.norm(on.root_positions[0] - motion.root_positions[-1]) < 0.01
    assert [one.mode for one in on.simulated] == ["mpc"]
    report = physics_of(join([motion, on]))
    assert report is not None
    assert report["root_force_newtons"] == 0
    assert {force["body"] for force in report["keyframes"][0]["forces"]} == {"left_foot", "right_foot"}
    assert dict_to_motion(motion_to_dict(on)).simulated == on.simulated


def test_in_mode_policy_it_says_who_moved_the_body_and_why(tmp_path: Path) -> None:
    give_physics(PhysicsOptions(mode=Mode.POLICY, policies=tmp_path))
    try:
        backend = brief()
    finally:
        give_physics(PhysicsOptions())
    motion, _ = stood(backend, after(HOME))
    report = physics_of(motion)
    assert report is not None
    assert report["mode"] == "mpc"
    (row,) = report["keyframes"]
    assert row["no_policy"] == ["there is no policy for it"]
    assert row["modes"] == {"mpc": pytest.approx(FRAMES / 30, abs=0.01)}


def test_the_budget_of_a_story_is_that_of_the_process() -> None:
    give_physics(PhysicsOptions(seconds=12.0))
    try:
        assert PhysicsBackend().budget == 12.0
    finally:
        give_physics(PhysicsOptions())


def test_a_body_that_another_backend_left_is_taken_up() -> None:
    state = after(HOME)
    moved = replace(state, backend="ghost", memory={"anything": [1, 2]})
    motion, left = stood(brief(), moved)
    assert motion.completed
    assert left.backend == "physics"
    assert np.linalg.norm(motion.root_positions[0] - state.history.root_positions[-1]) < 0.02


def test_when_time_is_over_the_body_is_kinematic_from_here_on_and_says_why() -> None:
    director = Director(PhysicsBackend(budget=0.0), ProceduralBackend())
    motion, _ = director.act(HOME, WALK, after(HOME))
    (segment,) = segments_of(motion)
    assert segment.backend == "procedural"
    assert segment.fallback == "kinematic from here on, because 0 s of simulating are over"
    assert motion.completed
    assert physics_of(motion) is None


def test_whoever_cancels_is_heard_between_two_windows() -> None:
    class StoppedError(Exception):
        pass

    asked = []

    def between() -> None:
        asked.append(True)
        if len(asked) == 2:
            raise StoppedError

    with pytest.raises(StoppedError):
        stood(brief(between), after(HOME))
    assert len(asked) == 2


def test_a_plan_that_teleports_is_left_to_the_kinematic_body(monkeypatch: pytest.MonkeyPatch) -> None:
    backend = PhysicsBackend()
    plain = backend._planner.advance

    def teleports(*asked: object) -> tuple[Motion, BodyState]:
        motion, state = plain(*asked)  # type: ignore[arg-type]
        roots = motion.root_positions.copy()
        roots[5:] += 3.0
        return replace(motion, root_positions=roots), state

    monkeypatch.setattr(backend._planner, "advance", teleports)
    motion, _ = Director(backend, ProceduralBackend()).act(HOME, WALK, after(HOME))
    assert "the plan jumps after 0.2 s" in (segments_of(motion)[0].fallback or "")


def test_who_is_too_tall_to_be_simulated_is_kinematic() -> None:
    motion, _ = Director(PhysicsBackend(), ProceduralBackend()).act(HOME, WALK, after(HOME, height=2.1))
    assert segments_of(motion)[0].fallback == "a simulated body is at most 2.0 m tall"


@pytest.mark.sweep
def test_sitting_down_and_standing_up_are_one_simulation() -> None:
    sit = contact(HOME, Skill.SITDOWN, "chair", "sitting still")
    director = Director(PhysicsBackend(), ProceduralBackend())
    state, motions = after(HOME, to(sit)), []
    for action in (sit, rise(sit)):
        motion, state = director.act(HOME, action, state)
        assert shares(motion) == {"physics": 1.0}
        assert outcome(action, Kinematics.of(motion)).reached
        assert not any(one.resets for one in motion.simulated)
        motions.append(motion)
    jump = np.linalg.norm(motions[1].root_positions[0] - motions[0].root_positions[-1])
    assert jump < 0.02
    on_things = {force.body for one in motions[0].simulated for force in one.forces if force.on == "things"}
    assert on_things & {"pelvis", "left_thigh", "right_thigh"}


@pytest.mark.sweep
def test_every_skill_of_the_small_home_is_done() -> None:
    lie = contact(HOME, Skill.LIEDOWN, "bed", "lying still")
    touch = contact(HOME, Skill.TOUCH, "shelf", "touch high height", which=2)
    director = Director(PhysicsBackend(), DIRECTOR.backend)
    for actions in ((lie, rise(lie, Skill.GETUP)), (touch,)):
        state = after(HOME, to(actions[0]))
        for action in actions:
            motion, state = director.act(HOME, action, state)
            assert outcome(action, Kinematics.of(motion)).reached
            assert not any(one.resets for one in motion.simulated)


def test_what_carries_a_body_is_held_against_its_weight_where_it_rests() -> None:
    speeds, frames = np.full(120, 0.2), range(120)
    pressures = [Pressure(up=np.array([660.0 if at % 2 else 740.0])) for at in frames]
    assert weight_error(pressures, speeds, 700.0) is None
    speeds[40:100] = 0.01
    assert weight_error(pressures, speeds, 700.0) == pytest.approx(40 / 700, abs=1e-4)
    # Half a second within what is slow; what is felt outside of it counts for nothing.
    for at in (*range(55), *range(85, 120)):
        pressures[at].up[0] = 0.0
    assert weight_error(pressures, speeds, 700.0) == pytest.approx(40 / 700, abs=1e-4)
    pressures[55].up[0] = 0.0
    assert weight_error(pressures, speeds, 700.0) == pytest.approx((1 + 29 * 40 / 700) / 30, abs=1e-4)
