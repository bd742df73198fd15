"""Where one runs: along the longest straight way of a room, and round to a place that is near."""

from __future__ import annotations

import numpy as np
import pytest

from motion_backend.motion import Action, Emotion, Skill
from motion_backend.scene import scene_of
from planner_service.evaluation.walk_evaluation import hall
from planner_service.grounding.keyframes_to_actions import Place, act
from planner_service.grounding.running_places import LONG_ENOUGH, runs, way_to_run
from planner_service.scripts.script import Keyframe

HOME = hall()
WALKABLE = scene_of(HOME).walkable
MIDDLE = (8.0, 2.0)


@pytest.mark.parametrize("seed", range(4))
def test_a_run_to_nowhere_has_a_straight_way_on_which_one_gets_up_to_speed(seed: int) -> None:
    found = way_to_run(WALKABLE, MIDDLE, 0, np.random.default_rng(seed))
    assert found is not None
    assert found.straight >= LONG_ENOUGH
    stops = [MIDDLE, *([found.by] if found.by else []), found.goal]
    assert max(WALKABLE.straight(np.array(stops), np.array(stops)).diagonal(1)) >= LONG_ENOUGH


def test_a_place_that_is_near_is_run_to_by_a_place_that_is_farther_and_one_that_is_far_straight() -> None:
    rng = np.random.default_rng(0)
    near = way_to_run(WALKABLE, MIDDLE, 0, rng, (8.5, 2.0))
    far = way_to_run(WALKABLE, MIDDLE, 0, rng, (14.0, 2.0))
    assert near is not None
    assert far is not None
    assert near.by is not None
    assert near.goal == (8.5, 2.0)
    assert near.straight >= LONG_ENOUGH
    assert far.by is None


def test_a_keyframe_that_runs_goes_farther_than_one_that_walks() -> None:
    def length(caption: str) -> float:
        keyframe = Keyframe(skill=Skill.LOCO, emotion="neutral", caption=caption, furniture="floor")
        [action] = act([keyframe], [Place(0)], HOME, 3)
        assert action.goal is not None
        legs = [scene_of(HOME).beginning(3)[0], *([action.by] if action.by else []), action.goal]
        return float(np.linalg.norm(np.diff(np.array(legs), axis=0), axis=1).max())

    assert length("run") >= LONG_ENOUGH > 0.0


@pytest.mark.parametrize(("caption", "says"), [("run", True), ("jog", True), ("dash", True), ("walk quickly", False)])
def test_words_say_what_is_a_run(caption: str, says: bool) -> None:
    assert runs(Action(Skill.LOCO, caption, Emotion.NEUTRAL)) == says


def test_straight_lines_are_as_long_as_they_are_and_none_goes_through_a_wall() -> None:
    found = WALKABLE.straight(np.array([MIDDLE]), np.array([(11.0, 2.0), (40.0, 2.0)]))
    assert found[0] == pytest.approx([3.0, 0.0])
