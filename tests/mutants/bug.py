"""One bug: a text of a module in the place of another."""

from __future__ import annotations

import difflib
from dataclasses import dataclass


@dataclass(frozen=True)
class Bug:
    """What is changed where; `start` and `stop` are places in the module's text."""

    path: str
    """Of the module, from the root of the tree: "motion_backend/skeleton.py"."""
    start: int
    stop: int
    wrong: str
    """What stands there instead."""
    first: int
    """First line, counted from 1, whose running shows the bug."""
    last: int
    """Last such line."""
    kind: str
    """What sort of change it is, or a person's words for the bug."""
    names: tuple[str, ...] = ()
    """Outside all functions: the names that the line gives a value; who reads them shows the bug."""

    def put_into(self, text: str) -> str:
        """The module's text with the bug in it."""
        return text[: self.start] + self.wrong + text[self.stop :]

    def difference(self, text: str) -> str:
        """The lines that change, before with - and after with +."""
        lines = difflib.ndiff(text.splitlines(), self.put_into(text).splitlines())
        return "\n".join(f"    {line[0]} {line[2:].strip()}" for line in lines if line[0] in "+-")
