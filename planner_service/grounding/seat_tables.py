"""What a body rests on for several keyframes, and the table that a seat stands at where something done on it needs one:
who reads on a sofa and dozes off there must be able to lie on it, and nobody writes on a chair by a wall."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import groupby
from typing import Final

from motion_backend.motion import Skill
from planner_service.composition.deed_table import deed_table
from planner_service.scripts.script import Keyframe

_AT_A_TABLE: Final = re.compile(r"\b(?:at|on) the table\b|\bkeyboard\b")
_AT_A_DESK: Final = re.compile(r"\bwriting\b|\bkeyboard\b")
_LOW: Final = ("coffee table",)
"""Tables that nobody writes or eats at with a straight back."""


def table_of(keyframe: Keyframe) -> str | None:
    """The word for the table that belongs to the seat of a keyframe; None where its caption needs none, and for sofas,
    which stand at low ones."""
    if keyframe.skill is not Skill.SITDOWN or keyframe.on_floor or not _AT_A_TABLE.search(keyframe.caption):
        return None
    seat = keyframe.piece[0]
    tables = [table for table, seats in deed_table().seats_at.items() if seat in seats and table not in _LOW]
    at_desk = _AT_A_DESK.search(keyframe.caption) is not None
    return next(iter(sorted(tables, key=lambda table: (table == "desk") is not at_desk)), None)


def rests(keyframes: Sequence[Keyframe]) -> list[list[int]]:
    """The places of keyframes that follow each other on one seat or bed."""

    def rested_on(place: int) -> tuple[object, ...]:
        one = keyframes[place]
        return (one.piece, getattr(one, "room", None)) if one.skill in (Skill.SITDOWN, Skill.LIEDOWN) else ()

    return [list(run) for on, run in groupby(range(len(keyframes)), rested_on) if on]


def done_at_tables(keyframes: Sequence[Keyframe]) -> list[str | None]:
    """For each keyframe the caption that its seat needs a table for: its own, or that of what else is done there."""
    found: list[str | None] = [None] * len(keyframes)
    for run in rests(keyframes):
        busy = next((keyframes[place].caption for place in run if table_of(keyframes[place]) is not None), None)
        for place in run:
            found[place] = busy
    return found


def tables_of(keyframes: Sequence[Keyframe]) -> list[str | None]:
    """For each keyframe the table that its seat stands at."""
    busy = done_at_tables(keyframes)
    return [
        table_of(one.model_copy(update={"caption": caption, "skill": Skill.SITDOWN})) if caption is not None else None
        for one, caption in zip(keyframes, busy, strict=True)
    ]
