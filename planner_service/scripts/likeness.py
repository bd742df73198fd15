"""Short scripts that are there already in other words: near in meaning, or the same to act."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from motion_backend.language.text import Vectors
from motion_backend.motion import Skill
from planner_service.scripts.fitting import place_of
from planner_service.scripts.keyframe import ShortScript
from planner_service.scripts.library import ScriptLibrary

MIN_DUPLICATE_COSINE: Final = 0.90
"""Cosine of two summaries' vectors from which on they tell the same."""
Doings = tuple[tuple[Skill, str, str, int], ...]


@dataclass(frozen=True)
class Twin:
    """The short script that another one is like."""

    script_id: str
    why: str


class Likeness:
    """What there is of short scripts, to hold new ones against."""

    def __init__(self, library: ScriptLibrary) -> None:
        self._library = library
        self._ids = [script.id for script in library.scripts]
        self._blocks = [library.summaries(range(len(library)))] if len(library) else []
        self._doings = {doings_of(script): script.id for script in reversed(library.scripts)}

    def twin(self, script: ShortScript) -> Twin | None:
        """The one of which this is a duplicate, if there is one: the same keyframes, or the nearest summary."""
        if (same := self._doings.get(doings_of(script))) is not None:
            return Twin(same, "the same keyframes")
        if not self._ids:
            return None
        vector = self._vectors(script)[0]
        near = np.concatenate([block @ vector for block in self._blocks]).round(4)
        best = int(near.argmax())
        return (
            Twin(self._ids[best], f"summaries alike ({near[best]:.2f})") if near[best] >= MIN_DUPLICATE_COSINE else None
        )

    def add(self, script: ShortScript) -> None:
        """From now on new ones are held against this one, too."""
        self._ids.append(script.id)
        self._blocks.append(self._vectors(script))
        self._doings.setdefault(doings_of(script), script.id)

    def _vectors(self, script: ShortScript) -> Vectors:
        """Of one that may never come back, so nothing remembers it. (1, D)."""
        return self._library.encoder.encode([script.summary])


def doings_of(script: ShortScript) -> Doings:
    """What the body does and where, whatever the mood: equal for scripts that look the same when acted out."""
    return tuple(
        (keyframe.skill, keyframe.caption.casefold(), *place_of(keyframe)[1:]) for keyframe in script.keyframes
    )
