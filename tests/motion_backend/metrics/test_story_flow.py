"""What is seen of how one action passes into the next, on stories whose answer is known."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from sample_motions import standing_still

from motion_backend import rotations
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.story_flow import (
    holds,
    seams,
    still_outside_holds,
    touch_waits,
    turning_on_the_spot,
)
from motion_backend.motion import FPS, Action, Emotion, Motion, Phase, PhaseKind, Skill
from motion_backend.skeleton import INDEX
from scene_graphs.affordances.affordances import Spot

WALK = Action(Skill.LOCO, "walk", Emotion.NEUTRAL, goal=(1.0, 0.0), hold=0.0)
STAY = replace(WALK, goal=None)


def going(speeds: list[float]) -> Motion:
    """A body that glides along x at these speeds (m/s), a second each."""
    pace = np.repeat(speeds, FPS)
    return standing_still(root=np.outer(np.cumsum(pace) / FPS, [1.0, 0.0, 0.0]))


def split(motion: Motion, count: int = 2) -> list[tuple[int, int]]:
    edges = np.linspace(0, len(motion), count + 1).astype(int).tolist()
    return list(pairwise(edges))


def test_who_walks_on_across_a_seam_flows_and_who_pauses_near_it_stops() -> None:
    flowing, pausing = Kinematics.of(going([1.2] * 6)), Kinematics.of(going([1.2, 1.2, 0.0, 0.5, 1.2, 1.2]))
    (on,) = seams(flowing, [WALK, WALK], split(flowing.motion))
    assert on.walking
    assert on.speed == pytest.approx(1.2, rel=1e-3)
    assert not on.stops
    (off,) = seams(pausing, [WALK, WALK], split(pausing.motion))
    assert off.stops
    assert off.speed == pytest.approx(0.5, rel=1e-3)


def test_a_seam_is_a_walking_one_only_between_two_walks_that_lead_somewhere() -> None:
    motion = going([1.2, 1.2, 1.2, 0.0, 0.0, 1.2])
    body, spans = Kinematics.of(motion), split(motion, 3)
    sit = Action(Skill.SITDOWN, "sit", Emotion.NEUTRAL)
    assert [one.walking for one in seams(body, [WALK, WALK, WALK], spans)] == [True, True]
    assert [one.walking for one in seams(body, [WALK, STAY, WALK], spans)] == [False, False]
    assert [one.walking for one in seams(body, [WALK, sit, WALK], spans)] == [False, False]
    looking_out = replace(WALK, stands=2.5)
    assert [one.walking for one in seams(body, [WALK, looking_out, WALK], spans)] == [True, False]
    nowhere = Kinematics.of(going([0.5, 0.5, 0.1, 0.1, 0.1, 0.1]))
    assert [one.walking for one in seams(nowhere, [WALK, WALK, WALK], spans)] == [False, False]


def test_standing_still_is_counted_where_nobody_means_to_stay() -> None:
    motion = going([1.2, 0.0, 1.2, 0.0])
    body, spans = Kinematics.of(motion), split(motion)
    assert still_outside_holds(body, [WALK, WALK], spans).value == pytest.approx(0.5, abs=0.02)
    staying = still_outside_holds(body, [WALK, STAY], spans)
    assert staying.part == pytest.approx(FPS, abs=1)
    assert staying.whole == 2 * FPS
    assert holds(body, [WALK, replace(WALK, hold=1.0)], spans)[-FPS:].all()


def test_a_contact_is_held_from_its_first_touch_to_its_last() -> None:
    motion = standing_still(90)
    wrist = Kinematics.of(motion).positions[0, INDEX["right_wrist"]]
    spot = _spot(wrist)
    touch = Action(Skill.TOUCH, "touch", Emotion.NEUTRAL, spot=spot, hold=0.0)
    away = np.linspace(-1, 1, 90)[:, None] * [1.0, 0.0, 0.0]
    passing = Kinematics.of(standing_still(root=away))
    held = np.flatnonzero(holds(passing, [touch], [(0, 90)]))
    # It is within 20 cm of the spot for a fifth of the way there and back.
    assert len(held) == pytest.approx(18, abs=2)
    assert held.mean() == pytest.approx(44.5, abs=1)


def test_who_stands_about_before_a_touch_waits_and_who_reaches_at_once_does_not() -> None:
    touch = Action(Skill.TOUCH, "touch", Emotion.NEUTRAL, spot=_spot(np.array([0.0, 1.0, 0.4])), hold=0.0)
    waits = {}
    for after in (0.0, 1.0):
        motion = _reaching(after)
        body = Kinematics.of(motion)
        (waits[after],) = touch_waits(body, [WALK, touch], [(0, 2 * FPS), (2 * FPS, len(motion))])
    assert waits[0.0] == pytest.approx(0.0, abs=0.1)
    assert waits[1.0] == pytest.approx(1.0, abs=0.1)


def _reaching(after: float) -> Motion:
    """Two seconds of gliding to the origin, standing for so long, and one second in which the right arm goes ahead."""
    way = np.concatenate([np.linspace(-2, 0, 2 * FPS), np.zeros(round(after * FPS) + FPS)])
    motion = standing_still(root=np.outer(way, [0.0, 0.0, 1.0]))
    turn = np.clip((np.arange(len(motion)) / FPS - 2 - after), 0, 1) * np.pi / 2
    local = motion.local_rotations.astype(np.float64)
    local[:, INDEX["right_shoulder"]] = rotations.axis_to_quat("y", turn)
    moved = replace(motion, local_rotations=local.astype(np.float32))
    wrist = Kinematics.of(moved).positions[-1, INDEX["right_wrist"]]
    by = np.array([0.0, 1.0, 0.4]) - wrist
    return replace(moved, root_positions=(moved.root_positions + by).astype(np.float32))


def _spot(point: np.ndarray) -> Spot:
    x, y, z = (float(one) for one in point)
    return Spot("touch", "0/shelf", (x, y, z), (0.0, 1.0, 0.0), 0.0, (x, z), 0.0)


def test_a_turn_on_the_spot_is_all_on_the_spot_and_an_arc_is_not() -> None:
    yaw = np.linspace(0, np.pi, 90)
    around = np.stack([np.sin(yaw), 0 * yaw, np.cos(yaw)], axis=1)
    on_the_spot, arc = _turning(0 * around, yaw), _turning(around, yaw)
    assert turning_on_the_spot(on_the_spot).value == pytest.approx(1.0)
    assert turning_on_the_spot(on_the_spot).whole == pytest.approx(np.pi, rel=0.1)
    assert turning_on_the_spot(arc).value == pytest.approx(0.0, abs=0.02)
    assert turning_on_the_spot(_turning(0 * around, 0 * yaw)).value is None
    lying = replace(on_the_spot.motion, phases=(Phase(PhaseKind.LIEDOWN, 0, 90),))
    assert turning_on_the_spot(Kinematics.of(lying)).value is None


def _turning(place: np.ndarray, yaw: np.ndarray) -> Kinematics:
    motion = standing_still(root=place)
    local = motion.local_rotations.astype(np.float64)
    local[:, 0] = rotations.yaw_to_quat(yaw)
    return Kinematics.of(replace(motion, local_rotations=local.astype(np.float32)))
