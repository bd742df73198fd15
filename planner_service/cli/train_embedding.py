"""`sims train embedding`: the language-aware embedding of SIMS 3.3, from captioned motion of our own body and clips."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer
from rich.console import Console

from planner_service.cli.console import plain_table
from planner_service.output.story_export import check_writable

if TYPE_CHECKING:
    from motion_backend.embedding.caption_retrieval import Retrieval
    from motion_backend.mocap.dataset_file import Dataset, Entry

ACTED: Final = "acted.npz"
WEIGHTS: Final = "text_motion.safetensors"
RECORDED: Final = "real mocap"
"""The kind of clips that is learned from besides our own."""


def embedding(
    out: Annotated[Path, typer.Option(help="Folder for clips, checkpoints and weights; a run goes on where it was.")],
    rooms: Annotated[int, typer.Option(min=2, max=400, help="Rooms that every caption is acted in.")] = 12,
    clips: Annotated[
        Path | None, typer.Option(help="Recorded motion besides: a collection of `sims clips build`.")
    ] = None,
    steps: Annotated[int, typer.Option(min=1, max=1_000_000, help="Batches of 64 clips.")] = 900,
    contrast: Annotated[
        float, typer.Option(min=0, max=100, help="Weight of telling captions apart; 0 is the paper's Eq. 3.")
    ] = 1.0,
    seed: Annotated[int, typer.Option(min=0, help="The same seed learns the same.")] = 0,
    workers: Annotated[int, typer.Option(min=1, max=64, help="Processes that act at once.")] = 1,
) -> None:
    """Learn one space for words and motion (SIMS Eq. 3 to 5) and say how often a caption's own motion is found.

    A fifth of the rooms and of the recorded people is kept back for that.
    """
    from motion_backend.datasets.motion_text_dataset import MotionTextDataset, motion_texts
    from motion_backend.datasets.splits import TEST, TRAIN
    from motion_backend.embedding.text_motion_autoencoder import AutoencoderConfig
    from motion_backend.embedding.text_motion_embedding import TextMotionEmbedding
    from motion_backend.embedding.train import TrainConfig
    from motion_backend.embedding.train import train as learn
    from motion_backend.language.sentence_encoder import load_encoder
    from planner_service.evaluation.embedding_evaluation import acted_retrieval, recorded_retrieval

    console = Console(markup=False, highlight=False)
    check_writable(out, (ACTED, WEIGHTS))
    acted, recorded = _acted(out / ACTED, rooms, workers, console).entries, recorded_clips(clips)
    learned, asked = _of(acted, TRAIN), _of(acted, TEST)
    dataset = MotionTextDataset(motion_texts(learned) + motion_texts(_of(recorded, TRAIN), grouped=False))
    encoder = load_encoder()
    features = dict(zip(dataset.wordings, encoder.encode(dataset.wordings), strict=True))
    model, scale = learn(
        dataset,
        features,
        out,
        TrainConfig(steps=steps, contrast=contrast, seed=seed),
        AutoencoderConfig(text_size=len(next(iter(features.values())))),
        lambda step, terms: console.print(f"{step} of {steps}  " + "  ".join(f"{k} {v:.3f}" for k, v in terms.items())),
    )
    seen = frozenset(entry.subject for entry in (*learned, *_of(recorded, TRAIN)))
    TextMotionEmbedding(model, scale, encoder, seen).save(out / WEIGHTS)
    shipped = TextMotionEmbedding.load(out / WEIGHTS, encoder)
    show(console, "our body, other rooms", acted_retrieval(shipped, asked))
    if _of(recorded, TEST):
        show(console, "other people", recorded_retrieval(shipped, _of(recorded, TEST)))
    console.print(f"weights in {out / WEIGHTS}", soft_wrap=True)


def show(console: Console, what: str, found: Retrieval) -> None:
    """A table of a retrieval, and its most frequent mistakes."""
    table = plain_table("retrieval", "clips", "groups", "own group first", "among three", "words find a clip")
    shares = (found.first, found.among_three, found.finds)
    table.add_row(what, str(found.clips), str(found.groups), *(f"{share:.1%}" for share in shares))
    console.print(table)
    for own, taken, times in found.taken_for[:8]:
        console.print(f"  {times} × {own}  →  {taken}", soft_wrap=True)


def _acted(file: Path, rooms: int, workers: int, console: Console) -> Dataset:
    """Our body acting all captions: what a run before has acted, else anew."""
    from motion_backend.mocap.dataset_file import dataset_bytes, read_dataset
    from motion_backend.motion import Skill
    from planner_service.evaluation.body_evaluation import plan_trials
    from planner_service.evaluation.captioned_clips import act_clips
    from planner_service.scripts.captions import captions

    if file.is_file():
        return read_dataset(file)
    trials = plan_trials({Skill(skill): some for skill, some in captions().items()}, rooms, 1)
    made = act_clips(trials, workers, lambda done, every: console.print(f"acted {done} of {every}"))
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(dataset_bytes(made))
    return made


def recorded_clips(file: Path | None) -> Sequence[Entry]:
    """The recorded people of a collection; none without one."""
    from motion_backend.mocap.dataset_file import read_dataset

    return [] if file is None else [entry for entry in read_dataset(file).entries if entry.kind == RECORDED]


def _of(entries: Sequence[Entry], side: str) -> list[Entry]:
    return [entry for entry in entries if entry.split == side]
