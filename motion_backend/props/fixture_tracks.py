"""Where doors, drawers and lights of furniture are that hands open, shut and switch.

A hand opens the front that it is laid on, from when it is there on; a front that is shut is shut as the hand gets
there, and stood open before. What is switched on shines until it is switched off. A door waits while the body stands in
its way. It is only seen: contacts, ways and figures know nothing of it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.body.cast import Role, Worked
from motion_backend.motion import FPS, Motion, Skill
from motion_backend.props.handle_tracks import followed
from motion_backend.props.prop_frames import PropTrack, runs_of, spans_of
from motion_backend.props.prop_hands import Hands
from motion_backend.props.prop_shapes import painted_shape
from motion_backend.rotations import Array
from scene_graphs.layout import Placed
from scene_graphs.meshes.moving_parts import Kind, Mechanism, Moving, mechanisms

MOVES, SLAMS, SWITCHES = 0.7, 0.3, 0.15
"""Seconds in which a front opens or shuts, in which it is slammed, and after which a switch has been pressed."""
AT: Final = 0.03
"""A hand is at a thing while it is no farther from it than this from its nearest (metres)."""
NEAR: Final = 0.45
"""From farther away nothing is opened (metres)."""
RECOILS: Final = (0.05, 0.27)
"""The share of its way that a slammed front springs back, and the seconds until it is shut again."""
IN_THE_WAY: Final = 0.12
"""A door keeps this far from the middle of hips and head (metres)."""
OVERHEAD: Final = 1.3
"""What reaches no higher opens under a head (metres)."""
SETS_OFF: Final = 0.15
"""Who has let go of a door goes on through it once they are this far from where they did (metres)."""
PASSED: Final = 0.35
"""Who has passed a door is this far from all of its way (metres)."""
STEPS: Final = 21
"""Places of a door that are looked at for that."""
AGAIN: Final = 3.0
"""Seconds for which one who reaches in leaves it open, to reach in again."""
SHUT: Final = 1e-3
"""A share that is as good as none."""
_SLAM: Final = re.compile(r"^slamming\b")


@dataclass(frozen=True)
class _Deed:
    """Something done to a piece: from the first frame in which a hand is at it to the last."""

    worked: Worked
    first: int
    last: int
    slams: bool
    passes: bool = False
    """Whether its door is passed."""
    along: tuple[int, Array] | None = None
    """From which frame on a hand takes it along, and how far open it then is."""


def fixture_tracks(hands: Hands, motion: Motion, role: Role) -> Iterator[PropTrack]:
    """The tracks of all that hands open, shut and switch; frames count from the motion's first."""
    deeds: dict[tuple[str, Kind], list[_Deed]] = {}
    for start, stop in spans_of(motion):
        worked = role.worked.get(int(motion.actions[start]))
        deed = worked and _deed(hands, motion, role, worked, (start, stop))
        if deed:
            deeds.setdefault((deed.worked.piece.id, kind_of(deed.worked.does)), []).append(deed)
    for (_, kind), done in deeds.items():
        yield from _lights(motion, done) if kind == "light" else _fronts(hands, motion, done)


def kind_of(does: str) -> Kind:
    """What of a piece is meant by what is done to it."""
    return "light" if does in ("on", "off") else "front"


def replaced(role: Role) -> frozenset[str]:
    """The names of meshes of a home that are not drawn at rest, since they move in a story: leaves of its doors."""
    doors = [one.piece for one in role.worked.values() if any(front.always for front in mechanisms(one.piece))]
    names = [door.id.partition("/")[2].removesuffix(" door") for door in doors]
    return frozenset(f"door {part} {name}" for name in names for part in ("leaf", "handle"))


def works(piece: Placed, does: str) -> bool:
    """Whether there is anything of a piece that it can be done to."""
    return any(one.kind == kind_of(does) for one in mechanisms(piece))


def _deed(hands: Hands, motion: Motion, role: Role, worked: Worked, span: tuple[int, int]) -> _Deed | None:
    """When a hand is where it reaches in a keyframe; None where it never gets there."""
    side = 0 if worked.hand == "left" else 1
    away = np.linalg.norm(hands.palms[slice(*span), side] - np.array(worked.at), axis=1)
    skill, caption = role.captions.get(int(motion.actions[span[0]]), (None, ""))
    passes = skill is Skill.LOCO
    if away.min() > NEAR and not passes:
        return None
    there = span[0] + np.flatnonzero(away <= away.min() + AT)
    slams = _SLAM.search(caption) is not None
    along = None if passes and worked.does == "close" else followed(hands, worked, span)
    return _Deed(worked, int(there[0]), int(there[-1]), slams, passes, along)


def _lights(motion: Motion, done: Sequence[_Deed]) -> Iterator[PropTrack]:
    """What shines of a piece, while it is on."""
    lit = np.full(len(motion), done[0].worked.does == "off")
    for deed in done:
        lit[deed.first + round(SWITCHES * motion.fps) :] = deed.worked.does == "on"
    piece = done[0].worked.piece
    for number, one in enumerate(_all(piece, "light")):
        for moving in one.moving:
            yield from _tracks(piece, f"light{number}", moving, lit.astype(np.float64))


