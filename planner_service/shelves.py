"""The short scripts and rooms there are: ours, shipped with the package, and the users', in the database."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path

from sqlalchemy import Engine

from planner_service.scripts.library import ScriptLibrary
from scene_graphs.layouts import LayoutError, read_layouts
from scene_graphs.library import built_in_layouts
from scene_graphs.retrieval import LayoutIndex


class Shelves:
    """Scripts and rooms, loaded on first use and read again when somebody has changed them."""

    def __init__(
        self, engine: Engine | None = None, cache: Path | None = None, layouts_file: Path | None = None
    ) -> None:
        self.engine = engine
        self.cache = cache
        self.layouts_file = layouts_file

    def scripts(self) -> ScriptLibrary:
        """The short scripts as they are now."""
        return self._scripts

    def layouts(self) -> LayoutIndex:
        """The rooms as they are now, ready to be searched."""
        return self._layouts

    @cached_property
    def _scripts(self) -> ScriptLibrary:
        return ScriptLibrary.read(cache=self.cache)

    @cached_property
    def _layouts(self) -> LayoutIndex:
        extra = tuple(read_layouts(self.layouts_file)) if self.layouts_file else ()
        taken = {layout.id for layout in built_in_layouts()}
        for layout in extra:
            if layout.id in taken:
                raise LayoutError(f"{self.layouts_file}: {layout.id!r} is the id of a built-in room; choose another id")
        return LayoutIndex((*built_in_layouts(), *extra))
