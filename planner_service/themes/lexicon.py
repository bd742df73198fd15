"""English words: what they may be, their base forms, and their inflected forms.

All of it is lemminflect's, a dictionary of English inflection; it is imported when the first word is asked for.
"""

from __future__ import annotations

import re
from functools import cache, cached_property, lru_cache
from typing import Annotated, Final

from pydantic import BeforeValidator

from scene_graphs.data_tables import read_table, table

Words = Annotated[frozenset[str], BeforeValidator(lambda words: frozenset(words.split()))]
"""Words apart by blanks."""


@table
class EnglishGrammar:
    """data/english_grammar.toml: words that tell one clause from the next; what each list is for stands there."""

    subjects: Words
    marks: Words
    numbers: Words
    times: Words
    prepositions: Words
    adverbs: Words
    joints: Words
    earlier: Words
    with_gerund: Words
    aspects: Words
    postures: Words
    denials: Words
    refusals: Words
    wishes: Words
    not_verbs_after_to: Words
    be: Words
    have: Words
    do: Words
    modals: Words
    never_verbs: Words
    more_verbs: Words
    slang: dict[str, str]
    contractions: dict[str, str]
    rewrites: tuple[tuple[str, str], ...]

    @cached_property
    def auxiliaries(self) -> frozenset[str]:
        """Forms of be, have and do, and modals."""
        return self.be | self.have | self.do | self.modals


@cache
def grammar() -> EnglishGrammar:
    """The words we know."""
    known: EnglishGrammar = read_table("planner_service", "english_grammar.toml", EnglishGrammar)
    return known


@lru_cache(maxsize=20_000)
def kinds_of(word: str) -> dict[str, tuple[str, ...]]:
    """Base forms of a word by what it may be: "VERB", "NOUN", "ADJ", "ADV"; empty for a word nobody knows."""
    from lemminflect import getAllLemmas

    found: dict[str, tuple[str, ...]] = getAllLemmas(word.lower())
    return found


def verb_of(word: str) -> str:
    """The base form of a word that may be a verb, else "": "slept" is sleep, "lay" is lie."""
    low = word.lower()
    if low in grammar().never_verbs:
        return ""
    known = _IRREGULAR.get(low) or next(iter(kinds_of(low).get("VERB", ())), "") or _more_forms().get(low, "")
    return known or (_guessed_verb(word) if word == low else "")


_INFLECTED: Final = re.compile(r"(?!\w*(?:ers|ors|ists|ions|ments)$)[a-z]{3,}(?:[^s]s|ed|ing)")


@cache
def _guessed_verb(word: str) -> str:
    """The base form of a word that no dictionary has, if it may be an inflected verb: facetimes → facetime."""
    from lemminflect import getAllLemmasOOV

    if not _INFLECTED.fullmatch(word) or kinds_of(word):
        return ""
    return next(iter(getAllLemmasOOV(word, upos="VERB").get("VERB", ())), "")


_DOUBLED: Final = re.compile(r"[^aeiou][aeiou][bdgmnpt]$")
"""Ends of verbs whose last letter may be doubled."""


@cache
def _more_forms() -> dict[str, str]:
    """Base forms of the forms of verbs that the dictionary does not know."""
    verbs = sorted(grammar().more_verbs)
    found = {form(base): base for base in verbs for form in (str, third_person, past, gerund)}
    short = [base for base in verbs if _DOUBLED.search(base)]  # "repotted", "channel-hopping"
    return found | {f"{base}{base[-1]}{end}": base for base in short for end in ("ed", "ing")}


_IRREGULAR: Final = {"found": "find", "felt": "feel", "saw": "see", "lay": "lie", "laid": "lay", "wound": "wind",
                     "left": "leave", "fell": "fall", "ground": "grind", "bore": "bear", "rose": "rise",
                     "lying": "lie", "lies": "lie", "dying": "die", "bound": "bind", "thought": "think"}  # fmt: skip
"""Forms of two verbs, with the one that themes mean."""


def is_known_word(word: str) -> bool:
    """Whether a word in small letters is English."""
    words = grammar()
    small = words.marks | words.subjects | words.prepositions | words.joints | words.adverbs | words.auxiliaries
    return bool(kinds_of(word)) or word in small or word in words.never_verbs


def is_verb(word: str) -> bool:
    """Whether a word may be a form of a verb."""
    return bool(verb_of(word)) or word.lower() in grammar().auxiliaries


def is_noun(word: str) -> bool:
    """Whether a word may be a noun."""
    return "NOUN" in kinds_of(word)


def is_adjective(word: str) -> bool:
    """Whether a word may be an adjective."""
    return "ADJ" in kinds_of(word)


@lru_cache(maxsize=20_000)
def lemma_of(word: str) -> str:
    """The base form by which a word is compared with others: of the verb it may be, else of the noun."""
    low = word.lower()
    base = verb_of(low) or next(iter(kinds_of(low).get("NOUN", ())), "")
    head, _, last = low.rpartition("-")
    return base or (f"{head}-{lemma_of(last)}" if head and last else low)  # "sit-ups" are a sit-up


def is_third_person(word: str) -> bool:
    """Whether a word may be a present of he, she and it: "carries"."""
    base = verb_of(word)
    return bool(base) and word.lower() == third_person(base) != base


def past(base: str) -> str:
    """The simple past of a base form: sit → sat, carry → carried."""
    return _inflected(base, "VBD")


def participle(base: str) -> str:
    """The past participle of a base form: go → gone."""
    return _CHOSEN_PARTICIPLES.get(base) or _inflected(base, "VBN")


_CHOSEN_PARTICIPLES: Final = {"lie": "lain", "get": "got", "wake": "woken", "quit": "quit"}
"""Where the first of the dictionary's forms is not the usual one."""


def gerund(base: str) -> str:
    """The -ing form: lie → lying."""
    return _inflected(base, "VBG")


def third_person(base: str) -> str:
    """The present of he, she and it: carry → carries."""
    return {"be": "is", "have": "has"}.get(base) or _inflected(base, "VBZ")


@cache
def _inflected(base: str, tag: str) -> str:
    """A form of a verb, as in Britain where there are two: travelled."""
    from lemminflect import getInflection

    found: tuple[str, ...] = (base and getInflection(base, tag=tag)) or (base,)
    return next((form for form in found if base.endswith("l") and "ll" in form), found[0])
