"""Shots and scenes: hard cuts to the picture, a fade is one cut, nothing is left out, nothing depends on luck."""

from __future__ import annotations

import io
from collections.abc import Sequence
from itertools import pairwise

import pytest
from examples import tries
from film_made import Drawn, Making, film_of, four_shots
from hypothesis import given
from hypothesis import strategies as st
from layers import sampled

from planner_service.extraction.shot_detection import (
    MAX_FRAMES,
    MAX_SCENE_SECONDS,
    MAX_SCENES,
    MIN_SCENE_SECONDS,
    Shot,
    scenes_in,
    scenes_of,
    shots_of,
)
from planner_service.extraction.subtitles import Cue
from planner_service.extraction.video import open_film


def shots(drawn: Sequence[Drawn], making: Making | None = None) -> tuple[Shot, ...]:
    return shots_of(open_film(io.BytesIO(film_of(drawn, making)), "a film"))


def cuts(found: Sequence[Shot]) -> list[float]:
    return [shot.start for shot in found[1:]]


@tries(6)
@given(st.lists(st.tuples(st.integers(8, 24), st.integers(1, 4)), min_size=1, max_size=5))
def test_hard_cuts_are_found_to_the_picture(lengths: list[tuple[int, int]]) -> None:
    drawn, colour = [], 0
    for pictures, step in lengths:
        colour = (colour + step) % 6
        drawn.append(Drawn(pictures / 12, colour))
    wanted = [round(sum(length for length, _ in lengths[:index]) / 12, 3) for index in range(1, len(lengths))]
    assert cuts(shots(drawn)) == wanted


@pytest.mark.parametrize(
    ("seconds", "through_black"), sampled([(1.0, False), (1.0, True), (2.0, False), (2.0, True)], 3)
)
def test_a_fade_is_one_cut_within_it(seconds: float, through_black: bool) -> None:
    found = cuts(shots([Drawn(4, 0, seconds, through_black), Drawn(3, 1)]))
    assert len(found) == 1
    assert 4 - seconds <= found[0] <= 4


def test_movement_and_a_flash_are_no_cuts() -> None:
    assert cuts(shots([Drawn(4, 4)])) == []
    assert cuts(shots([Drawn(2, 0), Drawn(1 / 12, 3), Drawn(2, 0)])) == []


def test_shots_follow_one_another() -> None:
    found = shots_of(open_film(io.BytesIO(four_shots()), "a film"))
    assert [(shot.start, shot.end) for shot in found] == [(0, 2), (2, 4.5), (4.5, 6), (6, 8)]
    for shot in found:
        assert sum(shot.look) == pytest.approx(3 * 255, abs=10)


def test_the_same_film_has_the_same_shots_and_progress_only_grows() -> None:
    told: list[tuple[str, float]] = []
    film = open_film(io.BytesIO(four_shots()), "a film")
    assert shots_of(film, lambda stage, share: told.append((stage, share))) == shots_of(film)
    assert told[-1] == ("shots", 1.0)
    assert [share for _, share in told] == sorted(share for _, share in told)


def test_a_film_of_one_picture_is_one_shot() -> None:
    found = shots([Drawn(1 / 12)], Making("avi", "mjpeg", options=()))
    (shot,) = found
    assert shot.start == 0
    assert shot.end == pytest.approx(1 / 12, abs=0.01)


LOOKS = [tuple(255 if bin_ == at else 0 for _ in range(3) for bin_ in range(16)) for at in (2, 7, 12)]


@st.composite
def cut_films(draw: st.DrawFn) -> list[Shot]:
    """Shots that follow one another, of three looks."""
    found, start = [], 0.0
    for length in draw(st.lists(st.floats(0.6, 400), min_size=1, max_size=60)):
        end = round(start + length, 3)
        found.append(Shot(start, end, draw(st.sampled_from(LOOKS))))
        start = end
    return found


