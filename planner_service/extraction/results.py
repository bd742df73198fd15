"""What is extracted from, with what, and what comes of it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from planner_service.extraction.making import RULES, Draft, Span
from planner_service.extraction.reading import SceneRead
from planner_service.extraction.shots import Progress
from planner_service.llm.protocol import LanguageModel
from planner_service.scripts.library import ScriptLibrary
from planner_service.scripts.picking import UNKNOWN

if TYPE_CHECKING:
    from planner_service.extraction.speech import Transcriber


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
