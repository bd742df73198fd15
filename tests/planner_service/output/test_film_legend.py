"""What slanted words mean is said once in a film, where one first asks."""

from __future__ import annotations

import numpy as np
from acted import SMALL, walked

from motion_backend.rendering.film_picture import BLACK, WHITE
from planner_service.narration.told import Span, Told
from planner_service.output.film import LEGEND_ENDS, WORDS_END, Filmed, film_plan

SIZE = (640, 360)
TEXT = "She came home. She put down a parcel. She opened a letter."
WORDS = ("She came home", "She put down", "She opened")


def filmed(thoughts: tuple[str, ...]) -> Filmed:
    """Three sentences of 4 s each, of which some words are not seen."""
    motion = walked("walk").motion
    spans = tuple(Span(TEXT.index(word), TEXT.index(word) + len(word), (k,)) for k, word in enumerate(WORDS))
    unseen = tuple(Span(TEXT.index(word), TEXT.index(word) + len(word), ()) for word in thoughts)
    return Filmed(SMALL, motion, Told("", TEXT, spans, unseen), ((0, 120), (120, 240), (240, 360)))


def with_legend(filmed: Filmed) -> list[bool]:
    """Whether anything is written below the words, when each of them is shown."""
    plan, (width, height) = film_plan(filmed, SIZE), SIZE
    grey = np.full((height * 3 // 2, width), (BLACK + WHITE) // 2, dtype=np.uint8)
    below = slice(round(WORDS_END * height) + 2, round(LEGEND_ENDS * height))
    shown = [plan.dressed((line.start + line.stop) // 2, grey.copy()) for line in filmed.words]
    return [bool((picture[below] != grey[below]).any()) for picture in shown]


def test_what_italics_mean_stands_under_the_first_words_that_have_some_and_under_no_others() -> None:
    assert with_legend(filmed(("a parcel", "a letter"))) == [False, True, False]
    assert with_legend(filmed(("a letter",))) == [False, False, True]


def test_a_film_without_italics_says_nothing_of_them() -> None:
    assert with_legend(filmed(())) == [False, False, False]
