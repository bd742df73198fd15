"""How strongly the surface of a body in its T-pose hangs on each joint, by where it is, for each kind of piece.

Frame: the reference skeleton's T-pose, pelvis at the origin, facing +Z, left is +X, metres.
"""

from __future__ import annotations

import numpy as np

from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, JOINTS

Weights = dict[str, Array]
"""Shares of joints at some points, by the joint's name; those that are not named have none."""


def dense(weights: Weights, count: int) -> Array:
    """One column a joint. (V, J)."""
    table = np.zeros((count, len(JOINTS)))
    for joint, share in weights.items():
        table[:, INDEX[joint]] = share
    return table


def _rise(x: Array, middle: float, half: float) -> Array:
    """From 0 to 1, smoothly, over middle ± half."""
    t = np.clip((x - middle + half) / (2 * half), 0.0, 1.0)
    return t * t * (3 - 2 * t)


def _hand_on(weights: Weights, parent: str, child: str, share: Array) -> None:
    """Move a share of what hangs on the parent to its child."""
    weights[child] = weights[parent] * share
    weights[parent] = weights[parent] * (1 - share)


def weigh_spine(p: Array) -> Weights:
    """Pelvis, back, neck and head, by height: what has no arms."""
    y = p[:, 1]
    weights = {"pelvis": np.ones(len(p))}
    chain = (("pelvis", "spine1", 0.10), ("spine1", "spine2", 0.22), ("spine2", "spine3", 0.34))
    for parent, child, middle in chain:
        _hand_on(weights, parent, child, _rise(y, middle, 0.07))
    # The neck turns only what is near the middle: shoulders are as high as its root.
    _hand_on(weights, "spine3", "neck", _rise(y - 0.5 * np.abs(p[:, 0]), 0.53, 0.04))
    _hand_on(weights, "neck", "head", _rise(y - 0.35 * p[:, 2], 0.615, 0.035))
    return weights


def weigh_head(p: Array) -> Weights:
    """All of it on the head."""
    return {"head": np.ones(len(p))}


def weigh_shirt(p: Array) -> Weights:
    """Trunk, shoulders and arms, as far as sleeves go."""
    weights = weigh_spine(p)
    for side, x in (("left_", p[:, 0]), ("right_", -p[:, 0])):
        # The band tilts, so that the armpit stays with the chest and the top of the shoulder goes with the arm.
        outward = x + 0.55 * (p[:, 1] - 0.485)
        _hand_on(weights, "spine3", side + "collar", _rise(outward, 0.11, 0.06))
        _hand_on(weights, side + "collar", side + "shoulder", _rise(outward, 0.185, 0.05))
        _hand_on(weights, side + "shoulder", side + "elbow", _rise(x, 0.472, 0.045))
        _hand_on(weights, side + "elbow", side + "wrist", _rise(x, 0.718, 0.028))
    return weights


def weigh_arm(p: Array) -> Weights:
    """The left arm and hand."""
    weights = {"left_shoulder": np.ones(len(p))}
    _hand_on(weights, "left_shoulder", "left_elbow", _rise(p[:, 0], 0.472, 0.045))
    _hand_on(weights, "left_elbow", "left_wrist", _rise(p[:, 0], 0.718, 0.028))
    return weights


def weigh_trousers(p: Array) -> Weights:
    """Hips and legs."""
    weights = {"pelvis": np.ones(len(p))}
    _hand_on(weights, "pelvis", "spine1", _rise(p[:, 1], 0.10, 0.07))
    for side, x in (("left_", p[:, 0]), ("right_", -p[:, 0])):
        below = 0.45 * (x - 0.088) - p[:, 1]
        _hand_on(weights, "pelvis", side + "hip", _rise(below, 0.015, 0.075) * _rise(x, 0.0, 0.03))
        _hand_on(weights, side + "hip", side + "knee", _rise(-p[:, 1], 0.4165, 0.06))
    return weights


def weigh_shoe(p: Array) -> Weights:
    """The left foot."""
    weights = {"left_ankle": np.ones(len(p))}
    _hand_on(weights, "left_ankle", "left_foot", _rise(p[:, 2], 0.115, 0.025))
    return weights


def weigh_skirt(p: Array) -> Weights:
    """Hips and thighs, softly from one to the other: cloth hangs between them."""
    weights = {"pelvis": np.ones(len(p))}
    _hand_on(weights, "pelvis", "spine1", _rise(p[:, 1], 0.10, 0.07))
    below = _rise(-p[:, 1], 0.06, 0.14)
    left = _rise(p[:, 0], 0.0, 0.07)
    hung = weights["pelvis"] * below
    weights["pelvis"] = weights["pelvis"] - hung
    weights["left_hip"], weights["right_hip"] = hung * left, hung * (1 - left)
    return weights


def weigh_coat(p: Array) -> Weights:
    """A shirt above the hips, a skirt below them."""
    return _above(weigh_shirt(p), weigh_skirt(p), p)


def weigh_tunic(p: Array) -> Weights:
    """A shirt above the hips, and below them as the trousers that it lies on."""
    return _above(weigh_shirt(p), weigh_trousers(p), p)


def _above(upper: Weights, lower: Weights, p: Array) -> Weights:
    """One garment's weights above the hips, another's below."""
    share = _rise(-p[:, 1], 0.0, 0.08)
    return {
        name: upper.get(name, np.zeros(len(p))) * (1 - share) + lower.get(name, np.zeros(len(p))) * share
        for name in {**upper, **lower}
    }


def weigh_hair(p: Array) -> Weights:
    """The head's; what falls on the back stays with the back."""
    weights = {"head": np.ones(len(p))}
    _hand_on(weights, "head", "neck", _rise(-p[:, 1], -0.57, 0.05))
    _hand_on(weights, "neck", "spine3", _rise(-p[:, 1], -0.49, 0.05))
    return weights
