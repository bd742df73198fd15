"""Bodies sit, lie and touch by every other caption as they did when somebody last looked at them."""

from __future__ import annotations

import json
from importlib.resources import files
from math import pi
from typing import Any, Final

from recorded import agrees
from small_home import DIRECTOR, after, contact, small_home, to

from motion_backend import rotations
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Action, Emotion, Motion, Skill
from motion_backend.skeleton import INDEX
from motion_backend.walk_generator import yaw_of
from scene_graphs.affordances.affordances import floor_spot

HOME: Final = small_home()
PIECES: Final = {Skill.SITDOWN: ("chair", "sofa", ""), Skill.LIEDOWN: ("bed", ""), Skill.TOUCH: ("shelf", "table")}
NEEDS: Final = {Skill.SITDOWN: "sit", Skill.LIEDOWN: "lie"}
EVERY: Final = 2
MOODS: Final = tuple(Emotion)
SEEN: Final = [INDEX[name] for name in (
    "neck", "head", "left_elbow", "right_elbow", "left_wrist", "right_wrist", "left_knee", "right_knee", "left_ankle",
    "right_ankle", "left_foot", "right_foot",
)]  # fmt: skip


def captions() -> dict[str, list[str]]:
    found: dict[str, list[str]] = json.loads((files("planner_service") / "data" / "captions.json").read_text("utf-8"))
    return found


def action_of(skill: Skill, caption: str, number: int) -> Action:
    """At one piece after the other, and on the floor, in one mood after the other."""
    piece, mood = PIECES[skill][number % len(PIECES[skill])], MOODS[number % len(MOODS)]
    if piece:
        return contact(HOME, skill, piece, caption, mood)
    return Action(skill, caption, mood, "floor", "floor", floor_spot(NEEDS[skill], (3.4, 2.6), pi / 5))


def test_poses_are_as_recorded() -> None:
    found: dict[str, Any] = {}
    for skill in PIECES:
        for number, caption in enumerate(captions()[skill][::EVERY]):
            action = action_of(skill, caption, number)
            motion, _ = DIRECTOR.act(HOME, action, after(HOME, to(action)))
            found[f"{skill}, {caption}, {action.furniture}, {action.emotion}"] = seen(motion)
    agrees("poses", found)


def seen(motion: Motion) -> list[list[float]]:
    """How long it takes; then where joints are from the pelvis, half way and in the end."""
    body, moments = Kinematics.of(motion), [len(motion) // 2, len(motion) - 1]
    level = rotations.inverse(rotations.yaw_to_quat(yaw_of(body.world[moments, 0])))
    around = rotations.rotate(level[:, None], body.positions[moments] - body.positions[moments, :1])
    rows = [[round(float(number), 3) + 0.0 for number in joints.ravel()] for joints in around[:, SEEN]]
    return [[float(len(motion)), round(float(body.positions[-1, 0, 1]), 3)], *rows]
