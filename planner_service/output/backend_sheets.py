"""One picture of what several backends make of the same actions in the same rooms, one under the other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from motion_backend.body.cast import Role, acted_captions
from motion_backend.director import Director, shares
from motion_backend.motion import Skill
from planner_service.evaluation.trials import Trial, act_trial, places_for, setting
from planner_service.grounding.keyframes_to_actions import UnreachableError
from planner_service.scripts.captions import captions
from scene_graphs.layout_library import built_in_index
from scene_graphs.navigation.path_planner import NoPath

SKILLS: Final = (Skill.LOCO, Skill.SITDOWN, Skill.STANDUP, Skill.LIEDOWN, Skill.TOUCH)
"""One of each is drawn."""


def draw_backends(directors: Sequence[tuple[str, Director]], folder: Path, seed: int = 0) -> Iterator[Path]:
    """A sheet of each skill: a caption by chance in a room by chance, acted by every director, a row each."""
    from motion_backend.rendering.contact_sheet import sheet
    from motion_backend.rendering.motion_figures import save_png

    folder.mkdir(parents=True, exist_ok=True)
    for skill in SKILLS:
        trial = _drawn(skill, seed)
        rows = []
        for name, director in directors:
            _, actions, motions = act_trial(trial, director)
            motion, role = motions[-1], Role(captions=acted_captions(actions))
            own = ", ".join(f"{who} {share:.0%}" for who, share in shares(motion).items())
            rows.append((f"{name} ({own}) · {trial.caption} · {trial.room}", motion))
        path = folder / f"{skill.value}.png"
        save_png(sheet(rows, setting(trial.room).home, roles=[role] * len(rows)), path)
        yield path


def _drawn(skill: Skill, seed: int) -> Trial:
    """The first trial by chance that its room has a place for."""
    rng = np.random.default_rng([seed, list(Skill).index(skill)])
    rooms = [layout.id for layout in built_in_index().layouts]
    while True:
        trial = Trial(skill, str(rng.choice(captions()[skill])), str(rng.choice(rooms)), int(rng.integers(1 << 31)))
        if not places_for(skill, trial.caption, setting(trial.room)):
            continue
        try:
            act_trial(trial)
        except (UnreachableError, NoPath):
            continue
        return trial
