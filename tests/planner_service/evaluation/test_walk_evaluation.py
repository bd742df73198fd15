"""`sims evaluate walks`: recorded walks are chosen by what they are, and ours compared with them."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from motion_backend.metrics.gait_features import UNITS
from motion_backend.mocap.clip import ClipError
from motion_backend.mocap.dataset_builder import Kept, collect, folder_labels, read_folder
from motion_backend.mocap.dataset_file import Dataset, Entry, dataset_bytes
from motion_backend.motion import Emotion, Motion
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose_solver import solve
from motion_backend.procedural.walk.gait import walk
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.skeleton import build_skeleton
from planner_service.cli import app
from planner_service.evaluation.walk_evaluation import (
    CAPTION,
    MAX_WINDOWS,
    WalkReport,
    evaluate_walks,
    jerk_bins,
    matched_walks,
    recorded_walks,
)

MOTION = Path(os.environ.get("SIMS_TEST_DATA", ".")) / "motion"
SKELETON = build_skeleton()
PEOPLE = 5


@cache
def walked(speed: float, seed: int, length: float = 6.0) -> Motion:
    style = replace(walk_style(Emotion.NEUTRAL, CAPTION), speed=speed)
    start, way = standing((0.0, 0.0), 0.0, style.bearing, SKELETON), np.array([[0.0, 0.0], [0.0, length]])
    pose = walk(start, way, None, style, SKELETON, np.random.default_rng(seed))
    root, local = solve(pose, SKELETON)
    contacts = np.repeat(pose.planted, 2, axis=1).astype(np.float32)
    actions = np.zeros(len(pose), dtype=np.int32)
    return Motion(root.astype(np.float32), local.astype(np.float32), contacts, SKELETON, actions)


def entry(person: int, motion: Motion, **changes: Any) -> Entry:
    plain = Entry(
        name=f"{person}", skill="loco", style="neutral", emotion="neutral", captions=("a person walks",),
        subject=f"person {person}", kind="real mocap", licence="", source="", changed=(), split="train", motion=motion,
        hands=np.zeros((len(motion), 2), dtype=np.bool_),
    )  # fmt: skip
    return replace(plain, **changes)


@cache
def collection() -> Dataset:
    """Walks of our own that pass for recorded ones, and what must not be taken for one."""
    entries = [entry(person, walked(0.9 + 0.12 * person, person)) for person in range(PEOPLE)]
    odd: list[dict[str, Any]] = [
        {"style": "zombie"}, {"style": "running/hurried"}, {"captions": ("a person runs",)}, {"kind": "hand-keyed"},
        {"kind": "model-generated"}, {"changed": ("mirrored",)}, {"skill": "touch"}, {"style": "exaggerated stride"},
    ]  # fmt: skip
    entries += [entry(9, walked(1.0, 9), **changes) for changes in odd]
    return Dataset(SKELETON, tuple(entries))


def test_only_plain_recorded_walks_are_compared_with() -> None:
    found = recorded_walks(collection())
    assert set(found.groups) == {f"person {person}" for person in range(PEOPLE)}
    assert len(found) == len(found.features) == len(found.groups) == len(found.skates)


def test_another_style_is_compared_with_where_it_is_asked_for() -> None:
    entries = tuple(entry(person, walked(1.0, person), style="sneaky") for person in range(PEOPLE))
    dataset = Dataset(SKELETON, entries)
    assert len(set(recorded_walks(dataset, "sneak").groups)) == PEOPLE
    with pytest.raises(ClipError, match="0 people"):
        recorded_walks(dataset)


def test_nobody_counts_for_more_than_a_dozen_windows() -> None:
    entries = list(collection().entries) + [entry(0, walked(1.0, 20 + k)) for k in range(6)]
    found = recorded_walks(Dataset(SKELETON, tuple(entries)))
    assert found.groups.count("person 0") == MAX_WINDOWS


def test_too_few_people_say_what_to_do() -> None:
    few = Dataset(SKELETON, collection().entries[:2])
    with pytest.raises(ClipError, match=r"2 people.*sims clips build"):
        recorded_walks(few)


def test_ours_walk_at_the_speeds_they_are_given() -> None:
    speeds = np.array([0.8, 1.2, 1.6])
    found = matched_walks(speeds, CAPTION, SKELETON)
    np.testing.assert_allclose(found.of("speed"), speeds, rtol=0.09)
    np.testing.assert_array_equal(matched_walks(speeds, CAPTION, SKELETON).features, found.features)


@cache
def report() -> WalkReport:
    return evaluate_walks(collection(), rooms=1, seeds=1)


@pytest.mark.sweep
def test_walks_like_the_recorded_ones_are_nearer_than_others() -> None:
    distance = {one.walks.name: one.distance.value for one in report().compared}
    assert distance["at recorded speeds"] < 0.40 < distance["sad"]
    assert all(0.7 < one.ours / one.recorded < 1.4 for one in report().jerk)
    told = report().to_dict()
    assert list(told["recorded"]["features"]) == list(told["deviations_apart"]) == list(UNITS)
    assert (told["physics_mode"], told["backend"], told["recorded"]["people"]) == ("none", "procedural", PEOPLE)
    recorded = report().recorded
    assert all(one.ours == one.recorded for one in jerk_bins(recorded, recorded))


@pytest.mark.sweep
def test_the_command_prints_what_was_measured(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def measured(*words: object) -> WalkReport:
        asked.append(words[1:])
        return report()

    monkeypatch.setattr("planner_service.evaluation.walk_evaluation.evaluate_walks", measured)
    file = tmp_path / "clips.npz"
    file.write_bytes(dataset_bytes(collection()))
    words = ["evaluate", "walks", "--clips", str(file), "--rooms", "2"]
    shown = CliRunner().invoke(app, words, env={"COLUMNS": "140"})
    assert shown.exit_code == 0, shown.output
    for name in (*UNITS, "people among themselves", "at recorded speeds", "in rooms", "drunk", "physics_mode none"):
        assert name in shown.output
    told = json.loads(CliRunner().invoke(app, [*words, "--style", "slow", "--json"]).output)
    assert told["recorded"]["windows"] == told["compared"][0]["windows"]
    assert asked == [("", CAPTION, 2, 3), ("slow", CAPTION, 2, 3)]


@pytest.mark.skipif(not (MOTION / "manifest.csv").is_file(), reason="SIMS_TEST_DATA holds no motion")
def test_recorded_people_walk_as_people_do() -> None:
    labels = {key: label for key, label in folder_labels(MOTION).items() if key[0] in FILES}
    kept = [one.entry for one in read_folder(MOTION, labels) if isinstance(one, Kept)]
    found = recorded_walks(collect(kept))
    assert len(set(found.groups)) == len({file[8:10] for file in FILES})
    assert 0.8 < np.median(found.of("stride_rate")) < 1.1
    assert 0.03 < np.median(found.of("step_width")) < 0.15
    assert 0.5 < np.median(found.of("duty_factor")) < 0.7
    assert 0.9 < np.median(found.of("knee_range")) < 1.3


FILES = tuple(f"cmu_bvh/{trial}.bvh" for trial in ("02_01", "06_01", "07_01", "08_01", "12_01", "35_01"))
