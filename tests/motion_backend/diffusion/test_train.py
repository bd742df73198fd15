"""Windows as they are learned from, one clip learned by heart, runs that are broken off, and weights on disk."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
import torch
from numpy.typing import NDArray
from sample_motions import tumbling
from small_home import DIRECTOR, small_home

from motion_backend.backend_protocol import PartKind
from motion_backend.diffusion.body_kinematics import Kinematics, told_joints
from motion_backend.diffusion.checkpoint import CheckpointError, load_denoiser, save_weights
from motion_backend.diffusion.completion_scheduler import SchedulerSizes
from motion_backend.diffusion.conditions import MadeOf
from motion_backend.diffusion.dataset import Passage, Stretch, read_sentences, read_stretches, write_stretches
from motion_backend.diffusion.denoiser import DenoiserSizes
from motion_backend.diffusion.losses import LossWeights, losses
from motion_backend.diffusion.motion_features import HISTORY, HeadingFrame, Poses, to_features
from motion_backend.diffusion.sampler import Sampler, Scale
from motion_backend.diffusion.scene_encoder import RoomVoxels, voxel_image
from motion_backend.diffusion.train import (
    Adam,
    Learner,
    Run,
    TrainConfig,
    TrainingError,
    denoiser_learner,
    dropped,
    scheduler_learner,
    train,
    usable,
)
from motion_backend.diffusion.windows import WindowBank, Windows, wordings
from motion_backend.mocap.augmentation import mirror
from motion_backend.mocap.clip import ClipError
from motion_backend.motion import Action, Character, Emotion, Motion, Skill
from motion_backend.skeleton import build_skeleton
from scene_graphs.geometry.egocentric_heightmap import SceneHeights
from scene_graphs.geometry.occupancy_grid import occupancy_pair
from scene_graphs.home import home_from_layouts
from scene_graphs.layout_library import built_in_index

TINY = DenoiserSizes(1, 2, 16, 16, True, None)
WALK, REACH = (MadeOf.RECORDED, PartKind.WALK), (MadeOf.PROCEDURAL, PartKind.REACH)


def words(texts: Sequence[str]) -> NDArray[np.float32]:
    """Features that differ from text to text."""
    return np.stack([np.random.default_rng(list(text.encode())).normal(size=384) for text in texts]).astype(np.float32)


def stretch(motion: Motion, *passages: Passage, made_of: MadeOf = MadeOf.RECORDED, person: str = "one") -> Stretch:
    return Stretch(
        "clip", person, made_of, motion.root_positions.astype(float), motion.local_rotations.astype(float),
        motion.contacts.astype(float), passages,
    )  # fmt: skip


def two_people() -> list[Stretch]:
    return [
        stretch(tumbling(90, seed), Passage(0, 90, PartKind.WALK, "walk to the left"), person=f"person {seed}")
        for seed in range(2)
    ]


def bank_of(stretches: list[Stretch]) -> WindowBank:
    return WindowBank(stretches, words)


def test_windows_are_the_features_of_their_frames() -> None:
    bank = bank_of(two_people())
    windows = bank.windows({WALK: 1.0})
    batch = bank.batch(windows.starts, windows.passages, np.zeros(len(windows), dtype=np.bool_))
    for start, row, found in zip(windows.starts, windows.passages, batch.windows.numpy(), strict=True):
        index = bank.passages[row][0]
        one, frames = bank.stretches[index], start - 90 * index + 3 * np.arange(16)
        poses = Poses(one.roots[frames], one.local[frames], one.contacts[frames])
        assert np.abs(to_features(poses, HeadingFrame.of(poses), build_skeleton()) - found).max() < 2e-3


def test_a_window_in_the_mirror_is_that_of_the_mirrored_motion() -> None:
    motion = tumbling(90)
    here = bank_of([stretch(motion, Passage(0, 90, PartKind.WALK, "walk to the left"))])
    there = bank_of([stretch(mirror(motion), Passage(0, 90, PartKind.WALK, "walk to the right"))])
    starts, rows = np.array([0, 12]), np.array([0, 0])
    flipped = here.batch(starts, rows, np.ones(2, dtype=np.bool_))
    wanted = there.batch(starts, rows, np.zeros(2, dtype=np.bool_))
    assert torch.allclose(flipped.windows, wanted.windows, atol=2e-3)
    assert torch.allclose(flipped.given.pelvis, wanted.given.pelvis, atol=1e-4)
    assert torch.equal(flipped.given.text, wanted.given.text)


def test_locomotion_has_frame_number_zero_and_its_goal_where_the_window_ends() -> None:
    bank = bank_of(two_people())
    batch = bank.batch(np.array([9]), np.array([0]), np.zeros(1, dtype=np.bool_))
    assert batch.given.frame.tolist() == [0]
    assert torch.allclose(batch.given.pelvis[0, [0, 1]], batch.windows[0, -1, [0, 2]], atol=1e-5)
    assert not batch.over.any()


def test_other_actions_count_frames_and_seconds_to_go_and_are_over_once_they_are() -> None:
    reach = Passage(30, 75, PartKind.REACH, "wave", hand=(1.0, 1.2, 0.5), left=True, reached=60)
    bank = bank_of([stretch(tumbling(90), reach, made_of=MadeOf.PROCEDURAL)])
    starts = np.array([24, 54])
    batch = bank.batch(starts, np.array([0, 0]), np.zeros(2, dtype=np.bool_))
    assert batch.given.frame.tolist() == [0, 30]
    assert batch.given.pelvis[:, 7].tolist() == pytest.approx([33 / 90, 3 / 90])
    assert batch.given.pelvis[:, :7].abs().sum() == 0
    assert batch.given.hand[:, 3].tolist() == [1.0, 1.0]
    assert batch.over.tolist() == [True, True]
    # What our own body did is held past its end, so that staying is learned.
    assert torch.equal(batch.windows[1, -1, 135:], batch.windows[1, -5, 135:])


def test_everybody_counts_alike_however_long_they_were_recorded() -> None:
    long, short = tumbling(300, 0), tumbling(90, 1)
    bank = bank_of([
        stretch(long, Passage(0, 300, PartKind.WALK, "walk"), person="long"),
        stretch(short, Passage(0, 90, PartKind.WALK, "walk"), person="short"),
    ])  # fmt: skip
    windows = bank.windows({WALK: 0.3, REACH: 0.7})
    assert windows.weights.sum() == pytest.approx(1)
    assert windows.weights[windows.passages == 0].sum() == pytest.approx(0.5)
    with pytest.raises(ClipError, match="no window"):
        bank.windows({REACH: 1.0})


def test_conditions_are_dropped_about_as_often_as_is_said() -> None:
    bank, config = bank_of(two_people()), TrainConfig(1)
    windows = bank.windows({WALK: 1.0})
    rng = np.random.default_rng(0)
    batch = bank.batch(*windows.drawn(2000, rng), np.zeros(2000, dtype=np.bool_))
    given = dropped(batch, config, rng)
    for kept in (given.has_text, given.has_pelvis, given.made_of == MadeOf.RECORDED):
        assert float(kept.float().mean()) == pytest.approx(0.9, abs=0.03)
    assert float(given.pelvis[:, 6].mean()) == pytest.approx(0.5, abs=0.05)


def test_history_is_never_diffused_in_training() -> None:
    """Only disturbed, by as much as is said: the network sees at every step where a body comes from."""
    bank = bank_of(two_people())
    windows = bank.windows({WALK: 1.0})
    batch = bank.batch(*windows.drawn(64, np.random.default_rng(0)), np.zeros(64, dtype=np.bool_))
    for noise in (0.0, 0.05):
        learner = denoiser_learner(TINY, TrainConfig(1, history_noise=noise))
        seen: list[tuple[torch.Tensor, ...]] = []
        learner.network.register_forward_pre_hook(lambda _module, given, seen=seen: seen.append(given[:2]))
        scale = Scale(torch.zeros(202), torch.ones(202))
        learner.loss(Run(learner.network, {}, scale, Adam([])), batch, np.random.default_rng(1))
        shown, steps = seen[0]
        assert steps.unique().numel() > 30
        away = (shown - batch.windows).detach()
        assert float(away[:, :HISTORY].abs().max()) <= 6 * noise
        assert (float(away[:, :HISTORY].abs().max()) > 0) is (noise > 0)
        assert float(away[:, HISTORY:].std()) > 0.3


def test_bones_and_told_positions_agree_on_true_windows() -> None:
    bank = bank_of(two_people())
    batch = bank.batch(np.array([0, 6]), np.array([0, 0]), np.zeros(2, dtype=np.bool_))
    assert torch.allclose(Kinematics().joints(batch.windows), told_joints(batch.windows), atol=5e-3)
    scale = Scale(torch.zeros(202), torch.ones(202))
    found = losses(batch.windows, batch.windows, scale, Kinematics(), LossWeights())
    assert float(found.clean) == 0.0
    assert found.numbers()["bones"] < 5e-3


def test_voxels_of_many_bodies_are_those_of_each() -> None:
    """Looked up in bits of whole rooms, where `occupancy_pair` asks for one body at a time."""
    homes = [home_from_layouts([built_in_index().layouts[number]], 0) for number in (0, 7)]
    rng, rooms, walks = np.random.default_rng(0), np.array([0, 1, 1, 0]), np.array([True, False, True, False])
    floors = [shapely.bounds(homes[room].floor) for room in rooms]
    here, goal = (np.stack([rng.uniform(one[:2], one[2:]) for one in floors]) for _ in range(2))
    yaw = rng.uniform(-3, 3, 4)
    found = RoomVoxels(homes).images(*map(torch.from_numpy, (rooms, here, goal, yaw, walks)))
    for at, room in enumerate(rooms):
        places = tuple(here[at].tolist()), tuple(goal[at].tolist())
        pair = occupancy_pair(SceneHeights(homes[room]), places[0], yaw[at], places[1], walking=bool(walks[at]))
        assert 0 < pair.mean() < 1
        assert np.array_equal(found[at].numpy(), voxel_image(pair))


def test_a_run_by_the_clock_ends_with_it_and_with_its_lowest_rate(tmp_path: Path) -> None:
    config = TrainConfig(1000, batch=2, seconds=10.0, warmup=1)
    assert config.rate_at(5, 10.0) == pytest.approx(config.rate * config.final)
    assert config.rate_at(500, 0.0) == config.rate_at(0, 5.0)
    bank, soon = bank_of(two_people()), replace(config, seconds=1e-6)
    weights = train(denoiser_learner(TINY, soon), bank, bank.windows({WALK: 1.0}), soon, tmp_path)
    assert weights.config["training"]["steps_done"] == 1


def test_a_device_that_is_not_there_is_refused() -> None:
    assert usable("cpu") == "cpu"
    with pytest.raises(TrainingError, match="'gpu7' cannot be trained on"):
        usable("gpu7")


def test_dropout_is_of_training_alone_and_follows_from_the_step() -> None:
    sizes, config = replace(TINY, dropout=0.5), TrainConfig(1)
    bank = bank_of(two_people())
    batch = bank.batch(np.array([0, 6]), np.array([0, 0]), np.zeros(2, dtype=np.bool_))
    learner, scale = denoiser_learner(sizes, config), Scale(torch.zeros(202), torch.ones(202))
    run = Run(learner.network, {}, scale, Adam([]))

    def loss(seed: int) -> float:
        return float(learner.loss(run, batch, np.random.default_rng(seed))[0].detach())

    learner.network.train()
    assert loss(0) == loss(0)
    learned = loss(0)
    learner.network.eval()
    assert loss(0) != learned
    assert loss(0) == loss(0)


def a_walk() -> Motion:
    """Of our own body, across a room."""
    home = small_home()
    action = Action(Skill.LOCO, "walk", Emotion.NEUTRAL, goal=(0.6, 3.2))
    return DIRECTOR.act(home, action, DIRECTOR.begin(home, Character(), 5))[0]


def overfitted(folder: Path, steps: int, sizes: DenoiserSizes) -> float:
    """Mean error of joints (m) of windows sampled from what was learned of one clip."""
    bank = bank_of([stretch(a_walk().part(20, 80), Passage(0, 60, PartKind.WALK, "walk"))])
    starts, rows = np.array([0, 6, 12]), np.zeros(3, dtype=np.int64)
    windows = Windows(starts, rows, np.full(3, 1 / 3))
    config = TrainConfig(steps, batch=12, rate=3e-3, warmup=20, average=0.97, save_every=steps, dropped=0.0)
    weights = train(denoiser_learner(sizes, config), bank, windows, config, folder)
    batch = bank.batch(starts, rows, np.zeros(3, dtype=np.bool_))
    sampler = Sampler(weights.network, weights.scale)
    made = sampler.windows(batch.windows[:, :HISTORY].double().numpy(), batch.given, 0)
    kinematics = Kinematics()
    wanted = kinematics.joints(batch.windows[:, HISTORY:])
    away = (kinematics.joints(torch.from_numpy(made).float()) - wanted).norm(dim=-1)
    return float(away.mean())


def test_a_clip_is_learned_roughly_in_seconds(tmp_path: Path) -> None:
    sizes = DenoiserSizes(2, 2, 48, 96, True, None)
    assert overfitted(tmp_path / "some", 40, sizes) < 0.8 * overfitted(tmp_path / "none", 1, sizes)


@pytest.mark.sweep
def test_a_clip_is_learned_to_two_centimetres(tmp_path: Path) -> None:
    assert overfitted(tmp_path, 2500, DenoiserSizes(3, 4, 128, 256, True, None)) < 0.02


@pytest.mark.sweep
def test_adam_is_that_of_torch() -> None:
    """Without the cut of a gradient's norm, which torch has elsewhere."""
    torch.manual_seed(0)
    ours, theirs = (torch.nn.Parameter(torch.ones(5, 3)) for _ in range(2))
    mine, other = Adam([ours]), torch.optim.Adam([theirs], lr=0.1)
    for number in range(1, 4):
        target = 0.01 * torch.randn(5, 3)
        for one in (ours, theirs):
            ((one - 1) * target + one * target).sum().backward()
        mine.step(0.1, number)
        other.step()
        other.zero_grad()
    assert torch.allclose(ours, theirs, atol=1e-5)


