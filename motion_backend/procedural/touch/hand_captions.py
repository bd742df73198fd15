"""What hands do at what they touch: pick up, put down, switch on, wash, rotate (LINGO Table A1)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.emotion_style import arm_arrays
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.style_sheet import read_style_sheet
from motion_backend.props.prop_table import shown_as
from motion_backend.rotations import Array
from motion_backend.skeleton import HAND_REST

CARRIES: Final = 0.08
"""A wrist so near to where it would carry something carries it (arm lengths)."""
CARRYING: Final = ("carry", "carry_low")
"""The arm poses of a hand that holds something: before the body, or at the side where that hangs from it."""
FREE: Final = ("hang", "bent")
"""Arms that swing as one walks."""
FINGERS, FINGER = 0.14, 0.024
"""From the wrist to the fingertips, and half of what a hand is thick (metres)."""


@dataclass(frozen=True)
class Handled:
    """What a caption may say of hands at a thing."""

    doing: str = ""
    """What `touch_keys.TouchKeys` has a table of; nothing for a plain touch."""
    both_hands: bool = False
    """Whether both are laid on it."""


@dataclass(frozen=True)
class Laid:
    """Where a hand is to lie, and where the other one is when both do."""

    wrist: Array
    """(3,) world."""
    palm: Array
    """(4,) hand to world."""
    normal: Array
    """(3,) out of the surface."""
    hand: str
    other: tuple[Array, Array] | None = None
    """The other hand's wrist (3,) and palm (4,)."""
    stroke: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) along the surface, as far as hands may go that way and its opposite (metres)."""
    elbows: Array = field(default_factory=lambda: np.zeros((2, 3)))
    """(2, 3) where the elbows of hands that are laid point, in the chest's frame (see `hand_placement.placed`)."""

    @property
    def hands(self) -> tuple[tuple[int, Array, Array], ...]:
        """Index (0 left, 1 right), wrist and palm of each hand that is laid."""
        index = 0 if self.hand == "left" else 1
        first = (index, self.wrist, self.palm)
        return (first,) if self.other is None else (first, (1 - index, *self.other))

    def tilted(self, angle: float) -> Laid:
        """The first hand with its fingers turned into the surface (radians), as high over it as their tips need."""
        side = 1.0 if self.hand == "left" else -1.0
        turn = rotations.rotvec_to_quat(np.array([0.0, 0.0, -side * angle]))
        lift = max(FINGERS * float(np.sin(angle)) + FINGER - HAND_REST, 0.0)
        return replace(self, wrist=self.wrist + lift * self.normal, palm=rotations.compose(self.palm, turn))


def handled(caption: str) -> Handled:
    """What data/styles/touch.toml says of a caption."""
    return Handled(**read_style_sheet("touch.toml", Handled).of_caption(caption))


def handling_of(caption: str) -> str:
    """What a touch does, as `Handled.doing` says it."""
    return handled(caption).doing


def with_both_hands(caption: str) -> bool:
    """Whether a caption lays both hands on what is touched."""
    return handled(caption).both_hands


def steadies(caption: str) -> bool:
    """Whether the other hand keeps still what one hand turns."""
    return handling_of(caption) == "rotate"


def arms_on_the_way(pose: Pose, arms: tuple[str, str], thing: str | None = None) -> tuple[str, str]:
    """How arms are held in walking: a hand that carries something goes on to, if it would only hang; a `thing` of that
    name as that is carried."""
    left, right = (
        (carried_as(thing) if thing else carried) if carried and arm in FREE else arm
        for carried, arm in zip(_carried(pose), arms, strict=True)
    )
    return left, right


def holding(pose: Pose) -> tuple[bool, bool]:
    """Whether the left and the right hand carry something."""
    left, right = map(bool, _carried(pose))
    return left, right


def carried_as(thing: str | None) -> str:
    """The arm pose in which a thing of that name is carried."""
    called = shown_as(thing) if thing else None
    return "carry_low" if called is not None and called.low else "carry"


def _carried(pose: Pose) -> tuple[str, str]:
    """In which pose the left and the right hand carry something; "" where one does not."""
    near = [np.linalg.norm(pose.arms - arm_arrays(name, name)[0], axis=-1) < CARRIES for name in CARRYING]
    left, right = (next((name for name, is_so in zip(CARRYING, near, strict=True) if is_so[i]), "") for i in (0, 1))
    return left, right


def with_arms(pose: Pose, hands: Iterable[int], name: str) -> Pose:
    """A pose whose hands (0 left, 1 right) lie nowhere, their arms held in the pose of that name."""
    wrists, poles = arm_arrays(name, name)
    arms, elbows = pose.arms.copy(), pose.elbows.copy()
    for index in hands:
        arms[index], elbows[index] = wrists[index], poles[index]
    return replace(pose, arms=arms, elbows=elbows, reaching=np.zeros(2), pressing=np.zeros(2))
