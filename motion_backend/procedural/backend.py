"""The procedural backend: rules, styles and inverse kinematics behind `begin` and `advance`.

It learns nothing and says so. What comes before what is decided in state_machine.py; here a state wakes up, one part
is performed, and the state that is left is put into plain lists again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace

import numpy as np

from motion_backend.backend_protocol import POSTURE_AFTER, BodyState, History, Part, PartKind
from motion_backend.motion import FPS, Action, Character, Motion, Note, PhaseKind
from motion_backend.procedural.body_state import Body
from motion_backend.procedural.collision_avoidance.arm_clearance import arms_clear
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import idle, standing
from motion_backend.procedural.pose import Pose, concatenate
from motion_backend.procedural.pose_solver import hips_within, released, solve
from motion_backend.procedural.skill_controller import perform
from motion_backend.procedural.touch.hand_rests import Hold
from motion_backend.scene import scene_of
from motion_backend.skeleton import build_skeleton
from scene_graphs.home import Home
from scene_graphs.navigation.path_planner import NoPath

STANDS = 1.0
"""How long a body stands that cannot get where it is to go (seconds)."""


class ProceduralBackend:
    """Kinematic motion by rules: always works, needs no weights, is labelled `procedural`."""

    name = "procedural"

    def begin(self, home: Home, character: Character, seed: int) -> BodyState:
        """Standing in the first room, on a free place that the seed chooses."""
        rng = np.random.default_rng([seed, 0])
        place = scene_of(home).walkable.random_point(rng, 0)
        yaw = float(rng.uniform(-np.pi, np.pi))
        skeleton = build_skeleton(character.height)
        pose = standing(place, yaw, Bearing(), skeleton).repeat(1)
        history = History.of(*solve(pose, skeleton), np.repeat(pose.planted, 2, axis=1))
        first = BodyState.standing(place, yaw, character, seed)
        return replace(first, history=history, index=1, backend=self.name, memory={"pose": pose.at(0).to_lists()})

    def advance(self, home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> tuple[Motion, BodyState]:
        """Do one part, all of it; a body that cannot get there stays where it is and says why."""
        body = _awake(home, upcoming, state)
        start, reason = body.pose, ""
        try:
            perform(body, part)
        except NoPath as error:
            reason = str(error)
            body.enter(PhaseKind.STAND)
            body.add(idle(body.pose, STANDS, 1.0, body.rng, FPS))
        motion = replace(_to_motion(body, start, part), completed=not reason, reason=reason)
        holds = [asdict(hold) if hold is not None else None for hold in body.holds]
        return motion, state.after(part, motion, self.name, {"pose": body.pose.to_lists(), "holds": holds})


def _awake(home: Home, upcoming: Sequence[Part], state: BodyState) -> Body:
    """The body as the state left it, whoever made what was before."""
    skeleton, memory = build_skeleton(state.height), state.memory
    left, right = (Hold(**hold) if hold else None for hold in memory.get("holds", (None, None)))
    return Body(
        scene=scene_of(home),
        skeleton=skeleton,
        rng=np.random.default_rng([state.seed, state.index]),
        pose=released(Pose.from_lists(memory["pose"]), skeleton),
        posture=state.posture,
        rest=state.rest,
        holds=(left, right),
        upcoming=tuple(upcoming),
    )


def _to_motion(body: Body, start: Pose, part: Part) -> Motion:
    action = part.action
    if not body.frames:
        return _nothing(body, action)
    posture = POSTURE_AFTER.get(part.kind, body.posture) if part.kind is not PartKind.RISE else body.posture
    pose = hips_within(concatenate(body.frames), body.skeleton)
    pose = arms_clear(pose, start, part, posture, body.skeleton, body.scene.obstacles.solid())
    body.pose = pose.at(len(pose) - 1)
    root, local = solve(pose, body.skeleton)
    return Motion(
        root_positions=root.astype(np.float32),
        local_rotations=local.astype(np.float32),
        contacts=np.repeat(pose.planted, 2, axis=1).astype(np.float32),
        skeleton=body.skeleton,
        actions=np.full(len(pose), action.keyframe, dtype=np.int32),
        fps=FPS,
        phases=body.phases,
        notes=tuple(Note(action.keyframe, words) for words in body.otherwise),
    )


def _nothing(body: Body, action: Action) -> Motion:
    """No frames: the body is where it is to be."""
    return Motion(
        root_positions=np.zeros((0, 3), dtype=np.float32),
        local_rotations=np.zeros((0, len(body.skeleton.names), 4), dtype=np.float32),
        contacts=np.zeros((0, 4), dtype=np.float32),
        skeleton=body.skeleton,
        actions=np.zeros(0, dtype=np.int32),
        notes=tuple(Note(action.keyframe, words) for words in body.otherwise),
    )
