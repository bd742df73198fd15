from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest
from encoded import encoded

from motion_backend.backend_protocol import BodyState
from motion_backend.director import Director
from motion_backend.motion import Character, Emotion
from planner_service.grounding.keyframes_to_actions import act
from planner_service.jobs import serialization
from planner_service.library.library import Shelves
from planner_service.narration.told import Told
from planner_service.pipeline import Pipeline, Planned, StoryRequest, request_from_dict, request_to_dict
from planner_service.scripts.script import Keyframe

REQUEST = StoryRequest(
    "A woman comes home tired, reads a book on the sofa and falls asleep.",
    seed=3,
    rooms=("living_room", "bedroom"),
    character=Character("Ada", "she", 1.62),
)


@pytest.fixture(scope="module")
def planned() -> Planned:
    return Pipeline(Shelves(cache=encoded())).plan(REQUEST)


def through_json(value: dict[str, Any]) -> dict[str, Any]:
    again: dict[str, Any] = json.loads(json.dumps(value, allow_nan=False))
    return again


def test_a_request_comes_back_as_it_was(planned: Planned) -> None:
    layouts = tuple(room.layout for room in planned.home.rooms)
    own = tuple(
        Keyframe(**keyframe.model_dump(include=set(Keyframe.model_fields))) for keyframe in planned.script.keyframes
    )
    for request in (
        REQUEST,
        replace(REQUEST, rooms=(), layouts=layouts),
        replace(REQUEST, home=planned.home, keyframes=own),
    ):
        assert request_from_dict(through_json(request_to_dict(request))) == request


def test_a_furnished_script_comes_back_as_it_was(planned: Planned) -> None:
    again = serialization.furnished_from_dict(through_json(serialization.furnished_to_dict(planned.stage)))
    assert replace(again, graphs={}) == replace(planned.stage, graphs={})
    assert again.home == planned.home
    assert again.names == planned.stage.names
    assert {room: (set(g), set(map(frozenset, g.edges))) for room, g in again.graphs.items()} == {
        room: (set(g), set(map(frozenset, g.edges))) for room, g in planned.stage.graphs.items()
    }


def test_a_told_story_comes_back_as_it_was(planned: Planned) -> None:
    assert Told.from_dict(through_json(planned.told.to_dict())) == planned.told


def test_a_body_goes_on_from_json_exactly_as_from_memory(planned: Planned) -> None:
    """Actions and states through JSON give the same bytes of motion: what a resumed story rests on."""
    actions = act(planned.script.keyframes, planned.stage.places, planned.home, REQUEST.seed)
    again = tuple(
        serialization.action_from_dict(through_json(serialization.action_to_dict(action))) for action in actions
    )
    assert again == actions
    assert {type(action.emotion) for action in again} == {Emotion}
    director, resumed = Director.of("procedural"), Director.of("procedural")
    home = serialization.furnished_from_dict(through_json(serialization.furnished_to_dict(planned.stage))).home
    state = director.begin(planned.home, REQUEST.character, REQUEST.seed)
    stored = through_json(state.to_dict())
    # Ways, something done and what comes after it: what follows is the same again.
    for action, read in zip(actions[:5], again[:5], strict=True):
        motion, state = director.act(planned.home, action, state)
        other, after = resumed.act(home, read, BodyState.from_dict(stored))
        stored = through_json(after.to_dict())
        assert stored == through_json(state.to_dict())
        assert other.local_rotations.tobytes() == motion.local_rotations.tobytes()
        assert other.root_positions.tobytes() == motion.root_positions.tobytes()