def learner_of(kind: str, config: TrainConfig) -> Learner:
    if kind == "denoiser":
        return denoiser_learner(TINY, config)
    return scheduler_learner(SchedulerSizes(1, 2, 16, 16, True), config)


@pytest.mark.parametrize("kind", ["denoiser", "scheduler"])
def test_a_run_that_was_broken_off_ends_in_the_same_bytes(kind: str, tmp_path: Path) -> None:
    class BrokenOffError(Exception):
        pass

    def breaks(_run: object, _weights: object) -> dict[str, float]:
        if (tmp_path / "parts" / "run.json").exists():
            raise BrokenOffError
        return {}

    config = TrainConfig(4, batch=3, save_every=2, warmup=1)

    def trained(folder: str, at_checkpoint: Callable[[object, object], dict[str, float]] = lambda _r, _w: {}) -> None:
        bank = bank_of(two_people())
        windows = bank.windows({WALK: 1.0})
        weights = train(learner_of(kind, config), bank, windows, config, tmp_path / folder, at_checkpoint)
        save_weights(weights, tmp_path / folder / "shipped", half=True)

    trained("whole")
    with pytest.raises(BrokenOffError):
        trained("parts", breaks)
    # What else is drawn between the two parts is nothing to it.
    torch.manual_seed(99)
    trained("parts")
    names = ("shipped", "step000002", "step000004")
    files = [f"{name}.{kind}" for name in names for kind in ("safetensors", "json")]
    for name in (*files, "run.safetensors"):
        assert (tmp_path / "whole" / name).read_bytes() == (tmp_path / "parts" / name).read_bytes(), name


