"""Who a theme is about, where nobody said: the name it calls its person by, and the pronouns it uses."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Final

from motion_backend.motion import Character
from planner_service.themes.lexicon import is_verb, is_verb_form

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
    r"^(?:\W*(?:an?|the|this|one|our|some|old|young|tired|little|lonely|happy|sad|elderly|busy|single)\s+)*(?:"
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
    """The first name that does something, or "".

    A word that opens a sentence must be known as a name, or go with its verb as only a name can: "Zora waters".
    """
    for found in _CAPITALISED.finditer(theme):
        name, verb = found["name"], found["verb"]
        inside = found["before"].strip() not in ("", ".", "!", "?") and found["before"].strip()[-1] not in ".!?\"'"
        if not (is_verb(verb) or is_verb_form(verb) or verb in _MODALS):
            continue
        if name.lower() in _PRONOUNS_OF or (inside and not _NOT_NAMES.fullmatch(name)):
            return name
        if inside:
            return ""
        if _agrees(name.lower(), verb):
            return name
    return ""


def _agrees(word: str, verb: str) -> bool:
    """Whether a word that opens a sentence and is no known name can be nothing else beside this verb."""
    singular = verb in _MODALS or (is_verb_form(verb) and verb.endswith("s"))
    other = word in _NOUNS or is_verb(word) or _NOUN_ENDING.search(word) or _NOT_NAMES.fullmatch(word.title())
    return singular and not other


_MODALS: Final = frozenset(("can", "cannot", "could", "must", "will", "would", "may", "might", "was"))
_NOUN_ENDING: Final = re.compile(
    r"(?:ness|ment|tion|sion|ing|ity|ism|ance|ship|hood|dom|ly|ed|body|one|thing|day|light)$"
)
_NOUN_WORDS: Final = """
after all anger another anxiety as at autumn beer before bread breakfast business cake cash champagne cheese chocolate
christmas coffee cold darkness dawn dessert dinner dust each either electricity even every excitement fate father fear
fever fire fog food frost fury grandma grandpa gravity grief hail happiness heat hope how hunger if in insomnia it
jazz joy laundry laziness life lightning love luck lunch mail midnight milk mom money mother mum music nature neither
news night no noise noon nostalgia not now once one only pain paint panic paper peace pizza post rage rain rock
sadness silence sleep smoke snow so somehow soup spring stress summer sun sunrise sunset supper tea that then there
thirst this though thunder time today tomorrow tonight traffic train trouble until war water weather what when where
while who whoever wind wine winter work worry yesterday yoga
"""
_NOUNS: Final = frozenset(_NOUN_WORDS.split())
"""Words that open a sentence without an article and are nobody's name."""
_NOT_NAMES: Final = re.compile(
    r"(?:Mon|Tues|Wednes|Thurs|Fri|Satur|Sun)day|January|February|March|April|May|June|July|August|September|October"
    r"|November|December|Christmas|Easter|Halloween|English|God|He|She|They|It|We|You|Then|And|But|So|Later|Finally"
)


def _pronouns_in(theme: str, named: bool) -> str:
    """The pronouns of the theme's person: those of the noun that opens it, else the first that stands in it."""
    for pattern in ([] if named else [_KINDS]) + [_SUBJECT, _PRONOUN]:
        found = pattern.search(theme)
        if found:
            return "she" if found["she"] else "he"
    return ""
