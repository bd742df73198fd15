"""Bodies sit, lie and touch by every third caption as they did when somebody last looked at them."""

from __future__ import annotations

import json
from dataclasses import replace
from importlib.resources import files
from math import pi
from typing import Any, Final

from recorded import agrees
from small_home import DIRECTOR, after, contact, rise, small_home, to

from motion_backend import rotations
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Action, Character, Emotion, Motion, Skill
from motion_backend.skeleton import INDEX
from motion_backend.state_machine import alongside
from motion_backend.walk_generator import yaw_of
from scene_graphs.affordances.affordances import floor_spot, spots

HOME: Final = small_home()
PIECES: Final = {Skill.SITDOWN: ("chair", "sofa", ""), Skill.LIEDOWN: ("bed", ""), Skill.TOUCH: ("shelf", "table")}
NEEDS: Final = {Skill.SITDOWN: "sit", Skill.LIEDOWN: "lie"}
EVERY: Final = 3
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


def turns() -> dict[str, list[Action]]:
    """What is done one after the other where one rests, without getting up in between, or up from there."""
    bed = contact(HOME, Skill.SITDOWN, "bed", "hands support on seat, legs straight", which=1)
    beds = (spot for spot in spots(HOME.object("0/bed"), "lie") if alongside(bed.spot, spot))
    lie = replace(contact(HOME, Skill.LIEDOWN, "bed", "right leg bent"), spot=next(beds))
    floor = action_of(Skill.LIEDOWN, "curled up on the left side, knees drawn up", 1)
    sofa = contact(HOME, Skill.SITDOWN, "sofa", "sitting still", which=1)
    prone = contact(HOME, Skill.TOUCH, "table", "Low touch from a prone position")
    return {
        "on a bed": [to(bed), bed, lie, replace(bed, emotion=Emotion.TIRED), rise(bed)],
        "to and fro on a bed": [to(lie), lie, replace(lie, caption="side-lie on right"), rise(lie, Skill.GETUP)],
        "on the floor": [floor, replace(floor, caption="hands on belly"), rise(floor, Skill.GETUP), prone],
        "on a sofa": [to(sofa), sofa, replace(sofa, caption="cross-legged, hands on knees"), rise(sofa), to(floor)],
    }


def test_turns_are_as_recorded() -> None:
    found: dict[str, Any] = {}
    for height, (name, actions) in zip((1.3, 1.6, 1.7, 2.0), turns().items(), strict=True):
        state = DIRECTOR.begin(HOME, Character(height=height), 2)
        played = zip(actions, DIRECTOR.play(HOME, actions, state), strict=True)
        found[name] = {f"{n} {action.caption}": seen(motion) for n, (action, (motion, _)) in enumerate(played)}
    agrees("turns", found)


def seen(motion: Motion) -> list[list[float]]:
    """How long it takes; then where joints are from the pelvis, half way and in the end."""
    body, moments = Kinematics.of(motion), [len(motion) // 2, len(motion) - 1]
    level = rotations.inverse(rotations.yaw_to_quat(yaw_of(body.world[moments, 0])))
    around = rotations.rotate(level[:, None], body.positions[moments] - body.positions[moments, :1])
    rows = [[round(float(number), 3) + 0.0 for number in joints.ravel()] for joints in around[:, SEEN]]
    return [[float(len(motion)), round(float(body.positions[-1, 0, 1]), 3)], *rows]
