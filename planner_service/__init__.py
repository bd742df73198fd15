"""Scripts, stories, language models and the command line. May import every other package.

What a program needs that makes stories stands here by name; everything is loaded when it is first asked for.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from planner_service.library.library import Shelves
    from planner_service.output.story_export import write_story
    from planner_service.pipeline import Pipeline, Planned, Story, StoryRequest
    from planner_service.scripts.script import Keyframe, LongScript, ShortScript
    from planner_service.scripts.script_library import ScriptLibrary

__all__ = [
    "Keyframe",
    "LongScript",
    "Pipeline",
    "Planned",
    "ScriptLibrary",
    "Shelves",
    "ShortScript",
    "Story",
    "StoryRequest",
    "write_story",
]
_ROOMS = {
    "Keyframe": "scripts.script",
    "LongScript": "scripts.script",
    "Pipeline": "pipeline",
    "Planned": "pipeline",
    "ScriptLibrary": "scripts.script_library",
    "Shelves": "library.library",
    "ShortScript": "scripts.script",
    "Story": "pipeline",
    "StoryRequest": "pipeline",
    "write_story": "output.story_export",
}
"""Where each of them is defined, below this package."""


def __getattr__(name: str) -> object:
    """One of `__all__`, loaded with the module that defines it."""
    if name not in _ROOMS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_ROOMS[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
