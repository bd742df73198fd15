"""Where small things are before they are in a hand and after: on what stands near.

Nobody is seen to reach for them there, unless the words say so (`carried_things`): films cut where keyframes begin, and
after the cut the cup is on the table.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise
from typing import Final

import numpy as np

from motion_backend.body.cast import Rest, Role
from motion_backend.motion import Motion
from motion_backend.props.carried_things import laid
from motion_backend.props.prop_frames import GROWS, PropTrack, growth
from motion_backend.props.prop_shapes import prop_shape
from motion_backend.props.prop_table import prop_table

SMALL: Final = 0.40
"""Metres of the longest side of what may lie anywhere: a guitar does not."""
POCKETED: Final = frozenset({"phone", "comb", "pen", "lipstick", "cigarette", "keys"})
"""What is in a pocket while it is in no hand."""
NEAR: Final = 1.6
"""Metres from somebody's hips to a place that is theirs."""
BETWEEN: Final = 0.5
"""Seconds for which something is in no hand and is not laid down."""


def resting_things(motion: Motion, role: Role, held: Sequence[PropTrack]) -> Iterator[PropTrack]:
    """Tracks of what lies while it is in no hand, besides those of what was in the hands of a motion."""
    known = {row.shape: row for row in prop_table().called}
    ordered = sorted((one for one in held if one.own is None and len(one.held)), key=lambda one: (one.prop, one.start))
    for prop, group in groupby(ordered, key=lambda one: one.prop):
        if prop not in known or prop in POCKETED or np.ptp(prop_shape(prop).vertices, axis=0).max() > SMALL:
            continue
        for start, stop, rest in _waits(motion, role, list(group)):
            there = laid(known[prop], rest.at, rest.facing)
            long = stop - start
            yield PropTrack(
                prop, start, np.tile(there.position, (long, 1)), np.tile(there.turn, (long, 1)),
                growth(start, stop, len(motion), motion.fps), np.ones(long, dtype=bool), (),
            )  # fmt: skip


def _waits(motion: Motion, role: Role, tracks: Sequence[PropTrack]) -> Iterator[tuple[int, int, Rest]]:
    """From when to when one thing, which these tracks have in their order, lies where: where it is laid down, else
    where it is taken from next."""
    ramp = round(GROWS * motion.fps)
    for before, after in pairwise([None, *tracks, None]):
        start = 0 if before is None else before.stop - ramp
        stop = len(motion) if after is None else after.start + ramp
        laid_down = before is not None and before.is_held(before.stop - 1) and before.stop < len(motion)
        taken = after is not None and after.is_held(after.start) and after.start > 0
        if stop - start - 2 * ramp < BETWEEN * motion.fps:
            continue
        rest = _rest(motion, role, before.stop - 1) if before is not None and laid_down else None
        if rest is None and after is not None and taken and (before is None or laid_down):
            rest = _rest(motion, role, after.start)
        if rest is not None:
            yield start, stop, rest


def _rest(motion: Motion, role: Role, frame: int) -> Rest | None:
    """That of the keyframe of a frame, if the body is near it."""
    rest = role.rests.get(int(motion.actions[frame]))
    if rest is None:
        return None
    away = motion.root_positions[frame, [0, 2]] - np.array(rest.at)[[0, 2]]
    return rest if float(np.hypot(*away)) < NEAR else None
