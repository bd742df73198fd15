"""The told words of a film stand for as long as they are read, and a film shows the story that was made."""

from __future__ import annotations

import pytest

from motion_backend.motion import FPS
from planner_service.narration.told import Span, Told
from planner_service.output.film import LETTERS, READ, Filmed, subtitles
from planner_service.pipeline import Pipeline, StoryRequest


@pytest.mark.parametrize("letters", [5, 12, 25, 40, 55, 66])
def test_words_stand_for_as_long_as_their_letters_ask_within_bounds(letters: int) -> None:
    text = ("He sat down for a while and looked at the door that nobody opened")[:letters].strip()
    told = Told("A title", text, (Span(0, len(text), (0,)),))
    (shown,) = subtitles(told, [(0, 60 * FPS)], FPS)
    least, first, most = READ
    assert shown.text == text
    assert (shown.stop - shown.start) / FPS == pytest.approx(
        min(max(least, first + len(text) / LETTERS), most), abs=1 / FPS
    )


def test_a_film_is_of_the_home_the_motion_and_the_words_of_its_story() -> None:
    story = Pipeline().make(StoryRequest("A person sits down on the sofa."))
    filmed = Filmed.of(story)
    assert (filmed.home, filmed.motion, filmed.told) == (story.planned.home, story.motion, story.planned.told)
    assert (filmed.segments, filmed.role) == (story.segments, story.role)
