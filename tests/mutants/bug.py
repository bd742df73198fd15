"""One bug: a text of a module in the place of another."""

from __future__ import annotations

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
        begin, end = text.rfind("\n", 0, self.start) + 1, text.find("\n", self.stop)
        end = len(text) if end < 0 else end
        changed = text[begin : self.start] + self.wrong + text[self.stop : end]
        return "\n".join(
            f"    {sign} {line.strip()}"
            for sign, lines in (("-", text[begin:end]), ("+", changed))
            for line in lines.splitlines()
        )
