"""What a user can do wrong, as one tuple of exceptions and one line of text; anything else is a fault of ours."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from motion_backend.clips.clip import ClipError
from motion_backend.language.minilm import WeightsError
from planner_service.extraction.containers import FilmError
from planner_service.extraction.plain import ExtractionError
from planner_service.extraction.speech import SpeechError
from planner_service.extraction.subtitles import SubtitleError
from planner_service.filing import OutputError
from planner_service.furnish import FurnishError
from planner_service.llm.protocol import ModelError
from planner_service.scripts.acting import UnreachableError
from planner_service.scripts.events import ThemeError
from planner_service.scripts.library import LibraryError
from planner_service.settings import SettingsError
from planner_service.shelves import ShelfError
from planner_service.stories import RequestError
from planner_service.tasks.plan import TaskError
from scene_graphs.homes import HomeError
from scene_graphs.layouts import LayoutError
from scene_graphs.navigation import NoPath
from scene_graphs.retrieval import NoSuitableRoom

USER_ERRORS = (
    RequestError,
    ThemeError,
    FurnishError,
    NoSuitableRoom,
    HomeError,
    LayoutError,
    NoPath,
    UnreachableError,
    LibraryError,
    ShelfError,
    ModelError,
    OutputError,
    SettingsError,
    WeightsError,
    TaskError,
    ExtractionError,
    SubtitleError,
    FilmError,
    SpeechError,
    ClipError,
)


@contextmanager
def writing_database() -> Iterator[None]:
    """Turns what a database refuses (no space left, locked for long) into a SettingsError."""
    from sqlalchemy.exc import SQLAlchemyError

    try:
        yield
    except SQLAlchemyError as error:
        reason = str(getattr(error, "orig", error)).splitlines()[0]
        raise SettingsError(f"the database cannot be written: {reason}; see SIMS_DATA_DIR") from error


def explain(error: BaseException) -> str:
    """One line naming what was wrong and what would be right, safe to show on a terminal."""
    line = " ".join(str(error).split())
    return "".join(letter if letter.isprintable() else letter.encode("unicode_escape").decode() for letter in line)
