"""Regular expressions that stand in data files: bounded, valid, compiled once."""

from __future__ import annotations

import re
from functools import cache
from typing import Final

MAX_PATTERN_LENGTH: Final = 3000
"""Letters of a pattern."""


@cache
def pattern_at(place: str, pattern: str) -> re.Pattern[str]:
    """A pattern of a table, whatever the letters' case; breaks between lines count for nothing. ValueError says at
    which place in the data what is wrong."""
    whole = pattern.replace("\n", "")
    if len(whole) > MAX_PATTERN_LENGTH:
        raise ValueError(f"{place}: {len(whole)} letters, at most {MAX_PATTERN_LENGTH} are compiled")
    try:
        return re.compile(whole, re.IGNORECASE)
    except re.error as error:
        raise ValueError(f"{place}: {error} in {whole[:60]!r}") from error
