"""Speech to cues: a server's model or one in a folder listens to a film piece by piece."""

from __future__ import annotations

import io
from dataclasses import dataclass
from functools import cached_property
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final, Protocol

from planner_service.extraction.audio import SoundPiece, SpeechError, heard, sound_of
from planner_service.extraction.shot_detection import Progress
from planner_service.extraction.subtitles import MAX_CUES, Cue, Subtitles, ordered
from planner_service.extraction.video import Film
from planner_service.settings import Settings, SettingsError

INSTALL: Final = 'pip install "sims-stories[asr]"'


class Transcriber(Protocol):
    """What turns speech into words."""

    @property
    def name(self) -> str:
        """Such as "asr:whisper-1"."""
        ...

    def transcribe(self, piece: SoundPiece) -> list[Cue]:
        """What is said in a piece, with times of the film. SpeechError."""
        ...


def hear(transcriber: Transcriber, film: Film, progress: Progress | None = None) -> Subtitles:
    """Everything that is said in a film; no cue where it has no sound. SpeechError, FilmError."""
    cues: list[Cue] = []
    for piece in sound_of(film):
        cues += transcriber.transcribe(piece)
        if len(cues) > MAX_CUES:
            raise SpeechError(
                f"{transcriber.name} heard more than {MAX_CUES} cues", "give subtitles instead", at="speech"
            )
        if progress is not None:
            progress("listening", min(0.99, piece.end / film.claimed) if film.claimed else 0.0)
    if progress is not None:
        progress("listening", 1.0)
    return Subtitles(ordered(cues), "speech", "utf-8", (f"what is said was heard by {transcriber.name}",))


@dataclass(frozen=True)
class LocalTranscriber:
    """faster-whisper on a model in a folder; nothing is ever downloaded."""

    folder: Path

    @property
    def name(self) -> str:
        """By the folder's name."""
        return f"faster-whisper:{self.folder.name}"

    def transcribe(self, piece: SoundPiece) -> list[Cue]:
        """What is said in a piece, with times of the film. SpeechError."""
        try:
            segments, _ = self._model.transcribe(io.BytesIO(piece.wav), vad_filter=False)
            found = [(float(one.start), float(one.end), str(one.text)) for one in segments]
        except (RuntimeError, ValueError, OSError) as error:
            raise SpeechError(
                f"{self.name} failed: {str(error)[:200]}", "check SIMS_ASR_FOLDER", at="speech"
            ) from error
        return [cue for start, end, text in found for cue in heard(piece, start, end, text)]

    @cached_property
    def _model(self) -> Any:
        from faster_whisper import WhisperModel

        return WhisperModel(str(self.folder), local_files_only=True)


def load_transcriber(settings: Settings) -> Transcriber | None:
    """The transcriber that settings name, a folder before a server; None where they name none. SettingsError."""
    if settings.asr_folder is not None:
        if not (settings.asr_folder / "model.bin").is_file():
            raise SettingsError(
                "there is no model.bin in it", "give the folder of a faster-whisper model", at="SIMS_ASR_FOLDER"
            )
        if find_spec("faster_whisper") is None:
            raise SettingsError(f"it needs a library that is not installed: {INSTALL}", at="SIMS_ASR_FOLDER")
        return LocalTranscriber(settings.asr_folder)
    if not settings.asr_model and not settings.asr_base_url:
        return None
    from planner_service.extraction.transcription_server import served_transcriber

    return served_transcriber(settings)
