"""Regular expressions that stand in data files: named parts put in for `<part>`, bounded, valid, compiled once."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Final

MAX_PATTERN_LENGTH: Final = 3000
"""Letters of a pattern with its parts put in."""
_PART: Final = re.compile(r"(?<!\?P)<([a-z_]+)>")


def expanded(parts: Mapping[str, str]) -> dict[str, str]:
    """Parts with the parts before them put in. ValueError as `with_parts`."""
    found: dict[str, str] = {}
    for name, pattern in parts.items():
        found[name] = with_parts(f"parts.{name}", pattern, found)
    return found


def with_parts(place: str, pattern: str, parts: Mapping[str, str]) -> str:
    """A pattern with the parts put in; breaks between lines count for nothing. ValueError says at which place in the
    data a part is unknown, or what is wrong."""
    unknown = [name for name in _PART.findall(pattern) if name not in parts]
    if unknown:
        raise ValueError(f"{place}: there is no part <{unknown[0]}> before it")
    whole = _PART.sub(lambda part: parts[part[1]], pattern.replace("\n", ""))
    if len(whole) > MAX_PATTERN_LENGTH:
        raise ValueError(f"{place}: {len(whole)} letters with its parts, at most {MAX_PATTERN_LENGTH} are compiled")
    try:
        compiled(whole)
    except re.error as error:
        raise ValueError(f"{place}: {error} in {pattern[:60]!r}") from error
    return whole


def either(patterns: Iterable[str]) -> str:
    """One pattern for several ways."""
    return f"(?:{'|'.join(patterns)})"


@cache
def compiled(pattern: str) -> re.Pattern[str]:
    """The pattern, whatever the letters' case."""
    return re.compile(pattern, re.IGNORECASE)
