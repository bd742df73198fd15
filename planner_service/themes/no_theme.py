"""Texts that tell no story: other languages, code, lists and heaps of words, questions and commands to a machine."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from planner_service.themes.clause import Clause
from planner_service.themes.language import ANOTHER, ENGLISH, foreign_language, language_of
from planner_service.themes.lexicon import grammar, is_known_word, lemma_of
from planner_service.themes.protagonist import is_person
from planner_service.themes.things import things
from planner_service.themes.verb_finder import tokens_of
from scene_graphs.furniture import is_known

_LIST: Final = 5
"""Things, and nothing else, from which on a sentence only lists them."""
_SYMBOLS: Final = re.compile(r"[{}<>;=\[\]_|\\^*/+]")
_MOST_SYMBOLS: Final = 3
_CODE: Final = re.compile(
    r"\w\([^()]*\)\s*[:{;.]|\w\.\w+\(|\bSELECT\b.+\bFROM\b|^\s*(?:def|const|var|function) \w+\s*[({=]"
)
"""Calls, queries and definitions."""
_HEAP: Final = re.compile(
    r"\b(?:the|an?) (?:the|an?|of|and|between|whereas|if|was|he|she|they)\b|\bof (?:of|and)\b|\band and\b|\bequals\b",
    re.IGNORECASE,
)
"""Small words that never follow each other, and sums."""
_CALLED_UPON: Final = re.compile(r"\s*O [a-z]+")
"""How poems call what they are about."""
_ASKED: Final = re.compile(
    r"(?i)(?:please|(?:can|could|would|will) you|(?:tell|show|give|help|write|draw|send) (?:me|us)"
    r"|ignore (?:all|any|the|your|previous)|translate|summari[sz]e|paraphrase|calculate|preheat"
    r"|(?:delete|install|restart|shut down) (?:\w+ ){0,2}(?:files?|server|system|program))\b"
)
_QUESTIONS: Final = re.compile(
    r"(?i)(?:\s*(?:what|which|how|where|why|who|is|are|does|do|can|could|will|would|should)\b[^.!?]*\?)+"
)
_ASKING: Final = frozenset(("", "it", "you", "i", "me", "us", "please"))
"""Who does things in a request, and is nobody whose story it is."""


def no_prose(text: str) -> str:
    """Why a text is no English prose: "looks like German"; "" where it may be."""
    tokens = tokens_of(text)
    words = [token.low for token in tokens if token.text[:1].isalpha()]
    plain = [token.low for token in tokens if token.text.isalpha() and token.text.islower()]
    known_words = sum(map(is_known_word, plain))
    unknown = len(plain) > 3 and 2 * known_words < len(plain)
    foreign = 10 * known_words < 9 * len(plain) and language_of(text) not in (ENGLISH, ANOTHER)  # "no TV, no phone"
    if unknown or foreign or not any(re.search(r"[a-z]", word) for word in words):
        language = foreign_language(text)
        return f"looks like {language}" if language != ANOTHER else "is no everyday English"
    known = [lemma_of(word) in things() or is_known(word) or is_known(lemma_of(word)) for word in words]
    if len(words) >= _LIST and all(known) and "." not in text.strip().rstrip("."):
        return "is a list of things"
    if _CODE.search(text) or len(_SYMBOLS.findall(text)) > max(_MOST_SYMBOLS, len(words) / 3):
        return "is no prose"
    return "is no sentence" if _HEAP.search(text) or _CALLED_UPON.match(text) else ""


def asks_for_something(text: str, clauses: Sequence[Clause]) -> bool:
    """Whether a text asks, or orders something of whoever reads it, and tells of nobody."""
    if _ASKED.match(text) and all(one.doer.lower() in _ASKING for one in clauses):
        return True
    told = {one.doer.lower() for one in clauses if is_person(one.doer)} - grammar().subjects - {"me", "us"}
    return _QUESTIONS.fullmatch(text) is not None and not told
