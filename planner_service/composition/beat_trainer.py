"""Learning which captions show a clause: adapters in every layer of the sentence encoder (LoRA), and one layer upon it.

Only what is added is learned: the encoder's own weights stay as they are, and are not shipped again.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn import functional
from torch.optim.swa_utils import AveragedModel

from motion_backend.language.minilm import HEADS, LAYERS, WIDTH, WordPiece
from motion_backend.motion import Emotion, Skill
from planner_service.composition.beat_classifier import PAIR, SCALE, TOKENS, Vocabulary, plain
from planner_service.composition.deed_reader import BEFORE
from planner_service.composition.deed_table import captions_of_gestures
from planner_service.evaluation.beat_judgement import same_words
from planner_service.evaluation.labels import Alternative, LabelledBeat, LabelledTheme
from planner_service.scripts.captions import captions
from planner_service.themes.beats import ThemeError, beats_of
from scene_graphs import furniture
from scene_graphs.errors import UserError

LINEAR: Final = (
    "attention.self.query",
    "attention.self.key",
    "attention.self.value",
    "attention.output.dense",
    "intermediate.dense",
    "output.dense",
)
"""The layers of BERT's blocks that get an adapter."""
SELDOM: Final = -2.5
"""Where the last layer begins: hardly anything shows a clause."""


@dataclass(frozen=True)
class BeatTraining:
    """How it is learned."""

    epochs: int = 5
    batch: int = 32
    chunk: int = 512
    """Of so many rows those that are about as long come together."""
    rank: int = 16
    rate: float = 1.5e-3
    """Of the adapters; twice as much for the last layer."""
    warm_up: int = 60
    least_rate: float = 0.02
    decay: float = 0.05
    dropout: float = 0.2
    memory: float = 0.998
    """What the weights that are shipped keep of themselves a step: they are a running mean of those that learn."""
    without_before: float = 0.25
    """How often a clause is read without what was told before it."""
    seed: int = 0


class Row(NamedTuple):
    """A clause with what shows it: floats, 1 for what does."""

    clause: str
    before: str
    captions: NDArray[np.float32]
    moods: NDArray[np.float32]
    pieces: NDArray[np.float32] | None
    """None where no label says at what furniture."""
    shown: float


def vocabulary() -> Vocabulary:
    """What there is to be told apart."""
    every = ((Skill(skill), one) for skill, some in captions().items() for one in some)
    known = tuple(one for one in every if one not in captions_of_gestures())
    return Vocabulary(known, tuple(Emotion), ("floor", *sorted(furniture.catalogue().categories)))


def rows_of(themes: Sequence[LabelledTheme], known: Vocabulary, ours: bool = True) -> list[Row]:
    """Every labelled beat in the labeller's words, and, with `ours`, in the words of the clause that we read for it.

    What is undone or remembered is told by its grammar, and is left out.
    """
    rows: list[Row] = []
    for theme in themes:
        told = [beat.text for beat in theme.beats]
        for place, beat in enumerate(theme.beats):
            if not (beat.undone or beat.memory):
                rows.append(_row(beat, beat.text, told[max(place - BEFORE, 0) : place], known))
        try:
            read = [one.text for one in beats_of(theme.theme)] if ours else []
        except ThemeError:
            continue
        for place, text in enumerate(read):
            fitting = [beat for beat in theme.beats if same_words(beat.text, text)]
            if len(fitting) == 1 and not (fitting[0].undone or fitting[0].memory) and text != fitting[0].text:
                rows.append(_row(fitting[0], text, read[max(place - BEFORE, 0) : place], known))
    return rows


def _row(beat: LabelledBeat, text: str, before: Sequence[str], known: Vocabulary) -> Row:
    deeds = [one for one in beat.shown_by if one.names_a_deed]
    kinds = {kind for one in deeds for word in one.furniture for kind in _kinds(word)}
    alone = {mood for one in beat.shown_by if not one.names_a_deed for mood in one.mood}
    shown = [any(_accepts(one, skill, caption) for one in deeds) for skill, caption in known.captions]
    return Row(
        text,
        ". ".join(before),
        np.array(shown, dtype=np.float32),
        np.array([mood in alone for mood in known.moods], dtype=np.float32),
        np.array([piece in kinds for piece in known.pieces], dtype=np.float32) if kinds else None,
        float(beat.actable),
    )


def _kinds(word: str) -> frozenset[str]:
    return frozenset(("floor",)) if word == "floor" else frozenset(furniture.categories_of(word))


def _accepts(one: Alternative, skill: Skill, caption: str) -> bool:
    fits = not one.caption or any(part.lower() in caption.lower() for part in one.caption)
    return fits and (not one.skill or skill in one.skill)


class Adapted(nn.Module):  # type: ignore[misc]
    """A linear layer that stays as it is, with a learned one of low rank beside it."""

    def __init__(self, weight: Tensor, bias: Tensor, rank: int, dropout: float) -> None:
        super().__init__()
        self.register_buffer("weight", weight)
        self.register_buffer("bias", bias)
        self.down = nn.Parameter(0.02 * torch.randn(rank, weight.shape[1]))
        self.up = nn.Parameter(torch.zeros(weight.shape[0], rank))
        self.dropout = nn.Dropout(dropout)

    def forward(self, x: Tensor) -> Tensor:
        """(..., in) to (..., out)."""
        beside = functional.linear(functional.linear(self.dropout(x), self.down), self.up)
        return functional.linear(x, self.get_buffer("weight"), self.get_buffer("bias")) + 2 * beside


