"""An extraction made piece by piece, every result stored before the next piece begins: no scene is asked about twice.

A film is listened to (its subtitles, or what is heard in it), cut into scenes, and each scene is read; then its scripts
are gathered, and kept in the library where that was asked for.

An extraction that is under way: what was stored of it, as the worker has it who goes on with it.

The scripts of an extraction put into the library together with what is stored of it: both happen, or neither.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

from pydantic import TypeAdapter
from sqlalchemy import Connection
from sqlalchemy.exc import InterfaceError, OperationalError

from planner_service.extraction.extract import words_in
from planner_service.extraction.extraction_result import (
    Before,
    Extraction,
    Means,
    PieceRead,
    Source,
    joined,
    readers,
    told_once,
)
from planner_service.extraction.from_film import notes_of, read_film_scene, words_of
from planner_service.extraction.from_text import read_piece
from planner_service.extraction.llm_text import pieces_of
from planner_service.extraction.script_writer import Maker
from planner_service.extraction.shot_detection import Scene, scenes_of
from planner_service.extraction.speech_to_text import Transcriber
from planner_service.extraction.subtitles import Subtitles
from planner_service.extraction.text_files import ExtractionError
from planner_service.extraction.text_scenes import TextScene, scenes_of_cues
from planner_service.extraction.video import Film, open_film
from planner_service.extraction.video_frames import Album
from planner_service.extraction.vision_model import Audience
from planner_service.jobs.uploads import Uploads
from planner_service.library.library import RESERVED, Shelves, TakenError
from planner_service.llm.protocol import LanguageModel
from planner_service.scripts.script import ShortScript
from planner_service.scripts.script import Source as ScriptSource
from planner_service.scripts.script_duplicates import slug_of
from planner_service.store.extraction_store import ExtractionRequest, extraction_request
from planner_service.store.story_store import Made, Stories
from scene_graphs.json_fields import Json

_TRIES: Final = 5
"""How often ids that somebody else took meanwhile are chosen anew."""


@dataclass(frozen=True)
class Gathered:
    """What of an extraction is kept in the library."""

    added: tuple[str, ...] = ()
    """Ids."""
    renamed: Mapping[str, str] = field(default_factory=dict)
    """Ids that somebody else took since the script was made, to those it has now."""


def keep_all(
    shelves: Shelves,
    scripts: Sequence[ShortScript],
    name: str,
    store: Callable[[Gathered, Callable[[Connection], None]], None],
) -> None:
    """Let `store` store what was gathered, in a transaction in which it calls what adds the scripts, all or none.

    A script whose id is taken by then gets another one. ShelfError, LibraryError.
    """
    for attempt in range(_TRIES):
        named, gathered = _named(shelves, scripts, name)

        def add(connection: Connection, named: Sequence[ShortScript] = named) -> None:
            if named:
                shelves.add_scripts(*named, within=connection)

        try:
            store(gathered, add)
        except TakenError:
            if attempt + 1 == _TRIES:
                raise
        else:
            return


def _named(shelves: Shelves, scripts: Sequence[ShortScript], name: str) -> tuple[list[ShortScript], Gathered]:
    """The scripts under ids that are free now."""
    taken = {script.id for script in shelves.scripts().scripts} | RESERVED
    named: list[ShortScript] = []
    for script in scripts:
        chosen = slug_of(script.summary, name, taken) if script.id in taken else script.id
        taken.add(chosen)
        named.append(script.model_copy(update={"id": chosen}))
    ids = tuple(script.id for script in named)
    changed = {before.id: after for before, after in zip(scripts, ids, strict=True) if before.id != after}
    return named, Gathered(ids, changed)


STAGES: Final = ("listen", "cut", "read", "gather")
WORDS, SCENES, FIRST_PIECE = range(3)
"""Positions of what the stages make; what was gathered follows the last piece."""
DONE: Final = {"listen": 0.1, "cut": 0.3, "read": 0.98, "gather": 1.0}
"""Share of the whole that is done after a stage."""
SUBTITLES: Final = TypeAdapter[Subtitles | None](Subtitles | None)
READ: Final = TypeAdapter[PieceRead](PieceRead)


@dataclass(frozen=True)
class Pieces:
    """What is read one after the other; a film that is watched has scenes, everything else has words."""

    kind: ScriptSource
    """How the scripts come to be: those of a text have no times."""
    scenes: tuple[Scene, ...] = ()
    words: tuple[dict[int, TextScene], ...] = ()

    def __len__(self) -> int:
        return len(self.scenes) + len(self.words)

    @property
    def scene_count(self) -> int:
        """Scenes in all of them."""
        return len(self.scenes) + sum(map(len, self.words))


PIECES: Final = TypeAdapter[Pieces](Pieces)


@dataclass
class OpenExtraction:
    """One that a worker has before it, read from the store as far as it was made before."""

    id: str
    request: ExtractionRequest
    source: Source
    means: Means
    store: Stories
    album: Album | None = None
    """Its frames, where this very worker cut it."""
    audience: Audience | None = None
    """The model that watches its scenes, some of them at once."""
    read: list[PieceRead] = field(default_factory=list)
    """The pieces that are known to be stored, in order."""
    fresh: tuple[int, PieceRead] | None = None
    """A piece that was read and is not stored yet: a database that is away costs no question."""

    @cached_property
    def film(self) -> Film:
        """The film. FilmError."""
        return open_film(self.source.file, self.source.name)

    @cached_property
    def maker(self) -> Maker:
        """What names the scripts, unlike all those before."""
        maker = Maker(self.request.name, self.means.library, self.pieces.kind, self.request.licence)
        maker.reserve(self.means.taken)
        return maker

    @cached_property
    def words(self) -> Subtitles | None:
        """What is said in a film."""
        return SUBTITLES.validate_json(self.store.data(self.id, WORDS))

    @cached_property
    def pieces(self) -> Pieces:
        """What is to be read."""
        return PIECES.validate_json(self.store.data(self.id, SCENES))

    def done(self, count: int) -> list[PieceRead]:
        """The first so many pieces, which were read; from the store where this worker did not read them all."""
        if len(self.read) < count:
            made = [one for one in self.store.get(self.id).artifacts if one.kind == "piece"]
            self.read = [READ.validate_python(one.summary) for one in made]
            self.maker.reserve(draft.script.id for piece in self.read for draft in piece.drafts)
        return self.read[:count]

    def close(self) -> None:
        """Let go of the frames, and of what is still asked about them."""
        if self.audience is not None:
            self.audience.close()
        if self.album is not None:
            self.album.close()


def gathered_to_dict(gathered: Gathered, by: str) -> Json:
    """What clients see of what was gathered."""
    return {"by": by, "added": list(gathered.added), "renamed": dict(gathered.renamed)}


def made_at_once(made: Extraction, gathered: Gathered) -> list[Made]:
    """What is stored of an extraction that needed no worker: the same as of any other, in one piece."""
    read = PieceRead(made.scripts, made.scenes, (), Before(len(made.scenes)))
    scenes = {"scene_count": len(made.scenes), "notes": made.notes}
    return [
        Made("scenes", SCENES, b"{}", scenes, "read", DONE["cut"], 0.0),
        Made("piece", FIRST_PIECE, b"{}", READ.dump_python(read, mode="json"), "gather", DONE["read"], 0.0),
        Made("gathered", FIRST_PIECE + 1, b"{}", gathered_to_dict(gathered, made.by), None, DONE["gather"], 0.0),
    ]


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
                f"{one.request.name}: was begun by a language model, and none is set now",
                "set SIMS_LLM_MODEL, or send the film again",
            )
        if one.audience is None:
            one.audience = Audience(self.model, one.film, one.pieces.scenes, one.album)
        return read_film_scene(one.audience, index, one.maker, one.means, before)

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
                    f"{request.name}: what was sent is not on this machine (worker {self.worker})",
                    "SIMS_DATA_DIR must be one folder that the service and all its workers share",
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
