"""What a policy sees (SIMS 3.3): the state s of its body, the egocentric heightmap h, and the contact goal g.

All three are told in the heading frame: origin at the pelvis, +Z where it heads on the floor, +Y up. Arrays are
batches: N bodies at one moment, or N frames of one body; sizes are those of a body of 1.70 m.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.body.capsules import BODIES
from motion_backend.body.scene_collision import Obstacles
from motion_backend.contact_goals import contact_goals, positions_and_mask
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Action, ContactGoal, Motion, Skill
from motion_backend.rotations import Array
from motion_backend.scene import Scene
from motion_backend.skeleton import INDEX, JOINTS, Skeleton, other_side
from scene_graphs.geometry.egocentric_heightmap import HeightmapSpec
from scene_graphs.layout import Placed

Mask = NDArray[np.bool_]

KEY_JOINTS: Final = ("head", "left_wrist", "right_wrist", "left_foot", "right_foot")
"""Whose places are told besides all rotations, as in AMP."""
STATE_SIZE: Final = 1 + 6 + 3 + 3 + 9 * (len(JOINTS) - 1) + 3 * len(KEY_JOINTS)
"""Numbers of s: height, tilt, velocity and spin of the pelvis, rotations and spins of 21 joints, key joints."""
STATE_FLOOR: Final = np.repeat(
    [0.02, 0.04, 0.1, 0.2, 0.04, 0.2, 0.02],
    [1, 6, 3, 3, 6 * (len(JOINTS) - 1), 3 * (len(JOINTS) - 1), 3 * len(KEY_JOINTS)],
)
"""What can be seen of each number of s: metres, axes, m/s, rad/s; what varies less is not blown up. (STATE_SIZE,)."""
HEIGHTMAP: Final = HeightmapSpec(25, 2 / 24, 1.0, "target")
"""h: 25 × 25 samples of the target object alone, from 1 m behind to 1 m ahead."""
NEAR: Final = 2.0
"""The target is seen by a root that is no farther from its bounding box (metres, along the floor)."""
GOAL_SIZE: Final = 4 * len(BODIES)
"""Numbers of g: places of the 15 contact bodies, and whether each counts."""
TOUCHES: Final = 0.05
"""A head or hand of a plan that is this near to furniture leans on it (metres, from its skin)."""
GOAL_BODIES: Final[dict[Skill, tuple[str, ...]]] = {
    Skill.LOCO: ("pelvis",),
    Skill.STANDUP: ("pelvis",),
    Skill.GETUP: ("pelvis",),
    Skill.TOUCH: ("left_hand", "right_hand"),
    Skill.SITDOWN: ("pelvis", "head", "left_hand", "right_hand"),
    Skill.LIEDOWN: ("pelvis", "head", "left_hand", "right_hand"),
}
"""Which entries of g a skill may use (SIMS 3.3); Reach uses one hand of the two at a time."""
_NAMES: Final = tuple(body.name for body in BODIES)
_LEANING: Final = {"head": "head", "left_hand": "left_wrist", "right_hand": "right_wrist"}
"""Contact bodies that may lean on something besides the pelvis, and the joints whose places g gives."""


@dataclass(frozen=True)
class BodyMoment:
    """N bodies at one moment, or N frames of one body; velocities come from a simulator or from `moments_of`."""

    positions: Array
    """(N, 22, 3) joints in the world."""
    world: Array
    """(N, 22, 4) their rotations in the world."""
    local: Array
    """(N, 22, 4) the same in their parents' frames; the pelvis' in the world's."""
    velocity: Array
    """(N, 3) of the pelvis, in the world (m/s)."""
    spins: Array
    """(N, 22, 3) how fast joints turn (rad/s): the pelvis in the world's axes, others in their parents'."""
    scale: float = 1.0
    """Size against the body of 1.70 m."""

    @property
    def root(self) -> Array:
        """(N, 3) the pelvis."""
        return self.positions[:, 0]

    @property
    def heading(self) -> Array:
        """(N,) yaw of the pelvis about +Y: its twist, which is as good of a body that lies on its back."""
        turn = self.local[:, 0]
        return np.asarray(rotations.wrap(2 * np.arctan2(turn[:, 1], turn[:, 3])))

    @property
    def level(self) -> Array:
        """(N, 4) what turns the world into the heading frame."""
        return rotations.yaw_to_quat(-self.heading)