class BeatNetwork(nn.Module):  # type: ignore[misc]
    """The encoder of `motion_backend.language.minilm` in torch, with adapters and the last layer."""

    def __init__(self, weights: Mapping[str, Tensor], known: Vocabulary, training: BeatTraining) -> None:
        super().__init__()
        self.plain = dict(weights)
        names = [f"encoder.layer.{index}.{name}" for index in range(LAYERS) for name in LINEAR]
        self.adapted = {
            name: Adapted(weights[f"{name}.weight"], weights[f"{name}.bias"], training.rank, training.dropout)
            for name in names
        }
        self.adapters = nn.ModuleList(self.adapted.values())
        self.pair = nn.Parameter(torch.zeros(2, WIDTH))
        self.head = nn.Linear(WIDTH, len(known.captions) + len(known.moods) + 1 + len(known.pieces))
        nn.init.constant_(self.head.bias, SELDOM)
        self.dropout = nn.Dropout(training.dropout)

    def forward(self, ids: Tensor, real: Tensor, kind: Tensor) -> Tensor:
        """Token ids, which are no padding, 0 or 1 for clause or what was before: (B, L) each. Logits (B, columns)."""
        words, places, kinds = (
            self.plain[f"embeddings.{name}_embeddings.weight"] for name in ("word", "position", "token_type")
        )
        x = words[ids] + places[: ids.shape[1]] + (kinds + self.pair)[kind]
        x = self.dropout(self._norm("embeddings.LayerNorm", x))
        for index in range(LAYERS):
            layer = f"encoder.layer.{index}"
            query, key, value = (
                self.adapted[f"{layer}.attention.self.{name}"](x).unflatten(2, (HEADS, -1)).transpose(1, 2)
                for name in ("query", "key", "value")
            )
            seen = functional.scaled_dot_product_attention(query, key, value, attn_mask=real[:, None, None, :])
            seen = self.adapted[f"{layer}.attention.output.dense"](seen.transpose(1, 2).flatten(2))
            x = self._norm(f"{layer}.attention.output.LayerNorm", x + self.dropout(seen))
            inner = functional.gelu(self.adapted[f"{layer}.intermediate.dense"](x))
            made = self.adapted[f"{layer}.output.dense"](inner)
            x = self._norm(f"{layer}.output.LayerNorm", x + self.dropout(made))
        ours = (real & (kind == 0)).float()[..., None]
        mean = (x * ours).sum(dim=1) / ours.sum(dim=1)
        logits: Tensor = self.head(self.dropout(mean) * SCALE)
        return logits

    def _norm(self, name: str, x: Tensor) -> Tensor:
        return functional.layer_norm(x, (WIDTH,), self.plain[f"{name}.weight"], self.plain[f"{name}.bias"], 1e-12)

    def begin_with(self, weights: Mapping[str, Tensor]) -> None:
        """Go on from weights as `learned` gives them; KeyError or RuntimeError where they are of another network."""
        with torch.no_grad():
            self.head.weight.copy_(weights["head.weight"])
            self.head.bias.copy_(weights["head.bias"])
            self.pair.copy_(weights[PAIR])
            for name, layer in self.adapted.items():
                layer.down.copy_(weights[f"{name}.A"])
                layer.up.copy_(weights[f"{name}.B"] / 2)

    def learned(self) -> dict[str, Tensor]:
        """What is shipped: half precision."""
        found = {"head.weight": self.head.weight, "head.bias": self.head.bias, PAIR: self.pair}
        for name, layer in self.adapted.items():
            found |= {f"{name}.A": layer.down, f"{name}.B": 2 * layer.up}
        return {name: value.detach().half().contiguous() for name, value in found.items()}


def batch_of(rows: Sequence[Row], tokens: WordPiece, alone: Callable[[], bool]) -> tuple[Tensor, Tensor, Tensor]:
    """Ids, mask and kind of tokens, (B, L) each; `alone` says whether the next row goes without what was before."""
    first = [tokens.encode(plain(row.clause), TOKENS) for row in rows]
    second = [[] if alone() or not row.before else tokens.encode(plain(row.before), TOKENS)[1:] for row in rows]
    length = max(len(one) + len(other) for one, other in zip(first, second, strict=True))
    ids = torch.zeros(len(rows), length, dtype=torch.long)
    kind, real = torch.zeros_like(ids), torch.zeros(len(rows), length, dtype=torch.bool)
    for place, (one, other) in enumerate(zip(first, second, strict=True)):
        ids[place, : len(one) + len(other)] = torch.tensor([*one, *other])
        kind[place, len(one) :], real[place, : len(one) + len(other)] = 1, True
    return ids, real, kind


