"""How far open is what a hand takes along by its handle: as far as the hand has got, whoever moved it."""

from __future__ import annotations

from typing import Final

import numpy as np

from motion_backend.body.cast import Worked
from motion_backend.props.prop_frames import runs_of
from motion_backend.props.prop_hands import Hands
from motion_backend.rotations import Array
from motion_backend.skeleton import HAND_REST

HOLDS: Final = 0.04
"""A wrist holds a handle that is no farther than this from where it would have it (metres)."""
WAYS: Final = 200
"""Places of a handle on its way that are looked at."""
GOES: Final = 0.4
"""The share of the way, from where it is taken hold of to the farthest, that counts as taken along."""
RESTS: Final = 0.012
"""A share of the way that is as good as none: a hand comes to a handle, and leaves it, from before the front."""


def followed(hands: Hands, worked: Worked, span: tuple[int, int]) -> tuple[int, Array] | None:
    """The first frame in which a hand holds a handle, and from there how far open its front is, 0 to 1, the last of
    which it stays; None where no hand takes it along in a span."""
    handle = worked.handle
    if handle is None:
        return None
    wrists = hands.wrists_at[slice(*span), 0 if worked.hand == "left" else 1]
    out = np.array([np.sin(worked.piece.yaw), 0.0, np.cos(worked.piece.yaw)])
    shares = np.linspace(0.0, 1.0, WAYS)
    gaps = np.linalg.norm(wrists[:, None] - (handle.at(shares) + HAND_REST * out), axis=2)
    at, gap = shares[gaps.argmin(axis=1)], gaps.min(axis=1)
    first, last = max(runs_of(gap < HOLDS), key=lambda run: run[1] - run[0], default=(0, 0))
    if last - first < 2 or np.ptp(at[first:last]) < GOES:
        return None
    shuts = handle.does == "close"
    gone = _taken((1.0 - at if shuts else at)[first:last], handle.does == "into")
    return span[0] + first, handle.share * (1.0 - gone if shuts else gone)


def _taken(along: Array, back: bool) -> Array:
    """How far a handle is taken along, 0 to 1, by a hand that is at shares (N,) of its way: from when it sets off to
    when it is farthest, and `back` or not. (N,)."""
    farthest = int(np.argmax(along >= along.max() - RESTS))
    begun = np.flatnonzero(along[: farthest + 1] <= along[: farthest + 1].min() + RESTS)[-1]
    low, high = along[begun], along.max()
    taken = np.ones(len(along))
    taken[: begun + 1] = 0.0
    taken[begun : farthest + 1] = (np.maximum.accumulate(along[begun : farthest + 1]) - low) / (high - low)
    if back:
        leaves = int(np.flatnonzero(along >= high - RESTS)[-1])
        rest = along[leaves:]
        shut = int(np.argmax(rest <= rest.min() + RESTS))
        taken[leaves : leaves + shut + 1] = (np.minimum.accumulate(rest[: shut + 1]) - rest[shut]) / (high - rest[shut])
        taken[leaves + shut :] = 0.0
    return np.clip(taken, 0.0, 1.0)
