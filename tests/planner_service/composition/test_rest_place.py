"""Who rests where, and what they get up for."""

from __future__ import annotations

from functools import cache

import pytest
from for_each import for_each

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Skill
from planner_service.composition.compose import compose
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import LongScript, PlannedKeyframe
from planner_service.scripts.script_library import Features, ScriptLibrary


@pytest.mark.parametrize("way", ["stomps off to bed", "tiptoes back to bed", "shuffles to bed", "goes to bed"])
def test_who_goes_to_bed_however_they_do_lies_down(way: str) -> None:
    *_, walk, last = planned(f"She {way}.").keyframes
    assert (walk.skill, last.skill, last.furniture) == (Skill.LOCO, Skill.LIEDOWN, "bed")


@pytest.mark.parametrize("rising", ["jumps out of bed", "gets out of bed", "leaps out of bed"])
def test_who_gets_out_of_bed_first_of_all_has_lain_there(rising: str) -> None:
    assert [one.skill for one in planned(f"He {rising}.").keyframes][:2] == [Skill.LIEDOWN, Skill.GETUP]


def test_who_sleeps_over_their_books_does_so_at_the_desk() -> None:
    asleep = shown(
        planned("She reads at the desk and falls asleep over her homework."), "falls asleep over her homework"
    )
    assert asleep.skill is Skill.SITDOWN
    assert asleep.caption == "head on folded arms on the table"


@pytest.mark.parametrize(
    ("seen", "ends"),
    [
        ("talks to her mother on the phone", "hangs up"),
        ("reads a novel in the armchair", "closes the book"),
        ("reads a letter in the armchair", "lets it slide to the floor"),
        ("plays the piano", "stops"),
    ],
)
def test_nobody_goes_anywhere_to_end_what_their_hands_do(seen: str, ends: str) -> None:
    script = planned(f"She {seen}, {ends} and sits down on the sofa.")
    assert shown(script, ends) is shown(script, seen)


def test_who_sits_gets_up_to_fetch_and_to_leave_but_not_for_their_own_seat() -> None:
    script = planned("He sits in the armchair. He pats the armchair. He grabs his keys. He leaves.")
    rising = next(at for at, one in enumerate(script.keyframes) if one.skill is Skill.STANDUP)
    assert script.beats[1].why
    assert not script.beats[2].why
    assert not script.beats[3].why
    assert all(one.beat == 2 for one in script.keyframes[rising : rising + 2])
    assert shown(script, "leaves").skill is Skill.LOCO


@pytest.mark.parametrize("heard", ["The phone rings and rings.", "The doorbell rings.", "The alarm beeps."])
def test_what_is_only_heard_is_done_by_nobody(heard: str) -> None:
    script = planned(f"{heard} He does not answer. He lies down.")
    assert {one.beat for one in script.keyframes} == {len(script.beats) - 1}


@pytest.mark.parametrize(
    ("theme", "back"),
    [
        ("He types at the desk. He gets up. He paces. He sits back down.", "sits back down"),
        ("She does yoga on the carpet. She opens the door. She goes back to her mat.", "goes back to her mat"),
        ("He reads in bed. He gets up. He drinks some water. He goes back to bed.", "goes back to bed"),
    ],
)
def test_who_goes_back_rests_where_they_did(theme: str, back: str) -> None:
    script = planned(theme)
    first = next(one for one in script.keyframes if one.skill in (Skill.SITDOWN, Skill.LIEDOWN))
    assert (shown(script, back).skill, shown(script, back).furniture) == (first.skill, first.furniture)


def test_what_is_done_again_is_done_where_it_was() -> None:
    script = planned("She knocks on the bathroom door. She waits. She knocks again.")
    touched = [one.furniture for one in script.keyframes if one.skill is Skill.TOUCH]
    assert len(touched) == 2
    assert len({*touched}) == 1


@pytest.mark.parametrize("meal", ["breakfast", "lunch", "class"])
def test_who_skips_a_meal_does_not_eat(meal: str) -> None:
    script = planned(f"He skips {meal}. He sits down.")
    assert script.beats[0].kind == "undone"
    assert not any("eating" in one.caption for one in script.keyframes)


def test_a_thing_is_where_it_is_told_to_lie() -> None:
    script = planned("The letter lies on the coffee table. She opens it.")
    assert [one.furniture for one in script.keyframes] == ["coffee table", "floor"], "gone to, then opened there"


def shown(script: LongScript, text: str) -> PlannedKeyframe:
    """The last keyframe of the beat of such words."""
    beat = next(index for index, one in enumerate(script.beats) if one.text == text)
    return [one for one in script.keyframes if beat in (one.beat, *one.also)][-1]


def planned(theme: str) -> LongScript:
    return compose(theme, library())


@cache
def library() -> ScriptLibrary:
    return ScriptLibrary(built_in(), Features(HashingEncoder()))


@for_each(
    ("theme", "phones"),
    [
        ("The phone rings. Aylin picks it up.", True),
        ("Her mother calls. She lets it ring, then picks up after all.", True),
        ("The phone rings, but she ignores it. She drops a spoon and picks it up.", False),
        ("She finds a ball and picks it up.", False),
    ],
)
def test_a_phone_that_rang_is_picked_up_and_no_other_thing_that_was_told_of_since(theme: str, phones: bool) -> None:
    assert any("phone" in one.caption for one in planned(theme).keyframes) == phones
