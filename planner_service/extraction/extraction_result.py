"""What is extracted from, with what, and what comes of it.

What comes of one piece of a film or text, which is read by itself: a scene of a film, or a few scenes of words.

Short scripts that one source gives more than once: the first is kept and stands for the others.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from motion_backend.language.sentence_encoder import SentenceEncoder
from planner_service.extraction.script_writer import RULES, Draft, Span
from planner_service.extraction.shot_detection import Progress
from planner_service.extraction.text_rules import SceneRead
from planner_service.llm.protocol import LanguageModel
from planner_service.scripts.script import ShortScript
from planner_service.scripts.script_duplicates import MIN_DUPLICATE_COSINE, doings_of
from planner_service.scripts.script_library import UNKNOWN, ScriptLibrary

if TYPE_CHECKING:
    from planner_service.extraction.speech_to_text import Transcriber


@dataclass(frozen=True)
class Source:
    """What is extracted from."""

    name: str
    """Its title, for people: never a path."""
    file: Path | BinaryIO
    subtitles: Path | BinaryIO | None = None
    """Of a film, beside it."""
    licence: str = UNKNOWN


@dataclass(frozen=True)
class SceneReport:
    """What came of one scene."""

    number: int
    start: float | None
    """Seconds, of a film or subtitles."""
    end: float | None
    room: str
    scripts: tuple[str, ...]
    """Ids."""
    unused: tuple[str, ...]
    """What was told and is not shown, each with the reason."""
    reason: str
    """Why there is no script; empty where there is one."""
    by: str


@dataclass(frozen=True)
class Extraction:
    """What came of a source; none of it is kept yet."""

    scripts: tuple[Draft, ...]
    scenes: tuple[SceneReport, ...]
    notes: tuple[str, ...]
    by: str
    """"rules", "llm:<model>", or both."""


@dataclass(frozen=True)
class Means:
    """With what is extracted."""

    library: ScriptLibrary
    model: LanguageModel | None = None
    transcriber: Transcriber | None = None
    """What hears the speech of a film that has no subtitles."""
    strict: bool = False
    """Whether an unusable model is an error; otherwise the rules do it."""
    taken: Collection[str] = ()
    """Ids that may not be used, besides the library's."""
    progress: Progress | None = None


def report_of(number: int, span: Span, read: SceneRead, by: str) -> SceneReport:
    """The report of a scene, counted from 1, that was read by rules or a model."""
    ids = tuple(draft.script.id for draft in read.drafts)
    return SceneReport(number, *span, read.room, ids, read.unused, read.reason, by)


def readers(reports: Sequence[SceneReport]) -> str:
    """Everybody who read a scene, in order."""
    return ", ".join(dict.fromkeys(report.by for report in reports)) or RULES


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


@dataclass(frozen=True)
class ToldOnce:
    """What came of a source, each script once."""

    read: PieceRead
    """Where a script was told again, its scene names the first one. A note says how many there were."""
    repeats: Mapping[str, str]
    """Ids of those that are left out, to the one that stands for each."""
    notes: tuple[str, ...]
    """What `read` notes of it, alone."""


def told_once(whole: PieceRead, encoder: SentenceEncoder) -> ToldOnce:
    """Of the scripts with the same keyframes and feelings and nearly the same summary only the first."""
    repeats = _repeats([draft.script for draft in whole.drafts], encoder)
    count = len(repeats)
    notes = (f"{count} script{'s' * (count != 1)} said the same again",) if repeats else ()
    drafts: tuple[Draft, ...] = tuple(draft for draft in whole.drafts if draft.script.id not in repeats)
    scenes = tuple(replace(scene, scripts=stood_for(scene.scripts, repeats)) for scene in whole.scenes)
    return ToldOnce(PieceRead(drafts, scenes, (*whole.notes, *notes), whole.after), repeats, notes)


def stood_for(ids: Sequence[str], repeats: Mapping[str, str]) -> tuple[str, ...]:
    """Ids of scripts, each repeat by the one that stands for it, each once."""
    return tuple(dict.fromkeys(repeats.get(one, one) for one in ids))


def _repeats(scripts: Sequence[ShortScript], encoder: SentenceEncoder) -> dict[str, str]:
    alike: dict[Hashable, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for script in scripts:
        feelings = (script.emotion, *(keyframe.emotion for keyframe in script.keyframes))
        alike[doings_of(script), feelings][script.summary].append(script.id)
    found: dict[str, str] = {}
    for ids_of in alike.values():
        summaries = list(ids_of)
        near = [[True]]
        if len(summaries) > 1:
            vectors = encoder.encode(summaries)
            near = ((vectors @ vectors.T).round(4) >= MIN_DUPLICATE_COSINE).tolist()
        kept: list[int] = []
        for index, summary in enumerate(summaries):
            first = next((one for one in kept if near[index][one]), index)
            if first == index:
                kept.append(index)
            stands = ids_of[summaries[first]][0]
            found |= {one: stands for one in ids_of[summary] if one != stands}
    return found
