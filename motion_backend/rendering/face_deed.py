"""What is done with the face: weeping, laughing, sighing, falling asleep, and whatever a story closes with.

A film shows it from near and from before, and stays there.
"""

from __future__ import annotations

import re
from typing import Final

import numpy as np

from motion_backend.body.cast import Role
from motion_backend.motion import Motion, PhaseKind
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

SAYS: Final = re.compile(
    r"\b(?:cry|sob|weep|laugh|giggl|chuckl|sigh|yawn|asleep|sleep|doz|smil|despair|pant|gasp|breath|sneez|cough|blush)"
    r"|\b(?:supporting|holding) head"
)
"""In a caption: its deed is of the face."""
STILL: Final = 0.3
"""Metres that a head moves while a camera that stands still may look at it from near."""
LEAST: Final = 1.2
"""Seconds that such a look is worth."""
WALKED: Final = 0.1
"""The share of some frames in which somebody walks from which on they are no such deed."""


def face_deed(
    motion: Motion, joints: Array, role: Role, start: int, stop: int, shortest: int
) -> tuple[int, int] | None:
    """The frames of some, to their end, in which a face does what it is about, or that a motion closes with; None where
    there are none. They are all of them, or leave at least so many before. `joints` (T, 22, 3) are the body's."""
    keyframe = int(motion.actions[stop - 1])
    _, caption = role.captions.get(keyframe, (None, ""))
    closes = bool((motion.actions[stop - 1 :] == keyframe).all()) and keyframe in role.captions
    if not (closes or keyframe in role.asleep or SAYS.search(caption)):
        return None
    walks = np.zeros(len(motion), dtype=bool)
    for phase in motion.phases:
        walks[phase.start : phase.stop] |= phase.kind in (PhaseKind.WALK, PhaseKind.TOUCH)
    own = int(np.flatnonzero(motion.actions[start:stop] == keyframe)[0]) + start
    head = joints[own:stop, INDEX["head"]][::-1]
    far = np.maximum.accumulate(head, axis=0) - np.minimum.accumulate(head, axis=0)
    still = int(np.searchsorted(far.max(axis=1), STILL))
    first = stop - still
    if first < start + shortest:
        first = start if first <= start else start + shortest
    if stop - first < LEAST * motion.fps or walks[first:stop].mean() > WALKED:
        return None
    return first, stop
