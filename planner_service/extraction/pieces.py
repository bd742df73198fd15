"""What comes of one piece of a film or text, which is read by itself: a scene of a film, or a few scenes of words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from planner_service.extraction.making import Draft
from planner_service.extraction.results import SceneReport


@dataclass(frozen=True)
class Before:
    """What a piece has to know of those before it."""

    scenes: int = 0
    """How many there were."""
    room: str = ""
    """Where the last of them played."""
    failures: int = 0
    """Questions that the model did not answer; after some of them it is not asked again."""


@dataclass(frozen=True)
class PieceRead:
    """What came of a piece."""

    drafts: tuple[Draft, ...]
    scenes: tuple[SceneReport, ...]
    notes: tuple[str, ...]
    after: Before
    """What the next piece has to know."""


def joined(pieces: Sequence[PieceRead]) -> PieceRead:
    """Pieces that follow one another as one."""
    return PieceRead(
        tuple(draft for piece in pieces for draft in piece.drafts),
        tuple(scene for piece in pieces for scene in piece.scenes),
        tuple(note for piece in pieces for note in piece.notes),
        pieces[-1].after if pieces else Before(),
    )
