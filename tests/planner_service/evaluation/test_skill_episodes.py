"""Episodes are drawn without end, and nothing is judged where it was learned."""

from __future__ import annotations

from itertools import islice
from typing import cast

import pytest

from motion_backend.motion import Skill
from planner_service.evaluation import skill_episodes
from planner_service.evaluation.acted_motion import is_for_training
from planner_service.evaluation.trials import Trial
from planner_service.scripts.captions import captions


@pytest.mark.parametrize("unseen", [True, False])
def test_what_is_learned_and_what_is_judged_is_drawn_in_rooms_apart(
    unseen: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(skill_episodes, "episode_of", lambda trial: trial)
    drawn = cast("list[Trial]", list(islice(skill_episodes.episodes(Skill.SITDOWN, 3, unseen), 40)))
    assert {is_for_training(trial.room) for trial in drawn} == {not unseen}
    assert {trial.caption for trial in drawn} <= set(captions()[Skill.SITDOWN])
    assert len({trial.seed for trial in drawn}) == 40
    assert max(trial.seed for trial in drawn) < 1 << 31
