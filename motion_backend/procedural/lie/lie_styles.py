"""Ways of lying: side, legs and arms, and which an emotion and a caption ask for (SIMS 4.1, 8.1, 9)."""

from __future__ import annotations

from dataclasses import dataclass

from motion_backend.motion import Emotion
from motion_backend.procedural.emotion_style import AT_EASE, Bearing, Words, bearing_of, changes_of


@dataclass(frozen=True)
class Lying:
    """A way of lying."""

    bearing: Bearing = AT_EASE
    side: str = "back"
    """back, left or right: what is down."""
    arms: tuple[str, str] = ("sides", "sides")
    legs: str = "straight"
    """straight, loose, left_bent, right_bent, bent, tucked, crossed; left_down, right_down: that foot on the floor."""
    propped: bool = False
    """Whether the trunk is raised on the elbows."""
    nod: float = 0.0
    turn: float = 0.0
    """How far the head is lifted, and turned to the left, from where it rests (radians)."""


_LIE_WORDS: Words = (
    (r"\bstill\b", {"arms": ("loose", "loose"), "legs": "loose", "turn": 0.45}),
    (r"spread|wide", {"arms": ("wide", "wide"), "legs": "loose"}),
    (r"chest|heart", {"arms": ("chest", "chest")}),
    (r"belly|stomach", {"arms": ("belly", "belly")}),
    (r"(under|behind|supporting) (the |his |her )?head", {"arms": ("behind_head", "behind_head")}),
    (r"right (arm|hand) .*head", {"arms": ("belly", "behind_head")}),
    (r"left (arm|hand) .*head", {"arms": ("behind_head", "belly")}),
    (r"right hand on (the |his |her )?belly", {"arms": ("sides", "belly")}),
    (r"left hand on (the |his |her )?belly", {"arms": ("belly", "sides")}),
    (r"cover", {"arms": ("face", "face")}),
    (r"\bread|book", {"arms": ("held_above", "held_above"), "nod": 0.22}),
    (r"elbows? support|propp", {"propped": True}),
    (r"legs (are )?bent|knees bent", {"legs": "bent"}),
    (r"legs crossed", {"legs": "crossed"}),
    (r"left leg bent|left knee", {"legs": "left_bent"}),
    (r"right leg bent|right knee", {"legs": "right_bent"}),
    (r"left foot on the (floor|ground)", {"legs": "left_down", "arms": ("belly", "sides")}),
    (r"right foot on the (floor|ground)", {"legs": "right_down", "arms": ("sides", "belly")}),
    (r"side[- ]?l(ie|ying)( on)?( the)? left|on (his |her |the )?left side", {"side": "left"}),
    (r"side[- ]?l(ie|ying)( on)?( the)? right|on (his |her |the )?right side", {"side": "right"}),
    (r"side[- ]?l(ie|ying)( on)?( the)? right(?!.*bent)", {"arms": ("along", "pillow")}),
    (r"curled|knees drawn", {"legs": "tucked", "arms": ("tucked", "tucked")}),
)


def lie_style(emotion: Emotion, caption: str) -> Lying:
    """The way of lying a caption asks for."""
    return Lying(bearing=bearing_of(emotion, caption), **changes_of(caption, _LIE_WORDS))


def wanted_edge(caption: str) -> str | None:
    """The side of the body that a caption wants towards the free edge: the front of who lies on a side, a foot's."""
    style = lie_style(Emotion.NEUTRAL, caption)
    if style.side != "back":
        return style.side
    return style.legs.removesuffix("_down") if style.legs.endswith("_down") else None
