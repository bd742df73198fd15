"""What only stands for a beat is left out where a body would have to get up for it."""

from __future__ import annotations

from functools import cache

import pytest

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Skill
from planner_service.composition.compose import compose
from planner_service.scripts.acted_beats import planned_beats
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import LongScript
from planner_service.scripts.script_library import Features, ScriptLibrary


def test_nobody_gets_up_for_what_only_stands_for_a_beat() -> None:
    script = planned("She sits on the sofa. She throws the cap onto the table.")
    assert [one.beat.text for one in planned_beats(script).missing] == ["throws the cap onto the table"]
    assert all(keyframe.beat == 0 for keyframe in script.keyframes)


def test_who_is_on_their_feet_is_seen_doing_something_in_its_place() -> None:
    script = planned("She walks to the table. She throws the cap onto the table.")
    assert [one.stood_for for one in planned_beats(script).outcomes] == [False, True]


def test_who_gets_up_does() -> None:
    script = planned("She lies on the bed. She gets up. She paces.")
    assert any(keyframe.beat == 1 for keyframe in script.keyframes)


@pytest.mark.parametrize("deed", ["breathes a deep sigh", "grins", "climbs onto the chair"])
def test_nobody_sits_down_for_what_is_done_with_the_face_or_standing_there(deed: str) -> None:
    script = planned(f"She walks to the window. She {deed}.")
    assert not any(keyframe.skill is Skill.SITDOWN for keyframe in script.keyframes)


def planned(theme: str) -> LongScript:
    return compose(theme, library())


@cache
def library() -> ScriptLibrary:
    return ScriptLibrary(built_in(), Features(HashingEncoder()))
