"""What is named and held for more than one caption: it lies where a hand takes it from, goes with that hand, is held as
captions hold it, and stays lying where it is put down.

Keyframes that follow one another and name the same thing are one stretch. A reach begins it by taking the thing, or
ends it by putting it down, unless its caption says which; a reach that is a stretch of its own leaves it where it lies.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.motion import Skill
from motion_backend.props.prop_frames import Flags, Moment, PropTrack, growth, runs_of
from motion_backend.props.prop_hands import UP, Hands
from motion_backend.props.prop_shapes import prop_shape
from motion_backend.props.prop_table import Called, Grip, prop_table, shown_as
from motion_backend.rotations import Array

NOWHERE: Final = -1
AT: Final = 0.03
"""A hand is at a thing while it is no farther from it than this from its nearest (metres)."""
BEFORE_HAND: Final = 0.10
"""How far before where a wrist is laid a thing lies (metres)."""
OVER_RIM: Final = 0.045
"""How far a large thing may lie over the rim of what it lies on (metres)."""
CHANGES: Final = 0.15
"""Half the seconds in which a thing goes from a table into a hand, or is held otherwise."""
CLEAR: Final = 0.3
"""Seconds before a hand is down, and after, in which what hangs from it would be in the table."""
NEAR: Final = 0.6
"""From farther away nothing comes into the hand (metres)."""


@dataclass(frozen=True)
class Lying:
    """Where a thing lies: position (3,) and turn (4,)."""

    position: Array
    turn: Array


Rows = Sequence[tuple[Grip, Flags]]
"""How captions hold a thing, and in which of all frames."""


def carried_things(
    hands: Hands, moments: Sequence[Moment], rows: Rows, others: Sequence[tuple[tuple[int, ...], Flags]]
) -> Iterator[PropTrack]:
    """The tracks of one thing that all these moments name; `others` are hands that hold something else, and when."""
    shape = shown_as(moments[0].thing, *(one.held for one in moments))
    if shape is None:
        return
    places = _Places(hands, shape, rows)
    labels = places.follow(moments)
    for number, holder in enumerate(places.holders):
        if isinstance(holder, Lying):
            continue
        for busy, frames in others:
            labels[(labels == number) & frames & bool({*_hands_of(holder)} & {*busy})] = NOWHERE
    for start, stop in runs_of(labels != NOWHERE):
        track = passed_on(hands, shape.shape, places.holders, labels, (start, stop))
        yield replace(track, taken=tuple(sorted(frame for frame in places.taken if start <= frame < stop)))


@dataclass
class _Places:
    """Where a thing is, as its moments follow one another: in which grip, or where it lies."""

    hands: Hands
    shape: Called
    rows: Rows
    holders: list[Grip | Lying] = field(default_factory=list)
    _turns: list[tuple[int, int]] = field(default_factory=list)
    """Frames from which on another holder has it."""
    taken: set[int] = field(default_factory=set)
    """Those in which it is taken, or lifted as a caption has it."""

    def follow(self, moments: Sequence[Moment]) -> NDArray[np.int64]:
        """The holder of all frames, by its place in `holders`; NOWHERE where the thing is not seen. (T,)."""
        frames = len(self.hands.wrists)
        last = 0
        for number, moment in enumerate(moments):
            if self._is_held() and moment.start > last:
                self._turn(last, NOWHERE)
            goes_on = number + 1 < len(moments) and moments[number + 1].start == moment.stop
            row = self._row_of(moment)
            last = moment.stop
            if row is not None and moment.grip is not None and moment.grip.prop == self.shape.shape:
                last = max(last, row[1]) if not goes_on else last
                self.taken.add(row[0])
                if not self._is_held():
                    self._leave_far(moment.grip.hand, row[0])
                    self._turn(row[0], self._in_hand(moment.grip.hand))
            elif moment.skill is Skill.TOUCH:
                self._reach(moment, goes_on)
            elif not self._is_held() and moment.held is None:  # a shut book is not there for an open one
                self._turn(moment.start, self._in_hand("right"))
        if self._is_held():
            self._turn(min(last, frames), NOWHERE)
        labels = np.full(frames, NOWHERE)
        for frame, holder in self._turns:
            labels[frame:] = holder
        for grip, there in self.rows:
            labels[there & (labels != NOWHERE)] = self._number(grip)
        return labels

    def _reach(self, moment: Moment, goes_on: bool) -> None:
        """A hand at the thing, which takes it, puts it down or leaves it there."""
        named = moment.named
        if named is None:
            return
        first, last = self._contact(moment)
        begins, ends = self._changes(first, last)
        held = self._is_held()
        puts = "put down" in moment.caption or (held and not goes_on)
        takes = not (puts or held) and ("pick up" in moment.caption or goes_on)
        there = self._number(self._lying(moment)) if named.on_top and named.at is not None else NOWHERE
        if takes:
            if self._holder() is None:
                self._turn(self._since(), there)
            self.taken.add(ends)
            self._leave_far(named.hand, ends)
            self._turn(ends, self._in_hand(named.hand))
        elif puts:
            if not held:
                self._turn(moment.start, self._in_hand(named.hand))
            self._turn(max(begins, moment.start), there)
        elif self._holder() is None and there != NOWHERE:
            self._turn(self._since(), there)
        elif self._holder() is None:
            self._turn(first, self._in_hand(named.hand))
            self._turn(last, self._in_hand(named.hand) if goes_on else NOWHERE)

    def _changes(self, first: int, last: int) -> tuple[int, int]:
        """From when on a thing is put down by a hand that is there from one frame to another, and taken: what hangs
        from the hand before that is down, and once that is up again."""
        middle, clear = (first + last) // 2, round(CLEAR * self.hands.fps)
        hangs = self.shape.way == "hanging"
        return (first - clear, last + clear) if hangs else (middle, middle)

    def _contact(self, moment: Moment) -> tuple[int, int]:
        """First and last frame in which a hand is at what it reaches for; without a place, as far out as it gets."""
        named = moment.named
        side = 0 if named is not None and named.hand == "left" else 1
        cut = slice(moment.start, moment.stop)
        if named is not None and named.at is not None:
            away = np.linalg.norm(self.hands.palms[cut, side] - np.array(named.at), axis=1)
        else:
            away = -np.linalg.norm(self.hands.wrists[cut, side] - [0.0, -1.0, 0.0], axis=1)
        there = np.flatnonzero(away <= away.min() + AT)
        return moment.start + int(there[0]), moment.start + int(there[-1])

    def _row_of(self, moment: Moment) -> tuple[int, int] | None:
        """The frames in which its caption holds the thing."""
        found = [run for _, frames in self.rows for run in runs_of(frames) if run[0] < moment.stop]
        return next((run for run in found if run[1] > moment.start), None)

    def _turn(self, frame: int, holder: int) -> None:
        self._turns.append((max(frame, self._since()), holder))

    def _since(self) -> int:
        return self._turns[-1][0] if self._turns else 0

    def _holder(self) -> Grip | Lying | None:
        number = self._turns[-1][1] if self._turns else NOWHERE
        return None if number == NOWHERE else self.holders[number]

    def _is_held(self) -> bool:
        return isinstance(self._holder(), Grip)

    def _leave_far(self, hand: str, frame: int) -> None:
        """What lies where the hand that has it next is not is seen no more: it is another one."""
        holder = self._holder()
        palm = self.hands.palms[min(frame, len(self.hands.palms) - 1), 0 if hand == "left" else 1]
        if isinstance(holder, Lying) and float(np.linalg.norm(holder.position - palm)) > NEAR:
            self._turn(frame - 1, NOWHERE)

    def _in_hand(self, hand: str) -> int:
        return self._number(in_hand(self.shape, hand))

    def _number(self, holder: Grip | Lying) -> int:
        known = [number for number, one in enumerate(self.holders) if isinstance(holder, Grip) and one == holder]
        if not known:
            self.holders.append(holder)
        return known[0] if known else len(self.holders) - 1

    def _lying(self, moment: Moment) -> Lying:
        """Where the hand of a moment lays it."""
        named = moment.named
        at, yaw = (named.at, named.facing) if named is not None else (None, 0.0)
        return laid(self.shape, at or (0.0, 0.0, 0.0), yaw)


def laid(shape: Called, at: tuple[float, float, float], yaw: float) -> Lying:
    """Before a hand at a point, on what it is laid on: books and coats on their broadest sides, cups on their feet,
    turned to who laid them."""
    corners = prop_shape(shape.shape).vertices.astype(np.float64)
    ahead = np.array([np.sin(yaw), 0.0, np.cos(yaw)])
    flat = shape.flat or prop_table().ways[shape.way].flat
    thin = np.ptp(corners[:, 2]) <= np.ptp(corners[:, 0])  # a coat is thin from side to side of how it hangs
    y, z = (ahead, UP if thin else np.cross(UP, ahead)) if flat else (UP, -ahead)
    turn = rotations.basis_to_quat(np.cross(y, z)[None], y[None], z[None])[0]
    turned = rotations.rotate(turn, corners)
    depth = float((turned @ ahead).min())
    inward = max(BEFORE_HAND, -depth - OVER_RIM)
    return Lying(np.array(at) + inward * ahead - [0.0, float(turned[:, 1].min()), 0.0], turn)


def in_hand(shape: Called, hand: str) -> Grip:
    """How a thing is in one hand where no caption says how, hanging or lifted."""
    way = prop_table().ways[shape.way]
    offset = np.array(way.offset_m if shape.offset_m is None else shape.offset_m)
    if way.beside:
        offset = offset - [0.0, 0.0, float(prop_shape(shape.shape).vertices[:, 2].min())]
    x, y, z = offset.tolist()
    return Grip(shape.shape, "left" if hand == "left" else "right", way.along, way.front, "along", (x, y, z))


def _hands_of(grip: Grip) -> tuple[int, ...]:
    return (0, 1) if grip.hand == "both" else (0,) if grip.hand == "left" else (1,)


def passed_on(
    hands: Hands,
    prop: str,
    holders: Sequence[Grip | Lying],
    labels: NDArray[np.int64],
    span: tuple[int, int],
    seconds: float = CHANGES,
) -> PropTrack:
    """A thing from one frame to another, passed softly from each holder to the next, in twice these seconds."""
    start, stop = span
    own, half = labels[start:stop], max(round(seconds * hands.fps), 1)
    begins = [0, *(np.flatnonzero(np.diff(own)) + 1).tolist()]
    positions, turns, sizes = _held_by(hands, holders[own[0]], start, stop)
    for begin in begins[1:]:
        first = max(begin - half, 0)
        later = _held_by(hands, holders[own[begin]], start + first, stop)
        last = min(first + 2 * half, stop - start)
        share = np.arange(1, last - first + 1) / (2 * half)
        share = share * share * (3 - 2 * share)
        soft = slice(first, last)
        mixed = (
            positions[soft] + share[:, None] * (later[0][: last - first] - positions[soft]),
            rotations.slerp(turns[soft], later[1][: last - first], share),
            sizes[soft] + share * (later[2][: last - first] - sizes[soft]),
        )
        positions, turns, sizes = (
            np.concatenate([before[:first], between, after[last - first :]])
            for before, between, after in zip((positions, turns, sizes), mixed, later, strict=True)
        )
    lying = np.array([isinstance(holders[label], Lying) for label in own])
    sizes = sizes * growth(start, stop, len(labels), hands.fps)
    return PropTrack(prop, start, positions, rotations.continuous(rotations.normalize(turns)), sizes, lying)


def _held_by(hands: Hands, holder: Grip | Lying, start: int, stop: int) -> tuple[Array, Array, Array]:
    """Positions (N, 3), turns (N, 4) and sizes (N,) in a grip or where it lies."""
    if isinstance(holder, Lying):
        return (
            np.tile(holder.position, (stop - start, 1)),
            np.tile(holder.turn, (stop - start, 1)),
            np.ones(stop - start),
        )
    positions, turns, size = hands.placed(holder, start, stop)
    return positions, turns, np.full(stop - start, size)
