"""Free words to one of the nine emotions: what keyframes, clips and sentences say, read with one list of words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache, lru_cache
from typing import Final, NamedTuple

from motion_backend.motion import Emotion
from scene_graphs.data_tables import read_table, table

Stems = Mapping[Emotion, tuple[str, ...]]
"""Words by the emotion they stand for; "*" stands for any letters."""
_NEGATION: Final = re.compile(
    r"(?:n't|\b(?:not|cannot|no|never|without|hardly|no longer|stops? being))\s+(?:(?!stop|help)\w+\s+){0,2}$"
    r"|\b(?:nobody|no one|no-one)\s+(?:\w+\s+){0,4}$"
)
_OVER: Final = re.compile(r"\b(?:no longer|stops? being)\s+(?:\w+\s+){0,2}$")


@table
class Naming:
    """The words of one emotion."""

    emotion: Emotion
    words: tuple[str, ...]
    """Stems, and sayings of several words."""
    names: tuple[str, ...] = ()
    """Words as plain as its own name."""
    opposite: Emotion | None = None
    """What is meant where its words are denied."""
    over: Emotion | None = None
    """What one feels when it is over; who never felt it feels nothing."""


@table
class EmotionWords:
    """All nine, what a body shows most first."""

    emotions: tuple[Naming, ...]


class Feeling(NamedTuple):
    """An emotion found in a text."""

    emotion: Emotion
    sure: bool
    """Whether a word names it; False when a word only hints at it."""
    start: int
    """Where in the text."""
    end: int
    negated: bool
    """Whether the text names its opposite and denies it."""


@cache
def naming_words() -> Stems:
    """The words that name each emotion, what a body shows most first."""
    return {naming.emotion: naming.words for naming in _namings()}


def find(text: str, stems: Stems, sure: bool) -> list[Feeling]:
    """Every emotion that words of `stems` stand for in a text; "not happy" is sad, and "no longer sad" relaxed."""
    found = []
    for naming in _namings():
        for match in _pattern(stems.get(naming.emotion, ())).finditer(text):
            before = text[: match.start()].lower()
            negated = _NEGATION.search(before) is not None
            denied = naming.opposite or (naming.over if _OVER.search(before) else None)
            emotion = denied if negated else naming.emotion
            if emotion is not None:
                found.append(Feeling(emotion, sure, match.start(), match.end(), negated))
    return found


def whole(found: Iterable[Feeling]) -> list[Feeling]:
    """Without words that are part of a longer saying ("tears" in "tears up"), in the order of the text."""
    found = list(found)
    kept = (one for one in found if not any(_within(one, other) for other in found))
    return sorted(kept, key=lambda feeling: feeling.start)


@lru_cache(maxsize=4096)
def emotion_of(words: str) -> Emotion | None:
    """The emotion that a keyframe's "emotion/style" or a clip's means, or None when no word of it is known.

    Plain names win over words like "uncomfortable", and among several the one that a body shows most: "stressed,
    uncomfortable, tired" is stressed.
    """
    found = find(words, _plain_names(), sure=True) or whole(find(words, naming_words(), sure=True))
    meant = {feeling.emotion for feeling in found}
    return next((emotion for emotion in naming_words() if emotion in meant), None)


def _within(one: Feeling, other: Feeling) -> bool:
    return other.start <= one.start and one.end <= other.end and one.end - one.start < other.end - other.start


def _namings() -> tuple[Naming, ...]:
    words: EmotionWords = read_table("motion_backend", "emotion_words.toml", EmotionWords)
    return words.emotions


@cache
def _plain_names() -> Stems:
    return {naming.emotion: (naming.emotion.value, *naming.names) for naming in _namings()}


@cache
def _pattern(stems: tuple[str, ...]) -> re.Pattern[str]:
    words = "|".join(stem.replace("*", r"\w*") for stem in stems)
    return re.compile(rf"\b(?:{words})\b" if words else r"(?!)", re.IGNORECASE)
