"""Which labelled events a long script plays, in order, and what it says of the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from planner_service.evaluating.labels import LabelledEvent
from planner_service.scripts.keyframe import LongScript


@dataclass(frozen=True)
class Coverage:
    """What became of one labelled event."""

    event: LabelledEvent
    covered: bool
    """Whether a short script plays it, in its place among the others."""
    listed: bool
    """Whether the long script says that it is not covered."""
    emotion: str | None
    """What it was given; None when the event was not found."""
    played: tuple[str, ...]
    """Ids of the short scripts that were chosen for it, right or wrong."""

    @property
    def hidden(self) -> bool:
        """Whether it is missing and nobody is told."""
        return not (self.covered or self.listed)

    @property
    def felt(self) -> bool:
        """Whether its emotion is right."""
        return self.emotion in self.event.emotions


def coverage(events: Sequence[LabelledEvent], script: LongScript) -> tuple[Coverage, ...]:
    """One a labelled event, in order; of events that cannot all be in order the most that can be count.

    A short script may play two events that follow each other, where the long script took them for one.
    """
    chosen = [(script.events[one.event].text, one.script) for one in script.short_scripts]
    fits = [[event.told_in(text) and event.played_by(played) for text, played in chosen] for event in events]
    covered = in_order(fits)
    return tuple(
        Coverage(
            event,
            index in covered,
            any(event.told_in(text) for text in script.uncovered),
            event.emotion_in(script),
            tuple(played.id for text, played in chosen if event.told_in(text)),
        )
        for index, event in enumerate(events)
    )


def in_order(fits: Sequence[Sequence[bool]]) -> frozenset[int]:
    """The most rows that can each be given a column that fits, no column before an earlier row's; earlier rows win."""
    best: dict[int, tuple[int, ...]] = {0: ()}  # the first column still free to the rows taken so far
    for row, columns in enumerate(fits):
        found = dict(best)
        for first, taken in best.items():
            column = next((place for place in range(first, len(columns)) if columns[place]), None)
            if column is not None and _better((*taken, row), found.get(column)):
                found[column] = (*taken, row)
        best = found
    most = min(best.values(), key=lambda rows: (-len(rows), rows))
    return frozenset(most)


def _better(rows: tuple[int, ...], others: tuple[int, ...] | None) -> bool:
    return others is None or (-len(rows), rows) < (-len(others), others)
