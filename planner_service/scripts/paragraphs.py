"""Paragraphs: sentences of scenes brought to a length that reads well, and laid out as text with spans."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from planner_service.scripts.frames import Sentence

MIN_SENTENCES, MAX_SENTENCES = 3, 6
"""Sentences in a paragraph, where the story is long enough for it."""


@dataclass(frozen=True)
class Span:
    """A stretch of a told text, end exclusive, and the keyframes it tells."""

    start: int
    end: int
    keyframes: tuple[int, ...]


def balanced(scenes: Sequence[Sequence[Sentence]]) -> list[list[Sentence]]:
    """One paragraph a scene; short ones join a neighbour, long ones are parted in the middle."""
    joined: list[list[Sentence]] = []
    for scene in scenes:
        short = bool(joined) and min(len(scene), len(joined[-1])) < MIN_SENTENCES
        if short and (len(scene) + len(joined[-1]) <= MAX_SENTENCES or not scene):
            joined[-1] += scene
        else:
            joined.append(list(scene))
    for index in range(len(joined) - 1, 0, -1):
        if len(joined[index]) < MIN_SENTENCES:
            joined[index - 1] += joined.pop(index)
    if len(joined) > 1 and len(joined[0]) < MIN_SENTENCES:
        joined[0] += joined.pop(1)
    return [part for paragraph in joined for part in _parted(paragraph)]


def _parted(paragraph: list[Sentence]) -> list[list[Sentence]]:
    """A paragraph as it is, or parts of it where a sentence about the body can begin the next with the name."""
    places = range(MIN_SENTENCES, len(paragraph) - MIN_SENTENCES + 1)
    able = [place for place in places if paragraph[place].named is not None]
    if len(paragraph) <= MAX_SENTENCES or not able:
        return [paragraph]
    at = min(able, key=lambda place: abs(2 * place - len(paragraph)))
    return [*_parted(paragraph[:at]), *_parted([paragraph[at].with_name(), *paragraph[at + 1 :]])]


def laid_out(paragraphs: Sequence[Sequence[Sentence]]) -> tuple[str, tuple[Span, ...]]:
    """The text, paragraphs parted by empty lines, and which of its characters tell which keyframes."""
    text = ""
    spans: list[Span] = []
    for number, paragraph in enumerate(paragraphs):
        text += "\n\n" if number else ""
        for place, sentence in enumerate(paragraph):
            text += " " if place else ""
            for position, (words, keyframes) in enumerate(sentence.pieces):
                words = words[:1].upper() + words[1:] if position == 0 else words
                if keyframes:
                    spans.append(Span(len(text), len(text) + len(words), keyframes))
                text += words
    return text, tuple(spans)
