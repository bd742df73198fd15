"""Weights, sizes and passages that cannot be used are refused, and say which they are and why."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from for_each import for_each
from safetensors.torch import load_file, save_file
from small_home import DIRECTOR, small_home

from motion_backend.backend_protocol import Part, PartKind
from motion_backend.body.joint_limits import out_of_cone, overbent
from motion_backend.diffusion.checkpoint import (
    CheckpointError,
    Weights,
    load_denoiser,
    load_scheduler,
    read_tensors,
    save_weights,
)
from motion_backend.diffusion.completion_scheduler import CompletionScheduler, SchedulerSizes
from motion_backend.diffusion.conditions import GAITS, MadeOf
from motion_backend.diffusion.dataset import Passage, Stretch
from motion_backend.diffusion.denoiser import Denoiser, DenoiserSizes
from motion_backend.diffusion.motion_features import FEATURES
from motion_backend.diffusion.noise_schedule import NoiseSchedule
from motion_backend.diffusion.passage_checks import RefusedError, check, refuse_beyond
from motion_backend.diffusion.planned_passages import PlannedPassage
from motion_backend.diffusion.sampler import Scale
from motion_backend.diffusion.transformer import Encoder
from motion_backend.diffusion.windows import WindowBank, gaits
from motion_backend.mocap.clip import ClipError
from motion_backend.motion import Action, Character, Emotion, Motion, PhaseKind, Skill
from motion_backend.skeleton import build_skeleton
from motion_backend.walk_generator import Frames

SIZES: dict[str, Any] = {"layers": 1, "heads": 2, "width": 16, "hidden": 16, "norm_first": True}
SCALE = Scale(torch.zeros(FEATURES), torch.ones(FEATURES))


def saved(folder: Path, kind: str) -> Path:
    """A network that has learned nothing."""
    if kind == "denoiser":
        sizes = DenoiserSizes(**SIZES, scene=None)
        network: torch.nn.Module = Denoiser(sizes)
        config = {"kind": kind, "sizes": sizes.to_dict(), "noise": {}}
    else:
        network, config = CompletionScheduler(SchedulerSizes(**SIZES)), {"kind": kind, "sizes": SIZES}
    path = folder / kind
    save_weights(Weights(network, SCALE, config), path)
    return path


LOADED: dict[str, Callable[[Path], Any]] = {"denoiser": load_denoiser, "scheduler": load_scheduler}


@pytest.mark.parametrize("kind", list(LOADED))
def test_weights_that_cannot_be_used_say_why(kind: str, tmp_path: Path) -> None:
    load = LOADED[kind]
    path = saved(tmp_path, kind).with_suffix(".safetensors")
    load(path)
    config, tensors = json.loads(path.with_suffix(".json").read_text()), load_file(path)
    for change, says in (
        ({"kind": "other"}, f"no config of a {kind} of format"),
        ({"format": -1}, f"no config of a {kind} of format"),
        ({"sizes": {"depth": 3}}, f"no config of a {kind} "),
        ({"sizes": {**config["sizes"], "width": 8}}, "not those of its config"),
    ):
        path.with_suffix(".json").write_text(json.dumps(config | change))
        with pytest.raises(CheckpointError, match=says):
            load(path)
    path.with_suffix(".json").write_text("{")
    with pytest.raises(CheckpointError, match="damaged"):
        load(path)
    path.with_suffix(".json").write_text(json.dumps(config))
    name = next(name for name, tensor in tensors.items() if tensor.dim() > 1)
    for wrong, says in (
        ({one: tensor for one, tensor in tensors.items() if tensor.shape != (FEATURES,)}, f"no scale of {FEATURES}"),
        ({one: tensor[:9] if tensor.shape == (FEATURES,) else tensor for one, tensor in tensors.items()}, "no scale"),
        (tensors | {name: tensors[name] * float("nan")}, "not finite"),
        ({one: tensor for one, tensor in tensors.items() if one != name}, "not those of its config"),
    ):
        save_file(wrong, path)
        with pytest.raises(CheckpointError, match=says):
            load(path)
    path.write_bytes(b"x" * 99)
    with pytest.raises(CheckpointError, match="damaged"):
        read_tensors(path)
    path.unlink()
    with pytest.raises(CheckpointError, match="missing"):
        read_tensors(path)


@for_each(
    "wrong",
    [{"steps": 1}, {"steps": 10_001}, {"first": 0.0}, {"first": 0.5, "last": 0.4}, {"last": 1.0}, {"last": 0.001}],
)
def test_a_schedule_that_does_not_end_in_noise_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"a schedule has|of the signal"):
        NoiseSchedule(**wrong)


def test_a_width_is_even_and_shared_by_the_heads() -> None:
    Encoder(1, 12, 3, 8, True)
    for width, heads in ((12, 5), (9, 3)):
        with pytest.raises(ValueError, match=f"width {width}"):
            Encoder(1, width, heads, 8, True)


def a_walker(name: str) -> Stretch:
    passage = (Passage(0, 4, PartKind.WALK, "x"),)
    turns = np.tile([0.0, 0.0, 0.0, 1.0], (4, 22, 1))
    return Stretch(name, name, MadeOf.RECORDED, np.zeros((4, 3)), turns, np.ones((4, 4)), passage)


def test_nothing_and_too_many_people_cannot_be_learned_from() -> None:
    with pytest.raises(ClipError, match="nothing to learn from"):
        WindowBank([], lambda words: np.zeros((len(words), 384), np.float32))
    people = [a_walker(f"{number:03d}") for number in range(GAITS)]
    assert gaits(people[1:]) == {f"{number:03d}": number for number in range(1, GAITS)}
    with pytest.raises(ClipError, match=f"{GAITS} people walk"):
        gaits(people)


def test_a_joint_has_hinges_or_a_cone() -> None:
    still = np.array([0.0, 0.0, 0.0, 1.0])
    assert not out_of_cone("left_shoulder", still).any()
    assert not overbent("left_knee", still).any()
    with pytest.raises(ValueError, match="ask overbent"):
        out_of_cone("left_knee", still)


def stood(frames: int, up: float = 0.0, slide: float = 0.0) -> Motion:
    """A body that stands in the middle of the small home, floats so many metres, or slides so many a second."""
    history = DIRECTOR.begin(small_home(), Character(), 3).history
    root, local = history.root_positions[-1:] * [0.0, 1.0, 0.0] + [3.0, 0.0, 3.0], history.local_rotations[-1:]
    way = np.arange(frames)[:, None] * [slide / 30, 0.0, 0.0] + [0.0, up, 0.0]
    return Motion(
        (root + way).astype(np.float32), np.repeat(local, frames, axis=0).astype(np.float32),
        np.ones((frames, 4), np.float32), build_skeleton(), np.zeros(frames, np.int32),
    )  # fmt: skip


def carried_along(frames: int, slide: float, since: int, until: int) -> Motion:
    """The same that slides from one frame to another."""
    made = stood(frames)
    gone = np.clip(np.arange(frames) - since, 0, until - since)[:, None] * [slide / 30, 0.0, 0.0]
    return replace(made, root_positions=(made.root_positions + gone).astype(np.float32))


def into_the_bed(motion: Motion) -> Motion:
    moved = motion.root_positions + np.array([1.2 - 3.0, -0.2, 1.2 - 3.0], dtype=np.float32)
    return replace(motion, root_positions=moved)


@for_each(
    ("made", "says"),
    [
        (stood(30), ""),
        (stood(30, up=0.03), ""),
        (stood(30, up=0.2), "floated in 30 frames"),
        (stood(30, slide=0.05), ""),
        (stood(30, slide=0.3), "feet slid at 30 cm/s"),
        (carried_along(120, 0.1, 40, 60), ""),
        (carried_along(120, 0.3, 40, 60), "feet slid at 30 cm/s at once"),
        (into_the_bed(stood(30)), "deep in furniture"),
    ],
)
def test_a_body_that_floats_slides_or_sinks_where_its_plan_stands_is_refused(made: Motion, says: str) -> None:
    action = Action(Skill.SITDOWN, "sitting still", Emotion.NEUTRAL)
    passage = PlannedPassage(small_home(), Part(PartKind.SIT, action), PhaseKind.SITDOWN, stood(30))
    none = Frames(np.zeros((0, 3)), np.zeros((0, 22, 4)))
    if not says:
        check(made, passage, none)
        check(made, replace(passage, plan=made), none)
        return
    with pytest.raises(RefusedError, match=says):
        check(made, passage, none)
    check(made, replace(passage, plan=made), none)  # what the plan does too is no fault of the model
    refuse_beyond(0.1, 0.1, passage)
    with pytest.raises(RefusedError, match=r"ended 0\.20 m from its goal"):
        refuse_beyond(0.2, 0.1, passage)
