"""Where props are in every frame of a motion: they follow the hands of whoever moved the body.

A prop is there while the hands are where its caption has them: lifted, and near to where they are for most of the
keyframe. It grows in the hand as that comes, and is gone before the hand is down. What is named, and taken, put down or
carried besides, is of carried_things.py; what hands open and switch is of fixture_tracks.py. The same motion and role
give the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from motion_backend.body.cast import Role
from motion_backend.motion import Motion
from motion_backend.props.carried_things import carried_things
from motion_backend.props.fixture_tracks import fixture_tracks
from motion_backend.props.prop_frames import Flags, Moment, PropTrack, growth, runs_of, spans_of
from motion_backend.props.prop_hands import Hands
from motion_backend.props.prop_table import Held, shown_as
from motion_backend.rotations import Array

Key = tuple[Held, str]
"""What a caption holds, and the thing in it that is carried besides, or ""."""
LIFTED: Final = -0.63
"""A wrist is lifted where it is higher than this over the shoulder, along the chest (arm lengths); hanging is -0.95."""
NEAR: Final = 0.30
"""As far as hands may be from where they hold it (arm lengths)."""
SETTLED: Final = 0.3
"""The share of the lifted frames after which hands are where they hold it."""
COMPARED: Final = 24
"""Frames among these that others are compared with."""
BEFORE, AFTER = 0.8, 1.2
"""Seconds around its keyframe in which it may already be there, and still."""
GAP: Final = 0.4
"""Seconds that it is not gone for."""


def prop_tracks(motion: Motion, role: Role) -> tuple[PropTrack, ...]:
    """All props of a motion, in the order in which they come; frames count from its first."""
    moments = [one for span in spans_of(motion) if (one := Moment.of(motion, role, *span)) is not None]
    if not len(motion) or not (moments or role.worked):
        return ()
    hands = Hands.of(motion)
    found = [*_in_hand(hands, moments), *fixture_tracks(hands, motion, role)]
    return tuple(sorted(found, key=lambda track: track.start))


def _in_hand(hands: Hands, moments: Sequence[Moment]) -> list[PropTrack]:
    """What is in the hands, or was put down by them."""
    carried = _carried(moments)
    rows = [(one, (one.held, _carries(one, carried))) for one in moments if one.held is not None]
    there = dict(_presences(hands, rows))
    found = [one for (held, thing), when in there.items() for one in _tracks(hands, held, when, carried.get(thing, ""))]
    for thing, shape in carried.items():
        mine = [(held, when) for (held, one), when in there.items() if one == thing]
        own = [(grip, when) for held, when in mine for grip in held.props if grip.prop == shape]
        others = [(held.hands, when) for (held, one), when in there.items() if one != thing]
        found += carried_things(hands, [one for one in moments if one.thing == thing], own, others)
    return found


def _carried(moments: Sequence[Moment]) -> dict[str, str]:
    """Things that are in the hands otherwise than captions have them, and the shape of each."""
    things = sorted({one.thing for one in moments if one.is_carried})
    shapes = [(thing, shown_as(thing, *(one.held for one in moments if one.thing == thing))) for thing in things]
    return {thing: shape.shape for thing, shape in shapes if shape is not None}


def _carries(moment: Moment, carried: Mapping[str, str]) -> str:
    """The thing that its caption holds, where it is carried besides; else ""."""
    grip = moment.grip
    return moment.thing if grip is not None and grip.prop == carried.get(moment.thing) else ""


def _presences(hands: Hands, moments: Sequence[tuple[Moment, Key]]) -> Iterator[tuple[Key, Flags]]:
    """What is held and in which of all frames, once for all keyframes that hold the same; later ones take it over."""
    frames = len(hands.wrists)
    there = {key: np.zeros(frames, dtype=bool) for _, key in moments}
    for moment, key in moments:
        now = _presence(hands, key[0], moment.start, moment.stop)
        for other in there:
            if other != key and set(other[0].hands) & set(key[0].hands):
                there[other] &= ~now
        there[key] |= now
    for key, found in there.items():
        yield key, _without_gaps(found, round(GAP * hands.fps))


def _presence(hands: Hands, held: Held, start: int, stop: int) -> Flags:
    """In which frames the hands are where they are in most of a keyframe. (T,)."""
    chosen = hands.wrists[:, held.hands]  # (T, H, 3)
    lifted = chosen[..., 1].max(axis=1) > LIFTED
    first, last = max(start - round(BEFORE * hands.fps), 0), min(stop + round(AFTER * hands.fps), len(lifted))
    there = np.zeros(len(lifted), dtype=bool)
    run = max(runs_of(lifted[start:stop]), key=lambda one: one[1] - one[0], default=None)
    if run is None:
        return there
    settled = np.arange(start + run[0] + round(SETTLED * (run[1] - run[0])), start + run[1])
    some = settled[np.unique(np.linspace(0, len(settled) - 1, COMPARED).round().astype(int))]
    away = np.linalg.norm(chosen[first:last, None] - chosen[None, some], axis=-1).max(axis=2).min(axis=1)
    near = lifted[first:last] & (away < NEAR)
    middle = (settled[0] + settled[-1]) // 2 - first
    # What is lifted elsewhere in these frames is another gesture.
    begin, end = next((one for one in runs_of(near) if one[0] <= middle < one[1]), (0, 0))
    there[first + begin : first + end] = True
    return there


def _without_gaps(flags: Flags, longest: int) -> Flags:
    """The same with True where it is False for no longer than that between two runs."""
    filled, runs = flags.copy(), runs_of(flags)
    for (_, stop), (start, _) in pairwise(runs):
        if start - stop <= longest:
            filled[stop:start] = True
    return filled


def _tracks(hands: Hands, held: Held, there: Flags, but: str) -> Iterator[PropTrack]:
    """Every prop of a row, whenever it is there, `but` for one."""
    for start, stop in runs_of(there):
        share = growth(start, stop, len(there), hands.fps)
        for grip in held.props:
            if grip.prop == but:
                continue
            positions, turns, size = hands.placed(grip, start, stop)
            palm = hands.palms[start:stop, 0 if grip.hand == "left" else 1]
            yield PropTrack(grip.prop, start, palm + share[:, None] * (positions - palm), turns, size * share)


def prop_points(tracks: Sequence[PropTrack], frame: int) -> Array:
    """The vertices of all that is in the hands at a frame, in the world. (N, 3)."""
    points: list[Array] = [np.zeros((0, 3))]
    for track in tracks:
        if track.is_held(frame):
            now = frame - track.start
            shape = track.shape
            points.append(
                shape.moved(track.positions[now], track.turns[now], float(track.sizes[now]))[0].astype(np.float64)
            )
    return np.concatenate(points)
