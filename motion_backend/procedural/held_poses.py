"""Poses that hold: standing and seated, from a style and the place they are held at, and the life in a held pose.

The numbers of what lives are in data/idle.toml.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from motion_backend import rotations
from motion_backend.procedural.emotion_style import Bearing, arm_arrays
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.pose_solver import chest_frame
from motion_backend.procedural.walk.footsteps import drift, home_ankle
from motion_backend.rotations import Array
from motion_backend.skeleton import ANKLE_HEIGHT, INDEX, SEATED_REST, Skeleton
from scene_graphs.affordances.affordances import Spot
from scene_graphs.data_tables import read_table, table

SHIN_REACH = 0.42
"""Seated pelvis to ankle on the floor with upright shins, at the reference height."""
BENT_LEG, LEAST_REACH = 0.80, 0.10
"""A leg between a seat and the floor is no longer, and its foot no less far ahead (metres at 1.70 m)."""
STANCE = 0.085
"""Half as far as the feet of a standing body are apart (metres at 1.70 m)."""
UNLOCKED, SUNK = 0.998, 0.004
"""How high a standing pelvis is: this share of the standing height, less so much (metres at 1.70 m)."""
FOOT_SPLAY, KNEE_SPLAY = 0.10, 0.06
"""How far outwards the feet and the knees of a standing body point (radians)."""
HIPS_LEAN, SPINE_LEAN = 0.3, 0.7
"""Shares of a standing body's lean in its hips and its spine."""
FLOOR_REACH, LOW = 0.56, 0.30
"""The same where the pelvis comes to rest lower than `LOW`: hips do not fold any further (metres at 1.70 m)."""
UP = np.array([0.0, 1.0, 0.0])
LIES = 0.5
"""A body lies whose pelvis is upright by less than this (cosine)."""
MIRROR = np.array([-1.0, 1.0, 1.0])
"""What makes a left vector, in the body's own frame, a right one."""


@table
class Shift:
    """The weight goes to another place now and then: bounds that chance keeps."""

    wait_min_s: float
    wait_max_s: float
    take_s: float
    forward_rad: float
    side_rad: float


@table
class SlidingHands:
    """Hands that rest and are not still."""

    first_min_s: float
    wait_min_s: float
    wait_max_s: float
    take_s: float
    slide_m: float
    lift_m: float


@table
class Idle:
    """data/idle.toml: the life in a held pose, of a body of usual restlessness."""

    ease_s: float
    breath_hz: float
    breath_rad: float
    """Of the chest."""
    breath_arms: float
    """How far free hands come forward with it."""
    breath_uneven_share: float
    """Of a breath: how far one comes before or after its time."""
    drift_hz: float
    quick_hz: float
    quick_share: float
    """Of what drifts: small corrections on top, so that no part ever stands."""
    spine_forward_rad: float
    spine_turn_rad: float
    spine_side_rad: float
    least_share: float
    """Of these, whatever the mood: nobody alive is a statue."""
    least_lying_share: float
    """And of who lies."""
    lying_share: float
    """Of how the trunk moves of who is up: what of it is left to who lies."""
    head_forward_rad: float
    head_turn_rad: float
    head_side_rad: float
    on_feet_above_m: float
    """A planted body with its pelvis above this stands."""
    sway_standing_m: float
    sway_m: float
    sway_down_share: float
    """Of the sway: the weight on one leg."""
    waits_usual_share: float
    """Of the times that one stands about, arms are as the mood has them; else as one of `waits`."""
    waits: tuple[tuple[str, str], ...]
    idle_arms: tuple[str, ...]
    """Where the other arm is of who does something with one hand."""
    shift: Shift
    hands: SlidingHands

    def beside(self, arms: tuple[str, str], rng: np.random.Generator) -> tuple[str, str]:
        """The same arm poses, but that one arm does not hang while the other does something."""
        if arms.count("hang") != 1:
            return arms
        left, right = (self.idle_arms[rng.integers(len(self.idle_arms))] if arm == "hang" else arm for arm in arms)
        return left, right

    def waiting(self, usual: tuple[str, str], rng: np.random.Generator) -> tuple[str, str]:
        """How arms are held by who stands about this time: names of arm poses."""
        others = [pair for pair in self.waits if pair != usual]
        return usual if rng.random() < self.waits_usual_share else others[rng.integers(len(others))]


def idle_table() -> Idle:
    """The numbers of holding still."""
    rows: Idle = read_table("motion_backend", "idle.toml", Idle)
    return rows


