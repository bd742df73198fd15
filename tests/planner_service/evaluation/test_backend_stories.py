"""Stories by several backends: seams are told from what is inside, people who were learned from judge nobody."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_motions import tumbling
from typer.testing import CliRunner

from motion_backend.mocap.dataset_file import Dataset, Entry
from motion_backend.motion import Motion, Phase, PhaseKind, Skill
from motion_backend.skeleton import build_skeleton
from planner_service.cli import app
from planner_service.evaluation.acted_motion import Ended, summed_ends
from planner_service.evaluation.backend_stories import left_to_others_of, seams_of, seven_themes
from planner_service.evaluation.walk_comparison import with_sides

AT = 40


def gliding() -> Motion:
    """Straight on at one speed, two phases by two backends."""
    motion = tumbling(90)
    root = np.linspace([0.0, 0.9, 0.0], [0.0, 0.9, 3.0], 90).astype(np.float32)
    local = np.repeat(motion.local_rotations[:1], 90, axis=0)
    phases = (
        Phase(PhaseKind.WALK, 0, AT, "diffusion"),
        Phase(PhaseKind.WALK, AT, 90, "procedural", "diffusion: feet slid"),
    )
    return replace(motion, root_positions=root, local_rotations=local, phases=phases, actions=np.zeros(90, np.int32))


def test_a_change_of_speed_counts_at_its_seam_and_nowhere_else() -> None:
    motion = gliding()
    assert seams_of(motion).at == pytest.approx([0.0], abs=1e-3)
    root = motion.root_positions.copy()
    root[AT:, 0] += np.linspace(0, 0.5, 50)  # 0.3 m/s aside from the seam on
    found = seams_of(replace(motion, root_positions=root))
    assert found.at == pytest.approx([0.5 / 49 * 30], abs=1e-3)
    assert found.inside.max() < 1e-3
    assert len(found.at) + len(found.inside) == 90 - 2 - 1


def test_a_new_keyframe_is_a_seam_too() -> None:
    motion = gliding()
    assert len(seams_of(replace(motion, actions=np.repeat([0, 1], 45).astype(np.int32))).at) == 2


def test_what_is_left_to_others_is_told_in_seconds_with_the_reason() -> None:
    assert left_to_others_of(gliding(), "diffusion") == {"walk, procedural: diffusion: feet slid": round(50 / 30, 1)}


def test_people_who_were_learned_from_judge_nobody_however_they_were_dealt() -> None:
    entries = tuple(
        Entry(
            name=name, skill="loco", style="neutral", emotion="neutral", captions=("walk",), subject=name,
            kind="real mocap", licence="ours", source="made here", changed=(), split=split, motion=tumbling(9),
            hands=np.zeros((9, 2), dtype=np.bool_),
        )
        for name, split in (("anna", "test"), ("bert", "train"), ("carl", "test"))
    )  # fmt: skip
    dataset = Dataset(build_skeleton(), entries)
    dealt = {entry.subject: entry.split for entry in with_sides(dataset, ("anna",)).entries}
    assert dealt == {"anna": "train", "bert": "test", "carl": "test"}
    assert with_sides(dataset, ()) is dataset


def test_ends_are_counted_by_skill_and_over_all() -> None:
    found = [Ended(Skill.SITDOWN, 2, 2), Ended(Skill.SITDOWN, 2, 1), Ended(Skill.TOUCH, 1, 4)]
    figures = summed_ends(found)
    assert figures["sitdown"] == {"right": 0.5, "within_one": 1.0, "early": 0.5, "passages": 2.0}
    assert figures["touch"]["within_one"] == 0.0
    assert figures["all"]["right"] == pytest.approx(1 / 3)
    assert figures["all"]["passages"] == 3


def test_a_theme_that_is_none_of_the_seven_is_refused() -> None:
    assert len(seven_themes()) == 7
    found = CliRunner().invoke(app, ["evaluate", "motion", "--stories", "--theme", "holiday"])
    assert "'holiday' is none of weekend" in str(found.exception)
