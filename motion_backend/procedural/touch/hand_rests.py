"""Hands that rest: on thighs, knees, head, arms of a chair, a table. Each place follows what it is on.

A `Hold` is given for a left hand in the frame of the joint it is on (metres at 1.70 m, see skeleton.py; the outlines
are the mannequin's, clothing.py), or in the world; a right hand's is its mirror image.

Where hands can lie around a seat: on armrests, on the seat itself, on a table ahead, on the floor.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from motion_backend import rotations
from motion_backend.body.scene_collision import Obstacles
from motion_backend.procedural.arm_solver import Arm
from motion_backend.procedural.held_poses import Seat
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.pose_solver import chest_frame, released, trunk_and_legs
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, SEATED_REST, Skeleton

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
    "folded": Hold("left_hip", (-0.055, -0.19, 0.085), (0.0, 0.0, 1.0), (-1.0, -0.45, 0.0), (0.8, -0.3, -0.6)),
    "folded_over": Hold("left_hip", (-0.045, -0.20, 0.122), (0.0, 0.0, 1.0), (-1.0, -0.45, 0.0), (0.8, -0.3, -0.6)),
    "clasped": Hold("left_hip", (-0.089, -0.611, 0.198), (1.0, -0.2, 0.0), (-0.2, -1.0, 0.1), (0.0, -1.0, 0.1)),
    "own_shin": Hold("left_knee", (0.042, -0.07, 0.045), (0.7, 0.0, 0.7), (-0.7, -0.15, 0.7), (0.8, -0.5, -0.3)),
    "other_shin": Hold("right_knee", (0.042, -0.13, 0.045), (0.7, 0.0, 0.7), (-0.7, -0.15, 0.7), (0.8, -0.5, -0.3)),
    "crossed_ankle": Hold("right_knee", (0.052, -0.29, 0.015), (1.0, 0.0, 0.1), (0.0, -0.3, 1.0), (0.6, -0.5, -0.6)),
    "behind_head": _on_head((0.62, 0.10, -0.78), (-1.0, 0.20, -0.5), (1.0, 0.30, 0.0)),
    "nape": _on_head((0.75, -0.25, -0.60), (-0.8, 0.6, -0.3), (1.0, -0.3, 0.55), 0.035),
    "temples": _on_head((0.95, 0.10, 0.25), (-0.25, 1.0, -0.35), (0.8, -1.0, 0.2), 0.035, 0.10),
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


Pair = tuple[Array | None, Array | None]
"""Where the left and the right palm lie, (3,) in the world each; None where nothing is there."""
TABLE_REACH = 0.74
"""How far ahead of the pelvis the near edge of a table may be for a leaning sitter (metres at 1.70 m)."""
ELBOWS = [(up, ahead) for up in (0.30, 0.45, 0.60, 0.75) for ahead in (-0.08, 0.05, 0.18)]
"""Heights above the pelvis, and distances ahead of it, at which elbows are that are not on anything (metres)."""
INSET = 0.01
"""A hand lies at least so far within the edge of a surface (metres)."""
ARMREST, TABLE = (0.08, 0.36), (0.14, 0.58)
"""Heights above the seat that armrests and tables have (metres)."""
ABOUT = (1.2, 1.0, 1.2)
"""Half the box about the pelvis in which things are looked at (metres)."""
LEVEL = 0.05
"""Above and below its seat what a sitter's hands lie on beside it (metres)."""
OVER = 0.1
"""What stands this much higher than that is above the hands (metres)."""
Grid = tuple[float, float, float]
"""From, up to and in steps of (metres)."""
WIDE: Grid = (0.26, 0.16, -0.02)
"""How far to either side of the middle hands lie beside a sitter, the widest first (at 1.70 m)."""
BEHIND, BACKREST, BEHIND_STEP, BEHIND_END = 0.24, 0.07, 0.03, -0.03
"""How far behind the pelvis (at 1.70 m), how far before the backrest, in which steps, and up to where hands lie behind
a sitter (metres)."""
EDGE, MIN_EDGE = 0.07, 0.12
"""How far within the seat's front edge hands lie, and how far before the pelvis that must be for it (metres)."""
ARMREST_AHEAD = (0.24, 0.18, 0.12, 0.06)
"""How far ahead of the pelvis a hand lies on an armrest, the farthest first (metres)."""
ARMREST_ASIDE: Grid = (0.22, 0.44, 0.02)
"""How far to the side armrests are (at 1.70 m)."""
ARMREST_STEPS = 5
"""How many such steps an armrest is wide at the most, from its inner edge."""
ELBOW_ASIDE: Grid = (0.26, 0.62, 0.02)
"""How far to the side it is looked for what elbows would be in (at 1.70 m)."""
TABLE_FROM, TABLE_STEP = 0.20, 0.02
"""How far ahead of the pelvis tables are looked for from, and in which steps (metres)."""
FOREARMS = (0.17, 0.0, -0.17)
"""To the left, where a table must be for two forearms (metres)."""
HALF_DEPTH = 5
"""Steps of half the depth that they need."""
UNEVEN = 0.01
"""A table is level whose heights differ by less (metres)."""


