"""A theme taken apart by rules: what happens in it, in the order of time, with the feeling each moment has."""

from __future__ import annotations

import itertools
import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from planner_service.scripts.emotions import feelings
from planner_service.themes.lexicon import idiom_in
from planner_service.themes.sentence_parser import (
    STRONG,
    has_verb,
    moments_of,
    sentences_of,
    state_words,
    without_subject,
)
from scene_graphs.errors import UserError

MAX_THEME_LENGTH: Final = 2000
"""Letters of a theme."""
LANGUAGE: Final = "Themes are read in English."
EXAMPLES: Final = (
    "A person enjoys a relaxed afternoon at home.",
    "A woman searches for her keys, misses the bus, gets angry and then calms down with a book.",
)

_OVER: Final = "is relieved, calm and at ease"
"""What somebody is who is "no longer nervous": the encoder does not see a negation."""
_BACK: Final = re.compile(r"\b(?:it|them)\b", re.IGNORECASE)
_FEELS: Final = re.compile(r"(?:feels?|felt|is|are|was|were)\b", re.IGNORECASE)
_LOUDER: Final = {"stressed": ("drunk", "angry", "sad", "hurried")}
"""Moods that a mere hint of another one does not end within a sentence: who is angry paces with anger."""
_ROOMS: Final = {
    "living_room": r"living[ -]?room|lounge|sitting room",
    "bedroom": r"bed ?rooms?",
    "dining_room": r"dining[ -]?room|kitchen",
    "study": r"study room|(?:in|into|to|from|of) (?:the|his|her|their) (?:study|library|office)|home office",
}


class ThemeError(UserError):
    """A theme that no story can be made of; the text says what was not understood and what would be."""

    def __init__(self, reason: str) -> None:
        super().__init__(f"{reason} Try for example: " + " Or: ".join(EXAMPLES), at="theme")
        self.reason = reason


@dataclass(frozen=True)
class Clause:
    """One event as the rules see it."""

    text: str
    """The user's words, without the subject."""
    query: str
    """What to look for in the library: the meaning of an idiom, or what "it" stands for put first."""
    emotion: str | None = None
    """None when the words show none; it is then judged from the whole."""
    sure: bool = False
    """Whether a word names the emotion; otherwise it is only hinted at."""
    room: str | None = None
    """The room it names."""
    active: bool = True
    """Whether it has a verb: a bare noun ("insomnia") must be nearer to a script to count."""
    sentence: int = 0
    """Index of its sentence in the theme."""


def clean(theme: object) -> str:
    """The theme without stray white space; ThemeError when it is empty, too long or not text."""
    if not isinstance(theme, str):
        raise ThemeError(f"it is {type(theme).__name__}, not text.")
    if any(unicodedata.category(letter) in ("Cc", "Cs", "Co") and letter not in "\t\n\r" for letter in theme):
        raise ThemeError("it has control characters or bytes that are not text.")
    lines = [" ".join(line.split()) for line in theme.splitlines()]
    text = "\n".join(line for line in lines if line)
    if not text:
        raise ThemeError("it is empty.")
    if len(text) > MAX_THEME_LENGTH:
        raise ThemeError(f"it has {len(text)} letters; at most {MAX_THEME_LENGTH} are read.")
    if not any(letter.isalpha() for letter in text):
        raise ThemeError(f"there is no word in {text[:60]!r}.")
    return text


def clauses_of(theme: str) -> tuple[Clause, ...]:
    """What happens, in the order of time. Raises ThemeError as `clean` does."""
    clauses: list[Clause] = []
    for number, sentence in enumerate(sentences_of(clean(theme))):
        said: list[Clause] = []
        for moment in moments_of(sentence):
            if re.search(r"[^\W\d_]", moment):
                before = [*clauses, *said][-1:]
                said.append(_clause(moment, before[0].text if before else "", number))
        clauses.extend(_merge_states(said))
    if not clauses:
        raise ThemeError(f"nothing happens in {theme[:60]!r}. {LANGUAGE}")
    return tuple(clauses)


