"""The training loop (LINGO A.6): Adam with a falling rate, a slow average of the weights, a checkpoint now and then.

What is drawn in a step depends on the seed and the step alone, and nothing else is by chance: a run that was broken off
goes on as if it had not been, and the same data and seed give the same bytes of weights on the same machine with as
many threads. A loss that is not finite ends it, with its batch and the last good weights kept.
"""

from __future__ import annotations

import json
import math
import time
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import torch
from safetensors.torch import save_file
from torch import Tensor, nn

from motion_backend.backend_protocol import PartKind
from motion_backend.diffusion.body_kinematics import Kinematics
from motion_backend.diffusion.checkpoint import DEVIATION, MEAN, CheckpointError, Weights, read_tensors, save_weights
from motion_backend.diffusion.completion_scheduler import CompletionScheduler, SchedulerSizes
from motion_backend.diffusion.conditions import Conditions, MadeOf
from motion_backend.diffusion.denoiser import Denoiser, DenoiserSizes
from motion_backend.diffusion.losses import LossWeights, losses
from motion_backend.diffusion.motion_features import CONTACTS, HISTORY, PLACES, ROOT, TURNS
from motion_backend.diffusion.noise_schedule import NoiseSchedule
from motion_backend.diffusion.sampler import Scale
from motion_backend.diffusion.windows import Batch, WindowBank, Windows
from scene_graphs.errors import UserError

Shares = Mapping[tuple[MadeOf, PartKind], float]
WALK_SHARES: Final[Shares] = {
    (MadeOf.RECORDED, PartKind.WALK): 0.33, (MadeOf.MATCHED, PartKind.WALK): 0.4,
    (MadeOf.PROCEDURAL, PartKind.WALK): 0.22, (MadeOf.PROCEDURAL, PartKind.TURN): 0.05,
}  # fmt: skip
"""Of windows where only walking is learned."""
SHARES: Final[Shares] = {
    (MadeOf.RECORDED, PartKind.WALK): 0.08, (MadeOf.MATCHED, PartKind.WALK): 0.12,
    (MadeOf.PROCEDURAL, PartKind.WALK): 0.15, (MadeOf.PROCEDURAL, PartKind.TURN): 0.02,
    (MadeOf.RECORDED, PartKind.REACH): 0.03, (MadeOf.KEYED, PartKind.SIT): 0.02, (MadeOf.KEYED, PartKind.LIE): 0.01,
    (MadeOf.KEYED, PartKind.RISE): 0.01, (MadeOf.KEYED, PartKind.REACH): 0.01,
    (MadeOf.PROCEDURAL, PartKind.SIT): 0.21, (MadeOf.PROCEDURAL, PartKind.LIE): 0.12,
    (MadeOf.PROCEDURAL, PartKind.RISE): 0.13, (MadeOf.PROCEDURAL, PartKind.REACH): 0.13,
}  # fmt: skip
"""Of windows where all skills are learned; those of which there is no motion fall to the others."""
ACTED_SHARES: Final[Shares] = {
    (MadeOf.PROCEDURAL, PartKind.WALK): 0.17, (MadeOf.PROCEDURAL, PartKind.TURN): 0.06,
    (MadeOf.PROCEDURAL, PartKind.SIT): 0.18, (MadeOf.PROCEDURAL, PartKind.LIE): 0.11,
    (MadeOf.PROCEDURAL, PartKind.RISE): 0.22, (MadeOf.PROCEDURAL, PartKind.REACH): 0.26,
}  # fmt: skip
"""Of windows where all that our own body acts is learned, starts, stops and odd walks too."""
ENDING_SHARES: Final[Shares] = {
    (MadeOf.PROCEDURAL, PartKind.SIT): 0.21, (MadeOf.PROCEDURAL, PartKind.LIE): 0.12,
    (MadeOf.PROCEDURAL, PartKind.RISE): 0.25, (MadeOf.PROCEDURAL, PartKind.REACH): 0.13,
}  # fmt: skip
"""Of windows whose end the scheduler learns: recordings end where the camera stopped, not where an action was over."""
FLOORS: Final = ((ROOT, 0.1), (TURNS, 0.04), (PLACES, 0.02), (CONTACTS, 0.3))
"""Deviations that no feature goes below: what hardly varies is not blown up."""
SAMPLED: Final = 2048
"""Windows that mean and deviation are taken from."""
STEP: Final = "step"
"""How far a run has come, among its tensors."""
CHECKED: Final = 50
"""Steps on a GPU after which it is asked whether all losses were finite; it is waited for then."""
MAX_NORM: Final = 1.0
"""Of a gradient."""
MOMENTS: Final = (0.9, 0.999)
"""How slowly Adam forgets gradients and their squares: its defaults."""


