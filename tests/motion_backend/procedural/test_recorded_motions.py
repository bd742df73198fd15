"""Bodies of every size and mood move as they did when somebody last looked at them, and are judged as they were."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import pi
from typing import Any, Final

import numpy as np
from recorded import agrees
from small_home import DIRECTOR, contact, rise, small_home, to

from motion_backend import rotations
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.story_metrics import judge
from motion_backend.motion import Action, Character, Emotion, Motion, Skill
from motion_backend.scene import scene_of
from motion_backend.walk_generator import yaw_of
from scene_graphs.affordances.affordances import floor_spot

HOME: Final = small_home()
HEIGHTS: Final = {"a child": 1.17, "somebody small": 1.5, "somebody tall": 1.98}
MOMENTS: Final = 3
"""At which each motion is looked at, from a little after its first frame to its last."""


def days() -> Iterator[tuple[str, list[Action]]]:
    """What each of them does, one after the other."""
    chair = contact(HOME, Skill.SITDOWN, "chair", "hands behind head, cross-legged, lean back", Emotion.HAPPY)
    bed = contact(HOME, Skill.LIEDOWN, "bed", "side-lie on left, legs crossed", Emotion.SAD)
    shelf = contact(HOME, Skill.TOUCH, "shelf", "touch medium height with the left hand", Emotion.ANGRY)
    yield "a child", [
        Action(Skill.LOCO, "skip steps running", Emotion.HAPPY, goal=(3.2, 2.6)),
        to(chair, "walk to the front left", Emotion.HURRIED), chair, rise(chair),
        to(bed, "walk on tiptoes", Emotion.STRESSED), replace(bed, caption="hands on belly, left leg bent"),
        replace(rise(bed, Skill.GETUP), caption="get up quickly"),
    ]  # fmt: skip
    sofa = contact(HOME, Skill.SITDOWN, "sofa", "leaning forward, elbows on knees", Emotion.SAD, 1)
    floor = Action(
        Skill.SITDOWN, "right leg held, left leg stretched out", Emotion.NEUTRAL, "floor", "floor",
        floor_spot("sit", (3.3, 2.6), pi / 3),
    )  # fmt: skip
    yield "somebody small", [
        to(sofa, "walk wearily, dragging the feet", Emotion.SAD), sofa,
        replace(sofa, caption="reading, book held in both hands"),
        replace(rise(sofa), caption="stand up slowly"),
        to(floor, "walking with hands placed on the hips"), floor, rise(floor),
        to(shelf, "angrily walking", Emotion.ANGRY), shelf,
    ]  # fmt: skip
    yield "somebody tall", [
        Action(Skill.LOCO, "wave with the right hand", Emotion.RELAXED, goal=(3.0, 3.4), facing=0.4),
        to(shelf, "walk with large steps"), replace(shelf, caption="wash with both hands"),
        to(bed, "walk like an old person", Emotion.DRUNK), bed, replace(rise(bed, Skill.GETUP), caption="get up"),
        to(chair, "rush anxiously forward"), replace(chair, caption="left leg straightened"),
    ]  # fmt: skip


def test_motions_are_as_recorded() -> None:
    found: dict[str, Any] = {}
    for who, actions in days():
        state = DIRECTOR.begin(HOME, Character(height=HEIGHTS[who]), 3)
        made = [motion for motion, _ in DIRECTOR.play(HOME, actions, state)]
        rows = zip(actions, made, strict=True)
        found[who] = {f"{i} {one.skill}, {one.caption}": told(motion, one) for i, (one, motion) in enumerate(rows)}
    agrees("motions", found)


def told(motion: Motion, action: Action) -> dict[str, Any]:
    """What was measured, what it is made of, and where the body was."""
    body = Kinematics.of(motion)
    moments = np.linspace(len(motion) // 8, len(motion) - 1, MOMENTS).round().astype(int)
    level = rotations.inverse(rotations.yaw_to_quat(yaw_of(body.world[moments, 0])))
    around = rotations.rotate(level[:, None], body.positions[moments] - body.positions[moments, :1])
    figures = judge(motion, action, scene_of(HOME).obstacles).to_dict()
    return {
        "figures": {name: value for name, value in figures.items() if name not in ("keyframe", "skill")},
        "phases": [f"{phase.kind} {phase.start}-{phase.stop}" for phase in motion.phases],
        "planted": short(*motion.contacts.mean(axis=0)),
        "pelvis": [short(*place) for place in body.positions[moments, 0]],
        "joints": [short(*(number for joint in joints[1:] for number in joint)) for joints in around],
    }


def short(*numbers: float) -> list[float]:
    return [round(float(number), 3) + 0.0 for number in numbers]
