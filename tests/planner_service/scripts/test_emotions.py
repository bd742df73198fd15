"""A keyframe's words mean one emotion, and that is what it is told in and acted in."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from motion_backend.emotion_words import naming_words
from motion_backend.motion import Action, Emotion, Skill
from motion_backend.procedural.emotion_style import bearings
from motion_backend.procedural.lie.lie_styles import lie_style
from motion_backend.procedural.sit.sit_styles import sit_style
from motion_backend.procedural.walk.walk_styles import walk_style
from planner_service.grounding.keyframes_to_actions import Place, act
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.captions import captions
from planner_service.scripts.emotions import EmotionHints, feelings
from planner_service.scripts.script import Keyframe
from planner_service.scripts.script_repair import repair
from scene_graphs.data_tables import read_table
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout

HOME = home_from_layouts([Layout("room", "study", ((0.0, 0.0), (0.0, 4.0), (4.0, 4.0), (4.0, 0.0)), objects=())], 0)
NAMED = [
    (stem.replace(" * ", " her ").replace("*", ""), emotion)
    for emotion, stems in naming_words().items()
    for stem in stems
]
STYLES: dict[Skill, Callable[[Emotion, str], Any]] = {
    Skill.LOCO: walk_style,
    Skill.SITDOWN: sit_style,
    Skill.LIEDOWN: lie_style,
}


def hinted() -> list[str]:
    table = read_table("planner_service", "emotion_hints.toml", EmotionHints)
    return [stem.replace(" * ", " her ").replace("*", "") for row in table.emotions for stem in row.hints]


def standing(words: str) -> Keyframe:
    return Keyframe.model_validate({"skill": "loco", "emotion/style": words, "caption": "stand still"})


def acted(keyframes: list[Keyframe]) -> tuple[Action, ...]:
    return act(keyframes, [Place(0)] * len(keyframes), HOME, 0)


def test_every_word_that_the_planner_knows_means_the_same_to_the_body() -> None:
    written = [*NAMED, *((word, standing(word).mood) for word in hinted())]
    keyframes = [standing(word) for word, _ in written]
    differ = [
        (word, emotion, keyframe.mood, action.emotion)
        for (word, emotion), keyframe, action in zip(written, keyframes, acted(keyframes), strict=True)
        if not (
            keyframe.mood is action.emotion is emotion
            and walk_style(action.emotion, action.caption).bearing == bearings()[emotion]
        )
    ]
    assert len(NAMED) >= 235
    assert not differ


def test_every_keyframe_of_the_library_is_acted_in_the_emotion_it_is_told_in() -> None:
    words = sorted({keyframe.emotion for script in built_in() for keyframe in script.keyframes})
    keyframes = [standing(one) for one in words]
    assert [action.emotion for action in acted(keyframes)] == [keyframe.mood for keyframe in keyframes]


def test_no_caption_changes_the_emotion() -> None:
    """Captions say how a thing is done; a mood in them ("walk with depression") is manner."""
    for skill, style in STYLES.items():
        for caption in captions()[skill]:
            tempos = [style(emotion, caption).bearing.tempo for emotion in Emotion]
            paced = any(word in caption.lower() for word in ("slow", "weari", "quick"))
            assert paced or tempos == [bearings()[emotion].tempo for emotion in Emotion], caption


@given(st.text(alphabet="qxz ", max_size=12))
def test_words_that_nobody_knows_are_neutral_and_noted(words: str) -> None:
    keyframe = standing(words)
    (kept,), notes = repair([keyframe])
    assert keyframe.mood is kept.mood is Emotion.NEUTRAL
    assert any("acted as neutral" in note for note in notes)


def test_a_keyframe_keeps_its_words() -> None:
    keyframe = standing("tired, sad")
    assert keyframe.model_dump(mode="json")["emotion"] == "tired, sad"
    assert (keyframe.mood, acted([keyframe])[0].emotion) == (Emotion.SAD, Emotion.SAD)


def test_sentences_name_feelings_or_hint_at_them() -> None:
    found = feelings("She is happy after her exam.")
    assert [(one.emotion, one.sure) for one in found] == [(Emotion.HAPPY, True), (Emotion.STRESSED, False)]
