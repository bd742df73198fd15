"""What a theme tells and nobody does: when it is, the weather, who and how old somebody is, and what there is not."""

from __future__ import annotations

import re
from typing import Final

from planner_service.themes.lexicon import grammar, is_adjective, lemma_of, participle, verb_of
from planner_service.themes.protagonist import head_of
from planner_service.themes.sentence_parser import Clause
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things
from planner_service.themes.verb_finder import tokens_of
from scene_graphs.furniture import is_known

_PUT: Final = frozenset(("on", "off", "up", "down", "out", "away", "in", "open", "ready"))
"""How a thing is when somebody has done it: "Kettle on"."""
_NONE: Final = frozenset(("nothing", "nobody", "none", "no", "silence"))
_FALLS: Final = frozenset(("rain", "snow", "hail", "sleet", "drizzle", "thunder"))
"""Weather that may be a verb too: "Rain all Sunday"."""
_ALONE: Final = re.compile(
    r"(?:is|was|am|are|were) (?:\w+ly |all |still )?(?:alone at home|home alone|alone)\b", re.IGNORECASE
)
"""How it is from the beginning, and nothing that is done: "is home alone"."""
_ON_SOMEBODY: Final = re.compile(r"\b(?:on|in|around|under) (?:his|her|my) \w+", re.IGNORECASE)
"""Where things are that are no people: "they were on his head"."""
_PLACED: Final = re.compile(r" (?:on|in|by|under|beside|behind|near|at) (?=(?:the|an?|his|her|their|my|every|each)\b)")
"""Before where things are."""
_OF_AGE: Final = frozenset(
    ("year", "old", "now", "almost", "nearly", "already", "just", "only", "month", "today", "be")
)
"""Words beside a number that tell an age: "is six years old"."""


def tells_no_deed(clause: Clause) -> bool:
    """Whether a clause tells nothing that anybody does or feels."""
    if not clause.verb or (clause.text.split()[0].lower() in _FALLS and not clause.doer):
        return _is_when_or_none(clause)
    if clause.verb == "be" and clause.subject:
        of_things = clause.subject.lower() == "they" and _ON_SOMEBODY.search(clause.text) is not None
        return of_things or _is_who(clause) or _is_age(clause) or _ALONE.match(clause.text) is not None
    rest = clause.lemmas[1:2]
    return clause.verb == "have" and (not _NONE.isdisjoint(rest) or not grammar().numbers.isdisjoint(rest))


def _is_when_or_none(clause: Clause) -> bool:
    """Whether words without a verb tell the time, the weather, or that there is nothing: "Laundry day", "Nothing"."""
    words = theme_words()
    if "but" in clause.lemmas:
        return False  # "Nothing but boredom"
    near = (head_of(clause.text).lower(), clause.text.split()[0].lower())
    if is_state(clause):
        return True
    told = {*near, *map(lemma_of, near)}
    return bool(told & (words["weather"] | words["told_times"] | _NONE))


def _is_there(clause: Clause) -> bool:
    """Whether words without a verb tell what lies where: "Three cups on the table", not "Keys in the bowl"."""
    noun, place, _ = (*_PLACED.split(clause.text, maxsplit=1), "", "")[:3]
    words = [token.low for token in tokens_of(noun)]
    counted = words[:1] and (words[0].split("-")[0] in grammar().numbers | {"a", "an", "one"} or words[0].isdigit())
    known = words and (lemma_of(words[-1]) in things() or is_known(words[-1]))
    return bool(place and counted and known and not clause.verb)


def is_state(clause: Clause) -> bool:
    """Whether two words tell how a thing is: "Fridge empty", "Socks impossible", not "Shoes off" or "Door locked"; or
    more of them where it is."""
    if _is_there(clause):
        return True
    words = [token.low for token in tokens_of(clause.text) if token.text[:1].isalpha()]
    thing, how = words if len(words) == 2 else ("", "")
    done = how in _PUT or participle(verb_of(how) or "be") == how
    return is_adjective(how) and not done and (lemma_of(thing) in things() or is_known(thing))


def _is_who(clause: Clause) -> bool:
    """Whether it is told who somebody is: "is a widower"."""
    tokens = tokens_of(clause.text)[1:]
    head = head_of(" ".join(token.text for token in tokens)).lower()
    led = bool(tokens) and tokens[0].low in grammar().marks
    return led and (head in theme_words()["people"] or lemma_of(head) in theme_words()["people"])


def _is_age(clause: Clause) -> bool:
    """Whether it is told how old somebody is: "is six"."""
    rest = [token.low for token in tokens_of(clause.text)[1:]]
    numbers = [word for word in rest if word in grammar().numbers or word.isdigit()]
    return bool(numbers) and all(word in numbers or lemma_of(word) in _OF_AGE for word in rest)
