"""What a theme says, told again: the words of a beat, which have no subject, as a predicate in the past."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from planner_service.narration.narrative_voice import Voice
from planner_service.narration.story_words import story_words
from planner_service.narration.tense import bases, form_of, in_past, says_how
from planner_service.scripts.script import Beat
from planner_service.themes.beats import EXPRESSIONS
from planner_service.themes.lexicon import grammar, is_adjective, is_noun, lemma_of, past
from planner_service.themes.things import things
from scene_graphs.furniture import is_known

WAS: Final = "\ue000"
"""Stands for was or were until the subject is known; no theme has it."""
_SAID: Final = "\ue001"
"""Stands for what is quoted."""
_QUOTE: Final = re.compile(r'"[^"]*"|“[^”]*”')
_PERSON: Final = {
    "he": {"he": "they", "him": "them", "his": "their", "himself": "themself"},
    "she": {"she": "they", "her": "their", "hers": "theirs", "herself": "themself"},
    "they": {"they": "they", "them": "them", "their": "their", "themselves": "themself", "themself": "themself"},
}
_FIRST: Final = {"i": "they", "me": "them", "my": "their", "mine": "theirs", "myself": "themself"}
_OBJECT: Final = re.compile(r"\s+(?:and|to|in|on|at|with|from|for)\b|\W*$")
"""What follows "her" where it does not own what follows."""
_MOVES: Final = re.compile(r" (?:up|out of)\b")
"""Who "gets" so moves, and is not in a state."""


@dataclass(frozen=True)
class Predicate:
    """A clause in the past without its subject, `WAS` for was and were."""

    text: str
    verbs: frozenset[str]
    """Base forms that its verb may have."""

    @property
    def is_state(self) -> bool:
        """Whether it says how somebody is, not what is done."""
        return self.text.startswith(WAS) or (bool(self.verbs & _of("states")) and not _MOVES.search(self.text))


def event(beat: Beat, hero: str, voice: Voice) -> Predicate | None:
    """A beat as it happens, None where its grammar is not sure; `hero` are the theme's own pronouns for its person."""
    quotes = iter(_QUOTE.findall(beat.text))
    words = _own_clause(_QUOTE.sub(_SAID, beat.text))
    at = next((at for at, word in enumerate(words) if not _is_adverb(word)), 0)
    listed = beat.kind == "feeling" and "," in beat.text
    told = None if listed or _is_thing(words) else _head(words[at:], beat.kind == "feeling")
    if told is None or (beat.kind == "feeling" and hero in ("he", "she") and _is_bare_noun(words[at:])):
        return None
    verb, rest, ing = told
    text = of_voice(" ".join([*words[:at], verb, *_shifted(rest, ing)]), hero, voice).rstrip(" .,;:!?")
    for day, instead in story_words().days.items():
        text = re.sub(rf"\b{day}\b", instead, text)
    goes_on = verb != WAS and _helpers().get(_bare(words[at])) == WAS  # "is sitting" was told as "sat"
    text = re.sub(_SAID, lambda _: next(quotes), text)
    return Predicate(text, frozenset(bases(_bare(words[at + goes_on]))))


def purpose(beat: Beat, hero: str, voice: Voice) -> str:
    """A deed as what something else is done for: "to bake a cake"; empty where its grammar is not sure."""
    told = event(beat, hero, voice)
    words = told.text.split() if told else []
    at = next((at for at, word in enumerate(words) if not _is_adverb(word)), 0)
    base = next((base for base in sorted(told.verbs) if past(base) == words[at]), "") if told else ""
    if not base or base in ("be", "can", "have", "may", "will") or "and" in words or words[at + 1 : at + 2] == ["not"]:
        return ""
    return " ".join(["to", *words[:at], base, *words[at + 1 :]])


def _own_clause(text: str) -> list[str]:
    """Words without what joins them to those before."""
    words = re.sub(
        r"^(?:(?![\"“\ue001])\W|(?:and|but|then|so(?=,| (?:he|she|they|i)\b))\b)+",
        "",
        text.strip(),
        flags=re.IGNORECASE,
    ).split()
    return [word[:1].lower() + word[1:] if not at else word for at, word in enumerate(words)]


