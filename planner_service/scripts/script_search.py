"""Queries held against every short script: nearness in meaning and shared words, fused into one score (SIMS 3.2).

Sentence features know that to snooze is to nap, and hardly tell "passed" from "failed"; words do, and know no synonym.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from motion_backend.language.sentence_encoder import SentenceEncoder, Vectors
from planner_service.scripts.keyword_index import KeywordIndex
from planner_service.scripts.script import ShortScript

Scores = NDArray[np.float64]

_WORDS: Final = 0.5
"""How much shared words count beside meaning."""
ABOUT: Final = {"hashing": 0.3, "": 0.35}
"""From what score a script is about a query, and not only the nearest there is, by the encoder's name; "" for any that
knows meaning."""


@dataclass(frozen=True)
class Found:
    """A short script and how well it answers what was asked, 0 to 1."""

    script: ShortScript
    score: float


class Searched(Protocol):
    """What a library knows of its scripts: see `ScriptLibrary`."""

    @property
    def encoder(self) -> SentenceEncoder: ...

    @property
    def keywords(self) -> KeywordIndex: ...

    def scores(self, vectors: Vectors) -> Scores: ...


def rank(queries: Sequence[str], library: Searched, vectors: Vectors | None = None) -> Scores:
    """How well each script answers each query, 0 to 1, rounded to 1e-4; the higher the better. (queries, scripts).

    `vectors` are the queries', where somebody has them already. (queries, D).
    """
    near = library.scores(library.encoder.encode(queries) if vectors is None else vectors)
    fused: Scores = (1 - _WORDS) * np.clip(near, 0, 1) + _WORDS * library.keywords.scores(queries)
    return fused.round(4)
