"""What the simulated body is to follow: a kinematic plan as positions, speeds, controls and planted feet."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.body.scene_collision import Obstacles
from motion_backend.inverse_kinematics import arm_rotations, leg_rotations, two_bone
from motion_backend.motion import FPS
from motion_backend.physics.feet_over_edges import lift_over_edges
from motion_backend.physics.generalized_coordinates import controls, fold, speeds
from motion_backend.physics.hands_round_things import bones, eased, hands_round_things
from motion_backend.physics.mjcf_character import SIDES
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

LIFT: Final = 0.012
"""Metres that feet swing higher than planned, at 1.70 m: simulated ones hang lower by as much and graze the floor."""
LIFTED_IN: Final = 5
"""Frames in which a foot comes to that height, and in which it comes down again."""
LONGEST_SWING: Final = 1.2
"""Seconds: a foot that is off the floor for longer is not in a step."""
TURNED: Final = 1e-3
"""A collar turned by less (radians) counts as at rest."""
ARM_OVER: Final = 0.05
"""Elbows and wrists are so high over the floor, at 1.70 m (metres)."""
RADIUS: Final = 0.02
"""The least radius of the circle that an elbow is turned on (metres): a straight arm has nothing to turn."""
MOST_TURNED: Final = 0.6
"""No elbow is turned by more (radians): one that swings through below the line would have to go round over it."""
ARM_EASES: Final = 8
"""Frames before and after in which that comes and goes."""
UP: Final = np.array([0.0, 1.0, 0.0])
FASTEST: Final = 8.0
"""Metres a second: a pelvis that is planned faster jumps."""


class Doing(IntEnum):
    """What a body does in a frame, as far as it is followed otherwise for it."""

    OTHER = 0
    WALKS = 1
    REACHES = 2
    """For something, with its hands."""
    LIES = 3
    """Lies down, lies, or gets up from a bed."""
    RISES = 4
    """Gets up from the floor, on hands and knees."""
    STANDS_UP = 5
    """From its knees."""
    GOES_DOWN = 6
    """To lie: onto its knees, or to the edge of a bed."""


ROLLS: Final = (Doing.LIES, Doing.GOES_DOWN)
"""Where feet go over the edge of a bed or a seat."""


@dataclass(frozen=True)
class Plan:
    """T frames of a kinematic body."""

    roots: Array
    """(T, 3)."""
    local: Array
    """(T, 22, 4) xyzw."""
    contacts: Array
    """(T, 4)."""
    doing: NDArray[np.int8]
    """(T,) of `Doing`."""

    def __len__(self) -> int:
        return len(self.roots)

    @property
    def reaching(self) -> NDArray[np.bool_]:
        """In which frames it reaches for something. (T,)."""
        return np.asarray(self.doing == Doing.REACHES)

    @property
    def _rows(self) -> tuple[Any, ...]:
        return self.roots, self.local, self.contacts, self.doing

    def part(self, frames: slice) -> Plan:
        """Some of the frames."""
        return Plan(*(rows[frames] for rows in self._rows))

    def last(self, frames: int) -> Plan:
        """Its last frame, so often."""
        return Plan(*(np.repeat(rows[-1:], max(frames, 0), axis=0) for rows in self._rows))

    def followed_by(self, later: Plan) -> Plan:
        """One after the other."""
        return Plan(*(np.concatenate(both) for both in zip(self._rows, later._rows, strict=True)))

    def jump(self) -> int | None:
        """The first frame that a body cannot come to from the one before, or that has no finite numbers."""
        steps = np.linalg.norm(np.diff(self.roots, axis=0), axis=1) * FPS
        bad = np.concatenate([[False], ~(steps <= FASTEST)])
        bad |= ~np.isfinite(self.roots).all(axis=1) | ~np.isfinite(self.local).all(axis=(1, 2))
        return int(bad.argmax()) if bad.any() else None


@dataclass(frozen=True)
class Reference:
    """T frames in the simulated body's numbers."""

    qpos: Array
    """(T, 45)."""
    qvel: Array
    """(T, 36)."""
    controls: Array
    """(T, 30)."""
    planted: NDArray[np.bool_]
    """(T, 4): left heel, left ball, right heel, right ball are to stay where they are."""
    wrists: Array
    """(T, 2, 4) local rotations, xyzw."""
    doing: NDArray[np.int8]
    """(T,) of `Doing`, as of the plan."""

    def __len__(self) -> int:
        return len(self.qpos)

    def part(self, frames: slice) -> Reference:
        """Some of the frames."""
        moving = (self.qpos[frames], self.qvel[frames], self.controls[frames])
        return Reference(*moving, self.planted[frames], self.wrists[frames], self.doing[frames])

    @staticmethod
    def of(plan: Plan, skeleton: Skeleton, things: Obstacles | None = None) -> Reference:
        """With feet that swing a little higher and over edges, and arms that reach as far without their collars and
        round things."""
        local = _without_collars(plan.roots, _feet_lifted(plan, skeleton, things), skeleton)
        local = _arms_over_floor(plan.roots, local, skeleton)
        if things is not None:
            local = hands_round_things(plan.roots, local, plan.reaching, skeleton, things)
        qpos = fold(plan.roots, local)
        qvel = speeds(qpos)
        wrists = local[:, [INDEX[f"{side}_wrist"] for side, _ in SIDES]]
        return Reference(qpos, qvel, controls(qpos, qvel), plan.contacts > 0.5, wrists, plan.doing)


