"""Furniture and captions as prompts tell language models what they may choose from."""

from __future__ import annotations

from planner_service.scripts.captions import captions
from scene_graphs.catalogue import CATALOGUE, KINDS
from scene_graphs.furniture import display_name


def furniture_offered() -> str:
    """Every furniture word there is, between commas."""
    return ", ".join(sorted({display_name(word) for word in (*KINDS, *CATALOGUE)}))


def captions_offered(most: int | None = None) -> str:
    """A line a skill with its captions between semicolons, the first so many of them."""
    return "\n".join(f"  {skill}: {'; '.join(known[:most])}" for skill, known in captions().items())