@dataclass(frozen=True)
class Handholds:
    """The surfaces about a sitter that palms can lie on."""

    armrests: Pair = (None, None)
    beside: Pair = (None, None)
    """On the seat, or the floor that is sat on, beside the hips."""
    behind: Pair = (None, None)
    edge: Pair = (None, None)
    """At the seat's front edge, outside the thighs."""
    table: float | None = None
    """How far ahead of the pelvis the edge of a table begins that both forearms fit on."""
    table_top: float = 0.0

    def on_table(self, seat: Seat, inwards: float, apart: float) -> Pair:
        """Both palms on the table, so far from its edge and from each other; none where there is no table."""
        if self.table is None:
            return None, None
        ahead = self.table + inwards
        left, right = (seat.to_world((side * apart / 2, self.table_top, ahead)) for side in (1, -1))
        return left, right


def handholds(seat: Seat, obstacles: Obstacles, scale: float) -> Handholds:
    """What there is about a seat for a body of that size."""
    about = np.array(ABOUT)
    near = obstacles.solid().near(seat.pelvis - about, seat.pelvis + about)
    top = float(seat.pelvis[1]) - SEATED_REST
    level = (top - LEVEL, top + LEVEL)
    rests = (top + ARMREST[0] * scale, top + ARMREST[1] * scale)
    back = -min(BEHIND * scale, max(seat.back - BACKREST, 0.0))
    wide = np.arange(*WIDE) * scale
    behind = [(side, ahead) for ahead in np.arange(back, BEHIND_END, BEHIND_STEP) for side in wide]
    edge = [(side, seat.edge - EDGE) for side in wide] if seat.edge > MIN_EDGE else []
    armrest = [(side, ahead) for ahead in ARMREST_AHEAD for side in np.arange(*ARMREST_ASIDE) * scale]
    table = table_before(seat, near, scale)
    return Handholds(
        armrests=_pair(seat, near, _middles(seat, near, armrest, rests), rests),
        beside=_pair(seat, near, [[(side, 0.0) for side in wide]] * 2, level),
        behind=_pair(seat, near, [behind] * 2, level),
        edge=_pair(seat, near, [edge] * 2, level),
        table=table[0] if table else None,
        table_top=table[1] if table else 0.0,
    )


def elbow_room(seat: Seat, near: Obstacles, scale: float) -> tuple[float, float]:
    """How far to either side of the middle something begins that is as high as elbows; infinite beyond their reach."""
    aside = np.arange(*ELBOW_ASIDE) * scale
    found = []
    for side in (1, -1):
        places = [(side * a, seat.pelvis[1] + up * scale, ahead) for a in aside for up, ahead in ELBOWS]
        depth = near.depth(seat.to_world(places)).reshape(len(aside), -1).max(axis=1)
        found.append(float(aside[np.argmax(depth > 0)]) if (depth > 0).any() else np.inf)
    return found[0], found[1]


