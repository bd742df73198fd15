"""What a language model is to imitate: the wish, and the stored short scripts that show the manner (SIMS 3.2)."""

from __future__ import annotations

from dataclasses import dataclass
from random import Random
from typing import Final

import numpy as np

from planner_service.scripts.keyframe import EMOTIONS, ShortScript
from planner_service.scripts.library import LibraryError, ScriptLibrary
from planner_service.scripts.picking import Choice
from scene_graphs.furniture import ROOM_TYPES, categories_of, is_known

MAX_WANTED: Final = 20
_EXAMPLES: Final = 5
_MIN_EXAMPLES: Final = 3
"""Examples below which those of another room, then of another emotion, are taken as well."""
_FROM: Final = 200
"""Scripts among which the examples are chosen."""


@dataclass(frozen=True)
class Wish:
    """What is to be imitated: so many scripts of an emotion in a room with this furniture. LibraryError."""

    emotion: str
    room: str
    count: int
    furniture: tuple[str, ...]

    def __post_init__(self) -> None:
        if self.emotion not in EMOTIONS:
            raise LibraryError(f"emotion: {self.emotion!r:.80} is none of {', '.join(EMOTIONS)}")
        if self.room not in ROOM_TYPES:
            raise LibraryError(f"room: {self.room!r:.80} is none of {', '.join(ROOM_TYPES)}")
        if not 1 <= self.count <= MAX_WANTED:
            raise LibraryError(f"count: {self.count} cannot be imitated at once; ask for 1 to {MAX_WANTED}")
        strange = [word for word in self.furniture if not is_known(word)]
        if strange or not self.furniture:
            said = f"{strange[0]!r:.80} is not known" if strange else "nothing to play with"
            raise LibraryError(f"furniture: {said}; name pieces such as bed, sofa, desk or wardrobe")

    @property
    def categories(self) -> frozenset[str]:
        """Of furniture that may be used."""
        return frozenset().union(*(categories_of(word) for word in self.furniture))


def examples(library: ScriptLibrary, wish: Wish, seed: int) -> tuple[ShortScript, ...]:
    """Three to five stored scripts of the emotion and room, as unlike each other as they are; others where these lack.

    The seed draws the first; each further one is the one whose summary is farthest from those chosen.
    """
    found: dict[str, ShortScript] = {}
    for choice in (Choice(wish.emotion, wish.room), Choice(wish.emotion), Choice(room=wish.room), Choice()):
        if len(found) < _MIN_EXAMPLES:
            found |= {script.id: script for script in choice.of(library)}
    if not found:
        raise LibraryError("library: there is no short script to imitate; add one first")
    draw = Random(seed)
    ids = sorted(found)
    pool = [found[one] for one in (draw.sample(ids, _FROM) if len(ids) > _FROM else ids)]
    vectors = library.features.of([script.summary for script in pool])
    near = np.round(vectors @ vectors.T, 4)
    chosen = [draw.randrange(len(pool))]
    while len(chosen) < min(_EXAMPLES, len(pool)):
        closest = near[:, chosen].max(axis=1)
        closest[chosen] = np.inf
        chosen.append(int(closest.argmin()))
    return tuple(pool[index] for index in chosen)
