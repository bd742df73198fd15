"""What became of a theme's beats, by the keyframes that there are and by what the body did."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.motion import Emotion, Skill
from planner_service.scripts.acted_beats import (
    ACTED,
    IN_ITS_PLACE,
    LEFT_UNDONE,
    NOT_SHOWN,
    Shot,
    acted_beats,
    connects,
    lost_in_moving,
    planned_beats,
)
from planner_service.scripts.script import Beat, Keyframe, LongScript, PlannedKeyframe

SITS, READS, NO_SUPPER = Beat(text="sits down"), Beat(text="reads"), Beat(text="eats no supper", kind="undone")


def shot(beat: int | None, reached: bool | None = None, **more: object) -> Shot:
    """A deed of a second."""
    fields = {"mood": Emotion.NEUTRAL, "connects": False, "seconds": 1.0, **more}
    return Shot(beats=() if beat is None else (beat,), reached=reached, **fields)  # type: ignore[arg-type]


SHOTS = st.builds(
    Shot,
    beats=st.lists(st.integers(0, 3), max_size=2).map(tuple),
    mood=st.sampled_from(Emotion),
    connects=st.booleans(),
    reached=st.none() | st.booleans(),
    seconds=st.floats(0, 9),
)
BEATS = st.builds(
    Beat,
    text=st.just("sits"),
    emotion=st.sampled_from(Emotion),
    kind=st.sampled_from(["deed", "feeling", "undone", "other"]),
    why=st.sampled_from(["", "nobody can fly"]),
    unshown=st.sampled_from([(), ("sits",), ("with a sigh",)]),
)


@given(st.lists(BEATS, max_size=4), st.lists(SHOTS, max_size=8))
def test_every_beat_is_acted_or_there_is_a_reason_and_shares_are_shares(beats: list[Beat], shots: list[Shot]) -> None:
    found = acted_beats(beats, shots)
    assert len(found.outcomes) == len(beats)
    assert all(one.acted == (not one.why) for one in found.outcomes)
    assert all(one.acted + one.stood_for <= 1 for one in found.outcomes)
    assert found.acted + found.stood_for + len(found.missing) == found.asked
    assert found.asked + len(found.undone) + len(found.told) == len(beats)
    assert 0 <= found.spare_share <= found.other_share <= 1
    assert not any(one.acted for one in found.undone)
    assert all(one.why == one.beat.why for one in found.outcomes if one.beat.why)
    rows = found.to_dict()["beats"]
    assert [(row["acted"], row["stood_for"]) for row in rows] == [(one.acted, one.stood_for) for one in found.outcomes]


@given(st.lists(BEATS, max_size=4), st.lists(SHOTS, max_size=8))
def test_only_a_body_that_moved_loses_what_was_to_be_seen(beats: list[Beat], shots: list[Shot]) -> None:
    shots = [replace(one, beats=tuple(beat for beat in one.beats if beat < len(beats))) for one in shots]
    outcomes = acted_beats(beats, shots).outcomes
    for place in lost_in_moving(beats, shots):
        assert shots[place].beats
        assert not any(outcomes[beat].acted for beat in shots[place].beats)
    assert not lost_in_moving(beats, [replace(one, reached=None) for one in shots])


@given(st.lists(BEATS, max_size=4), st.lists(SHOTS, min_size=1, max_size=8), st.data())
def test_nothing_more_is_acted_when_a_keyframe_is_dropped(
    beats: list[Beat], shots: list[Shot], data: st.DataObject
) -> None:
    lost = data.draw(st.integers(0, len(shots) - 1))
    left = shots[:lost] + shots[lost + 1 :]
    if shots[lost].reached is not False and not shots[lost].connects:
        assert acted_beats(beats, left).acted <= acted_beats(beats, shots).acted


def test_a_beat_without_a_keyframe_is_not_acted_though_nobody_said_why() -> None:
    assert [one.acted for one in acted_beats([SITS, READS], [shot(0)]).outcomes] == [True, False]


def test_a_beat_whose_deeds_the_body_did_not_reach_is_not_acted_and_says_so() -> None:
    walk = shot(0, True, connects=True)
    (lost,) = acted_beats([SITS], [walk, shot(0, False, reason="the chair is behind a wall")]).outcomes
    assert lost.why == "the body did not reach it: the chair is behind a wall"
    assert acted_beats([SITS], [walk, shot(0, False), shot(0, True)]).acted == 1
    assert acted_beats([Beat(text="walks to the window")], [walk]).acted == 1


def test_what_the_body_did_otherwise_only_stands_for_its_beat_and_says_why() -> None:
    other = ("nothing to lean back against: upright",)
    found = acted_beats([READS], [shot(0, True, otherwise=other)])
    assert (found.acted, found.stood_for, found.outcomes[0].why) == (0, 1, f"{IN_ITS_PLACE}, {other[0]}")
    for more in (shot(0, True), shot(0, True, otherwise=())):
        found = acted_beats([READS], [shot(0, True, connects=True, otherwise=other), more])
        assert (found.acted, found.stood_for) == (1, 0)


@pytest.mark.parametrize(
    ("text", "stood_for"),
    [
        ("sits at the table", False), ("quietly lies down on the bed", False), ("takes a seat", False),
        ("sits with her hands folded", True), ("sits down to write", True), ("writes a letter", True),
        ("sits reading", True),
    ],
)  # fmt: skip
def test_a_note_on_hands_leaves_the_beat_acted_that_only_says_where_one_rests(text: str, stood_for: bool) -> None:
    hands = shot(0, True, otherwise=("no table in easy reach: each hand in the lap",))
    assert acted_beats([Beat(text=text)], [hands]).stood_for == stood_for
    both = acted_beats([Beat(text=text)], [shot(0, True, otherwise=(*hands.otherwise, "no edge on that side"))])
    assert both.stood_for == 1, "the other note is about the body"


@pytest.mark.parametrize(
    ("text", "stood_for"),
    [
        ("lies down on the bed, tired", False), ("sleeps", False), ("falls asleep on the sofa", False),
        ("lies with her knees drawn up", True), ("does sit-ups", True), ("enjoys a quiet afternoon", False),
        ("stretches her legs", True),
    ],
)  # fmt: skip
def test_who_is_only_said_to_lie_or_sleep_does_so_however_the_knees_lie(text: str, stood_for: bool) -> None:
    less = shot(0, True, otherwise=("no room before the body: knees drawn up less",))
    assert acted_beats([Beat(text=text)], [less]).stood_for == stood_for


def test_who_walks_out_does_so_with_the_arms_before_them_too() -> None:
    less = shot(0, True, otherwise=("no room for open arms: to the front",))
    found = [acted_beats([Beat(text=text)], [less]).acted for text in ("walks out of the door", "runs with open arms")]
    assert found == [1, 0]


@pytest.mark.parametrize(
    ("text", "unshown"),
    [
        ("slams the cabinet", ["that the cabinet moves"]), ("opens the curtains", ["that the curtains move"]),
        ("turns off the lamp", ["that it goes off"]), ("blows the candle out", ["that it goes off"]),
        ("turns the music down", ["that it goes down"]), ("puts on a hat", []), ("sits down", []),
        ("opens a book", []), ("closes her eyes on the bed", []), ("pulls out the chair and sits by the window", []),
    ],
)  # fmt: skip
def test_a_thing_that_the_theme_moves_is_named_since_it_stays_where_it_is(text: str, unshown: list[str]) -> None:
    found = acted_beats([Beat(text=text)], [shot(0, True)])
    assert (found.acted, found.to_dict()["beats"][0]["unshown"]) == (1, unshown)
    assert (f"not shown of “{text}”: {'; '.join(unshown)}" in found.lines()) == bool(unshown)
    assert not acted_beats([Beat(text=text)], []).outcomes[0].unshown, "what is not acted shows nothing at all"


def test_a_feeling_is_acted_by_the_mood_of_other_beats() -> None:
    cries = Beat(text="cries", emotion=Emotion.SAD, kind="feeling")
    assert acted_beats([SITS, cries], [shot(0, mood=Emotion.SAD)]).outcomes[1].acted
    assert not acted_beats([SITS, cries], [shot(0)]).outcomes[1].acted


def test_one_keyframe_may_serve_several_beats() -> None:
    keyframe = PlannedKeyframe(skill=Skill.SITDOWN, caption="reading", furniture="sofa", beat=0, also=(1,))
    script = LongScript(theme="t", beats=(SITS, READS), short_scripts=(), keyframes=(keyframe,))
    assert planned_beats(script).acted == 2


def test_the_words_name_what_is_missing_and_apart_from_it_what_is_left_undone() -> None:
    found = acted_beats([SITS, READS, NO_SUPPER], [shot(0, seconds=3.0), shot(None, seconds=1.0)])
    assert found.lines() == [
        "1 of 2 beats of your theme are acted; 25% of the screen time plays something else",
        "not acted: reads (no keyframe is left that shows it)",
        "left undone, as asked: eats no supper",
        *(ACTED, NOT_SHOWN, LEFT_UNDONE),
    ], "each word that comes up is explained, on a line of its own"
    told = found.to_dict()
    assert (told["beats_asked"], told["beats_acted"], told["screen_time_without_beat"]) == (2, 1, 0.25)
    assert [(one["text"], one["acted"]) for one in told["beats"]] == [
        ("sits down", True), ("reads", False), ("eats no supper", False),
    ]  # fmt: skip


def test_what_is_no_deed_is_named_and_not_counted_but_what_somebody_else_does_is() -> None:
    day = Beat(text="Laundry day", kind="other", why="it is no deed")
    rings = Beat(text="the bell rings", kind="other", who="the bell", why="somebody or something else does it")
    found = acted_beats([day, SITS, rings], [shot(1)])
    assert (found.acted, found.asked, len(found.told)) == (1, 2, 1)
    assert found.lines()[1:3] == [
        "not acted: the bell rings (somebody or something else does it)",
        "told, not acted: Laundry day (it is no deed)",
    ]


def test_time_that_shows_what_only_stands_for_a_beat_is_no_time_of_an_acted_one() -> None:
    spins = Beat(text="conducts an orchestra", unshown=("conducts an orchestra",))
    found = acted_beats([SITS, spins], [shot(0, seconds=3.0), shot(1, seconds=1.0)])
    assert (found.spare_share, found.other_share) == (0.0, 0.25)


def test_without_a_theme_nothing_is_said() -> None:
    found = acted_beats([], [shot(None)])
    assert (found.lines(), found.to_dict()["screen_time_without_beat"]) == ([], None)


def test_walks_to_furniture_and_risings_connect_and_what_is_done_does_not() -> None:
    rows = [(Skill.LOCO, "sofa"), (Skill.LOCO, "floor"), (Skill.GETUP, "floor"), (Skill.TOUCH, "table")]
    told = [connects(Keyframe(skill=skill, caption="x", furniture=furniture)) for skill, furniture in rows]
    assert told == [True, False, True, False]


def test_a_plan_is_judged_as_if_the_body_reached_everything() -> None:
    keyframe = PlannedKeyframe(skill=Skill.SITDOWN, caption="sitting still", furniture="sofa", beat=1)
    script = LongScript(theme="t", beats=(SITS, READS), short_scripts=(), keyframes=(keyframe,))
    assert [one.acted for one in planned_beats(script).outcomes] == [False, True]


def test_hands_at_another_piece_than_a_beat_names_only_stand_for_it() -> None:
    words = "at the wardrobe in place of the washing machine"
    beats = [Beat(text="loads the washing machine"), Beat(text="hums")]
    found = acted_beats(beats, [shot(0, True, otherwise=(words,)), shot(1, True, otherwise=(words,))])
    first, second = found.outcomes
    assert (first.acted, first.stood_for, second.acted) == (False, True, True)
    assert first.why.endswith(words)
    assert any(words in line for line in found.lines())
    there = acted_beats(beats[:1], [shot(0, True, otherwise=(words,)), shot(0, True)])
    assert there.acted == 1, "it is seen at the right piece as well"