class TrainingError(UserError):
    """Training cannot go on; says why and what was kept."""


@dataclass(frozen=True)
class TrainConfig:
    """How to train; the same config, data and machine give the same bytes."""

    steps: int
    batch: int = 64
    rate: float = 1.2e-3
    """Of `small`; the paper's is 1e-4 with batches of 1024."""
    final: float = 0.04
    """Share of the rate that is left at the end of its cosine."""
    warmup: int = 150
    """Steps in which the rate rises."""
    average: float = 0.998
    """How slowly the averaged weights follow."""
    history_noise: float = 0.06
    """Deviations by which history is disturbed at most, so that one's own faults are known."""
    dropped: float = 0.1
    """How often text, goals and what it is made of are not told."""
    facing_dropped: float = 0.5
    """How often a walk is not told where to face."""
    save_every: int = 500
    seconds: float | None = None
    """After which training ends by the clock, with its rate at the end of the cosine, however few steps were done:
    for a machine that is rented. None: by steps alone, which gives the same bytes again."""
    seed: int = 0
    losses: LossWeights = field(default_factory=LossWeights)
    noise: NoiseSchedule = field(default_factory=NoiseSchedule)

    def done(self, step: int, elapsed: float = 0.0) -> float:
        """How much of training is over after so many steps and seconds, from 0 to 1."""
        return min(1.0, max(step / self.steps, 0.0 if self.seconds is None else elapsed / self.seconds))

    def rate_at(self, step: int, elapsed: float = 0.0) -> float:
        """Of Adam, warmed up and then along a cosine."""
        cosine = 0.5 * (1 + math.cos(math.pi * self.done(step, elapsed)))
        return self.rate * min(1.0, (step + 1) / max(self.warmup, 1)) * (self.final + (1 - self.final) * cosine)

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


class Adam:
    """As Kingma and Ba print it; the one of torch loads a compiler first, which takes longer than a small run."""

    def __init__(self, parameters: Sequence[nn.Parameter]) -> None:
        self.parameters = list(parameters)
        self.means = [torch.zeros_like(one) for one in self.parameters]
        self.squares = [torch.zeros_like(one) for one in self.parameters]

    def step(self, rate: float, number: int) -> None:
        """Go along the gradients, whose norm is cut at `MAX_NORM`; `number` counts from 1."""
        gradients = [one.grad if one.grad is not None else torch.zeros_like(one) for one in self.parameters]
        with torch.no_grad():
            norm = torch.stack(torch._foreach_norm(gradients)).norm()
            # A number would be waited for in every step where a GPU works it out.
            torch._foreach_mul_(gradients, (MAX_NORM / (norm + 1e-6)).clamp(max=1.0))
            torch._foreach_lerp_(self.means, gradients, 1 - MOMENTS[0])
            torch._foreach_mul_(self.squares, MOMENTS[1])
            torch._foreach_addcmul_(self.squares, gradients, gradients, 1 - MOMENTS[1])
            sizes = torch._foreach_sqrt(self.squares)
            torch._foreach_div_(sizes, math.sqrt(1 - MOMENTS[1] ** number))
            torch._foreach_add_(sizes, 1e-8)
            torch._foreach_addcdiv_(self.parameters, self.means, sizes, -rate / (1 - MOMENTS[0] ** number))
        for one in self.parameters:
            one.grad = None


