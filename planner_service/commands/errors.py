"""What a user can do wrong, as one tuple of exceptions and one line of text."""

from __future__ import annotations

from pydantic import ValidationError

from planner_service.filing import OutputError
from planner_service.furnish import FurnishError
from planner_service.llm.protocol import ModelError
from planner_service.scripts.acting import UnreachableError
from planner_service.scripts.library import LibraryError
from scene_graphs.layouts import LayoutError

USER_ERRORS = (
    OutputError,
    FurnishError,
    ModelError,
    UnreachableError,
    LibraryError,
    LayoutError,
    ValidationError,
    UnicodeError,
    ValueError,
    OSError,
)


def explain(error: BaseException) -> str:
    """One or a few lines naming what was wrong and, where it is known, what would be right."""
    if isinstance(error, ValidationError):
        return "; ".join(f"{'.'.join(str(part) for part in fault['loc'])}: {fault['msg']}" for fault in error.errors())
    if isinstance(error, OSError) and error.filename:
        return f"{error.filename}: {error.strerror}"
    return str(error)
