"""Ways of lying: side, legs and arms, which data/styles/lie.toml has by caption (SIMS 4.1, 8.1, 9)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from motion_backend.motion import Emotion
from motion_backend.procedural.emotion_style import AT_EASE, Bearing, bearing_of
from motion_backend.procedural.lie.lie_own import CHARACTER, NOBODY, LieOwn, OwnWay, drawn_arms
from motion_backend.procedural.own_way import drawn_way
from motion_backend.procedural.style_sheet import Radians, Seconds, read_style_sheet


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
    """Whether the trunk is raised on the elbows, on a side with the head in the hand."""
    nod: Radians = 0.0
    turn: Radians = 0.0
    """How far the head is lifted, and turned to the left, from where it rests."""
    doing: str = ""
    """What is done lying: one of `gestures.gesture_names`."""
    stays: Seconds = 0.0
    """How long that takes at least."""
    own: OwnWay = NOBODY


def lie_style(emotion: Emotion, caption: str) -> Lying:
    """The way of lying a caption asks for."""
    changes = read_style_sheet("lie.toml", Lying).of_caption(caption, emotion)
    return Lying(bearing=bearing_of(emotion, caption), **changes)


def wanted_edge(caption: str) -> str | None:
    """The side of the body that a caption wants towards the free edge: the front of who lies on a side, a foot's."""
    style = lie_style(Emotion.NEUTRAL, caption)
    if style.side != "back":
        return style.side
    return style.legs.removesuffix("_down") if style.legs.endswith("_down") else None


def own_way(style: Lying, own: LieOwn, seed: int, rng: np.random.Generator) -> Lying:
    """The way of lying as it is this time, of the character of that seed."""
    rows = own.back_arms if style.side == "back" else own.side_arms
    arms = drawn_arms(rows, own.usual_arms_share, seed, rng)
    style = replace(style, own=drawn_way(NOBODY, own.spread, (seed, CHARACTER), rng))
    if style.arms != Lying().arms or style.propped:
        return style
    pair = (arms.left, arms.right)
    return replace(style, arms=pair if style.side != "right" else pair[::-1])