@dataclass
class Run:
    """Where a training run is."""

    network: nn.Module
    average: dict[str, Tensor]
    scale: Scale
    optimizer: Adam
    step: int = 0
    seconds: float = 0.0
    """Of one core's time."""
    elapsed: float = 0.0
    """By the clock, checkpoints not counted."""
    curve: list[dict[str, float]] = field(default_factory=list)
    gaits: int = 0
    """Of how many people's walks are told apart."""
    learned_from: tuple[str, ...] = ()
    """Everybody who was recorded in what is learned from: they are no judges of it."""
    told: dict[str, Any] = field(default_factory=dict)
    """What it was begun with, and must be gone on with."""

    @property
    def device(self) -> torch.device:
        """Where its network is."""
        return next(self.network.parameters()).device


@dataclass(frozen=True)
class Learner:
    """One of the two networks in training: what it is, and what its loss is on a batch."""

    kind: str
    network: nn.Module
    loss: Callable[[Run, Batch, np.random.Generator], tuple[Tensor, dict[str, Tensor]]]
    """And figures for the curve, which stay where they were worked out until they are asked for."""
    sizes: Mapping[str, Any]


def denoiser_learner(sizes: DenoiserSizes, config: TrainConfig, device: str = "cpu") -> Learner:
    """The motion diffusion module: it guesses clean windows."""
    torch.manual_seed(config.seed)
    network, kinematics = Denoiser(sizes).to(device), Kinematics(device)

    def loss(run: Run, batch: Batch, rng: np.random.Generator) -> tuple[Tensor, dict[str, Tensor]]:
        # What is drawn on the device, by dropout too, follows from the step alone, as all else does.
        torch.manual_seed(int(rng.integers(1 << 62)))
        given = dropped(batch, config, rng)
        clean = run.scale.encode(batch.windows)
        noise = torch.randn_like(clean)
        steps = torch.randint(config.noise.steps, (len(clean),), device=clean.device)
        noised = config.noise.noised(clean, noise, steps)
        share = config.history_noise * torch.rand((len(clean), 1, 1), device=clean.device)
        # The history is never diffused; it is disturbed a little, as what was sampled before is not perfect.
        noised = torch.cat([clean[:, :HISTORY] + share * noise[:, :HISTORY], noised[:, HISTORY:]], dim=1)
        with torch.autocast(clean.device.type, torch.bfloat16, enabled=clean.device.type != "cpu"):
            guess = network(noised, steps, network.encode(given))
        found = losses(guess.float(), clean, run.scale, kinematics, config.losses)
        return found.total(config.losses), found.told()

    return Learner("denoiser", network, loss, sizes.to_dict())


def scheduler_learner(sizes: SchedulerSizes, config: TrainConfig, device: str = "cpu") -> Learner:
    """The completion scheduler: it tells whether a window's action is over."""
    torch.manual_seed(config.seed)
    network = CompletionScheduler(sizes).to(device)

    def loss(run: Run, batch: Batch, rng: np.random.Generator) -> tuple[Tensor, dict[str, Tensor]]:
        torch.manual_seed(int(rng.integers(1 << 62)))
        clean = run.scale.encode(batch.windows)
        seen = clean + config.history_noise * torch.randn_like(clean)
        logits = network.logits(seen, batch.given.text, batch.given.frame)
        wanted = batch.over.float()
        found = torch.nn.functional.binary_cross_entropy_with_logits(logits, wanted)
        right = ((logits > 0) == (wanted > 0.5)).float().mean()
        return found, {"cross_entropy": found.detach(), "right": right}

    return Learner("scheduler", network, loss, sizes.to_dict())


