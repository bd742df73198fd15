"""Feelings that are told are seen in a gesture of their own, or are not counted."""

from __future__ import annotations

from for_each import for_each

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Emotion, Skill
from planner_service.composition.compose import compose
from planner_service.composition.request import Request
from planner_service.scripts.acted_beats import FELT, Shot, acted_beats, planned_beats
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import Beat, LongScript
from planner_service.scripts.script_library import Features, ScriptLibrary

LIBRARY = ScriptLibrary(built_in(), Features(HashingEncoder()))


def planned(theme: str) -> LongScript:
    return compose(theme, LIBRARY, Request())


@for_each(
    ("theme", "caption"),
    [
        ("He laughed, and walked out of the door.", "laughing"),
        ("She sobbed, giggled, and swept the floor.", "crying"),
        ("He burst into tears.", "crying"),
        ("She felt relieved.", "sighing"),
        ("Relief washes over her.", "sighing"),
        ("He danced until he was out of breath.", "panting"),
        ("Panting, he opened the door.", "panting"),
        ("She was terrified and looked at the door.", "recoiling"),
        ("She flinched.", "recoiling"),
        ("Fear grips her; she locks the door.", "recoiling"),
        ("He is bored.", "bored"),
        ("Boredom overcomes him.", "bored"),
        ("She is proud of her painting.", "proudly"),
        ("He swelled with pride.", "proudly"),
        ("She was ashamed.", "in shame"),
        ("He hangs his head in shame.", "in shame"),
        ("She was astonished.", "covering the mouth"),
        ("She shook with anger.", "clenching"),
        ("Anger rises in him.", "clenching"),
    ],
)
def test_a_feeling_is_seen_in_its_gesture_in_the_past_and_the_present(theme: str, caption: str) -> None:
    script = planned(theme)
    assert any(caption in one.caption for one in script.keyframes), [one.caption for one in script.keyframes]
    assert all(one.acted for one in planned_beats(script).outcomes if one.beat.asked)


def test_who_rests_is_not_made_to_get_up_for_a_feeling() -> None:
    keyframes = planned("She is reading on the sofa. Surprised, she gets up.").keyframes
    assert [one.skill for one in keyframes if one.skill is Skill.SITDOWN] == [Skill.SITDOWN]


def test_who_is_angry_thrusts_the_phone_down_and_nobody_else_does() -> None:
    angry = planned("He talks on the phone, hangs up angrily and goes to the kitchen.")
    calm = planned("He talks on the phone, hangs up and goes to the kitchen.")
    assert ["hanging up" in one.caption for one in angry.keyframes].count(True) == 1
    assert not any("hanging up" in one.caption for one in calm.keyframes)


def test_a_mood_is_seen_beside_its_words_for_long_enough_or_not_at_all() -> None:
    beats = [Beat(text=text, kind=kind, emotion=emotion) for text, kind, emotion in (
        ("sweeps", "deed", Emotion.SAD), ("is sad", "feeling", Emotion.SAD), ("sits", "deed", Emotion.NEUTRAL),
        ("lies", "deed", Emotion.SAD),
    )]  # fmt: skip

    def seen(*seconds: float, moods: tuple[Emotion, ...] = (Emotion.SAD, Emotion.NEUTRAL, Emotion.SAD)) -> bool:
        shots = [
            Shot((beat,), mood, False, reached=True, seconds=one)
            for beat, mood, one in zip((0, 2, 3), moods, seconds, strict=True)
        ]
        return acted_beats(beats, shots).outcomes[1].acted

    assert seen(FELT, 3.0, 3.0)
    assert not seen(FELT - 0.5, 3.0, 3.0)
    assert not seen(3.0, 3.0, 3.0, moods=(Emotion.NEUTRAL, Emotion.NEUTRAL, Emotion.SAD))
