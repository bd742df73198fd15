"""Who dances at a piece of furniture steps back from it as far as its legs need, and is still by it."""

from __future__ import annotations

import numpy as np
import pytest
from small_home import DIRECTOR, small_home

from motion_backend.backend_protocol import BodyState
from motion_backend.metrics.contact_error import HAND_OVER
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.penetration import CLEARLY_IN, penetration
from motion_backend.motion import Action, Character, Emotion, PhaseKind, Skill
from motion_backend.scene import scene_of

HOME = small_home()


PLACES = {"table": ((1.2, 3.82), 0.0), "table's end": ((1.98, 4.3), -np.pi / 2), "shelf": ((3.2, 0.46), np.pi)}


@pytest.mark.parametrize("at", PLACES)
@pytest.mark.parametrize("caption", ["dancing steps, arms swinging", "sweeping the floor with both hands"])
def test_legs_keep_out_of_it_and_the_body_ends_within_reach(at: str, caption: str) -> None:
    place, yaw = PLACES[at]
    piece = at.split("'")[0]
    action = Action(Skill.LOCO, caption, Emotion.HAPPY, piece, f"0/{piece}", goal=place, stands=9.0)
    motion, _ = DIRECTOR.act(HOME, action, BodyState.standing(place, yaw, Character(), 3))
    does_it = motion.phases[-1]
    assert does_it.kind is PhaseKind.STAND
    assert len(motion) - does_it.start > 6 * motion.fps
    body = Kinematics.of(motion.part(does_it.start, len(motion)))
    assert penetration(body, scene_of(HOME).obstacles, action).max() < CLEARLY_IN
    assert np.linalg.norm(motion.root_positions[-1, [0, 2]] - np.array(place)) < HAND_OVER
