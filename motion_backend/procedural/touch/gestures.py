"""What hands do while a pose is held: write, type, play, drink, eat, read, keep time, wave (LINGO Table A1).

The numbers are rows of data/gestures.toml.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Final, Literal

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import arm_arrays
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.rotations import Array
from motion_backend.skeleton import ARM_LENGTH
from scene_graphs.data_tables import read_table, table


@table
class HandWave:
    """One wave that a hand is moved by."""

    rate_hz: float
    hand: Literal["left", "right", "raised"] = "right"
    left_arms: float = 0.0
    """How far to the left, up and ahead it goes (arm lengths)."""
    up_arms: float = 0.0
    ahead_arms: float = 0.0
    phase_share: float = 0.0
    """Where in its period it begins."""
    taps: bool = False
    """Whether only its upper half is gone through: up between strokes and down on them."""

    def offsets(self, time: Array) -> Array:
        """At times (T,): to the left, up and ahead. (T, 3)."""
        wave = _wave_of(self.rate_hz, time, self.phase_share)
        return (np.maximum(wave, 0.0) if self.taps else wave)[:, None] * [self.left_arms, self.up_arms, self.ahead_arms]


@table
class TrunkWave:
    """One wave that trunk or head bends in."""

    part: Literal["spine", "head"]
    rate_hz: float
    forward_rad: float = 0.0
    turn_rad: float = 0.0
    side_rad: float = 0.0

    def bends(self, time: Array) -> Array:
        """At times (T,): forwards, to the left and to the side. (T, 3)."""
        return _wave_of(self.rate_hz, time)[:, None] * [self.forward_rad, self.turn_rad, self.side_rad]


@table
class Waves:
    """A gesture that is nothing but waves, each added to the ones before."""

    hands: tuple[HandWave, ...]
    trunk: tuple[TrunkWave, ...] = ()


@table
class Writing:
    """A line written, and the way back to the next."""

    line_s: float
    written_share: float
    """Of its time spent along the line."""
    returned_share: float
    line_arms: float
    start_arms: float
    """So far to the right of where the hand was a line begins."""
    across: HandWave
    along: HandWave


@table
class ToTheMouth:
    """A sip or a bite."""

    bite_s: float
    rise_share: float
    """Of its time spent on the way up."""
    lower_share: float
    head_forward_rad: float


@table
class Reading:
    """A page read, and its leaf turned."""

    page_s: float
    leaf_at_share: float
    """When in a page's time its leaf is taken."""
    leaf_share: float
    leaf_left_arms: float
    leaf_up_arms: float
    leaf_ahead_arms: float
    down_rad: float
    """How far the head sinks from the first line to the last."""
    scan_rad: float
    scan_hz: float


@table
class Music:
    """The beat kept; hands stay at the ears."""

    nod_rad: float
    nod_hz: float
    spine_nod_share: float
    """Of the nod, in the trunk."""
    sway_rad: float
    sway_hz: float


@table
class Gestures:
    """data/gestures.toml."""

    ease_s: float
    """A gesture grows out of the held pose, and back into it, over this long."""
    write: Writing
    mouth: ToTheMouth
    read: Reading
    music: Music
    waves: dict[str, Waves]


def gesture_table() -> Gestures:
    """The numbers of every gesture."""
    rows: Gestures = read_table("motion_backend", "gestures.toml", Gestures)
    return rows


def gesture(held: Pose, doing: str) -> Pose:
    """A held pose of T frames with hands that do something; as it was where `doing` names nothing in `GESTURES`."""
    if doing not in GESTURES:
        return held
    time = np.arange(1, len(held) + 1) / FPS
    seconds = gesture_table().ease_s
    ease = smooth(time / seconds) * smooth((time[-1] - time) / seconds)
    return GESTURES[doing](held, time, ease)


def _wave_of(rate: float, time: Array, phase: float = 0.0) -> Array:
    return np.asarray(np.sin(2 * np.pi * (rate * time + phase)))


def _moved(held: Pose, left: Array, right: Array, ease: Array) -> Pose:
    """Wrists moved by offsets (T, 3) in arm lengths, those of hands that lie somewhere as the body faces."""
    offsets = ease[:, None, None] * np.stack([left, right], axis=1)
    heading = rotations.yaw_to_quat(yaw_of(held.hips))[:, None]
    return replace(held, arms=held.arms + offsets, reach=held.reach + ARM_LENGTH * rotations.rotate(heading, offsets))


