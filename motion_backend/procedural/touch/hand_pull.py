"""What a hand does that takes a handle along: of a door about its hinge, of a drawer straight out.

Key poses and the way through them are rows of data/transitions/touch_pull.toml.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.pose import Pose, concatenate, interpolate, smooth
from motion_backend.procedural.touch.hand_actions import Way
from motion_backend.procedural.touch.touch_keys import TouchKeys
from motion_backend.rotations import Array


def pulled(first: Way, last: Way, way: Array, back: bool, keys: TouchKeys) -> Pose:
    """Frames from standing to standing: a hand laid as it is `first`, taken along a way of wrists (N, 3) to where it is
    `last`, kept there, and `back` by the same way or not; body and palm go along."""
    rows, row = keys.pull, keys.held.pull
    poses = [{one.name: end.pose(one) for one in rows.pose} for end in (first, last)]
    come = first.through(first.away, first.keys(rows, "come", poses[0]))
    there, stays = poses[0]["there"], poses[1]["there"]
    steps = np.diff(way, axis=0)
    length = float(np.linalg.norm(steps, axis=1).sum())
    sets_off, gets_there = rotations.normalize(steps[[0, -1]])
    turn = float(np.arccos(np.clip(sets_off @ gets_there, -1.0, 1.0)))
    takes = round(max(length / row.speed_mps, turn / row.rate_radps, row.swing_min_s) / first.tempo * FPS)
    time = np.arange(1, takes + 1) / takes
    grips, waits = there.repeat(round(row.grips_s * FPS)), round(max(first.hold, row.least_s) * FPS)
    swing = _carried(there, stays, way, time * time * (3 - 2 * time), first.hands[0])
    parts = [come, grips, swing, swing.at(takes - 1).repeat(waits)]
    ends = last
    if back:
        parts += [swing.at(slice(None, None, -1)), grips]
        ends, stays = first, there
    leave = ends.through(stays, ends.keys(rows, "leave", poses[0 if ends is first else 1]))
    return concatenate([*parts, leave])


def _carried(there: Pose, stays: Pose, way: Array, share: Array, hand: int) -> Pose:
    """Frames between two poses at shares (T,) of the time, a hand (0 left, 1 right) along a way of wrists (N, 3)."""
    frames = interpolate([0.0, 1.0], [there, stays], 120)
    eased = smooth(np.arange(1, len(frames) + 1) / len(frames))
    chosen = frames.at(np.clip(np.searchsorted(eased, share), 0, len(frames) - 1))
    reach = chosen.reach.copy()
    along = np.linspace(0.0, 1.0, len(way))
    reach[:, hand] = np.stack([np.interp(share, along, axis) for axis in way.T], axis=1)
    palms = chosen.palms.copy()
    palms[:, hand] = rotations.slerp(there.palms[hand], stays.palms[hand], share)
    return replace(chosen, reach=reach, palms=palms)
