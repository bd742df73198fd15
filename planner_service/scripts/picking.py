"""Which short scripts of a library are meant: by emotion, room, furniture, source and licence."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from planner_service.scripts.keyframe import ShortScript
from planner_service.scripts.library import Found, ScriptLibrary

UNKNOWN: Final = "unknown"
"""The licence of what nobody knows the licence of."""
FOUND: Final = frozenset({"video", "text"})
"""Sources that are works of others."""


@dataclass(frozen=True)
class Choice:
    """What a short script must be; what is left out does not matter."""

    emotion: str | None = None
    room: str | None = None
    furniture: tuple[str, ...] = ()
    """It uses all of these."""
    source: str | None = None
    licence: str | None = None

    def of(self, library: ScriptLibrary) -> tuple[ShortScript, ...]:
        """Those of a library, in its order. LibraryError for a word that is not known."""
        fitting = np.flatnonzero(library.fitting(self.emotion, self.room, self.furniture))
        return tuple(script for index in fitting if self._allows(script := library.scripts[index]))

    def search(self, library: ScriptLibrary, query: str, k: int) -> tuple[Found, ...]:
        """The k of them that are nearest to the query in meaning, nearest first. LibraryError."""
        everything = self.source is not None or self.licence is not None
        found = library.search(query, len(library) if everything else k, self.emotion, self.room, self.furniture)
        return tuple(one for one in found if self._allows(one.script))[:k]

    def _allows(self, script: ShortScript) -> bool:
        return self.source in (None, script.source) and self.licence in (None, script.licence)


def unlicensed(script: ShortScript) -> bool:
    """Whether somebody else's work comes without a word on its licence."""
    return script.source in FOUND and "licence" not in script.model_fields_set


def unknown_licences(scripts: Iterable[ShortScript]) -> tuple[str, ...]:
    """Ids of scripts of which nobody knows whether they may be passed on."""
    return tuple(script.id for script in scripts if script.licence.strip().lower() == UNKNOWN)
