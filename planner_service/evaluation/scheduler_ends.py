"""Whether the scheduler (LINGO A.5) ends what it has never seen when it is over, window by window, skill by skill.

Judged by what our own body does in rooms that nothing is learned in; recordings have hardly any ends. Windows follow
one another as they do in acting. The right window is the first by whose end the pelvis, or the hand, is where it stays.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import torch

from motion_backend.backend_protocol import PartKind
from motion_backend.diffusion.completion_scheduler import DONE, CompletionScheduler
from motion_backend.diffusion.dataset import PERIODIC, Stretch
from motion_backend.diffusion.motion_features import STRIDE
from motion_backend.diffusion.rollout import NEW
from motion_backend.diffusion.sampler import Scale
from motion_backend.diffusion.windows import LEAD, Encode, WindowBank
from motion_backend.motion import Skill
from motion_backend.skeleton import INDEX, build_skeleton

SKILLS: Final = {PartKind.SIT: Skill.SITDOWN, PartKind.LIE: Skill.LIEDOWN, PartKind.REACH: Skill.TOUCH}
"""Of passages that end; a rise is from a seat or from lying."""
LATER: Final = 4
"""Windows after a passage's end that are still asked about: what is not over by then is never over."""
LIES: Final = 0.5
"""Share of the way from pelvis to head that goes up, under which a body lies."""


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
        with torch.inference_mode():
            over = scheduler(seen_as.encode(batch.windows), batch.given.text, batch.given.frame) > DONE
        yield Ended(_skill(stretch, passage.start, passage.kind), _first(batch.over.numpy()), _first(over.numpy()))


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
        return SKILLS[kind]
    places, _ = build_skeleton().forward_kinematics(stretch.roots[frame][None], stretch.local[frame][None])
    way = places[0, INDEX["head"]] - places[0, 0]
    return Skill.GETUP if way[1] < LIES * np.linalg.norm(way) else Skill.STANDUP


def _first(flags: np.ndarray) -> int:
    return int(np.argmax(flags)) if flags.any() else len(flags)
