"""Who of the cast plays a theme's person, and in which clothes: what is given, else what the theme says, else the seed.

Words that describe the person (age, build, hair, job) are read where they describe whom the theme is about, and nowhere
else: of "a nurse waits for the old doctor" the nurse is played. Occasions (night, sports) are read wherever they stand.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, lru_cache
from typing import Final, Literal
from zlib import crc32

from motion_backend.body.cast import GIVEN, Cast, Member, cast
from motion_backend.motion import Character
from planner_service.themes.protagonist import cast_by, hero_of
from planner_service.themes.sentence_parser import clauses_of_text
from scene_graphs.data_tables import read_table, require_known, table
from scene_graphs.errors import UserError

DEFAULT: Final = Character()
FORMAL: Final = {"office": "suit_dress"}
"""What women wear where men wear the first."""
PARTY: Final = {"dress": "office"}
"""What men wear where women wear the first."""
_ARRIVING: Final = re.compile(
    r"\b(?:com|came|get|got|return|arriv|back)\w*\b[^.!?]*\bhome\b|\bwork\b|\bshift\b", re.IGNORECASE
)
"""Whoever does is dressed."""
TEENS: Final = 15
"""Years of a teenager whose age is not told."""
_TEENAGE: Final = re.compile(
    r"(?:^|;)(?:(?!\b(?:of|with|for|to|and|whose)\b)[^;])*\b(?:teen(?:age[dr]?)?|adolescent|high[- ]schooler)\b",
    re.IGNORECASE,
)
_TOLD_AGE: Final = (
    r"\b{who}(?P<led>,|\s*\(|,?\s+who\s+(?:is|was|(?:has\s+|had\s+)?(?:just\s+)?turned)"
    r"|\s+(?:has\s+|had\s+)?(?:just\s+)?turned)\s*({number})(?=\s*[,.;)]|\s+(?:today|yesterday|years|and|last)\b|$)"
)
"""An age beside a name: "Henrik, 74, …", "Ida, who is eight, …"."""
_RETIRED: Final = re.compile(r"\b(?:retired|former|ex)\b", re.IGNORECASE)
"""Whose work is over wears nothing for it."""
_LEFT_ALONE: Final = re.compile(
    r"\b(?:since|after|when) (?:(?:his|her|their|my) (?:husband|wife)|[A-Z]\w+) (?:had )?(?:died|passed away)\b"
)
"""Whose husband or wife has died is a widow or widower."""
_IS: Final = r"(?:\s+(?:is|was|am)|['’](?:s|m))\s+(?:still\s+|only\s+|just\s+)?(?:an?\s+|the\s+)?(?P<told>[^,.;!?]+)"
_AS: Final = re.compile(
    r"\b(?:works|working|work|job)\s+as\s+an?\s+(?P<told>[^,.;!?]+)|^as\s+an?\s+(?P<first>[^,.;!?]+)", re.IGNORECASE
)


class CharacterError(UserError):
    """A character that nobody can be; the text names the field and what would be right."""


@table
class _PersonWords:
    """Words that say something of a person."""

    field: Literal["age", "build", "skin", "hair", "hair_color", "outfit", "beard", "glasses"]
    value: str
    words: tuple[str, ...]


@table
class _OccasionWords:
    """Words that say what is worn."""

    outfit: str
    words: tuple[str, ...]
    worn: bool = False
    """The clothes themselves are named."""
    home: bool = False
    """Not of somebody who is on the way home."""


@table
class _CastWords:
    """data/cast_words.toml."""

    numbers: Mapping[str, int]
    school: tuple[str, ...]
    """What is had or done by who goes to school."""
    schooled: tuple[str, ...]
    """Of whom it may be instead, where one of these is named."""
    person: tuple[_PersonWords, ...]
    occasion: tuple[_OccasionWords, ...]

    def __post_init__(self) -> None:
        known = cast()
        require_known("occasion", [one.outfit for one in self.occasion], known.known("outfit"))
        for one in self.person:
            if one.field in GIVEN:
                require_known(f"person.{one.field}", [one.value], known.known(one.field))


@cache
def _words() -> _CastWords:
    known: _CastWords = read_table("planner_service", "cast_words.toml", _CastWords)
    return known


def check_character(character: Character) -> None:
    """CharacterError for words that the cast does not know, and for such as contradict each other."""
    known = cast()
    for name in GIVEN:
        value = getattr(character, name)
        if value and value not in known.known(name):
            raise CharacterError(f"{value!r:.60} is none of {', '.join(known.known(name))}", at=name)
    member = known.named(character.member) if character.member else None
    if member and character.pronouns not in (DEFAULT.pronouns, member.pronouns):
        fitting = ", ".join(one.name for one in known.member if one.pronouns == character.pronouns)
        raise CharacterError(
            f"{member.name} is {member.pronouns!r}, not {character.pronouns!r}",
            f"leave them out, or choose {fitting}",
            at="pronouns",
        )
    if member and character.age and (character.age == "child") != (member.age == "child"):
        fitting = ", ".join(one.name for one in known.member if one.age == character.age)
        raise CharacterError(
            f"{member.name} is {member.age!r}, not {character.age!r}", f"leave it out, or choose {fitting}", at="age"
        )
    age = character.age or (member.age if member else "")
    if age and character.height != DEFAULT.height:
        group = known.ages[age]
        if not group.height_min_m <= character.height <= group.height_max_m:
            raise CharacterError(
                f"{character.height:g} m is nobody's who is {age!r}: {group.height_min_m:g} to {group.height_max_m:g}",
                "leave it out, or give another age",
                at="height",
            )


def named_as(theme: str, character: Character) -> Character:
    """A character with the name and pronouns of the member that was asked for, or of the theme's person; one of which
    everything is given already is as it is."""
    if all(getattr(character, name) for name in GIVEN):
        return character
    if not character.member or (character.name, character.pronouns) != (DEFAULT.name, DEFAULT.pronouns):
        return cast_by(theme, character)
    member, read = cast().named(character.member), cast_by(theme, DEFAULT)
    told = read.name != DEFAULT.name and read.pronouns in (member.pronouns, "they")
    return replace(character, name=read.name if told else member.name.capitalize(), pronouns=member.pronouns)


@lru_cache(maxsize=256)
def cast_for(theme: str, character: Character, seed: int, years: int | None = None) -> Character:
    """A named character with all that can be seen of it: given words stay, then come the theme's, then the seed's.

    `years` is how old somebody else knows the person to be. The height is the age's where it was left as it is.
    """
    known, about = cast(), description_of(theme, character)
    read = _read(about)
    years = _years(about) if years is None else years
    if years is None and not {"age", "outfit"} & set(read) and _goes_to_school(theme):
        years = TEENS
    if years is not None:
        read["age"] = next(name for name, group in known.ages.items() if years <= group.years_max)
    given = {name: value for name in GIVEN if (value := getattr(character, name))}
    if "member" in given:
        read.pop("age", None)
    member = _member(known, character, read | given, theme, seed)
    age = given.get("age") or member.age
    outfit = given.get("outfit") or _outfit(theme, read, age, character.pronouns, member)
    words = {name: value for name, value in read.items() if name in GIVEN} | given
    words |= {"member": member.name, "age": age, "outfit": outfit}
    full = {name: words.get(name) or str(getattr(member, name)) for name in GIVEN if name != "member"}
    height = character.height
    if height == DEFAULT.height:
        height = known.ages[age].height_at(years if read.get("age") == age else None)
    return replace(character, member=member.name, height=height, **full)


def _member(known: Cast, character: Character, wanted: Mapping[str, str], theme: str, seed: int) -> Member:
    """The one that was asked for, else one of those that fit age and pronouns, and what else can be met."""
    if "member" in wanted:
        return known.named(wanted["member"])
    age = wanted.get("age", "adult")
    fitting = [one for one in known.member if one.age == age]
    fitting = [one for one in fitting if character.pronouns in ("they", one.pronouns)] or fitting
    for name in ("beard", "glasses"):
        fitting = [one for one in fitting if name not in wanted or getattr(one, name)] or fitting
    return fitting[(crc32(theme.encode()) + seed) % len(fitting)]


def _outfit(theme: str, read: Mapping[str, str], age: str, pronouns: str, member: Member) -> str:
    """What is worn: clothes that are named, the night's, the job's, the occasion's, else one's own."""
    job = read.get("outfit", "") if age != "child" else ""
    arrives = _ARRIVING.search(theme) is not None
    found = [one for one in _words().occasion if _says(theme, one.words) and not (one.home and arrives)]
    named = next((one.outfit for one in found if one.worn), "")
    night = next((one.outfit for one in found if one.home), "")
    other = next((one.outfit for one in found), "") if age != "old" else ""
    chosen = named or night or job or other
    if age == "child" and chosen not in ("pyjamas", "sports"):
        return member.outfit
    woman = (pronouns if pronouns in ("he", "she") else member.pronouns) == "she"
    return (FORMAL if woman else PARTY).get(chosen, chosen) or member.outfit


def description_of(theme: str, character: Character) -> str:
    """The words of a theme that describe whom it is about."""
    hero = hero_of(clauses_of_text(theme))
    found = [hero]
    subjects = {
        character.name,
        "he" if character.pronouns == "he" else "she" if character.pronouns == "she" else "they",
    }
    subjects |= {"I"} if hero == "I" else set()
    for subject in sorted(subjects):
        plain = re.escape(subject)
        found += [one["told"] for one in re.finditer(rf"\b{plain}{_IS}", theme, re.IGNORECASE)]
        found += [one[2] for one in re.finditer(_TOLD_AGE.format(who=plain, number=_number()), theme, re.IGNORECASE)]
        found += [one[1] for one in re.finditer(rf"\b{plain},\s+((?:an?|the|my|our|aged)\s[^,.;!?]+)", theme)]
    found += [one["told"] or one["first"] for one in _AS.finditer(theme)]
    found += ["widow"] if _LEFT_ALONE.search(theme) else []
    return "; ".join(found)


def _read(about: str) -> dict[str, str]:
    """What words about a person say, by field; the first counts."""
    told = re.sub(r"\byears? old\b|-years?-old\b", " ", about, flags=re.IGNORECASE)
    found: dict[str, str] = {}
    for one in _words().person:
        if one.field not in found and _says(told, one.words):
            found[one.field] = one.value
    if _RETIRED.search(told):
        found.pop("outfit", None)
    return found


def _years(about: str) -> int | None:
    """How old somebody is said to be."""
    number = f"({_number()})"
    forms = (
        rf"\b{number}[\s-]years?[\s-]old\b",
        rf"\b(?:boy|girl|child|kid|man|woman)\s+of\s+{number}\b",
        rf"\baged\s+{number}\b",
        rf"(?:^|;\s*){number}(?:;|$)",
    )
    for form in forms:
        if match := re.search(form, about, re.IGNORECASE):
            word = match[1].lower()
            return min(int(word) if word.isdigit() else _words().numbers[word], 120)
    return TEENS if _TEENAGE.search(about) else None


def _number() -> str:
    return rf"\d{{1,3}}|{'|'.join(_words().numbers)}"


def _goes_to_school(theme: str) -> bool:
    """Whether a theme's person seems to: of nobody else the homework may be."""
    return _says(theme, _words().school) and not _says(theme, _words().schooled)


def _says(text: str, words: Sequence[str]) -> bool:
    return _pattern(tuple(words)).search(text) is not None


@lru_cache(maxsize=128)
def _pattern(words: tuple[str, ...]) -> re.Pattern[str]:
    listed = "|".join(sorted((re.escape(word).replace(r"\*", r"\w*") for word in words), key=len, reverse=True))
    return re.compile(rf"(?<![\w-])(?:{listed})(?![\w-])", re.IGNORECASE)


def told_look(character: Character) -> Iterator[str]:
    """How a character looks, in words for people."""
    yield f"{character.member}: {character.age}, {character.build}, {character.height:.2f} m"
    hair = "bald" if character.hair == "bald" else f"{character.hair} {character.hair_color} hair"
    yield f"{character.skin} skin, {hair}"
    yield f"wears: {character.outfit}"
