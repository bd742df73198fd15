"""Which caption holds what, in which hand and how: rows of data/props.toml."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from functools import cache, lru_cache
from typing import Literal

from motion_backend.motion import Skill
from scene_graphs.data_tables import read_table, require_known, require_unlike, table

Vector = tuple[float, float, float]
Direction = Literal[
    "up", "down", "ahead", "left", "trunk", "across", "fingers", "palm", "thumb",
    "face", "mouth", "scalp", "jaw", "crown", "nose", "inward",
]  # fmt: skip
"""Of the world (up, down), of the chest (ahead, left, and up the trunk), from the right to the left hand (across), of
the hand, or of both between them (fingers, palm, thumb), from there to the eyes, to the mouth and to the middle of
the skull (scalp), of the head: up (crown), ahead (nose), from the chin past the ear (jaw), and to its middle from the
side of that hand (inward)."""


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
class Way:
    """How one hand holds a thing where no caption says: as `Grip` has it."""

    along: Direction
    front: Direction
    offset_m: Vector = (0.0, 0.0, 0.0)
    beside: bool = False
    """Whether its back is at the palm, not its origin."""
    flat: bool = False
    """Whether it lies on its back where it is put down; else it stands."""


@table
class Tipped:
    """How what is drunk from is tipped at the mouth."""

    deg: float
    """From upright, wholly at the mouth."""
    rim_m: float
    """How high its rim is over its origin, and"""
    wide_m: float
    """how far from its middle."""


@table
class Called:
    """What one shape is called, and how it is held."""

    shape: str
    way: str
    words: str
    """Nouns in the singular, a hyphen in those of two words."""
    instead: tuple[str, ...] = ()
    """Props of captions that it is held in the place of."""
    offset_m: Vector | None = None
    """From the palm, in its own frame; None: its way's."""
    low: bool = False
    """Whether it is carried at the side, the arm straight."""
    flat: bool = False
    """Whether it lies on its back where it is put down, whatever its way has: a coat, which hangs from a hand."""

    def is_held_for(self, grip: Grip) -> bool:
        """Whether it is what a grip of a caption holds, or is held in the place of that."""
        return grip.prop in (self.shape, *self.instead)


@table
class Held:
    """What is in the hands for captions with these words."""

    words: str
    """The pattern that a caption fits, in lower case."""
    props: tuple[Grip, ...]
    skills: tuple[Skill, ...] = (Skill.LOCO, Skill.SITDOWN, Skill.LIEDOWN, Skill.TOUCH)
    unless: str = ""
    """A caption that fits this too is left to other rows."""
    anything: bool = False
    """Whether its prop is for want of a name: a thing that is named, and is not held so, is in one hand instead."""
    of: tuple[str, ...] = ()
    """Tools, as `called` has them: it is held so where one of these is named, and lies so under it."""

    def is_of(self, skill: Skill, caption: str) -> bool:
        """Whether a caption says so."""
        text = caption.lower()
        left = bool(self.unless and re.search(self.unless, text))
        return skill in self.skills and not left and re.search(self.words, text) is not None

    @property
    def lies_under(self) -> bool:
        """Whether what a tool is used on is seen with it: food under a knife, cloth under a needle."""
        return len(self.props) > 1 or any(grip.still for grip in self.props)

    @property
    def hands(self) -> tuple[int, ...]:
        """Those that hold: 0 the left one, 1 the right one."""
        named = {grip.hand for grip in self.props}
        return tuple(i for i, side in enumerate(("left", "right")) if named & {side, "both"})


@table
class Props:
    """data/props.toml."""

    shapes: dict[str, tuple[PropPart, ...]]
    ways: dict[str, Way]
    called: tuple[Called, ...]
    tipped: dict[str, Tipped]
    held: tuple[Held, ...]

    def __post_init__(self) -> None:
        require_unlike("held.words", [f"{row.words} {row.skills} {row.of}" for row in self.held])
        require_known("held.props", [grip.prop for row in self.held for grip in row.props], self.shapes)
        held = {grip.prop for row in self.held for grip in row.props}
        require_unlike("called", [f"{row.shape} {word}" for row in self.called for word in row.words.split()])
        require_known("held.of", [tool for row in self.held for tool in row.of], self._words)
        require_known("called.shape", [row.shape for row in self.called], self.shapes)
        require_known("tipped", self.tipped, self.shapes)
        require_known("called.way", [row.way for row in self.called], self.ways)
        require_known("called.instead", [prop for row in self.called for prop in row.instead], held)
        require_known("shapes", self.shapes, held | {row.shape for row in self.called})

    @property
    def _words(self) -> frozenset[str]:
        """All nouns by which something is called."""
        return frozenset(word for row in self.called for word in row.words.split())


@cache
def prop_table() -> Props:
    """All rows. TableError."""
    read: Props = read_table("motion_backend", "props.toml", Props)
    return read


@lru_cache(maxsize=512)
def held_in(skill: Skill, caption: str, thing: str = "") -> Held | None:
    """What a caption has in the hands, by the first row that knows its words, with what a thing is called by in the
    place of its own prop where that may be; None for nothing."""
    look = caption.rpartition(";")[2]  # before it stands what is done; see planner_service/scripts/caption_actions.py
    rows = (row for row in prop_table().held if not row.of or not {*row.of}.isdisjoint(_calls(thing)))
    row = next((row for row in rows if row.is_of(skill, look)), None)
    if row is None or not (named := shown_as(thing, row)) or any(grip.prop == named.shape for grip in row.props):
        return row
    # Of two props that it might be, it is the first.
    place = next((number for number, grip in enumerate(row.props) if named.is_held_for(grip)), None)
    if place is None:
        return None if row.anything else row
    props = [replace(grip, prop=named.shape) if number == place else grip for number, grip in enumerate(row.props)]
    return replace(row, props=tuple(props))


@cache
def things_named() -> Mapping[str, tuple[Called, ...]]:
    """The rows that call something by each noun."""
    found: dict[str, tuple[Called, ...]] = {}
    for row in prop_table().called:
        for word in row.words.split():
            found[word] = (*found.get(word, ()), row)
    return found


def shown_as(thing: str, *captions: Held | None) -> Called | None:
    """How a thing of that name is seen: as what most captions hold for it, of several shapes that it is called; None
    of what has no shape. A thing is called by its last word, or its last two: "red cups", "watering can"."""
    known = things_named()
    rows = next((known[word] for word in _calls(thing) if word in known), ())
    holding = [grip for row in captions if row is not None for grip in row.props]
    return max(rows, key=lambda row: sum(map(row.is_held_for, holding)), default=None)


def _calls(thing: str) -> tuple[str, str, str]:
    """The nouns that a thing of that name may be called by, the best first."""
    words = thing.lower().split()[-2:]
    last = "".join(words[-1:])
    return "-".join(words), last, last.removesuffix("s")
