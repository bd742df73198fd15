"""Ways of lying: side, legs and arms, and which an emotion and a caption ask for (SIMS 4.1, 8.1, 9)."""

from __future__ import annotations

from dataclasses import dataclass

from motion_backend.procedural.moods import Words, bearing_of, changes_of
from motion_backend.procedural.styles import AT_EASE, Bearing


@dataclass(frozen=True)
class Lying:
    """A way of lying."""

    bearing: Bearing = AT_EASE
    side: str = "back"
    """back, left or right: what is down."""
    arms: tuple[str, str] = ("sides", "sides")
    legs: str = "straight"
    """straight, left_bent, right_bent, bent, crossed."""
    prop: float = 0.0
    """How far the trunk is propped up."""


_LIE_WORDS: Words = (
    (r"spread|wide", {"arms": ("wide", "wide")}),
    (r"belly|stomach|chest", {"arms": ("belly", "belly")}),
    (r"(under|behind|supporting) (the |his |her )?head", {"arms": ("behind_head", "behind_head")}),
    (r"right (arm|hand) .*head", {"arms": ("belly", "behind_head")}),
    (r"left (arm|hand) .*head", {"arms": ("behind_head", "belly")}),
    (r"right hand on belly", {"arms": ("sides", "belly")}),
    (r"cover", {"arms": ("face", "face")}),
    (r"\bread|book", {"arms": ("held_above", "held_above")}),
    (r"elbows? support|propp", {"prop": 32.0, "arms": ("elbows", "elbows")}),
    (r"legs (are )?bent|knees bent|curled", {"legs": "bent"}),
    (r"legs crossed", {"legs": "crossed"}),
    (r"left leg bent|left knee|left foot on", {"legs": "left_bent"}),
    (r"right leg bent|right knee|right foot on", {"legs": "right_bent"}),
    (r"side[- ]?l(ie|ying)( on)?( the)? left|on (his |her |the )?left side", {"side": "left"}),
    (r"side[- ]?l(ie|ying)( on)?( the)? right|on (his |her |the )?right side", {"side": "right"}),
)


def lie_style(emotion: str, caption: str) -> Lying:
    """The way of lying a caption asks for."""
    return Lying(bearing=bearing_of(emotion, caption), **changes_of(caption, _LIE_WORDS))