def _feet_lifted(plan: Plan, skeleton: Skeleton, things: Obstacles | None) -> Array:
    """Local rotations (T, 22, 4) of a plan whose feet swing a little higher, as they are turned."""
    positions, world = skeleton.forward_kinematics(plan.roots, plan.local)
    over = np.zeros((len(plan), len(SIDES)))
    if things is not None and (rolls := np.isin(plan.doing, ROLLS)).any():
        over = lift_over_edges(positions, world, skeleton, things) * rolls[:, None]
    local = np.array(plan.local, dtype=np.float64)
    for index, (side, _) in enumerate(SIDES):
        lift = _lift(plan.contacts[:, 2 * index : 2 * index + 2].max(axis=1) > 0.5) * skeleton.scale
        lift = np.maximum(lift, over[:, index])
        frames = np.flatnonzero(lift)
        if not len(frames):
            continue
        hip, knee, ankle = (positions[frames, INDEX[f"{side}_{joint}"]] for joint in ("hip", "knee", "ankle"))
        target = ankle.astype(np.float64)
        target[:, 1] += lift[frames]
        limb = two_bone(hip.astype(np.float64), target, (knee - hip).astype(np.float64), _leg(skeleton, side))
        thigh, shin = leg_rotations(limb)
        foot = world[frames, INDEX[f"{side}_ankle"]]
        local[frames, INDEX[f"{side}_hip"]] = rotations.compose(rotations.inverse(world[frames, 0]), thigh)
        local[frames, INDEX[f"{side}_knee"]] = rotations.compose(rotations.inverse(thigh), shin)
        local[frames, INDEX[f"{side}_ankle"]] = rotations.compose(rotations.inverse(shin), foot)
    return local


def _leg(skeleton: Skeleton, side: str) -> tuple[float, float]:
    upper, lower = (float(np.linalg.norm(skeleton.offsets[INDEX[f"{side}_{joint}"]])) for joint in ("knee", "ankle"))
    return upper, lower


def _lift(planted: NDArray[np.bool_]) -> Array:
    """How much higher a foot is to be, from whether it is planted (T,); metres at 1.70 m. (T,)."""
    lift = np.zeros(len(planted))
    edges = np.flatnonzero(np.diff(np.concatenate([[True], planted, [True]]).astype(np.int8)))
    for start, stop in edges.reshape(-1, 2):
        # A swing that goes on beyond what is known is not in its middle where that ends.
        if stop - start <= LONGEST_SWING * FPS and start > 0 and stop < len(planted):
            inside = np.minimum(np.arange(1, stop - start + 1), np.arange(stop - start, 0, -1)) / (LIFTED_IN + 1)
            share = np.minimum(inside, 1.0)
            lift[start:stop] = LIFT * share**2 * (3 - 2 * share)
    return lift


