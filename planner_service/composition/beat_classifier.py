"""Which captions at which furniture a fair viewer takes for what a clause tells: learned from labelled beats.

The sentence encoder, adapted a little in every layer (LoRA), reads a clause; one linear layer tells how likely each
caption of the vocabulary shows it, at which furniture hands do it, which moods alone show it, and whether anything
does.
docs/model_cards/beat_classifier.md has data and figures, `sims train beats` makes the weights again.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import as_file, files
from pathlib import Path
from typing import Final

import numpy as np

from motion_backend.language.minilm import Floats, MiniLM, WeightsError
from motion_backend.motion import Emotion, Skill
from planner_service.composition.deed_table import captions_of_gestures
from planner_service.scripts.captions import captions

SHIPPED: Final = "beat_classifier.safetensors"
TOKENS: Final = 48
"""Of a clause at most."""
SCALE: Final = 3.0
"""What means over tokens are multiplied by before the last layer."""
PAIR: Final = "embeddings.token_type_embeddings.weight"
"""What tells a clause from what was told before it."""
Caption = tuple[Skill, str]


@dataclass(frozen=True)
class Vocabulary:
    """What the columns of the last layer stand for, in their order; one more follows the moods: anything shows it."""

    captions: tuple[Caption, ...]
    moods: tuple[Emotion, ...]
    pieces: tuple[str, ...]
    """Categories of furniture, and "floor"."""

    @staticmethod
    def read(text: str) -> Vocabulary:
        """From JSON; WeightsError where our captions, those of gestures aside, are not those that were learned."""
        known = json.loads(text)
        learned = tuple((Skill(skill), caption) for skill, caption in known["captions"])
        ours = {(Skill(skill), one) for skill, some in captions().items() for one in some}
        if set(learned) != ours - captions_of_gestures():
            raise WeightsError(
                "the captions are not those that the beat classifier has learned", "train it again: sims train beats"
            )
        return Vocabulary(learned, tuple(map(Emotion, known["moods"])), tuple(known["pieces"]))

    def written(self) -> str:
        """As JSON, for `read`."""
        rows = [[skill.value, caption] for skill, caption in self.captions]
        return json.dumps({"captions": rows, "moods": [mood.value for mood in self.moods], "pieces": self.pieces})


@dataclass(frozen=True)
class Likely:
    """How likely a fair viewer accepts something for what one clause tells: probabilities."""

    captions: dict[Caption, float]
    moods: dict[Emotion, float]
    """Each alone, whatever is done in it."""
    pieces: dict[str, float]
    """Where hands do it, if they do."""
    shown: float
    """That anything shows it."""

    @property
    def best(self) -> Caption:
        """The likeliest caption."""
        return max(self.captions, key=lambda one: self.captions[one])

    def has_learned(self, skill: Skill, caption: str) -> bool:
        """Whether it was among the captions that were learned: those of gestures are known by the table alone."""
        return (skill, caption) in self.captions

    def of(self, skill: Skill, some: Collection[str]) -> float:
        """The likeliest of some captions of a skill; 0 for none that are known."""
        return max((self.captions.get((skill, one), 0.0) for one in some), default=0.0)


class BeatClassifier:
    """The adapted encoder and the last layer."""

    def __init__(self, encoder: MiniLM, weights: Path) -> None:
        from safetensors import SafetensorError, safe_open

        try:
            with safe_open(weights, framework="numpy") as stored:
                known = {name: stored.get_tensor(name).astype(np.float32) for name in stored.keys()}  # noqa: SIM118
                self.vocabulary = Vocabulary.read(stored.metadata()["vocabulary"])
            self._last: tuple[Floats, Floats] = known["head.weight"], known["head.bias"]
            adapters = sorted(name.removesuffix(".A") for name in known if name.endswith(".A"))
            changes: dict[str, Floats] = {PAIR: known[PAIR]}
            changes |= {f"{name}.weight": known[f"{name}.B"] @ known[f"{name}.A"] for name in adapters}
        except (OSError, SafetensorError, KeyError, TypeError) as error:
            raise WeightsError(f"{weights} holds no beat classifier: {error}") from error
        self._encoder = encoder.adapted(changes)

    def likely(self, clauses: Sequence[str], before: Sequence[str]) -> list[Likely]:
        """What each clause is likely shown by, as it is told after what was told `before` it."""
        if not clauses:
            return []
        weight, bias = self._last
        means = self._encoder.means([plain(one) for one in clauses], TOKENS, [plain(one) for one in before])
        shares = 1 / (1 + np.exp(-(means * np.float32(SCALE) @ weight.T + bias)))  # (N, captions + moods + 1 + pieces)
        return [self._told(row.tolist()) for row in shares]

    def _told(self, row: list[float]) -> Likely:
        known = self.vocabulary
        said, felt = len(known.captions), len(known.captions) + len(known.moods)
        return Likely(
            dict(zip(known.captions, row[:said], strict=True)),
            dict(zip(known.moods, row[said:felt], strict=True)),
            dict(zip(known.pieces, row[felt + 1 :], strict=True)),
            row[felt],
        )


def plain(clause: str) -> str:
    """A clause as the classifier reads it."""
    return clause.lower().rstrip(".")


@lru_cache(maxsize=1)
def shipped(encoder: MiniLM) -> BeatClassifier:
    """The classifier that is shipped, upon an encoder that is loaded already."""
    with as_file(files("planner_service") / "data" / SHIPPED) as path:
        return BeatClassifier(encoder, path)
