"""Themes are planned, grounded and told as they were when somebody last read them."""

from __future__ import annotations

from typing import Any

import pytest
from encoded import encoded
from recorded import agrees

from motion_backend.language import minilm
from motion_backend.motion import Action
from planner_service.evaluation.labels import labelled_themes
from planner_service.library.library import Shelves
from planner_service.pipeline import Pipeline, StoryRequest
from planner_service.scripts.script import Beat, PlannedKeyframe

EVERY = 3
"""Of the themes that are labelled to be tuned on."""

pytestmark = pytest.mark.skipif(
    minilm.weights_folder() is None, reason="the sentence encoder is not installed: make test installs it"
)


def test_stories_are_as_recorded() -> None:
    pipeline = Pipeline(Shelves(cache=encoded()))
    themes = [label.theme for label in labelled_themes() if label.split == "tune" and not label.refuse][::EVERY]
    agrees("stories", {theme: told(pipeline, StoryRequest(theme, seed=seed)) for seed, theme in enumerate(themes)})


def told(pipeline: Pipeline, request: StoryRequest) -> dict[str, Any]:
    """A story but for its motion, a line a keyframe."""
    planned = pipeline.plan(request)
    return {
        "keyframes": [line(keyframe) for keyframe in planned.script.keyframes],
        "beats": [outcome(beat) for beat in planned.script.beats],
        "told": planned.told.text.split(". "),
        "rooms": [room.layout.id for room in planned.home.rooms],
        "actions": [grounded(action) for action in pipeline.act(request, planned.stage)],
    }


def line(keyframe: PlannedKeyframe) -> str:
    words = (keyframe.skill.value, keyframe.caption, keyframe.furniture, keyframe.emotion)
    return " | ".join([*words, f"beats {[keyframe.beat, *keyframe.also]}"])


def outcome(beat: Beat) -> str:
    left = [f"not shown: {words}" for words in beat.unshown]
    return "; ".join([beat.text, beat.kind, beat.why or "served", *["stood for"] * beat.stood_for, *left])


def grounded(action: Action) -> list[Any]:
    spot = action.spot and [*action.spot.point, action.spot.facing]
    place = [*(action.goal or ()), *(spot or ()), *([action.facing] if action.facing is not None else [])]
    done = f"{action.skill.value} {action.object_id} {action.hand} {action.hold}"
    return [done, *(round(float(number), 3) for number in place)]
