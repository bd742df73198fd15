"""Props in the frames of a motion: keyframes with what is in the hands in them, and where a prop is meanwhile."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.body.cast import InHand, Role
from motion_backend.motion import Motion, Skill
from motion_backend.props.prop_shapes import PropShape, prop_shape
from motion_backend.props.prop_table import Called, Grip, Held, held_in, shown_as
from motion_backend.rotations import Array

Flags = NDArray[np.bool_]
GROWS: Final = 0.2
"""Seconds in which a prop comes, and in which it goes."""


@dataclass(frozen=True)
class Moment:
    """A keyframe in which something is in the hands, by its caption or by name."""

    start: int
    stop: int
    skill: Skill
    caption: str
    held: Held | None
    """What its caption has in the hands, a thing that is named in its place where that may be."""
    named: InHand | None
    """What is named, of what has a shape."""

    @staticmethod
    def of(motion: Motion, role: Role, start: int, stop: int) -> Moment | None:
        """That of some frames; None where nothing is in the hands."""
        keyframe = int(motion.actions[start])
        if keyframe not in role.captions:
            return None
        named = role.things.get(keyframe)
        named = named if named is not None and shown_as(named.thing) is not None else None
        held = held_in(*role.captions[keyframe], named.thing if named else "")
        return None if held is None and named is None else Moment(start, stop, *role.captions[keyframe], held, named)

    @property
    def thing(self) -> str:
        """What is named, or ""."""
        return self.named.thing if self.named is not None else ""

    @property
    def shape(self) -> Called | None:
        """What that looks like, as far as this moment tells."""
        return shown_as(self.thing, self.held)

    @property
    def grip(self) -> Grip | None:
        """How its caption holds what is named; None where it does not."""
        shape = self.shape
        props = self.held.props if self.held is not None and shape is not None else ()
        return next((grip for grip in props if shape is not None and grip.prop == shape.shape), None)

    @property
    def is_carried(self) -> bool:
        """Whether what is named is in the hands otherwise than its caption has it: taken, put down, carried."""
        return bool(self.thing) and self.grip is None


@dataclass(frozen=True)
class PropTrack:
    """A prop that is there for some frames, N of them from `start` on."""

    prop: str
    start: int
    positions: Array
    """(N, 3) its origin in the world, metres."""
    turns: Array
    """(N, 4) its frame to the world, xyzw."""
    sizes: Array
    """(N,) shares of its size, 0 to 1 at 1.70 m."""
    lying: Flags | None = None
    """(N,) where it lies somewhere, and nobody holds it; None: nowhere."""
    taken: tuple[int, ...] | None = None
    """The frames in which it is taken, or lifted as a caption has it; None: its first."""
    own: PropShape | None = None
    """What it looks like, where that is no row of the table."""

    @property
    def shape(self) -> PropShape:
        """What it looks like."""
        return self.own or prop_shape(self.prop)

    @property
    def stop(self) -> int:
        """Behind its last frame."""
        return self.start + len(self.positions)

    @property
    def lifts(self) -> tuple[int, ...]:
        """The frames in which something is begun with it."""
        return (self.start,) if self.taken is None else self.taken

    @property
    def held(self) -> tuple[tuple[int, int], ...]:
        """First and stop frame of every stretch in which it is in the hands."""
        held = np.ones(len(self.positions), dtype=bool) if self.lying is None else ~self.lying
        return tuple((self.start + start, self.start + stop) for start, stop in runs_of(held))

    def lies(self, start: int, stop: int) -> bool:
        """Whether it lies where it is in all of these frames, whole."""
        first, last = start - self.start, stop - self.start
        if self.lying is None or first < 0 or last > len(self.positions):
            return False
        whole = self.lying[first:last] & (self.sizes[first:last] == 1.0)
        still = [not np.ptp(one[first:last], axis=0).any() for one in (self.positions, self.turns)]
        return bool(whole.all()) and all(still)

    def sets_off(self, start: int, stop: int) -> int | None:
        """The first of some frames in which it moves; None where it stays."""
        first = max(start - self.start, 0)
        ways = (np.diff(one[first : max(stop - self.start, first)], axis=0) for one in (self.positions, self.turns))
        moving = np.flatnonzero(sum(np.abs(way).sum(axis=1) for way in ways))
        return self.start + first + int(moving[0]) if len(moving) else None

    def is_held(self, frame: int) -> bool:
        """Whether it is in the hands at a frame."""
        now = frame - self.start
        return 0 <= now < len(self.positions) and not (self.lying is not None and bool(self.lying[now]))


def spans_of(motion: Motion) -> Iterator[tuple[int, int]]:
    """First frame and stop frame of every keyframe."""
    starts = np.flatnonzero(np.diff(motion.actions, prepend=motion.actions[:1] - 1)).tolist()
    return zip(starts, [*starts[1:], len(motion)], strict=True)


def runs_of(flags: Flags) -> list[tuple[int, int]]:
    """First and stop index of every run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def growth(start: int, stop: int, frames: int, fps: int) -> Array:
    """The shares of its size that a prop has from one frame to another of `frames`: it comes and goes, but for what is
    there at the first frame or the last. (N,)."""
    ramp = GROWS * fps
    since = np.arange(1, stop - start + 1) / ramp if start else np.ones(stop - start)
    left = np.arange(stop - start, 0, -1) / ramp if stop < frames else np.ones(stop - start)
    share = np.clip(np.minimum(since, left), 0.0, 1.0)
    return np.asarray(share * share * (3 - 2 * share))
