"""The report of a scene file that was read: what was kept, dropped and guessed, and why."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass, field
from typing import Any, Final

EXAMPLES: Final = 3
"""Things that are named for one reason."""


@dataclass
class Report:
    """What was kept, dropped and why; `lines` for a person, `to_dict` for a program."""

    rooms: int = 0
    kept: Counter[str] = field(default_factory=Counter)
    """Objects by category."""
    dropped: Counter[str] = field(default_factory=Counter)
    """Things by the reason they were dropped for."""
    examples: dict[str, list[str]] = field(default_factory=lambda: defaultdict(list))
    """For every reason the first few things."""
    guessed: Counter[str] = field(default_factory=Counter)
    """How often a size, front or floor that the file does not give was estimated."""

    def drop(self, why: str, what: str = "") -> None:
        """Count something that is left out; `what` names it."""
        self.dropped[why] += 1
        examples, shown = self.examples[why], printable(what)
        if shown and len(examples) < EXAMPLES and shown not in examples:
            examples.append(shown)

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "rooms": self.rooms,
            "objects": dict(sorted(self.kept.items())),
            "dropped": [
                {"why": why, "count": count, "examples": self.examples[why]} for why, count in _ranked(self.dropped)
            ],
            "estimated": dict(sorted(self.guessed.items())),
        }

    def lines(self) -> list[str]:
        """A few sentences."""
        kinds = ", ".join(f"{count} {category}" for category, count in _ranked(self.kept))
        rooms = "1 room" if self.rooms == 1 else f"{self.rooms} rooms"
        lines = [f"kept {rooms} with {self.kept.total()} objects" + (f": {kinds}" if kinds else "")]
        for why, count in _ranked(self.dropped):
            examples = self.examples[why]
            lines.append(f"dropped {count}: {why}" + (f" ({', '.join(examples)})" if examples else ""))
        lines += [f"estimated {count}: {what}" for what, count in _ranked(self.guessed)]
        return lines


def printable(text: str) -> str:
    """A name of somebody else's, short and on one line."""
    return "".join(letter if letter.isprintable() else " " for letter in text[:160]).strip()


def _ranked(counts: Counter[str]) -> list[tuple[str, int]]:
    return sorted(counts.items(), key=lambda item: (-item[1], item[0]))