def test_a_run_is_gone_on_with_by_the_same_data_and_options_alone(tmp_path: Path) -> None:
    bank, config = bank_of(two_people()), TrainConfig(1, batch=2)
    windows = bank.windows({WALK: 1.0})
    train(denoiser_learner(TINY, config), bank, windows, config, tmp_path)
    faster, fewer = replace(config, rate=1.0), bank_of(two_people()[:1])
    for other, told in ((bank, faster), (fewer, config)):
        with pytest.raises(CheckpointError, match="another config, of other data or from another start"):
            train(denoiser_learner(TINY, told), other, other.windows({WALK: 1.0}), told, tmp_path)
    skewed = replace(windows, weights=np.linspace(1, 2, len(windows)) / (1.5 * len(windows)))
    weights = train(denoiser_learner(TINY, config), bank, windows, config, tmp_path / "start")
    for drawn, start in ((skewed, None), (windows, weights)):
        with pytest.raises(CheckpointError, match="from another start"):
            train(denoiser_learner(TINY, config), bank, drawn, config, tmp_path, start=start)


def test_a_run_broken_off_as_it_was_saved_goes_on_from_its_tensors(tmp_path: Path) -> None:
    bank, config = bank_of(two_people()), TrainConfig(2, batch=2, save_every=1)
    windows = bank.windows({WALK: 1.0})
    whole = train(denoiser_learner(TINY, config), bank, windows, config, tmp_path)
    row = json.loads((tmp_path / "run.json").read_text())
    (tmp_path / "run.json").write_text(json.dumps(row | {"step": 1, "curve": row["curve"][:1]}))
    again = train(denoiser_learner(TINY, config), bank, windows, config, tmp_path)
    for one, other in zip(whole.network.state_dict().values(), again.network.state_dict().values(), strict=True):
        assert torch.equal(one, other)