def _without_collars(roots: Array, local: Array, skeleton: Skeleton) -> Array:
    """Local rotations whose collars are at rest, and whose wrists are where they were as far as arms can reach."""
    positions, world = skeleton.forward_kinematics(roots, local)
    found = np.array(local)
    for side, sign in SIDES:
        collar, shoulder, elbow, wrist = (
            INDEX[f"{side}_{joint}"] for joint in ("collar", "shoulder", "elbow", "wrist")
        )
        frames = np.flatnonzero(np.linalg.norm(local[:, collar, :3], axis=1) > TURNED / 2)
        if not len(frames):
            continue
        chest = world[frames, INDEX["spine3"]]
        rest = skeleton.offsets[collar] + skeleton.offsets[shoulder]
        at = positions[frames, INDEX["spine3"]] + rotations.rotate(chest, rest)
        pole = (positions[frames, elbow] - positions[frames, shoulder]).astype(np.float64)
        limb = two_bone(at, positions[frames, wrist].astype(np.float64), pole, bones(skeleton, side))
        upper, lower = arm_rotations(limb, int(sign))
        found[frames, collar] = rotations.IDENTITY
        found[frames, shoulder] = rotations.compose(rotations.inverse(chest), upper)
        found[frames, elbow] = rotations.compose(rotations.inverse(upper), lower)
        found[frames, wrist] = rotations.compose(rotations.inverse(lower), world[frames, wrist])
    return found


def _arms_over_floor(roots: Array, local: Array, skeleton: Skeleton) -> Array:
    """Local rotations whose elbows and wrists are over the floor: a kinematic arm may swing through it, and a simulated
    one that followed would lie under its body and hold it down."""
    positions, world = skeleton.forward_kinematics(roots, local)
    found, least = np.array(local), ARM_OVER * skeleton.scale
    for side, sign in SIDES:
        shoulder, elbow, wrist = (INDEX[f"{side}_{joint}"] for joint in ("shoulder", "elbow", "wrist"))
        if positions[:, [elbow, wrist], 1].min() >= least:
            continue
        at, middle, hand = (positions[:, joint].astype(np.float64) for joint in (shoulder, elbow, wrist))
        lengths, raised = bones(skeleton, side), eased(np.maximum(least - hand[:, 1], 0.0), ARM_EASES)
        target, pole = hand + raised[:, None] * UP, middle - at
        axis, turn = _turned_up(at, target, pole, lengths, least)
        frames = np.flatnonzero(turn + raised)
        pole = rotations.rotate(rotations.rotvec_to_quat(turn[:, None] * axis), pole)
        limb = two_bone(at[frames], target[frames], pole[frames], lengths)
        upper, lower = arm_rotations(limb, int(sign))
        found[frames, shoulder] = rotations.compose(rotations.inverse(world[frames, INDEX["spine3"]]), upper)
        found[frames, elbow] = rotations.compose(rotations.inverse(upper), lower)
        found[frames, wrist] = rotations.compose(rotations.inverse(lower), world[frames, wrist])
    return found


def _turned_up(
    at: Array, target: Array, pole: Array, lengths: tuple[float, float], least: float
) -> tuple[Array, Array]:
    """Lines from shoulders to wrists (T, 3), and by how much elbows are turned about them (T,) to be over the floor: as
    little as it takes, on the side on which they are."""
    limb = two_bone(at, target, pole, lengths)
    axis, elbow = rotations.normalize(target - at), lengths[0] * limb.upper
    along = rotations.dot(elbow, axis)
    radius = np.maximum(np.linalg.norm(elbow - along * axis, axis=1), RADIUS)
    across = rotations.cross(axis, np.broadcast_to(UP, axis.shape))
    sine, cosine = rotations.dot(elbow, across)[:, 0], elbow[:, 1] - along[:, 0] * axis[:, 1]
    # From where the elbow would be highest; the circle it can be on leans as much as the line from shoulder to wrist.
    angle = np.arctan2(sine, cosine)
    steep = np.maximum(radius * np.linalg.norm(across, axis=1), RADIUS)
    most = np.arccos(np.clip((least - at[:, 1] - along[:, 0] * axis[:, 1]) / steep, -1.0, 1.0))
    needed = np.sign(angle) * np.clip(most - np.abs(angle), -MOST_TURNED, 0.0)
    return axis, eased(np.maximum(needed, 0.0), ARM_EASES) - eased(np.maximum(-needed, 0.0), ARM_EASES)
