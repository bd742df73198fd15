"""The clauses of a scene: who does what, in the order it is told, and in which mood."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from planner_service.extraction.text import Line, TextScene
from planner_service.scripts.emotions import feelings
from planner_service.scripts.events import MAX_THEME_LENGTH, Clause, ThemeError, clauses_of, moods_of
from planner_service.scripts.sentences import moments_of, sentences_of
from planner_service.scripts.verbs import is_verb

_NAMED: Final = re.compile(
    r"^(?:(?:then|and|but|so|now|later|meanwhile|slowly|quietly|suddenly)[ ,]+)?"
    r"(?:(?:Mr|Mrs|Ms|Dr|Miss|Aunt|Uncle|Old|Young|Little)\s+)?"
    r"(?P<name>[A-Z][^\W\d_A-Z]+)(?:\s+[A-Z][^\W\d_]+)?\s+(?=(?P<verb>\w+))"
)
_KIND: Final = re.compile(
    r"^(?:the|an?|this|that|one)\s+(?:\w+\s+)?"
    r"(?P<kind>man|woman|boy|girl|guy|student|child|kid|father|mother|writer|worker)\s+(?=\w)", re.IGNORECASE,
)  # fmt: skip
_SOMETHING: Final = re.compile(
    r"^(?:(?:and|but|so|then)\s+)?(?:the|an?|his|her|their|my|our|its|this|that|these|those|every|no)\s+\w",
    re.IGNORECASE,
)
"""A subject that is no person we know of, where no person was found."""
_ADVERBIAL: Final = re.compile(
    r"^(?:later|early|late|that|this|one|the (?:next|same|following)|all|in|on|at|by|after|before|from|with|without"
    r"|during|for|under|still|now|then|once|again|back|home|alone|tired|half|not long|some|outside|inside|upstairs"
    r"|downstairs)\b"
    r"[^.;]{0,60}?[\s,](?=(?:he|she|they|I|we)\s+\w)", re.I,
)  # fmt: skip
_WHILE: Final = re.compile(r",?\s*\b(?:for|after|in|once in) a (?:little |long |short |good )?while\b,?", re.IGNORECASE)
_TOSSES: Final = re.compile(r"\b(toss\w*) and turn\w*", re.IGNORECASE)
_NAME_WORDS: Final = "James Thomas Charles Chris Nicholas Lucas Jonas Agnes Frances Iris Doris Louis Marcus Jess Tess"
_NAMES_IN_S: Final = frozenset(_NAME_WORDS.split())
_I: Final = re.compile(r"^(?:I|we)\s+(?=\w)")
_OTHER_WORDS: Final = """
The This That These Those There Then When While After Before Once Soon Now Later Outside Inside Nobody Everything
Nothing Something It He She They His Her Their Someone Somebody Everyone And But So Still At In On As If Finally
Suddenly Slowly Quietly Music Night Morning Evening Rain Silence Darkness Somehow Perhaps Maybe Not Only Just
"""
_NOT_NAMES: Final = frozenset(_OTHER_WORDS.split())
_PERSON: Final = re.compile(
    r"^(?:the|an?|this|our|one)\s+(?:\w+\s+)?(?:character|person|protagonist|hero|heroine)\b", re.IGNORECASE
)
SOMETHING: Final = "something"


@dataclass(frozen=True)
class Told:
    """A clause and who it is about."""

    clause: Clause
    who: str
    """A name or "man"; empty where nobody is named, `SOMETHING` for what is no person we know of."""
    mood: str
    line: Line


def clauses_in(scene: TextScene) -> tuple[Told, ...]:
    """What the scene tells, clause by clause."""
    found: list[tuple[Clause, str, Line]] = []
    who = ""
    for line in scene.lines:
        if line.spoken:
            continue
        for sentence in sentences_of(_TOSSES.sub(r"\1 about", _WHILE.sub("", line.text))):
            for moment in moments_of(sentence[:MAX_THEME_LENGTH]):
                moment = _ADVERBIAL.sub("", moment)  # "that night she …"
                named = _who(moment)
                who = who if named in ("", SOMETHING) else named
                found += [(clause, named or who, line) for clause in _clauses(_without_name(moment))]
    moods = moods_of([clause for clause, _, _ in found], [None] * len(found)) if found else ()
    return tuple(Told(clause, who, mood, line) for (clause, who, line), mood in zip(found, moods, strict=True))


def hero_of(told: tuple[Told, ...], deeds: tuple[bool, ...]) -> str:
    """Who does most of what a body can act; the first of those who do as much."""
    done = Counter(one.who for one, deed in zip(told, deeds, strict=True) if deed and one.who not in ("", SOMETHING))
    return max(done, key=lambda name: done[name]) if done else ""


def mood_of(text: str) -> str | None:
    """The emotion that most words of a text name, or None."""
    named = Counter(feeling.emotion for feeling in feelings(text) if feeling.sure and feeling.emotion != "neutral")
    return max(named, key=lambda emotion: named[emotion]) if named else None


def _clauses(moment: str) -> Iterator[Clause]:
    try:
        yield from clauses_of(moment)
    except ThemeError:
        return


def _who(moment: str) -> str:
    """Whose deed it is, where a name or a kind of person begins the clause."""
    if (kind := _KIND.match(moment)) is not None:
        return kind["kind"].lower()
    named = _NAMED.match(moment)
    if named is not None and _is_name(named):
        return named["name"]
    return SOMETHING if _SOMETHING.match(moment) and not _PERSON.match(moment) else ""


def _without_name(moment: str) -> str:
    """The clause without a name or "I" in front, which the reading of themes does not expect."""
    if (spoken := _I.match(moment)) is not None:
        return moment[spoken.end() :]
    named = _NAMED.match(moment)
    return moment[named.end() :] if named is not None and _is_name(named) else moment


def _is_name(match: re.Match[str]) -> bool:
    name = match["name"]
    if name.endswith("s") and name not in _NAMES_IN_S:
        return False  # "Clouds hung over the town"
    return name not in _NOT_NAMES and (is_verb(match["verb"]) or match["verb"].endswith("ly"))
