"""Hours of what our own body does in the rooms of the library, with its phases: what sitting, lying and rising is
learned from, of which no recordings are at hand; and, in rooms that nothing is learned in, whether the scheduler
(LINGO A.5) ends it when it is over. Windows follow one another as in acting; the right one is the first by whose end
the pelvis, or the hand, is where it stays.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.backend_protocol import PartKind
from motion_backend.diffusion.completion_scheduler import CompletionScheduler
from motion_backend.diffusion.dataset import PERIODIC, Stretch, followed
from motion_backend.diffusion.motion_features import STRIDE
from motion_backend.diffusion.rollout import NEW
from motion_backend.diffusion.sampler import Scale
from motion_backend.diffusion.windows import LEAD, Encode, WindowBank
from motion_backend.motion import FPS, Skill
from motion_backend.skeleton import INDEX, build_skeleton
from planner_service.evaluation.trials import Trial, act_trial, places_for, setting
from planner_service.grounding.keyframes_to_actions import UnreachableError
from planner_service.scripts.captions import captions, synonyms
from scene_graphs.layout_library import built_in_index
from scene_graphs.navigation.path_planner import NoPath

SHARES: Final = {
    Skill.LOCO: 0.26, Skill.SITDOWN: 0.15, Skill.STANDUP: 0.11, Skill.LIEDOWN: 0.11, Skill.GETUP: 0.14,
    Skill.TOUCH: 0.23,
}  # fmt: skip
"""How often each skill is drawn: all but a walk are walked to, and getting up is over soonest."""
CAPTIONS_A_ROOM: Final = 6
"""Tried before another room is drawn: what is worked out about a room takes longer than to act in it."""
KEPT_APART: Final = 7
"""One room in so many is never learned from."""
ENDS: Final = {PartKind.SIT: Skill.SITDOWN, PartKind.LIE: Skill.LIEDOWN, PartKind.REACH: Skill.TOUCH}
"""Of passages that end; a rise is from a seat or from lying."""
LATER: Final = 4
"""Windows after a passage's end that are still asked about: what is not over by then is never over."""
LIES: Final = 0.5
"""Share of the way from pelvis to head that goes up, under which a body lies."""


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


@dataclass(frozen=True)
class Ended:
    """One passage."""

    skill: Skill
    right: int
    """The window that it was over in."""
    found: int
    """The one after which the scheduler ended it; one beyond the last where it never did."""


def ends(
    scheduler: CompletionScheduler, seen_as: Scale, stretches: Sequence[Stretch], encode: Encode
) -> Iterator[Ended]:
    """Every passage that ends, of stretches that were never learned from."""
    bank = WindowBank(stretches, encode)
    for row, (index, passage) in enumerate(bank.passages):
        if passage.kind in PERIODIC or (passage.kind is PartKind.REACH and passage.hand is None):
            continue
        stretch = stretches[index]
        begin = sum(len(one) for one in stretches[:index]) + passage.start - LEAD
        count = (passage.stop - passage.start) // (NEW * STRIDE) + 1 + LATER
        starts = begin + NEW * STRIDE * np.arange(count)
        batch = bank.batch(starts, np.full(count, row), np.zeros(count, dtype=np.bool_))
        over = scheduler.over(seen_as.encode(batch.windows), batch.given.text, batch.given.frame)
        yield Ended(_skill(stretch, passage.start, passage.kind), _first(batch.over.numpy()), _first(over))


def summed_ends(found: Sequence[Ended]) -> dict[str, dict[str, float]]:
    """Shares ended in the right window and within one of it: by skill, over all, and the mean of the skills."""
    skills = sorted({one.skill for one in found}, key=list(Skill).index)
    rows = {skill.value: _shares([one for one in found if one.skill is skill]) for skill in skills}
    names = ("right", "within_one", "early")
    mean = {name: float(np.mean([row[name] for row in rows.values()])) for name in names}
    return {**rows, "all": _shares(found), "mean of skills": mean}


def _shares(found: Sequence[Ended]) -> dict[str, float]:
    late = np.array([one.found - one.right for one in found])
    return {
        "right": float((late == 0).mean()), "within_one": float((np.abs(late) <= 1).mean()),
        "early": float((late < 0).mean()), "passages": float(len(late)),
    }  # fmt: skip


def _skill(stretch: Stretch, frame: int, kind: PartKind) -> Skill:
    if kind is not PartKind.RISE:
        return ENDS[kind]
    places, _ = build_skeleton().forward_kinematics(stretch.roots[frame][None], stretch.local[frame][None])
    way = places[0, INDEX["head"]] - places[0, 0]
    return Skill.GETUP if way[1] < LIES * np.linalg.norm(way) else Skill.STANDUP


def _first(flags: NDArray[np.bool_]) -> int:
    return int(np.argmax(flags)) if flags.any() else len(flags)
