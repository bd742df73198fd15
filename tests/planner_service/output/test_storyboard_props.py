"""A storyboard shows what is in the hands, at the moment in which it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from for_each import for_each

from motion_backend.body.cast import Role, acted_captions
from motion_backend.motion import Skill
from motion_backend.rendering.motion_figures import Acting, home_props
from planner_service.evaluation.trials import act_trial, setting
from planner_service.output.caption_sheets import trial_of
from planner_service.output.storyboard import _camera, _panel, _picture, _Stage
from planner_service.scripts.script import Keyframe

MIN_PIXELS = 25
"""Of what is held, in a picture of 356 by 268."""


@for_each(
    ("skill", "caption"),
    [
        (Skill.SITDOWN, "drinking from a cup in the right hand"),
        (Skill.SITDOWN, "reading, book held in both hands"),
        (Skill.LOCO, "walk while talking on the phone with the right hand"),
    ],
)
def test_what_is_held_is_seen_in_the_picture_of_its_moment(skill: Skill, caption: str) -> None:
    trial = trial_of(skill, caption, None, 0)
    _, actions, motions = act_trial(trial)
    home, motion, role = setting(trial.room).home, motions[-1], Role(captions=acted_captions(actions))
    stage = _Stage(home, motion, motion.joint_positions(), home_props(home), Acting.of(motion, role), role)
    index = int(motion.actions[-1])
    panel = _panel(stage, index, Keyframe(skill=skill, caption=caption), None, ())
    bare = replace(stage, acting=replace(stage.acting, props=()))
    camera = _camera(stage, panel.shot)
    shown = np.any(_picture(stage, panel.shot, camera) != _picture(bare, panel.shot, camera), axis=-1)
    assert shown.sum() >= MIN_PIXELS
