"""A language model drives planning and telling through the whole house; one that talks nonsense is done without."""

from __future__ import annotations

from typing import Any

import pytest
from encoded import encoded
from for_each import for_each
from good_model import EVENTS, TEXT, THEME, answer_to, chosen_in, told_in
from pydantic import BaseModel

from motion_backend.motion import Character
from planner_service.library.library import Shelves
from planner_service.llm.fake_model import Answer, ScriptedModel
from planner_service.llm.protocol import ModelError
from planner_service.output.story_export import report_to_dict, story_to_dict, story_to_markdown
from planner_service.pipeline import Pipeline, Planned, StoryRequest


def answer_well(prompt: str, _schema: type[BaseModel]) -> Answer:
    """As a good model does."""
    return answer_to(prompt)


def plan(model: ScriptedModel, shelves: Shelves, **asked: Any) -> Planned:
    return Pipeline(shelves, model=model).plan(StoryRequest(THEME, **asked))


@pytest.fixture(scope="module")
def shelves() -> Shelves:
    return Shelves(cache=encoded())


@pytest.fixture(scope="module")
def by_rules(shelves: Shelves) -> Planned:
    return Pipeline(shelves).plan(StoryRequest(THEME))


def test_a_model_finds_the_events_arranges_the_scripts_and_tells_the_story(shelves: Shelves) -> None:
    model = ScriptedModel(answer_well, name="scripted-a")
    planned = plan(model, shelves, method="matching")
    script = planned.script
    assert [call.schema for call in model.calls] == ["PlannedEvents", "Arrangement", "_ModelStory"]
    assert tuple(event.text for event in script.beats) == EVENTS
    assert [event.emotion for event in script.beats] == ["relaxed", "stressed", "sad"]
    wanted = chosen_in(model.calls[1].prompt)
    assert {r.beat: r.script.id for r in script.short_scripts} == wanted
    assert script.planner == "llm:scripted-a"
    assert (planned.told.title, planned.told.text) == ("A Letter of Glass", f"{TEXT} {told_in(model.calls[2].prompt)}")


def test_a_model_plans_every_beat_in_one_call_and_tells_the_story(shelves: Shelves) -> None:
    model = ScriptedModel(answer_well, name="scripted-a")
    planned = plan(model, shelves)
    assert [call.schema for call in model.calls] == ["PlannedBeats", "_ModelStory"]
    assert tuple(beat.text for beat in planned.script.beats) == EVENTS
    assert planned.script.acted == planned.script.asked == len(EVENTS)
    assert planned.told.title == "A Letter of Glass"
    assert planned.character.name == "Sam"


def test_a_model_changes_what_is_played(shelves: Shelves, by_rules: Planned) -> None:
    by_model = plan(ScriptedModel(answer_well), shelves)
    assert by_rules.script.planner == "rules"
    assert by_model.script.keyframes != by_rules.script.keyframes


def test_the_theme_and_the_character_reach_the_model(shelves: Shelves) -> None:
    model = ScriptedModel(answer_well)
    plan(model, shelves, character=Character("Noor", "she"))
    assert all(THEME in call.prompt for call in model.calls)
    assert "Noor" in model.calls[-1].prompt


@for_each(
    "nonsense",
    [
        "As a model I like cats.",
        "",
        "{}",
        '{"events": []}',
        '{"events": [{"text": "x", "emotion": "beige"}]}',
        "{" * 99,
    ],
)
def test_a_model_that_talks_nonsense_is_done_without_and_this_is_said(
    nonsense: str, shelves: Shelves, by_rules: Planned
) -> None:
    planned = plan(ScriptedModel(lambda _prompt, _schema: nonsense), shelves)
    assert planned.script.planner == "rules"
    assert planned.script.keyframes == by_rules.script.keyframes
    assert planned.told == by_rules.told
    said = " ".join(planned.script.repairs)
    for stage in ("beats planned by rules", "told by rules"):
        assert stage in said


def test_a_lost_connection_costs_only_the_stage_it_happened_in(shelves: Shelves) -> None:
    def answer(prompt: str, schema: type[BaseModel]) -> Answer:
        return ModelError("no connection") if schema.__name__ == "Arrangement" else answer_well(prompt, schema)

    planned = plan(ScriptedModel(answer, name="half"), shelves, method="matching")
    assert planned.script.planner == "llm:half, rules"
    assert any("arranged by rules: no connection" in note for note in planned.script.repairs)
    assert planned.told.title == "A Letter of Glass"


def test_a_model_may_write_the_keyframes_itself(shelves: Shelves) -> None:
    keyframes = [
        {"skill": "walk", "emotion": "sad", "caption": "walk slowly", "furniture": "bed"},
        {"skill": "liedown", "emotion": "sad", "caption": "lie on the back", "furniture": "bed"},
    ]

    def answer(prompt: str, schema: type[BaseModel]) -> Answer:
        return {"keyframes": keyframes} if schema.__name__ == "DirectScript" else answer_well(prompt, schema)

    planned = plan(ScriptedModel(answer, name="writer"), shelves, method="direct")
    assert planned.script.method == "direct"
    assert planned.script.planner == "llm:writer"
    assert [keyframe.skill.value for keyframe in planned.script.keyframes] == ["loco", "liedown"]
    assert {keyframe.room for keyframe in planned.script.keyframes} == {"bedroom"}


@pytest.mark.sweep
def test_the_told_story_of_a_model_is_acted_out_and_says_who_told_it(shelves: Shelves) -> None:
    pipeline = Pipeline(shelves, model=ScriptedModel(answer_well, name="scripted-a"))
    made = pipeline.make(StoryRequest(THEME, seed=3))
    assert "Planned by a language model (llm:scripted-a)." in story_to_markdown(made)
    assert report_to_dict(made)["planner"] == "llm:scripted-a"


def test_a_story_on_the_floor_needs_no_furniture(shelves: Shelves) -> None:
    keyframes = [
        {"skill": "loco", "emotion": "tired", "caption": "walk wearily", "furniture": "floor"},
        {"skill": "sitdown", "emotion": "tired", "caption": "sit cross-legged", "furniture": "floor"},
        {"skill": "standup", "emotion": "tired", "caption": "stand up", "furniture": "floor"},
        {"skill": "liedown", "emotion": "tired", "caption": "lie on the back", "furniture": "floor"},
    ]

    def answer(prompt: str, schema: type[BaseModel]) -> Answer:
        return {"keyframes": keyframes} if schema.__name__ == "DirectScript" else answer_well(prompt, schema)

    request = StoryRequest("A tired person lies on the floor.", method="direct")
    made = Pipeline(shelves, model=ScriptedModel(answer, name="scripted-a")).make(request)
    assert "Planned by a language model (llm:scripted-a)." in story_to_markdown(made)
    assert report_to_dict(made)["planner"] == "llm:scripted-a"
    assert [figure.reached for figure in made.figures] == [True] * len(made.figures)
    assert {action.object_id for action in made.actions} <= {None, "floor"}
    assert len(story_to_dict(made)["actions"]) == len(keyframes)
