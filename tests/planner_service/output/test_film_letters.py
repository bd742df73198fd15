"""A film's words always fit into its picture, whatever they are and whatever is to be written with them."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from motion_backend.rendering.film_picture import BLACK, WHITE, lay_words, split
from motion_backend.rendering.renderer import to_linear
from motion_backend.rendering.title_place import PLACES
from planner_service.output.film import SHADE, TEXT_HEIGHT, TITLE_HEIGHT, WORDS_END
from planner_service.output.film_letters import lettered, titled

SIZES = st.sampled_from([(96, 54), (320, 180), (180, 320), (1280, 720)])
WORDS = st.text(st.characters(), max_size=300)
CLAUSE = "Sam walked listlessly over to the sofa and sat down wearily"


def laid(letters: np.ndarray | None, size: tuple[int, int], bottom: float, across: float = 0.5) -> np.ndarray:
    """How bright a grey picture is after words were laid on it."""
    planes = np.full((size[1] * 3 // 2, size[0]), 150, dtype=np.uint8)
    if letters is not None:
        lay_words(planes, letters, bottom, 0.5, across)
    return split(planes)[0]


@settings(max_examples=40, deadline=None)
@given(WORDS, SIZES)
def test_any_title_fits_into_any_picture(title: str, size: tuple[int, int]) -> None:
    letters = titled(title, size, TITLE_HEIGHT)
    assert (letters is None) or (letters.shape[0] <= size[1] and letters.shape[1] <= size[0])
    for place in PLACES:
        bottom = 0.5 if letters is None else place.box((letters.shape[0], letters.shape[1]), size)[3] / size[1]
        assert laid(letters, size, bottom, place.across).shape == size[::-1]
    assert title.strip() or letters is None, "no band without words"


@settings(max_examples=40, deadline=None)
@given(st.lists(st.lists(st.tuples(st.characters(), st.booleans()), max_size=90), max_size=2),
       SIZES)  # fmt: skip
def test_any_lines_fit_into_any_picture(lines: list[list[tuple[str, bool]]], size: tuple[int, int]) -> None:
    letters = lettered(lines, size, TEXT_HEIGHT)
    assert (letters is None) or letters.shape[1] <= size[0]
    assert laid(letters, size, WORDS_END).shape == size[::-1]


def test_a_title_wider_than_the_picture_stands_on_two_lines_whole() -> None:
    size = (1280, 720)
    short, long = titled("A Sad Day", size, TITLE_HEIGHT), titled(CLAUSE, size, TITLE_HEIGHT)
    assert short is not None
    assert long is not None
    assert long.shape[0] > 1.5 * short.shape[0]
    # Both lines have ink, and the picture has a rim on both sides.
    assert (long.max(axis=1) > 0.5).mean() > 0.5
    assert long.shape[1] < size[0]
    assert long[:, [0, -1]].max() == 0.0


def test_what_is_too_long_for_two_lines_ends_with_a_sign_that_it_was_cut() -> None:
    size = (320, 180)
    cut, cut_elsewhere = (titled(" ".join([CLAUSE] * count), size, TITLE_HEIGHT) for count in (5, 9))
    assert cut is not None
    assert cut_elsewhere is not None
    assert np.array_equal(cut, cut_elsewhere), "what is beyond the cut changes nothing"


def test_slanted_words_look_otherwise_than_upright_ones() -> None:
    upright, slanted = (lettered([[(one, slant) for one in "walk"]], (320, 180), 0.2) for slant in (False, True))
    assert upright is not None
    assert slanted is not None
    assert upright.shape != slanted.shape or not np.allclose(upright, slanted)


def test_words_are_four_and_a_half_times_as_bright_as_what_is_behind_them_even_on_white() -> None:
    planes = np.full((54 * 3 // 2, 96), 128, dtype=np.uint8)
    planes[:54] = WHITE
    letters = np.zeros((10, 40), dtype=np.float32)
    letters[4:6, 10:20] = 1
    lay_words(planes, letters, WORDS_END, SHADE)
    light, dark = (
        float(to_linear(np.array((level - BLACK) / (WHITE - BLACK)))) for level in (WHITE, planes[:54].min())
    )
    assert (light + 0.05) / (dark + 0.05) >= 4.5
