"""Things that stay as they are when a hand is laid on them: what is told of doors and lamps, and is not seen."""

from __future__ import annotations

import re
from typing import Final

MOVED: Final = re.compile(
    r"\b(?:open|clos|shut|slam|bang|draw|pull|unlock|lock)\w*\b(?:(?!\b(?:and|then)\b)[^,;.])*?"
    r"\b((?:cabinet|cupboard|wardrobe|closet|fridge|refrigerator|freezer|oven|microwave|dresser|desk)(?: door| drawer)?"
    r"|drawer|door|gate|window|curtain|blind|shutter|lid|box|chest|suitcase)(s?)\b",
    re.IGNORECASE,
)
"""Words of a beat in which a thing moves."""
QUENCHED: Final = re.compile(
    r"\b(?:(?:turn|switch|click|flick|shut)\w*\b[^,;.]*?\b(?:off|out|down)\b|(?:blow|blew|blown|snuff|put)\w* out\b"
    r"|(?:blow|blew|snuff|put)\w* (?:(?:the|a|an|his|her|their|my|every|each|all) )?(?:\w+ ){1,2}out\b"
    r"|extinguish\w*|unplug\w*)",
    re.IGNORECASE,
)
"""Words of a beat in which something goes off or out."""


def still_in(text: str) -> tuple[str, ...]:
    """What of a beat's words is not seen though a hand is: "that the door moves", "that it goes off"."""
    moved = MOVED.search(text)
    if moved:
        return (f"that the {moved[1].lower()}{moved[2]} move{'' if moved[2] else 's'}",)
    quenched = QUENCHED.search(text)
    return (f"that it goes {'down' if quenched[0].endswith('down') else 'off'}",) if quenched else ()