def upright(yaw: float, pitch: Array | float = 0.0) -> Array:
    """Pelvis rotation heading `yaw`, bent forward by `pitch` (...) radians. (..., 4)."""
    return rotations.compose(rotations.yaw_to_quat(yaw), rotations.axis_to_quat("x", np.asarray(pitch)))


def bend(forward: float, side: float = 0.0, turn: float = 0.0) -> Array:
    """A rotation vector of spine or head: forward bend, turn to the left, side bend. (3,)."""
    return np.array([forward, turn, side])


def both_sides(left: ArrayLike) -> Array:
    """A vector of the left side (outwards to the left first), and its mirror image for the right. (2, 3)."""
    vector = np.asarray(left, dtype=np.float64)
    return np.stack([vector, vector * MIRROR])


def part_way(start: Array, end: Array, share: ArrayLike) -> Array:
    """So large a share of the way from start to end; at 1 the end itself, to the last bit."""
    shares = np.asarray(share, dtype=np.float64)
    return np.where(shares == 1.0, end, start + shares * (end - start))


def standing(position: tuple[float, float], yaw: float, bearing: Bearing, skeleton: Skeleton) -> Pose:
    """Standing on both feet at [x, z]."""
    ground = np.asarray(position, dtype=np.float64)
    ankles = np.stack([home_ankle(ground, yaw, index, STANCE, skeleton) for index in (0, 1)])
    wrists, elbows = arm_arrays(*bearing.arms)
    lean = np.radians(bearing.lean)
    height = skeleton.standing_height * UNLOCKED - SUNK * skeleton.scale
    return Pose(
        pelvis=np.array([ground[0], height, ground[1]]),
        hips=upright(yaw, HIPS_LEAN * lean),
        spine=bend(SPINE_LEAN * lean),
        head=bend(np.radians(bearing.head)),
        ankles=ankles,
        feet=np.stack([rotations.yaw_to_quat(yaw + side * FOOT_SPLAY) for side in (1, -1)]),
        toes=np.zeros(2),
        knees=np.stack([_ahead(yaw + side * KNEE_SPLAY) for side in (1, -1)]),
        arms=wrists,
        elbows=elbows,
        reach=ankles + UP,
        reaching=np.zeros(2),
        palms=np.tile(rotations.IDENTITY, (2, 1)),
        pressing=np.zeros(2),
        planted=np.ones(2),
    )


def _ahead(yaw: float) -> Array:
    return np.array([np.sin(yaw), 0.0, np.cos(yaw)])


@dataclass(frozen=True)
class Seat:
    """A place to sit, as the body needs it."""

    pelvis: Array
    """(3,) where the pelvis joint rests."""
    yaw: float
    back: float
    """Distance from the pelvis to the backrest behind it."""
    edge: float = 0.0
    """Distance from the pelvis to the front edge."""

    @staticmethod
    def of(spot: Spot) -> Seat:
        """The seat of a sit spot."""
        pelvis = np.asarray(spot.point) + SEATED_REST * np.asarray(spot.normal)
        return Seat(pelvis, spot.facing, spot.back, spot.edge)

    def is_low(self, scale: float) -> bool:
        """Whether one sits on the floor, or nearly."""
        return bool(self.pelvis[1] < LOW * scale)

    def feet_ahead(self, scale: float) -> float:
        """How far ahead of the pelvis feet stand before it: shins are upright, legs that are too short for that bent
        (metres)."""
        if self.is_low(scale):
            return FLOOR_REACH * scale
        drop = float(self.pelvis[1]) / scale - ANKLE_HEIGHT
        return scale * min(SHIN_REACH, float(np.sqrt(max(BENT_LEG**2 - drop**2, LEAST_REACH**2))))

    def standing_point(self, scale: float) -> tuple[float, float]:
        """[x, z] of the pelvis standing before it, over where the feet are when seated."""
        x, _, z = self.to_world((0.0, 0.0, self.feet_ahead(scale)))
        return float(x), float(z)

    def to_world(self, left_up_ahead: ArrayLike) -> Array:
        """Points given to the sitter's left, up from the floor and ahead of the pelvis. (..., 3)."""
        left, up, ahead = np.moveaxis(np.asarray(left_up_ahead, dtype=np.float64), -1, 0)
        sin, cos = np.sin(self.yaw), np.cos(self.yaw)
        x = self.pelvis[0] + left * cos + ahead * sin
        z = self.pelvis[2] - left * sin + ahead * cos
        return np.stack([x, up, z], axis=-1)


