"""What keyframes of one's own are called: what they were given as, else by mood and place."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.motion import Character, Skill
from planner_service.composition.compose import script_of
from planner_service.narration.narrator import narrate
from planner_service.narration.story_words import MAX_TITLE, headline, title_of
from planner_service.scripts.script import Keyframe

SIT = Keyframe(skill=Skill.SITDOWN, emotion="sad", caption="sitting still", furniture="sofa")


@given(st.text())
def test_a_headline_is_short_and_begins_as_its_text_does(text: str) -> None:
    found = headline(text)
    assert len(found) <= MAX_TITLE + 3
    kept = " ".join(found.split()).rstrip("…").casefold()
    assert " ".join(text.split()).casefold().lstrip(".!?… ").startswith(kept) or not kept


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("watch TV on the sofa", "Watch TV on the sofa"),
        ("She slept. Then she rose.", "She slept"),
        (
            "Sam walked listlessly over to the corner sofa and sat down wearily, chin in hand.",
            "Sam walked listlessly over",
        ),
    ],
)
def test_a_headline_ends_where_something_does(text: str, said: str) -> None:
    assert headline(text).startswith(said)
    assert not headline(text).endswith((",", ".", " and"))


def test_a_script_of_ones_own_is_called_what_it_calls_itself() -> None:
    assert narrate(script_of([SIT], "My evening"), Character()).title == "My evening"


@pytest.mark.parametrize("furniture", ["sofa", "armchair", "kitchen counter", "tv stand", "floor", "wardrobe 2"])
@pytest.mark.parametrize("mood", ["neutral", "sad", "angry", "drunk"])
def test_a_script_that_has_no_name_is_called_after_its_mood_and_where_it_plays(furniture: str, mood: str) -> None:
    can_sit = furniture in ("sofa", "armchair", "floor")
    done = Keyframe(skill=Skill.SITDOWN if can_sit else Skill.TOUCH, caption="x", furniture=furniture, emotion=mood)
    told = narrate(script_of([done], ""), Character())
    words = told.title.split()
    assert 2 < len(words) <= 6
    assert not told.text.startswith(told.title)
    assert title_of("", mood).removesuffix(" at Home") in told.title
    assert furniture == "floor" or words[-1].lower() in furniture


def test_the_mood_of_a_nameless_script_is_that_of_most_of_it() -> None:
    rows = [("sitdown", "sad", "sofa"), ("touch", "angry", "bookshelf"), ("loco", "sad", "floor")]
    keyframes = [Keyframe(skill=Skill(s), emotion=mood, caption="x", furniture=there) for s, mood, there in rows]
    assert narrate(script_of(keyframes, ""), Character()).title == "A Sad Day on the Sofa"


def test_a_mood_is_told_of_the_place_where_it_is() -> None:
    rows = [
        Keyframe(skill=Skill.SITDOWN, emotion="sad", caption="right hand on chin, thinking", furniture="sofa"),
        Keyframe(skill=Skill.TOUCH, emotion="angry", caption="touch medium height", furniture="cabinet"),
    ]
    assert narrate(script_of(rows, ""), Character()).title == "A Sad Day on the Sofa"
    assert narrate(script_of(rows[::-1], ""), Character()).title == "An Angry Day by the Cabinet"
