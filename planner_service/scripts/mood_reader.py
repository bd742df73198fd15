"""The emotion of a sentence, read from its features: a ridge regression on what short scripts are told in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.language.text import Vectors
from planner_service.scripts.keyframe import EMOTIONS, ShortScript
from planner_service.scripts.traits import Scores

TAUGHT: Final = 6_000
"""Texts that it learns from: those of our own library, which come first, and some more."""
_RIDGE: Final = 3.0
"""Of 1, 3 and 10 the best on cues of scripts it had not seen: right for 57 % of them, of nine emotions."""

_AHEAD: Final = 0.2
"""How much more a text must feel like one emotion than like the next to show it: right for 80 % of unseen cues."""


class MoodReader:
    """Knows no words: a sentence feels as the scripts feel that are told in sentences like it."""

    def __init__(self, vectors: Vectors, emotions: Sequence[str]) -> None:
        """Learn from one unit row a text and its emotion. (N, D)."""
        rows = _with_one(vectors)
        wanted = np.eye(len(EMOTIONS))[[EMOTIONS.index(emotion) for emotion in emotions]]
        squares = rows.T @ rows + _RIDGE * np.eye(rows.shape[1])
        self._weights = np.linalg.solve(squares, rows.T @ wanted)

    def read(self, vectors: Vectors) -> Scores:
        """How much each text feels like each of `EMOTIONS`, about 0 to 1, rounded to 1e-4. (N, 9)."""
        felt: Scores = (_with_one(vectors) @ self._weights).round(4)
        return felt


def clear_moods(felt: Scores) -> list[str | None]:
    """The emotion that each text clearly feels like, or None. `felt` is what `MoodReader.read` gives, (N, 9)."""
    clear: list[str | None] = []
    for row in felt:
        second, first = np.argsort(row, kind="stable")[-2:]
        clear.append(EMOTIONS[first] if row[first] - row[second] >= _AHEAD else None)
    return clear


def lessons(scripts: Sequence[ShortScript]) -> tuple[list[str], list[str]]:
    """At most `TAUGHT` texts that scripts are told in, and their emotions."""
    rows = [(text, script.emotion) for script in scripts[:TAUGHT] for text in (script.summary, *script.cues)][:TAUGHT]
    return [text for text, _ in rows], [emotion for _, emotion in rows]


def _with_one(vectors: Vectors) -> NDArray[np.float64]:
    return np.concatenate([vectors, np.ones((len(vectors), 1))], axis=1).astype(np.float64)
