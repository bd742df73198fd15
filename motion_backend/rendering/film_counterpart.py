"""The window at which somebody stands and out of which they look: it is in the picture with them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from motion_backend import rotations
from motion_backend.motion import Motion
from motion_backend.rendering.film_entrance import SILL
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX
from motion_backend.walls import Side

if TYPE_CHECKING:
    from scene_graphs.home import Home

FROM: Final = 2.3
"""Metres from a window at most at which one stands who looks out of it."""
BESIDE: Final = 0.4
"""Metres that one may stand beside it."""
TOWARDS: Final = 0.8
"""The cosine from which on head and window are in line."""
STANDS: Final = 0.35
"""The share of frames in which somebody stands there, from which on it is what they do."""
WIDE: Final = 0.8
"""Metres of a wide window that are shown, to either side of who looks."""
UPRIGHT: Final = 0.8
"""The share of a standing pelvis's height above which somebody stands."""


@dataclass(frozen=True)
class Outlook:
    """A window somebody looks out of."""

    corners: Array
    """Of what is shown of it. (4, 3)."""
    side: Side
    """Its wall, as its room sees it."""

    @staticmethod
    def of(home: Home, motion: Motion, joints: Array, turns: Array) -> Outlook | None:
        """The window before which a body stands with its head turned to it in many of some frames of a motion, whose
        joints are (T, 22, 3) in the world and their rotations `turns` (T, 22, 4)."""
        ahead = rotations.rotate(turns[:, INDEX["head"]], np.array([0.0, 0.0, 1.0]))[:, [0, 2]]
        upright = joints[:, 0, 1] > UPRIGHT * motion.skeleton.standing_height
        found: list[tuple[float, Outlook]] = []
        for wall in home.walls:
            side = Side.of(wall, home)
            if side is None:
                continue
            for window in (one for one in wall.openings if one.bottom > SILL):
                one, other = np.asarray(window.segment, dtype=np.float64)
                long = max(float(np.linalg.norm(other - one)), 1e-6)
                here = joints[:, 0][:, [0, 2]] - one
                along, away = here @ (other - one) / long, -here @ side.outward
                before = (away > 0) & (away < FROM) & (along > -BESIDE) & (along < long + BESIDE)
                there = before & upright & (ahead @ side.outward > TOWARDS)
                if there.mean() < STANDS:
                    continue
                at = float(np.clip(along[there].mean(), 0.0, long))
                ends = [one + (other - one) * share / long for share in (max(at - WIDE, 0.0), min(at + WIDE, long))]
                corners = np.array([(x, y, z) for x, z in ends for y in (window.bottom, window.top)])
                found.append((float(away[there].mean()), Outlook(corners, side)))
        return min(found, key=lambda two: two[0])[1] if found else None
