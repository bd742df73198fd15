"""Clips come whole, in all their words, and mirrored together with them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from examples import tries
from hypothesis import given
from hypothesis import strategies as st
from sample_motions import tumbling

from motion_backend.datasets.motion_text_dataset import (
    SAMPLED,
    MotionText,
    MotionTextDataset,
    may_mirror,
    motion_texts,
    skip_sample,
    states_of,
)
from motion_backend.datasets.normalization import Normalization
from motion_backend.mocap.dataset_file import Entry
from motion_backend.physics.observations import STATE_SIZE, mirror_state


def text(name: str, *wordings: str, group: str = "", seed: int = 0) -> MotionText:
    return MotionText(f"room/0/{name}/{wordings[0]}", states_of(tumbling(30, seed)), wordings, group or wordings[0])


@given(st.integers(1, 5000))
@tries(30)
def test_all_of_a_clip_is_in_its_300_frames(frames: int) -> None:
    chosen = skip_sample(0, frames)
    assert chosen.shape == (SAMPLED,)
    steps = np.diff([-1, *chosen, frames])
    assert (steps[1:-1] >= 0).all()
    assert steps.max() <= frames / SAMPLED + 1, "no more is skipped at one place than at another"
    assert set(chosen) == set(range(frames)) or frames > SAMPLED


def test_what_is_drawn_mirrored_has_mirrored_words() -> None:
    clip = text("touch", "touch low height with the left hand", "reach down with the left hand")
    drawn = MotionTextDataset((clip,)).draw(64, np.random.default_rng(0))
    assert drawn.states.shape == (64, SAMPLED, STATE_SIZE)
    seen = {"left": clip.states, "right": mirror_state(clip.states)}
    sides = [next(side for side in seen if side in wording) for wording in drawn.wordings]
    assert {sides.count("left") > 16, sides.count("right") > 16} == {True}
    for states, side, group in zip(drawn.states, sides, drawn.groups, strict=True):
        assert side in group
        rows = seen[side].astype(np.float32)
        assert all((np.abs(rows - frame).max(axis=1) < 1e-3).any() for frame in states[::50])
    assert len(set(drawn.wordings)) == 4


def test_a_touch_that_names_no_hand_is_not_mirrored() -> None:
    silent, named = text("touch", "touch low height"), text("touch", "pick up with the right hand")
    assert (may_mirror(silent), may_mirror(named), may_mirror(text("touch", "wash with both hands"))) == (0, 1, 1)
    assert may_mirror(text("sitdown", "crossing arms"))
    drawn = MotionTextDataset((silent,)).draw(20, np.random.default_rng(0))
    assert set(drawn.wordings) == {"touch low height"}


def test_groups_know_the_words_of_their_mirrored_clips() -> None:
    left, right = text("loco", "walk to the front left"), text("loco", "walk to the front right", "step to the right")
    dataset = MotionTextDataset((left, right, text("loco", "walk", group=" ")))
    assert dataset.grouped["walk to the front left"] == ("step to the left", "walk to the front left")
    assert set(dataset.grouped["walk to the front right"]) <= set(dataset.wordings)


def test_the_same_chance_draws_the_same() -> None:
    dataset = MotionTextDataset((text("sitdown", "crossing arms"), text("loco", "walk", seed=1)))
    one, same = (dataset.draw(5, np.random.default_rng([3, 1])) for _ in range(2))
    assert one.wordings == same.wordings
    np.testing.assert_array_equal(one.states, same.states)


def test_clips_of_a_collection_keep_their_captions_and_short_ones_go() -> None:
    words = dict.fromkeys(("skill", "style", "emotion", "subject", "kind", "licence", "source", "split"), "x")
    own = {"captions": ("walk", "stroll"), "changed": (), "motion": tumbling(40), "hands": np.zeros((40, 2), bool)}
    whole = Entry(name="a", **words, **own)  # type: ignore[arg-type]
    short = replace(whole, motion=tumbling(10))
    (one,) = motion_texts([whole, short])
    assert (one.wordings, one.group, one.states.shape) == (("walk", "stroll"), "x", (40, STATE_SIZE))
    assert motion_texts([whole], grouped=False)[0].group == ""
    with pytest.raises(ValueError, match="none to learn from"):
        MotionTextDataset(())


def test_a_scale_makes_rows_alike_and_is_undone() -> None:
    rows = np.random.default_rng(0).normal(5, [1.0, 100.0, 1e-9], (400, 3))
    scale = Normalization.of(rows, 0.01)
    told = scale.apply(rows)
    np.testing.assert_allclose(told.mean(axis=0), 0, atol=1e-3)
    np.testing.assert_allclose(told.std(axis=0), [1, 1, 0], atol=1e-3)
    np.testing.assert_allclose(scale.undo(told), rows, rtol=1e-4)
    with pytest.raises(ValueError, match="rows"):
        Normalization.of(np.full((2, 3), np.nan), 0.01)
