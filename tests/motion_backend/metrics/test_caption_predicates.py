"""What captions must look like: predicates that the neutral pose of a skill fails, and that notes can excuse."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from acted import Body, got_up, lain, risen_from, sat, touched, walked

from motion_backend.metrics.caption_predicates import (
    MEASURES,
    Check,
    judge_caption,
    kept_share,
    predicates,
    predicates_of,
    shown,
)
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Note, Skill
from planner_service.scripts.captions import captions


def neutral(skill: Skill) -> Body:
    """What the body does whose caption says no more than the skill."""
    match skill:
        case Skill.SITDOWN:
            return sat("chair", "sit")
        case Skill.LIEDOWN:
            return lain("bed", "lie")
        case Skill.GETUP:
            return got_up("bed", "hands on belly")
        case Skill.TOUCH:
            return touched("table", "medium", "touch medium height")
        case Skill.LOCO:
            return walked("steadily walking forward", home="hall")
    return risen_from("chair", "stand up")


@pytest.mark.parametrize("skill", Skill)
def test_every_caption_is_judged(skill: Skill) -> None:
    assert [one for one in captions()[skill] if not predicates_of(skill, one)] == []


@pytest.mark.parametrize("skill", Skill)
def test_the_neutral_pose_fails_every_caption_that_says_something_else(skill: Skill) -> None:
    body, passed = neutral(skill), []
    for caption in captions()[skill]:
        verdict = judge_caption(body.motion, body.action, caption)
        assert verdict is not None
        says = not all(row.neutral for row in predicates_of(skill, caption))
        if says == (not verdict.missed):
            passed.append((caption, verdict.missed))
    assert passed == []


@pytest.mark.parametrize("place", ["bed", "floor"])
def test_who_lies_does_what_the_words_say(place: str) -> None:
    some = captions()[Skill.LIEDOWN][::5]
    verdicts = [judge_caption(body.motion, body.action) for body in (lain(place, caption) for caption in some)]
    assert [verdict for verdict in verdicts if verdict is None or not verdict.kept] == []


def test_a_row_that_judges_no_caption_is_no_row() -> None:
    every = [(Skill(skill), caption) for skill, some in captions().items() for caption in some]
    assert [row.words for row in predicates() if not any(row.is_of(skill, caption) for skill, caption in every)] == []


def test_what_is_missed_is_excused_by_a_note_of_its_own_keyframe_and_of_its_own_kind() -> None:
    body = sat("chair", "sit")
    straight = "hands behind head, legs straight"
    for words, keyframe, noted in (
        ("no room ahead of the feet: legs bent", body.action.keyframe, False),
        ("no room ahead of the feet: legs bent", body.action.keyframe + 1, False),
        ("no piano: each hand in the air", body.action.keyframe, False),
    ):
        motion = replace(body.motion, notes=(Note(keyframe, words),))
        verdict = judge_caption(motion, body.action, straight)
        assert verdict is not None
        assert verdict.missed
        assert verdict.noted == noted, words
        # The hands are not at the head either, and nothing excuses that; of one leg alone the note is enough.
        one_leg = judge_caption(motion, body.action, "left leg straightened")
        assert one_leg is not None
        assert one_leg.kept == (words.endswith("legs bent") and keyframe == body.action.keyframe)


def test_a_caption_without_words_of_the_table_is_not_judged() -> None:
    body = sat("chair", "sit")
    assert judge_caption(body.motion, body.action, "sit") is None
    assert kept_share([None]) is None
    assert kept_share([None, judge_caption(body.motion, body.action, "hands on thighs")]) == 1.0


def test_a_share_of_the_frames_is_enough_where_the_row_says_so() -> None:
    body = sat("chair", "sit").kinematics
    height = MEASURES["pelvis_height"](body)
    seated = float((height < height[-1] + 0.05).mean())
    low = Check("pelvis_height", most=float(height[-1]) + 0.05, share=seated)
    assert low.holds(body)
    assert not replace(low, share=min(seated + 0.01, 1.0)).holds(body)


def test_measures_of_known_poses() -> None:
    body = sat("chair", "sit")
    held = Kinematics.of(shown(body.motion, body.action))
    found = {name: float(np.median(measure(held))) for name, measure in MEASURES.items()}
    assert 80 < found["knee"] < 115
    assert 60 < found["hip"] < 120
    assert found["foot_height"] == pytest.approx(0.0, abs=0.01)
    assert found["feet_apart"] > 0.1
    assert found["foot_ahead"] == pytest.approx(0.42, abs=0.1)
    assert found["hand_to_thigh"] < 0.17
    assert found["pelvis_height"] == pytest.approx(0.54, abs=0.06)
    assert found["pelvis_speed"] < 0.02
