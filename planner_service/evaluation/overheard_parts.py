"""The procedural body, and every part that it was asked for: what others are to do instead of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from motion_backend.backend_protocol import BodyState, Part
from motion_backend.motion import Motion
from motion_backend.procedural.backend import ProceduralBackend
from scene_graphs.home import Home


@dataclass(frozen=True)
class Step:
    """One part, where it began and what the procedural body did."""

    part: Part
    state: BodyState
    motion: Motion


class Overheard(ProceduralBackend):
    """The procedural body, and what it was asked for."""

    def __init__(self) -> None:
        self.steps: list[Step] = []

    def advance(self, home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> tuple[Motion, BodyState]:
        """Do a part and keep it."""
        motion, after = super().advance(home, part, upcoming, state)
        if len(motion):
            self.steps.append(Step(part, state, motion))
        return motion, after
