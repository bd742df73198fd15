"""Told words of a film stand from where what they tell is done, and can be read."""

from __future__ import annotations

from itertools import accumulate, pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.body.cast import Role
from motion_backend.motion import FPS, Character, Motion, Phase, PhaseKind, Skill
from motion_backend.rotations import IDENTITY
from motion_backend.skeleton import build_skeleton
from planner_service.narration.told import Span, Told
from planner_service.output.film_deeds import deeds
from planner_service.output.film_pages import subtitles

LEGIBLE, SHORTEST = 17.0, 1.2
"""Letters a second at most, and seconds at least, of words in a film."""


def with_phases(*phases: tuple[PhaseKind, int]) -> Motion:
    """A body that does one after the other, for so many frames each."""
    skeleton = build_skeleton(Character().height)
    ends = list(accumulate((long for _, long in phases), initial=0))
    return Motion(
        root_positions=np.zeros((ends[-1], 3), np.float32),
        local_rotations=np.tile(np.float32(IDENTITY), (ends[-1], len(skeleton.names), 1)),
        contacts=np.ones((ends[-1], 4), np.float32),
        skeleton=skeleton,
        actions=np.zeros(ends[-1], np.int32),
        phases=tuple(Phase(kind, *edges) for (kind, _), edges in zip(phases, pairwise(ends), strict=True)),
    )


def told_of(*keyframes: tuple[int, ...]) -> Told:
    return Told("", "x" * 9 * len(keyframes), tuple(Span(9 * n, 9 * n + 8, k) for n, k in enumerate(keyframes)))


def test_a_deed_begins_where_the_way_to_it_ends() -> None:
    motion = with_phases((PhaseKind.STANDUP, 40), (PhaseKind.WALK, 90), (PhaseKind.TOUCH, 60))
    assert deeds(told_of((0,)), motion, [(0, 190)], Role(captions={0: (Skill.TOUCH, "touch")})) == [130]


def test_the_way_to_a_deed_that_the_same_words_tell_is_no_deed_and_one_told_by_itself_is() -> None:
    motion = with_phases((PhaseKind.WALK, 90), (PhaseKind.TOUCH, 60))
    segments = [(0, 90), (90, 150)]
    assert deeds(told_of((0, 1)), motion, segments, Role()) == [90, 90]
    assert deeds(told_of((0,), (1,)), motion, segments, Role()) == [0, 90]


@pytest.mark.parametrize(("stands", "begins"), [(90, 120), (30, 0)])
def test_who_goes_somewhere_and_stands_there_for_a_while_does_it_standing(stands: int, begins: int) -> None:
    motion = with_phases((PhaseKind.WALK, 120), (PhaseKind.STAND, stands))
    role = Role(captions={0: (Skill.LOCO, "wave with the right hand")})
    assert deeds(told_of((0,)), motion, [(0, 120 + stands)], role) == [begins]


def test_who_goes_about_with_something_in_hand_does_it_from_where_they_took_it() -> None:
    motion = with_phases((PhaseKind.WALK, 120), (PhaseKind.STAND, 90))
    said = (Skill.LOCO, "walk while talking on the phone with the right hand")
    (begins,) = deeds(told_of((0,)), motion, [(0, 210)], Role(captions={0: said}))
    assert begins < 60


@pytest.mark.parametrize("caption", ["rush anxiously forward", "walk happily"])
def test_what_is_done_on_the_way_is_not_told_of_who_has_arrived(caption: str) -> None:
    motion = with_phases((PhaseKind.WALK, 120), (PhaseKind.STAND, 90))
    assert deeds(told_of((0,)), motion, [(0, 210)], Role(captions={0: (Skill.LOCO, caption)})) == [0]


def test_nobody_is_asleep_who_is_not_on_the_way_down() -> None:
    motion = with_phases((PhaseKind.WALK, 60), (PhaseKind.EDGE, 30), (PhaseKind.LIEDOWN, 100))
    motion.root_positions[:, 1] = np.interp(np.arange(190), [100, 140], [1.0, 0.4])
    captions = {0: (Skill.LIEDOWN, "lie down")}
    (awake,), (asleep,) = (
        deeds(told_of((0,)), motion, [(0, 190)], Role(asleep=frozenset(who), captions=captions)) for who in ((), (0,))
    )
    assert awake == 60
    assert 110 < asleep < 130


def test_who_lies_already_is_asleep_at_once() -> None:
    motion = with_phases((PhaseKind.LIEDOWN, 100))
    role = Role(asleep=frozenset((0,)), captions={0: (Skill.LIEDOWN, "lie down")})
    assert deeds(told_of((0,)), motion, [(0, 100)], role) == [0]


WAITS = st.lists(st.tuples(st.integers(45, 300), st.floats(0.0, 0.9), st.integers(4, 40)), min_size=1, max_size=8)


@given(WAITS)
def test_words_can_be_read_and_none_stands_before_its_deed_but_to_be_read(
    rows: list[tuple[int, float, int]],
) -> None:
    ends = list(accumulate((long for long, _, _ in rows), initial=0))
    segments = list(pairwise(ends))
    own = [start + round(share * (stop - start)) for (start, stop), (_, share, _) in zip(segments, rows, strict=True)]
    words = ["a" * letters for _, _, letters in rows]
    starts = list(accumulate((len(word) + 2 for word in words), initial=0))
    spans = tuple(Span(at, at + len(word), (k,)) for k, (at, word) in enumerate(zip(starts, words, strict=False)))
    shown = subtitles(Told("", ". ".join(words) + ".", spans), segments, FPS, 0, own)
    seconds = sum(max(1.7, (len(word) + 2) / 15) for word in words)
    if seconds < ends[-1] / FPS * 0.9:
        assert all(line.stop - line.start >= SHORTEST * FPS for line in shown)
        assert all(len(line.text) <= LEGIBLE * (line.stop - line.start) / FPS for line in shown)
    for line, following in pairwise(shown):
        deed = own[words.index(line.text.split(".")[0])]
        hurried = following.start - line.start <= 1.1 * max(1.6, len(line.text) / 15) * FPS + 2
        assert line.start >= deed or hurried
    assert "".join(c for line in shown for c in line.text if c.isalpha()) == "".join(words)


def test_a_film_may_end_before_somebody_falls_asleep() -> None:
    motion = with_phases((PhaseKind.WALK, 60))
    role = Role(asleep=frozenset({1}), captions={1: (Skill.LIEDOWN, "lie down")})
    assert deeds(told_of((0,), (1,)), motion, [(0, 60), (60, 60)], role) == [0, 60]
