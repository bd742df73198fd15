"""What hands do at what they touch: pick up, put down, switch on, wash, rotate (LINGO Table A1)."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.styles import arm_arrays

Array = NDArray[np.float64]
HANDLINGS: Final = (
    ("pick", r"\bpick(s|ing)?\b.*\bup\b|\btak(e|ing) (up|hold)|\bgrab|\bgrasp"),
    ("put", r"\bput(s|ting)?\b.*\bdown\b|\bset(ting)? down|\bplac(e|ing)\b"),
    ("press", r"\b(turn|switch)(ing|es)? (it )?(on|off)\b|\bpress|\bpush"),
    ("wash", r"\bwash|\bwip(e|ing)|\bscrub|\bpolish"),
    ("rotate", r"\brotat|\bturn(s|ing)?\b(?! (on|off))|\btwist"),
)
"""What a caption may say is done at a thing, the first that is found."""
CARRY: Final = 0.7
"""How long the forearm takes up to the belly before something is put down (seconds)."""
KEPT: Final = 15
"""Frames for which what was picked up is held before the body."""
LONGER: Final = {"wash": 2.4, "rotate": 2.0}
"""What takes longer than a touch (seconds)."""
CARRIES: Final = 0.08
"""A wrist so near to where it would carry something carries it (arm lengths)."""
FREE: Final = ("hang", "bent")
"""Arms that swing as one walks."""
_CIRCLE, _PRESS, _TURN = 0.035, 0.03, np.radians(32)


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
    down: bool = False
    """Whether fingers point down a front."""
    other: tuple[Array, Array] | None = None
    """The other hand's wrist (3,) and palm (4,)."""

    @property
    def hands(self) -> tuple[tuple[int, Array, Array], ...]:
        """Index (0 left, 1 right), wrist and palm of each hand that is laid."""
        index = 0 if self.hand == "left" else 1
        first = (index, self.wrist, self.palm)
        return (first,) if self.other is None else (first, (1 - index, *self.other))


def handling_of(caption: str) -> str:
    """What a touch does, a word of `HANDLINGS`, or "" for a plain touch."""
    return next((doing for doing, pattern in HANDLINGS if re.search(pattern, caption.lower())), "")


def with_both_hands(caption: str) -> bool:
    """Whether a caption lays both hands on what is touched."""
    return re.search(r"\b(both|two) (hands|palms)\b", caption.lower()) is not None


def carrying(pose: Pose, hands: Iterable[int]) -> Pose:
    """A standing pose with something held in these hands (0 left, 1 right) before the body."""
    return _with_arms(pose, hands, "carry")


def empty(pose: Pose, hands: Iterable[int]) -> Pose:
    """A standing pose with these hands (0 left, 1 right) hanging, since they have put down what they held."""
    return _with_arms(pose, hands, "hang")


def arms_on_the_way(pose: Pose, arms: tuple[str, str]) -> tuple[str, str]:
    """How arms are held in walking: a hand that carries something keeps it before the body, if it would only hang."""
    wrists, _ = arm_arrays("carry", "carry")
    carries = np.linalg.norm(pose.arms - wrists, axis=-1) < CARRIES
    left, right = ("carry" if holds and arm in FREE else arm for holds, arm in zip(carries, arms, strict=True))
    return left, right


def _with_arms(pose: Pose, hands: Iterable[int], name: str) -> Pose:
    wrists, poles = arm_arrays(name, name)
    arms, elbows = pose.arms.copy(), pose.elbows.copy()
    for index in hands:
        arms[index], elbows[index] = wrists[index], poles[index]
    return replace(pose, arms=arms, elbows=elbows, reaching=np.zeros(2), pressing=np.zeros(2))


def handled(held: Pose, laid: Laid, doing: str) -> Pose:
    """A held touch of T frames with hands that do something there; it begins and ends where the hands lie."""
    time = np.arange(1, len(held) + 1) / FPS
    ease = smooth(time / 0.3) * smooth((time[-1] - time) / 0.3)
    reach, palms = held.reach.copy(), held.palms.copy()
    for index, _, palm in laid.hands:
        if doing == "press":
            reach[:, index] += (_PRESS * ease * np.sin(2 * np.pi * time / time[-1]) ** 2)[:, None] * laid.normal
        elif doing == "wash":
            reach[:, index] += _circling(palm, time, ease, 1.0 if index == 0 else -1.0)
        elif doing == "rotate":
            angle = _TURN * ease * np.sin(2 * np.pi * 0.8 * time)
            palms[:, index] = rotations.compose(rotations.rotvec_to_quat(angle[:, None] * laid.normal), palm)
    return replace(held, reach=reach, palms=palms)


def _circling(palm: Array, time: Array, ease: Array, way: float) -> Array:
    """Circles of a hand in the plane that it lies on; it rests on +Y of its own frame. (T, 3)."""
    turn = 2 * np.pi * 0.9 * time
    local = np.stack([np.cos(turn) - 1.0, np.zeros_like(turn), way * np.sin(turn)], axis=1)
    return np.asarray(_CIRCLE * ease[:, None] * rotations.rotate(palm, local))
