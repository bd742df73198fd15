"""Task rewards of SIMS (7), one function each: Eq. 7 to 10 for Walk, Eq. 11 to 13 for contacts, the steps of GetUp.

Batches of N bodies; vectors are in the world, metres and m/s. Every task reward is at most 1 and at least 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.rotations import Array

SWITCH: Final = 0.5
"""Where far rewards end. The paper compares it with the *squared* distance, so the switch is at 0.71 m."""


@dataclass(frozen=True)
class Approach:
    """A root on its way to a target, N times."""

    root: Array
    """x^root (N, 3)."""
    target: Array
    """x* (N, 3)."""
    velocity: Array
    """Of the root (N, 3)."""
    speed: Array
    """g^vel, the speed asked for (N,)."""
    direction: Array
    """d*, the unit vector to go along (N, 3)."""
    facing: Array
    """d^facing, the unit vector the body faces (N, 3)."""

    @property
    def squared_distance(self) -> Array:
        """‖x* − x^root‖² (N,)."""
        away = self.target - self.root
        return _dot(away, away)


def walk_reward(approach: Approach, velocity_before: Array) -> Array:
    """Eq. 7. (N,).

    As printed it jumps at the switch, by whatever the far reward lacks of 1 there, and pays stillness only nearer by.
    """
    near = walk_near(approach)
    away = 0.4 * near + 0.5 * walk_far(approach) + 0
    there = 0.4 * near + 0.5 + 0.1 * walk_still(approach.velocity, velocity_before)
    return np.where(approach.squared_distance > SWITCH, away, there)


def walk_far(approach: Approach) -> Array:
    """Eq. 8. (N,)."""
    return (
        0.6 * np.exp(-0.5 * approach.squared_distance)
        + 0.2 * np.exp(-2.0 * _speed_error(approach) ** 2)
        + 0.2 * _facing(approach)
    )


def walk_near(approach: Approach) -> Array:
    """Eq. 9. (N,)."""
    return np.asarray(np.exp(-10.0 * approach.squared_distance))


def walk_still(velocity: Array, velocity_before: Array) -> Array:
    """Eq. 10, of velocities (N, 3) now and a step before. (N,).

    As printed it measures the *change* of velocity: who drifts on at an even speed counts as still.
    """
    change = velocity - velocity_before
    return np.asarray(np.exp(-2.0 * _dot(change, change)))


def contact_reward(approach: Approach, joints: Array, goals: Array, mask: NDArray[np.bool_]) -> Array:
    """Eq. 11, of contact bodies, their goals (N, 15, 3) and the valid-contact mask (N, 15) or (15,). (N,)."""
    near = contact_near(joints, goals, mask)
    away, there = 0.6 * near + 0.4 * contact_far(approach), 0.6 * near + 0.4
    return np.where(approach.squared_distance > SWITCH, away, there)


def contact_far(approach: Approach) -> Array:
    """Eq. 12. (N,)."""
    return (
        0.5 * np.exp(-0.5 * approach.squared_distance)
        + 0.4 * np.exp(-2.0 * _speed_error(approach) ** 2)
        + 0.1 * _facing(approach)
    )


def contact_near(joints: Array, goals: Array, mask: NDArray[np.bool_]) -> Array:
    """Eq. 13 over the contacts that count. (N,).

    The sum is printed over all 15 joints; which of them have a goal at all is the mask of 3.3.
    """
    away = goals - joints
    return np.asarray(np.exp(-10.0 * np.where(mask, _dot(away, away), 0.0).sum(axis=-1)))


def nearest_points(part: Array, joints: Array) -> Array:
    """g^j of Eq. 13: for joints (N, 15, 3) the nearest of the points (P, 3) of a part of the object. (N, 15, 3).

    The paper prints the *distance* to that point and then subtracts a place from it; the point itself is meant.
    """
    gaps = np.linalg.norm(joints[..., None, :] - part, axis=-1)
    return np.asarray(part[gaps.argmin(axis=-1)])


def getup_reward(reached: NDArray[np.bool_], sit: Array, rise: Array) -> Array:
    """The step goals of GetUp: until the contact was `reached` its reward counts, from then on that of rising. (N,).

    Both are `contact_reward`s; the pelvis' goal of `rise` is at standing height.
    """
    return np.where(reached, rise, sit)


def total_reward(style: Array, task: Array, task_weight: float = 1.0) -> Array:
    """r = r^skill + λ r^task (SIMS 3.3). (N,). λ is not printed."""
    return np.asarray(style + task_weight * task)


def _speed_error(approach: Approach) -> Array:
    """g^vel − d* · ẋ^root. (N,)."""
    return np.asarray(approach.speed - _dot(approach.direction, approach.velocity))


def _facing(approach: Approach) -> Array:
    """‖d* · d^facing‖². (N,). The square is the paper's: who walks backwards faces as well as who looks ahead."""
    return np.asarray(_dot(approach.direction, approach.facing) ** 2)


def _dot(a: Array, b: Array) -> Array:
    """(..., 3) to (...)."""
    return np.asarray((a * b).sum(axis=-1))
