"""Which caption holds what, in which hand and how: rows of data/props.toml."""

from __future__ import annotations

import re
from functools import cache
from typing import Literal

from motion_backend.motion import Skill
from scene_graphs.data_tables import read_table, require_known, require_unlike, table

Vector = tuple[float, float, float]
Direction = Literal[
    "up", "down", "ahead", "left", "trunk", "across", "fingers", "palm", "thumb",
    "face", "mouth", "jaw", "crown", "nose", "inward",
]  # fmt: skip
"""Of the world (up, down), of the chest (ahead, left, and up the trunk), from the right to the left hand (across), of
the hand, or of both between them (fingers, palm, thumb), from there to the eyes and to the mouth, of the head: up
(crown), ahead (nose), from the chin past the ear (jaw), and to its middle from the side of that hand (inward)."""


@table
class PropPart:
    """A block, an upright cylinder or a pillow thick along z, between two corners in the frame of its prop (metres)."""

    low: Vector
    high: Vector
    color: Vector
    """sRGB."""
    form: Literal["block", "cylinder", "pillow"] = "block"
    bevel: float = 0.0
    taper: float = 1.0
    """How wide it is at its upper end against its lower one."""
    segments: int = 10
    turned_deg: Vector = (0.0, 0.0, 0.0)
    """About x, then y, then z, through its middle."""


@table
class Grip:
    """One prop in the hands: y is along it, z is its front."""

    prop: str
    """A name in `shapes`."""
    hand: Literal["left", "right", "both"]
    """Whose palm it lies in; between both."""
    along: Direction
    front: Direction
    keeps: Literal["along", "front"] = "along"
    """Which of them it keeps to where they are not at right angles."""
    offset_m: Vector = (0.0, 0.0, 0.0)
    """From the palm, or the middle between both, to its origin, in its own frame."""
    turned_deg: Vector = (0.0, 0.0, 0.0)
    """How it is turned in that frame: about x, then y, then z."""
    still: bool = False
    """Whether it stays where the hand mostly is: what lies on a table."""
    stands: bool = False
    """Whether it is pushed along y until it stands on the floor."""


@table
class Held:
    """What is in the hands for captions with these words."""

    words: str
    """The pattern that a caption fits, in lower case."""
    props: tuple[Grip, ...]
    skills: tuple[Skill, ...] = (Skill.LOCO, Skill.SITDOWN, Skill.LIEDOWN, Skill.TOUCH)
    unless: str = ""
    """A caption that fits this too is left to other rows."""

    def is_of(self, skill: Skill, caption: str) -> bool:
        """Whether a caption says so."""
        text = caption.lower()
        left = bool(self.unless and re.search(self.unless, text))
        return skill in self.skills and not left and re.search(self.words, text) is not None

    @property
    def hands(self) -> tuple[int, ...]:
        """Those that hold: 0 the left one, 1 the right one."""
        named = {grip.hand for grip in self.props}
        return tuple(i for i, side in enumerate(("left", "right")) if named & {side, "both"})


@table
class Props:
    """data/props.toml."""

    shapes: dict[str, tuple[PropPart, ...]]
    held: tuple[Held, ...]

    def __post_init__(self) -> None:
        require_unlike("held.words", [f"{row.words} {row.skills}" for row in self.held])
        require_known("held.props", [grip.prop for row in self.held for grip in row.props], self.shapes)
        require_known("shapes", self.shapes, {grip.prop for row in self.held for grip in row.props})


@cache
def prop_table() -> Props:
    """All rows. TableError."""
    read: Props = read_table("motion_backend", "props.toml", Props)
    return read


def held_in(skill: Skill, caption: str) -> Held | None:
    """What a caption has in the hands, by the first row that knows its words; None for nothing."""
    look = caption.rpartition(";")[2]  # before it stands what is done; see planner_service/scripts/caption_actions.py
    return next((row for row in prop_table().held if row.is_of(skill, look)), None)
