"""Who flings a leg forwards does so where nothing is in its way."""

from __future__ import annotations

import numpy as np
import pytest
from small_home import DIRECTOR, small_home

from motion_backend.backend_protocol import BodyState
from motion_backend.body.scene_collision import Obstacles
from motion_backend.metrics.caption_predicates import judge_caption
from motion_backend.motion import Action, Character, Emotion, Skill
from motion_backend.rotations import wrap
from motion_backend.skeleton import INDEX

HOME = small_home()
KICK = Action(Skill.LOCO, "kicking with the right foot", Emotion.NEUTRAL, "floor", hold=3.0)
LEG = [INDEX["right_knee"], INDEX["right_ankle"], INDEX["right_foot"]]


@pytest.mark.parametrize("place", [(3.2, 0.85), (2.5, 1.2), (1.2, 3.4)])
@pytest.mark.parametrize("yaw", [np.pi, -np.pi / 2, 0.0])
def test_a_kick_meets_no_furniture_wherever_one_looks(place: tuple[float, float], yaw: float) -> None:
    motion, _ = DIRECTOR.act(HOME, KICK, BodyState.standing(place, yaw, Character(), 3))
    joints = motion.joint_positions().astype(np.float64)
    assert Obstacles.of_home(HOME).solid().depth(joints[:, LEG].reshape(-1, 3)).max() < 0.0
    assert joints[:, INDEX["right_ankle"], 1].max() > 0.35
    verdict = judge_caption(motion, KICK)
    assert verdict is not None
    assert verdict.kept, verdict.missed


def test_who_has_room_kicks_where_one_looks() -> None:
    motion, after = DIRECTOR.act(HOME, KICK, BodyState.standing((3.0, 2.5), 0.3, Character(), 3))
    assert abs(wrap(after.yaw - 0.3)) < 0.15
    assert len(motion) < 7 * motion.fps
