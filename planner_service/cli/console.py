"""What the command line prints: errors as one line, tables without lines.

Tables as commands print them: no lines, bold headings, figures on the right; and cells from files of others.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager

from rich.table import Table

from motion_backend.language.minilm import WeightsError
from motion_backend.mocap.clip import ClipError
from planner_service.extraction.subtitles import SubtitleError
from planner_service.extraction.text_files import ExtractionError
from planner_service.extraction.transcription import SpeechError
from planner_service.extraction.video_container import FilmError
from planner_service.grounding.furnish import FurnishError
from planner_service.grounding.keyframes_to_actions import UnreachableError
from planner_service.library.library import ShelfError
from planner_service.llm.protocol import ModelError
from planner_service.output.story_files import OutputError
from planner_service.pipeline import RequestError
from planner_service.scripts.script_library import LibraryError
from planner_service.settings import SettingsError
from planner_service.tasks.task_plan import TaskError
from planner_service.themes.beats import ThemeError
from scene_graphs.home import HomeError
from scene_graphs.layout import LayoutError
from scene_graphs.navigation.path_planner import NoPath
from scene_graphs.retrieval.layout_index import NoSuitableRoom

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


def shown(text: str, most: int = 100) -> str:
    """What a file says, as a terminal may show it: one line of printable letters, cut after `most`."""
    line = " ".join(text[: 4 * most].split())
    safe = "".join(letter if letter.isprintable() else letter.encode("unicode_escape").decode() for letter in line)
    return safe if len(safe) <= most else safe[: most - 1] + "…"


def plain_table(*columns: str, right: Collection[str] = (), fold: bool = False) -> Table:
    """An empty table with these columns; to `fold` breaks long words instead of cutting them."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for column in columns:
        table.add_column(
            column, justify="right" if column in right else "left", overflow="fold" if fold else "ellipsis"
        )
    return table
