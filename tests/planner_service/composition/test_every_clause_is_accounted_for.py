"""Whatever a theme says is acted by keyframes or named as not acted, and what is not acted is not told as done."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache

import pytest
from examples import tries
from hypothesis import assume, given
from hypothesis import strategies as st

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Character
from planner_service.composition.compose import compose
from planner_service.composition.request import Request
from planner_service.evaluation.beat_judgement import Judgement
from planner_service.evaluation.labels import labelled_themes
from planner_service.narration.narrator import narrate
from planner_service.scripts.acted_beats import planned_beats
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import LongScript
from planner_service.scripts.script_library import Features, ScriptLibrary
from planner_service.themes.beats import ThemeError

KNOWN = ("reads a book", "sits on the sofa", "washes the dishes", "falls asleep", "opens the window", "dances")
UNKNOWN = ("yodels a ballad", "blorfs the frimble", "governs the universe", "quandles", "zibbered her cousin")
DENIED = ("does not yodel", "never blorfs the frimble", "refuses to swim")
BESIDES = ("quilted slippers", "a bag of plums", "barefoot as ever", "under protest", "like a heron")
LEADS = ("Barefoot", "Sour as vinegar", "Her umbrella dripping", "Up since two")
OTHERS = ("the kettle whistles", "her cousin yodels", "the neighbours quarrel")
JOINTS = (", ", " and ", ", then ", " but ", " before she ", " while ", "; ", ". She ")
SMALL = "a the she her and then but before while does not never to of as ever since under like on refuses"


@dataclass(frozen=True)
class Told:
    """A theme, and the stretches it is made of."""

    text: str
    stretches: tuple[str, ...]
    strange: tuple[str, ...]
    """Those of them that no body at home can show."""


@st.composite
def themes(draw: st.DrawFn) -> Told:
    """One to four clauses that joints join, with what is told besides before, after and between them."""
    lead = draw(st.sampled_from(("", *LEADS)))
    first = draw(st.sampled_from(KNOWN + UNKNOWN + DENIED))
    more = draw(st.lists(st.sampled_from(KNOWN + UNKNOWN + DENIED + OTHERS), max_size=3, unique=True))
    clauses = [first, *(one for one in more if one != first)]
    besides = draw(st.sampled_from(("", *BESIDES)))
    text, own = f"{lead}, she" if lead else "She", True
    for place, clause in enumerate(clauses):
        joint = draw(st.sampled_from(JOINTS)) if place else " "
        joint = " while " if clause in OTHERS and joint.endswith("he ") else joint
        joint = "; she " if clause not in OTHERS and not own and joint in (", ", " and ", "; ") else joint
        own = clause not in OTHERS
        text += (joint if place or own else ". Meanwhile ") + clause
    text += f", {besides}." if besides else "."
    strange = tuple(one for one in clauses if one in UNKNOWN + OTHERS)
    return Told(text, tuple(filter(None, (lead, *clauses, besides))), strange)


@cache
def library() -> ScriptLibrary:
    return ScriptLibrary(built_in(), Features(HashingEncoder()))


def planned(theme: str) -> LongScript | None:
    try:
        return compose(theme, library(), Request())
    except ThemeError:
        return None


def words_of(*texts: str) -> set[str]:
    """Words that tell something."""
    return set(re.findall(r"[a-z]+", " ".join(texts).lower())) - {*SMALL.split()}


@tries(100)
@given(themes())
def test_every_word_of_a_theme_is_of_a_beat_that_is_acted_or_named(theme: Told) -> None:
    script = planned(theme.text)
    assume(script is not None)
    assert script is not None
    outcomes = planned_beats(script).outcomes
    said = words_of(*(f"{one.beat.who} {one.beat.text}" for one in outcomes))
    assert not words_of(*theme.stretches) - said, (theme.text, [one.beat.text for one in outcomes])


@tries(100)
@given(themes())
def test_what_no_body_can_show_is_named_and_no_event_of_the_story(theme: Told) -> None:
    script = planned(theme.text)
    assume(script is not None)
    assert script is not None
    outcomes = planned_beats(script).outcomes
    named = words_of(*(one.beat.text for one in outcomes if not one.acted))
    named |= words_of(*(part for one in outcomes if one.acted for part in one.beat.unshown))
    told = words_of(narrate(script, Character()).events)
    for stretch in theme.strange:
        assert words_of(stretch) <= named, (theme.text, stretch, [one.beat.text for one in outcomes])
        assert not words_of(stretch.split()[-1]) & told, (theme.text, stretch)


@pytest.mark.sweep
def test_no_story_of_a_labelled_theme_tells_as_done_what_is_neither_acted_nor_named() -> None:
    for label in labelled_themes():
        script = planned(label.theme) if label.split == "tune" and not label.refuse else None
        if script is not None:
            judged = Judgement(label, script)
            told = judged.told_as_done(narrate(script, Character()).events)
            assert not told, (label.id, [label.beats[index].text for index in told])
