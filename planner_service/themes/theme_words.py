"""The lists of words by which the rules read themes."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from planner_service.themes.lexicon import Words
from scene_graphs.data_tables import read_table


@cache
def theme_words() -> Mapping[str, frozenset[str]]:
    """The lists of data/theme_words.toml by their names; what each is for stands there."""
    known: dict[str, frozenset[str]] = read_table("planner_service", "theme_words.toml", dict[str, Words])
    return known
