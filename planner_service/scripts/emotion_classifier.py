"""The emotion of a sentence, read from its features: a ridge regression on sentences whose emotion is known.

They are what short scripts are told in, and `data/moods.json`: moments of people at home, by the emotion they bring.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cache
from importlib.resources import files
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.language.sentence_encoder import Vectors
from motion_backend.motion import Emotion
from planner_service.scripts.script import EMOTIONS, ShortScript
from planner_service.scripts.script_search import Scores

TAUGHT: Final = 6_000
"""Texts that it learns from: those of our own library, which come first, and some more."""
_RIDGE: Final = 3.0
"""Of 1, 3 and 10 the best on cues of scripts it had not seen: right for 57 % of them, of nine emotions."""

_KINDS: Final = (
    ("sad", "angry", "stressed"), ("happy", "relaxed"), ("hurried",), ("tired",), ("drunk",), ("neutral",),
)  # fmt: skip
"""Emotions that are more easily taken for each other than for the rest."""
_AHEAD, _KIND_AHEAD = 0.15, 0.25
"""How much more a text must feel like one emotion than like the next to show it, or like one kind of them than like the
next kind: of unseen moments 70 % show one, which is right for two thirds of them and its kind for four fifths."""


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


def clear_moods(felt: Scores) -> list[Emotion | None]:
    """The emotion that each text clearly feels like, or None. `felt` is what `MoodReader.read` gives, (N, 9)."""
    return [_clear(row) for row in felt]


def _clear(row: Scores) -> Emotion | None:
    second, first = np.argsort(row, kind="stable")[-2:]
    if row[first] - row[second] >= _AHEAD:
        return EMOTIONS[int(first)]
    kinds = [[EMOTIONS.index(emotion) for emotion in kind] for kind in _KINDS]
    sums = np.array([np.maximum(row[kind], 0).sum() for kind in kinds])
    next_kind, best = np.argsort(sums, kind="stable")[-2:]
    if sums[best] - sums[next_kind] < _KIND_AHEAD:
        return None
    loudest: int = max(kinds[best], key=lambda index: row[index])
    return EMOTIONS[loudest]


def lessons(scripts: Sequence[ShortScript]) -> tuple[list[str], list[str]]:
    """Moments of known emotion, and at most `TAUGHT` texts that scripts are told in; and their emotions."""
    told = [(text, script.emotion) for script in scripts[:TAUGHT] for text in (script.summary, *script.cues)][:TAUGHT]
    rows = [*told, *((moment, emotion) for emotion, those in moments().items() for moment in those)]
    return [text for text, _ in rows], [emotion for _, emotion in rows]


@cache
def moments() -> dict[str, list[str]]:
    """What happens to people at home, by the emotion that it brings, for all of `EMOTIONS`."""
    read: dict[str, list[str]] = json.loads((files("planner_service") / "data" / "moods.json").read_text())
    return read


def _with_one(vectors: Vectors) -> NDArray[np.float64]:
    return np.concatenate([vectors, np.ones((len(vectors), 1))], axis=1).astype(np.float64)
