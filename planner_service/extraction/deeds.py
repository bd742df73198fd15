"""What a clause has a body do: the skill its verb means, the furniture it names, and what is no deed at all."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from typing import Final

from motion_backend.motion import Skill
from planner_service.extraction.deed_words import (
    DOES_SITTING,
    FALLS,
    GOES,
    LEAD,
    LETS_DOWN,
    LIES,
    ON_THE_PHONE,
    OWN,
    RISES,
    SITS,
    STANDS,
    TOUCHES,
    WAKES,
)
from planner_service.scripts.fitting import NEEDS, affords
from scene_graphs import furniture


@dataclass(frozen=True)
class Kind:
    """A way a clause is acted out."""

    skill: Skill
    words: str
    """How the clause begins."""
    falls: bool = False
    """Whether one lies where one can, and else sits ("collapses onto …")."""
    wakes: bool = False
    """Whether one must have been asleep before."""
    done: bool = False
    """Whether it is done while sitting or lying, and no going to a seat by itself ("reads")."""


KINDS: Final = (
    Kind(Skill.GETUP, WAKES, wakes=True),
    Kind(Skill.STANDUP, RISES),
    Kind(Skill.LOCO, ON_THE_PHONE),
    Kind(Skill.LIEDOWN, LIES),
    Kind(Skill.SITDOWN, LETS_DOWN),
    Kind(Skill.LIEDOWN, FALLS, falls=True),
    Kind(Skill.SITDOWN, SITS),
    Kind(Skill.SITDOWN, DOES_SITTING, done=True),
    Kind(Skill.TOUCH, TOUCHES),
    Kind(Skill.LOCO, GOES),
    Kind(Skill.LOCO, STANDS),
)
"""The first that fits."""

_NO_FURNITURE: Final = re.compile(
    rf"^\W*(?:\w+\s+){{0,4}}?{OWN}?\s*(?:\w+\s+)?(?:doors?|windows?|gate)\b", re.IGNORECASE
)
_NOT_PIECES: Final = frozenset(
    ("bar", "chest", "trunk", "picture", "book", "pillow", "clock", "statue", "console", "seat", "bin")
)
"""Furniture words that mean something else more often."""
_STANDS_ON: Final = {"tv": "tv stand", "monitor": "desk", "table lamp": "nightstand"}
"""Where one goes for what stands on other furniture."""
_SEATS_AT: Final = {
    "desk": "chair", "dining_table": "dining chair", "table": "chair", "kitchen_counter": "barstool",
    "dressing_table": "dressing chair", "console_table": "chair",
}  # fmt: skip
"""Where one sits at what nobody sits on."""
_CLOTHES: Final = (
    "cloth\\w*|suit|shirt|dress\\w*|coat|jacket|jeans|sweater|socks|changes?|changed|outfit|p[yj]+amas|tie"
)
_PAPERS: Final = "laptop|computer|keyboard|printer|papers|documents|files?|pens?|notebook|email\\w*"
_MEALS: Final = """water|milk|beer|wine|whisk\\w+|bottle|glass|glasses|cups?|mug|plates?|dishes|bowl|pan|pot|food|
breakfast|lunch|dinner|supper|snack|coffee|tea|kettle|cereal|soup|cake|bread|sandwich|medicine|pills?"""
_THINGS: Final = (
    (_CLOTHES, "wardrobe"),
    ("books?|novel|album|diary|dictionary|photos?|photographs?|letters?", "bookshelf"),
    ("tv|television|remote|channel|radio|music|stereo|record", "tv stand"),
    (_PAPERS, "desk"),
    ("light|lights|lamp", "floor lamp"),
    (_MEALS.replace("\n", ""), "cabinet"),
)
"""Where things are kept."""


@dataclass(frozen=True)
class Deed:
    """What a clause has a body do."""

    kind: Kind
    skill: Skill
    piece: str = ""
    """The furniture word it names or hints at; empty where it names none."""
    named: bool = False
    """Whether the clause itself names the piece."""


def deed_of(clause: str) -> Deed | None:
    """The deed of a clause without its subject ("slumps onto the couch"), or None where a body shows none."""
    found = _kinds(clause)
    if found is None:
        return None
    kind, rest = found
    skill = kind.skill
    if skill is Skill.LOCO:
        piece = next((one for one in pieces_in(rest) if furniture.affordances(one)), "")
        return Deed(kind, skill, piece, bool(piece))
    if skill in (Skill.STANDUP, Skill.GETUP):
        piece = next((one for one in pieces_in(rest) if furniture.affordances(one) & {"sit", "lie"}), "")
        return Deed(kind, skill, piece, bool(piece))
    if skill is Skill.TOUCH and _NO_FURNITURE.match(rest) and not pieces_in(rest):
        return None
    named = pieces_in(rest)
    if kind.falls and not any(affords(piece, "lie") for piece in named):
        skill = Skill.SITDOWN
    elif kind.skill is Skill.SITDOWN and not kind.done and any(furniture.group_of(piece) == "bed" for piece in named):
        skill = Skill.LIEDOWN if re.match(LETS_DOWN, _bare(clause), re.IGNORECASE) else skill
    if kind.falls and not named:
        return None  # "rests in peace", "falls into a rage"
    fitting = ""
    if skill is Skill.SITDOWN and not re.search(r"\bon (?:\w+ ){0,3}(?:table|desk|counter)\b", rest):
        fitting = next((_SEATS_AT[at] for piece in named if (at := furniture.canonical(piece)) in _SEATS_AT), "")
    fitting = fitting or next((piece for piece in named if affords(piece, NEEDS[skill])), "")
    if fitting:
        return Deed(kind, skill, fitting, True)
    kept = next((piece for words, piece in _THINGS if re.search(rf"\b(?:{words})\b", rest, re.IGNORECASE)), "")
    return Deed(kind, skill, kept if skill is Skill.TOUCH else "")


def pieces_in(text: str) -> list[str]:
    """Furniture words of a text in its order, longest names first: "dining table", not "table"."""
    words = re.findall(r"[a-z]+(?:'s)?", text.lower())
    found: list[str] = []
    at = 0
    while at < len(words):
        size = next((size for size in (3, 2, 1) if _names(tuple(words[at : at + size]), size)), 0)
        if size and words[at] not in _NOT_PIECES:
            piece = furniture.canonical(" ".join(words[at : at + size])).replace("_", " ")
            found.append(_STANDS_ON.get(piece, piece))
        at += size or 1
    return found


@cache
def _known() -> tuple[tuple[Kind, re.Pattern[str]], ...]:
    return tuple((kind, re.compile(rf"(?:{kind.words})", re.IGNORECASE)) for kind in KINDS)


def _bare(clause: str) -> str:
    """The clause from its main verb on."""
    return re.sub(rf"^{LEAD}", "", clause.strip(), count=1, flags=re.IGNORECASE)


def _kinds(clause: str) -> tuple[Kind, str] | None:
    """The first kind that the clause, or the clause from its main verb on, begins with; and what follows."""
    for start in dict.fromkeys((clause.strip(), _bare(clause))):
        for kind, pattern in _known():
            if (match := pattern.match(start)) is not None:
                return kind, start[min(match.end(), _after_verb(start)) :]
    return None


def _after_verb(text: str) -> int:
    verb = re.match(r"\S+", text)
    return verb.end() if verb else 0


def _names(words: tuple[str, ...], size: int) -> bool:
    """Whether these very words, and not only the last of them, are a furniture word."""
    if len(words) < size:
        return False
    whole = " ".join(words)
    if not furniture.is_known(whole):
        return False
    return size == 1 or furniture.canonical(whole) != furniture.canonical(" ".join(words[1:]))
