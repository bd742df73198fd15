"""Captions for the deeds of a text: those authored for such a mood, unless the words ask for another."""

from __future__ import annotations

from functools import cache
from itertools import product

import pytest

from motion_backend.emotion_words import emotion_of
from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Skill
from planner_service.extraction.text_rules import captions_for, rise
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.captions import captions
from planner_service.scripts.script_library import Features, ScriptLibrary

LIBRARY = cache(lambda: ScriptLibrary(built_in(), Features(HashingEncoder())))
MOODS = ("neutral", "happy", "sad", "angry", "tired")
PLAIN = {Skill.SITDOWN: "sits there", Skill.LIEDOWN: "lies there", Skill.LOCO: "goes there"}


def test_a_plain_deed_is_done_as_somebody_once_did_it_in_that_mood() -> None:
    authored: dict[tuple[Skill, str], set[str]] = {}
    for script in built_in():
        for keyframe in script.keyframes:
            mood = emotion_of(keyframe.emotion) or "neutral"
            authored.setdefault((keyframe.skill, str(mood)), set()).add(keyframe.caption)
    deeds = [(skill, words, mood) for (skill, words), mood in product(PLAIN.items(), MOODS)]
    chosen = captions_for(deeds, LIBRARY())
    wrong = [
        (deed, caption)
        for deed, caption in zip(deeds, chosen, strict=True)
        if authored.get((deed[0], deed[2])) and caption not in authored[deed[0], deed[2]]
    ]
    assert wrong == []
    assert len(set(chosen)) > 5, "moods look alike"


@pytest.mark.parametrize("hand", ["left", "right"])
def test_a_hand_that_the_words_name_is_the_captions(hand: str) -> None:
    deed = (Skill.TOUCH, f"picks the cup up with the {hand} hand", "neutral")
    (caption,) = captions_for([deed], LIBRARY())
    assert caption in captions()[Skill.TOUCH]
    assert ("left" if hand == "right" else "right") not in caption


def test_a_phone_at_the_ear_is_for_those_who_telephone() -> None:
    deeds = [(Skill.LOCO, "talks on the phone and walks about", "neutral"), (Skill.LOCO, "walks about", "neutral")]
    with_phone, without = captions_for(deeds, LIBRARY())
    assert "phone" in with_phone
    assert "phone" not in without


def test_a_rising_is_as_quick_as_its_mood() -> None:
    assert rise(Skill.STANDUP, "angry") == "stand up abruptly"
    assert rise(Skill.STANDUP, "tired") == "stand up slowly"
    assert rise(Skill.STANDUP, "neutral") == "stand up"
    assert rise(Skill.GETUP, "neutral") == "get up"
    assert {rise(Skill.GETUP, mood) for mood in MOODS} <= {"get up", "get up quickly", "get up slowly"}


def test_no_deeds_have_no_captions() -> None:
    assert captions_for([], LIBRARY()) == []
