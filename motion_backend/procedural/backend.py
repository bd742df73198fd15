"""The procedural backend: rules, styles and inverse kinematics behind `begin` and `advance`.

It learns nothing and says so. What comes before what is decided in state_machine.py; here a state wakes up, one action
is performed, and the state that is left is put into plain lists again.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from motion_backend.body.scene_collision import Obstacles
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import FPS, Action, BodyState, Character, ContactGoal, Motion, Note, Part, Posture, Skill
from motion_backend.procedural.body_state import Body, Scene
from motion_backend.procedural.collision_avoidance.arm_clearance import arms_clear
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import idle, standing
from motion_backend.procedural.pose import Pose, concatenate
from motion_backend.procedural.pose_solver import hips_within, released, solve
from motion_backend.procedural.skill_controller import perform
from motion_backend.rotations import Array
from motion_backend.skeleton import HAND_REST, LYING_REST, SEATED_REST, build_skeleton
from motion_backend.state_machine import shortfall, time_limit
from scene_graphs.affordances.affordances import Spot
from scene_graphs.home import Home
from scene_graphs.navigation.path_planner import NoPath, Walkable


class ProceduralBackend:
    """Kinematic motion by rules: always works, needs no weights, is labelled `procedural`."""

    name = "procedural"

    def __init__(self) -> None:
        self._scene: Scene | None = None

    def begin(self, home: Home, character: Character, seed: int) -> BodyState:
        """Standing in the first room, on a free place that the seed chooses."""
        scene = self._enter(home)
        rng = np.random.default_rng([seed, 0])
        place = scene.walkable.random_point(rng, 0)
        yaw = float(rng.uniform(-np.pi, np.pi))
        skeleton = build_skeleton(character.height)
        pose = standing(place, yaw, Bearing(), skeleton)
        memory: dict[str, Any] = {"pose": pose.to_lists()}
        return BodyState(Posture.STANDING, _triple(pose.pelvis), yaw, None, 1, seed, character.height, memory)

    def advance(self, home: Home, action: Action, state: BodyState) -> tuple[Motion, BodyState]:
        """Act out one action; a body that cannot get there stays where it is and says why."""
        body = self._wake(home, state)
        start, reason = body.pose, ""
        try:
            perform(body, action)
        except NoPath as error:
            reason = str(error)
            body.enter(Part.STAND)
            body.add(idle(body.pose, 1.0, 1.0, body.rng, FPS))
        motion = _to_motion(body, start, action)
        limit = time_limit(state.posture, action, body.way)
        reason = reason or shortfall(action, Kinematics.of(motion), limit)
        motion = replace(motion, completed=not reason, reason=reason)
        rest = body.rest if body.posture is not Posture.STANDING else None
        memory: dict[str, Any] = {"pose": body.pose.to_lists(), "spot": _spot_to_lists(rest)}
        following = BodyState(
            body.posture,
            _triple(body.pose.pelvis),
            body.yaw,
            rest.object_id if rest else None,
            state.index + 1,
            state.seed,
            state.height,
            memory,
        )
        return motion, following

    def _wake(self, home: Home, state: BodyState) -> Body:
        rng = np.random.default_rng([state.seed, state.index])
        skeleton = build_skeleton(state.height)
        pose = released(Pose.from_lists(state.memory["pose"]), skeleton)
        rest = _spot_from_lists(state.memory.get("spot"))
        return Body(self._enter(home), skeleton, rng, pose, state.posture, rest, [])

    def _enter(self, home: Home) -> Scene:
        if self._scene is None or self._scene.home is not home:
            self._scene = Scene(home, Walkable(home), Obstacles.of_home(home))
        return self._scene


def _triple(point: Array) -> tuple[float, float, float]:
    return float(point[0]), float(point[1]), float(point[2])


def _spot_to_lists(spot: Spot | None) -> dict[str, Any] | None:
    if spot is None:
        return None
    return {name: (None if value == np.inf else value) for name, value in vars(spot).items()}


def _spot_from_lists(values: dict[str, Any] | None) -> Spot | None:
    if values is None:
        return None
    restored: dict[str, Any] = {
        name: tuple(value) if isinstance(value, list) else np.inf if value is None else value
        for name, value in values.items()
    }
    return Spot(**restored)


def _to_motion(body: Body, start: Pose, action: Action) -> Motion:
    pose = hips_within(concatenate(body.frames), body.skeleton)
    pose = arms_clear(pose, start, action, body.skeleton, body.scene.obstacles.solid())
    body.pose = pose.at(len(pose) - 1)
    root, local = solve(pose, body.skeleton)
    return Motion(
        root_positions=root.astype(np.float32),
        local_rotations=local.astype(np.float32),
        contacts=np.repeat(pose.planted, 2, axis=1).astype(np.float32),
        skeleton=body.skeleton,
        actions=np.full(len(pose), action.keyframe, dtype=np.int32),
        fps=FPS,
        goals=contact_goals(action),
        phases=body.phases,
        notes=tuple(Note(action.keyframe, words) for words in body.otherwise),
    )


def contact_goals(action: Action) -> tuple[ContactGoal, ...]:
    """Where joints should be: surface point + normal × that joint's rest offset."""
    rest = {Skill.SITDOWN: SEATED_REST, Skill.LIEDOWN: LYING_REST, Skill.TOUCH: HAND_REST}.get(action.skill)
    if action.spot is None or rest is None:
        return ()
    joint = f"{action.hand}_wrist" if action.skill is Skill.TOUCH else "pelvis"
    point = np.asarray(action.spot.point) + rest * np.asarray(action.spot.normal)
    return (ContactGoal(joint, _triple(point)),)