def _fronts(hands: Hands, motion: Motion, done: Sequence[_Deed]) -> Iterator[PropTrack]:
    """The doors or drawers of a piece that are open, and what is seen behind them."""
    piece = done[0].worked.piece
    found = _all(piece, "front")
    chosen: int | None = None
    by_front: dict[int, list[_Deed]] = {}
    for deed in done:
        if deed.worked.handle is not None:
            chosen = deed.worked.handle.front
        elif chosen is None or by_front[chosen][-1].worked.does == "close":
            chosen = _front(found, hands, motion, deed)
        by_front.setdefault(chosen, []).append(deed)
    for number, deeds in sorted(by_front.items()):
        shares = _shares(found[number], hands, motion, deeds)
        shares = 1.0 - shares if found[number].drawn else shares
        for place, moving in enumerate(found[number].moving):
            yield from _tracks(piece, f"front{number}_{place}", moving, shares, found[number].always)


def _all(piece: Placed, kind: Kind) -> list[Mechanism]:
    return [one for one in mechanisms(piece) if one.kind == kind]


def _front(found: Sequence[Mechanism], hands: Hands, motion: Motion, deed: _Deed) -> int:
    """The one that a hand is at; of those as near to it the one that the body is least in the way of."""
    hand = deed.worked.piece.to_local(np.array(deed.worked.at))

    def rank(number: int) -> tuple[float, float]:
        one = found[number]
        gap = np.maximum(np.maximum(np.array(one.low) - hand, hand - np.array(one.high)), 0.0)
        body = _bodies(hands, motion, deed.worked.piece, deed.first, deed.first + 1)
        return round(float(np.hypot(gap[0], gap[1])), 1), -float(_clearance(one, body).min())

    return min(range(len(found)), key=rank)


def _bodies(hands: Hands, motion: Motion, piece: Placed, start: int, stop: int) -> Array:
    """Where hips and head are, [x, z] in the frame of a piece. (N, 2, 2)."""
    both = np.stack([motion.root_positions[start:stop].astype(np.float64), hands.head_at[start:stop]], axis=1)
    return piece.to_local(both)[..., [0, 2]]


def _clearance(front: Mechanism, bodies: Array) -> Array:
    """How far bodies (N, 2, 2) are from what swings or slides, at each of its places. (N, STEPS)."""
    leaf = front.moving[-1]
    share = np.linspace(0.0, 1.0, STEPS)
    turn = leaf.turn * share
    along = np.stack([np.cos(turn), -np.sin(turn)], axis=1)  # of x, turned about +Y
    origin = np.array(leaf.pivot)[[0, 2]] + share[:, None] * np.array(leaf.way)[[0, 2]]
    bodies = bodies[:, : 1 + (front.high[1] > OVERHEAD)]
    start, end = origin + front.leaf[0] * along, origin + front.leaf[1] * along
    way = end - start
    away = bodies[:, :, None] - start  # (N, 1 or 2, STEPS, 2)
    part = np.sum(away * way, axis=-1) / np.maximum(np.sum(way * way, axis=1), 1e-9)
    return np.asarray(np.linalg.norm(away - np.clip(part, 0.0, 1.0)[..., None] * way, axis=-1).min(axis=1))


@dataclass(frozen=True)
class _Swing:
    """A front that opens, from when on, or shuts, until when."""

    opens: bool
    since: int
    until: int
    slams: bool = False


def _swings(deeds: Sequence[_Deed], fps: int) -> Iterator[_Swing]:
    """What a front does, one after the other."""
    is_open = deeds[0].worked.does == "close"
    for deed, following in zip(deeds, [*deeds[1:], None], strict=True):
        if deed.worked.does == "close":
            long = round((SLAMS if deed.slams else MOVES) * fps)
            since = max(deed.first - long, 0)
            yield _Swing(False, since, max(deed.first, min(since + long, round(MOVES * fps))), deed.slams)
            is_open = False
            continue
        if not is_open:
            yield _Swing(True, deed.first, deed.first)
        soon = following is not None and following.first - deed.last < AGAIN * fps
        awaited = following is not None and following.worked.does == "close"
        is_open = is_open or deed.worked.does == "open" or soon or awaited
        if not is_open:
            yield _Swing(False, deed.last, deed.last + round(MOVES * fps))


def _shares(front: Mechanism, hands: Hands, motion: Motion, deeds: Sequence[_Deed]) -> Array:
    """How far open a front is, 0 to 1. (T,)."""
    if any(deed.along is not None or deed.passes for deed in deeds):
        return _taken_along(front, hands, motion, deeds)
    shares = np.full(len(motion), float(deeds[0].worked.does == "close"))
    for swing in _swings(deeds, motion.fps):
        if swing.opens:
            shares[swing.since :] = _eased(_opening(front, hands, motion, deeds[0].worked.piece, swing.since))
        else:
            left = _slammed if swing.slams else _shut
            frames = np.arange(swing.since, len(motion), dtype=np.float64)
            shares[swing.since :] = shares[swing.since] * left(swing, frames)
    return shares


