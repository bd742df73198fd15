"""Between the product's 22 joints and the simulated body's numbers, both ways, and what speeds and controls they give.

A position qpos (45,) is the pelvis' place and turn, then every simulated joint: a quaternion (wxyz, MuJoCo's order) or
an angle. A velocity qvel (36,) has the pelvis' in the world, then what each joint turns by in its own frame.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.physics.mjcf_character import NQ, NU, NV, SIDES, SIMULATED
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, JOINTS

LEAD: Final = 0.1
"""Seconds by which a control runs ahead of the reference, at its speed: a damped servo lags by as much."""
SMOOTHED: Final = (0.25, 0.5, 0.25)
"""The bell that reference speeds are smoothed by, over three frames."""
_SPINE: Final = ("spine1", "spine2", "spine3")
_HEAD: Final = ("neck", "head")
_BALLS: Final = [joint for joint in SIMULATED if not joint.axis]
_HINGES: Final = [joint for joint in SIMULATED if joint.axis]
_TURNS: Final = np.array([range(first, first + 4) for first in (3, *(joint.qpos for joint in _BALLS))])
"""Where in qpos the quaternions of the pelvis, of trunk and neck, and of the other ball joints are. (9, 4)."""
_TURNED: Final = [0, *(INDEX[{"trunk": "spine1"}.get(joint.name, joint.name)] for joint in _BALLS)]
"""Whose turns they are, or the first of those who share one."""


def fold(roots: NDArray[np.floating], local: NDArray[np.floating]) -> Array:
    """Pelvis (T, 3) and local rotations (T, 22, 4) xyzw to positions (T, 45); signs are continuous in time."""
    qpos = np.zeros((len(roots), NQ))
    qpos[:, :3], qpos[:, 3:7] = roots, _wxyz(rotations.continuous(np.asarray(local[:, 0], dtype=np.float64)))
    for joint in SIMULATED:
        turn = _folded(joint.name, np.asarray(local, dtype=np.float64))
        if joint.axis:
            angle = 2 * np.arctan2(turn[:, "xyz".index(joint.axis)], turn[:, 3])
            qpos[:, joint.qpos] = rotations.wrap(angle)
        else:
            qpos[:, joint.qpos : joint.qpos + 4] = _wxyz(rotations.continuous(turn))
    return qpos


def _folded(name: str, local: Array) -> Array:
    """What the product's joints that a simulated one stands for turn together. (T, 4)."""
    side, _, kind = name.rpartition("_")
    chains = {"trunk": _SPINE, "neck": _HEAD, "shoulder": (f"{side}_collar", name), "toe": (f"{side}_foot",)}
    chain = chains.get(kind, (name,))
    turn = local[:, INDEX[chain[0]]]
    for joint in chain[1:]:
        turn = rotations.compose(turn, local[:, INDEX[joint]])
    return turn


def unfold(qpos: Array, wrists: Array) -> tuple[Array, Array]:
    """Positions (T, 45) to pelvis (T, 3) and local rotations (T, 22, 4); wrists (T, 2, 4) are the plan's, since they
    are rigid in the simulated body. A trunk's turn is shared evenly by three joints, a neck's by two."""
    local = np.tile(rotations.IDENTITY, (len(qpos), len(JOINTS), 1))
    turns = _xyzw(qpos[:, _TURNS])
    local[:, _TURNED] = turns
    for shared, turn in ((_SPINE, turns[:, 1]), (_HEAD, turns[:, 2])):
        part = rotations.rotvec_to_quat(rotations.quat_to_rotvec(turn) / len(shared))
        local[:, [INDEX[own] for own in shared]] = part[:, None]
    for axis in "xy":
        hinges = [joint for joint in _HINGES if joint.axis == axis]
        own = [INDEX[joint.name.replace("toe", "foot")] for joint in hinges]
        local[:, own] = rotations.axis_to_quat(axis, qpos[:, [joint.qpos for joint in hinges]])
    for place, (side, _) in enumerate(SIDES):
        local[:, INDEX[f"{side}_wrist"]] = wrists[:, place]
    return qpos[:, :3].copy(), local


def speeds(qpos: Array) -> Array:
    """Velocities (T, 36) of a reference at 30 frames a second: differences over two frames, smoothed."""
    later, earlier = np.minimum(np.arange(len(qpos)) + 1, len(qpos) - 1), np.maximum(np.arange(len(qpos)) - 1, 0)
    seconds = np.maximum(later - earlier, 1)[:, None] / FPS
    qvel = np.zeros((len(qpos), NV))
    qvel[:, :3] = (qpos[later, :3] - qpos[earlier, :3]) / seconds
    for place, speed, ball in _slots():
        if ball:
            turn = rotations.compose(
                rotations.inverse(_xyzw(qpos[earlier, place : place + 4])), _xyzw(qpos[later, place : place + 4])
            )
            qvel[:, speed : speed + 3] = rotations.quat_to_rotvec(turn) / seconds
        else:
            qvel[:, speed] = (qpos[later, place] - qpos[earlier, place]) / seconds[:, 0]
    padded = np.pad(qvel, ((1, 1), (0, 0)), "edge")
    return sum((weight * padded[late : late + len(qvel)] for late, weight in enumerate(SMOOTHED)), np.zeros_like(qvel))


def controls(qpos: Array, qvel: Array) -> Array:
    """What the servos are told to follow a reference: its joints' exponential maps, led by its speed. (T, 30)."""
    found = np.zeros((len(qpos), NU))
    for joint in _HINGES:
        found[:, joint.control] = qpos[:, joint.qpos] + LEAD * qvel[:, joint.qvel]
    for joint in _BALLS:
        led = rotations.rotvec_to_quat(LEAD * qvel[:, joint.qvel : joint.qvel + 3])
        turn = _xyzw(qpos[:, joint.qpos : joint.qpos + 4])
        target = rotations.quat_to_rotvec(rotations.compose(turn, led))
        found[:, joint.control : joint.control + 3] = _nearest_map(target, rotations.quat_to_rotvec(turn))
    return found


def _nearest_map(turn: Array, other: Array) -> Array:
    """A rotation vector (T, 3), written the longer way round where that is nearer to another: servos know no circle."""
    angle = rotations.length(turn)
    longer = turn * (1 - 2 * np.pi / np.maximum(angle, 1e-9))
    nearer = rotations.length(longer - other) < rotations.length(turn - other)
    return np.where(nearer, longer, turn)


def _slots() -> Iterator[tuple[int, int, bool]]:
    """Where in qpos and qvel everything that turns is, and whether it is a ball."""
    yield 3, 3, True
    for joint in SIMULATED:
        yield joint.qpos, joint.qvel, not joint.axis


def _wxyz(turn: Array) -> Array:
    return np.concatenate([turn[..., 3:], turn[..., :3]], axis=-1)


def _xyzw(turn: Array) -> Array:
    return rotations.normalize(np.concatenate([turn[..., 1:], turn[..., :1]], axis=-1))