def moments_of(motion: Motion) -> BodyMoment:
    """Every frame of a motion, with velocities from a frame to the next; the last moves like the one before."""
    body = Kinematics.of(motion)
    local = rotations.normalize(motion.local_rotations.astype(np.float64))
    velocity, spins = np.zeros((len(motion), 3)), np.zeros((len(motion), len(JOINTS), 3))
    if len(motion) > 1:
        steps = rotations.compose(local[1:], rotations.inverse(local[:-1]))
        velocity[:-1] = np.diff(body.positions[:, 0], axis=0) * motion.fps
        spins[:-1] = rotations.quat_to_rotvec(steps) * motion.fps
        velocity[-1], spins[-1] = velocity[-2], spins[-2]
    return BodyMoment(body.positions, body.world, local, velocity, spins, motion.skeleton.scale)


def state(moment: BodyMoment) -> Array:
    """s, the observation of AMP's discriminator as well, free of place and heading. (N, STATE_SIZE)."""
    level, count = moment.level, len(moment.root)
    keys = moment.positions[:, [INDEX[name] for name in KEY_JOINTS]] - moment.root[:, None]
    return np.concatenate(
        [
            moment.root[:, 1:2] / moment.scale,
            axes_of(rotations.compose(level, moment.local[:, 0])),
            rotations.rotate(level, moment.velocity) / moment.scale,
            rotations.rotate(level, moment.spins[:, 0]),
            axes_of(moment.local[:, 1:]).reshape(count, -1),
            moment.spins[:, 1:].reshape(count, -1),
            (rotations.rotate(level[:, None], keys) / moment.scale).reshape(count, -1),
        ],
        axis=1,
    )


def _mirrored() -> tuple[NDArray[np.int_], Array]:
    """For every number of s, which one the mirror puts in its place, and with which sign."""
    across, turned = [-1.0, 1.0, 1.0], [1.0, -1.0, -1.0]
    swapped = [INDEX[other_side(name)] - 1 for name in JOINTS[1:]]
    keys = [KEY_JOINTS.index(other_side(name)) for name in KEY_JOINTS]
    blocks = [
        (np.arange(1), [1.0]),
        (np.arange(6), across * 2),
        (np.arange(3), across),
        (np.arange(3), turned),
        (np.arange(6 * len(swapped)).reshape(-1, 6)[swapped].ravel(), across * 2 * len(swapped)),
        (np.arange(3 * len(swapped)).reshape(-1, 3)[swapped].ravel(), turned * len(swapped)),
        (np.arange(3 * len(keys)).reshape(-1, 3)[keys].ravel(), across * len(keys)),
    ]
    starts = np.cumsum([0, *(len(order) for order, _ in blocks)])
    order = np.concatenate([start + order for start, (order, _) in zip(starts, blocks, strict=False)])
    return order, np.concatenate([signs for _, signs in blocks])


_ORDER, _SIGNS = _mirrored()


def mirror_state(states: NDArray[np.floating]) -> NDArray[np.floating]:
    """s of the body seen in a mirror: sides swapped, what points sideways negated. (..., STATE_SIZE)."""
    return np.asarray(states[..., _ORDER] * _SIGNS.astype(states.dtype))


def axes_of(turns: Array) -> Array:
    """Rotations without a jump: where +Z and +Y come to point, as in AMP. (..., 4) to (..., 6)."""
    forward, up = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
    return np.concatenate([rotations.rotate(turns, forward), rotations.rotate(turns, up)], axis=-1)


