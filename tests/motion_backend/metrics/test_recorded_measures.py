"""All that is measured of a body is what it was when somebody last looked at it."""

from __future__ import annotations

from functools import cache
from typing import Any, Final

import numpy as np
from recorded import agrees
from sample_motions import tumbling
from small_home import DIRECTOR, contact, rise, small_home, to

from motion_backend.metrics.caption_predicates import MEASURES, judge_caption, shown
from motion_backend.metrics.gait_features import gait_features, windows
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.story_figures import story_figures
from motion_backend.metrics.story_flow import seams
from motion_backend.metrics.story_metrics import judge, summarise
from motion_backend.motion import Action, Character, Emotion, Motion, Skill, join
from motion_backend.scene import scene_of

HOME: Final = small_home()


@cache
def day() -> tuple[tuple[Action, Motion], ...]:
    """A body walks, sits, rises and takes something."""
    sofa = contact(HOME, Skill.SITDOWN, "sofa", "hands behind head, lean back, cross-legged")
    shelf = contact(HOME, Skill.TOUCH, "shelf", "pick up with the right hand")
    walk = Action(Skill.LOCO, "walking with hands placed on the hips", Emotion.HAPPY, goal=(3.0, 4.0))
    actions = [walk, to(sofa), sofa, rise(sofa), to(shelf, "marching with swinging arms", Emotion.ANGRY), shelf]
    state = DIRECTOR.begin(HOME, Character(height=1.55), 7)
    return tuple(zip(actions, (motion for motion, _ in DIRECTOR.play(HOME, actions, state)), strict=True))


def test_measures_are_as_recorded() -> None:
    bodies = {"tumbling": tumbling(60, height=1.5)} | {action.caption: motion for action, motion in day()}
    agrees("measures", {name: measured(motion) for name, motion in bodies.items()})


def measured(motion: Motion) -> dict[str, list[float]]:
    """Of every measure what it is at first, at last and on average."""
    body = Kinematics.of(motion)
    found = {name: np.asarray(measure(body)) for name, measure in MEASURES.items()}
    return {
        name: short(*np.ravel(values[0]), *np.ravel(values[-1]), *np.ravel(values.mean(axis=0)))
        for name, values in found.items()
    }


def test_verdicts_are_as_recorded() -> None:
    """Of what was acted, by the words that were said and by others."""
    said = [action.caption for action, _ in day()]
    found: dict[str, Any] = {}
    for action, motion in day():
        verdicts = {words: judge_caption(motion, action, words) for words in said}
        found[action.caption] = {
            "shown": len(shown(motion, action)),
            "missed": {words: list(one.missed) for words, one in verdicts.items() if one is not None and one.missed},
        }
        positions = motion.joint_positions().astype(np.float64)
        found[action.caption]["gait"] = [
            short(*features)
            for start, stop in windows(positions, motion.fps)
            if (features := gait_features(positions[start:stop], motion.fps)) is not None
        ]
    agrees("verdicts", found)


def test_figures_of_a_story_are_as_recorded() -> None:
    actions, motions = [action for action, _ in day()], [motion for _, motion in day()]
    whole, ends = join(motions), np.cumsum([len(motion) for motion in motions]).tolist()
    spans = list(zip([0, *ends[:-1]], ends, strict=True))
    judged = [judge(motion, action, scene_of(HOME).obstacles) for action, motion in day()]
    agrees("story_figures", {
        **story_figures(whole, actions, spans).to_dict(),
        "seams": [short(seam.frame, seam.walking, seam.stops, seam.speed, seam.slowest)
                  for seam in seams(Kinematics.of(whole), actions, spans)],
        "all": summarise(judged),
    })  # fmt: skip


def short(*numbers: float) -> list[float]:
    return [round(float(number), 3) + 0.0 for number in numbers]
