"""Bodies do what they did when somebody last looked at them, and are judged as they were."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from recorded import agrees

from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Skill
from motion_backend.skeleton import INDEX
from planner_service.evaluation.trials import Trial, perform

ROOM: Final = "living-room-0022"
CAPTIONS: Final = (
    (Skill.LOCO, "walking drunkenly"),
    (Skill.SITDOWN, "typing, both hands on the keyboard"),
    (Skill.SITDOWN, "resting hands on the armrests, legs spread apart"),
    (Skill.LIEDOWN, "curled up on the left side, knees drawn up"),
    (Skill.TOUCH, "touch low height with the right hand"),
    (Skill.TOUCH, "An act of reaching high with the left hand"),
)
SEEN: Final = [INDEX[name] for name in ("pelvis", "head", "left_wrist", "right_wrist", "left_foot", "right_foot")]
MOMENTS: Final = 5
"""At which it is looked at, from the first frame to the last."""


def test_trials_are_as_recorded() -> None:
    trials = [Trial(skill, caption, ROOM, seed) for seed, (skill, caption) in enumerate(CAPTIONS)]
    agrees("trials", {f"{trial.skill.value}, {trial.caption}": acted(trial) for trial in trials})


def acted(trial: Trial) -> dict[str, Any]:
    """What was measured, and where the body was, in metres."""
    done = perform(trial)
    body = Kinematics.of(done.motion)
    moments = np.linspace(0, len(done.motion) - 1, MOMENTS).round().astype(int)
    return {**done.to_dict(), "positions": body.positions[moments][:, SEEN].round(3).astype(float).tolist()}
