"""Whether a body got where it was to get, how near, how soon and for how long (SIMS 4.3, metrics of UniHSI)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Action, Skill
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

THRESHOLDS = {Skill.SITDOWN: 0.20, Skill.TOUCH: 0.20, Skill.LIEDOWN: 0.30}
HAND_OVER = 0.30
STRICT = 0.10
"""What is near enough for strict success, whatever the skill (metres)."""
PASSES = 0.5
"""A walk that goes on to somewhere else has gone at most so far since it was nearest to its goal (metres of the pelvis'
way): it goes over into the next where feet change, within half a step."""
SUSTAINED = 1.0
RISEN = (0.85, np.cos(np.radians(30)), 0.1)
"""Share of the standing height, cosine of the trunk's tilt and seconds that count as having risen."""


@dataclass(frozen=True)
class Outcome:
    """What became of one trial; none of it is true of a body that gave up."""

    reached: bool
    """Sustained: without a break for one second (a walk: at its end; rising: for a tenth)."""
    reached_any: bool
    """In any frame (SIMS' own rule)."""
    reached_strict: bool
    """Sustained within 10 cm."""
    error: float | None
    """Metres from joint to goal: the smallest in the last second of the contact; of a hand that held for a second
    within 10 cm, of that hold. None where nothing is touched."""
    mean_error: float | None
    """The mean of the same over the hold, the longest time within 10 cm. None where nothing is touched."""
    seconds: float | None
    """Until the threshold was first met; None if never."""


def outcome(action: Action, body: Kinematics) -> Outcome:
    """How a trial of one action went."""
    motion = body.motion
    if action.skill in THRESHOLDS:
        return _contact(action, body) if motion.goals else _FAILED
    if action.skill is not Skill.LOCO:
        up = risen(body)
        start, stop = longest_run(up)
        held = bool(up[-1] and stop - start >= RISEN[2] * motion.fps)
        return _if_completed(body, Outcome(held, bool(up.any()), held, None, None, _first(up, motion.fps)))
    if action.goal is None:
        done = motion.completed
        return Outcome(done, done, done, None, None, motion.duration if done else None)
    gap = np.hypot(*(body.positions[:, 0, [0, 2]] - np.asarray(action.goal)).T)
    near = gap <= HAND_OVER
    # Who walks on passes by.
    gone = np.linalg.norm(np.diff(body.positions[:, 0, [0, 2]], axis=0), axis=1)
    since = np.concatenate([np.cumsum(gone[::-1])[::-1], [0.0]])
    end = gap[since <= PASSES].min()
    found = Outcome(bool(end <= HAND_OVER), bool(near.any()), bool(end <= STRICT), None, None, _first(near, motion.fps))
    return _if_completed(body, found)


_FAILED = Outcome(False, False, False, None, None, None)


def _contact(action: Action, body: Kinematics) -> Outcome:
    fps = body.motion.fps
    distance = contact_distance(body)
    within = distance <= THRESHOLDS[action.skill]
    start, stop = longest_run(within)
    closest, farthest = longest_run(distance <= STRICT)
    strict = farthest - closest >= SUSTAINED * fps
    # Who sits or lies stays, and is judged by where that ends; a hand has been where it held, and then goes back.
    end = farthest if action.skill is Skill.TOUCH and strict else stop if stop > start else len(distance)
    last = distance[max(end - round(SUSTAINED * fps), 0) : end]
    found = Outcome(
        reached=stop - start >= SUSTAINED * fps,
        reached_any=bool(within.any()),
        reached_strict=strict,
        error=float(last.min()),
        mean_error=_over_hold(distance, fps),
        seconds=_first(within, fps),
    )
    return _if_completed(body, found)


def _over_hold(distance: Array, fps: int) -> float:
    """The mean of distances over the hold: the longest time within 10 cm without a break, but at least the second in
    which they are smallest."""
    start, stop = longest_run(distance <= STRICT)
    frames = min(round(SUSTAINED * fps), len(distance))
    if stop - start >= frames:
        return float(distance[start:stop].mean())
    sums = np.cumsum(np.concatenate([[0.0], distance]))
    return float((sums[frames:] - sums[:-frames]).min() / frames)


def _if_completed(body: Kinematics, found: Outcome) -> Outcome:
    return found if body.motion.completed else Outcome(False, False, False, found.error, found.mean_error, None)


def _first(flags: NDArray[np.bool_], fps: int) -> float | None:
    return float(flags.argmax()) / fps if flags.any() else None


def contact_distance(body: Kinematics) -> Array:
    """Largest distance over the goals of a motion between joint and goal. (T,)."""
    gaps = [
        np.linalg.norm(body.positions[:, INDEX[goal.joint]] - np.asarray(goal.position), axis=1)
        for goal in body.motion.goals
    ]
    return np.asarray(np.max(gaps, axis=0))


def longest_run(flags: NDArray[np.bool_]) -> tuple[int, int]:
    """Start and stop (exclusive) of the longest unbroken run of true; the later of equals; (0, 0) if none."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    runs = edges.reshape(-1, 2)
    if not len(runs):
        return 0, 0
    lengths = runs[:, 1] - runs[:, 0]
    best = len(runs) - 1 - int(np.argmax(lengths[::-1]))
    return int(runs[best, 0]), int(runs[best, 1])


def risen(body: Kinematics) -> NDArray[np.bool_]:
    """Frames in which the body stands: pelvis high and trunk upright. (T,)."""
    high = body.positions[:, 0, 1] >= RISEN[0] * body.motion.skeleton.standing_height
    trunk = rotations.normalize(body.positions[:, INDEX["neck"]] - body.positions[:, 0])
    return np.asarray(high & (trunk[:, 1] >= RISEN[1]))
