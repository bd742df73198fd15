"""Sentences whose words stand in another order than who, does, what: "Into the armchair sinks Hugo", "It is Tessa who
washes". Their words are put in that order, and none is added but a verb's ending."""

from __future__ import annotations

import re
from functools import cache
from typing import Final

from planner_service.themes.lexicon import (
    grammar,
    kinds_of,
    lemma_of,
    participle,
    past,
    third_person,
    verb_of,
)
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things
from planner_service.themes.verb_finder import names

_MARK: Final = "the|an?|his|her|their|my|our|your|one|little|old|young"
_WHO: Final = rf"(?:(?:{_MARK}) (?:\w+ ){{0,2}}?)?\w+(?:['’]s \w+)?"
_PERSON: Final = rf"(?:he|she|they|I|you|{_WHO})"
_ABOUT: Final = "up|down|in|out|off|away|back|over|on|there|here|round|around|along|across|home"
_WHERE: Final = (
    rf"(?:(?:{_ABOUT})\b(?! of),? ?)*"
    r"(?:(?:in|on|at|by|into|onto|out of|off|from|to|under|beside|behind|through|across|along|up|down|round|before"
    r"|over|towards?|against|near|between|among|within) (?:\w+[ -]){0,3}?\w+|(?:\w+ed|\w+ing|bent|sunk|spread|sat"
    r"|lain|drawn|wound) (?:\w+ ){0,4}?\w+)?"
)
_MOVES: Final = "go be hang wait dive hop slip hurtle"
"""Verbs that stand before who does them, beside those of postures and ways."""
_CLEFT: Final = (
    (
        re.compile(rf"^it (?:is|was) (?:only |just |once more )?(?P<who>{_WHO}) (?:who|that) (?=\w)", re.IGNORECASE),
        r"\g<who> ",
    ),
    (
        re.compile(
            r"^it (?:is|was) (?:only )?(?P<how>(?:with|on|in|at|by|under|from|into|over) [^,]{2,60}?) that (?=\w)",
            re.IGNORECASE,
        ),
        r"\g<how>, ",
    ),
    (re.compile(r"^what happens (?:next |now |then )?is (?:that )?", re.IGNORECASE), ""),
)
"""Who does it, or how, told apart from what is done: "It is Tessa | who washes the plates"."""
_ALL_DONE: Final = re.compile(
    rf"^(?:all|what|the (?:first|next|last|only|one|other) thing) (?:that )?(?P<who>{_PERSON}) (?:then |now )?"
    r"(?:does|did|can do|could do|manages|ever does)(?: now| next| then| first| all day)? (?:is|was) (?:to )?"
    r"(?P<verb>\w+)",
    re.IGNORECASE,
)
"""What is done told apart from who does it: "The first thing Axel does is | open the fridge"."""
_TAKES: Final = re.compile(
    rf"^it (?:takes|took|costs?) (?P<who>him|her|me|them|you|{_WHO}) [^,.]{{2,40}}? to (?P<verb>\w+)", re.IGNORECASE
)
"""What it takes somebody to do a thing: "It takes Bernd three tries to | get out of the chair"."""
_DONE_ALL: Final = re.compile(
    rf"(?P<doing>\w+ing\b[^,.]*?) (?:is|was) (?:all|the only thing|what) (?:that )?(?P<who>{_PERSON}) "
    r"(?:does|did|can do|could do)$",
    re.IGNORECASE,
)
_WERE_IT: Final = re.compile(rf"^(?P<verb>were|had|should) (?P<who>{_PERSON}) (?=[^,]{{2,80}}, )", re.IGNORECASE)
"""A condition without "if": "Were she braver, …"."""
_NO_SOONER: Final = re.compile(
    rf"^no sooner (?P<verb>is|was|has) (?P<who>{_PERSON}) (?P<how>[^,]{{2,60}}?),? than ", re.IGNORECASE
)


def in_usual_order(sentence: str) -> str:
    """The sentence with who does it before what is done."""
    for cleft, plainly in _CLEFT:
        if (found := cleft.match(sentence)) and _acts(found.groupdict().get("who", "I")):
            sentence = cleft.sub(plainly, sentence)
    sentence = _ALL_DONE.sub(_does, sentence)
    sentence = _TAKES.sub(_does, sentence)
    sentence = _DONE_ALL.sub(_is_doing, sentence)
    sentence = _WERE_IT.sub(
        lambda one: f"if {one['who']} {one['verb'].lower()} " if _is_person(one["who"]) else one[0], sentence
    )
    sentence = _NO_SOONER.sub(lambda one: f"when {one['who']} {one['verb']} {one['how']}, ", sentence)
    return _inverted().sub(_turned, sentence)


@cache
def _inverted() -> re.Pattern[str]:
    """Where, how somebody gets there, and who does: "Down the stairs | runs | the boy"."""
    bases = sorted(grammar().postures | {*_MOVES.split()})
    verbs = "|".join(dict.fromkeys(form for base in bases for form in (third_person(base), past(base))))
    return re.compile(
        rf"(?P<lead>^|(?:, |\b)(?:and|then|but) |, )(?P<where>{_WHERE}),? ?\b(?P<verb>{verbs}|was|were) (?P<who>{_WHO})"
        r"(?=$|[,.;:]| (?:and|with|to|in|on|at|by|into|onto|from|out|off|under|beside|behind|through|across|for|without"
        r"|like|as|who|\w+ing)\b)",
        re.IGNORECASE,
    )


def _does(one: re.Match[str]) -> str:
    who = {"him": "he", "her": "she", "me": "I", "them": "they"}.get(one["who"].lower(), one["who"])
    plain = verb_of(one["verb"]) == one["verb"] and _is_person(who)
    return f"{who} {one['verb'] if who in ('I', 'you', 'they') else third_person(one['verb'])}" if plain else one[0]


def _is_doing(one: re.Match[str]) -> str:
    return f"{one['who']} is {one['doing'][0].lower()}{one['doing'][1:]}"


def _turned(one: re.Match[str]) -> str:
    """Who stands where, or goes there, before the verb."""
    verb, where, who = one["verb"].lower(), one["where"].strip(" ,"), one["who"]
    first, last = where.split(" ", 1)[0].lower(), where.split(" ")[-1].lower()
    if not (where and _acts(who)):
        return one[0]
    posed = verb in grammar().be
    is_posed = first.endswith("ing") or (bool(verb_of(first)) and participle(verb_of(first)) == first)
    if posed != is_posed or last in grammar().marks | {"who", "that", "and"}:
        return one[0]
    lead = one["lead"] if one["lead"] else ""
    who = who if lead or not who[:1].islower() else who[:1].upper() + who[1:]
    where = where if first in ("i",) else where[:1].lower() + where[1:]
    where = "" if where in ("there", "here") else f" {where}"
    return f"{lead}{who} {one['verb']}{where}"


def _acts(who: str) -> bool:
    """Whether words name a person, or a thing with its mark."""
    last = who.split(" ")[-1]
    return _is_person(who) or (" " in who and (lemma_of(last) in things() or who.lower().startswith(("the ", "a "))))


def _is_person(who: str) -> bool:
    last = who.split(" ")[-1]
    known = lemma_of(last) in theme_words()["people"] or last.lower() in grammar().subjects
    return known or (last[:1].isupper() and (not kinds_of(last.lower()) or last.lower() in names()))
