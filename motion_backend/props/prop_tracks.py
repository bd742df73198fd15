"""Where props are in every frame of a motion: they follow the hands of whoever moved the body.

A prop is there while the hands are where its caption has them: lifted, and near to where they are for most of the
keyframe. It grows in the hand as that comes, and is gone before the hand is down. The same motion and role give the
same.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.body.cast import Role
from motion_backend.motion import Motion
from motion_backend.props.prop_hands import Hands
from motion_backend.props.prop_shapes import prop_shape
from motion_backend.props.prop_table import Held, held_in
from motion_backend.rotations import Array

LIFTED: Final = -0.63
"""A wrist is lifted where it is higher than this over the shoulder, along the chest (arm lengths); hanging is -0.95."""
NEAR: Final = 0.30
"""As far as hands may be from where they hold it (arm lengths)."""
SETTLED: Final = 0.3
"""The share of the lifted frames after which hands are where they hold it."""
COMPARED: Final = 24
"""Frames among these that others are compared with."""
GROWS: Final = 0.2
"""Seconds in which a prop comes, and in which it goes."""
BEFORE, AFTER = 0.8, 1.2
"""Seconds around its keyframe in which it may already be there, and still."""
GAP: Final = 0.4
"""Seconds that it is not gone for."""


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

    @property
    def stop(self) -> int:
        """Behind its last frame."""
        return self.start + len(self.positions)


def prop_tracks(motion: Motion, role: Role) -> tuple[PropTrack, ...]:
    """All props of a motion, in the order in which they come; frames count from its first."""
    spans = [(*span, held) for span in _spans(motion) if (held := _held(motion, role, span[0])) is not None]
    if not spans:
        return ()
    hands = Hands.of(motion)
    found = [track for held, there in _presences(hands, spans) for track in _tracks(hands, held, there)]
    return tuple(sorted(found, key=lambda track: track.start))


def _held(motion: Motion, role: Role, frame: int) -> Held | None:
    said = role.captions.get(int(motion.actions[frame]))
    return None if said is None else held_in(*said)


def _spans(motion: Motion) -> Iterator[tuple[int, int]]:
    """First frame and stop frame of every keyframe."""
    starts = np.flatnonzero(np.diff(motion.actions, prepend=motion.actions[:1] - 1)).tolist()
    return zip(starts, [*starts[1:], len(motion)], strict=True)


def _presences(hands: Hands, spans: Sequence[tuple[int, int, Held]]) -> Iterator[tuple[Held, NDArray[np.bool_]]]:
    """What is held and in which of all frames, once for all keyframes that hold the same; later ones take it over."""
    frames = len(hands.wrists)
    there = {held.words: np.zeros(frames, dtype=bool) for *_, held in spans}
    for start, stop, held in spans:
        now = _presence(hands, held, start, stop)
        for *_, other in spans:
            if other is not held and set(other.hands) & set(held.hands):
                there[other.words] &= ~now
        there[held.words] |= now
    rows = {held.words: held for *_, held in spans}
    for words, held in rows.items():
        yield held, _without_gaps(there[words], round(GAP * hands.fps))


def _presence(hands: Hands, held: Held, start: int, stop: int) -> NDArray[np.bool_]:
    """In which frames the hands are where they are in most of a keyframe. (T,)."""
    chosen = hands.wrists[:, held.hands]  # (T, H, 3)
    lifted = chosen[..., 1].max(axis=1) > LIFTED
    first, last = max(start - round(BEFORE * hands.fps), 0), min(stop + round(AFTER * hands.fps), len(lifted))
    there = np.zeros(len(lifted), dtype=bool)
    run = max(_runs(lifted[start:stop]), key=lambda one: one[1] - one[0], default=None)
    if run is None:
        return there
    settled = np.arange(start + run[0] + round(SETTLED * (run[1] - run[0])), start + run[1])
    some = settled[np.unique(np.linspace(0, len(settled) - 1, COMPARED).round().astype(int))]
    away = np.linalg.norm(chosen[first:last, None] - chosen[None, some], axis=-1).max(axis=2).min(axis=1)
    near = lifted[first:last] & (away < NEAR)
    middle = (settled[0] + settled[-1]) // 2 - first
    # What is lifted elsewhere in these frames is another gesture.
    begin, end = next((one for one in _runs(near) if one[0] <= middle < one[1]), (0, 0))
    there[first + begin : first + end] = True
    return there


def _runs(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and stop index of every run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def _without_gaps(flags: NDArray[np.bool_], longest: int) -> NDArray[np.bool_]:
    """The same with True where it is False for no longer than that between two runs."""
    filled, runs = flags.copy(), _runs(flags)
    for (_, stop), (start, _) in pairwise(runs):
        if start - stop <= longest:
            filled[stop:start] = True
    return filled


def _tracks(hands: Hands, held: Held, there: NDArray[np.bool_]) -> Iterator[PropTrack]:
    """Every prop of a row, whenever it is there."""
    frames, ramp = len(there), GROWS * hands.fps
    for start, stop in _runs(there):
        since = np.arange(1, stop - start + 1) / ramp if start else np.ones(stop - start)
        left = np.arange(stop - start, 0, -1) / ramp if stop < frames else np.ones(stop - start)
        share = np.clip(np.minimum(since, left), 0.0, 1.0)
        share = share * share * (3 - 2 * share)
        for grip in held.props:
            positions, turns, size = hands.placed(grip, start, stop)
            palm = hands.palms[start:stop, 0 if grip.hand == "left" else 1]
            yield PropTrack(grip.prop, start, palm + share[:, None] * (positions - palm), turns, size * share)


def prop_points(tracks: Sequence[PropTrack], frame: int) -> Array:
    """The vertices of all that is in the hands at a frame, in the world. (N, 3)."""
    points: list[NDArray[np.floating]] = [np.zeros((0, 3))]
    for track in tracks:
        if track.start <= frame < track.stop:
            now = frame - track.start
            shape = prop_shape(track.prop)
            points.append(shape.moved(track.positions[now], track.turns[now], float(track.sizes[now]))[0])
    return np.concatenate(points).astype(np.float64)