def _head(words: Sequence[str], feeling: bool) -> tuple[str, Sequence[str], bool] | None:
    """The verb in the past, what follows it, and whether it was an -ing form; None where it is no verb."""
    first, after = [*map(_bare, words[:2]), "", ""][:2]
    rest = words[1:]
    if feeling and first == "not" and says_how(after):
        return WAS, words, False
    if first == "to" and rest:
        return _head(rest, feeling)
    if first in ("had", "having") and form_of(after) in ("past", "participle"):
        return _head(rest, feeling)  # what had been done is told where it is acted
    if first in _helpers():
        goes_on = _helpers()[first] == WAS and form_of(after) == "ing" and not feeling
        return _head(rest, feeling) if goes_on else (_helpers()[first], rest, False)
    does = form_of(first) in ("present", "ing") or not EXPRESSIONS.keys().isdisjoint(bases(first))
    plain = not does or is_adjective(first)  # "laughed" says what is done, "exhausted" how one is
    adjective = plain and says_how(first) and first not in grammar().numbers
    adjective = adjective and after not in ("down", "up", "out", *grammar().marks)
    if feeling and (adjective or (first in ("in", "at") and rest)):
        return WAS, words, False
    told = in_past(first)
    return (told, rest, form_of(first) == "ing") if told else None


def _is_thing(words: Sequence[str]) -> bool:
    """Whether words only name a thing, and where it goes: "keys", "shoes off", "lights out"."""
    first, rest = _bare(words[0]) if words else "", [*map(_bare, words[1:])]
    known = lemma_of(first) in things() or is_known(first)
    return known and len(rest) < 2 and {*rest} <= _of("adverbs") | {"on", "off", "up", "down", "out", "in", "away"}


def _is_bare_noun(words: Sequence[str]) -> bool:
    """Whether what "he" or "she" might do is no form of theirs: "love, money, weather"."""
    first = _bare(words[0])
    known = first in _helpers() or first in ("to", "not")
    return not known and is_noun(first) and form_of(first) is None and past(first) != first and not is_adjective(first)


def _shifted(words: Sequence[str], ing: bool) -> list[str]:
    """What follows the verb, with the further verbs in it in the past too."""
    bare = ["", *map(_bare, words), ""]
    told = []
    for at, word in enumerate(words):
        new = _later(bare[at], bare[at + 1], bare[at + 2], at <= 1, ing)
        told.append(word.replace(_bare(word), new) if new else word)
    return told


def _later(before: str, word: str, follows: str, early: bool, ing: bool) -> str | None:
    """A verb after a subject of its own, or after "and", in the past; None for any other word."""
    form, subject, was = form_of(word), before in _of("subjects"), "were" if word in ("are", "aren't") else "was"
    if word in ("is", "has", "isn't", "hasn't", "doesn't", "cannot", "can't", "won't", "are", "aren't") or (
        subject and word in _helpers() and word not in ("was", "were")
    ):
        return _helpers()[word].replace(WAS, was)
    if subject:
        return in_past(word) if form == "present" or before in ("i", "they", "we") else None
    alone = bool(_of("alone") & {*bases(word)})
    joined = before in ("and", "or", "then") and (alone or early or follows in _of("after_verbs"))
    takes = (form == "present" and joined) or (form == "ing" and ing) or (form is None and alone and not ing)
    return in_past(word) if takes and before in ("and", "or", "then") else None


def of_voice(text: str, hero: str, voice: Voice) -> str:
    """Pronouns for the theme's person made the voice's: its writer, "I", and he, she or they where that differs."""
    blanks = _FIRST | (_PERSON[hero] if hero != voice.pronouns else {})

    def pronoun(match: re.Match[str]) -> str:
        word = match[0].lower()
        owner = word != "her" or not _OBJECT.match(text[match.end() :])
        return voice[blanks[word] if owner else "them"] if word in blanks else match[0]

    return re.sub(r"\b[A-Za-z]+\b(?!['’]\w)", pronoun, text)


def _is_adverb(word: str) -> bool:
    lower = _bare(word)
    return lower in _of("adverbs") or (lower.endswith("ly") and not bases(lower) and not says_how(lower))


def _of(name: str) -> frozenset[str]:
    return story_words().lists[name]


def _helpers() -> dict[str, str]:
    return {word: told.format(was=WAS) for word, told in story_words().helpers.items()}


def _bare(word: str) -> str:
    return word.strip(".,;:!?\"“”()'’—–-").lower().replace("’", "'")
