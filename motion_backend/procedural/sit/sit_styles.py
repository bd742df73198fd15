"""Ways of sitting: trunk, legs and hands, which data/styles/sit.toml has by caption (SIMS 4.1, 8.1, 9)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from motion_backend.motion import Emotion
from motion_backend.procedural.emotion_style import AT_EASE, THIGHS, Bearing, bearing_of, carried
from motion_backend.procedural.sit.sit_own import NOBODY, OwnSeat
from motion_backend.procedural.style_sheet import Degrees, Metres, Share, read_style_sheet


@dataclass(frozen=True)
class Manner:
    """How one goes down onto a seat and leaves it."""

    glance: Share = 1.0
    """How far one looks back at the seat first."""
    hands: tuple[bool, bool] = (False, True)
    """Which hands feel for the armrest or the seat on the way down."""
    plump: Share = 0.4
    """How heavily one lands: the pelvis sinks and comes up again."""
    sway: Metres = 0.0
    """To the side on the way."""


@cache
def manners() -> Mapping[Emotion, Manner]:
    """The manner of every emotion."""
    rows = read_style_sheet("sit_down.toml", Manner).emotions
    return {emotion: Manner(**rows.get(emotion, {})) for emotion in Emotion}


@dataclass(frozen=True)
class Seated:
    """A way of sitting."""

    bearing: Bearing = AT_EASE
    manner: Manner = Manner()
    arms: tuple[str, str] = (THIGHS, THIGHS)
    """For each hand a rest of `hand_rests.HOLDS`, a surface of `sit_pose.SURFACES` or a pose of styles/arms.toml."""
    legs: str = "rest"
    """One of `sit_legs.WAYS`."""
    recline: Degrees = 4.0
    """Backward lean of the trunk once seated; negative is forward. The backrest limits it."""
    on_elbows: bool = False
    """Leaning forward just as far as elbows lie on thighs or table, whatever `recline` says."""
    head: Degrees = 0.0
    tilt: Degrees = 0.0
    """Head turned to the left."""
    own: OwnSeat = NOBODY
    """What this time of sitting has of its own."""
    doing: str = ""
    """What the hands do while seated: one of `gestures.gesture_names`."""


AT_REST = 9.0
"""Backward lean of who sits as it comes: against the back of the seat, where there is one (degrees)."""
SLUMP = 1.2
"""How much of the forward lean of a bearing takes from that, seated."""
HANGING = 0.8
"""How much of its bent head is seen, seated."""


def sit_style(emotion: Emotion, caption: str) -> Seated:
    """The way of sitting a caption asks for, in that emotion."""
    said = read_style_sheet("sit.toml", Bearing, Seated).of_caption(caption, emotion)
    bearing, changes = carried(bearing_of(emotion, caption), said, Seated)
    slump = {"recline": AT_REST - SLUMP * max(bearing.lean, 0.0), "head": HANGING * max(bearing.head, 0.0)}
    return Seated(bearing=bearing, manner=manners()[emotion], **(slump | changes))
