"""Free words mean one of nine emotions, by one list."""

from __future__ import annotations

from for_each import for_each

from motion_backend.emotion_words import emotion_of, naming_words
from motion_backend.mocap import clip_captions
from motion_backend.motion import Emotion


def test_every_emotion_has_its_words_and_its_own_name_is_one() -> None:
    assert set(naming_words()) == set(Emotion)
    assert {emotion: emotion_of(emotion.value) for emotion in Emotion} == {emotion: emotion for emotion in Emotion}


def test_every_word_names_the_emotion_it_stands_under_and_no_word_stands_twice() -> None:
    rows = [(stem, emotion) for emotion, stems in naming_words().items() for stem in stems]
    assert {stem: emotion_of(stem.replace("*", "")) for stem, _ in rows} == dict(rows)
    assert len(dict(rows)) == len(rows) >= 235


@for_each(
    ("words", "emotion"),
    [
        ("neutral, calm", Emotion.NEUTRAL),
        ("tired, depressed, drunk", Emotion.DRUNK),
        ("tired, sad", Emotion.SAD),
        ("painful, sad", Emotion.SAD),
        ("happy, childish", Emotion.HAPPY),
        ("cold, disturbed, anxious", Emotion.STRESSED),
        ("stressed, uncomfortable, tired", Emotion.STRESSED),
        ("thinking, stressed", Emotion.STRESSED),
        ("UNHAPPY", Emotion.SAD),
        ("not happy", Emotion.SAD),
        ("no longer sad", Emotion.RELAXED),
        ("not angry", None),
        ("tears up", Emotion.ANGRY),
        ("purple", None),
        ("", None),
    ],
)
def test_what_a_body_shows_most_is_meant(words: str, emotion: Emotion | None) -> None:
    assert emotion_of(words) is emotion


@for_each(
    ("style", "told", "emotion"),
    [
        ("brisk/hurried", "walk 07_12.bvh", Emotion.HURRIED),
        ("", "ZombieWalk_02", Emotion.DRUNK),
        ("sad_walk", "a happy jog", Emotion.SAD),
        ("style3", "AngryStomp", Emotion.ANGRY),
        ("", "Maddie_walks_by_the_latex_wall", Emotion.NEUTRAL),
    ],
)
def test_a_clip_feels_as_its_style_says_else_its_name(style: str, told: str, emotion: Emotion) -> None:
    assert clip_captions.emotion_of(style, told) is emotion
