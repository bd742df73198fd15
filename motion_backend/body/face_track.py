"""What a face does in every frame of a motion: the emotion of each keyframe, blinks, and eyes that lead the head.

Shares of the units of `face.UNITS`; the numbers are rows of data/faces.toml. The same motion and role give the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from random import Random
from typing import get_args

import numpy as np

from motion_backend import rotations
from motion_backend.body.cast import Role
from motion_backend.body.face import UNITS
from motion_backend.motion import Emotion, Motion, Reacts
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX
from scene_graphs.data_tables import read_table, require_known, table

_LIDS, _LEFT, _UP = (UNITS.index(unit) for unit in ("lids_down", "gaze_left", "gaze_up"))


@table
class _Blinks:
    """Seconds between blinks, and of one."""

    gap_min_s: float
    gap_max_s: float
    close_s: float
    shut_s: float
    open_s: float


@table
class _Faces:
    """data/faces.toml."""

    change_s: float
    lead_s: float
    aside_rad: float
    up_rad: float
    least_share: float
    jump_s: float
    startled_s: float
    """Into what a face does at something that happens, and out of it."""
    blinks: _Blinks
    emotions: Mapping[str, Mapping[str, float]]
    reactions: Mapping[str, Mapping[str, float]]
    """What it does at once, whatever the emotion."""

    def __post_init__(self) -> None:
        require_known("emotions", self.emotions, set(Emotion))
        require_known("emotions: lacking", set(Emotion), self.emotions)
        require_known("reactions", self.reactions, set(get_args(Reacts)))
        for name, row in (*self.emotions.items(), *self.reactions.items()):
            require_known(f"emotions or reactions.{name}", row, UNITS)


@cache
def _faces() -> _Faces:
    known: _Faces = read_table("motion_backend", "faces.toml", _Faces)
    return known


def expression(emotion: Emotion) -> Array:
    """What a face does in an emotion. (K,) shares."""
    return _shares(_faces().emotions[emotion])


def _shares(row: Mapping[str, float]) -> Array:
    """What a face does by a row of the table. (K,)."""
    return np.array([row.get(unit, 0.0) for unit in UNITS])


def face_track(motion: Motion, role: Role) -> Array:
    """Shares of every unit in every frame of a motion. (T, K)."""
    track = _startled(_emotions(motion, role), motion)
    shut = np.isin(motion.actions, sorted(role.asleep)).astype(np.float64)
    shut = _smoothed(shut[:, None], _faces().change_s * motion.fps)[:, 0]
    closed = np.maximum(_blinks(len(motion), motion.fps), shut)
    track[:, _LIDS] += (1.0 - track[:, _LIDS]) * closed
    aside, up = _gaze(motion)
    track[:, _LEFT], track[:, _UP] = aside * (1 - shut), up * (1 - shut)
    return track


def _emotions(motion: Motion, role: Role) -> Array:
    """Each keyframe's, passing softly into the next."""
    keyframes, where = np.unique(motion.actions, return_inverse=True)
    rows = np.stack([expression(role.emotions.get(int(k), Emotion.NEUTRAL)) for k in keyframes])
    return _smoothed(rows[where.reshape(-1)], _faces().change_s * motion.fps)


def _startled(track: Array, motion: Motion) -> Array:
    """The same with what a face does where something that happens is reacted to."""
    for phase in motion.phases:
        if phase.reacts:
            row = _faces().reactions.get(phase.reacts, {})
            there = np.zeros((len(track), 1))
            there[phase.start : phase.stop] = 1.0
            track = track + _smoothed(there, _faces().startled_s * motion.fps) * (_shares(row) - track)
    return track


def _smoothed(track: Array, frames: float) -> Array:
    """Means over so many frames: steps become ramps."""
    half = max(1, round(frames / 2))
    padded = np.concatenate([track[:1].repeat(half, axis=0), track, track[-1:].repeat(half, axis=0)])
    total = np.concatenate([np.zeros((1, track.shape[1])), np.cumsum(padded, axis=0)])
    return np.asarray((total[2 * half + 1 :] - total[: -2 * half - 1]) / (2 * half + 1))


def _blinks(frames: int, fps: int) -> Array:
    """How far lids are closed by blinks. (T,)."""
    row, luck = _faces().blinks, Random(0)
    times = np.arange(frames) / fps
    closed, now = np.zeros(frames), luck.uniform(row.gap_min_s, row.gap_max_s) / 2
    while now < frames / fps:
        edges = np.cumsum([now, row.close_s, row.shut_s, row.open_s])
        closed = np.maximum(closed, np.interp(times, edges, (0.0, 1.0, 1.0, 0.0), left=0.0, right=0.0))
        now = float(edges[-1]) + luck.uniform(row.gap_min_s, row.gap_max_s)
    return closed


def _gaze(motion: Motion) -> tuple[Array, Array]:
    """How far the eyes look to the left and up, where the head will soon face: they lead it, in jumps. (T,) each."""
    row = _faces()
    _, world = motion.skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
    head = world[:, INDEX["head"]]
    ahead = np.minimum(np.arange(len(head)) + round(row.lead_s * motion.fps), len(head) - 1)
    toward = rotations.rotate(rotations.compose(rotations.inverse(head), head[ahead]), np.array([0.0, 0.0, 1.0]))
    aside = np.arctan2(toward[:, 0], toward[:, 2]) / row.aside_rad
    up = np.arcsin(np.clip(toward[:, 1], -1.0, 1.0)) / row.up_rad
    wanted = np.clip(np.column_stack([aside, up]), -1.0, 1.0)
    held = np.zeros_like(wanted)
    for frame in range(1, len(wanted)):
        away = np.abs(wanted[frame] - held[frame - 1]).max() > row.least_share
        held[frame] = wanted[frame] if away else held[frame - 1]
    jumped = _smoothed(held, row.jump_s * motion.fps)
    return jumped[:, 0], jumped[:, 1]
