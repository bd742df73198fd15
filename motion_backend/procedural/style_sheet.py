"""Styles as data: what an emotion, and the words of a caption, change of a way to walk, sit or lie.

A sheet is a table with one section an emotion and one row a pattern of words, which may count in some `moods` alone.
Its keys are the fields of the style's class with their units behind them (`lean_deg`); a row names only what it
changes.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from functools import cache
from typing import Annotated, Any, NamedTuple, get_args, get_type_hints

from motion_backend.motion import Emotion
from scene_graphs.data_tables import read_table, table


@dataclass(frozen=True)
class Unit:
    """What a number of a style is measured in."""

    suffix: str
    """The end of its key in a sheet."""


Degrees = Annotated[float, Unit("deg")]
Radians = Annotated[float, Unit("rad")]
Metres = Annotated[float, Unit("m")]
MetresPerSecond = Annotated[float, Unit("m_per_s")]
Seconds = Annotated[float, Unit("s")]
ArmLengths = Annotated[float, Unit("arm_lengths")]
Ratio = Annotated[float, Unit("ratio")]
"""Against what is usual: 1 is as usual."""
Share = Annotated[float, Unit("share")]
Turns = Annotated[float, Unit("turns")]

Changes = Mapping[str, Any]
"""New values of some fields of a style, by field."""


class Row(NamedTuple):
    """What the words of a caption change."""

    words: re.Pattern[str]
    changes: Changes
    moods: tuple[Emotion, ...]
    """In these alone; in any where there are none."""


@dataclass(frozen=True)
class StyleSheet:
    """What emotions and captions change."""

    emotions: Mapping[Emotion, Changes]
    captions: tuple[Row, ...]
    """What the words of a caption change, the particular after the general."""

    def of_caption(self, caption: str, mood: Emotion = Emotion.NEUTRAL) -> dict[str, Any]:
        """What all rows change whose words a caption has, the later over the earlier."""
        changes: dict[str, Any] = {}
        for row in self.captions:
            if row.words.search(caption.lower()) and (not row.moods or mood in row.moods):
                changes |= row.changes
        return changes


@cache
def read_style_sheet(path: str, *styles: type) -> StyleSheet:
    """The sheet `data/styles/<path>`, whose rows change fields of these classes. TableError."""
    keys = {key: field for style in styles for key, field in _keys_of(style).items()}
    names = {key: name for key, (name, _) in keys.items()}
    hints = {key: hint for key, (_, hint) in keys.items()}
    change: Any = _table_of("Change", {}, hints)
    row: Any = _table_of("Row", {"words": str}, hints | {"moods": tuple[Emotion, ...]})
    sheet = _table_of("Sheet", {}, {"emotions": dict[Emotion, change], "captions": tuple[row, ...]})
    read: Any = read_table("motion_backend", f"styles/{path}", sheet)
    return StyleSheet(
        {emotion: _given(one, names) for emotion, one in (read.emotions or {}).items()},
        tuple(Row(re.compile(one.words), _given(one, names), one.moods or ()) for one in read.captions or ()),
    )


def _keys_of(style: type) -> dict[str, tuple[str, Any]]:
    """The fields that a sheet can change, and their types, by key."""
    hints = get_type_hints(style, include_extras=True)
    found = {}
    for field in fields(style):
        hint = hints[field.name]
        if not is_dataclass(hint):
            unit = next((one.suffix for one in get_args(hint) if isinstance(one, Unit)), None)
            found[f"{field.name}_{unit}" if unit else field.name] = (field.name, hint)
    return found


def _table_of(name: str, needed: Mapping[str, Any], others: Mapping[str, Any]) -> type:
    """A class of rows that have fields they need and others that may be left out, which are None then."""
    return table(type(name, (), {"__annotations__": {**needed, **others}, **dict.fromkeys(others)}))


def _given(row: object, names: Mapping[str, str]) -> Changes:
    return {name: value for key, name in names.items() if (value := getattr(row, key)) is not None}
