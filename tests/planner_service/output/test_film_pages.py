"""The told words of a film stand for as long as they are read, and a film shows the story that was made."""

from __future__ import annotations

from dataclasses import replace
from itertools import accumulate, pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.motion import FPS
from planner_service.narration.told import Span, Told
from planner_service.output.film import Filmed
from planner_service.output.film_pages import LETTERS, QUICK, READ, STAYS, subtitles
from planner_service.pipeline import Pipeline, StoryRequest


@pytest.mark.parametrize("letters", [5, 12, 25, 40, 55, 66])
def test_words_stand_for_as_long_as_their_letters_ask_within_bounds(letters: int) -> None:
    text = ("He sat down for a while and looked at the door that nobody opened")[:letters].strip()
    told = Told("A title", text, (Span(0, len(text), (0,)),))
    (shown,) = subtitles(told, [(0, 60 * FPS)], FPS)
    least, first, most = READ
    assert shown.text == text
    read = min(max(least, first + len(text) / LETTERS), most)
    assert (shown.stop - shown.start) / FPS == pytest.approx(max(read, STAYS), abs=1 / FPS)
    (brief,) = subtitles(told, [(0, round(read * FPS))], FPS)
    assert (brief.stop - brief.start) / FPS == pytest.approx(read, abs=1 / FPS), "it is over, and was read"


def test_words_go_when_what_they_tell_is_over_as_soon_as_they_could_be_read() -> None:
    text = "He then remembered his wife and drank a whole bottle of old wine."
    told = Told("", text, (Span(0, len(text), (0,)),))
    (long,), (short,) = (subtitles(told, [(0, over), (over, 60 * FPS)], FPS) for over in (12 * FPS, 2 * FPS))
    assert long.stop <= 12 * FPS, "there was time enough while he drank"
    asked = min(READ[1] + len(text) / LETTERS, READ[2])
    assert short.start == 0
    assert short.stop / FPS == pytest.approx(QUICK * asked, abs=0.1), "it is read quickly, and he is gone"


def test_what_is_told_first_and_done_last_is_shown_when_it_is_done() -> None:
    text = "Before he watered the plant, Idris opened the curtains and stretched."
    spans = spans_of(text, "Before he watered the plant", "opened the curtains", "stretched")
    last, *rest = spans
    told = Told(
        "", text, (replace(last, keyframes=(2,)), *(replace(one, keyframes=(k,)) for k, one in enumerate(rest)))
    )
    shown = subtitles(told, [(0, 200), (200, 400), (400, 600)], FPS)
    assert ["opened" in shown[0].text, "Before" in shown[-1].text] == [True, True]
    assert shown[0].start < 200
    assert shown[-1].stop > 400


def test_a_film_is_of_the_home_the_motion_and_the_words_of_its_story() -> None:
    story = Pipeline().make(StoryRequest("A person sits down on the sofa."))
    filmed = Filmed.of(story)
    assert (filmed.home, filmed.motion, filmed.told) == (story.planned.home, story.motion, story.planned.told)
    assert (filmed.segments, filmed.role) == (story.segments, story.role)


PARTS = st.lists(
    st.tuples(
        st.text("abcdefg", min_size=1, max_size=30),
        st.sampled_from([" ", ", ", " and ", ", and ", ". ", " who had gone, ", ", when it rained, ", '." ']),
        st.booleans(),
        st.booleans(),
    ),
    min_size=1,
    max_size=14,
)


def told_of(parts: list[tuple[str, str, bool, bool]]) -> Told:
    """Words with what joins them; some tell a keyframe, some are not seen."""
    text, spans, thoughts = "", list[Span](), list[Span]()
    for words, joint, tells, thought in parts:
        place = Span(len(text), len(text) + len(words), ())
        spans += [replace(place, keyframes=(len(spans),))] if tells and not thought else []
        thoughts += [place] if thought else []
        text += words + joint
    return Told("", text.rstrip(" ,") + ".", tuple(spans), tuple(thoughts))


