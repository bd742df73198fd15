"""The hands of a moving body, and where a grip puts a prop between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.motion import Motion
from motion_backend.props.prop_table import Direction, Grip, prop_table
from motion_backend.rotations import Array
from motion_backend.skeleton import ARM_LENGTH, INDEX

PALM: Final = (0.075, 0.02)
"""From the wrist to the middle of the palm, along the fingers and out of the hand (metres at 1.70 m)."""
EYES, MOUTH, JAW = (0.0, 0.085, 0.09), (0.0, 0.015, 0.10), (0.0, 0.85, -0.53)
SKULL: Final = (0.0, 0.065, -0.01)
"""In the head's frame: places (metres at 1.70 m), and the way from the chin past the ear."""
LIPS: Final = (0.0, 0.012, 0.112)
"""Where a rim is that is drunk from, in the head's frame (metres at 1.70 m)."""
UP: Final = np.array([0.0, 1.0, 0.0])
TIPS: Final = (0.30, 0.16)
"""Metres between palm and mouth (at 1.70 m) from which on what is drunk from is tipped, and from which on wholly."""
TO_LIPS: Final = 0.08
"""How far it may slip in the hand for its rim to be at the lips (metres)."""
LEFT, AHEAD = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
_SIDES: Final = ("left", "right")


