"""The short scripts and captions that ship with the service."""

from __future__ import annotations

import json
from collections import Counter
from importlib import resources
from itertools import pairwise, product

import pytest

from motion_backend.motion import Skill
from planner_service.scripts.keyframe import EMOTIONS, ShortScript
from planner_service.scripts.moments import mood_of
from planner_service.scripts.voice import Voice, retell
from scene_graphs.furniture import ROOM_TYPES, affordances, is_known

DATA = resources.files("planner_service").joinpath("data")
SCRIPTS = tuple(
    ShortScript.model_validate_json(line)
    for line in DATA.joinpath("short_scripts.jsonl").read_text(encoding="utf-8").splitlines()
)
CAPTIONS: dict[str, list[str]] = json.loads(DATA.joinpath("captions.json").read_text(encoding="utf-8"))
NEEDS = {Skill.SITDOWN: "sit", Skill.LIEDOWN: "lie", Skill.TOUCH: "touch"}
SIT_CAPTIONS_OF_THE_PAPER = {
    "arms loosely, legs open",
    "hands behind head, cross-legged, lean back",
    "hands support on seat, legs straight",
    "legs straight, hands support body",
    "hands on thighs",
    "arms crossed, straight legs, feet crossed",
    "sit upright with hands on thighs",
    "hands behind head, lean back, cross-legged",
    "hands behind head, lean back, feet crossed",
    "hands behind head, legs straight",
}
LIE_CAPTIONS_OF_THE_PAPER = {
    "left leg bent",
    "side-lie on left, legs bent",
    "side-lie on left, legs crossed",
    "side lie on left, right hand on belly",
    "right leg bent",
    "side-lie on right",
    "elbows supporting body, left leg bent",
    "hands on belly",
    "side-lying on right, legs bent",
    "hands on belly, left leg bent",
    "hands on belly, right leg bent",
    "side lying on left with hands on belly",
}
WALK_CAPTIONS_OF_THE_PAPER = {
    "walk with knees bent",
    "skip steps running",
    "walk while talking on the phone with the left hand",
    "walk with the body leaning back",
    "walk on tiptoes",
    "tap chest lightly with both hands",
    "run and spin",
    "uplifted head walking",
    "walk while talking on the phone with the right hand",
    "walk like an old person",
    "rush anxiously forward",
    "walking slowly, hands behind back",
    "walk with depression",
    "head bowed and body bent while walking",
    "walking drunkenly",
}


def why_not_executable(script: ShortScript) -> str | None:
    """What keeps a body that stands somewhere in the room from acting the script out."""
    posture, at = "standing", None
    for number, keyframe in enumerate(script.keyframes):
        here = keyframe.furniture
        match keyframe.skill:
            case Skill.LOCO if posture == "standing":
                at = here
            case Skill.TOUCH if posture == "standing" and at == here and not keyframe.on_floor:
                pass
            case Skill.SITDOWN | Skill.LIEDOWN if posture == "standing" and at == here:
                posture = "seated" if keyframe.skill == Skill.SITDOWN else "lying"
            case Skill.STANDUP if posture == "seated" and at == here:
                posture = "standing"
            case Skill.GETUP if posture == "lying" and at == here:
                posture = "standing"
            case _:
                return f"keyframe {number}: {keyframe.skill} at {here} while {posture} at {at}"
    return None


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.id)
def test_a_body_can_act_a_script_out(script: ShortScript) -> None:
    assert why_not_executable(script) is None
    assert 3 <= len(script.keyframes) <= 9


def test_ids_and_summaries_are_unique() -> None:
    assert len({script.id for script in SCRIPTS}) == len(SCRIPTS) >= 180
    assert len({script.summary for script in SCRIPTS}) == len(SCRIPTS)


def test_every_emotion_is_shown_in_every_room_at_least_four_times() -> None:
    cells = Counter((script.emotion, script.room) for script in SCRIPTS)
    assert {cell: count for cell in product(EMOTIONS, ROOM_TYPES) if (count := cells[cell]) < 4} == {}


def test_all_scripts_are_our_own() -> None:
    assert {(script.source, script.licence) for script in SCRIPTS} == {("authored", "MIT")}


def test_captions_come_from_the_vocabulary_and_all_of_it_is_used() -> None:
    used: dict[str, set[str]] = {skill.value: set() for skill in Skill}
    for script in SCRIPTS:
        for keyframe in script.keyframes:
            used[keyframe.skill.value].add(keyframe.caption)
    assert {skill: sorted(captions) for skill, captions in used.items()} == CAPTIONS


def test_the_captions_of_the_paper_are_all_there() -> None:
    assert set(CAPTIONS["sitdown"]) >= SIT_CAPTIONS_OF_THE_PAPER
    assert set(CAPTIONS["liedown"]) >= LIE_CAPTIONS_OF_THE_PAPER
    assert set(CAPTIONS["loco"]) >= WALK_CAPTIONS_OF_THE_PAPER
    assert {len(captions) for captions in CAPTIONS.values()} <= set(range(2, 36))


def test_furniture_is_known_and_affords_what_is_done_with_it() -> None:
    for script in SCRIPTS:
        for keyframe in script.keyframes:
            if not keyframe.on_floor:
                assert is_known(keyframe.furniture), (script.id, keyframe.furniture)
                assert NEEDS.get(keyframe.skill, "touch") in affordances(keyframe.furniture), (script.id, keyframe)


def test_a_script_shows_the_emotion_it_is_filed_under() -> None:
    for script in SCRIPTS:
        assert script.emotion in {mood_of(keyframe) for keyframe in script.keyframes}, script.id


def test_no_keyframe_is_repeated_at_once() -> None:
    for script in SCRIPTS:
        assert all(one != other for one, other in pairwise(script.keyframes)), script.id


@pytest.mark.parametrize("voice", [Voice("Sam", "they"), Voice("Emily", "she"), Voice("John", "he")], ids=str)
def test_every_summary_can_be_told_in_the_past(voice: Voice) -> None:
    for script in SCRIPTS:
        told = retell(script.summary, voice)
        assert told is not None, script.id
        assert voice.name in told, script.id
        assert "character" not in told, script.id
        assert not {"is", "are", "has", "does", "they was", "cannot"} & set(told.lower().split()), told