def _pair(seat: Seat, near: Obstacles, places: list[list[tuple[float, float]]], level: tuple[float, float]) -> Pair:
    """The first of the places (to the side, ahead) on either side with a free surface at that level."""
    found: list[Array | None] = []
    for side, wanted in zip((1, -1), places, strict=True):
        points = seat.to_world(np.array([(side * lateral, 0.0, ahead) for lateral, ahead in wanted]).reshape(-1, 3))
        tops = _tops(near, points, level[1] + OVER)
        good = np.flatnonzero((tops >= level[0]) & (tops <= level[1]))
        found.append(np.array([*points[good[0], :1], tops[good[0]], *points[good[0], 2:]]) if len(good) else None)
    return found[0], found[1]


def _middles(
    seat: Seat, near: Obstacles, places: list[tuple[float, float]], level: tuple[float, float]
) -> list[list[tuple[float, float]]]:
    """For either side the middle of the armrest at the farthest of the distances ahead that it reaches."""
    chosen: list[list[tuple[float, float]]] = []
    for side in (1, -1):
        points = seat.to_world([(side * lateral, 0.0, ahead) for lateral, ahead in places])
        tops = _tops(near, points, level[1] + OVER)
        good = (tops >= level[0]) & (tops <= level[1])
        rows = [[place for place, fits in zip(places, good, strict=True) if fits and place[1] == ahead]
                for ahead in dict.fromkeys(ahead for _, ahead in places)]  # fmt: skip
        row = next((row for row in rows if row), [])
        chosen.append([(float(np.mean([lateral for lateral, _ in row[:ARMREST_STEPS]])), row[0][1])] if row else [])
    return chosen


def table_before(seat: Seat, near: Obstacles, scale: float, reach: float = TABLE_REACH) -> tuple[float, float] | None:
    """How far ahead a table's edge is, and its height; a table is level under both forearms."""
    top = float(seat.pelvis[1]) - SEATED_REST
    level = (top + TABLE[0] * scale, top + TABLE[1] * scale)
    deep = 2 * HALF_DEPTH
    ahead = np.arange(TABLE_FROM, reach * scale + (deep + 1) * TABLE_STEP, TABLE_STEP)
    points = seat.to_world([(side, 0.0, a) for a in ahead for side in FOREARMS])
    tops = _tops(near, points, level[1] + OVER).reshape(-1, len(FOREARMS))
    flat = (np.ptp(tops, axis=1) < UNEVEN) & (tops[:, 0] >= level[0]) & (tops[:, 0] <= level[1])
    fits = flat[:-deep] & flat[HALF_DEPTH:-HALF_DEPTH] & flat[deep:]
    if not fits.any():
        return None
    first = int(np.argmax(fits))
    return float(ahead[first]), float(tops[first, 0])


def _tops(near: Obstacles, points: Array, ceiling: float) -> Array:
    """Height of the highest thing at each of N places, of what begins below `ceiling`; the floor is at 0. (N,)."""
    low = near.only(near.centers[:, 1] - near.halves[:, 1] <= ceiling)
    moved = points - low.centers[:, None]
    cos, sin = np.cos(low.yaws)[:, None], np.sin(low.yaws)[:, None]
    across, along = cos * moved[..., 0] - sin * moved[..., 2], sin * moved[..., 0] + cos * moved[..., 2]
    half = low.halves[:, None] - INSET
    on = (np.abs(across) < half[..., 0]) & (np.abs(along) < half[..., 2])
    top = (low.centers[:, 1] + low.halves[:, 1])[:, None]
    return np.asarray(np.where(on, top, 0.0).max(axis=0, initial=0.0))
