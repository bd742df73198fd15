"""What a theme says, told again: the words of a beat, which have no subject, as a predicate in the past."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from planner_service.narration.narrative_voice import Voice
from planner_service.narration.story_words import story_words
from planner_service.narration.tense import bases, form_of, in_past, inflected, is_adjective, past
from planner_service.scripts.script import Beat

WAS: Final = "\ue000"
"""Stands for was or were until the subject is known; no theme has it."""
_HELPERS: Final = {
    **dict.fromkeys(("is", "am", "are", "was", "were", "being", "be"), WAS),
    **dict.fromkeys(("isn't", "aren't", "wasn't", "weren't", "ain't"), f"{WAS} not"),
    **dict.fromkeys(("has", "have", "had", "having"), "had"), **dict.fromkeys(("hasn't", "haven't", "hadn't"), "had not"),
    **dict.fromkeys(("does", "do", "did", "doing"), "did"), **dict.fromkeys(("doesn't", "don't", "didn't"), "did not"),
    **dict.fromkeys(("can", "could"), "could"), **dict.fromkeys(("can't", "cannot", "couldn't"), "could not"),
    **dict.fromkeys(("will", "would"), "would"), **dict.fromkeys(("won't", "wouldn't"), "would not"),
    "must": "had to", "may": "might", "might": "might", "should": "should", "shouldn't": "should not",
}  # fmt: skip
_ADVERBS: Final = frozenset("again also always already finally hardly just never now once soon still then".split())
_NEGATED: Final = frozenset("cannot hardly neither never no nobody none not nothing refused without".split())
_SUBJECTS: Final = frozenset("he i it she that there they we which who you".split())
_OPEN: Final = frozenset(
    "a an the his her my their its it them him me some to up down out off away back on in into at over through about".split()
)
"""Words that follow a verb rather than a noun."""
_PERSON: Final = {
    "he": {"he": "they", "him": "them", "his": "their", "himself": "themself"},
    "she": {"she": "they", "her": "their", "hers": "theirs", "herself": "themself"},
    "they": {"they": "they", "them": "them", "their": "their", "themselves": "themself", "themself": "themself"},
}
_FIRST: Final = {"i": "they", "me": "them", "my": "their", "mine": "theirs", "myself": "themself"}
_DAYS: Final = (
    (r"\btomorrow (morning|afternoon|evening|night)\b", r"the next \1"), (r"\btomorrow\b", "the next day"),
    (r"\btonight\b", "that night"), (r"\btoday\b", "that day"), (r"\byesterday\b", "the day before"),
    (r"\bthis (morning|afternoon|evening)\b", r"that \1"), (r"\bago\b", "before"),
)  # fmt: skip
"""Days named from the writer's present, named from the story's."""


@dataclass(frozen=True)
class Predicate:
    """A clause in the past without its subject, `WAS` for was and were."""

    text: str
    verbs: frozenset[str]
    """Base forms that its verb may have."""
    adjective: str = ""
    """ "exhausted", where that is all it says of somebody."""

    @property
    def negated(self) -> bool:
        """Whether it says that something is not done."""
        return bool(_NEGATED & {*re.findall(r"\w+", self.text.lower())})


def event(beat: Beat, hero: str, voice: Voice) -> Predicate | None:
    """A beat as it happens, None where its grammar is not sure; `hero` are the theme's own pronouns for its person."""
    words = _own_clause(beat.text)
    at = next((i for i, word in enumerate(words) if not _is_adverb(word) or len(words) == i + 1), 0)
    told = _head(words[at:], beat.kind == "feeling")
    if told is None:
        return None
    words = [words[0][:1].lower() + words[0][1:], *words[1:]]
    verb, rest, ing = told
    adjective = " ".join(words[at:][len(words) - at - len(rest) :]) if verb == WAS else ""
    text = " ".join([*words[:at], verb, *_shifted(rest, ing)] if verb else [*words[:at], *_shifted(rest, ing)])
    text = _of_voice(text, hero, voice)
    for pattern, instead in _DAYS:
        text = re.sub(pattern, instead, text)
    plain = adjective and len(words) <= 4 and at == 0 and is_adjective(_bare(words[-1]).lower()) and "," not in text
    base = bases(_bare(words[at]).lower(), guessed=True) if verb != "did not" else bases(_bare(rest[0]).lower())
    return Predicate(text.rstrip(" .,;:!?"), frozenset(base), adjective.rstrip(" .,;:!?") if plain else "")


def thought(beat: Beat, hero: str, voice: Voice) -> str | None:
    """A memory: what its person thinks of, "remembered her mother", or a clause "she had lost the key"."""
    told = event(beat, hero, voice)
    if told is None or told.verbs & story_words().lists["minds"]:
        return told and told.text
    verb, _, rest = told.text.partition(" ")
    if verb in ("could", "would", "should", "might"):
        return None
    if rest.startswith("not ") and verb == "did":
        word, _, rest = rest[4:].partition(" ")
        had = f"had not {inflected(word, 'VBN')}"
    elif verb == "had":
        had = "had"
    else:
        base = next(iter(sorted(base for base in told.verbs if past(base) == verb)), "be" if verb == WAS else "")
        had = f"had {inflected(base, 'VBN')}" if base else ""
    return f"{voice['they']} {had} {rest}".strip() if had else None


