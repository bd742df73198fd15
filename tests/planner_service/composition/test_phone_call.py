"""A call goes on till it is hung up, and sleep till somebody wakes: nothing undoes them that no words tell of."""

from __future__ import annotations

from functools import cache

from for_each import for_each

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Emotion, Skill
from planner_service.composition.compose import compose
from planner_service.composition.phone_call import HANGING_UP, is_talk
from planner_service.composition.request import Request
from planner_service.scripts.acted_beats import connects
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import PlannedKeyframe
from planner_service.scripts.script_library import Features, ScriptLibrary


@cache
def library() -> ScriptLibrary:
    return ScriptLibrary(built_in(), Features(HashingEncoder()))


def acted(theme: str) -> list[PlannedKeyframe]:
    return [one for one in compose(theme, library(), Request()).keyframes if not connects(one)]


@for_each(
    ("theme", "calls"),
    [
        ("She calls her mother, walks up and down while talking, laughs and hangs up.", 2),
        ("He shouts at his boss on the phone and hangs up.", 1),
        ("She calls a friend, sits down on the sofa, laughs and hangs up.", 2),
        ("He phones his sister and nods.", 1),
    ],
)
def test_all_of_a_call_has_the_phone_at_the_ear(theme: str, calls: int) -> None:
    keyframes = [one for one in acted(theme) if one.caption != HANGING_UP]
    assert [is_talk(one.caption) for one in keyframes] == [True] * calls


def test_who_shouts_on_the_phone_is_angry_there_and_has_none_after_it() -> None:
    shouts, hangs_up, sits = acted("He shouts at his boss on the phone, hangs up and sits down on the sofa.")
    assert is_talk(shouts.caption)
    assert (shouts.mood, hangs_up.caption) == (Emotion.ANGRY, HANGING_UP)
    assert (sits.skill, is_talk(sits.caption)) == (Skill.SITDOWN, False)


def test_who_shouts_without_a_phone_has_none() -> None:
    assert not any(is_talk(one.caption) for one in acted("He shouts at his boss."))


def test_who_has_the_head_on_the_desk_falls_asleep_as_they_are() -> None:
    *_, rests = acted("He sits at the desk and types, rests his head on the desk and falls asleep.")
    assert rests.caption == "head on folded arms on the table"
    assert len(rests.also) == 1


@for_each(
    ("theme", "caption"),
    [
        ("She types at her desk and falls asleep.", "head on folded arms on the table"),
        ("She sits in the armchair and falls asleep.", "asleep in the seat, head sunk to the chest"),
    ],
)
def test_who_sits_falls_asleep_there(theme: str, caption: str) -> None:
    assert acted(theme)[-1].caption == caption


@for_each(
    "after",
    ["She sleeps on.", "She is happy.", "She dreams of the sea."],
)
def test_nobody_wakes_without_words_for_it(after: str) -> None:
    theme = "She sits in the armchair and falls asleep."
    asleep, later = acted(theme)[-1], acted(f"{theme} {after}")[-1]
    assert (later.skill, later.caption, later.furniture) == (asleep.skill, asleep.caption, asleep.furniture)


def test_who_wakes_gets_up_again() -> None:
    script = compose("He falls asleep in the armchair. He wakes up and waters the plants.", library(), Request())
    assert script.keyframes[-1].furniture == "plant"


@for_each(
    "theme",
    ["She kneels to pray beside the bed.", "He kneels by the bed and prays.", "He prays beside his bed."],
)
def test_who_prays_by_the_bed_kneels_there(theme: str) -> None:
    walk, prays = compose(theme, library(), Request()).keyframes
    assert (walk.skill, walk.furniture) == (Skill.LOCO, "bed")
    assert prays.caption == "praying while kneeling, palms together"
