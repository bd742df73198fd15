"""What is in no hand lies near: before it is taken and after, of what is small and in no pocket."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from sample_motions import standing_still

from motion_backend.body.cast import Rest, Role
from motion_backend.motion import Motion, Skill, join
from motion_backend.props import PropTrack, prop_tracks
from planner_service.evaluation.trials import perform
from planner_service.output.caption_sheets import trial_of

CUP, PHONE = "drinking from a cup in the right hand", "looking at the phone in the right hand"


@cache
def told(caption: str) -> tuple[Motion, tuple[int, int]]:
    """Somebody stands, does something as they sit, and stands; and from when to when they sit."""
    done = perform(trial_of(Skill.SITDOWN, caption, None, 0)).motion
    parts = [standing_still(60), done, standing_still(60)]
    parts = [replace(one, actions=np.full(len(one), number, dtype=np.int32)) for number, one in enumerate(parts)]
    return join([replace(one, skeleton=done.skeleton) for one in parts]), (60, 60 + len(done))


def role(caption: str, away: float) -> Role:
    motion, (_, stop) = told(caption)
    x, _, z = motion.root_positions[stop - 1].astype(float).tolist()
    return Role(captions={1: (Skill.SITDOWN, caption)}, rests={1: Rest((x + away, 0.7, z), 0.5 * np.pi)})


def lying(caption: str, away: float) -> list[PropTrack]:
    found = prop_tracks(told(caption)[0], role(caption, away))
    return [one for one in found if one.lying is not None and one.lying.all()]


def test_a_cup_stands_where_it_is_taken_from_and_put_down_and_is_once_at_a_time() -> None:
    motion, (start, stop) = told(CUP)
    before, after = lying(CUP, 0.8)
    held = next(one for one in prop_tracks(motion, role(CUP, 0.8)) if one.lying is None or not one.lying.all())
    assert (before.start, after.stop) == (0, len(motion))
    assert before.stop > start - 1
    assert after.start < stop + 1
    for frame in range(len(motion)):
        whole = [one.sizes[frame - one.start] for one in (before, held, after) if one.start <= frame < one.stop]
        assert max(whole) >= 0.4, "it is somewhere in every frame"
        assert sum(whole) <= 1.3, "and not twice"


def test_it_lies_on_the_top_and_beyond_its_edge() -> None:
    at = np.array(role(CUP, 0.8).rests[1].at)
    for one in lying(CUP, 0.8):
        vertices, _ = one.shape.moved(one.positions[0], one.turns[0], 1.0)
        assert vertices[:, 1].min() == pytest.approx(at[1], abs=1e-3)
        assert one.positions[0, 0] > at[0]


def test_nothing_is_laid_far_away_nor_what_a_pocket_takes() -> None:
    assert lying(CUP, 4.0) == []
    assert lying(PHONE, 0.8) == []
