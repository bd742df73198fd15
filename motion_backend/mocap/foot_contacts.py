"""Feet on the floor: when they stand, how they slide, and keeping them where they stand. Floor at y = 0.

Feet are (T, 2) left, right. A foot's position is that of its ankle; our sole hangs on it, so that a source's feet and
ours are measured alike.

Where the floor is under a body that was never told: levels, slopes, toy bodies and walks on the spot.

Heights are those of the lowest point of the body's skin: soles, and the capsules of all the rest.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from motion_backend import inverse_kinematics, rotations
from motion_backend.body import capsules
from motion_backend.mocap.resampling import low_pass
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

Flags = NDArray[np.bool_]
LOW, SLOW = 0.06, 0.15
"""Metres above rest height and metres a second within which a joint of the foot stands (notes of DIMOS and Kimodo)."""
LINGER = 1.6
"""How much either may be exceeded before a standing joint counts as lifted."""
HAND_AWAY = 0.25
"""Metres that a resting hand is beside or before its shoulder: a hanging one touches nothing."""
BRIEF = 3
"""Frames under which a contact, or a gap in one, is noise."""
MAX_FOOT_SHIFT = 0.06
"""Metres by which a foot is moved at most to stand still."""
CLEARANCE = 0.02
"""Metres that toes pass over the floor."""
MAX_TOES = 1.0
"""Radians by which toes are bent at most."""
TOE_SPEED = 9.0
"""Radians a second."""
EQUAL, MAX_UNEQUAL = 0.01, 0.05
"""Metres by which feet of one body may stand at different heights: unseen up to the first; beyond the second no fault
of how a skeleton was measured."""
NEAR_FLOOR = 0.01
"""Metres under which a corner of a sole counts as on the floor: recorded feet do not stand to the millimetre."""
MIN_LOW = 15
"""Corners of soles on the floor, over all frames, from which their speed says something."""
STRAIGHT = 0.02
"""Metres that a knee is out of the line from hip to ankle when its leg is as good as straight."""
_SIDES = ("left", "right")
_LEFT, _FRONT = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
ANKLES, KNEES, HIPS, BALLS = ([INDEX[f"{side}_{name}"] for side in _SIDES] for name in ("ankle", "knee", "hip", "foot"))


@dataclass(frozen=True)
class Feet:
    """Ankles (T, 2, 3), what turns them and the toes (T, 2, 4), of a body of that skeleton."""

    ankles: Array
    turns: Array
    toe_turns: Array
    skeleton: Skeleton
    fps: float

    @cached_property
    def balls(self) -> Array:
        """Where the toes begin. (T, 2, 3)."""
        return np.asarray(self.ankles + rotations.rotate(self.turns, self.skeleton.offsets[BALLS]))

    @cached_property
    def soles(self) -> Array:
        """Heel, toe tip and both edges of each sole. (T, 2, 4, 3)."""
        corners = capsules.SOLE * self.skeleton.scale
        found = self.ankles[:, :, None] + rotations.rotate(self.turns[:, :, None], corners)
        tip = corners[1] - self.skeleton.offsets[BALLS]
        found[:, :, 1] = self.balls + rotations.rotate(self.toe_turns, tip)
        return np.asarray(found)

    @property
    def ground(self) -> Array:
        """Height of the lowest point of heels and balls: toes bend, and tell little of the floor. (T,)."""
        return np.asarray(self.soles[..., [0, 2, 3], 1].min(axis=(1, 2)))

    def with_bent_toes(self) -> Feet:
        """Toes that go through the floor, as those of a stiff foot that pushes off, bent up onto it.

        In the air they are raised a little more, as people do who do not want to stumble.
        """
        speed = np.linalg.norm(np.gradient(self.balls[..., [0, 2]], axis=0), axis=-1) * self.fps
        wanted = CLEARANCE * np.clip((speed - 2 * SLOW) / (4 * SLOW), 0.0, 1.0)
        tip = self.skeleton.scale * capsules.SOLE[1] - self.skeleton.offsets[BALLS[0]]
        down = rotations.rotate(self.toe_turns, tip)[..., 1]
        aside = rotations.rotate(self.toe_turns, rotations.cross(_LEFT, tip))[..., 1]
        # Turned by θ about their own X the tips are at ball + down cos θ + aside sin θ: as high as wanted for two θ.
        reach = np.hypot(down, aside)
        middle, half = np.arctan2(aside, down), np.arccos(np.clip((wanted - self.balls[..., 1]) / reach, -1.0, 1.0))
        either = rotations.wrap(np.stack([middle + half, middle - half]))
        least = np.take_along_axis(either, np.abs(either).argmin(axis=0)[None], axis=0)[0]
        through = self.balls[..., 1] + down < wanted
        turn = -no_faster(np.where(through, np.clip(-least, 0.0, MAX_TOES), 0.0), TOE_SPEED / self.fps)
        bent = rotations.compose(self.toe_turns, rotations.rotvec_to_quat(turn[..., None] * [1.0, 0.0, 0.0]))
        return replace(self, toe_turns=bent)

    def unequal(self) -> Array:
        """How far each ankle must rise for its own foot to stand on the floor, where legs differ. (2,) metres."""
        levels = np.percentile(self.soles[..., [0, 2, 3], 1].min(axis=2), 10.0, axis=0)
        beyond = np.sign(levels) * np.maximum(np.abs(levels) - EQUAL, 0.0)
        return np.asarray(-beyond if np.abs(levels).max() < MAX_UNEQUAL else np.zeros(2))

    def contacts(self) -> Array:
        """1 where planted: left ankle, left toe, right ankle, right toe. (T, 4)."""
        ankle = self.skeleton.ankle_height
        rest = np.array([ankle, ankle + self.skeleton.offsets[BALLS[0], 1]])
        points = np.stack([self.ankles, self.balls], axis=2)  # (T, side, joint, 3)
        if len(points) < 2:
            return np.ones((len(points), 4))
        speed = np.linalg.norm(np.gradient(points, axis=0), axis=-1) * self.fps
        height = points[..., 1] - rest
        sure = (height < LOW) & (speed < SLOW)
        near = (height < LOW * LINGER) & (speed < SLOW * LINGER)
        flags = [_patient(sure[:, side, joint], near[:, side, joint]) for side in range(2) for joint in range(2)]
        return np.stack(flags, axis=1).astype(np.float64)

    def skate(self) -> float:
        """Mean horizontal speed of sole corners near the floor in two neighbouring frames, cm/s; 0 if hardly any."""
        low = self.soles[..., 1] < NEAR_FLOOR
        on = low[1:] & low[:-1]
        speed = np.linalg.norm(np.diff(self.soles[..., [0, 2]], axis=0), axis=-1) * self.fps * 100
        return float(speed[on].mean()) if on.sum() >= MIN_LOW else 0.0

    def depth(self) -> float:
        """Mean depth of the lowest sole corner under the floor, metres."""
        return float(np.maximum(-self.soles[..., 1].min(axis=(1, 2)), 0.0).mean())


def _patient(sure: Flags, near: Flags) -> Flags:
    """Stretches of `near` that hold a `sure` frame, brief ones and brief gaps smoothed over. (T,)."""
    kept = np.zeros(len(sure), dtype=np.bool_)
    for start, stop in runs(near):
        kept[start:stop] = sure[start:stop].any()
    return without_brief(kept)


def without_brief(flags: Flags) -> Flags:
    """Brief gaps closed, then brief stretches dropped. (T,)."""
    kept = flags.copy()
    for start, stop in runs(~kept):
        if stop - start < BRIEF and start > 0 and stop < len(kept):
            kept[start:stop] = True
    for start, stop in runs(kept):
        if stop - start < BRIEF:
            kept[start:stop] = False
    return kept


def no_faster(values: Array, step: float) -> Array:
    """The least curve above these that rises and falls by at most `step` a frame. (T, …)."""
    found = values.copy()
    for away in range(1, int(values.max(initial=0.0) / step) + 1):
        found[away:] = np.maximum(found[away:], values[:-away] - away * step)
        found[:-away] = np.maximum(found[:-away], values[away:] - away * step)
    return found


def runs(flags: Flags) -> list[tuple[int, int]]:
    """Starts and stops (exclusive) of unbroken stretches of true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [(int(start), int(stop)) for start, stop in edges.reshape(-1, 2)]


