"""A film, subtitles or a text to short scripts, told apart by what the file holds (SIMS 3.2)."""

from __future__ import annotations

from typing import Final

from planner_service.extraction.containers import checked_container, container_of
from planner_service.extraction.making import Maker
from planner_service.extraction.of_text import refuse_other_languages, scenes_read
from planner_service.extraction.plain import MOST_BYTES, first_bytes, read_text
from planner_service.extraction.results import Extraction, Means, Source
from planner_service.extraction.subtitles import LARGEST, form_of, read_subtitles
from planner_service.extraction.text import scenes_of_cues, scenes_of_text

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


def extract(source: Source, means: Means) -> Extraction:
    """The short scripts in a source. ExtractionError, SubtitleError or FilmError says why it cannot be read.

    Raises ModelError where the model fails and the means are strict.
    """
    head = first_bytes(source.file, source.name, _HEAD)
    if container_of(head) is not None:
        from planner_service.extraction.of_film import extract_film

        return extract_film(source, means)
    if head.lstrip(b"\xef\xbb\xbf \t\r\n").lower().startswith(_NAMING_OTHERS):
        checked_container(head)
    data = first_bytes(source.file, source.name, LARGEST + 1)
    if form_of(head.decode("utf-8", "ignore").replace("\0", "")) is not None:
        return _of_subtitles(source, data, means)
    text, notes = read_text(data[: MOST_BYTES + 1], source.name)
    if form_of(text) is not None:
        return _of_subtitles(source, data, means)
    if means.model is None:
        refuse_other_languages(text, source.name)
    return scenes_read(scenes_of_text(text), notes, Maker(source.name, means.library, "text", source.licence), means)


def _of_subtitles(source: Source, data: bytes, means: Means) -> Extraction:
    read = read_subtitles(data)
    scenes = scenes_of_cues(read.cues)
    if means.model is None:
        refuse_other_languages(" ".join(cue.text for cue in read.cues[:2000]), source.name)
    maker = Maker(source.name, means.library, "video", source.licence)
    return scenes_read(scenes, tuple(f"{source.name}: {note}" for note in read.notes), maker, means)
