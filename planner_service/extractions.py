"""An extraction made piece by piece, every result stored before the next piece begins: no scene is asked about twice.

A film is listened to (its subtitles, or what is heard in it), cut into scenes, and each scene is read; then its scripts
are gathered, and kept in the library where that was asked for.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Final

from sqlalchemy import Connection
from sqlalchemy.exc import InterfaceError, OperationalError

from planner_service.extraction.album import Album
from planner_service.extraction.by_model import pieces_of
from planner_service.extraction.extracting import words_in
from planner_service.extraction.grouping import scenes_of
from planner_service.extraction.of_film import notes_of, read_film_scene, words_of
from planner_service.extraction.of_text import read_piece
from planner_service.extraction.pieces import Before, PieceRead, joined
from planner_service.extraction.plain import ExtractionError
from planner_service.extraction.repeats import told_once
from planner_service.extraction.results import Means, Source, readers
from planner_service.extraction.speech import Transcriber
from planner_service.extraction.text import scenes_of_cues
from planner_service.gathering import Gathered, keep_all
from planner_service.llm.protocol import LanguageModel
from planner_service.shelves import RESERVED, Shelves
from planner_service.store.extractions import extraction_request
from planner_service.store.stories import Made, Stories
from planner_service.underway import (
    DONE,
    FIRST_PIECE,
    PIECES,
    READ,
    SCENES,
    SUBTITLES,
    WORDS,
    OpenExtraction,
    Pieces,
    gathered_to_dict,
)
from planner_service.uploads import Uploads

Json = dict[str, Any]
_STEP: Final = 0.01
"""The least progress that is told."""


@dataclass
class Reader:
    """One worker's desk for extractions: what they are read with, and the one that lies open."""

    store: Stories
    shelves: Shelves
    uploads: Uploads
    worker: str
    model: LanguageModel | None = None
    transcriber: Transcriber | None = None
    strict: bool = False
    open: dict[str, OpenExtraction] = field(default_factory=dict)

    def begin(self, extraction_id: str) -> bool:
        """It leaves the queue; whether it is a film, which is to be listened to first."""
        film = extraction_request(self.store.engine, extraction_id).film
        self.store.begin(extraction_id, "listen" if film else "cut")
        return film

    def listen(self, extraction_id: str) -> None:
        """A film to what is said in it. FilmError, SubtitleError, SpeechError, ExtractionError."""
        if self.store.has(extraction_id, WORDS):
            return
        started, one = time.perf_counter(), self._opened(extraction_id)
        means = replace(one.means, progress=self._telling(extraction_id, 0.0, DONE["listen"]))
        words = words_of(one.film, one.source, means)
        summary = {"notes": notes_of(words, one.source, means)}
        self._record(one, "words", WORDS, SUBTITLES.dump_json(words), summary, "cut", DONE["listen"], started)

    def cut(self, extraction_id: str) -> int:
        """A film or text to its pieces; how many there are. FilmError, SubtitleError, ExtractionError."""
        one = self._opened(extraction_id)
        if not self.store.has(extraction_id, SCENES):
            started = time.perf_counter()
            pieces, notes = self._cut(one)
            summary = {"scene_count": pieces.scene_count, "notes": notes}
            following = "read" if len(pieces) else "gather"
            self._record(one, "scenes", SCENES, PIECES.dump_json(pieces), summary, following, DONE["cut"], started)
        return len(one.pieces)

    def _cut(self, one: OpenExtraction) -> tuple[Pieces, tuple[str, ...]]:
        if not one.request.film:
            words = words_in(one.source, one.means)
            return Pieces(words.kind, words=tuple(map(dict, pieces_of(words.scenes)))), words.notes
        cues = one.words.cues if one.words is not None else ()
        if self.model is None:
            return Pieces("video", words=tuple(map(dict, pieces_of(scenes_of_cues(cues))))), ()
        one.close()
        one.album = Album()
        progress = self._telling(one.id, DONE["listen"], DONE["cut"])
        scenes = scenes_of(one.film, cues, progress, one.album)
        return Pieces("video", scenes=tuple(replace(scene, shots=()) for scene in scenes)), one.film.notes

    def read(self, extraction_id: str, index: int) -> None:
        """One piece to short scripts. FilmError; ModelError where the means are strict."""
        position = FIRST_PIECE + index
        if self.store.has(extraction_id, position):
            return
        started, one = time.perf_counter(), self._opened(extraction_id)
        if one.fresh is None or one.fresh[0] != index:
            one.fresh = index, self._read(one, index)
        read = one.fresh[1]
        last = index + 1 == len(one.pieces)
        share = DONE["cut"] + (index + 1) / len(one.pieces) * (DONE["read"] - DONE["cut"])
        following = "gather" if last else None
        summary = READ.dump_python(read, mode="json")
        self._record(one, "piece", position, b"{}", summary, following, round(share, 4), started)
        one.read.append(read)

    def _read(self, one: OpenExtraction, index: int) -> PieceRead:
        before = one.done(index)[-1].after if index else Before()
        if one.pieces.words:
            return read_piece(one.pieces.words[index], one.maker, one.means, before)
        if self.model is None:
            raise ExtractionError(
                f"{one.request.name}: was begun by a language model, and none is set now; set SIMS_LLM_MODEL, "
                "or send the film again"
            )
        return read_film_scene(one.film, one.pieces.scenes[index], one.maker, one.means, before, one.album)

    def gather(self, extraction_id: str) -> None:
        """All scripts together, each once, kept in the library if asked for, all or none. ShelfError, LibraryError."""
        started, one = time.perf_counter(), self._opened(extraction_id)
        position = FIRST_PIECE + len(one.pieces)
        once = told_once(joined(one.done(len(one.pieces))), one.maker.encoder)
        scripts = [draft.script for draft in once.read.drafts]

        def store(gathered: Gathered, add: Callable[[Connection], None]) -> None:
            summary = gathered_to_dict(gathered, readers(once.read.scenes))
            summary |= {"repeats": dict(once.repeats), "notes": once.notes}
            self._record(one, "gathered", position, b"{}", summary, None, DONE["gather"], started, add)

        keep_all(self.shelves, scripts if one.request.add else [], one.request.name, store)

    def close(self, extraction_id: str) -> None:
        """It has ended, however: its files are thrown away."""
        if extraction_id in self.open:
            self.open.pop(extraction_id).close()
        self.uploads.forget(extraction_id)

    def _opened(self, extraction_id: str) -> OpenExtraction:
        if extraction_id not in self.open:
            request = extraction_request(self.store.engine, extraction_id)
            paths = [
                self.uploads.path(extraction_id, content) for content in (request.file, request.subtitles) if content
            ]
            if not all(path.is_file() for path in paths):
                raise ExtractionError(
                    f"{request.name}: what was sent is not on this machine (worker {self.worker}); "
                    "SIMS_DATA_DIR must be one folder that the service and all its workers share"
                )
            source = Source(request.name, paths[0], paths[1] if len(paths) > 1 else None, request.licence)
            means = Means(self.shelves.scripts(), self.model, self.transcriber, self.strict, RESERVED)
            for other in list(self.open):
                self.open.pop(other).close()
            self.open[extraction_id] = OpenExtraction(extraction_id, request, source, means, self.store)
        return self.open[extraction_id]

    def _record(
        self,
        one: OpenExtraction,
        kind: str,
        position: int,
        data: bytes,
        summary: Json,
        following: str | None,
        progress: float,
        started: float,
        also: Callable[[Connection], None] = lambda _connection: None,
    ) -> None:
        made = Made(kind, position, data, summary, following, progress, time.perf_counter() - started)
        self.store.record(one.id, made, self.worker, also)

    def _telling(self, extraction_id: str, low: float, high: float) -> Callable[[str, float], None]:
        """Tells what part of a long stage is done; StoryGone from it ends a stage that nobody wants any more."""
        told = low

        def tell(_stage: str, share: float) -> None:
            nonlocal told
            now = round(low + min(1.0, share) * (high - low), 4)
            if now - told >= _STEP:
                told = now
                try:
                    self.store.go_on(extraction_id, now)
                except (OperationalError, InterfaceError):
                    return  # it is only a word about the way; what is made will be stored when the database is back

        return tell
