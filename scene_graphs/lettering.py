"""Names on a drawing: each in or right beside its thing, none over another."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

POINTS: Final = 7
"""Size of the letters."""
PLATE: Final = {"boxstyle": "round,pad=0.12", "facecolor": "#ffffff8c", "edgecolor": "none"}
"""Behind a name, so that it is read over lines."""
_SHIFTS: Final = (0, 1, -1, 2, -2)
Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class Name:
    """What is to be written where."""

    text: str
    """One or more lines."""
    x: float
    z: float
    """The middle of the text, in the units of the axes."""
    turned: bool = False
    """Written upwards."""


def letter(ax: Axes, names: Iterable[Name], above: float) -> None:
    """Write names, the first ones first, in the layer `above` others; one that would cover another is left out.

    The axes must have their final limits.
    """
    ax.apply_aspect()
    ends = ax.transData.transform([[0.0, 0.0], [1.0, 0.0]])
    point = ax.figure.dpi / 72 / float(np.ptp(ends[:, 0]))
    taken: list[Box] = []
    for name in names:
        for lines in _SHIFTS:
            x, z, box = _place(name, lines, point)
            if not any(_meet(box, other) for other in taken):
                taken.append(box)
                label = ax.text(
                    x, z, name.text, fontsize=POINTS, ha="center", va="center", color="#222222", parse_math=False
                )
                label.set(rotation=90.0 if name.turned else 0.0, bbox=PLATE, zorder=above)
                break


def _place(name: Name, lines: int, point: float) -> tuple[float, float, Box]:
    """Where a name is when moved across by as many times its height, and about what it covers; a letter's point is
    that many units of the axes."""
    rows = name.text.split("\n")
    width, height = 0.62 * POINTS * point * max(map(len, rows)), (1.25 * len(rows) + 0.2) * POINTS * point
    shift = lines * (height / 2 + 0.6 * POINTS * point)
    x, z = (name.x + shift, name.z) if name.turned else (name.x, name.z + shift)
    across, along = (height / 2, width / 2) if name.turned else (width / 2, height / 2)
    return x, z, (x - across, z - along, x + across, z + along)


def _meet(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
