"""The subtitles that a film carries within itself."""

from __future__ import annotations

from typing import Final

from planner_service.extraction.containers import load_av, opened, said
from planner_service.extraction.film import Film, text_tracks
from planner_service.extraction.subtitles import MAX_CUES, MAX_SUBTITLE_BYTES, Cue, Subtitles, cues_of, ordered

_COMMAS: Final = 8
"""Before the text in an event as FFmpeg gives it: order, layer, style, name, three margins, effect."""
_LONG: Final = 60.0
"""Seconds that a cue stays at most."""


def embedded_cues(film: Film) -> Subtitles | None:
    """The cues of the film's track of letters, on the clock of its pictures; None where there is none.

    Of several tracks with words the English one is read, else the one that is shown by default. Subtitles that are
    pictures are not read. FilmError.
    """
    with opened(film.source, film.form) as container:
        count = len(text_tracks(container))
    empty: list[str] = []
    for place in range(count):
        cues, language = _read(film, place)
        if cues:
            without = f"; nothing in: {', '.join(empty)}" if empty else ""
            notes = (f"{count} tracks of subtitles; read: {language}{without}",) if count > 1 else ()
            return Subtitles(ordered(cues), "embedded", "utf-8", notes)
        empty.append(language)
    return None


def _read(film: Film, place: int) -> tuple[list[Cue], str]:
    """The cues of one of the tracks, counted in the order of `text_tracks`, and its language."""
    error_type = load_av().FFmpegError
    cues: list[Cue] = []
    letters = 0
    with opened(film.source, film.form) as container:
        track = text_tracks(container)[place]
        packets = container.demux(track)
        base = float(track.time_base or 0)
        while len(cues) < MAX_CUES and letters < MAX_SUBTITLE_BYTES:
            try:
                packet = next(packets, None)
                if packet is None:
                    break
                found = packet.decode() if packet.pts is not None and packet.size else []
            except error_type as error:
                film.faults[f"times the subtitles broke off ({said(error)})"] += 1
                continue
            for subtitle in found:
                row = bytes(getattr(subtitle, "ass", b""))
                letters += len(row)
                start = (packet.pts or 0) * base - film.start
                length = packet.duration * base if packet.duration else 2.0
                cues += _cues(row.decode("utf-8", errors="replace"), start, start + min(length, _LONG))
        return cues, track.language or "no language named"


def _cues(row: str, start: float, end: float) -> list[Cue]:
    """What an event in FFmpeg's ASS says; nothing for one before the film."""
    parts = row.split(",", _COMMAS)
    if len(parts) <= _COMMAS or end <= 0:
        return []
    return cues_of(round(max(0.0, start), 3), round(end, 3), parts[-1], parts[3].strip() or None)