def usable(device: str) -> str:
    """A device that this machine has. TrainingError for any other."""
    try:
        torch.zeros(1, device=device)
    except (RuntimeError, AssertionError) as error:
        raise TrainingError(f"{device!r:.40} cannot be trained on ({error!s:.120})", "give cpu, or cuda") from error
    return device


def dropped(batch: Batch, config: TrainConfig, rng: np.random.Generator) -> Conditions:
    """The conditions of a batch, some of them not told."""
    given, count = batch.given, len(batch.windows)
    drawn = torch.from_numpy(rng.random((7, count), dtype=np.float32)).to(batch.windows.device)
    text, pelvis, hand, scene, made_of, gait = (drawn[1:] >= config.dropped).unbind()
    untold = (batch.periodic & (drawn[0] < config.facing_dropped))[:, None]
    told = torch.cat([given.pelvis[:, :3], given.pelvis[:, 3:5] * ~untold, given.pelvis[:, 5:6],
                      given.pelvis[:, 6:7] * ~untold, given.pelvis[:, 7:]], dim=1)  # fmt: skip
    return replace(
        given,
        has_text=given.has_text * text,
        has_pelvis=given.has_pelvis * pelvis,
        has_hand=given.has_hand * hand,
        has_scene=None if given.has_scene is None else given.has_scene * scene,
        made_of=given.made_of * made_of,
        gait=given.gait * gait,
        pelvis=told,
    )


def measured_scale(bank: WindowBank, windows: Windows, seed: int) -> Scale:
    """Mean and deviation of every feature over windows as they are drawn."""
    rng = np.random.default_rng([seed, 1])
    starts, rows = windows.drawn(SAMPLED, rng)
    flat = bank.batch(starts, rows, rng.random(SAMPLED) < 0.5).windows.flatten(0, 1)
    deviation = flat.std(dim=0)
    for part, least in FLOORS:
        deviation[part] = deviation[part].clamp(min=least)
    return Scale(flat.mean(dim=0), deviation)


def train(
    learner: Learner,
    bank: WindowBank,
    windows: Windows,
    config: TrainConfig,
    folder: Path,
    at_checkpoint: Callable[[Run, Weights], Mapping[str, float]] = lambda _run, _weights: {},
    start: Weights | None = None,
) -> Weights:
    """Train to the end, or from where a run in `folder` was broken off; the averaged weights. TrainingError.

    `at_checkpoint` may judge and draw; its figures go into the curve. A new run begins from `start` where that is
    given.
    """
    folder.mkdir(parents=True, exist_ok=True)
    run = _begun(learner, bank, windows, config, folder, start)
    with _repeatable(run.device):
        _steps(learner, bank.on(str(run.device)), windows, config, folder, run, at_checkpoint)
    return averaged(learner, run, config)


@contextmanager
def _repeatable(device: torch.device) -> Iterator[None]:
    """On the CPU only what gives the same numbers each time; on a GPU what is quick, products in 19 bits.

    What is drawn by chance is the same there too; sums may come in another order.
    """
    before, warns = torch.are_deterministic_algorithms_enabled(), torch.is_deterministic_algorithms_warn_only_enabled()
    precision = torch.get_float32_matmul_precision()
    if device.type == "cpu":
        torch.use_deterministic_algorithms(True)
    else:
        torch.set_float32_matmul_precision("high")
    try:
        yield
    finally:
        torch.use_deterministic_algorithms(before, warn_only=warns)
        torch.set_float32_matmul_precision(precision)


