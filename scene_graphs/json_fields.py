"""Reading checked fields out of JSON rows: every refusal names the field, what is wrong and what would be right."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator, Mapping
from typing import Any

from scene_graphs.errors import FieldPath, UserError

Json = dict[str, Any]
"""An object of JSON that we write."""
Row = Mapping[str, Any]
MAX_COORDINATE = 1000.0
"""No coordinate lies farther from the origin, in metres."""

_UNTOLD = frozenset("\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069\ufffe\uffff")
"""What turns the writing of a whole line round, and what no XML may hold."""


class LayoutError(UserError):
    """A room that cannot be read: names the place in the file, the field, what is wrong and what would be right."""

    joint = " "


def read_object(value: Any, where: FieldPath, what: str) -> Row:
    """A JSON object, which must be `what`."""
    if not isinstance(value, dict):
        raise LayoutError(f"must be {what}, got {type(value).__name__}", at=where)
    return value


def read_rows(row: Row, key: str, where: FieldPath, most: int) -> Iterator[tuple[Row, FieldPath]]:
    """The objects of a list field with the place of each; an absent field is an empty list."""
    items = row.get(key, [])
    if not isinstance(items, list) or len(items) > most:
        raise LayoutError(f"must be a list of at most {most} objects", at=where / key)
    for index, item in enumerate(items):
        if not isinstance(item, dict):
            raise LayoutError(f"must be an object, got {type(item).__name__}", at=where / key / index)
        yield item, where / key / index


def read_text(row: Row, key: str, where: FieldPath, default: str | None = None) -> str:
    """A text of 1 to 200 characters, none of which controls a terminal, turns the line round or is half a letter."""
    value = row.get(key, default)
    if not isinstance(value, str) or not 0 < len(value) <= 200:
        raise LayoutError(f"must be a text of 1 to 200 characters, got {value!r:.60}", at=where / key)
    if any(unicodedata.category(letter) in ("Cc", "Cs") or letter in _UNTOLD for letter in value):
        raise LayoutError(f"has control characters or letters that are not text: {value!a:.60}", at=where / key)
    return value


def read_texts(row: Row, key: str, where: FieldPath, most: int) -> tuple[str, ...]:
    """The texts of a list field; an absent field is an empty list."""
    texts = row.get(key) or []
    if not isinstance(texts, list) or len(texts) > most:
        raise LayoutError(f"must be a list of at most {most} texts, got {texts!r:.60}", at=where / key)
    return tuple(read_text({str(index): text}, str(index), where / key) for index, text in enumerate(texts))


def read_number(value: Any, where: FieldPath, least: float, most: float) -> float:
    """A finite number between two bounds."""
    if isinstance(value, bool) or not isinstance(value, int | float) or value != value:
        raise LayoutError(f"must be a number, got {value!r:.60}", at=where)
    if not least <= value <= most:
        raise LayoutError(f"must lie between {least:g} and {most:g}, got {value!r:.60}", at=where)
    return float(value)


def read_point2(value: Any, where: FieldPath) -> tuple[float, float]:
    """An [x, z] point in metres."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise LayoutError(f"must be [x, z] in metres, got {value!r:.60}", at=where)
    x, z = (read_number(number, where, -MAX_COORDINATE, MAX_COORDINATE) for number in value)
    return (x, z)


def read_point3(value: Any, where: FieldPath, least: float, most: float) -> tuple[float, float, float]:
    """Three numbers between two bounds."""
    if not isinstance(value, list | tuple) or len(value) != 3:
        raise LayoutError(f"must be three numbers [x, y, z] in metres, got {value!r:.60}", at=where)
    x, y, z = (read_number(number, where, least, most) for number in value)
    return (x, y, z)
