"""Scripts that a body can act out, and what is changed in those it cannot."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import pytest
from examples import tries
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Emotion, Skill
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.caption_fallbacks import usual
from planner_service.scripts.captions import Vocabulary
from planner_service.scripts.script import Keyframe, PlannedKeyframe
from planner_service.scripts.script_repair import (
    check,
    free_hand,
    hand_of,
    read_keyframe,
    repair,
    skill_of,
)


def script(*rows: str) -> list[Keyframe]:
    """Keyframes from lines "skill furniture[, emotion[, caption]]"."""
    keyframes = []
    for row in rows:
        what, *more = row.split(", ")
        skill, _, word = what.partition(" ")
        emotion, caption = (*more, "neutral", "as usual")[:2] if len(more) < 2 else more
        keyframes.append(
            read_keyframe({"skill": skill, "furniture": word or "floor", "emotion": emotion, "caption": caption})
        )
    return keyframes


def told(keyframes: tuple[Keyframe, ...]) -> list[str]:
    """Skill and furniture of each."""
    return [f"{keyframe.skill} {keyframe.furniture}" for keyframe in keyframes]


@for_each(
    ("before", "after"),
    [
        # a walk to the target, unless one is there already
        (["sitdown chair"], ["loco chair", "sitdown chair"]),
        (["loco chair", "sitdown chair"], ["loco chair", "sitdown chair"]),
        (["loco floor", "touch table"], ["loco floor", "loco table", "touch table"]),
        (["loco couch", "sitdown sofa"], ["loco couch", "sitdown sofa"]),
        (["loco wardrobe", "touch wardrobe 2"], ["loco wardrobe", "loco wardrobe 2", "touch wardrobe 2"]),
        # rising before anything else, by the posture
        (["sitdown floor", "loco floor"], ["sitdown floor", "standup floor", "loco floor"]),
        (["liedown floor", "touch bed"], ["liedown floor", "getup floor", "loco bed", "touch bed"]),
        (["loco sofa", "sitdown sofa", "touch sofa"], ["loco sofa", "sitdown sofa", "standup sofa", "touch sofa"]),
        # rising only from rest, from the object rested on
        (["standup chair", "loco floor"], ["loco floor"]),
        (["loco bed", "liedown bed", "getup floor"], ["loco bed", "liedown bed", "getup bed"]),
        (["loco bed", "liedown bed", "standup bed"], ["loco bed", "liedown bed", "getup bed"]),
        (["loco sofa", "sitdown sofa", "getup sofa"], ["loco sofa", "sitdown sofa", "getup sofa"]),
        # from sitting to lying on the same object, and back
        (["loco bed", "sitdown bed", "liedown bed"], ["loco bed", "sitdown bed", "liedown bed"]),
        (["loco bed", "liedown bed", "sitdown bed"], ["loco bed", "liedown bed", "sitdown bed"]),
        (
            ["loco bed", "sitdown bed", "liedown sofa"],
            ["loco bed", "sitdown bed", "standup bed", "loco sofa", "liedown sofa"],
        ),
        # twice the same
        (["loco floor", "loco floor", "sitdown floor", "sitdown floor"], ["loco floor", "sitdown floor"]),
        # furniture that does not fit
        (["loco armchair", "liedown armchair"], ["loco sofa", "liedown sofa"]),
        (["loco wardrobe", "sitdown wardrobe"], ["loco chair", "sitdown chair"]),
        (["loco desk", "sitdown desk"], ["loco coffee table", "sitdown coffee table"]),
        (["loco shelf", "touch shelf", "touch floor"], ["loco shelf", "touch shelf"]),
        (["loco spaceship", "liedown spaceship"], ["loco bed", "liedown bed"]),
        (["loco spaceship"], ["loco floor"]),
    ],
)
def test_a_script_is_repaired_with_the_smallest_change(before: list[str], after: list[str]) -> None:
    assert told(repair(script(*before))[0]) == after


KEYFRAMES = st.builds(
    lambda skill, emotion, caption, word: Keyframe(skill=skill, emotion=emotion, caption=caption, furniture=word),
    st.sampled_from(Skill),
    st.sampled_from(["neutral", "happy, childish", "drunk", "purple", "tired, sad"]),
    st.sampled_from(["as usual", "run and spin", "walk with depression"]),
    st.sampled_from(
        ["floor", "sofa", "couch", "chair 2", "bed", "lamp", "wardrobe", "rug", "spaceship", "coffee table"]
    ),
)


@tries(300)
@given(st.lists(KEYFRAMES, max_size=12))
def test_whatever_was_repaired_can_be_acted_out_and_is_then_left_alone(keyframes: list[Keyframe]) -> None:
    repaired, repairs = repair(keyframes)
    assert check(repaired) == ()
    assert repair(repaired) == (repaired, ())
    assert bool(repairs) == (list(repaired) != keyframes) == bool(check(keyframes))


@tries(100)
@given(st.lists(KEYFRAMES, max_size=12))
def test_repairing_keeps_the_order_of_what_is_done(keyframes: list[Keyframe]) -> None:
    assert uses(repair(keyframes)[0]) == uses(keyframes)


WORDS = Vocabulary.built_in(HashingEncoder())
OUTSIDE = st.builds(
    lambda one, caption: one.model_copy(update={"caption": caption}),
    KEYFRAMES,
    st.sampled_from(
        [
            "yodelling",
            "walk while talking on the phone with the right hand",
            "chatting on the phone, left hand",
            "touch medium height with the right hand",
            "rotate with the right hand",
            "grab it with both hands, left hand first",
            "sitting still",
        ]
    )
    | st.text(min_size=1, max_size=30),
)
HOMES = st.none() | st.lists(
    st.sampled_from(["double_bed", "dining_chair", "nightstand", "multi_seat_sofa", "floor_lamp", "hovercraft"]),
    max_size=4,
)


@tries(100)
@given(st.lists(OUTSIDE, max_size=10), st.sampled_from([WORDS, None]), HOMES)
def test_whatever_comes_from_outside_is_repaired_once_and_for_all(
    keyframes: list[Keyframe], vocabulary: Vocabulary | None, home: list[str] | None
) -> None:
    repaired, repairs = repair(keyframes, vocabulary=vocabulary, furniture=home)
    assert check(repaired, vocabulary=vocabulary, furniture=home) == ()
    assert repair(repaired, vocabulary=vocabulary, furniture=home) == (repaired, ())
    assert bool(repairs) == (list(repaired) != keyframes)
    if vocabulary is not None:
        assert all(vocabulary.known(keyframe.skill, keyframe.caption) for keyframe in repaired)


def test_an_unknown_caption_becomes_the_nearest_known_one_or_the_usual_one() -> None:
    rows = script("loco chair, sad, tiptoe quietly", "sitdown chair, sad, quantum flux")
    assert check(rows) == ()
    (walk, sit), repairs = repair(rows, vocabulary=WORDS)
    assert (walk.caption, sit.caption) == ("walk on tiptoes", "sitting with head bowed, hands resting on thighs")
    assert repairs[0] == (
        'moment 1: "tiptoe quietly" is no caption known for walk; "walk on tiptoes" is nearest (0.67)'
    )
    assert "nothing known is near it" in repairs[1]
    assert {problem.field for problem in check(rows, vocabulary=WORDS)} == {"caption"}


def test_our_own_short_scripts_pass_with_the_vocabulary() -> None:
    assert [one.id for one in built_in() if check(one, vocabulary=WORDS)] == []


def test_the_hand_with_the_phone_touches_nothing() -> None:
    walk = "loco table, neutral, walk while talking on the phone with the right hand"
    rows = script(walk, "touch table, neutral, touch low height with the right hand")
    repaired, repairs = repair(rows)
    assert repaired[1].caption == "touch low height with the left hand"
    assert "while the right hand holds the phone" in repairs[0]
    switched = script(walk, "touch table, neutral, turn on with the right hand")
    assert repair(switched, vocabulary=WORDS)[0][1].caption == "touch medium height with the left hand"
    for free in ("with the left hand", "with no hand named"):
        assert check(script(walk, f"touch table, neutral, {free}")) == ()
    assert (free_hand(rows[0]), free_hand(rows[1]), free_hand(None)) == ("left", "right", "right")


@for_each(
    ("home", "before", "after"),
    [
        (["armchair", "bed"], ["loco sofa", "sitdown sofa"], ["loco armchair", "sitdown armchair"]),
        (["dining_chair"], ["loco chair", "sitdown chair"], ["loco chair", "sitdown chair"]),
        (["wardrobe"], ["loco bed", "liedown bed"], ["loco floor", "liedown floor"]),
        (["wardrobe"], ["loco desk", "touch desk"], ["loco wardrobe", "touch wardrobe"]),
        (["wardrobe"], ["loco piano"], ["loco floor"]),
        ([], ["loco table", "touch table", "sitdown chair"], ["loco floor", "sitdown floor"]),
    ],
)
def test_furniture_that_the_home_lacks_is_replaced(home: list[str], before: list[str], after: list[str]) -> None:
    rows = script(*before)
    assert told(repair(rows, furniture=home)[0]) == after
    assert (check(rows, furniture=home) == ()) == (before == after)
    assert all(problem.field == "furniture" for problem in check(rows, furniture=home))


def uses(keyframes: Sequence[Keyframe]) -> list[Skill]:
    """What is done at furniture, in order, repetitions told once."""
    done = (k.skill for k in keyframes if k.skill in (Skill.SITDOWN, Skill.LIEDOWN, Skill.TOUCH))
    return [skill for skill, _ in itertools.groupby(done)]


@for_each("emotion", Emotion)
def test_a_connecting_walk_shows_the_mood(emotion: Emotion) -> None:
    walk = repair(script(f"sitdown chair, {emotion}"))[0][0]
    assert (walk.caption, walk.emotion) == (usual(Skill.LOCO, emotion), emotion)


def test_a_connecting_walk_goes_on_in_the_manner_of_the_walk_before_it() -> None:
    walked = repair(script("loco floor, drunk, walk with the body leaning back", "touch lamp"))[0]
    assert walked[1].caption == "walk with the body leaning back"
    spun = repair(script("loco floor, happy, run and spin", "touch table"))[0]
    assert spun[1].caption == "excited walk"


def test_a_connecting_keyframe_belongs_to_an_event_and_to_no_short_script() -> None:
    row = {"emotion": "sad", "caption": "x", "furniture": "chair", "short_script": 3, "beat": 2, "room": "study"}
    (walk, sit), _ = repair([PlannedKeyframe.model_validate({"skill": "sitdown", **row})])
    assert (walk.short_script, walk.beat, walk.room, walk.skill) == (None, 2, "study", Skill.LOCO)
    assert sit.short_script == 3


def test_the_same_word_in_another_room_is_another_place() -> None:
    rows = [("loco", "bedroom"), ("touch", "study")]
    keyframes = [
        PlannedKeyframe.model_validate({"skill": s, "caption": "x", "furniture": "chair", "room": room})
        for s, room in rows
    ]
    assert [keyframe.room for keyframe in repair(keyframes)[0]] == ["bedroom", "study", "study"]


def test_problems_name_the_keyframe_the_fault_and_the_remedy() -> None:
    problems = check(script("touch spaceship, purple"))
    assert [problem.field for problem in problems] == ["emotion", "furniture", "skill"]
    assert str(problems[1]) == 'moment 1: the furniture word "spaceship" is not known; uses the table instead'


def test_our_own_short_scripts_use_known_words_only() -> None:
    for one in built_in():
        assert [str(problem) for problem in check(one) if problem.field != "skill"] == [], one.id


@for_each(("word", "skill"), [("walk", "loco"), ("Sit down", "sitdown"), ("lie-down", "liedown"), ("reach", "touch")])
def test_skills_have_other_words(word: str, skill: str) -> None:
    assert skill_of(word) == skill
    row = {"skill": word, "emotion/style": "happy", "caption": "x", "furnitures": "sofa"}
    assert read_keyframe(row).skill == skill


def test_a_word_for_no_skill_is_refused_with_the_skills_there_are() -> None:
    with pytest.raises(ValueError, match=r"'juggle' is none of loco, sitdown, standup"):
        skill_of("juggle")
    with pytest.raises(ValidationError, match="skill"):
        read_keyframe({"skill": "juggle", "caption": "x"})


@pytest.mark.parametrize(
    ("caption", "hand"),
    [("touch medium height with the left hand", "left"), ("Right hand up", "right"), ("touch low height", "right")],
)
def test_the_hand_is_read_off_the_caption(caption: str, hand: str) -> None:
    assert hand_of(caption) == hand
    assert hand_of("reaching", default="left") == "left"


@for_each(("posture", "skill"), list(itertools.product(("sitdown", "liedown"), repeat=2)))
def test_who_rests_on_a_piece_rests_there_otherwise_without_rising(posture: str, skill: str) -> None:
    acted, repairs = repair(
        script("loco bed", f"{posture} bed, neutral, one way", f"{skill} bed, neutral, another way")
    )
    assert [keyframe.skill.value for keyframe in acted] == ["loco", posture, skill]
    assert repairs == ()
    elsewhere, _ = repair(script("loco bed", f"{posture} bed", f"{skill} sofa"))
    assert len(elsewhere) == 5


def test_only_the_first_keyframe_can_be_there_already_and_needs_no_walk() -> None:
    lies, walks = (PlannedKeyframe.model_validate(one.model_dump()) for one in script("liedown bed", "loco floor"))
    already = lies.model_copy(update={"already": True})
    acted, _ = repair([already, walks])
    assert [(keyframe.skill, keyframe.already) for keyframe in acted] == [
        (Skill.LIEDOWN, True), (Skill.GETUP, False), (Skill.LOCO, False),
    ]  # fmt: skip
    later, _ = repair([walks, already])
    assert not any(keyframe.already for keyframe in later)
    assert [keyframe.skill for keyframe in later] == [Skill.LOCO, Skill.LOCO, Skill.LIEDOWN]