def _in_waves(held: Pose, time: Array, ease: Array, waves: str) -> Pose:
    """Hands, trunk and head moved by the waves of that name."""
    rows = gesture_table().waves[waves]
    offsets, raised = np.zeros((2, len(time), 3)), held.arms[:, :, 1] > 0
    for row in rows.hands:
        for index, hand in enumerate(("left", "right")):
            if row.hand == hand:
                offsets[index] += row.offsets(time)
            elif row.hand == "raised":
                offsets[index] += raised[:, index, None] * row.offsets(time)
    moved = _moved(held, offsets[0], offsets[1], ease)
    for bend in rows.trunk:
        part = getattr(moved, bend.part) + ease[:, None] * bend.bends(time)
        moved = replace(moved, spine=part) if bend.part == "spine" else replace(moved, head=part)
    return moved


def _write(held: Pose, time: Array, ease: Array) -> Pose:
    """The right hand goes along a line in small strokes, and back to the next; the left keeps the paper."""
    row = gesture_table().write
    line = (time / row.line_s) % 1.0
    across = np.where(line < row.written_share, line / row.written_share, (1.0 - line) / row.returned_share)
    strokes = row.along.offsets(time)
    strokes[:, 0] = row.line_arms * smooth(across) - row.start_arms + row.across.offsets(time)[:, 0]
    return _moved(held, np.zeros_like(strokes), strokes, ease)


def _to_the_mouth(held: Pose, time: Array, ease: Array, index: int = 1) -> Pose:
    """A hand (0 left, 1 right) rises to the mouth, stays a moment and goes down, as often as there is time for."""
    row = gesture_table().mouth
    times = max(round(float(time[-1]) / row.bite_s), 1)
    share = (time / time[-1] * times) % 1.0
    share[-1] = 0.0
    lifted = (smooth(share / row.rise_share) * smooth((1.0 - share) / row.lower_share))[:, None]
    wrists, elbows = arm_arrays("mouth", "mouth")
    arms, poles, head = held.arms.copy(), held.elbows.copy(), held.head.copy()
    arms[:, index] += lifted * (wrists[index] - arms[:, index])
    poles[:, index] += lifted * (elbows[index] - poles[:, index])
    # A hand that rises leaves what it may have been laid on.
    free = np.zeros_like(held.reaching)
    free[:, index] = lifted[:, 0]
    head[:, 0] += row.head_forward_rad * ease * lifted[:, 0]
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
    row = gesture_table().read
    turns = max(round(float(time[-1]) / row.page_s), 1)
    page = time / time[-1] * turns % 1.0
    leaf = np.clip((page - row.leaf_at_share) / row.leaf_share, 0.0, 1.0)
    over = np.sin(np.pi * smooth(leaf))
    sweep = over[:, None] * [row.leaf_left_arms, row.leaf_up_arms, row.leaf_ahead_arms]
    head = held.head.copy()
    head[:, 0] += ease * row.down_rad * (page - 0.5)
    head[:, 1] += ease * row.scan_rad * _wave_of(row.scan_hz, time)
    return _moved(replace(held, head=head), np.zeros_like(sweep), sweep, ease)


def _music(held: Pose, time: Array, ease: Array) -> Pose:
    """The head nods and the trunk sways with the beat; the hands stay at the ears."""
    row = gesture_table().music
    nod = ease * row.nod_rad * _wave_of(row.nod_hz, time)
    sway, still = ease * row.sway_rad * _wave_of(row.sway_hz, time), np.zeros_like(nod)
    spine = held.spine + np.stack([row.spine_nod_share * nod, still, sway], axis=1)
    return replace(held, head=held.head + np.stack([nod, still, still], axis=1), spine=spine)


GESTURES: Final[dict[str, Callable[[Pose, Array, Array], Pose]]] = {
    "write": _write,
    "type": partial(_in_waves, waves="type"),
    "piano": partial(_in_waves, waves="piano"),
    "game": partial(_in_waves, waves="game"),
    "drink": _to_the_mouth,
    "drink_left": partial(_to_the_mouth, index=0),
    "eat": _to_the_mouth,
    "read": _read,
    "music": _music,
    "wave": partial(_in_waves, waves="wave"),
    "tap": partial(_in_waves, waves="tap"),
}
"""What hands can be told to do, by name."""
