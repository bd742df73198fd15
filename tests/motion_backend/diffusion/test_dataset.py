"""What our own body acted becomes passages that follow on each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from sample_motions import standing_still

from motion_backend.backend_protocol import PartKind
from motion_backend.diffusion.dataset import followed
from motion_backend.motion import Action, Emotion, Phase, PhaseKind, Skill


def test_passages_of_one_action_begin_where_those_of_the_one_before_end() -> None:
    walked, sat = (
        replace(standing_still(frames), phases=tuple(Phase(kind, start, stop) for kind, start, stop in phases))
        for frames, phases in (
            (30, [(PhaseKind.WALK, 0, 20), (PhaseKind.STAND, 20, 30)]),
            (12, [(PhaseKind.WALK, 0, 0), (PhaseKind.SITDOWN, 0, 12)]),
        )
    )
    actions = [Action(skill, "x", Emotion.NEUTRAL) for skill in (Skill.LOCO, Skill.SITDOWN)]
    stretch = followed(actions, [walked, sat], "a day", None)
    assert [(one.start, one.stop, one.kind) for one in stretch.passages] == [
        (0, 20, PartKind.WALK),
        (20, 30, PartKind.TURN),
        (30, 42, PartKind.SIT),
    ]
    assert len(stretch) == len(walked) + len(sat)
    np.testing.assert_allclose(stretch.roots[30:], sat.root_positions)
