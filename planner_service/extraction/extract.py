"""A film, subtitles or a text to short scripts, told apart by what the file holds (SIMS 3.2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from planner_service.extraction.extraction_result import Extraction, Means, Source
from planner_service.extraction.from_text import refuse_other_languages, scenes_read
from planner_service.extraction.llm_text import portions_of
from planner_service.extraction.script_writer import Maker
from planner_service.extraction.subtitles import MAX_SUBTITLE_BYTES, form_of, read_subtitles
from planner_service.extraction.text_files import MAX_BYTES, first_bytes, read_text
from planner_service.extraction.text_scenes import TextScene, scenes_of_cues, scenes_of_text
from planner_service.extraction.video_container import checked_container, container_of, names_pictures

_HEAD: Final = 4096
_NAMING_OTHERS: Final = (
    b"#extm3u",
    b"ffconcat",
    b"[playlist]",
    b"[reference]",
    b"<?xml",
    b"<svg",
    b"<mpd",
    b"<asx",
    b"v=0\n",
    b"v=0\r",
)
"""How files begin that are letters and stand for films elsewhere."""


@dataclass(frozen=True)
class Words:
    """A text or subtitles, in scenes."""

    scenes: tuple[TextScene, ...]
    notes: tuple[str, ...]
    kind: Literal["text", "video"]
    """Video for subtitles, whose scenes have times."""


def extract(source: Source, means: Means) -> Extraction:
    """The short scripts in a source. ExtractionError, SubtitleError or FilmError says why it cannot be read.

    Raises ModelError where the model fails and the means are strict.
    """
    if is_film(source):
        from planner_service.extraction.from_film import extract_film

        return extract_film(source, means)
    words = words_in(source, means)
    return scenes_read(words.scenes, words.notes, Maker(source.name, means.library, words.kind, source.licence), means)


def is_film(source: Source) -> bool:
    """Whether it begins as a film does. FilmError for what stands for films elsewhere, such as playlists."""
    head = first_bytes(source.file, source.name, _HEAD)
    if container_of(head) is not None:
        return True
    if names_pictures(head) or head.lstrip(b"\xef\xbb\xbf \t\r\n").lower().startswith(_NAMING_OTHERS):
        checked_container(head)
    return False


def words_in(source: Source, means: Means) -> Words:
    """The scenes of what is no film, for a model in portions that a question holds. ExtractionError, SubtitleError."""
    words = _words_in(source, means)
    if means.model is None:
        return words
    scenes, notes = portions_of(words.scenes)
    return Words(scenes, (*words.notes, *notes), words.kind)


def _words_in(source: Source, means: Means) -> Words:
    data = first_bytes(source.file, source.name, MAX_SUBTITLE_BYTES + 1)
    if form_of(data[:_HEAD].decode("utf-8", "ignore").replace("\0", "")) is not None:
        return _of_subtitles(source, data, means)
    text, notes = read_text(data[: MAX_BYTES + 1], source.name)
    if form_of(text) is not None:
        return _of_subtitles(source, data, means)
    if means.model is None:
        refuse_other_languages(text, source.name)
    return Words(scenes_of_text(text), notes, "text")


def _of_subtitles(source: Source, data: bytes, means: Means) -> Words:
    read = read_subtitles(data)
    if means.model is None:
        refuse_other_languages(" ".join(cue.text for cue in read.cues[:2000]), source.name)
    return Words(scenes_of_cues(read.cues), tuple(f"{source.name}: {note}" for note in read.notes), "video")
