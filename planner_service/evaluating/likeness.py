"""How alike stories are, and whether each is nearest to its own theme, by the vectors of their sentences."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from typing import Final

import numpy as np

from motion_backend.language.text import SentenceEncoder, Vectors

_SENTENCE: Final = re.compile(r"(?<=[.!?])\s+")


class RememberingEncoder:
    """An encoder that makes every vector once: seeds ask for the same events, stories share sentences."""

    def __init__(self, encoder: SentenceEncoder) -> None:
        self._encoder = encoder
        self._rows: dict[str, Vectors] = {}

    @property
    def name(self) -> str:
        """The name of the encoder inside: the vectors are the same."""
        return self._encoder.name

    def encode(self, texts: Sequence[str]) -> Vectors:
        """As the encoder inside. (N, D) float32."""
        new = [text for text in dict.fromkeys(texts) if text not in self._rows]
        if not texts:
            return self._encoder.encode([])
        self._rows.update(zip(new, self._encoder.encode(new) if new else (), strict=True))
        return np.stack([self._rows[text] for text in texts])


def text_vectors(texts: Sequence[str], encoder: SentenceEncoder) -> Vectors:
    """One unit row a text: the mean of its sentences' vectors, since encoders read only so much at once. (N, D)."""
    parts = [[part for part in _SENTENCE.split(text.strip()) if part] or [text] for text in texts]
    rows = encoder.encode(list(itertools.chain.from_iterable(parts)))
    starts = np.cumsum([0, *map(len, parts[:-1])])
    means = np.add.reduceat(rows, starts, axis=0)  # (N, D); a sum has the direction of the mean
    unit: Vectors = (means / np.linalg.norm(means, axis=1, keepdims=True)).astype(np.float32)
    return unit


def alike(vectors: Vectors) -> float:
    """Mean cosine of every two of the unit rows, rounded to 1e-4. ValueError when there are fewer than two."""
    if len(vectors) < 2:
        raise ValueError(f"vectors: {len(vectors)} of them; likeness needs two")
    first, second = np.triu_indices(len(vectors), k=1)
    return round(float((vectors @ vectors.T)[first, second].mean()), 4)


def nearness(story: Vectors, themes: Vectors, own: int) -> float:
    """Share of the other themes that a story (D,) is farther from than from its own among `themes` (N, D)."""
    near = (themes @ story).round(4)
    return float((np.delete(near, own) < near[own]).mean())