@tries(50)
@given(cut_films(), st.lists(st.tuples(st.floats(0, 3000), st.floats(0.1, 8)), max_size=20))
def test_scenes_are_the_whole_film_and_each_is_bounded(film: list[Shot], said: list[tuple[float, float]]) -> None:
    cues = [Cue(start, start + length, "words") for start, length in said if start + length < film[-1].end]
    scenes = scenes_in(film, cues)
    assert [scene.number for scene in scenes] == list(range(1, len(scenes) + 1))
    assert len(scenes) <= MAX_SCENES
    assert [scenes[0].start, *(scene.end for scene in scenes)] == [*(scene.start for scene in scenes), film[-1].end]
    assert sum(len(scene.cues) for scene in scenes) == len(cues)
    for scene in scenes:
        assert scene.start < scene.end
        assert scene.shots
        assert 1 <= len(scene.times) <= MAX_FRAMES
        assert list(scene.times) == sorted(set(scene.times))
        assert scene.start <= scene.times[0]
        assert scene.times[-1] <= scene.end
        assert all(after - before >= 1 for before, after in pairwise(scene.times)), "one frame a second at most"


def row(*parts: tuple[float, int]) -> list[Shot]:
    found, start = [], 0.0
    for length, look in parts:
        found.append(Shot(start, start + length, LOOKS[look]))
        start += length
    return found


def test_a_scene_ends_where_the_picture_changes_for_good() -> None:
    talk = [(3.0, 0), (3.0, 1), (3.0, 0), (3.0, 1)]
    scenes = scenes_in(row(*talk, (10.0, 2), (10.0, 2)), [])
    assert [(scene.start, scene.end) for scene in scenes] == [(0, 12), (12, 32)]


def test_a_scene_does_not_end_while_somebody_speaks() -> None:
    film = row((12.0, 0), (12.0, 2))
    assert len(scenes_in(film, [])) == 2
    one_look = [*film[:1], Shot(12, 24, tuple((a + b) // 2 for a, b in zip(LOOKS[0], LOOKS[2], strict=True)))]
    assert len(scenes_in(one_look, [])) == 2
    assert len(scenes_in(one_look, [Cue(11.0, 13.0, "I am speaking")])) == 1


def test_a_long_shot_is_several_scenes_and_a_short_film_is_one() -> None:
    scenes = scenes_in(row((3 * MAX_SCENE_SECONDS, 0)), [])
    assert [scene.end - scene.start for scene in scenes] == [MAX_SCENE_SECONDS] * 3
    film = open_film(io.BytesIO(film_of([Drawn(MIN_SCENE_SECONDS / 4, 0), Drawn(MIN_SCENE_SECONDS / 4, 1)])), "a film")
    assert len(scenes_of(film, [])) == 1


def unlike(share: float) -> list[tuple[int, ...]]:
    """Two looks that are so far apart, from 0 to 1."""
    moved = round(255 * share)
    return [
        tuple(255 if bin_ == 2 else 0 for _ in range(3) for bin_ in range(16)),
        tuple({2: 255 - moved, 7: moved}.get(bin_, 0) for _ in range(3) for bin_ in range(16)),
    ]


def parted(share: float, cues: tuple[Cue, ...] = (), first: float = 12.0) -> bool:
    """Whether there is a scene's end between two shots that are so far apart."""
    looks = unlike(share)
    return len(scenes_in([Shot(0.0, first, looks[0]), Shot(first, first + 20, looks[1])], list(cues))) == 2


def test_a_scene_ends_at_a_change_of_three_tenths_and_of_more_where_somebody_speaks() -> None:
    near, during = (Cue(8.0, 10.5, "before"),), (Cue(11.0, 13.0, "over it"),)
    quiet = (Cue(8.0, 9.9, "long before"), Cue(14.1, 15.0, "long after"))
    for cues, least in (((), 0.3), (quiet, 0.3), (near, 0.4), (during, 0.7)):
        assert not parted(least - 0.02, cues), cues
        assert parted(least + 0.02, cues), cues


def test_no_scene_is_shorter_than_six_seconds() -> None:
    assert not parted(1.0, first=MIN_SCENE_SECONDS - 0.1)
    assert parted(1.0, first=MIN_SCENE_SECONDS + 0.1)


def test_who_is_shown_again_within_three_shots_is_in_the_same_scene() -> None:
    for between, one in ((2, True), (3, False)):
        film = row((7.0, 0), *[(2.5, 1)] * between, (20.0, 0))
        assert (len(scenes_in(film, [])) == 1) == one, between
