"""What is said to users is one line that any terminal, log or answer can show."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from planner_service.user_errors import explain, printable


@given(st.text(max_size=2000), st.integers(2, 50))
def test_a_printable_text_is_one_short_line_of_utf_8(words: str, most: int) -> None:
    line = printable(words, most)
    assert len(line) <= most
    assert line.isprintable()
    line.encode("utf-8")
    assert printable(line, most) == line


@given(st.text(max_size=400))
def test_an_explanation_is_one_printable_line_of_every_word(words: str) -> None:
    line = explain(ValueError(words))
    assert line.isprintable()
    assert all(word in line for word in words.split() if word.isprintable())


def test_a_long_text_ends_with_an_ellipsis() -> None:
    assert printable("a" * 101) == "a" * 99 + "…"
    assert printable("a" + " " * 500 + "b") == "a…"
    assert printable("a" * 100) == "a" * 100
