"""What hands do while a pose is held: write, type, play, drink, eat, read, keep time, wave (LINGO Table A1)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import arm_arrays
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.rotations import Array

BITE: Final = 2.6
"""About how long a sip or a bite takes, from the table to the mouth and back (seconds)."""
PAGE: Final = 2.8
"""About how long a page takes (seconds)."""
ARM: Final = 0.54
"""Shoulder to wrist (metres at 1.70 m)."""
EASE: Final = 0.3
"""A gesture grows out of the held pose and back into it over this long (seconds)."""


def gesture(held: Pose, doing: str) -> Pose:
    """A held pose of T frames with hands that do something; as it was where `doing` names nothing in `GESTURES`."""
    if doing not in GESTURES:
        return held
    time = np.arange(1, len(held) + 1) / FPS
    ease = smooth(time / EASE) * smooth((time[-1] - time) / EASE)
    return GESTURES[doing](held, time, ease)


def _moved(held: Pose, left: Array, right: Array, ease: Array) -> Pose:
    """Wrists moved by offsets (T, 3) in arm lengths, those of hands that lie somewhere as the body faces."""
    offsets = ease[:, None, None] * np.stack([left, right], axis=1)
    heading = rotations.yaw_to_quat(yaw_of(held.hips))[:, None]
    return replace(held, arms=held.arms + offsets, reach=held.reach + ARM * rotations.rotate(heading, offsets))


def _wave_of(rate: float, time: Array, phase: float = 0.0) -> Array:
    return np.sin(2 * np.pi * (rate * time + phase))


def _taps(rate: float, time: Array, phase: float = 0.0) -> Array:
    """Up between strokes and down on them, 0 to 1."""
    return np.maximum(_wave_of(rate, time, phase), 0.0)


def _along(time: Array, x: Array | float = 0.0, y: Array | float = 0.0, z: Array | float = 0.0) -> Array:
    """Offsets to the left, up and ahead. (T, 3)."""
    return np.stack([np.broadcast_to(np.asarray(value, dtype=np.float64), time.shape) for value in (x, y, z)], axis=1)


def _write(held: Pose, time: Array, ease: Array) -> Pose:
    """The right hand goes along a line in small strokes, and back to the next; the left keeps the paper."""
    line = (time / 1.6) % 1.0
    across = np.where(line < 0.85, line / 0.85, (1.0 - line) / 0.15)
    strokes = _along(time, 0.18 * smooth(across) - 0.12 + 0.015 * _wave_of(2.7, time), 0.0, 0.022 * _wave_of(3.1, time))
    return _moved(held, _along(time), strokes, ease)


def _type(held: Pose, time: Array, ease: Array) -> Pose:
    left = _along(time, 0.03 * _wave_of(0.7, time), 0.030 * _taps(3.1, time))
    right = _along(time, 0.04 * _wave_of(0.5, time, 0.3), 0.030 * _taps(2.9, time, 0.45))
    return _moved(held, left, right, ease)


def _piano(held: Pose, time: Array, ease: Array) -> Pose:
    left = _along(time, 0.12 * _wave_of(0.35, time), 0.055 * _taps(1.4, time))
    right = _along(time, 0.16 * _wave_of(0.4, time, 0.4), 0.055 * _taps(2.8, time, 0.5))
    sway = ease[:, None] * _along(time, 0.03 * _wave_of(0.35, time), 0.0, 0.05 * _wave_of(0.35, time))
    return replace(_moved(held, left, right, ease), spine=held.spine + sway)


def _game(held: Pose, time: Array, ease: Array) -> Pose:
    """Both hands keep the controller between them: it jerks and tilts."""
    shared = 0.022 * _wave_of(0.9, time)
    tilt = 0.030 * _wave_of(1.3, time) + 0.012 * _wave_of(3.7, time)
    return _moved(held, _along(time, shared, tilt), _along(time, shared, -tilt), ease)


def _to_the_mouth(held: Pose, time: Array, ease: Array, index: int = 1) -> Pose:
    """A hand (0 left, 1 right) rises to the mouth, stays a moment and goes down, as often as there is time for."""
    times = max(round(float(time[-1]) / BITE), 1)
    share = (time / time[-1] * times) % 1.0
    share[-1] = 0.0
    lifted = (smooth(share / 0.4) * smooth((1.0 - share) / 0.35))[:, None]
    wrists, elbows = arm_arrays("mouth", "mouth")
    arms, poles, head = held.arms.copy(), held.elbows.copy(), held.head.copy()
    arms[:, index] += lifted * (wrists[index] - arms[:, index])
    poles[:, index] += lifted * (elbows[index] - poles[:, index])
    # A hand that rises leaves what it may have been laid on.
    free = np.zeros_like(held.reaching)
    free[:, index] = lifted[:, 0]
    head[:, 0] += 0.06 * ease * lifted[:, 0]
    return replace(
        held,
        arms=arms,
        elbows=poles,
        head=head,
        reaching=held.reaching * (1 - free),
        pressing=held.pressing * (1 - free),
    )


def _read(held: Pose, time: Array, ease: Array) -> Pose:
    """The eyes go along the lines and down the page; now and then the right hand turns a leaf over."""
    turns = max(round(float(time[-1]) / PAGE), 1)
    page = time / time[-1] * turns % 1.0
    leaf = np.clip((page - 0.62) / 0.30, 0.0, 1.0)
    over = np.sin(np.pi * smooth(leaf))
    sweep = _along(time, 0.26 * over, 0.10 * over, 0.04 * over)
    scan = ease * 0.035 * _wave_of(0.9, time)
    eyes = replace(held, head=held.head + _along(time, ease * 0.08 * (page - 0.5), scan))
    return _moved(eyes, _along(time), sweep, ease)


def _music(held: Pose, time: Array, ease: Array) -> Pose:
    """The head nods and the trunk sways with the beat; the hands stay at the ears."""
    nod = ease * 0.09 * _wave_of(1.5, time)
    sway = ease * 0.06 * _wave_of(0.75, time)
    return replace(held, head=held.head + _along(time, nod), spine=held.spine + _along(time, 0.2 * nod, 0.0, sway))


def _wave(held: Pose, time: Array, ease: Array) -> Pose:
    """Whichever hand is up swings from side to side."""
    raised = (held.arms[:, :, 1] > 0).astype(np.float64)
    swing = _along(time, 0.20 * _wave_of(1.6, time), 0.02 * _wave_of(3.2, time))
    return _moved(held, raised[:, :1] * swing, raised[:, 1:] * swing, ease)


GESTURES: Final[dict[str, Callable[[Pose, Array, Array], Pose]]] = {
    "write": _write,
    "type": _type,
    "piano": _piano,
    "game": _game,
    "drink": _to_the_mouth,
    "drink_left": partial(_to_the_mouth, index=0),
    "eat": _to_the_mouth,
    "read": _read,
    "music": _music,
    "wave": _wave,
}
