"""Hands that rest: on thighs, knees, head, arms of a chair, a table. Each place follows what it is on.

A `Hold` is given for a left hand in the frame of the joint it is on (metres at 1.70 m, see skeleton.py; the outlines
are the mannequin's, clothing.py), or in the world; a right hand's is its mirror image.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.arm_solver import Arm
from motion_backend.procedural.held_poses import idle_table
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.pose_solver import chest_frame, released, trunk_and_legs
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

Vector = tuple[float, float, float]
PALM, FINGERS = 0.075, 0.13
"""Wrist to the middle of the palm, and to the middle of the fingers (metres at 1.70 m)."""
ASIDE, BEND = np.radians(20), np.radians(65)
"""How far a hand is turned aside against its forearm, and bent to or fro, at most."""
PASSES = 4
"""Where the hand is turns the forearm, which turns the hand: so often."""
FREE_FROM, FREE_WITHIN = 0.3, 0.3
"""A forearm with less of itself along the skin leaves the hand free to turn; one with so much more does not (sines)."""
STEEP_FROM, STEEP_WITHIN = 0.75, 0.2
"""The back of a hand turns with a forearm that stands steeper on the skin than this, wholly with one so much steeper
(cosines)."""
TIP = 0.16
"""Wrist to the tips of the fingers (metres at 1.70 m)."""
BETWEEN = -0.03
"""A hand that is farther in than this on its thigh lies on the other one, or between them (metres at 1.70 m)."""
ON_SKIN, ON_THINGS = 0.030, 0.042
"""Wrist above what the palm lies on: bodies give way under the fingers, furniture does not."""


@dataclass(frozen=True)
class Hold:
    """Where a hand lies."""

    part: str
    """The joint whose frame it is given in, named for a left hand (`right_knee` is the other knee); "" is the world."""
    palm: Vector
    """The place on the skin under the middle of the palm."""
    normal: Vector
    """Out of the skin there."""
    fingers: Vector
    elbow: Vector
    """Where the elbow points, in the chest frame."""
    gap: float = ON_SKIN
    along: float = PALM
    """From the wrist to the part of the hand that lies there."""


BACK: Vector = (0.4, 0.0, -1.0)
"""Where the elbow of a hand points that lies close beside the hips: out to the side it turns the hand into them."""
Holds = tuple[Hold | None, Hold | None]
"""What the left and the right hand lie on."""
_HEAD, _SKULL = np.array([0.0, 0.065, -0.010]), np.array([0.082, 0.100, 0.098])


def _on_head(direction: Vector, fingers: Vector, elbow: Vector, gap: float = ON_SKIN, along: float = PALM) -> Hold:
    """A hand on the head, in that direction from its middle."""
    way = np.asarray(direction) / np.linalg.norm(direction)
    skin = _HEAD + way / np.linalg.norm(way / _SKULL)
    x, y, z = (float(v) for v in skin)
    u, v, w = (float(v) for v in (skin - _HEAD) / _SKULL**2)
    return Hold("head", (x, y, z), (u, v, w), fingers, elbow, gap, along)


HOLDS: dict[str, Hold] = {
    "thighs": Hold("left_hip", (0.005, -0.27, 0.074), (0.05, 0.0, 1.0), (-0.2, -1.0, 0.0), (0.55, -0.3, -0.8)),
    "knees": Hold("left_hip", (0.005, -0.375, 0.066), (0.05, -0.2, 1.0), (-0.1, -1.0, -0.2), (0.6, -0.5, -0.5)),
    "lap": Hold("left_hip", (-0.04, -0.245, 0.074), (0.05, 0.0, 1.0), (-0.25, -1.0, 0.0), (0.7, -0.4, -0.7), 0.085),
    "folded": Hold("left_hip", (-0.060, -0.19, 0.085), (0.0, 0.0, 1.0), (-1.0, -0.45, 0.0), (0.8, -0.3, -0.6)),
    "folded_over": Hold("left_hip", (-0.050, -0.20, 0.122), (0.0, 0.0, 1.0), (-1.0, -0.45, 0.0), (0.8, -0.3, -0.6)),
    "clasped": Hold("left_hip", (-0.089, -0.611, 0.198), (1.0, -0.2, 0.0), (-0.2, -1.0, 0.1), (0.0, -1.0, 0.1)),
    "own_shin": Hold("left_knee", (0.042, -0.07, 0.045), (0.7, 0.0, 0.7), (-0.7, -0.15, 0.7), (0.8, -0.5, -0.3)),
    "ankle": Hold("left_knee", (0.02, -0.34, 0.055), (0.3, 0.0, 1.0), (-0.2, -1.0, 0.2), (0.8, -0.2, 0.6)),
    "other_shin": Hold("right_knee", (0.042, -0.13, 0.045), (0.7, 0.0, 0.7), (-0.7, -0.15, 0.7), (0.8, -0.5, -0.3)),
    "crossed_ankle": Hold("right_knee", (0.052, -0.29, 0.015), (1.0, 0.0, 0.1), (0.0, -0.3, 1.0), (0.6, -0.5, -0.6)),
    "behind_head": _on_head((0.62, 0.10, -0.78), (-1.0, 0.20, -0.5), (1.0, 0.30, 0.0)),
    "nape": _on_head((0.75, -0.25, -0.60), (-0.8, 0.6, -0.3), (1.0, -0.3, 0.55), 0.035),
    "temples": _on_head((0.90, -0.05, 0.45), (-0.25, 1.0, -0.35), (0.5, -1.0, 0.2), 0.022, 0.09),
    "forehead": _on_head((0.55, 0.05, 0.80), (-0.30, 1.0, 0.0), (0.5, -1.0, 0.3)),
    "ears": _on_head((1.0, -0.20, 0.0), (-0.15, 0.85, -0.55), (1.0, -1.0, 0.3), 0.040, 0.11),
    "phone": _on_head((1.0, -0.25, 0.05), (-0.25, 0.75, -0.6), (0.35, -1.0, 0.1), 0.045, FINGERS),
    "chin": Hold("head", (0.030, -0.045, 0.080), (0.55, -0.15, 0.80), (-0.45, 0.85, 0.3), (1.2, -1.0, 1.0), 0.025, 0.1),
}  # fmt: skip
"""Rests on the body, by name."""


def on_thing(point: Array, yaw: float, fingers: float, elbow: Vector) -> Hold:
    """A hand flat on a piece of furniture or the floor: `fingers` is their yaw against the body's, outwards positive
    for a left hand."""
    way = yaw + fingers
    x, y, z = (float(v) for v in point)
    return Hold("", (x, y, z), (0.0, 1.0, 0.0), (float(np.sin(way)), 0.0, float(np.cos(way))), elbow, ON_THINGS)


def hold_of(name: str) -> Hold | None:
    """The rest of that name; None where arms are only held."""
    return HOLDS.get(name)


def lay_hands(pose: Pose, holds: Holds, skeleton: Skeleton) -> Pose:
    """Point `reach` and `palms` of T frames at what the hands lie on, wherever the body has taken it."""
    if holds == (None, None):
        return pose
    positions, world = _joints(pose, holds, skeleton)
    chest = chest_frame(pose, skeleton)
    reach, palms = pose.reach.copy(), pose.palms.copy()
    for index, hold in enumerate(holds):
        if hold is None:
            continue
        skin, normal, fingers = _in_world(hold, index, positions, world, skeleton.scale)
        wanted, rise = fingers, hold.gap * np.ones((len(pose), 1))
        for _ in range(PASSES):
            reach[:, index] = skin + skeleton.scale * (rise * normal - hold.along * fingers)
            arm = Arm.of(replace(pose, reach=reach), skeleton, index, chest).limb
            fingers = _along_forearm(wanted, normal, arm.lower)
            hand, back = _tipped(fingers, normal, arm.lower)
            # A hand that is tipped stands on its fingers.
            tipped = hold.gap + TIP * np.maximum(-np.sum(hand * normal, axis=1, keepdims=True), 0.0)
            rise = 0.5 * (rise + tipped)
        x = (1.0, -1.0)[index] * hand
        palms[:, index] = rotations.basis_to_quat(x, back, rotations.cross(x, back))
    return replace(pose, reach=reach, palms=palms)


def follow(pose: Pose, rest: Pose, holds: Holds, skeleton: Skeleton) -> Pose:
    """T frames whose hands stay on what they lie on in the single pose `rest`: on furniture where they are there, on
    the body wherever it goes."""
    reach, palms = pose.reach.copy(), pose.palms.copy()
    for index, hold in enumerate(holds):
        if hold is not None:
            reach[:, index], palms[:, index] = rest.reach[index], rest.palms[index]
    left, right = (hold if hold is not None and hold.part else None for hold in holds)
    return lay_hands(replace(pose, reach=reach, palms=palms), (left, right), skeleton)


def sliding(pose: Pose, holds: Holds, rng: np.random.Generator, restless: float) -> Pose:
    """T frames whose hands slide on their own thighs, where they lie there, now and then, and back at the end."""
    row, frames = idle_table().hands, len(pose)
    reach = pose.reach.copy()
    for index, hold in enumerate(holds):
        if hold is None or hold.part != "left_hip" or hold.palm[0] < BETWEEN:
            continue
        turn, time = pose.palms[:, index], np.arange(frames) / FPS
        slid, lifted, place = np.zeros(frames), np.zeros(frames), 0.0
        at = rng.uniform(row.first_min_s, row.wait_max_s) / restless
        while at + row.take_s < frames / FPS:
            wanted, share = rng.uniform(-row.slide_m, row.slide_m), smooth((time - at) / row.take_s)
            slid, lifted = slid + share * (wanted - place), lifted + 4 * row.lift_m * share * (1 - share)
            place, at = wanted, at + row.take_s + rng.uniform(row.wait_min_s, row.wait_max_s) / restless
        slid *= smooth((time[-1] - time) / row.take_s)
        way = np.stack([(1.0, -1.0)[index] * slid, lifted, np.zeros(frames)], axis=1)
        reach[:, index] += rotations.rotate(turn, way)
    return replace(pose, reach=reach)


def _joints(pose: Pose, holds: Holds, skeleton: Skeleton) -> tuple[Array, Array]:
    """World positions (T, 22, 3) and rotations (T, 22, 4) of trunk and legs; zeros where no hand lies on them."""
    if not any(hold is not None and hold.part for hold in holds):
        return np.zeros((len(pose), len(INDEX), 3)), np.zeros((len(pose), len(INDEX), 4))
    positions, world = skeleton.forward_kinematics(pose.pelvis, trunk_and_legs(pose, skeleton))
    return positions.astype(np.float64), world


def _in_world(hold: Hold, index: int, positions: Array, world: Array, scale: float) -> tuple[Array, Array, Array]:
    """The place on the skin, the way out of it and the way of the fingers along it. (T, 3) each."""
    mirror = np.array([-1.0, 1.0, 1.0]) if index and hold.part else np.ones(3)
    normal = rotations.normalize(np.asarray(hold.normal)) * mirror
    fingers = np.asarray(hold.fingers) * mirror
    fingers = rotations.normalize(fingers - (fingers @ normal) * normal)
    frames = len(positions)
    if not hold.part:
        return np.tile(hold.palm, (frames, 1)), np.tile(normal, (frames, 1)), np.tile(fingers, (frames, 1))
    joint = INDEX[_mirrored(hold.part) if index else hold.part]
    turn = world[:, joint]
    skin = positions[:, joint] + rotations.rotate(turn, np.asarray(hold.palm) * mirror * scale)
    return skin, rotations.rotate(turn, normal), rotations.rotate(turn, fingers)


def _along_forearm(fingers: Array, normal: Array, forearm: Array) -> Array:
    """Fingers turned on the skin until they are no farther than `ASIDE` from the way of the forearm. (T, 3)."""
    flat = forearm - np.sum(forearm * normal, axis=1, keepdims=True) * normal
    size = np.linalg.norm(flat, axis=1)
    flat = rotations.normalize(flat)
    turned = np.arctan2(np.sum(rotations.cross(flat, fingers) * normal, axis=1), np.sum(flat * fingers, axis=1))
    kept = np.clip(turned, -ASIDE, ASIDE)
    # A forearm that stands upright on the skin leaves the hand free to lie any way.
    angle = (kept + (1 - smooth((size - FREE_FROM) / FREE_WITHIN)) * (turned - kept))[:, None]
    return np.asarray(flat * np.cos(angle) + rotations.cross(normal, flat) * np.sin(angle))


def _tipped(fingers: Array, normal: Array, forearm: Array) -> tuple[Array, Array]:
    """The hand's own axes (fingers and back, (T, 3) each) where a wrist cannot bend enough to lay it flat: fingers are
    turned towards the forearm's way until the bend is `BEND`, and the back into the plane of both."""
    along = np.sum(fingers * forearm, axis=1, keepdims=True)
    aside = rotations.normalize(fingers - along * forearm)
    bent = np.minimum(np.arccos(np.clip(along, -1.0, 1.0)), BEND)
    hand = np.cos(bent) * forearm + np.sin(bent) * aside
    into = np.sum(forearm * normal, axis=1, keepdims=True)
    over = np.sign(into) * rotations.normalize(forearm - np.sum(forearm * hand, axis=1, keepdims=True) * hand)
    upright = smooth((np.abs(into) - STEEP_FROM) / STEEP_WITHIN)
    back = upright * over + (1 - upright) * normal
    return hand, rotations.normalize(back - np.sum(back * hand, axis=1, keepdims=True) * hand)


def _mirrored(joint: str) -> str:
    if joint.startswith("left_"):
        return "right_" + joint[5:]
    return "left_" + joint[6:] if joint.startswith("right_") else joint


def at_rest(pose: Pose, holds: Holds, skeleton: Skeleton) -> Pose:
    """The same single pose with its hands on what they lie on, its arms as they then are against the chest."""
    laid = np.array([0.0 if hold is None else 1.0 for hold in holds])
    elbows = pose.elbows.copy()
    for index, hold in enumerate(holds):
        if hold is not None:
            elbows[index] = np.asarray(hold.elbow) * [1.0 if index == 0 else -1.0, 1.0, 1.0]
    one = replace(pose, elbows=elbows, reaching=laid, pressing=laid)
    one = lay_hands(one.repeat(1), holds, skeleton).at(0)
    return replace(one, arms=np.where(laid[:, None] > 0, released(one, skeleton).arms, pose.arms))
