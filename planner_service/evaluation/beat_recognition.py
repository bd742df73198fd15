"""How well the beat classifier knows what shows a labelled beat: by itself, without the rules around it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from planner_service.composition.beat_classifier import BeatClassifier
from planner_service.composition.beat_trainer import rows_of
from planner_service.evaluation.labels import LabelledTheme


@dataclass(frozen=True)
class Recognition:
    """Shares of labelled beats, in the labellers' words."""

    beats: int
    first: float
    """Of the beats that some caption shows: the likeliest caption is accepted."""
    shown: float
    """Of all: whether anything shows them is known."""
    placed: float
    """Of those that are done at certain furniture: the likeliest piece is accepted."""


def recognised(classifier: BeatClassifier, themes: Sequence[LabelledTheme]) -> Recognition:
    """The shares over all beats of some themes that are neither undone nor remembered."""
    known = classifier.vocabulary
    rows = rows_of(themes, known, ours=False)
    found = classifier.likely([row.clause for row in rows], [row.before for row in rows])
    pairs = list(zip(rows, found, strict=True))
    first = [row.captions[known.captions.index(one.best)] > 0 for row, one in pairs if row.captions.any()]
    shown = [(one.shown > 0.5) == (row.shown > 0) for row, one in pairs]
    places = [(row.pieces, list(one.pieces.values())) for row, one in pairs if row.pieces is not None]
    placed = [accepted[int(np.argmax(shares))] > 0 for accepted, shares in places]
    return Recognition(len(rows), *(float(np.mean(some)) if some else 0.0 for some in (first, shown, placed)))