@dataclass(frozen=True)
class Hands:
    """Wrists, palms, chest and head of a motion of T frames."""

    fps: int
    scale: float
    """Of the body, against 1.70 m."""
    wrists: Array
    """(T, 2, 3) from the shoulder in the chest's frame, arm lengths: to the left, up, ahead."""
    palms: Array
    """(T, 2, 3) the middle of each palm in the world."""
    wrists_at: Array
    """(T, 2, 3) of each wrist."""
    turns: Array
    """(T, 2, 4) of the wrists."""
    chest: Array
    """(T, 4)."""
    head: Array
    """(T, 4)."""
    head_at: Array
    """(T, 3)."""

    @staticmethod
    def of(motion: Motion) -> Hands:
        """Those of a motion."""
        skeleton = motion.skeleton
        places, world = skeleton.forward_kinematics(motion.root_positions, motion.local_rotations)
        positions = places.astype(np.float64)
        wrists, shoulders = ([INDEX[f"{side}_{joint}"] for side in _SIDES] for joint in ("wrist", "shoulder"))
        chest, turns = world[:, INDEX["spine3"]], world[:, wrists]
        lifted = rotations.rotate(rotations.inverse(chest)[:, None], positions[:, wrists] - positions[:, shoulders])
        along, out = (value * skeleton.scale for value in PALM)
        middles = np.array([[along, -out, 0.0], [-along, -out, 0.0]])
        return Hands(
            fps=motion.fps,
            scale=skeleton.scale,
            wrists=lifted / (ARM_LENGTH * skeleton.scale),
            wrists_at=positions[:, wrists],
            palms=positions[:, wrists] + rotations.rotate(turns, middles),
            turns=turns,
            chest=chest,
            head=world[:, INDEX["head"]],
            head_at=positions[:, INDEX["head"]],
        )

    def placed(self, grip: Grip, start: int, stop: int) -> tuple[Array, Array, float]:
        """Where a prop is in frames start to stop: positions (N, 3), turns (N, 4), and its size against the table's."""
        part = self._part(start, stop)
        both = grip.hand == "both"
        origin = part.palms.mean(axis=1) if both else part.palms[:, _SIDES.index(grip.hand)]
        along, front = (part.direction(name, grip, origin) for name in (grip.along, grip.front))
        turns = rotations.compose(_framed(along, front, grip.keeps == "front"), euler_to_quat(grip.turned_deg))
        # What both hands hold apart is as large as whoever holds it.
        size = self.scale if both else 1.0
        tipped = prop_table().tipped.get(grip.prop)
        tips = None if tipped is None or both else part.tipping(tipped.deg, origin)
        turns = turns if tips is None else rotations.compose(tips, turns)
        positions = origin + rotations.rotate(turns, size * np.array(grip.offset_m))
        if tips is not None and tipped is not None:
            positions = positions + part.to_lips(positions, turns, tips, (tipped.rim_m, tipped.wide_m), origin)
        if grip.stands:
            way = rotations.rotate(turns, UP)
            positions = positions - way * (positions[:, 1:2] / np.maximum(way[:, 1:2], 0.3))
        if grip.still:
            positions = np.tile(np.median(positions, axis=0), (len(positions), 1))
            turns = np.tile(turns[len(turns) // 2], (len(turns), 1))
        return positions, rotations.continuous(turns), size

    def _part(self, start: int, stop: int) -> Hands:
        cut = slice(start, stop)
        arrays = (self.wrists, self.palms, self.wrists_at, self.turns, self.chest, self.head, self.head_at)
        return Hands(self.fps, self.scale, *(array[cut] for array in arrays))

    def tipping(self, degrees: float, palm: Array) -> Array:
        """Turns of what is drunk from to the face, the farther the nearer a palm (T, 3) is to the mouth. (T, 4)."""
        return rotations.rotvec_to_quat(np.radians(degrees) * self._near(palm)[:, None] * self._tip_axis())

    def to_lips(self, positions: Array, turns: Array, tips: Array, rim: tuple[float, float], palm: Array) -> Array:
        """How far what is drunk from moves until its rim, so high and so wide, is at the lips. (T, 3)."""
        high, wide = rim
        nearest = rotations.rotate(tips, rotations.cross(self._tip_axis(), UP[None]))
        lip = positions + rotations.rotate(turns, high * UP) + wide * nearest
        gap = self._in_head(LIPS) - lip
        far = np.maximum(np.linalg.norm(gap, axis=1, keepdims=True), 1e-9)
        return np.asarray(self._near(palm)[:, None] * gap * np.minimum(1.0, TO_LIPS / far))

    def _tip_axis(self) -> Array:
        """About which what stands upright tips towards the face. (T, 3)."""
        back = rotations.rotate(self.head, -AHEAD) * [1.0, 0.0, 1.0]
        return rotations.normalize(rotations.cross(UP[None], back))

    def _near(self, palm: Array) -> Array:
        """How near palms (T, 3) are to the mouth, 0 to 1. (T,)."""
        far, close = TIPS
        away = np.linalg.norm(palm - self._in_head(MOUTH), axis=1) / self.scale
        share = np.clip((far - away) / (far - close), 0.0, 1.0)
        return np.asarray(share * share * (3 - 2 * share))

    def direction(self, name: Direction, grip: Grip, origin: Array) -> Array:
        """Unit vectors of a direction in the world, of things at an origin (T, 3). (T, 3)."""
        match name:
            case "up" | "down":
                found = np.tile(UP if name == "up" else -UP, (len(origin), 1))
            case "ahead" | "left" | "trunk":
                found = rotations.rotate(self.chest, {"ahead": AHEAD, "left": LEFT, "trunk": UP}[name])
            case "across":
                found = self.palms[:, 0] - self.palms[:, 1]
            case "fingers" | "palm" | "thumb":
                found = self._of_hand(name, grip)
            case "jaw" | "crown" | "nose":
                found = rotations.rotate(self.head, {"jaw": np.array(JAW), "crown": UP, "nose": AHEAD}[name])
            case "inward":
                found = rotations.rotate(self.head, -LEFT if grip.hand == "left" else LEFT)
            case _:
                found = self._in_head({"face": EYES, "mouth": MOUTH, "scalp": SKULL}[name]) - origin
        return rotations.normalize(found)

    def _in_head(self, place: tuple[float, float, float]) -> Array:
        return self.head_at + rotations.rotate(self.head, self.scale * np.array(place))

    def _of_hand(self, name: str, grip: Grip) -> Array:
        """A hand's own direction, or that of both in the middle. (T, 3)."""
        own = {"fingers": [LEFT, -LEFT], "palm": [-UP, -UP], "thumb": [AHEAD, AHEAD]}[name]
        both = rotations.rotate(self.turns, np.array(own))  # (T, 2, 3)
        return both.mean(axis=1) if grip.hand == "both" else both[:, _SIDES.index(grip.hand)]


def euler_to_quat(degrees: tuple[float, float, float]) -> Array:
    """Turns about x, then y, then z, as one. (4,)."""
    x, y, z = (rotations.axis_to_quat(axis, np.radians(angle)) for axis, angle in zip("xyz", degrees, strict=True))
    return rotations.compose(z, rotations.compose(y, x))


def _framed(along: Array, front: Array, keeps_front: bool) -> Array:
    """Frames whose y is `along` and whose z is `front`, one of them only nearly. (T, 4)."""
    first, second = (front, along) if keeps_front else (along, front)
    second = second - np.sum(first * second, axis=1, keepdims=True) * first
    # Two directions that fall together leave it open which way round it is.
    helper = np.where(np.abs(first[:, :1]) < 0.8, LEFT, AHEAD)
    spare = helper - np.sum(first * helper, axis=1, keepdims=True) * first
    second = rotations.normalize(np.where(np.linalg.norm(second, axis=1, keepdims=True) < 1e-3, spare, second))
    y, z = (second, first) if keeps_front else (first, second)
    return rotations.basis_to_quat(rotations.cross(y, z), y, z)
