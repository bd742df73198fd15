"""What is drawn for one time of sitting down, sitting and rising (own_way.py): data/transitions/sit_own.toml."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from motion_backend.procedural.held_poses import bend
from motion_backend.procedural.own_way import drawn_way
from motion_backend.procedural.sit.sit_keys import SitKeys
from motion_backend.procedural.touch.hand_rests import Hold
from motion_backend.rotations import Array

ON_TOP, TO_KNEE = 0.02, -0.02
"""How far a palm is from a thigh's middle line that lies on top of it, and goes towards the knee (metres)."""
ON_ARMS: Final = 0.5
"""Arms on a table or the thighs leave so large a share of a trunk's turn and bend aside."""
CHARACTER: Final = 0x517
"""Sets what is drawn for a character apart from what else is drawn from its seed."""


def _pair() -> Array:
    return np.zeros(2)


@dataclass(frozen=True, eq=False)
class OwnSeat:
    """What one time of sitting has of its own; nothing by itself. Pairs are left and right, metres at 1.70 m.

    No two are the same, whatever was drawn.
    """

    lean: float = 0.0
    """How much farther the trunk folds (share)."""
    time: float = 0.0
    """How much longer it all takes (share)."""
    recline: float = 0.0
    """In the mean of those who do not sit upright (degrees)."""
    upright_recline: float = 0.0
    turn: float = 0.0
    side: float = 0.0
    head_forward: float = 0.0
    head_turn: float = 0.0
    foot_ahead: Array = field(default_factory=_pair)
    foot_out: Array = field(default_factory=_pair)
    palm_along: Array = field(default_factory=_pair)
    palm_out: Array = field(default_factory=_pair)
    elbow_out: Array = field(default_factory=_pair)
    elbow_up: Array = field(default_factory=_pair)
    """Of an elbow's direction."""

    def of_hand(self, hold: Hold | None, index: int) -> Hold | None:
        """A hold with its elbow a little elsewhere, and the palm too where that is on top of a thigh."""
        if hold is None:
            return hold
        out, up, ahead = hold.elbow
        elbow = (out * (1 + float(self.elbow_out[index])), up + float(self.elbow_up[index]), ahead)
        if hold.part != "left_hip" or abs(hold.palm[0]) > ON_TOP:
            return replace(hold, elbow=elbow)
        x, y, z = hold.palm
        palm = (x + float(self.palm_out[index]), y + max(float(self.palm_along[index]), TO_KNEE), z)
        return replace(hold, palm=palm, elbow=elbow)

    def of_trunk(self, on_arms: bool) -> Array:
        """How it is turned and bent aside: less where arms lie on something before it. (3,)."""
        return (ON_ARMS if on_arms else 1.0) * bend(0.0, self.side, self.turn)


NOBODY: Final = OwnSeat()
"""Who sits as the tables say."""


def own_seat(spread: Mapping[str, float], seed: int, rng: np.random.Generator) -> OwnSeat:
    """What this time of sitting has of its own, of the character of that seed."""
    return drawn_way(NOBODY, spread, (seed, CHARACTER), rng)


def in_own_way(keys: SitKeys, own: OwnSeat, low: bool) -> SitKeys:
    """The tables as this time has them: how far the trunk folds, and how long it takes.

    On a low seat there is no room between trunk and knees to fold farther.
    """
    lean, time = 1 + (min(own.lean, 0.0) if low else own.lean), float(np.exp(own.time))
    lower, rise = keys.down.lower, keys.up.rise
    down = replace(
        lower, time_s=time * lower.time_s, lean_rad=lean * lower.lean_rad,
        lean_per_depth_rad=lean * lower.lean_per_depth_rad,
    )  # fmt: skip
    up = replace(
        rise, time_s=time * rise.time_s, lean_rad=lean * rise.lean_rad,
        lean_per_depth_rad=lean * rise.lean_per_depth_rad,
    )  # fmt: skip
    return replace(keys, down=replace(keys.down, lower=down), up=replace(keys.up, rise=up))
