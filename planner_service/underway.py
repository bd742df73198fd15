"""An extraction that is under way: what was stored of it, as the worker has it who goes on with it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final

from pydantic import TypeAdapter

from planner_service.extraction.album import Album
from planner_service.extraction.film import Film, open_film
from planner_service.extraction.grouping import Scene
from planner_service.extraction.making import Maker
from planner_service.extraction.pieces import Before, PieceRead
from planner_service.extraction.results import Extraction, Means, Source
from planner_service.extraction.subtitles import Subtitles
from planner_service.extraction.text import TextScene
from planner_service.gathering import Gathered
from planner_service.scripts import keyframe
from planner_service.store.extractions import ExtractionRequest
from planner_service.store.stories import Made, Stories

Json = dict[str, Any]
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

    kind: keyframe.Source
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
        """Let go of the frames."""
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