def _taken_along(front: Mechanism, hands: Hands, motion: Motion, deeds: Sequence[_Deed]) -> Array:
    """The same of one that hands take along, and that who comes in or leaves has open as long as they are in it."""
    shares = np.full(len(motion), float(deeds[0].worked.does == "close" and not deeds[0].passes))
    if deeds[0].worked.handle is not None:
        shares *= deeds[0].worked.handle.share
    ramp = _eased(np.arange(1, round(MOVES * motion.fps) + 1) / round(MOVES * motion.fps))
    away = _clearance(front, _bodies(hands, motion, deeds[0].worked.piece, 0, len(motion))).min(axis=1)
    for deed, following in zip(deeds, [*deeds[1:], None], strict=True):
        if deed.along is not None:
            since, along = deed.along
            shares[since:] = _fitted(along, len(motion) - since)
        if not deed.passes:
            continue
        if deed.worked.does == "close":  # who comes in
            shares[:] = _fitted(ramp, len(motion))
        elif deed.along is not None:  # who leaves pushes it wide on the way through
            let_go = min(deed.along[0] + len(deed.along[1]), len(motion) - 1)
            gone = np.linalg.norm(motion.root_positions[let_go:] - motion.root_positions[let_go], axis=1) > SETS_OFF
            sets_off = let_go + int(np.argmax(gone)) if gone.any() else len(motion)
            shares[sets_off:] += (1.0 - shares[sets_off:]) * _fitted(ramp, len(motion) - sets_off)
        passed = np.flatnonzero(away[deed.last :] < PASSED)
        past = deed.last + (int(passed[-1]) + 1 if len(passed) else 0)
        awaits = following.worked.handle if following is not None and following.worked.does == "close" else None
        if following is not None and following.along is not None:
            past = max(min(past, following.along[0] - len(ramp)), 0)
        if past < len(motion):
            rest = awaits.share if awaits is not None else 0.0
            shares[past:] = rest + (shares[past] - rest) * (1.0 - _fitted(ramp, len(motion) - past))
    return shares


def _fitted(shares: Array, frames: int) -> Array:
    """So many frames of shares (N,), the last of which goes on."""
    return np.concatenate([shares[:frames], np.full(max(frames - len(shares), 0), shares[-1])])


def _eased(shares: Array) -> Array:
    return np.asarray(shares * shares * (3 - 2 * shares))


def _shut(swing: _Swing, frames: Array) -> Array:
    """How far open a front still is in some frames that is shut softly, 1 to 0."""
    return _eased(np.clip((swing.until - frames) / max(swing.until - swing.since, 1), 0.0, 1.0))


def _slammed(swing: _Swing, frames: Array) -> Array:
    """The same of one that flies with the hand, faster and faster, hits its frame, and springs back a little."""
    far, seconds = RECOILS
    flown = np.clip((frames - swing.since) / max(swing.until - swing.since, 1), 0.0, 1.0)
    back = np.clip((frames - swing.until) / (seconds * FPS), 0.0, 1.0)
    return np.asarray(1.0 - flown**2 + far * np.sin(np.pi * back))


def _opening(front: Mechanism, hands: Hands, motion: Motion, piece: Placed, since: int) -> Array:
    """How far open a front is from a frame on, before that is eased: as far as the body leaves it room, and on once
    that is gone. (T - since,)."""
    blocked = _clearance(front, _bodies(hands, motion, piece, since, len(motion))) < IN_THE_WAY
    places = 0.5 - np.sin(np.arcsin(1.0 - 2.0 * np.linspace(0.0, 1.0, STEPS)) / 3.0)  # which are even once eased
    rate, share = 1.0 / (MOVES * motion.fps), 0.0
    found = np.zeros(len(motion) - since)
    for frame in range(1, len(found)):
        ahead = np.flatnonzero(blocked[frame] & (places > share))
        room = places[ahead[0] - 1] if len(ahead) else 1.0
        share = max(share, min(share + rate, room))
        found[frame] = share
    return found


def _tracks(piece: Placed, name: str, moving: Moving, shares: Array, always: bool = False) -> Iterator[PropTrack]:
    """Something while it is not at rest, or all the time."""
    shape = painted_shape(moving.painted)
    upright = rotations.yaw_to_quat(piece.yaw)
    called = re.sub(r"\W+", "_", f"{piece.id}_{name}")
    for start, stop in runs_of((shares > SHUT) | always):
        share = shares[start:stop]
        places = np.array(moving.pivot) + share[:, None] * np.array(moving.way)
        turns = rotations.compose(upright, rotations.yaw_to_quat(moving.turn * share))
        there = np.ones(stop - start, dtype=bool)
        yield PropTrack(called, start, piece.to_world(places), turns, np.ones(stop - start), there, (), shape)