def resting_hands(positions: Array, fps: float) -> Flags:
    """Whether left and right wrist rest: still in the world, away from where they hang. (T, 22, 3) to (T, 2)."""
    flags = []
    for side in _SIDES:
        wrist, shoulder = positions[:, INDEX[f"{side}_wrist"]], positions[:, INDEX[f"{side}_shoulder"]]
        away = np.linalg.norm((wrist - shoulder)[:, [0, 2]], axis=1) > HAND_AWAY
        speed = np.linalg.norm(np.gradient(wrist, axis=0), axis=-1) * fps if len(wrist) > 1 else np.zeros(1)
        flags.append(_patient((speed < SLOW) & away, (speed < SLOW * LINGER) & away))
    return np.stack(flags, axis=1)


def above_floor(feet: Feet) -> Array:
    """How far each ankle must rise so that no corner of its sole is under the floor. (T, 2, 3) metres."""
    lift = np.zeros_like(feet.ankles)
    lift[..., 1] = np.maximum(-feet.soles[..., 1].min(axis=2), 0.0)
    return lift


def bend_legs(skeleton: Skeleton, positions: Array, world: Array, ankles: Array) -> Array:
    """World rotations (T, 22, 4) with the ankles at (T, 2, 3), knees as hinges and feet turned as they were."""
    turned = world.copy()
    hip, knee = positions[:, HIPS], positions[:, KNEES]
    upper, lower = (float(np.linalg.norm(skeleton.offsets[joint])) for joint in (KNEES[0], ANKLES[0]))
    # A leg that is nearly straight says little about its plane: there the thigh's own front decides.
    along = rotations.normalize(positions[:, ANKLES] - hip)
    bent = (knee - hip) - np.sum((knee - hip) * along, axis=-1, keepdims=True) * along
    front = rotations.rotate(world[:, HIPS], _FRONT)
    backwards = np.minimum(np.sum(bent * front, axis=-1, keepdims=True), 0.0)
    pole = bent + (STRAIGHT - backwards) * front
    leg = inverse_kinematics.two_bone(hip, ankles, pole, (upper, lower))
    turned[:, HIPS], turned[:, KNEES] = inverse_kinematics.leg_rotations(leg)
    return turned