def moods_of(clauses: Sequence[Clause], judged: Sequence[str | None]) -> tuple[str, ...]:
    """One emotion for each clause: what its words show, else what was `judged` of its meaning, else the mood it is in.

    A mood lasts until another one comes; "is dressing up and feels excited" is excited from the start.
    """
    moods: list[str] = []
    mood = "neutral"
    for index, (clause, judgement) in enumerate(zip(clauses, judged, strict=True)):
        after = clauses[index + 1] if index + 1 < len(clauses) else None
        if clause.emotion is not None:
            before = clauses[index - 1] if index else clause
            if not clause.sure and re.search(r"\brest", clause.text):
                mood = _rest(mood)
            elif clause.sure or mood not in _LOUDER.get(clause.emotion, ()) or before.sentence != clause.sentence:
                mood = clause.emotion
        elif mood == "neutral" and after is not None and after.sentence == clause.sentence and _FEELS.match(after.text):
            mood = after.emotion or mood
        moods.append(judgement if judgement is not None and mood == "neutral" else mood)
    return tuple(moods)


def _rest(mood: str) -> str:
    """How somebody rests who was in that mood."""
    return {"drunk": "drunk", "sad": "tired", "stressed": "tired", "tired": "tired"}.get(mood, "relaxed")


def clause_of(text: str, emotion: str) -> Clause:
    """An event that somebody else found, with the emotion it was given."""
    return replace(_clause(text, "", 0), text=text, emotion=emotion, sure=True, active=True)


def grouped(clauses: Sequence[Clause], most: int) -> tuple[Clause, ...]:
    """At most so many clauses: neighbours of one emotion are told together first, and the shortest of them."""
    left = list(clauses)
    while len(left) > most:
        costs = [
            (one.emotion != other.emotion, len(one.text) + len(other.text), index)
            for index, (one, other) in enumerate(itertools.pairwise(left))
        ]
        at = min(costs)[2]
        left[at : at + 2] = [_joined(left[at], left[at + 1], left[at + 1] if left[at + 1].emotion else left[at])]
    return tuple(left)


def rooms_in(text: str) -> tuple[str, ...]:
    """Room types that the text names, in its order."""
    found = [
        (match.start(), room) for room, words in _ROOMS.items() if (match := re.search(words, text, re.IGNORECASE))
    ]
    return tuple(room for _, room in sorted(found))


def _clause(moment: str, before: str, sentence: int) -> Clause:
    text = without_subject(moment)
    idiom = idiom_in(text)
    emotion, sure = (idiom.emotion, True) if idiom is not None else _emotion(text)
    if not sure:
        named, of_subject = _emotion(moment)  # "a tired student …"
        emotion, sure = (named, True) if of_subject else (emotion, sure)
    query = text
    if idiom is not None:
        query = idiom.meaning
    elif emotion == "relaxed" and state_words(text) and all(feeling.negated for feeling in feelings(text)):
        query = _OVER
    elif before and (_BACK.search(text) or (len(text.split()) <= 2 and emotion is None)):
        query = f"{before}, {text}"
    return Clause(text, query, emotion, sure, next(iter(rooms_in(text)), None), has_verb(text), sentence)


def _emotion(text: str) -> tuple[str | None, bool]:
    """The emotion the words show: drunk if that is named, else the last one named, else the last hint."""
    found = [feeling for feeling in feelings(text) if feeling.emotion != "neutral"]
    named = [feeling.emotion for feeling in found if feeling.sure]
    if named:
        return ("drunk" if "drunk" in named else named[-1]), True
    return (found[-1].emotion, False) if found else (None, False)


def _merge_states(clauses: list[Clause]) -> list[Clause]:
    """A bare feeling joined to what caused it ("finds it" + "becomes excited"), or to what is done in it.

    Being drunk and what is stressed with "very" stay moments of their own: they are worth showing.
    """
    merged: list[Clause] = []
    for clause in clauses:
        last = merged[-1] if merged else None
        if last is None:
            merged.append(clause)
        elif _joins(clause, last):
            merged[-1] = _joined(last, clause, clause)
        elif _joins(last, clause) and len(merged) == 1:
            merged[-1] = _joined(last, clause, last)
        else:
            merged.append(clause)
    return merged


def _joins(state: Clause, other: Clause) -> bool:
    """Whether `state` only says how `other` feels."""
    words = state_words(state.text)
    plain = words is not None and not STRONG.search(words) and "first" not in words and state.emotion != "drunk"
    return plain and (not other.sure or other.emotion == state.emotion) and state_words(other.text) is None


def _joined(first: Clause, second: Clause, feeling: Clause) -> Clause:
    return replace(
        first,
        text=f"{first.text} and {second.text}",
        query=f"{first.query} and {second.query.removeprefix(f'{first.text}, ')}",
        emotion=feeling.emotion,
        sure=feeling.sure,
        room=first.room or second.room,
        active=True,
    )
