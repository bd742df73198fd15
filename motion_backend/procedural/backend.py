"""The procedural backend: rules, styles and inverse kinematics behind `begin` and `advance`.

It learns nothing and says so. What comes before what is decided in state_machine.py; here a state wakes up, one part
is performed, and the state that is left is put into plain lists again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from motion_backend.backend_protocol import HISTORY, POSTURE_AFTER, BodyState, History, Part, PartKind
from motion_backend.motion import FPS, Character, Motion, Note, PhaseKind, Posture
from motion_backend.procedural.arm_clearance import Around, arms_clear
from motion_backend.procedural.balance_pass import Before, balanced
from motion_backend.procedural.body_state import Body
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.gaze import gazing
from motion_backend.procedural.held_poses import idle, standing
from motion_backend.procedural.pose import Pose, concatenate
from motion_backend.procedural.pose_solver import all_released, head_clear, hips_within, released, solve
from motion_backend.procedural.reaction import looking
from motion_backend.procedural.skill_controller import perform
from motion_backend.procedural.tail import carried_on, frames_kept_back
from motion_backend.procedural.takeover import eased_from, pose_of
from motion_backend.procedural.touch.hand_rests import Hold
from motion_backend.procedural.walk.stride import Stride
from motion_backend.scene import scene_of
from motion_backend.skeleton import build_skeleton
from scene_graphs.home import Home
from scene_graphs.navigation.path_planner import NoPath

STANDS = 1.0
"""How long a body stands that cannot get where it is to go (seconds)."""


ENTERS = (PartKind.SIT, PartKind.LIE)
"""Parts that are in the posture they end in, for what arms may lie on, but in sitting up; all others in the one they
begin in."""


class ProceduralBackend:
    """Kinematic motion by rules: always works, needs no weights, is labelled `procedural`."""

    name = "procedural"

    def begin(self, home: Home, character: Character, seed: int) -> BodyState:
        """Standing in the first room, on a free place that the seed chooses."""
        place, yaw = scene_of(home).beginning(seed)
        skeleton = build_skeleton(character.height)
        pose = standing(place, yaw, Bearing(), skeleton).repeat(1)
        history = History.of(*solve(pose, skeleton), np.repeat(pose.planted, 2, axis=1))
        first = BodyState.standing(place, yaw, character, seed)
        return replace(first, history=history, index=1, backend=self.name, memory={"pose": pose.at(0).to_lists()})

    def advance(self, home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> tuple[Motion, BodyState]:
        """Do one part, all of it; a body that cannot get there stays where it is and says why."""
        body = self._awake(home, upcoming, state)
        reason = ""
        try:
            perform(body, part)
        except NoPath as error:
            reason = str(error)
            body.enter(PhaseKind.STAND)
            body.add(idle(body.pose, STANDS, 1.0, body.rng, FPS))
        if not body.frames:
            nothing = _nothing(body, part)
            return nothing, state.after(part, nothing, state.backend, state.memory)
        motion = replace(_to_motion(body, part), completed=not reason, reason=reason)
        if state.backend != self.name:
            motion = eased_from(state.history, motion, body.skeleton)
        return motion, state.after(part, motion, self.name, _remembered(body))

    def _awake(self, home: Home, upcoming: Sequence[Part], state: BodyState) -> Body:
        """The body as the state left it, whoever made what was before."""
        skeleton, memory = build_skeleton(state.height), state.memory if state.backend == self.name else {}
        left, right = (Hold(**hold) if hold else None for hold in memory.get("holds", (None, None)))
        pose = Pose.from_lists(memory["pose"]) if memory else pose_of(state.history, skeleton)
        tail, stride = memory.get("tail"), Stride.from_lists(memory["stride"]) if memory.get("stride") else None
        still = np.zeros((HISTORY if memory else 0, 3))
        before = Before.of(state.history, still if stride is None else stride.shift, skeleton)
        body = Body(
            scene=scene_of(home),
            skeleton=skeleton,
            rng=np.random.default_rng([state.seed, state.index]),
            pose=released(pose, skeleton),
            before=before,
            posture=state.posture,
            rest=state.rest,
            holds=(left, right),
            seed=state.seed,
            tail=Pose.from_lists(tail) if tail else None,
            stride=stride,
            upcoming=tuple(upcoming),
        )
        # A walk goes on as it was planned: where its weight goes then is found after it.
        if len(before.shift):
            body.pose = replace(body.pose, pelvis=body.pose.pelvis - before.shift[-1])
        return body


def _remembered(body: Body) -> dict[str, Any]:
    """What the next part needs of a body besides its last frames."""
    return {
        "pose": body.pose.to_lists(),
        "holds": [asdict(hold) if hold is not None else None for hold in body.holds],
        "tail": body.tail.to_lists() if body.tail is not None else None,
        "stride": body.stride.to_lists() if body.stride is not None else None,
    }


def _to_motion(body: Body, part: Part) -> Motion:
    """The frames made for a part, but those that are done together with what comes next."""
    action = part.action
    enters = part.kind in ENTERS and body.posture is not Posture.LYING
    posture = POSTURE_AFTER[part.kind] if enters else body.posture
    under = body.rest if part.kind not in ENTERS else action.spot
    around = Around(part, posture, under.object_id if under else None, body.scene.obstacles.solid())
    pose, start = concatenate(body.frames), body.begun
    if body.tail is not None:
        pose, start = carried_on(body.tail, pose), body.tail.at(0)
    pose = gazing(pose, body, part) if part.reaction is None else looking(pose, body, part)
    if posture is not Posture.LYING:
        pose = head_clear(pose, around.solid, body.skeleton)
    upright, pose = pose, balanced(pose, body.phases, body.skeleton, body.before, body.beyond)
    if body.stride is not None:
        shift = np.concatenate([body.before.shift, pose.pelvis - upright.pelvis])
        body.stride = replace(body.stride, shift=shift[-HISTORY:])
    pose = hips_within(pose, body.skeleton)
    wanted, pose = pose.arms[-1], arms_clear(pose, start, around, body.skeleton)
    if body.stride is not None and len(pose) > 1 and (pose.arms[-1] != wanted).any():
        # Arms that are on a detour go on from that.
        body.stride = replace(body.stride, arms_onward=pose.arms[-1] - pose.arms[-2])
    body.pose = pose.at(len(pose) - 1)
    root, local = solve(pose, body.skeleton)
    whole = Motion(
        root_positions=root.astype(np.float32),
        local_rotations=local.astype(np.float32),
        contacts=np.repeat(pose.planted, 2, axis=1).astype(np.float32),
        skeleton=body.skeleton,
        actions=np.full(len(pose), action.keyframe, dtype=np.int32),
        fps=FPS,
        phases=(*body.phases[:-1], replace(body.phases[-1], stop=len(pose))),
        notes=tuple(Note(part.action.keyframe, words) for words in body.otherwise),
    )
    kept = frames_kept_back(part, body.upcoming, whole) if body.stride is None else 0
    body.tail = all_released(pose.at(slice(len(pose) - kept - 1, None)), body.skeleton) if kept else None
    return whole.part(0, len(pose) - kept)


def _nothing(body: Body, part: Part) -> Motion:
    """No frames: the body is where it is to be."""
    notes = tuple(Note(part.action.keyframe, words) for words in body.otherwise)
    return replace(Motion.empty(body.skeleton), notes=notes)