def idle(pose: Pose, seconds: float, size: float, rng: np.random.Generator, fps: int) -> Pose:
    """Hold a single pose for a while, alive: breath, a slow shift of weight, a head that is never quite still."""
    row, frames = idle_table(), max(round(seconds * fps), 1)
    held, time = pose.repeat(frames), np.arange(1, frames + 1)
    ease = (1 - np.exp(-time / (row.ease_s * fps)))[:, None]
    slow = [_wander(frames, row, rng, fps) for _ in range(4)]
    breath = np.sin(2 * np.pi * (row.breath_hz * time / fps + rng.uniform() + row.breath_uneven_share * slow[3]))
    left = _bends_lying(pose.hips, row)
    least = row.least_share if (left == 1).all() else row.least_lying_share
    moved = (least + (1 - least) * size) * left * _bends(slow, _shifts(frames, rng, fps), row)
    moved[:, 0] += row.breath_rad * breath
    spine = held.spine + ease * moved
    nod, turn = row.head_forward_rad * size * slow[2], row.head_turn_rad * size * slow[3]
    head = held.head + ease * np.stack([nod, turn, row.head_side_rad * slow[0]], axis=1)
    on_feet = bool(pose.planted.min() > 0 and pose.pelvis[1] > row.on_feet_above_m)
    way = np.stack([slow[0], -row.sway_down_share * np.abs(slow[0]), slow[1]], axis=1)
    sway = (row.sway_standing_m if on_feet else row.sway_m) * size * ease * way
    arms = held.arms.copy()
    arms[:, :, 2] += (row.breath_arms * ease[:, 0] * breath)[:, None] * (1 - held.reaching)
    return replace(held, spine=spine, head=head, pelvis=held.pelvis + sway, arms=arms)


def _bends_lying(hips: Array, row: Idle) -> Array:
    """What is left of bends forwards, turns and bends aside: of who lies what lifts no head off its pillow. (3,)."""
    if abs(float(rotations.rotate(hips, UP)[1])) >= LIES:
        return np.ones(3)
    upright_axes = np.abs(rotations.rotate(hips, np.eye(3))[:, 1])
    return np.asarray(row.lying_share * np.maximum(upright_axes, [0.0, 1.0, 0.0]))


def alive(motion: Pose, size: float, rng: np.random.Generator, fps: int) -> Pose:
    """Frames that breathe and shift their weight as `idle` does, from none at all at both ends; hands, feet and eyes
    are where they were."""
    first, frames = motion.at(0), len(motion)
    held = idle(first, frames / fps, size, rng, fps)
    from_ends = np.minimum(np.arange(frames), np.arange(frames)[::-1]) / fps
    share = smooth(from_ends / idle_table().ease_s)[:, None]
    spine = motion.spine + share * (held.spine - first.spine)
    return replace(motion, spine=spine, pelvis=motion.pelvis + share * (held.pelvis - first.pelvis))


def _wander(frames: int, row: Idle, rng: np.random.Generator, fps: int) -> Array:
    """Slow wandering with small quick corrections on it, of unit size. (T,)."""
    return drift(frames, row.drift_hz, fps, rng) + row.quick_share * drift(frames, row.quick_hz, fps, rng)


def _bends(slow: list[Array], shift: tuple[Array, Array], row: Idle) -> Array:
    """How the trunk bends and turns while it holds, besides its breath: forwards, to the left, to the side. (T, 3)."""
    forward, side = shift
    return np.stack(
        [row.spine_forward_rad * slow[0] + forward, row.spine_turn_rad * slow[1], row.spine_side_rad * slow[2] + side],
        axis=1,
    )


def _shifts(frames: int, rng: np.random.Generator, fps: int) -> tuple[Array, Array]:
    """Where the weight is taken to now and then, forwards and aside: bends of the trunk, radians. (T,) twice."""
    row, forward, side = idle_table().shift, np.zeros(frames), np.zeros(frames)
    time, take, place = np.arange(frames), row.take_s * fps, np.zeros(2)
    at = rng.uniform(0.0, row.wait_max_s) * fps
    while at < frames:
        wanted = rng.uniform(-1.0, 1.0, 2) * [row.forward_rad, row.side_rad]
        gone = smooth((time - at) / take)
        forward, side = forward + gone * (wanted - place)[0], side + gone * (wanted - place)[1]
        place = wanted
        at += take + rng.uniform(row.wait_min_s, row.wait_max_s) * fps
    return forward, side


def shoulders(pose: Pose, skeleton: Skeleton) -> Array:
    """World positions of both shoulders. (T, 2, 3)."""
    chest, position = chest_frame(pose, skeleton)
    found = []
    for name in ("left", "right"):
        offset = skeleton.offsets[INDEX[f"{name}_collar"]] + skeleton.offsets[INDEX[f"{name}_shoulder"]]
        found.append(position + rotations.rotate(chest, offset))
    return np.stack(found, axis=1)
