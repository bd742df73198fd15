"""What a policy sees of a task while it does it: (s, h, g, z) of SIMS 3.4, from a simulated body's numbers.

Besides these it sees the plan that the procedural body made, which the paper's do not: its controls are offsets from
the plan's, as the teacher's are.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.backend_protocol import Part, PartKind
from motion_backend.motion import Motion, Skill
from motion_backend.physics.engine import engine
from motion_backend.physics.generalized_coordinates import unfold
from motion_backend.physics.linear_model import NX
from motion_backend.physics.mjcf_character import NU, NV, SIMULATED
from motion_backend.physics.observations import (
    GOAL_SIZE,
    HEIGHTMAP,
    STATE_FLOOR,
    BodyMoment,
    Mask,
    goal,
    goal_places,
    heightmap,
    leaning_of,
    state,
)
from motion_backend.physics.policies import AHEAD, EMBEDDING_SIZE, PLAN_SIZE, POLICY_OF, SOLES, WITH_TEXT, PolicyName
from motion_backend.physics.task import Task
from motion_backend.rotations import Array
from motion_backend.scene import scene_of
from motion_backend.skeleton import INDEX

AT_GOAL: Final = 0.06
"""A hand of a plan that is this near to its goal (metres) is there: until it leaves, the goal is shown."""
HELD_FRAMES: Final = 10
"""Last frames of a plan in which it is looked for what head and hands lean on."""
CONTROL_FLOOR, HEIGHT_FLOOR, GOAL_FLOOR, TEXT_FLOOR = 0.05, 0.5, 0.2, 0.3
"""What can be seen of controls (radians), of heights and goals (metres), and of an embedding's numbers: heights and
words little, or rooms and captions are learned by heart."""
OFFSET_FLOOR: Final = 0.02
"""What can be seen of a control's offset from the plan's (radians)."""
PLAN_FLOOR: Final = np.repeat(
    [0.01, 0.02, 0.02, 0.05, 0.1, 0.1, OFFSET_FLOOR, 0.05, 0.5],
    [3, 3, NV - 6, 3, 3, NV - 6, NU, NV * len(AHEAD), SOLES],
)
"""What can be seen of these. (PLAN_SIZE,)."""
_SHARED: Final = {"trunk": ("spine1", "spine2", "spine3"), "neck": ("neck", "head")}
_TURNING: Final = [
    (INDEX[own], joint.qvel, len(shared))
    for joint in SIMULATED
    if not joint.axis
    for shared in [_SHARED.get(joint.name, (joint.name,))]
    for own in shared
]
_BALLS, _AMONG = (np.array([row[index] for row in _TURNING]) for index in (0, 2))
"""Joints of ours that turn with a ball joint, and among how many its turn is shared."""
_BALL_SPEEDS: Final = np.array([[first, first + 1, first + 2] for _, first, _ in _TURNING])
_HINGED: Final = np.array([INDEX[joint.name.replace("toe", "foot")] for joint in SIMULATED if joint.axis])
_AXES: Final = np.array(["xyz".index(joint.axis) for joint in SIMULATED if joint.axis])
_HINGE_SPEEDS: Final = np.array([joint.qvel for joint in SIMULATED if joint.axis])


def policy_of(part: Part) -> PolicyName | None:
    """Who of the five does a part; None where nobody does: standing."""
    skill = part.action.skill
    if part.kind in (PartKind.WALK, PartKind.TURN):
        return PolicyName.WALK
    if part.kind is PartKind.RISE:
        return PolicyName.GETUP
    if part.reaction is not None or (part.kind is PartKind.HOLD and skill not in (Skill.SITDOWN, Skill.LIEDOWN)):
        return None
    return POLICY_OF[skill]


def bodies_of(qpos: Array, qvel: Array, wrists: Array, task: Task) -> BodyMoment:
    """N simulated bodies (N, 45), (N, 36) as observations want them; wrists (N, 2, 4) are the plan's.

    Joints that are one in the simulation turn equally fast.
    """
    roots, local = unfold(qpos, wrists)
    positions, world = task.skeleton.forward_kinematics(roots, local)
    spins = np.zeros((len(qpos), local.shape[1], 3))
    spins[:, 0] = rotations.rotate(local[:, 0], qvel[:, 3:6])
    spins[:, _HINGED, _AXES] = qvel[:, _HINGE_SPEEDS]
    # MuJoCo tells how fast a joint turns in the child's frame.
    spins[:, _BALLS] = rotations.rotate(local[:, _BALLS], qvel[:, _BALL_SPEEDS]) / _AMONG[:, None]
    placed, turned = np.asarray(positions, dtype=np.float64), np.asarray(world, dtype=np.float64)
    return BodyMoment(placed, turned, local, qvel[:, :3], spins, task.skeleton.scale)


def level_of(qpos: Array) -> Array:
    """What turns the world's axes into those of bodies (N, 45) that face ahead. (N, 4)."""
    return np.asarray(rotations.yaw_to_quat(-2 * np.arctan2(qpos[:, 5], qpos[:, 3])))


