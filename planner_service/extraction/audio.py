"""The sound of a film in pieces that a transcriber can take: 16 kHz, one channel, cut where it is quiet.

What comes of listening to a piece: cues with times of the film, or why there are none.
"""

from __future__ import annotations

import io
import wave
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from planner_service.extraction.subtitles import Cue, cues_of
from planner_service.extraction.video import Film
from planner_service.extraction.video_container import SOUNDS, load_av, opened, said
from scene_graphs.errors import UserError

RATE: Final = 16_000
"""Samples a second."""
MAX_AUDIO_SECONDS: Final = 60.0
"""Seconds of a piece."""
_QUIET_WITHIN: Final = 8.0
"""Seconds before the end of a piece in which a quiet place is looked for."""
_WINDOW: Final = 0.05
"""Seconds of a quiet place."""
_GAP: Final = 0.25
"""Seconds without sound that begin a new piece."""
_SILENT: Final = 30
"""Loudest sample of silence, of 32768."""
Samples = NDArray[np.int16]


@dataclass(frozen=True)
class SoundPiece:
    """A piece of a film's sound (seconds of the film), as a WAV file."""

    start: float
    end: float
    wav: bytes = field(repr=False)


def sound_of(film: Film) -> Iterator[SoundPiece]:
    """The film's first track of sound in order, on the clock of its pictures; silent pieces are left out. FilmError."""
    held: list[Samples] = []
    start = 0.0
    for time, samples in _samples(film):
        length = sum(map(len, held)) / RATE
        if held and abs(time - (start + length)) > _GAP:
            yield from _piece(start, np.concatenate(held))
            held = []
        if not held:
            start = time
        held.append(samples)
        if length + len(samples) / RATE >= MAX_AUDIO_SECONDS:
            whole = np.concatenate(held)
            cut = _quiet_place(whole[: int(MAX_AUDIO_SECONDS * RATE)])
            yield from _piece(start, whole[:cut])
            held, start = [whole[cut:]], start + cut / RATE
    if held:
        yield from _piece(start, np.concatenate(held))


def _samples(film: Film) -> Iterator[tuple[float, Samples]]:
    """Decoded sound with its times, never before the pictures begin nor after a film may end."""
    av = load_av()
    with opened(film.source, film.form) as container:
        tracks = [one for one in container.streams.audio if one.codec_context and one.codec_context.name in SOUNDS]
        if not tracks:
            return
        track = tracks[0]
        track.codec_context.thread_count = 1
        resampler = av.AudioResampler(format="s16", layout="mono", rate=RATE)
        packets = container.demux(track)
        time = 0.0
        while True:
            try:
                packet = next(packets, None)
                frames = packet.decode() if packet is not None else []
            except av.FFmpegError as error:
                film.faults[f"damaged pieces of sound ({said(error)})"] += 1
                continue
            if packet is None:
                return
            for frame in frames:
                time = time if frame.time is None else frame.time - film.start
                if time > film.limits.seconds:
                    return
                parts = [part.to_ndarray()[0] for part in resampler.resample(frame)]
                if parts and time >= 0:
                    yield time, np.concatenate(parts)
                time += frame.samples / (frame.sample_rate or RATE)


def _quiet_place(samples: Samples) -> int:
    """Where to cut: the middle of the quietest moment near the end."""
    width = int(_WINDOW * RATE)
    begin = max(0, len(samples) - int(_QUIET_WITHIN * RATE))
    tail = samples[begin:].astype(np.float32)
    energy = (tail[: len(tail) // width * width].reshape(-1, width) ** 2).mean(axis=1)
    return begin + int(np.argmin(np.round(energy, 4))) * width + width // 2


def _piece(start: float, samples: Samples) -> Iterator[SoundPiece]:
    if len(samples) == 0 or int(np.abs(samples.astype(np.int32)).max()) <= _SILENT:
        return
    file = io.BytesIO()
    with wave.open(file, "wb") as out:
        out.setnchannels(1)
        out.setsampwidth(2)
        out.setframerate(RATE)
        out.writeframes(samples.astype("<i2").tobytes())
    yield SoundPiece(round(start, 3), round(start + len(samples) / RATE, 3), file.getvalue())


class SpeechError(UserError):
    """Speech could not be turned into words; says what would help."""


def heard(piece: SoundPiece, start: float, end: float, text: str) -> list[Cue]:
    """A cue from times within a piece, moved to those of the film and kept inside the piece."""
    begin, stop = (round(min(max(piece.start + time, piece.start), piece.end), 3) for time in (start, end))
    return cues_of(begin, stop, text) if begin < stop else []