def test_a_loss_that_is_not_finite_ends_training_and_keeps_batch_and_weights(tmp_path: Path) -> None:
    good, bad = two_people()
    bad.roots[39] = np.nan
    bank = bank_of([good, bad])
    windows, config = bank.windows({WALK: 1.0}), TrainConfig(500, batch=1, save_every=1, warmup=1)
    with pytest.raises(TrainingError, match="not finite"):
        train(denoiser_learner(TINY, config), bank, windows, config, tmp_path)
    assert (tmp_path / "bad_batch.safetensors").exists()


def saved(folder: Path) -> Path:
    bank, config = bank_of(two_people()), TrainConfig(1, batch=2)
    weights = train(denoiser_learner(TINY, config), bank, bank.windows({WALK: 1.0}), config, folder / "run")
    save_weights(weights, folder / "denoiser", half=True)
    return folder / "denoiser"


def test_weights_come_back_from_disk_and_broken_ones_are_named(tmp_path: Path) -> None:
    path = saved(tmp_path)
    weights, schedule = load_denoiser(path)
    assert schedule.steps == 100
    assert weights.config["sizes"]["width"] == 16
    tensors, config = path.with_suffix(".safetensors"), path.with_suffix(".json")
    whole = tensors.read_bytes()
    tensors.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(CheckpointError, match=r"denoiser\.safetensors: it is damaged"):
        load_denoiser(path)
    tensors.write_bytes(whole)
    row = json.loads(config.read_text())
    config.write_text(json.dumps(row | {"sizes": {**row["sizes"], "width": 32}}))
    with pytest.raises(CheckpointError, match="not those of its config"):
        load_denoiser(path)
    config.write_text(json.dumps(row | {"kind": "scheduler"}))
    with pytest.raises(CheckpointError, match="no config of a denoiser"):
        load_denoiser(path)
    config.unlink()
    with pytest.raises(CheckpointError, match=r"denoiser\.json: it is missing"):
        load_denoiser(path)