def _steps(
    learner: Learner,
    bank: WindowBank,
    windows: Windows,
    config: TrainConfig,
    folder: Path,
    run: Run,
    at_checkpoint: Callable[[Run, Weights], Mapping[str, float]],
) -> None:
    """All steps that a run has not done yet."""
    recent: list[dict[str, Tensor]] = []
    checked = 1 if run.device.type == "cpu" else CHECKED
    bad = torch.full((), -1, device=run.device)
    begun, watch = time.process_time(), time.perf_counter()
    learner.network.train()
    while config.done(run.step, run.elapsed) < 1:
        batch, rng = _drawn(bank, windows, config, run.step)
        loss, told = learner.loss(run, batch, rng)
        bad = torch.where((bad < 0) & ~torch.isfinite(loss.detach()), run.step, bad)
        due = (run.step + 1) % config.save_every == 0 or config.done(run.step + 1, run.elapsed) == 1
        if (due or run.step % checked == 0) and int(bad) >= 0:
            raise _not_finite(int(bad), _drawn(bank, windows, config, int(bad))[0], folder)
        _stepped(run, loss, config)
        recent.append(told)
        run.seconds, begun = run.seconds + time.process_time() - begun, time.process_time()
        run.elapsed, watch = run.elapsed + time.perf_counter() - watch, time.perf_counter()
        if due or config.done(run.step, run.elapsed) == 1:
            means = {name: float(torch.stack([one[name] for one in recent]).mean()) for name in recent[0]}
            recent = []
            _checkpointed(learner, run, config, folder, means, at_checkpoint)
            learner.network.train()
            begun, watch = time.process_time(), time.perf_counter()


def _drawn(bank: WindowBank, windows: Windows, config: TrainConfig, step: int) -> tuple[Batch, np.random.Generator]:
    """What a step learns from, and what goes on being drawn from in it."""
    rng = np.random.default_rng([config.seed, 2, step])
    starts, rows = windows.drawn(config.batch, rng)
    return bank.batch(starts, rows, rng.random(config.batch) < 0.5), rng


def averaged(learner: Learner, run: Run, config: TrainConfig) -> Weights:
    """The slow average of a run's weights, as a network of its own."""
    if isinstance(learner.network, Denoiser):
        network: nn.Module = Denoiser(learner.network.sizes)
    else:
        assert isinstance(learner.network, CompletionScheduler)
        network = CompletionScheduler(learner.network.sizes)
    network.load_state_dict({name: tensor.cpu() for name, tensor in run.average.items()})
    scale = Scale(run.scale.mean.cpu(), run.scale.deviation.cpu())
    told = {
        "kind": learner.kind, "sizes": dict(learner.sizes), "noise": asdict(config.noise),
        "gaits": run.gaits, "learned_from": list(run.learned_from),
        "training": {**config.to_dict(), "steps_done": run.step},
    }  # fmt: skip
    return Weights(network.eval().requires_grad_(False), scale, told)


def _begun(
    learner: Learner, bank: WindowBank, windows: Windows, config: TrainConfig, folder: Path, start: Weights | None
) -> Run:
    """A run at its beginning, or as it was saved."""
    device = next(learner.network.parameters()).device
    optimizer = Adam(list(learner.network.parameters()))
    told = _told(learner, bank, windows, config, start)
    people: dict[str, Any] = {"gaits": len(bank.gaits), "learned_from": bank.learned_from}
    state = folder / "run.json"
    if not state.exists():
        if start is not None:
            learner.network.load_state_dict(start.network.state_dict())
        scale = start.scale if start is not None else measured_scale(bank, windows, config.seed)
        scale = Scale(scale.mean.to(device), scale.deviation.to(device))
        average = {name: tensor.detach().clone() for name, tensor in learner.network.state_dict().items()}
        return Run(learner.network, average, scale, optimizer, told=told, **people)
    row = json.loads(state.read_text(encoding="utf-8"))
    if row["told"] != told:
        why = f"{folder} holds a run of another config, of other data or from another start"
        raise CheckpointError(why, "give another folder, or the same data and options")
    tensors = {name: tensor.to(device) for name, tensor in read_tensors(folder / "run.safetensors").items()}
    learner.network.load_state_dict(_under("network.", tensors))
    for kind, kept in (("mean", optimizer.means), ("square", optimizer.squares)):
        for index, tensor in enumerate(kept):
            tensor.copy_(tensors[f"adam.{kind}.{index}"])
    scale = Scale(tensors[MEAN], tensors[DEVIATION])
    # The tensors are written first: they say how far it came where it was broken off between the two.
    step = int(tensors[STEP])
    done = (step, row["seconds"], row["elapsed"], [one for one in row["curve"] if one["step"] <= step])
    average = _under("average.", tensors)
    return Run(learner.network, average, scale, optimizer, *done, told=told, **people)


