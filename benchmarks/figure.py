"""One line of the table: a figure that was measured, and the limit it must keep."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Figure:
    """What was measured; `bound` says whether the limit is the most or the least it may be."""

    name: str
    measured: float
    unit: str = ""
    limit: float | None = None
    bound: Literal["most", "least"] = "most"
    note: str = ""
    digits: int = 1

    @property
    def missed(self) -> bool:
        """Whether there is a limit and it is not kept."""
        if self.limit is None:
            return False
        return self.measured > self.limit if self.bound == "most" else self.measured < self.limit

    @property
    def verdict(self) -> str:
        """ok, MISS, or nothing where there is no limit."""
        return "" if self.limit is None else "MISS" if self.missed else "ok"

    @property
    def shown_limit(self) -> str:
        """The limit with its sign."""
        if self.limit is None:
            return "–"
        return f"{'≤' if self.bound == 'most' else '≥'} {self.limit:g} {self.unit}".strip()

    @property
    def shown(self) -> str:
        """The measured value with its unit."""
        return f"{self.measured:.{self.digits}f} {self.unit}".strip()
