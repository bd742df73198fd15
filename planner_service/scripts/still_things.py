"""What is told of doors, lamps and screens under the hands, and is not seen: that they open, shut, go on or off."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Final

from motion_backend.motion import Does

MOVED: Final = re.compile(
    r"\b(?:open|clos|shut|slam|bang|draw|pull|unlock|lock)\w*\b(?:(?!\b(?:and|then)\b)[^,;.])*?"
    r"\b((?:cabinet|cupboard|wardrobe|closet|fridge|refrigerator|freezer|oven|microwave|dresser|desk)(?: door| drawer)?"
    r"|drawer|door|gate|window|curtain|blind|shutter|lid|box|chest|suitcase)(s?)\b",
    re.IGNORECASE,
)
"""Words of a beat in which a thing moves."""
REACHED_INTO: Final = re.compile(
    r"\b(?:look|peer|peek|glanc|star|gaz|rummag|search|dig|dug|hunt|root|reach|t[ao]k|get|got|fetch|grab|find|found|put"
    r"|plac|stor|hid)\w*\b(?:(?!\b(?:and|then)\b)[^,;.])*?\b(?P<there>(?:in|into|inside|through|from|out of) "
    r"(?:the|an?|his|her|their|my|its) (?:\w+ )??"
    r"(?P<what>cabinet|cupboard|wardrobe|closet|fridge|refrigerator|drawer))\b",
    re.IGNORECASE,
)
"""Words of a beat in which a hand goes into what is shut."""
QUENCHED: Final = re.compile(
    r"\b(?:(?:turn|switch|click|flick|shut)\w*\b[^,;.]*?\b(?:off|out|down)\b|(?:blow|blew|blown|snuff|put)\w* out\b"
    r"|(?:blow|blew|snuff|put)\w* (?:(?:the|a|an|his|her|their|my|every|each|all) )?(?:\w+ ){1,2}out\b"
    r"|extinguish\w*|unplug\w*)",
    re.IGNORECASE,
)
"""Words of a beat in which something goes off or out."""
LIT: Final = re.compile(
    r"\b(?:turn|switch|click|flick|flip|put|snap)\w*\b[^,;.]*?\bon\b"
    r"|\b(?:light(?:s|ed|ing)?|lit|ignit\w+) (?:the|an?|his|her|their|my) ",
    re.IGNORECASE,
)
_SWITCHED: Final = re.compile(
    r"\b(?:lamps?|lights?|tv|telly|television|screen|stove|hob|gas|oven|tap|faucet|radio|stereo|music|kettle|fan|heating"
    r"|heater|computer|laptop|candles?|fire|match|lantern)\b",
    re.IGNORECASE,
)
"""Words of a beat in which something goes on, and what."""


def still_in(text: str, seen: Collection[Does] = ()) -> tuple[str, ...]:
    """What of a beat's words is not seen though a hand is: "that the door moves", "that it goes off"; `seen` is what
    becomes of pieces while it is acted."""
    told, _ = _still(text, seen)
    return (told,) if told else ()


def still_words(text: str, seen: Collection[Does] = ()) -> str:
    """The words themselves: "opens the door"; "" where all is seen."""
    return _still(text, seen)[1]


def _still(text: str, seen: Collection[Does]) -> tuple[str, str]:
    if moved := MOVED.search(text):
        known, told = {"open", "close"}, f"that the {moved[1].lower()}{moved[2]} move{'' if moved[2] else 's'}"
        return ("", "") if known & {*seen} else (told, moved[0])
    if quenched := QUENCHED.search(text):
        told = f"that it goes {'down' if quenched[0].endswith('down') else 'off'}"
        return ("", "") if "off" in seen else (told, quenched[0])
    lit, switched = LIT.search(text), _SWITCHED.search(text)
    if lit and switched:
        words = text[min(lit.start(), switched.start()) : max(lit.end(), switched.end())]
        return ("", "") if "on" in seen else ("that it goes on", words)
    inner = REACHED_INTO.search(text)
    hidden = inner is not None and not {"into", "open"} & {*seen}
    return (f"that the {inner['what'].lower()} opens", inner["there"]) if inner and hidden else ("", "")
