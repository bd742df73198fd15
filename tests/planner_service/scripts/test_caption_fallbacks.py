"""Words the body does not know are acted by the nearest known caption, and what is told keeps them."""

from __future__ import annotations

import pytest
from for_each import for_each

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Emotion, Skill
from motion_backend.procedural.caption_coverage import understands
from planner_service.output.story_export import report_to_dict, story_to_markdown, told_notes
from planner_service.pipeline import Pipeline, StoryRequest
from planner_service.scripts.caption_fallbacks import hashed_words, performed_as
from planner_service.scripts.captions import Vocabulary, captions, synonyms
from planner_service.scripts.script import Keyframe

KNOWN = [(Skill(skill), caption) for skill, some in captions().items() for caption in some]


def nobody() -> Vocabulary:
    raise AssertionError("the known captions were asked for")


def acted(skill: Skill, caption: str, emotion: Emotion = Emotion.NEUTRAL) -> str:
    return performed_as(skill, caption, emotion, hashed_words)


def test_known_captions_are_acted_as_they_are() -> None:
    assert all(performed_as(skill, caption, Emotion.NEUTRAL, nobody) == caption for skill, caption in KNOWN)


@for_each(
    ("skill", "caption"),
    [
        (Skill.LOCO, "walk to the sofa"),
        (Skill.SITDOWN, "sit down on the coffee table"),
        (Skill.SITDOWN, "huddled with head bowed"),
        (Skill.LIEDOWN, "lies down, knees bent"),
        (Skill.TOUCH, "reach for the lamp"),
        (Skill.STANDUP, "stands up with a groan"),
    ],
)
def test_words_that_the_body_knows_are_its_own(skill: Skill, caption: str) -> None:
    assert understands(skill, caption)
    assert performed_as(skill, caption, Emotion.NEUTRAL, nobody) == caption


def test_other_words_for_a_known_caption_are_acted_as_it() -> None:
    others = [
        (Skill(skill), known, other)
        for skill, by_caption in synonyms().items()
        for known, some in by_caption.items()
        for other in some
    ]
    assert {acted(skill, other) for skill, known, other in others} - {other for *_, other in others} <= {
        caption for _, caption in KNOWN
    }
    unread = [(known, acted(skill, other)) for skill, known, other in others if not understands(skill, other)]
    assert len(unread) > 50
    assert all(known == found for known, found in unread)


def test_words_near_to_nothing_are_acted_as_the_mood_usually_is() -> None:
    assert acted(Skill.LOCO, "xyzzy", Emotion.SAD) == "walk with depression"
    assert acted(Skill.SITDOWN, "xyzzy", Emotion.ANGRY) == "crossing arms"


def test_the_report_says_what_stood_in_and_the_story_keeps_its_words(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("planner_service.scripts.script_library.load_by_heart", lambda _: HashingEncoder())
    words = "plodding like a ghost"
    lines = (
        Keyframe(skill=Skill.LOCO, emotion="sad", caption=words, furniture="chair"),
        Keyframe(skill=Skill.SITDOWN, emotion="sad", caption="sitting with head bowed", furniture="chair"),
        Keyframe(skill=Skill.SITDOWN, emotion="sad", caption="legs crossed, reading a newspaper", furniture="chair"),
    )
    story = Pipeline().make(StoryRequest("", keyframes=lines))
    assert story.planned.script.keyframes[0].caption == words
    walk, sitting, *_, reading = report_to_dict(story)["keyframes"]
    lost = "nothing is seen of “newspaper” in “legs crossed, reading a newspaper”"
    assert reading["notes"] == [lost]
    assert any(line.endswith(lost) for line in told_notes(story))
    assert walk["performed_as"] == story.actions[0].caption
    assert walk["performed_as"] in captions()["loco"]
    assert sitting["performed_as"] is None
    assert walk["phases"][0] == {
        "part": "walk",
        "start": 0,
        "stop": walk["phases"][0]["stop"],
        "backend": "procedural",
        "fallback": None,
    }
    assert reading["phases"][-1]["stop"] == len(story.motion)
    assert walk["notes"] == sitting["notes"] == []


def test_the_report_of_a_story_says_what_was_done_otherwise(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("planner_service.scripts.script_library.load_by_heart", lambda _: HashingEncoder())
    lines = (
        Keyframe(skill=Skill.LOCO, emotion="neutral", caption="smoothly forward walk", furniture="bed"),
        Keyframe(
            skill=Skill.SITDOWN, emotion="neutral", caption="leaning forward, forearms on the table", furniture="bed"
        ),
    )
    story = Pipeline().make(StoryRequest("", keyframes=lines))
    said = "no table before the seat: each hand in the other, its elbow on the thigh"
    assert [row["notes"] for row in report_to_dict(story)["keyframes"]] == [[], [said]]
    assert f"moment 2: {said}" in story_to_markdown(story)
