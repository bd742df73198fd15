"""Standing feet put on the floor and held where they stand, heel first and ball after it. Floor at y = 0.

What a foot slides while it stands is taken back step by step: the ball's way where the ball stands, else the heel's.
Over a stance that shift is zero on average; in the air it passes from that of one stance to that of the next.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from motion_backend.mocap.foot_contacts import BALLS, MAX_FOOT_SHIFT, Feet, Flags, runs, without_brief
from motion_backend.mocap.resampling import low_pass
from motion_backend.rotations import Array

LOW = 0.04
"""Metres above its rest height under which a heel or ball may stand."""
SLOW, SLOWER = 0.3, 0.25
"""Metres a second, and share of the pelvis' speed: it stands while slower than either. Shoes of who runs shake."""
DRAGGED = 0.8
"""Metres a second: a low foot that is faster swings."""
PASSED = 8.0
"""Hz above which nothing of the shift is kept."""
CARRIED = 3.0
"""Likewise of what the pelvis comes along with a standing foot."""
SETS_OUT = 20.0
"""A second: how fast a shift comes to where it should be from frames that are not shifted."""


def standing(feet: Feet, pelvis: Array, grounded: bool = False) -> tuple[Flags, Flags]:
    """Whether heels and whether balls stand, under a pelvis at (T, 3). (T, 2) each.

    Who is `grounded` never leaves the floor: where no point is slow enough to stand, the slowest of the low ones is
    taken to, up to `DRAGGED`. A made foot slides in places where a person's stands.
    """
    speed = np.linalg.norm(_rate(pelvis[:, [0, 2]], feet.fps), axis=1)
    most = np.maximum(SLOW, SLOWER * speed)[:, None]
    rest = feet.skeleton.ankle_height + feet.skeleton.offsets[BALLS[0], 1]
    points, rests = np.stack([feet.soles[:, :, 0], feet.balls], axis=2), np.array([0.0, rest])  # (T, side, point, 3)
    pace, low = np.linalg.norm(_rate(points[..., [0, 2]], feet.fps), axis=-1), points[..., 1] < rests + LOW
    flags = low & (pace < most[..., None])
    if grounded:
        least = np.where(low & (pace < DRAGGED), pace, np.inf)
        slowest = least <= least.min(axis=(1, 2), keepdims=True)
        flags |= slowest & np.isfinite(least) & ~flags.any(axis=(1, 2), keepdims=True)
    flags = np.stack([without_brief(column) for column in flags.reshape(len(flags), 4).T], axis=1)
    return flags[:, 0::2], flags[:, 1::2]


def locked(
    feet: Feet, pelvis: Array, fixed: int = 0, slack: float = 0.0, grounded: bool = False
) -> tuple[Array, Array]:
    """How far ankles must move for feet to stand on the floor and to stay there, (T, 2, 3), and the pelvis with them.

    The pelvis, (T, 3), rises and sinks with the foot that stands, so that its leg keeps its length: a leg that is
    nearly straight pays for a centimetre with ten degrees of its knee. Metres. The first `fixed` frames do not move,
    and a foot that stands in the last of them stays there. Soles that stand within `slack` over the floor are left so.
    """
    heels, balls = standing(feet, pelvis, grounded)
    shift = np.zeros_like(feet.ankles)
    for side in range(2):
        way = np.where(balls[:-1, side, None], _steps(feet.balls[:, side]), _steps(feet.soles[:, side, 0]))
        stances = runs(without_brief(heels[:, side] | balls[:, side]))
        for start, stop in stances:
            back = -np.concatenate([[[0.0, 0.0]], np.cumsum(way[start : stop - 1], axis=0)])
            there = back[fixed - 1 - start] if start < fixed < stop else back.mean(axis=0)
            shift[start:stop, side][:, [0, 2]] = back - there
            low = feet.soles[start:stop, side, :, 1].min(axis=1)
            shift[start:stop, side, 1] = np.clip(low, 0.0, slack) - low
        if fixed:
            shift[:fixed, side] = 0.0
            stances = [(0, fixed), *((max(start, fixed), stop) for start, stop in stances if stop > fixed)]
        _pass_over(shift[:, side], stances)
    length = np.linalg.norm(shift, axis=-1, keepdims=True)
    shift *= np.minimum(1.0, MAX_FOOT_SHIFT / np.maximum(length, 1e-9))
    carried = np.zeros_like(pelvis)
    carried[:, 1] = np.average(shift[..., 1], axis=1, weights=(heels | balls) + 1e-3)
    if len(shift) > 8:
        shift, carried = low_pass(shift, feet.fps, PASSED), low_pass(carried, feet.fps, CARRIED)
    return from_nothing(shift, fixed, feet.fps), from_nothing(carried, fixed, feet.fps)


def from_nothing(shift: Array, fixed: int, fps: float) -> Array:
    """A shift (T, …) that is none in the first `fixed` frames, and sets out from there in place and in speed."""
    if not 0 < fixed < len(shift):
        return shift
    begins, pace = shift[fixed - 1], (shift[fixed] - shift[fixed - 1]) * fps
    seconds = np.arange(1, len(shift) - fixed + 1).reshape(-1, *([1] * (shift.ndim - 1))) / fps
    found = np.zeros_like(shift)
    found[fixed:] = shift[fixed:] - np.exp(-SETS_OUT * seconds) * (begins + seconds * (pace + SETS_OUT * begins))
    return found


def _rate(points: Array, fps: float) -> Array:
    """Metres a second, of neighbouring frames. (T, …)."""
    return np.asarray(np.gradient(points, axis=0) * fps) if len(points) > 1 else np.zeros_like(points)


def _steps(points: Array) -> Array:
    """From each frame to the next over the floor. (T, 3) to (T - 1, 2)."""
    return np.asarray(np.diff(points[:, [0, 2]], axis=0))


def _pass_over(shift: Array, stances: list[tuple[int, int]]) -> None:
    """Between stances the shift (T, 3) goes smoothly from one to the next; at either end it stays."""
    if not stances:
        return
    shift[: stances[0][0]] = shift[stances[0][0]]
    shift[stances[-1][1] :] = shift[stances[-1][1] - 1]
    for (_, stop), (start, _) in pairwise(stances):
        share = np.linspace(0.0, 1.0, start - stop + 2)[1:-1, None]
        share = share * share * (3.0 - 2.0 * share)
        shift[stop:start] = shift[stop - 1] * (1 - share) + shift[start] * share
