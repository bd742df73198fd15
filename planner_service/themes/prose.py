"""A theme as prose: headings of screenplays, labels of outlines and words to whoever makes the film are no sentences.

They are said in sentences where they tell something, and left out where they do not.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Final

from planner_service.themes.lexicon import (
    is_adjective,
    is_noun,
    is_third_person,
    kinds_of,
    lemma_of,
    participle,
    verb_of,
)
from planner_service.themes.outline import lines_of
from planner_service.themes.spell_check import spelt
from planner_service.themes.theme_words import theme_words
from planner_service.themes.verb_finder import names

_QUOTED: Final = r"(?P<quoted>“[^”]*”|\"[^\"]*\")"
_SLUG: Final = re.compile(
    r"\b(?P<side>INT|EXT)\.? (?:the )?(?P<place>[A-Z][A-Z0-9' ]+?)"
    r"(?:\s*[-–—,]\s*(?P<time>[A-Z]+(?: [A-Z]+)?))?(?=\s*(?:[.:\n]|$))[.:]?\s*"
)
"""A place and a time as screenplays head a scene: "INT. KITCHEN - NIGHT."."""
_TIMES: Final = frozenset(
    ("night", "day", "dawn", "dusk", "morning", "evening", "noon", "midnight", "afternoon", "late")
)
_TRODDEN: Final = frozenset(
    ("balcony", "roof", "terrace", "porch", "stairs", "steps", "street", "road", "lawn", "deck")
)
_CUT: Final = re.compile(
    r"\b(?:FADE (?:IN|OUT|TO BLACK)|(?:SMASH |MATCH |JUMP )?CUT TO(?: BLACK)?|DISSOLVE TO|THE END)\b[.:]?\s*"
)
_PERSON: Final = re.compile(r"\b(?P<name>[A-Z]{2,}(?: [A-Z]{2,})?),? \((?P<told>[^()]{1,80})\)(?P<mark>,?)")
"""Somebody as screenplays bring them in: "DANNY (40s, in his work boots)"."""
_LOUD: Final = re.compile(r"\b[A-Z]{4,}\b|(?:(?<=^)|(?<=[.!?] ))[A-Z]{3}(?=, | [a-z]+s\b)")
"""Names as screenplays write them."""
_DECADE: Final = re.compile(r"\b(?:(?:early|mid|late)[- ])?([2-9])0s\b")
_AGED: Final = re.compile(r"(?<=[A-Za-z]), (?P<age>(?:(?:early|mid|late)[- ])?[2-9]0s)(?P<mark>[,.])")
_ABOUT: Final = ("twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety")
_LABEL: Final = re.compile(
    r"(?:(?<=^)|(?<=[.!?;] )|(?<=\n))(?:(?P<wish>goal|objective|aim|want|wants|need|motivation"
    r"|task(?=:.*\b(?:sub-?)?(?:steps|tasks):))"
    r"|(?P<who>(?:main )?character|protagonist|hero|heroine|who)|(?P<where>setting|location|place|where)"
    r"|(?P<left>genre|tone|style|mood|title|length|duration|rating)"
    r"|obstacles?|conflict|problem|stakes|resolution|ending|end|beginning|middle|twist|climax|plot|story|premise|logline"
    r"|(?:sub-?)?(?:steps?|tasks?)|solution|answer|prompt|theme|idea|action|outcome|result|what happens|start|finally"
    r"|intro|outro|trigger|loop|idle|sequence|cue|setup|payoff|event|reaction|response|beats?|shots?|first|second|third"
    r"|then|next|last)"
    r"\s?: +(?P<told>[^.!?\n;]*[.!?;]?)",
    re.IGNORECASE | re.DOTALL,
)
"""What an outline calls its parts: "Goal: leave the house"."""
_ROLE: Final = re.compile(
    r"(?:(?<=^)|(?<=[.!?;] )|(?<=, )|(?<=\band ))(character|protagonist)(?= [a-z]+s\b)", re.IGNORECASE
)
"""Whom notes call so without an article."""
_REQUEST: Final = re.compile(
    r"^(?:(?:hey|hi|hello|ok(?:ay)?|so|please|pls|um|well|yo)[,!]? )*"
    r"(?:(?:can|could|would|will) (?:you|u|ya) (?:please |pls )?|please |pls "
    r"|i(?:'d| would)? (?:want|like|need)(?: you)?(?: to (?:see )?)?|let's )?"
    r"(?:make|do|write|show|create|film|animate|generate|tell|give|see|have)?"
    r"(?: me| us)?(?: an?| one| the| some)?(?: \w+){0,2}?(?:(?<=one)| (?:story|film|movie|scene|video|clip|animation))"
    r" (?:where|in which|about how|about|of)\s+(?:(?P<who>(?:an?|my|the) (?:\w+ ){1,3}?)who )?",
    re.IGNORECASE,
)
"""To whoever makes the film: "can u make one where a girl gets ready"."""
_OPENING: Final = re.compile(
    r"^(?:(?:so,? )?basically|ok(?:ay)?,? so|so like|like|imagine(?: this)?:|picture this:)[,:]? ", re.IGNORECASE
)
_CLOSING: Final = re.compile(
    r"(?: (?:lol|lmao|haha(?:ha)*|xd|pls|thx)|, ?(?:please|thanks|etc))\b(?=[.!]*\s*$)", re.IGNORECASE
)
_TWICE: Final = re.compile(
    r"(?:(?<=^)|(?<=[.!?;,] )|(?<=\b(?:and|but) ))"
    r"((?:the|my|our|an?|his|her|their) (?:\w+ )?(\w+)) (?:he|she) (?=(\w+))",
    re.IGNORECASE,
)
"""Who does it, said twice: "the grandmother | she cooks"."""
_SHORT: Final = re.compile(
    rf"{_QUOTED}|\b(?P<who>I|[Yy]ou|[Ww]e|[Tt]hey|[Hh]e|[Ss]he|[Ii]t|[Tt]here|[Tt]hat|[Ww]hat|[Ww]here|[Hh]ere|[Hh]ow|[Ww]ho)"
    r"['’](?P<end>m|re|s|ve|ll|d)\b(?= (?P<how>(?:never|always|often|rather|not) )*(?P<next>\w+))?"
)
_ENDINGS: Final = {"m": "am", "re": "are", "ve": "have", "ll": "will"}
_STATE: Final = re.compile(r"\b((?:[Tt]he|[Hh]is|[Hh]er|[Tt]heir|[Mm]y) \w+)['’]s (?=(\w+)(?:[.,;!?]| and\b| but\b|$))")
"""How a thing is: "the floor's wet, the mop's broken"."""
_POSED: Final = re.compile(
    r"(?:(?<=^)|(?<=[.!?;] ))(?P<who>[A-Z]\w+(?:, [^.!?,]+,)*) (?P<how>asleep|awake|alone|back|\w+ing)\b"
    r"(?P<rest>[^.!?]*)"
)
"""Somebody and how they are, as screenplays tell it: "Leo | asleep on the couch"."""
_ME: Final = re.compile(r"^me (?P<when>(?:at|on|in|after|every) [^,]*? )?(?P<doing>\w+ing)\b", re.IGNORECASE)
"""What somebody says of themself: "me at 3am eating cheese"."""
_EXERCISE_OF_TWO: Final = re.compile(r"\b(?:(?:push|press|sit|pull|chin) ups?|star jumps?)\b")
"""Exercises that others write as one word: "push ups" are push-ups."""
_EXERCISE: Final = (
    r"(?:[\w-]+ ){0,3}?(?:(?:push|press|sit|pull|chin)-?ups?|squats?|crunches|lunges|planks?|burpees|stretches"
    r"|star[ -]jumps|jumping[ -]jacks|knee[ -]bends)\b"
)
_EXERCISES: Final = re.compile(
    rf"\b(?P<does>do|does|did|doing|done) (?P<all>{_EXERCISE}(?:(?:,|,? and) {_EXERCISE})+)", re.IGNORECASE
)
"""Several exercises that one verb has: "does ten push-ups, sit-ups and squats"."""
_TEXTED: Final = {"u": "you", "ur": "your", "im": "I am", "ive": "I have"}


@lru_cache(maxsize=256)
def prose_of(theme: str) -> str:
    """The theme in sentences, which are read and told in its place."""
    text = _SLUG.sub(_slug, _CUT.sub("", lines_of(theme)))
    text = _PERSON.sub(_brought_in, text)
    text = _AGED.sub(lambda one: f", {_about(one['age'])}{one['mark']}", text)
    text = _LOUD.sub(lambda one: one[0] if kinds_of(one[0]) else one[0].capitalize(), text)
    text = _LABEL.sub(_labelled, text)
    text = _ROLE.sub(r"the \1", text)
    text = _CLOSING.sub("", _OPENING.sub("", _REQUEST.sub(lambda one: one["who"] or "", text)))
    text = re.sub(r"\b(?:u|ur|im|ive)\b", lambda one: _TEXTED[one[0]], text)
    text = _TWICE.sub(_once, text)
    text = _POSED.sub(_posed, _ME.sub(lambda one: f"{one['when'] or ''}I am {one['doing']}", text))
    text = _EXERCISES.sub(_one_by_one, _EXERCISE_OF_TWO.sub(lambda one: one[0].replace(" ", "-"), text))
    text = _STATE.sub(lambda one: f"{one[1]} is " if is_adjective(one[2].lower()) else one[0], text)
    return spelt(_SHORT.sub(_written_out, text)).strip() or theme


def _one_by_one(one: re.Match[str]) -> str:
    """Every exercise with the verb of them all: "does push-ups, does squats"."""
    return re.sub(rf"(^|, and |, | and )(?={_EXERCISE})", lambda joint: f"{joint[1]}{one['does']} ", one["all"])


def _slug(one: re.Match[str]) -> str:
    """Where and when in a sentence: "It is night in the kitchen"."""
    place, time = one["place"].lower().strip(), (one["time"] or "").lower()
    lead = "in" if one["side"] == "INT" else "on" if place.split(" ")[-1] in _TRODDEN else "at"
    where = f"{lead} the {place}"
    return f"It is {time} {where}. " if time.split(" ")[-1] in _TIMES else f"The scene is the {place}. "


def _brought_in(one: re.Match[str]) -> str:
    return f"{one['name'].title()}, {_about(one['told'])},"


def _about(told: str) -> str:
    return _DECADE.sub(lambda ten: f"about {_ABOUT[int(ten[1]) - 2]}", told)


def _labelled(one: re.Match[str]) -> str:
    """What stands after a label as a sentence of its own."""
    told, first = one["told"].strip(), one["told"].split(" ")[0].lower()
    if one["left"]:
        return ""
    if one["wish"]:
        return f"The goal is {'' if first == 'to' or verb_of(first) != first else 'to '}{told}"
    if one["who"]:
        return f"There is {told}"
    return f"The scene is {told}" if one["where"] else told[:1].upper() + told[1:]


def _posed(one: re.Match[str]) -> str:
    """A sentence with its verb, where it has none and somebody's name opens it."""
    who, how = one["who"].split(",")[0].lower(), one["how"]
    acts = any(is_third_person(word) and not is_noun(word) for word in re.findall(r"[a-z]+", one["rest"]))
    gerund = how.endswith("ing") and verb_of(how) not in ("", how) and not is_adjective(how) and not is_noun(how)
    named = who in names() or not kinds_of(who)
    return (
        f"{one['who']} is {how}{one['rest']}" if named and not acts and (gerund or not how.endswith("ing")) else one[0]
    )


def _once(one: re.Match[str]) -> str:
    people = {one[2].lower(), lemma_of(one[2])} & theme_words()["people"]
    return f"{one[1]} " if people and verb_of(one[3]) else one[0]


def _written_out(one: re.Match[str]) -> str:
    """A helper that is written together with who does it: "I've" is "I have"; what is said stays as it is."""
    if one["quoted"]:
        return one[0]
    after, how, who = (one["next"] or "").lower(), one["how"] or "", one["who"]
    base = verb_of(after)
    helper = _ENDINGS.get(one["end"], "")
    if one["end"] == "s":
        helper = "has" if after == "been" or (after.endswith("ed") and not is_adjective(after)) else "is"
    if one["end"] == "d":
        helper = "would" if base == after != participle(base) or "rather" in how or after == "like" else "had"
    return f"{who} {helper}"