SHARE = 10.0
"""Percentile of the lowest points that lies on the floor: a body walks on it, and now and then scuffs it."""
CLIMB = 0.03
"""Metres that a floor must climb over a clip to be a fault of the recording."""
WINDOW = 0.45
"""Seconds in which a walking body touches the floor at least once."""
SOFT, RISE = 0.01, 0.5
"""Metres that skin gives, and metres a second at which a body is raised out of the floor."""
STEADY = 0.52
"""Share of what standing feet do that is in one direction, for a walk."""
_NOT_FEET = [index for index, body in enumerate(capsules.BODIES) if not body.name.endswith("foot")]
ON_THE_SPOT = (0.25, 0.1)
"""Metres a second: a standing foot faster than the first under a pelvis slower than the second walks on the spot."""


def lowest_skin(skeleton: Skeleton, positions: Array, world: Array) -> Array:
    """Height of the lowest point of all but the feet in each frame. (T,)."""
    starts, ends, radii = capsules.placed(skeleton, positions, world)
    bars = np.minimum(starts[..., 1], ends[..., 1]) - radii
    return np.asarray(bars[:, _NOT_FEET].min(axis=1))


def out_of_floor(lowest: Array, fps: float) -> Array:
    """How far a body must rise so that none of its skin is deep in the floor, without a jerk. (T,) metres."""
    lift = no_faster(np.maximum(-lowest - SOFT, 0.0), RISE / fps)
    return np.maximum(low_pass(lift, fps, cutoff=4.0), 0.0) if lift.any() and len(lift) > 8 else lift


def floor_under(lowest: Array, fps: float) -> Array:
    """Height of the floor in each frame: one level, or a straight climb where the recording plainly drifts. (T,)."""
    level = np.full(len(lowest), np.percentile(lowest, SHARE))
    size = round(WINDOW * fps)
    count = len(lowest) // size
    if count < 4:
        return level
    windows = lowest[: count * size].reshape(count, size)
    middles = (np.arange(count) + 0.5) * size
    lows = windows.min(axis=1)
    i, j = np.triu_indices(count, 1)
    slope = float(np.median((lows[j] - lows[i]) / (middles[j] - middles[i])))
    straight = slope * (np.arange(len(lowest)) - len(lowest) / 2)
    over = np.abs(lows - np.median(lows)).mean()
    left = np.abs(lows - slope * middles - np.median(lows - slope * middles)).mean()
    if abs(slope) * len(lowest) < CLIMB or left > 0.4 * over:
        return level
    return np.asarray(straight + np.percentile(lowest - straight, SHARE))


def always_down(lowest: Array, fps: float) -> Array:
    """The floor where a path says nothing of heights: under the lowest point of every frame, smoothly. (T,)."""
    return low_pass(lowest, fps, cutoff=5.0) if len(lowest) > 8 else lowest


def travel(feet: Feet, pelvis: Array) -> Array | None:
    """Where a walk on the spot would have come by now, from the foot that stands. (T, 3); None for other clips."""
    if len(pelvis) < 8:
        return None
    speed = np.gradient(feet.balls[..., [0, 2]], axis=0) * feet.fps
    height = feet.soles[..., 1].min(axis=2)
    # The lower foot carries the body: what it does backwards, the body does forwards.
    weight = np.exp(-np.maximum(height - height.min(axis=1, keepdims=True), 0.0) / 0.01)
    carried = -np.sum(speed * (weight / weight.sum(axis=1, keepdims=True))[..., None], axis=1)
    mean, span = carried.mean(axis=0), len(pelvis) / feet.fps
    drift = np.linalg.norm(pelvis[-1, [0, 2]] - pelvis[0, [0, 2]]) / span
    steady = np.linalg.norm(mean) > STEADY * np.linalg.norm(carried, axis=1).mean()
    if np.linalg.norm(mean) < ON_THE_SPOT[0] or drift > ON_THE_SPOT[1] or not steady:
        return None
    smooth = low_pass(carried, feet.fps, cutoff=3.0)
    path = np.zeros_like(pelvis)
    path[1:, [0, 2]] = np.cumsum((smooth[1:] + smooth[:-1]) / 2, axis=0) / feet.fps
    return path
