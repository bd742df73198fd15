"""How an emotion and a caption look: the style each asks for (SIMS 4.1, 8.1, 9)."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import lru_cache
from typing import Any

from motion_backend.procedural.styles import Bearing

STILL = 0.3
"""Restlessness, against its mood, of who keeps still."""

BEARINGS: dict[str, Bearing] = {
    "neutral": Bearing(),
    "happy": Bearing(lean=-3, head=-7, tempo=1.2, restless=1.5),
    "angry": Bearing(lean=9, head=10, tempo=1.3, restless=1.4, arms=("bent", "bent")),
    "hurried": Bearing(lean=7, head=2, tempo=1.4, restless=1.5),
    "tired": Bearing(lean=13, head=16, tempo=0.75, restless=0.7),
    "sad": Bearing(lean=15, head=24, tempo=0.72, restless=0.5),
    "stressed": Bearing(lean=7, head=13, tempo=1.05, restless=1.8),
    "drunk": Bearing(lean=6, head=11, tempo=0.8, restless=3.5),
    "relaxed": Bearing(lean=-2, head=0, tempo=0.9, restless=0.9),
}
_FEELINGS = (
    ("drunk", r"drunk|tipsy|zombie|stagger|intoxicat|hangover"),
    ("angry", r"ang(er|ry)|furious|rage|mad\b|irritat|annoy|cold"),
    ("hurried", r"hurr|rush|urgen|panic|haste|late\b"),
    ("sad", r"sad|depress|grie|mourn|lonely|pain|heartbr|disappoint|melanchol|cry"),
    ("stressed", r"stress|anxi|nervous|worr|serious|disturb|uncomfort|tense|afraid|scared|guilt|asham"),
    ("tired", r"tired|sleepy|exhaust|weary|drows|sick|bored"),
    ("happy", r"happy|excit|joy|child|playful|cheer|proud|confident|elat|celebrat|curious|love"),
    ("relaxed", r"relax|content|peace|cozy|comfort|dream"),
)


@lru_cache(maxsize=4096)
def feeling(emotion: str, caption: str = "") -> str:
    """The one of nine emotions that free text such as "tired, depressed, drunk" stands for: the first word decides.

    A neutral emotion falls back to what the caption says ("walking drunkenly").
    """
    for text in (emotion.lower(), caption.lower()):
        found = [(match.start(), name) for name, pattern in _FEELINGS if (match := re.search(pattern, text))]
        if "drunk" in [name for _, name in found]:
            return "drunk"
        if found:
            return min(found)[1]
    return "neutral"


def bearing_of(emotion: str, caption: str = "") -> Bearing:
    """Posture and pace of an emotion; "slowly" and "abruptly" in the caption change the pace."""
    bearing = BEARINGS[feeling(emotion, caption)]
    if re.search(r"slow|weari", caption.lower()):
        return replace(bearing, tempo=min(bearing.tempo, 0.7))
    if re.search(r"abrupt|quick|sudden|leap|jump", caption.lower()):
        return replace(bearing, tempo=max(bearing.tempo, 1.5))
    if re.search(r"\bstill\b", caption.lower()):
        return replace(bearing, restless=STILL * bearing.restless)
    return bearing


Words = tuple[tuple[str, dict[str, Any]], ...]
"""Rows of what a caption says (a pattern) and what that changes. Later rows win: the particular after the general."""


def changes_of(caption: str, words: Words) -> dict[str, Any]:
    """What the rows whose pattern a caption has change, the later over the earlier."""
    changes: dict[str, Any] = {}
    for pattern, row in words:
        if re.search(pattern, caption.lower()):
            changes |= row
    return changes