def left_undone(beat: Beat, hero: str, voice: Voice) -> Predicate | None:
    """What is not done, or only wished for, as a predicate; None where its words do not say so themselves."""
    told = event(beat, hero, voice)
    return told if told and (told.negated or told.verbs & story_words().lists["wishes"]) else None


def _own_clause(text: str) -> list[str]:
    """Words up to a clause with a subject of its own, and without what joins them to those before."""
    words = re.sub(r"^(?:\W|and\b|but\b|then\b|so\b)+", "", text.strip(), flags=re.IGNORECASE).split()
    cut = story_words().lists["cut"]
    for at, word in enumerate(words[1:], start=1):
        if word.lower() in cut and _has_verb(words[at + 1 :]):
            return words[:at]
    return words


def _has_verb(words: Sequence[str]) -> bool:
    bare = [_bare(word).lower() for word in words]
    return any(word in _SUBJECTS or word in _HELPERS or form_of(word) in ("VBZ", "VBD") for word in bare)


def _head(words: Sequence[str], feeling: bool) -> tuple[str, Sequence[str], bool] | None:
    """The verb in the past, what follows it, and whether it was an -ing form; None where it is no verb."""
    if not words:
        return None
    words = [words[0][:1].lower() + words[0][1:], *words[1:]]
    first, rest = _bare(words[0]).lower().replace("’", "'"), words[1:]
    after = _bare(rest[0]).lower() if rest else ""
    if first in ("not", "without") or (first == "instead" and after == "of"):
        of = rest[1:] if first == "instead" else rest
        base = bases(_bare(of[0]).lower()) if of and form_of(_bare(of[0]).lower()) == "VBG" else ()
        return ("did not", [base[0], *of[1:]], False) if base else None
    if first == "to" and rest:
        return _head(rest, feeling)
    if first in _HELPERS:
        if _HELPERS[first] == WAS and form_of(after) == "VBG" and not feeling and bases(after):
            return _head(rest, feeling)
        return _HELPERS[first], rest, False
    if feeling and form_of(first) != "VBZ" and is_adjective(first) and after not in ("down", "up", "out"):
        return WAS, words, False
    if feeling and first in ("in", "at") and len(words) > 1:
        return WAS, words, False
    told = in_past(first)
    return (told, rest, form_of(first) == "VBG") if told else None


def _shifted(words: Sequence[str], ing: bool) -> list[str]:
    """What follows the verb, with the further verbs in it in the past too; what is quoted stays."""
    told: list[str] = []
    quoted = False
    bare = [_bare(word).lower().replace("’", "'") for word in words]
    for at, word in enumerate(words):
        before = bare[at - 1] if at else ""
        follows = bare[at + 1] if at + 1 < len(bare) else ""
        quoted_now = quoted or word[:1] in '"“'
        if word.count('"') % 2 or "“" in word or "”" in word:
            quoted = not quoted and "”" not in word
        form = form_of(bare[at]) if not quoted_now else None
        alone = bool(story_words().lists["alone"] & {*bases(bare[at])})
        joined = before in ("and", "or", "then") and (follows in _OPEN or at <= 1 or alone)
        base = joined and alone and bare[at] in bases(bare[at]) and not ing
        new = None
        if quoted_now:
            new = None
        elif bare[at] in ("is", "has", "does", "isn't", "hasn't", "doesn't", "cannot", "can't", "won't"):
            new = _HELPERS[bare[at]].replace(WAS, "was")
        elif bare[at] in ("am", "are", "aren't"):
            new = "was" if before == "i" else "were not" if bare[at] == "aren't" else "were"
        elif before in _SUBJECTS and bare[at] in _HELPERS and bare[at] not in ("was", "were"):
            new = _HELPERS[bare[at]]
        elif (
            (before in _SUBJECTS and (form == "VBZ" or before in ("i", "they", "we")))
            or (joined and form == "VBZ")
            or base
        ):
            new = in_past(bare[at])
        elif before in ("and", "or", "then") and form == "VBG" and ing:
            new = in_past(bare[at])
        told.append(word.replace(_bare(word), new) if new else word)
    return told


def _of_voice(text: str, hero: str, voice: Voice) -> str:
    """Pronouns for the theme's person made the voice's: its writer, "I", and he, she or they where that differs."""
    blanks = _FIRST | (_PERSON[hero] if hero != voice.pronouns else {})

    def pronoun(match: re.Match[str]) -> str:
        blank = blanks.get(match[0].lower())
        if blank is None:
            return match[0]
        if match[0].lower() == "her" and not re.match(
            r"\s+(?!(?:and|to|in|on|at|with|from|for)\b)\w", text[match.end() :]
        ):
            blank = "them"
        return voice[blank]

    return re.sub(r"\b[A-Za-z]+\b(?!['’]\w)", pronoun, text)


def _is_adverb(word: str) -> bool:
    lower = _bare(word).lower()
    return lower in _ADVERBS or (lower.endswith("ly") and not bases(lower) and lower not in ("lonely", "lovely"))


def _bare(word: str) -> str:
    return word.strip(".,;:!?\"“”()'’—–-")
