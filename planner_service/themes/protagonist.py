"""Who a theme is about, where nobody said: the name it calls its person by, and the pronouns it uses."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache, lru_cache
from typing import Final

from motion_backend.motion import Character
from planner_service.themes.lexicon import grammar, is_verb, kinds_of

_NAMES: Final = {
    "she": """
alice amelia amy ana andrea angela anita anja anna anne annie aisha barbara beatrice bella beth brigitte carla carmen
caroline catherine charlotte chloe claire clara cora daisy diana ebba eliza ella ellen elena elisa elizabeth emily emma
esther eva fatima fiona frida grace greta hannah heidi helen helena ida ines ingrid irene iris isabella jane jasmine
jenny jessica joan johanna judith julia julie karen kate katherine katie laura layla leila lena leonie lily lina linda
lisa lotte louise lucia lucy luna maria marie marta martha mary maya mei mia mila monica nadia nancy natalie nina nora
olga olivia petra priya rachel rebecca rita rosa ruth sally sarah selma sofia sophia sophie stella susan sylvia teresa
tina ursula vera victoria wendy yasmin yuki zoe
""",
    "he": """
aaron adam ahmed alan albert alexander ali andrew anton antonio arthur ben benjamin bernard bill bob boris brian bruno
carl carlos charles christian christopher daniel dave david diego dmitri edward emil eric erik felix finn frank fred
frederick george gustav hans harry hassan henry hiroshi hugo ian ibrahim igor ivan jack jacob jakob james jan jason
jens jim joe johan john jonas jonathan jose joseph juan karl kenji kevin klaus lars leo leon liam louis luca lucas
luis luke marco marcus mario martin matthew max michael miguel mike mohammed moritz nathan nick nils noah oliver omar
oscar otto pablo patrick paul pedro peter philip pierre ralph raj ravi richard robert roger samuel sebastian simon
stefan steve sven theo thomas tim timothy tobias tom tony viktor walter will william yusuf
""",
    "they": "alex ashley casey charlie chris dana eli jamie jordan kim lee morgan nico noor pat quinn sam sasha",
}  # fmt: skip
_PRONOUNS_OF: Final = {name: pronouns for pronouns, names in _NAMES.items() for name in names.split()}
_PRONOUN: Final = re.compile(r"\b(?:(?P<she>she|her|herself)|(?P<he>he|him|his|himself))\b", re.IGNORECASE)
_SUBJECT: Final = re.compile(r"\b(?:(?P<she>she)|(?P<he>he))\b", re.IGNORECASE)
_KINDS: Final = re.compile(
    r"^(?:\W*(?:an?|the|this|one|our|my|his|her|their|some|old|young|tired|little|lonely|happy|sad|elderly|busy|single)\s+)*(?:"
    r"(?P<she>woman|girl|lady|mother|mum|mom|grandmother|grandma|granny|widow|wife|daughter|sister|aunt|nun|actress"
    r"|queen|bride|waitress)"
    r"|(?P<he>man|boy|guy|gentleman|father|dad|grandfather|grandpa|widower|husband|son|brother|uncle|monk|king|groom))\b",
    re.IGNORECASE,
)
_CAPITALISED: Final = re.compile(
    r"(?P<before>^|[.!?]\s+|\S\s+)(?P<name>[A-Z][a-zà-öø-ÿ]{1,19})\s+(?=(?P<verb>[a-z]+)\b)"
)


def cast_by(theme: str, character: Character) -> Character:
    """The character, renamed after the theme where its name and its pronouns were both left at their defaults."""
    default = Character()
    if (character.name, character.pronouns) != (default.name, default.pronouns):
        return character
    name = name_in(theme)
    pronouns = _PRONOUNS_OF.get(name.lower()) or _pronouns_in(theme, bool(name)) or default.pronouns
    return replace(character, name=name or default.name, pronouns=pronouns)


def name_in(theme: str) -> str:
    """The first name that does something, or ""."""
    doing = (one["name"] for one in _CAPITALISED.finditer(theme) if is_verb(one["verb"]))
    return next((name for name in doing if is_name(name)), "")


def is_name(word: str) -> bool:
    """Whether a word is a name: one that we know, or one with a capital that no dictionary has."""
    low = word.lower()
    return word[:1].isupper() and (low in _PRONOUNS_OF or not (kinds_of(low) or low in _not_names()))


@lru_cache(maxsize=2_000)
def pronouns_of(subject: str) -> str:
    """ "he" or "she" for a person whose name or noun tells: "Anna", "the old man", "Mrs. Hill"; else ""."""
    words = re.findall(r"[^\W\d_]+", subject.lower())
    known = (word if word in ("he", "she") else _TITLES.get(word) or _PRONOUNS_OF.get(word) for word in words)
    told = next((pronouns for pronouns in known if pronouns), "") or _pronouns_by(_KINDS, subject)
    return told if told in ("he", "she") else ""


_TITLES: Final = {"mr": "he", "sir": "he", "mrs": "she", "miss": "she", "ms": "she", "madame": "she"}
_CAPITALS: Final = """
english french german christmas easter halloween monday tuesday wednesday thursday friday saturday sunday january
february april june july august september october november december everyone everybody everything although though
"""
"""Words that begin with a capital, are in no dictionary of nouns and verbs, and are nobody's name."""


@cache
def _not_names() -> frozenset[str]:
    words = grammar()
    return frozenset(_CAPITALS.split()).union(
        words.marks, words.subjects, words.prepositions, words.joints, words.adverbs, words.auxiliaries
    )


def _pronouns_in(theme: str, named: bool) -> str:
    """The pronouns of the theme's person: those of the noun that opens it, else the first that stands in it."""
    patterns = ([] if named else [_KINDS]) + [_SUBJECT, _PRONOUN]
    return next((told for pattern in patterns if (told := _pronouns_by(pattern, theme))), "")


def _pronouns_by(pattern: re.Pattern[str], text: str) -> str:
    found = pattern.search(text)
    return "" if found is None else "she" if found["she"] else "he"
