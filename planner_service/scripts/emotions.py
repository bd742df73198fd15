"""What sentences say about feelings: emotions that are named, and what hints at one ("her last exam")."""

from __future__ import annotations

from functools import cache

from motion_backend.emotion_words import Feeling, Stems, find, naming_words, whole
from motion_backend.motion import Emotion
from scene_graphs.data_tables import read_table, table


@table
class Hinting:
    """What hints at one emotion."""

    emotion: Emotion
    hints: tuple[str, ...]


@table
class EmotionHints:
    """Hints at each emotion that has some."""

    emotions: tuple[Hinting, ...]


def feelings(text: str) -> list[Feeling]:
    """Every emotion the text names or hints at, in the order of the text; "not happy" counts as sad, and "no longer
    sad" as relaxed.

    Words that are part of a longer saying do not count by themselves: "tears" in "tears up".
    """
    return whole([*find(text, naming_words(), sure=True), *find(text, _hinting_words(), sure=False)])


@cache
def _hinting_words() -> Stems:
    hints: EmotionHints = read_table("planner_service", "emotion_hints.toml", EmotionHints)
    return {row.emotion: row.hints for row in hints.emotions}