@dataclass(frozen=True)
class View:
    """What is told to a policy besides the state of its body."""

    task: Task
    target: str | None
    """The object whose heights are seen."""
    places: Array
    """Where contact bodies are to be, in the world. (15, 3)."""
    mask: Mask
    """Which of them count. (15,)."""
    shown: int
    """Frames after which no goal is shown: the hand has been there and is to come back."""
    z: Array
    """The caption's embedding; (0,) for a policy that is told no words."""

    @staticmethod
    def of(task: Task, part: Part, planned: Motion, z: Array) -> View:
        """Of a part, as it was planned."""
        held = planned.part(max(len(planned) - HELD_FRAMES, 0), len(planned))
        leaning = leaning_of(held, scene_of(task.home).obstacles)
        places, mask = goal_places(part.action, task.skeleton, leaning)
        shown = _shown(planned, part) if part.kind is PartKind.REACH else len(planned) + 1
        spot = part.action.spot
        return View(task, spot.object_id if spot is not None else None, places, mask, shown, z)

    def observe(self, qpos: Array, qvel: Array, controls: Array, frames: NDArray[np.int_]) -> Array:
        """(s, controls and plan, h, g, z) of bodies (N, 45), (N, 36) that hold controls (N, 30), each in a frame of
        its plan.

        (N, O) in metres, radians and their rates; the controls are seen since the teacher prices their change.
        """
        bodies = bodies_of(qpos, qvel, self.task.reference.wrists[frames], self.task)
        heights = heightmap(scene_of(self.task.home), self.target, bodies).reshape(len(qpos), -1)
        return self.joined(bodies, controls, self.off_plan(qpos, qvel, controls, frames), heights, frames)

    def off_plan(self, qpos: Array, qvel: Array, controls: Array, frames: NDArray[np.int_]) -> Array:
        """How far bodies are off their plan, what they hold beside its controls, and how it goes on. (N, PLAN_SIZE)."""
        reference, off = self.task.reference, np.empty((len(frames), NX))
        model, difference = self.task.models_at(0).fine, engine().mj_differentiatePos
        for row, planned, now in zip(off, reference.qpos[frames], qpos, strict=True):
            difference(model, row[:NV], 1.0, planned, now)
        off[:, NV:] = qvel - reference.qvel[frames]
        found = np.concatenate([off, controls - reference.controls[frames], self._goes_on[frames]], axis=1)
        # What is in the world's axes is told in the body's own, as everything else that it sees.
        level = level_of(qpos)
        for first in (0, NV, *range(NX + NU, PLAN_SIZE - SOLES, NV)):
            found[:, first : first + 3] = rotations.rotate(level, found[:, first : first + 3])
        return found

    @cached_property
    def _goes_on(self) -> Array:
        """Of every frame of the plan: the ways to where it is `AHEAD`, and which soles are planted then."""
        reference, model = self.task.reference, self.task.models_at(0).fine
        frames = np.arange(len(reference))
        later = np.minimum(frames[:, None] + AHEAD, frames[-1])
        ways = np.empty((*later.shape, NV))
        for rows, here, there in zip(ways, reference.qpos, reference.qpos[later], strict=True):
            for row, place in zip(rows, there, strict=True):
                engine().mj_differentiatePos(model, row, 1.0, here, place)
        planted = reference.planted[later].reshape(len(frames), -1)
        return np.concatenate([ways.reshape(len(frames), -1), planted], axis=1)

    def joined(
        self, bodies: BodyMoment, controls: Array, plan: Array, heights: Array, frames: NDArray[np.int_]
    ) -> Array:
        """The same with what is seen of the plan (N, PLAN_SIZE) and heightmaps (N, 625) that are known already."""
        mask = (frames < self.shown)[:, None] & self.mask
        places = np.broadcast_to(self.places, (len(frames), *self.places.shape))
        words = np.broadcast_to(self.z, (len(frames), len(self.z)))
        return np.concatenate([state(bodies), controls, plan, heights, goal(places, mask, bodies), words], axis=1)


def floors(name: PolicyName) -> Array:
    """What can be seen of each number of an observation. (O,)."""
    words = EMBEDDING_SIZE if name in WITH_TEXT else 0
    sizes = (sum(1 if joint.axis else 3 for joint in SIMULATED), HEIGHTMAP.size**2, GOAL_SIZE, words)
    controls, *rest = (
        np.full(size, floor)
        for size, floor in zip(sizes, (CONTROL_FLOOR, HEIGHT_FLOOR, GOAL_FLOOR, TEXT_FLOOR), strict=True)
    )
    return np.concatenate([STATE_FLOOR, controls, PLAN_FLOOR, *rest])


def _shown(planned: Motion, part: Part) -> int:
    """The frame in which a plan's hand leaves its goal for good."""
    contact = part.contacts[0]
    hands = planned.skeleton.forward_kinematics(planned.root_positions, planned.local_rotations)[0]
    away = np.linalg.norm(hands[:, INDEX[contact.joint]] - np.asarray(contact.position), axis=1)
    near = np.flatnonzero(away < max(AT_GOAL, float(away.min()) + AT_GOAL / 2))
    return int(near[-1]) + 1
