"""What the reader of a scene file cannot see in it, and how much it may read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from scene_graphs.loaders.source import Source

MAX_ROOMS: Final = 1_000
"""Rooms of one file, those that turn out to be none among them."""


@dataclass(frozen=True)
class Options:
    """What a reader cannot see in the file."""

    assets: Source | None = None
    """Sizes of models by their ids: ProcTHOR's asset boxes, 3D-FUTURE's model_info.json."""
    scan: str | None = None
    """The one scan or house to read of a file that holds many."""
    room_type: str | None = None
    """The room type of a file that does not say."""
    up: str = "y"
    """glb, obj: the axis that points up, y or z."""
    front: str = "+z"
    """glb, obj: where the front of every piece points in its own frame: +z, -z, +x or -x (after `up`)."""
    unit: float = 1.0
    """glb, obj: metres a unit."""
    most_rooms: int = MAX_ROOMS
    """A file of more is refused."""
