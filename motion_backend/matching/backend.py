"""The backend `matching`: walks put together from the clips that its user gives, on the ways of the shared driver."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np

from motion_backend.backend_protocol import BodyState, Part, PartKind
from motion_backend.backends import MATCHING, given_file
from motion_backend.matching.frame_matcher import FrameMatcher
from motion_backend.matching.walk_database import WalkDatabase, build_walk_database
from motion_backend.mocap.clip import ClipError
from motion_backend.mocap.dataset_file import read_dataset
from motion_backend.motion import Character, Motion
from motion_backend.walk_driver import WalkDriver
from motion_backend.walk_generator import Frames, Walker
from scene_graphs.home import Home


class Matching:
    """The generator."""

    name = MATCHING
    slowest = 0.5
    pace: float | None = None

    def __init__(self, database: WalkDatabase) -> None:
        self.database = database

    def begin(self, past: Frames, rng: np.random.Generator) -> Walker:
        """Go on from a body's last frames; nothing in it is random."""
        del rng
        return FrameMatcher(self.database, past)


class MatchingBackend:
    """Walks from recorded frames; all else is left to the backend behind it."""

    name = Matching.name
    parts = frozenset({PartKind.WALK})

    def __init__(self, database: WalkDatabase) -> None:
        self._driver = WalkDriver(Matching(database))

    def begin(self, home: Home, character: Character, seed: int) -> BodyState:
        """Standing in the first room, on a free place that the seed chooses."""
        return self._driver.begin(home, character, seed)

    def advance(self, home: Home, part: Part, upcoming: Sequence[Part], state: BodyState) -> tuple[Motion, BodyState]:
        """Walk to where a part asks for."""
        return self._driver.advance(home, part, upcoming, state)


@lru_cache(maxsize=2)
def _database(file: Path, changed: int) -> WalkDatabase:
    del changed  # a part of the key: a file that was written anew is read again
    return build_walk_database(read_dataset(file))


def of_given_clips() -> MatchingBackend:
    """The backend for the clips that a setting or an option names. ClipError where none does."""
    file = given_file(MATCHING)
    if file is None:
        raise ClipError("no clips are named", "give --clips FILE or SIMS_CLIPS, made by `sims clips build`")
    return matching_backend(file)


def matching_backend(file: Path) -> MatchingBackend:
    """The backend for a collection of clips. ClipError for a file that holds none, or too little walking."""
    if not file.is_file():
        raise ClipError(f"{file} is no file", "give --clips FILE or SIMS_CLIPS, made by `sims clips build`")
    return MatchingBackend(_database(file, file.stat().st_mtime_ns))