def _told(
    learner: Learner, bank: WindowBank, windows: Windows, config: TrainConfig, start: Weights | None
) -> dict[str, Any]:
    """What a run must have been begun with to be gone on with, as JSON has it."""
    begun = 0
    for tensor in [] if start is None else start.network.state_dict().values():
        begun = zlib.crc32(tensor.cpu().numpy().tobytes(), begun)
    told = {
        "config": config.to_dict(), "sizes": dict(learner.sizes), "kind": learner.kind, "data": bank.fingerprint,
        "drawn": windows.fingerprint, "start": begun,
    }  # fmt: skip
    return dict(json.loads(json.dumps(told)))


def _stepped(run: Run, loss: Tensor, config: TrainConfig) -> None:
    loss.backward()
    run.optimizer.step(config.rate_at(run.step, run.elapsed), run.step + 1)
    run.step += 1
    follow = 1 - min(config.average, (1 + run.step) / (10 + run.step))
    now = run.network.state_dict()
    with torch.no_grad():
        torch._foreach_lerp_([run.average[name] for name in now], list(now.values()), follow)


def _checkpointed(
    learner: Learner,
    run: Run,
    config: TrainConfig,
    folder: Path,
    means: Mapping[str, float],
    at_checkpoint: Callable[[Run, Weights], Mapping[str, float]],
) -> None:
    """The run as it is, and its averaged weights by their step; the last two are what a run goes on from."""
    weights = averaged(learner, run, config)
    save_weights(weights, folder / f"step{run.step:06d}")
    run.curve.append({"step": run.step, "core_seconds": run.seconds, "elapsed": run.elapsed, **means})
    run.curve[-1] |= at_checkpoint(run, weights)
    tensors = {f"network.{name}": tensor for name, tensor in run.network.state_dict().items()}
    tensors |= {f"average.{name}": tensor for name, tensor in run.average.items()}
    tensors |= _optimizer_tensors(run.optimizer) | {MEAN: run.scale.mean, DEVIATION: run.scale.deviation}
    tensors[STEP] = torch.tensor(run.step)
    save_file({name: tensor.detach().cpu().contiguous() for name, tensor in tensors.items()}, folder / "run.part")
    row = {"told": run.told, "step": run.step, "seconds": run.seconds, "elapsed": run.elapsed, "curve": run.curve}
    (folder / "run.part").replace(folder / "run.safetensors")
    (folder / "run.part").write_text(json.dumps(row, indent=1), encoding="utf-8")
    (folder / "run.part").replace(folder / "run.json")


def _optimizer_tensors(optimizer: Adam) -> dict[str, Tensor]:
    kinds = {"mean": optimizer.means, "square": optimizer.squares}
    return {f"adam.{kind}.{index}": one for kind, kept in kinds.items() for index, one in enumerate(kept)}


def _under(prefix: str, tensors: Mapping[str, Tensor]) -> dict[str, Tensor]:
    return {name.removeprefix(prefix): tensor for name, tensor in tensors.items() if name.startswith(prefix)}


def _not_finite(step: int, batch: Batch, folder: Path) -> TrainingError:
    save_file({"windows": batch.windows.cpu().contiguous()}, folder / "bad_batch.safetensors")
    return TrainingError(
        f"step {step}: the loss is not finite; its batch is in {folder / 'bad_batch.safetensors'}",
        "the last good weights are kept; look at the batch, or lower the rate",
    )
