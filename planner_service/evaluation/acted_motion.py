"""Hours of what our own body does in the rooms of the library, with its phases: what sitting, lying and rising is
learned from, of which no recordings are at hand.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from motion_backend.diffusion.dataset import Stretch, followed
from motion_backend.motion import FPS, Skill
from planner_service.evaluation.trials import Trial, act_trial, places_for, setting
from planner_service.grounding.keyframes_to_actions import UnreachableError
from planner_service.scripts.captions import captions, synonyms
from scene_graphs.layout_library import built_in_index
from scene_graphs.navigation.path_planner import NoPath

SHARES: Final = {
    Skill.LOCO: 0.34, Skill.SITDOWN: 0.18, Skill.STANDUP: 0.11, Skill.LIEDOWN: 0.11, Skill.GETUP: 0.09,
    Skill.TOUCH: 0.17,
}  # fmt: skip
"""How often each skill is drawn."""
CAPTIONS_A_ROOM: Final = 6
"""Tried before another room is drawn: what is worked out about a room takes longer than to act in it."""
KEPT_APART: Final = 7
"""One room in so many is never learned from."""


def is_for_training(room: str) -> bool:
    """Whether motion in a room is learned from; the same for everybody."""
    return zlib.crc32(room.encode()) % KEPT_APART != 0


def act_for_training(minutes: float, seed: int, unseen: bool = False) -> Iterator[Stretch]:
    """Captions by chance in rooms by chance until so much was acted; `unseen`: in the rooms that are kept apart."""
    rng, made = np.random.default_rng(seed), 0
    rooms = [layout.id for layout in built_in_index().layouts if is_for_training(layout.id) != unseen]
    while made < minutes * 60 * FPS:
        room = rooms[rng.integers(len(rooms))]
        for _ in range(CAPTIONS_A_ROOM):
            skill = list(SHARES)[rng.choice(len(SHARES), p=list(SHARES.values()))]
            caption, trial_seed = str(rng.choice(captions()[skill])), int(rng.integers(1 << 30))
            stretch = _acted(Trial(skill, caption, room, trial_seed), rng)
            if stretch is not None:
                made += len(stretch)
                yield stretch


def _acted(trial: Trial, rng: np.random.Generator) -> Stretch | None:
    """None where the room has no place for it, or the body did not do it."""
    if not places_for(trial.skill, trial.caption, setting(trial.room)):
        return None
    try:
        _, actions, motions = act_trial(trial)
    except (UnreachableError, NoPath):
        return None
    if not all(motion.completed for motion in motions):
        return None
    # Several wordings a caption (LINGO B.1.6).
    wordings = (trial.caption, *synonyms().get(trial.skill, {}).get(trial.caption, ()))
    told = (*actions[:-1], replace(actions[-1], caption=str(rng.choice(wordings))))
    return followed(told, motions, f"{trial.room}/{trial.seed}", trial.room)
