"""What is drawn for one time of lying (own_way.py): data/transitions/lie_own.toml."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any, Final, cast

import numpy as np

from motion_backend.rotations import Array
from scene_graphs.data_tables import table

CHARACTER: Final = 0x11E
"""Sets what is drawn for a character apart from what else is drawn from its seed."""


@table
class RestingArms:
    """Where both arms lie, by the rows of resting hands; on a side the one below is given as left."""

    left: str
    right: str


@table
class LieOwn:
    """How people lie otherwise than one another."""

    spread: dict[str, float]
    """Standard deviations, by what is drawn."""
    usual_arms_share: float
    """How often a character's arms lie where they usually do."""
    back_arms: tuple[RestingArms, ...]
    side_arms: tuple[RestingArms, ...]


def _none() -> Array:
    return np.zeros(2)


@dataclass(frozen=True, eq=False)
class OwnWay:
    """What one time of lying has of its own; nothing by itself. Pairs are left and right, or below and above.

    No two are the same, whatever was drawn.
    """

    askew: float = 0.0
    """Of the body to the left, seen from above (radians)."""
    curve: float = 0.0
    twist: float = 0.0
    """Of the trunk on the back, to the left."""
    head_turn: float = 0.0
    head_tilt: float = 0.0
    ankle_aside: Array = field(default_factory=_none)
    """Outwards (metres at 1.70 m)."""
    ankle_along: Array = field(default_factory=_none)
    foot_out: Array = field(default_factory=_none)
    knee_out: Array = field(default_factory=_none)
    side_hip: float = 0.0
    """Degrees."""
    side_knee: float = 0.0
    hand_along: Array = field(default_factory=_none)
    hand_across: Array = field(default_factory=_none)
    elbow_up: Array = field(default_factory=_none)
    """Of an elbow's direction, towards the head."""


NOBODY: Final = OwnWay()
"""Who lies as the tables say."""


def drawn_arms(rows: Sequence[RestingArms], usual: float, seed: int, rng: np.random.Generator) -> RestingArms:
    """Where both arms lie this time: in so large a share of times where those of the character of that seed do."""
    always = int(np.random.default_rng([seed, CHARACTER, len(rows)]).integers(len(rows)))
    other = int(rng.integers(len(rows)))
    return rows[always if rng.random() < usual else other]


def timed(rows: Any, factor: Callable[[], float]) -> Any:
    """A table, or a row of one, with every time of it multiplied by what `factor` draws."""
    if isinstance(rows, tuple) and rows and is_dataclass(rows[0]):
        return tuple(timed(row, factor) for row in rows)
    if not is_dataclass(rows):
        return rows
    changed = {}
    for one in fields(rows):
        value = getattr(rows, one.name)
        changed[one.name] = value * factor() if one.name.endswith("_s") else timed(value, factor)
    return replace(cast(Any, rows), **changed)
