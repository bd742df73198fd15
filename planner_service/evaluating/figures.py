"""One measured figure over a labelled set and its halves, beside its limit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeVar

from planner_service.evaluating.labels import SPLITS, LabelledTheme, Query, Split

Part = Literal["all", "tune", "held_out"]
T = TypeVar("T")


@dataclass(frozen=True)
class Figure:
    """A figure of the whole set and of each half; shares are between 0 and 1."""

    name: str
    all: float
    tune: float
    held_out: float
    limit: float | None = None
    """None where it is only told."""
    sense: Literal["least", "below", "most"] = "least"
    judged: Part = "all"
    """Which of the three the limit is for."""

    @property
    def missed(self) -> bool:
        """Whether the limit is not kept."""
        value: float = getattr(self, self.judged)
        if self.limit is None:
            return False
        return {"least": value < self.limit, "below": value >= self.limit, "most": value > self.limit}[self.sense]


@dataclass(frozen=True)
class Miss:
    """One thing that went wrong, with the half it was found in."""

    split: Split
    id: str
    """Of the query or theme."""
    text: str


def figure(
    name: str,
    labels: Sequence[Query | LabelledTheme],
    values: Sequence[T],
    summed: Callable[[Sequence[T]], float],
    limit: float | None = None,
    judged: Part = "all",
) -> Figure:
    """A figure `summed` up of one value a label, over all and over each half. Rounded to 1e-4."""
    halves = {
        split: [value for label, value in zip(labels, values, strict=True) if label.split == split] for split in SPLITS
    }
    tune, held_out = (round(summed(halves[split]), 4) for split in SPLITS)
    return Figure(name, round(summed(list(values)), 4), tune, held_out, limit, judged=judged)