def heightmap(scene: Scene, target: str | None, moment: BodyMoment) -> Array:
    """h: heights of the target object around each root, less the root's own; x first. (N, 25, 25).

    The object's heights are made once a scene inside its bounding box, and sampled while a root is `NEAR`; farther off,
    or without a target, the floor is bare. KeyError for an object that is not there.
    """
    root = moment.root
    flat = np.broadcast_to(-root[:, 1, None, None], (len(root), HEIGHTMAP.size, HEIGHTMAP.size))
    if target is None:
        return np.array(flat)
    close = away_from(scene.home.object(target), root) <= NEAR
    heights = np.array(flat)
    if close.any():
        heights[close] = scene.heights.egocentric(root[close], moment.heading[close], HEIGHTMAP, target)
    return heights


def away_from(placed: Placed, points: Array) -> Array:
    """How far points (N, 3) are from the bounding box of an object, along the floor; 0 over it (metres). (N,)."""
    local = np.abs(placed.to_local(points))
    gaps = np.maximum(local[:, [0, 2]] - np.asarray(placed.size)[[0, 2]] / 2, 0.0)
    return np.asarray(np.hypot(gaps[:, 0], gaps[:, 1]))


def goal_places(action: Action, skeleton: Skeleton, leaning: Sequence[ContactGoal] = ()) -> tuple[Array, Mask]:
    """Where contact bodies are to be, in the world (15, 3), and the valid-contact mask (15,).

    A walk and a rise bring the pelvis to standing height over the goal; sitting, lying and reaching bring it, or the
    hand, to its contact. `leaning` are contacts of head and hands of who sits or lies (`leaning_of` a plan); what a
    skill does not use is left out.
    """
    rests = action.skill in (Skill.SITDOWN, Skill.LIEDOWN)
    goals = (*contact_goals(action), *(leaning if rests else ()))
    over = action.goal if action.skill is Skill.LOCO else action.spot.standing if action.spot is not None else None
    if action.skill in (Skill.LOCO, Skill.STANDUP, Skill.GETUP) and over is not None:
        goals = (ContactGoal("pelvis", (over[0], skeleton.standing_height, over[1])),)
    places, given = positions_and_mask(goals)
    used = np.isin(_NAMES, GOAL_BODIES[action.skill])
    return np.where((given & used)[:, None], places, 0.0), given & used


def leaning_of(held: Motion, obstacles: Obstacles) -> tuple[ContactGoal, ...]:
    """Head and hands that lean on furniture while a plan holds a pose: backrest, armrest, mattress (SIMS 3.3).

    A goal is where the joint is when it is nearest.
    """
    body = Kinematics.of(held)
    start, end, radii = body.capsules
    solid, found = obstacles.solid(), []
    for name, joint in _LEANING.items():
        row = _NAMES.index(name)
        depth = solid.depth((start[:, row] + end[:, row]) / 2)
        frame = int(depth.argmax())
        if depth[frame] > -(radii[row] + TOUCHES):
            x, y, z = body.positions[frame, INDEX[joint]].tolist()
            found.append(ContactGoal(joint, (x, y, z)))
    return tuple(found)


def goal(places: Array, mask: Mask, moment: BodyMoment) -> Array:
    """g: where the contact bodies are to be, from the pelvis in the heading frame, nought where none; and the mask.

    Places (15, 3) and mask (15,) of one goal for all, or (N, 15, 3) and (N, 15). (N, GOAL_SIZE).
    """
    count = len(moment.root)
    away = rotations.rotate(moment.level[:, None], places - moment.root[:, None]) / moment.scale
    valid = np.broadcast_to(mask, (count, len(BODIES)))
    return np.concatenate([np.where(valid[..., None], away, 0.0).reshape(count, -1), valid], axis=1)
