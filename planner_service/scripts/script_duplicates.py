"""Short scripts that are there already in other words: near in meaning, or the same to act.

Ids of short scripts: the telling words of a summary, unlike all ids that are taken.
"""

from __future__ import annotations

import hashlib
import re
import unicodedata
from collections.abc import Collection
from dataclasses import dataclass
from typing import Final

import numpy as np

from motion_backend.language.sentence_encoder import Vectors
from motion_backend.motion import Skill
from planner_service.scripts.script import ShortScript
from planner_service.scripts.script_library import ScriptLibrary
from planner_service.scripts.script_words import place_of

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


_WORDS: Final = 6
_MAX_NAME_LENGTH: Final = 70
_PALE_WORDS: Final = "the character a an and their is are of to in on at for with from it they then them has"
_PALE: Final = frozenset(_PALE_WORDS.split())


def slug_of(summary: str, name: str, taken: Collection[str], first: str = "") -> str:
    """An id of the summary's telling words, behind a `first` one if that is given; numbered where it is taken.

    `name`, of a film or text, tells summaries apart that have no Latin letter.
    """
    plain = unicodedata.normalize("NFKD", summary).encode("ascii", "ignore").decode().lower().replace("'", "")
    words = [word for word in re.findall(r"[a-z0-9]+", plain) if word not in _PALE][:_WORDS]
    words = words or ["scene", hashlib.sha256(f"{name}{summary}".encode()).hexdigest()[:8]]
    slug = "-".join(filter(None, (first, *words)))[:_MAX_NAME_LENGTH].strip("-")
    names = (slug if number == 1 else f"{slug}-{number}" for number in range(1, len(taken) + 2))
    return next(one for one in names if one not in taken)
