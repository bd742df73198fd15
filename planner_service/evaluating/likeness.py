"""How alike stories are, and whether each is nearest to its own theme: every sentence with the one most like it."""

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


def sentence_vectors(text: str, encoder: SentenceEncoder) -> Vectors:
    """One unit row a sentence: an encoder reads only so much at once, and a mean would favour long texts. (N, D)."""
    return encoder.encode([part for part in _SENTENCE.split(text.strip()) if part] or [text])


def told_in(text: Vectors, other: Vectors) -> float:
    """How well each sentence of a text is told by some sentence of another, on average, -1 to 1. (N, D), (M, D)."""
    return float((text @ other.T).max(axis=1).mean())


def alike(texts: Sequence[Vectors]) -> float:
    """Mean of how well every text is told in every other, to 1e-4. ValueError when there are fewer than two."""
    if len(texts) < 2:
        raise ValueError(f"texts: {len(texts)} of them; likeness needs two")
    return round(float(np.mean([told_in(one, other) for one, other in itertools.permutations(texts, 2)])), 4)


def nearness(story: Vectors, themes: Sequence[Vectors], own: int) -> float:
    """Share of the other themes that are told in a story less well than its own is."""
    near = np.array([told_in(theme, story) for theme in themes]).round(4)
    return float((np.delete(near, own) < near[own]).mean())