def spans_of(text: str, *words: str) -> tuple[Span, ...]:
    """Where words stand that tell one keyframe after the other."""
    return tuple(Span(text.index(word), text.index(word) + len(word), (k,)) for k, word in enumerate(words))


def letters_of(text: str) -> str:
    return "".join(letter for letter in text if letter.isalnum())


@given(PARTS, st.lists(st.integers(60, 400), min_size=14, max_size=14))
def test_what_is_seen_is_always_shown_in_order_and_what_is_not_is_slanted(
    parts: list[tuple[str, str, bool, bool]], lengths: list[int]
) -> None:
    told = told_of(parts)
    ends = list(accumulate(lengths))
    segments = list(pairwise([0, *ends]))[: max(len(told.spans), 1)]
    shown = subtitles(told, segments, FPS)
    if not told.spans:
        assert shown == []
        return
    assert all(one.stop <= other.start for one, other in pairwise(shown))
    assert all(not line.text.endswith((",", ";", ":", "–", " ")) for line in shown)
    plain = "".join(
        letter for line in shown for row in line.lines for letter, slanted in row if letter.isalnum() and not slanted
    )
    assert plain == letters_of(told.events)


def test_a_sentence_is_parted_only_where_a_clause_ends_and_its_beginning_is_never_left_out() -> None:
    text = "She got a call that her grandson was born, danced through the room and sat down."
    spans = spans_of(text, "got a call", "danced", "sat")
    told = Told("", text, spans)
    apart = subtitles(told, [(0, 300), (300, 600), (600, 900)], FPS)
    assert [line.text for line in apart] == [
        "She got a call that her grandson was born…",
        "danced through the room…",
        "and sat down.",
    ]
    # The first is done in no time: nothing of it is lost.
    soon = subtitles(told, [(0, 3), (3, 600), (600, 900)], FPS)
    assert soon[0].text == "She got a call that her grandson was born, danced through the\nroom…"
    assert soon[-1].text == "and sat down."


def test_words_of_one_clause_are_parted_where_their_deeds_are_far_apart() -> None:
    text = "He sat down reading a book."
    told = Told("", text, (Span(0, 11, (0,)), Span(12, 26, (1,))))
    assert [line.text for line in subtitles(told, [(0, 60), (60, 360)], FPS)] == [text]
    far = subtitles(told, [(0, 300), (300, 600)], FPS)
    assert [(line.text, line.start < 300) for line in far] == [("He sat down…", True), ("reading a book.", False)]


def test_words_that_are_not_seen_are_slanted_and_whole_subtitles_of_them_left_out() -> None:
    text = (
        "She came home, waited nervously at the window, and sat down. "
        + "He had been gone for a year. " * 5
        + "She slept."
    )
    waits, gone = text.index("waited"), text.index("He had")
    spans = spans_of(text, "came home", "sat down", "She slept")
    thoughts = (Span(waits, text.index(", and sat"), ()), Span(gone, text.index(" She slept"), ()))
    shown = subtitles(Told("", text, spans, thoughts), [(0, 300), (300, 600), (600, 1200)], FPS)
    slanted = "".join(letter for line in shown for row in line.lines for letter, slants in row if slants)
    assert slanted.startswith("waited nervously at the window")
    assert shown[-1].text.endswith("She slept.")
    assert all(any(not slants for row in line.lines for _, slants in row) for line in shown)


def test_words_of_what_something_stands_for_are_shown_slanted_and_those_of_nothing_left_out() -> None:
    text = "He unlocked the door. Drop keys. Nobody came. He slept."
    spans = spans_of(text, "He unlocked the door.", "Drop keys.", "He slept.")
    unseen = [text.index(words) for words in ("Drop keys.", "Nobody came.")]
    told = Told("", text, spans, (Span(unseen[0], unseen[1] + len("Nobody came."), ()),))
    shown = subtitles(told, [(0, 200), (200, 400), (400, 600)], FPS)
    assert any(line.text.startswith("Drop keys.") and line.slanted for line in shown)