def loss_of(logits: Tensor, rows: Sequence[Row]) -> Tensor:
    """Every column by itself, and that some accepted caption comes first."""
    shown = torch.from_numpy(np.stack([row.captions for row in rows]))
    moods = torch.from_numpy(np.stack([row.moods for row in rows]))
    some = torch.tensor([[row.shown] for row in rows])
    said, felt = shown.shape[1], shown.shape[1] + moods.shape[1]

    def each(columns: Tensor, wanted: Tensor) -> Tensor:
        return functional.binary_cross_entropy_with_logits(columns, wanted, reduction="none").sum(dim=1)

    loss = each(logits[:, :said], shown).mean() / 8 + each(logits[:, said:felt], moods).mean() / 2
    loss = loss + 2 * each(logits[:, felt : felt + 1], some).mean()
    placed = [place for place, row in enumerate(rows) if row.pieces is not None]
    if placed:
        wanted = torch.from_numpy(np.stack([row.pieces for row in rows if row.pieces is not None]))
        loss = loss + each(logits[placed, felt + 1 :], wanted).sum() / (8 * len(rows))
    told = shown.sum(dim=1) > 0
    if told.any():
        shares = functional.log_softmax(logits[told, :said], dim=1)
        loss = loss - torch.logsumexp(shares.masked_fill(shown[told] == 0, -torch.inf), dim=1).mean()
    return loss


def learn(
    rows: Sequence[Row],
    known: Vocabulary,
    folder: Path,
    training: BeatTraining | None = None,
    tell: Callable[[int, float], None] = lambda _epoch, _loss: None,
    start: Path | None = None,
) -> BeatNetwork:
    """A network that has learned the rows, upon the encoder of a folder; the same bytes for the same seed. Its weights
    are a running mean: those are righter, and less sure of what is wrong, than the last ones.

    It goes on from the weights in `start` where those are named. `tell` hears of every epoch and its mean loss.
    FloatingPointError when that is no number any more, UserError where `start` holds no weights of this network.
    """
    from safetensors import SafetensorError
    from safetensors.torch import load_file

    training = training or BeatTraining()
    torch.set_num_threads(1)  # the last digits change with their number
    torch.manual_seed(training.seed)
    rng = random.Random(training.seed)
    tokens = WordPiece((folder / "vocab.txt").read_text(encoding="utf-8").split("\n"))
    net = BeatNetwork(load_file(folder / "model.safetensors"), known, training)
    if start is not None:
        try:
            net.begin_with(load_file(start))
        except (OSError, SafetensorError, KeyError, RuntimeError) as error:
            raise UserError(f"{start} holds no beat classifier to go on from: {error}", at="start") from error
    mean_net = AveragedModel(net, avg_fn=_mean_of(training.memory))
    slow = [*net.adapters.parameters(), net.pair]
    groups = [{"params": list(net.head.parameters()), "lr": 2 * training.rate}, {"params": slow, "lr": training.rate}]
    optimizer = torch.optim.AdamW(groups, weight_decay=training.decay)
    steps = training.epochs * ceil(len(rows) / training.batch)
    schedule = torch.optim.lr_scheduler.LambdaLR(
        optimizer, lambda step: min(1.0, (step + 1) / training.warm_up) * max(training.least_rate, 1 - step / steps)
    )
    for epoch in range(training.epochs):
        losses = []
        for some in _batches(rows, tokens, training, rng):
            given = batch_of(some, tokens, lambda: rng.random() < training.without_before)
            loss = loss_of(net(*given), some)
            optimizer.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(net.parameters(), 1.0)
            optimizer.step()
            schedule.step()
            mean_net.update_parameters(net)
            losses.append(float(loss.detach()))
        mean = float(np.mean(losses))
        if not np.isfinite(mean):
            raise FloatingPointError(f"the loss of epoch {epoch} is {mean}: a smaller --rate may help")
        tell(epoch, mean)
    learned: BeatNetwork = mean_net.module.eval()
    return learned


def _mean_of(memory: float) -> Callable[[Tensor, Tensor, Tensor | int], Tensor]:
    """How the mean follows the weights: closely at first, then slowly."""

    def followed(mean: Tensor, weights: Tensor, steps: Tensor | int) -> Tensor:
        known = int(steps)
        return mean + (weights - mean) * (1 - min(memory, (1 + known) / (10 + known)))

    return followed


def _batches(rows: Sequence[Row], tokens: WordPiece, training: BeatTraining, rng: random.Random) -> list[list[Row]]:
    """All rows once, by chance, in batches of about the same length: little is padded."""
    order = [(row, len(tokens.encode(plain(row.clause), TOKENS))) for row in rows]
    rng.shuffle(order)
    batches = []
    for start in range(0, len(order), training.chunk):
        some = sorted(order[start : start + training.chunk], key=lambda one: one[1])
        batches += [[row for row, _ in some[at : at + training.batch]] for at in range(0, len(some), training.batch)]
    rng.shuffle(batches)
    return batches


def save(net: BeatNetwork, known: Vocabulary, path: Path) -> None:
    """The weights as `BeatClassifier` reads them."""
    from safetensors.torch import save_file

    save_file(net.learned(), path, metadata={"vocabulary": known.written()})
