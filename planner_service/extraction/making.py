"""A short script from what was read of it: mended, named, labelled with where it was found and who wrote it down."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

from motion_backend.language.text import SentenceEncoder
from planner_service.extraction.writing import summarise
from planner_service.scripts.captions import Vocabulary
from planner_service.scripts.checking import repair
from planner_service.scripts.keyframe import MAX_PIECES, Keyframe, ShortScript, Source
from planner_service.scripts.library import ScriptLibrary
from planner_service.scripts.likeness import Likeness
from planner_service.scripts.naming import slug_of
from planner_service.scripts.picking import UNKNOWN

RULES: Final = "rules"
Span = tuple[float | None, float | None]


@dataclass(frozen=True)
class Draft:
    """A short script that was extracted."""

    script: ShortScript
    repairs: tuple[str, ...] = ()
    """What was changed so that a body can act it out, and why."""
    like: str = ""
    """Id of a script of the library that is nearly the same; empty where there is none."""


@dataclass
class Maker:
    """Makes short scripts of one text or film, with ids unlike each other, the library's and all that are reserved."""

    name: str
    library: ScriptLibrary
    source: Source = "text"
    licence: str = UNKNOWN
    _taken: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.reserve(script.id for script in self.library.scripts)

    def reserve(self, ids: Iterable[str]) -> None:
        """Use none of these ids."""
        self._taken.update(ids)

    @property
    def encoder(self) -> SentenceEncoder:
        """What turns texts into vectors here."""
        return self.library.encoder

    def by_rules(
        self,
        clauses: Sequence[str],
        keyframes: Sequence[Keyframe],
        emotion: str,
        room: str,
        span: Span,
        names: Sequence[str],
    ) -> Draft:
        """The script of some clauses, with a summary in their words."""
        return self.make(summarise(clauses, keyframes, emotion, names), keyframes, emotion, room, span, RULES)

    def make(self, summary: str, keyframes: Sequence[Keyframe], emotion: str, room: str, span: Span, by: str) -> Draft:
        """A script that a body can act out. ValidationError where a field does not fit."""
        kept, repairs = repair(keyframes, self._vocabulary)
        if len(kept) > MAX_PIECES:
            repairs = (*repairs, f"{len(kept)} keyframes; the first {MAX_PIECES} are kept")
        start, end = span
        script = ShortScript.model_validate(
            {
                "id": slug_of(summary, self.name, self._taken),
                "summary": summary,
                "emotion": emotion,
                "room": room,
                "keyframes": kept[:MAX_PIECES],
                "source": self.source,
                "licence": self.licence,
                "origin": {"name": self.name[:200], "start": start, "end": end, "by": by[:200]},
            }
        )
        self._taken.add(script.id)
        twin = self._likeness.twin(script)
        return Draft(script, repairs, twin.script_id if twin is not None else "")

    @cached_property
    def _vocabulary(self) -> Vocabulary:
        return Vocabulary.built_in(self.encoder)

    @cached_property
    def _likeness(self) -> Likeness:
        return Likeness(self.library)
