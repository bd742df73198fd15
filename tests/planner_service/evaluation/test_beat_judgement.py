"""What the judge of acted beats sees: order, what is missing, what nobody asked for, what was not to be done."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from pydantic import ValidationError

from motion_backend.motion import Skill
from planner_service.evaluation.beat_judgement import SECONDS, Judgement, in_order, same_words
from planner_service.evaluation.labels import Alternative, LabelledBeat, LabelledTheme, labelled_themes
from planner_service.scripts.acted_beats import connects
from planner_service.scripts.script import Beat, LongScript, PlannedKeyframe
from scene_graphs.furniture import categories_of

THEMES = tuple(theme for theme in labelled_themes() if not theme.refuse)
SOME = st.sampled_from(THEMES)


def keyframe(skill: str, caption: str, furniture: str = "floor", emotion: str = "neutral") -> PlannedKeyframe:
    """One moment."""
    return PlannedKeyframe(skill=Skill(skill), caption=caption, furniture=furniture, emotion=emotion)


def meeting(one: Alternative) -> PlannedKeyframe:
    """A keyframe that an alternative describes, and as little more as can be."""
    skill = one.skill[0] if one.skill else Skill.LOCO
    return keyframe(skill, one.caption[0] if one.caption else "x", *one.furniture[:1] or ("floor",), *one.mood[:1])


def script(keyframes: Sequence[PlannedKeyframe], *beats: Beat) -> LongScript:
    """A long script of these."""
    return LongScript(theme="t", beats=beats, short_scripts=(), keyframes=tuple(keyframes))


def played(theme: LabelledTheme) -> list[PlannedKeyframe]:
    """A keyframe for every actable beat, in order."""
    return [meeting(beat.shown_by[0]) for beat in theme.beats if beat.actable]


def beat(text: str, *shown_by: Alternative, **more: bool) -> LabelledBeat:
    """A beat that can be acted if something shows it."""
    return LabelledBeat(text=text, actable=bool(shown_by), shown_by=shown_by, **more)


SITS = beat("sits down", Alternative(skill=(Skill.SITDOWN,)))
DRINKS = beat("drinks a glass of wine", Alternative(caption=("drinking",)))
SLEEPS = beat("sleeps on the sofa", Alternative(skill=(Skill.LIEDOWN,), furniture=("sofa",)))
RAIN = beat("rain falls on the roof")
NO_TV = LabelledBeat(text="does not watch television", actable=False, undone=True)
EVENING = LabelledTheme(
    id="evening", theme="t", split="tune", beats=(SITS, DRINKS, SLEEPS, RAIN, NO_TV),
    forbidden=(Alternative(skill=(Skill.TOUCH,), furniture=("television",)),),
)  # fmt: skip
SIT, DRINK, SLEEP = (
    keyframe("sitdown", "sitting still", "chair"),
    keyframe("sitdown", "drinking from a glass", "chair"),
    keyframe("liedown", "lying still", "sofa"),
)


@given(SOME)
def test_a_script_of_a_labels_own_alternatives_acts_every_beat_and_nothing_else(theme: LabelledTheme) -> None:
    judged = Judgement(theme, script(played(theme)))
    assert judged.acted == judged.actable
    # A walk that ends a film leads nowhere, whatever mood it is in.
    assert all(connects(judged.keyframes[index]) for index in judged.unasked)
    assert judged.refused_rightly


def test_what_is_acted_backwards_is_acted_less() -> None:
    forth, back = (Judgement(EVENING, script(each)) for each in ([SIT, DRINK, SLEEP], [SLEEP, DRINK, SIT]))
    assert (len(forth.acted), len(back.acted)) == (3, 2)


@given(SOME, st.data())
def test_no_order_of_the_same_keyframes_acts_more_than_the_right_one(theme: LabelledTheme, data: st.DataObject) -> None:
    order = data.draw(st.permutations(played(theme)))
    assert set(Judgement(theme, script(order)).acted) <= set(Judgement(theme, script(played(theme))).acted)


@given(SOME, st.data())
def test_a_dropped_keyframe_loses_its_beat_where_nothing_else_shows_it(
    theme: LabelledTheme, data: st.DataObject
) -> None:
    whole = played(theme)
    assume(whole)
    lost = data.draw(st.integers(0, len(whole) - 1))
    left = whole[:lost] + whole[lost + 1 :]
    judged, before = Judgement(theme, script(left)), Judgement(theme, script(whole))
    assert set(judged.acted) <= set(before.acted)
    own = theme.beats[before.actable[lost]].shown_by
    if not any(one.shown_by(other) for one in own for other in left):
        assert before.actable[lost] not in judged.acted
        assert before.actable[lost] in judged.missing


def test_one_keyframe_may_show_several_beats() -> None:
    assert [EVENING.beats[index] for index in Judgement(EVENING, script([DRINK])).acted] == [SITS, DRINKS]


def test_an_unasked_deed_counts_with_the_walk_that_leads_to_it_and_an_asked_one_without() -> None:
    rise, walk = keyframe("standup", "stand up", "chair"), keyframe("loco", "walk", "shelf")
    touch = keyframe("touch", "touch medium height", "shelf")
    asked = Judgement(EVENING, script([SIT, rise, keyframe("loco", "walk", "sofa"), SLEEP]))
    more = Judgement(EVENING, script([SIT, rise, walk, touch, keyframe("loco", "walk", "sofa"), SLEEP]))
    assert (asked.unasked, asked.unasked_seconds) == ((), 0)
    assert more.unasked == (1, 2, 3)
    assert more.unasked_seconds == sum(SECONDS[skill] for skill in (Skill.STANDUP, Skill.LOCO, Skill.TOUCH))
    assert more.acted == asked.acted
    assert (asked.deeds, more.deeds) == (3, 4)


def test_a_walk_about_the_room_leads_nowhere_and_so_does_a_last_rising() -> None:
    rising = keyframe("standup", "stand up", "chair")
    assert Judgement(EVENING, script([keyframe("loco", "pacing"), SIT, rising])).unasked == (0, 2)


def test_a_mood_asks_for_one_deed_in_it_and_not_for_all() -> None:
    theme = LabelledTheme(id="a", theme="t", split="tune", beats=(beat("grins", Alternative(mood=("happy",))),))  # type: ignore[arg-type]
    happy = keyframe("loco", "dancing steps", emotion="happy")
    judged = Judgement(theme, script([happy, happy]))
    assert (judged.acted, judged.unasked) == ((0,), (1,))
    assert Judgement(theme, script([keyframe("loco", "dancing steps", emotion="sad")])).acted == ()


def test_what_must_not_be_seen_is_seen() -> None:
    touch = keyframe("touch", "touch low", "tv")
    assert not categories_of("tv").isdisjoint(categories_of("television"))
    assert Judgement(EVENING, script([SIT, touch])).forbidden == (1,)
    assert Judgement(EVENING, script([SIT])).forbidden == ()


def test_a_missing_beat_is_named_where_the_script_says_so_in_some_of_its_words() -> None:
    said = (
        Beat(text="sits down"),
        Beat(text="drinks wine", why="no caption for it"),
        Beat(text="watches television", kind="undone"),
    )
    silent, honest = Judgement(EVENING, script([SIT, SLEEP])), Judgement(EVENING, script([SIT, SLEEP], *said))
    assert silent.missing == honest.missing == (1, 3, 4)
    assert (silent.named, honest.named) == ((), (1, 4))


def test_a_beat_that_is_said_to_be_acted_though_no_keyframe_is_left_for_it_is_named() -> None:
    judged = Judgement(
        EVENING, script([SIT.model_copy(update={"beat": 0})], Beat(text="sits"), Beat(text="drinks wine"))
    )
    assert 1 in judged.named


def test_what_is_told_of_a_missing_beat_is_found_in_one_sentence_of_the_story() -> None:
    judged = Judgement(EVENING, script([SIT, SLEEP]))
    assert judged.told("She sat. She drank a glass of wine, and was drinking it long. It rained.") == (1,)
    assert judged.told("She sat. She had a glass. There was wine.") == ()


def test_a_refusal_acts_nothing_and_hides_nothing() -> None:
    judged = Judgement(EVENING, None)
    assert (judged.acted, judged.unasked, judged.seconds) == ((), (), 0)
    assert judged.named == judged.missing == (0, 1, 2, 3, 4)
    nonsense = LabelledTheme(id="n", theme="t", split="tune", refuse=True)
    assert [Judgement(one, None).refused_rightly for one in (EVENING, nonsense)] == [False, True]
    assert not Judgement(nonsense, script([SIT])).refused_rightly


@pytest.mark.parametrize(
    ("text", "other", "same"),
    [
        ("drinks a glass of wine", "drinks wine", True),
        ("she watches the birds", "watching birds at the window", True),
        ("rain falls on the roof", "falls asleep on the sofa at home", False),
        ("is in it", "is in it", False),
    ],
)
def test_texts_are_of_one_thing_where_they_share_half_of_what_they_say(text: str, other: str, same: bool) -> None:
    assert same_words(text, other) is same_words(other, text) is same


@given(st.lists(st.lists(st.booleans(), min_size=4, max_size=4), max_size=5))
def test_no_choice_of_beats_in_order_is_larger_than_the_one_found(fits: list[list[bool]]) -> None:
    def possible(rows: Sequence[int]) -> bool:
        return any(
            all(fits[row][column] for row, column in zip(rows, columns, strict=True))
            for columns in itertools.combinations_with_replacement(range(4), len(rows))
        )

    found = sorted(in_order(fits))
    assert possible(found)
    larger = itertools.combinations(range(len(fits)), len(found) + 1)
    assert not any(possible(rows) for rows in larger)


@pytest.mark.parametrize(
    "row",
    [
        {"text": "sits", "actable": True},
        {"text": "sits", "actable": True, "undone": True, "shown_by": [{"skill": ["sitdown"]}]},
        {"text": "sits", "actable": True, "shown_by": [{"text": "a note alone"}]},
        {"text": "sits", "actable": True, "shown_by": [{"skill": ["hop"]}]},
    ],
)
def test_a_label_that_cannot_be_judged_is_refused(row: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        LabelledBeat.model_validate(row)


def test_a_theme_has_beats_or_is_to_be_refused() -> None:
    for more in ({}, {"beats": (SITS,), "refuse": True}):
        with pytest.raises(ValidationError):
            LabelledTheme.model_validate({"id": "a", "theme": "t", "split": "tune", **more})
