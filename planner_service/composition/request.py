"""What may be asked of a long script besides its theme, and the record of who planned which part of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final, Literal, get_args

from planner_service.llm.protocol import ModelError
from scene_graphs.furniture import ROOM_TYPES, canonical_room

Method = Literal["auto", "matching", "direct"]
METHODS: Final[tuple[Method, ...]] = get_args(Method)
MAX_SHORT_SCRIPTS: Final = 12
"""Short scripts in a long one."""
RULES: Final = "rules"
"""The planner where no language model planned."""


@dataclass(frozen=True)
class Request:
    """What may be asked of a long script besides its theme."""

    short_scripts: int | None = None
    """How many, 1 to 12; None: one an event, and at least two."""
    rooms: tuple[str, ...] = ()
    """Room types to stay in; empty for all."""
    seed: int = 0
    method: Method = "auto"
    furniture: frozenset[str] | None = None
    """Categories that a given home has; None: any."""

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise ValueError(f"method: {self.method!r} is none of {', '.join(METHODS)}")
        if self.short_scripts is not None and not 1 <= self.short_scripts <= MAX_SHORT_SCRIPTS:
            raise ValueError(f"short_scripts: {self.short_scripts} is not a number from 1 to {MAX_SHORT_SCRIPTS}")
        for room in self.rooms:
            if canonical_room(room) not in ROOM_TYPES:
                raise ValueError(f"rooms: {room!r} is none of {', '.join(ROOM_TYPES)}")


@dataclass
class Record:
    """Who planned which part, and what went wrong on the way."""

    planners: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    """Why rules planned what a model was asked for."""
    insist: bool = False
    """Whether a model that fails is an error."""

    @property
    def planner(self) -> str:
        """Each planner once, in the order they had a part: "llm:claude, rules"."""
        return ", ".join(dict.fromkeys(self.planners))

    def failed(self, doing: str, error: ModelError) -> None:
        """Note that rules do it; the error itself where a model is insisted on."""
        if self.insist:
            raise error
        self.notes.append(f"{doing} by rules: {error}")