def test_sentences_of_stretches_come_back_from_disk_as_features(tmp_path: Path) -> None:
    walk = stretch(tumbling(60), Passage(0, 60, PartKind.WALK, "walk to the left"))
    said = wordings([walk])
    assert said == ["walk to the left", "walk to the right"]
    write_stretches([walk], tmp_path / "told.npz", dict(zip(said, words(said), strict=True)))
    write_stretches([walk], tmp_path / "untold.npz")
    found = read_sentences(tmp_path / "told.npz")
    assert [*found] == said
    assert np.array_equal(np.stack([*found.values()]), words(said))
    assert read_stretches(tmp_path / "told.npz")[0].passages == walk.passages
    assert read_sentences(tmp_path / "untold.npz") == {}
    (tmp_path / "untold.npz").write_bytes(b"nothing")
    with pytest.raises(ClipError, match=r"untold\.npz cannot be read"):
        read_sentences(tmp_path / "untold.npz")


def test_stretches_come_back_from_disk(tmp_path: Path) -> None:
    reach = Passage(30, 75, PartKind.REACH, "wave", hand=(1.0, 1.2, 0.5), left=True, reached=60)
    one = stretch(tumbling(90), reach, made_of=MadeOf.PROCEDURAL)
    write_stretches([one, one], tmp_path / "acted.npz")
    found = read_stretches(tmp_path / "acted.npz")
    assert len(found) == 2
    assert found[1].passages == (reach,)
    assert np.allclose(found[1].roots, one.roots)
    assert np.abs(np.abs(np.sum(found[1].local * one.local, axis=-1)) - 1).max() < 1e-6
    write_stretches([one, one], tmp_path / "again.npz")
    assert (tmp_path / "again.npz").read_bytes() == (tmp_path / "acted.npz").read_bytes()
    (tmp_path / "acted.npz").write_bytes(b"nothing")
    with pytest.raises(ClipError, match=r"acted\.npz cannot be read"):
        read_stretches(tmp_path / "acted.npz")
