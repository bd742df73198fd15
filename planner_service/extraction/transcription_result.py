"""What comes of listening to a piece of sound: cues with times of the film, or why there are none."""

from __future__ import annotations

from planner_service.extraction.audio import SoundPiece
from planner_service.extraction.subtitles import Cue, cues_of
from scene_graphs.errors import UserError


class SpeechError(UserError):
    """Speech could not be turned into words; says what would help."""


def heard(piece: SoundPiece, start: float, end: float, text: str) -> list[Cue]:
    """A cue from times within a piece, moved to those of the film and kept inside the piece."""
    begin, stop = (round(min(max(piece.start + time, piece.start), piece.end), 3) for time in (start, end))
    return cues_of(begin, stop, text) if begin < stop else []
