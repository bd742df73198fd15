"""What a film leaves out: the middle of walks without words, and nothing else."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.motion import FPS, Motion, Phase, PhaseKind
from motion_backend.rendering.film_edit import ARRIVES, ENDS, SETS_OFF, WORTH, FilmEdit, last_deed
from motion_backend.skeleton import build_skeleton

LONG = 30 * FPS


def moved(*walks: tuple[int, int]) -> Motion:
    """Thirty seconds in which a hip swings as it does in a walk, with walks in these frames."""
    skeleton = build_skeleton(1.7)
    turns = np.zeros((LONG, len(skeleton.names), 4), np.float32)
    swing = 0.4 * np.sin(np.arange(LONG) * 2 * np.pi / 33)
    turns[..., 3] = 1.0
    turns[:, 1, 0], turns[:, 1, 3] = np.sin(swing), np.cos(swing)
    turns[:, 2, 0], turns[:, 2, 3] = np.sin(-swing), np.cos(swing)
    phases = tuple(Phase(PhaseKind.WALK, start, stop) for start, stop in walks)
    roots, contacts = np.zeros((LONG, 3), np.float32), np.ones((LONG, 4), np.float32)
    return replace(Motion(roots, turns, contacts, skeleton, np.zeros(LONG, np.int32)), phases=phases)


SPANS = st.lists(st.integers(0, LONG), max_size=8, unique=True).map(
    lambda ends: list(zip(sorted(ends)[::2], sorted(ends)[1::2], strict=False))
)


@given(SPANS, SPANS)
def test_only_walks_without_words_are_left_out_and_their_beginnings_and_ends_are_not(
    walks: list[tuple[int, int]], told: list[tuple[int, int]]
) -> None:
    edit = FilmEdit.of(moved(*walks), told)
    assert edit.kept[0][0] == 0
    assert edit.kept[-1][1] == LONG
    for start, stop in edit.left_out:
        assert any(one + SETS_OFF * FPS <= start < stop <= other - ARRIVES * FPS for one, other in walks)
        assert not any(one < stop and start < other for one, other in told), "no words are torn apart"
    assert len(edit) + sum(stop - start for start, stop in edit.left_out) == LONG
    assert all(one[1] < other[0] for one, other in pairwise(edit.kept))


@given(SPANS, SPANS)
def test_no_walk_goes_on_for_long_without_words(walks: list[tuple[int, int]], told: list[tuple[int, int]]) -> None:
    edit = FilmEdit.of(moved(*walks), told)
    seen, silent = np.zeros(LONG, bool), np.zeros(LONG, bool)
    for start, stop in edit.kept:
        seen[start:stop] = True
    for start, stop in walks:
        silent[start:stop] = True
    for start, stop in told:
        silent[start:stop] = False
    shown = np.concatenate([[False], silent[seen], [False]]).astype(np.int8)
    # Two walks that the film brings together may be silent one after the other.
    begins, ends = (np.flatnonzero(np.diff(shown) == step) for step in (1, -1))
    runs = (ends - begins).tolist()
    assert max(runs, default=0) <= len(walks) * (SETS_OFF + ARRIVES + 2 * WORTH) * FPS
    if len(walks) == 1:
        assert max(runs, default=0) <= (SETS_OFF + ARRIVES + 2 * WORTH) * FPS


def test_after_a_cut_the_legs_stand_as_they_did_before_it() -> None:
    motion = moved((0, LONG))
    ((start, stop),) = FilmEdit.of(motion, []).left_out
    other = np.linalg.norm(motion.local_rotations[start, 1] - motion.local_rotations[stop, 1])
    assert other < 0.08, "half a stride later it is 0.4 off"


def test_a_frame_of_the_motion_has_its_place_in_the_film() -> None:
    edit = FilmEdit(((0, 10), (20, 30)))
    assert [edit.frame(frame) for frame in (0, 9, 15, 20, 25)] == [0, 9, 10, 10, 15]
    assert (len(edit), edit.left_out) == (20, ((10, 20),))
    assert FilmEdit.whole(7).kept == ((0, 7),)
    assert FilmEdit.of(moved(), []).left_out == (), "nobody walks"


def test_a_film_leaves_soon_after_the_last_deed_and_never_before_its_end_is_asked_for() -> None:
    skeleton = build_skeleton(1.7)
    turns, roots = np.zeros((LONG, len(skeleton.names), 4), np.float32), np.zeros((LONG, 3), np.float32)
    turns[..., 3] = 1.0
    roots[:, 1] = np.interp(np.arange(LONG), [300, 330], [0.9, 0.5])
    motion = Motion(roots, turns, np.ones((LONG, 4), np.float32), skeleton, np.zeros(LONG, np.int32))
    assert last_deed(motion, 0) == 330 + ENDS * FPS
    assert last_deed(motion, 400) == 400 + ENDS * FPS, "nothing is done in these frames"
    assert last_deed(motion, LONG - 10) == LONG
    edit = FilmEdit.of(motion, [], 375)
    assert (edit.kept, edit.left_out) == (((0, 375),), ((375, LONG),))
