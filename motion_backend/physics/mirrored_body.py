"""The simulated body in a mirror: its sides swapped, what points sideways negated. What one side learns, both know.

Everything is told in a body's own axes, +Z ahead and +Y up, so that the mirror negates x of what is a direction and y
and z of what is a turn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from motion_backend.body.capsules import BODIES
from motion_backend.physics.mjcf_character import NU, NV, SIMULATED
from motion_backend.physics.observations import HEIGHTMAP, STATE_SIZE, mirror_state
from motion_backend.physics.policies import AHEAD, EMBEDDING_SIZE, SOLES, WITH_TEXT, PolicyName
from motion_backend.rotations import Array
from motion_backend.skeleton import other_side

Kind = TypeVar("Kind", np.float32, np.float64)


@dataclass(frozen=True)
class Mirror:
    """Which of N numbers comes to each place (N,), and with which sign (N,)."""

    order: NDArray[np.int_]
    signs: Array

    def __call__(self, rows: NDArray[Kind]) -> NDArray[Kind]:
        """Numbers (..., N) as they are in the mirror."""
        return np.asarray(rows[..., self.order] * self.signs.astype(rows.dtype), rows.dtype)

    def answers(self, rows: Array, seen: Mirror) -> Array:
        """Matrices (..., N, M) by which these numbers answer to others, in the mirror."""
        return np.asarray(self(np.swapaxes(seen(rows), -1, -2)).swapaxes(-1, -2))

    @staticmethod
    def joined(parts: Sequence[Mirror]) -> Mirror:
        """Of numbers one after another."""
        starts = np.cumsum([0, *(len(part.order) for part in parts)])
        order = np.concatenate([start + part.order for start, part in zip(starts, parts, strict=False)])
        return Mirror(order, np.concatenate([part.signs for part in parts]))


ACROSS, TURNED = [-1.0, 1.0, 1.0], [1.0, -1.0, -1.0]


def _joints() -> tuple[Mirror, Mirror]:
    """Of speeds (36,) and of controls (30,)."""
    speeds = Mirror(np.arange(NV), np.concatenate([ACROSS, TURNED, np.ones(NV - 6)]))
    controls = Mirror(np.arange(NU), np.ones(NU))
    by_name = {joint.name: joint for joint in SIMULATED}
    for joint in SIMULATED:
        other, size = by_name[other_side(joint.name)], 1 if joint.axis else 3
        signs = TURNED if not joint.axis else [1.0] if joint.axis == "x" else [-1.0]
        for mirror, to, start in ((speeds, joint.qvel, other.qvel), (controls, joint.control, other.control)):
            mirror.order[to : to + size] = np.arange(start, start + size)
            mirror.signs[to : to + size] = signs
    return speeds, controls


def _same(size: int) -> Mirror:
    return Mirror(np.arange(size), np.ones(size))


SPEEDS, CONTROLS = _joints()
"""What a body is off, or how fast it goes, (36,), and its controls (30,)."""
OFF: Final = Mirror.joined([SPEEDS, SPEEDS, CONTROLS])
"""What the teacher answers to: states and held controls. (102,)."""
_FEET: Final = Mirror(np.array([2, 3, 0, 1]), np.ones(4))
PLAN: Final = Mirror.joined([OFF, *[SPEEDS] * len(AHEAD), *[_FEET] * (SOLES // 4)])
"""What is seen of a plan. (PLAN_SIZE,)."""


def _observed() -> Mirror:
    """Of all but words."""
    order = np.abs(mirror_state(np.arange(STATE_SIZE, dtype=np.float64))).astype(np.int_)
    signs = mirror_state(np.ones(STATE_SIZE)).astype(np.float64)
    names = [body.name for body in BODIES]
    swapped = np.array([names.index(other_side(name)) for name in names])
    places = Mirror((3 * swapped[:, None] + np.arange(3)).ravel(), np.tile(ACROSS, len(names)))
    mask = Mirror(swapped, np.ones(len(names)))
    size = HEIGHTMAP.size
    heights = Mirror(np.arange(size * size).reshape(size, size)[::-1].ravel(), np.ones(size * size))
    return Mirror.joined([Mirror(order, signs), CONTROLS, PLAN, heights, places, mask])


_OBSERVED: Final = _observed()


def mirrored_observation(observed: NDArray[Kind], name: PolicyName) -> NDArray[Kind]:
    """Observations (N, O) of a policy as its body in the mirror has them; words stay as they are."""
    words = EMBEDDING_SIZE if name in WITH_TEXT else 0
    return Mirror.joined([_OBSERVED, _same(words)])(observed)
