"""Where props are in every frame of a motion: they follow the hands of whoever moved the body.

A prop is held as its caption has it while the hands are where that has them: lifted, and near to where they are for
most of the keyframe. What one hand holds is in it for all of that keyframe, hanging before and after, so that it comes
and goes where films are cut; what both hold grows between them. What lies there for the hands lies there from before
they come until after they are gone. What is named, and taken, put down or carried besides, is of carried_things.py;
what hands open and switch is of fixture_tracks.py. The same motion and role give the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.body.cast import Role
from motion_backend.motion import Motion, Skill
from motion_backend.props.carried_things import NOWHERE, carried_things, in_hand, passed_on
from motion_backend.props.fixture_tracks import fixture_tracks
from motion_backend.props.prop_frames import Flags, Moment, PropTrack, growth, runs_of, spans_of
from motion_backend.props.prop_hands import Hands
from motion_backend.props.prop_table import Grip, Held, prop_table, shown_as
from motion_backend.props.resting_things import resting_things
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
AT_HAND: Final = 0
LIFTS: Final = 0.3
"""Half the seconds in which what hangs in a hand is turned as its caption has it."""
BEFORE, AFTER = 0.8, 2.0
"""Seconds around its keyframe in which it may already be there, and still."""
GAP: Final = 0.4
"""Seconds that it is not gone for."""


def prop_tracks(motion: Motion, role: Role) -> tuple[PropTrack, ...]:
    """All props of a motion, in the order in which they come; frames count from its first."""
    moments = [one for span in spans_of(motion) if (one := Moment.of(motion, role, *span)) is not None]
    if not len(motion) or not (moments or role.worked):
        return ()
    hands = Hands.of(motion)
    held = _in_hand(hands, moments, _stays(motion, role))
    found = [*held, *resting_things(motion, role, held), *fixture_tracks(hands, motion, role)]
    return tuple(sorted(found, key=lambda track: track.start))


def _stays(motion: Motion, role: Role) -> NDArray[np.int64]:
    """A number for every stretch of frames in which somebody stays where they are: of keyframes in which they sit all
    in a row, else of one; AT_HAND where hands are at a piece of furniture. (T,)."""
    found, number, before = np.zeros(len(motion), dtype=np.int64), AT_HAND, None
    for start, stop in spans_of(motion):
        skill, _ = role.captions.get(int(motion.actions[start]), (None, ""))
        number += not (skill is before is Skill.SITDOWN)
        found[start:stop], before = AT_HAND if skill is Skill.TOUCH else number, skill
    return found


def _in_hand(hands: Hands, moments: Sequence[Moment], stays: NDArray[np.int64]) -> list[PropTrack]:
    """What is in the hands, or was put down by them, by somebody who `stays` where the numbers (T,) are the same."""
    carried = _carried(moments)
    rows = [(one, (one.held, _carries(one, carried))) for one in moments if one.held is not None]
    there = dict(_presences(hands, rows))
    found: list[PropTrack] = []
    for (held, thing), when in there.items():
        spans = [
            (one.start, one.stop) for one, key in rows if key == (held, thing) and when[one.start : one.stop].any()
        ]
        busy = [flags for (other, _), flags in there.items() if other != held and {*other.hands} & {*held.hands}]
        for grip in held.props:
            if grip.prop == carried.get(thing, ""):
                continue
            if grip.still:
                found += _lying(hands, grip, when, stays)
            elif grip.hand == "both" and not grip.stands:
                found += _between(hands, grip, when)
            else:
                kept = _spanned(spans, len(when)) & ~np.any([np.zeros_like(when), *busy], axis=0)
                found += _one_handed(hands, grip, when, kept)
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
    # In the keyframe itself a hand goes up and down with what it holds: who lifts weights, who drinks twice.
    own = max(start, first) + np.flatnonzero(near[max(start - first, 0) : stop - first])
    if end > begin and all(grip.hand != "both" for grip in held.props):
        there[own[0] : own[-1] + 1] = True
    return there


def _without_gaps(flags: Flags, longest: int) -> Flags:
    """The same with True where it is False for no longer than that between two runs."""
    filled, runs = flags.copy(), runs_of(flags)
    for (_, stop), (start, _) in pairwise(runs):
        if start - stop <= longest:
            filled[stop:start] = True
    return filled


def _spanned(spans: Sequence[tuple[int, int]], frames: int) -> Flags:
    """Which of all frames are in any of some spans. (T,)."""
    found = np.zeros(frames, dtype=bool)
    for start, stop in spans:
        found[start:stop] = True
    return found


def _one_handed(hands: Hands, grip: Grip, there: Flags, kept: Flags) -> Iterator[PropTrack]:
    """What one hand holds, or what stands on the floor, in the frames in which it is `kept`: as its caption has it
    where it is `there`, else hanging."""
    shape = next((row for row in prop_table().called if row.shape == grip.prop), None)
    hanging = grip if shape is None else in_hand(shape, grip.hand)
    if grip.stands:  # it stands beside who does not use it
        hanging = replace(grip, hand="right", along="up", front="ahead")
    # It is turned once the hand is nearly where it holds it: on the way up the two ways are too far apart.
    late = round(LIFTS * hands.fps)
    turned = np.array([there[max(at - late, 0) : at + late + 1].all() for at in range(len(there))])
    labels = np.where(kept, np.where(turned, 1, 0), NOWHERE)
    lifts = [start for start, _ in runs_of(there & kept)]
    for start, stop in runs_of(labels != NOWHERE):
        track = passed_on(hands, grip.prop, (hanging, grip), labels, (start, stop), LIFTS)
        yield replace(track, lying=None, taken=tuple(frame for frame in lifts if start <= frame < stop))


def _between(hands: Hands, grip: Grip, there: Flags) -> Iterator[PropTrack]:
    """What both hands hold, whenever it is there."""
    for start, stop in runs_of(there):
        share = growth(start, stop, len(there), hands.fps)
        positions, turns, size = hands.placed(grip, start, stop)
        palm = hands.palms[start:stop, 1]
        yield PropTrack(grip.prop, start, palm + share[:, None] * (positions - palm), turns, size * share)


def _lying(hands: Hands, grip: Grip, there: Flags, stays: NDArray[np.int64]) -> Iterator[PropTrack]:
    """What lies where hands use it: once for as long as somebody stays there, and on furniture all the time."""
    runs = runs_of(there)
    for stay in np.unique(stays[there]).tolist():
        mine = [run for run in runs if (stays[slice(*run)] == stay).any()]
        first, last = max(mine, key=lambda run: run[1] - run[0])
        positions, turns, size = hands.placed(grip, first, last)
        frames = np.arange(len(there)) if stay == AT_HAND else np.flatnonzero(stays == stay)
        start, long = int(frames[0]), len(frames)
        lies, sizes = np.ones(long, dtype=bool), np.full(long, size)
        places, turned = np.tile(positions[0], (long, 1)), np.tile(turns[0], (long, 1))
        yield PropTrack(grip.prop, start, places, turned, sizes, lies, tuple(max(run[0], start) for run in mine))


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
