"""Doors and drawers of storage, with gaps between them and handles on them."""

from __future__ import annotations

import numpy as np

from scene_graphs.forms import Part, form_of
from scene_graphs.layouts import Point3
from scene_graphs.looks import materials as m
from scene_graphs.looks.canvas import Canvas
from scene_graphs.looks.shapes import Shape, block

HANDLE = 0.012
"""How far a handle stands out, in metres."""


def drawers(canvas: Canvas, part: Part) -> None:
    """A body with a front a drawer, each with a handle."""
    rows = max(1, round(part.size[1] / 0.2))
    columns = 2 if part.size[0] > 0.8 else 1
    _fronts(canvas, part, rows, columns, knob=True)


def doors(canvas: Canvas, part: Part) -> None:
    """Doors half a metre wide; low pieces have knobs, tall ones bars for handles."""
    category, width = canvas.placed.category, part.size[0]
    if form_of(category) == "tall_storage":
        _fronts(canvas, part, 2 if category == "refrigerator" else 1, max(1, round(width / 0.5)), knob=False)
    else:
        _fronts(canvas, part, 3 if category == "dresser" else 1, max(2, round(width / 0.55)), knob=True)


def _fronts(canvas: Canvas, part: Part, rows: int, columns: int, *, knob: bool) -> None:
    """A body and its fronts, which reach to the part's own front; handles stand out a little."""
    material = m.STEEL if canvas.placed.category == "refrigerator" else canvas.pick(m.CARCASSES)
    (x0, y0, z0), (x1, y1, z1) = part.low, part.high
    face = z1 - 0.016
    canvas.add(material, block((x0, y0, z0), (x1, y1, face)))
    xs, ys = np.linspace(x0, x1, columns + 1), np.linspace(y0, y1, rows + 1)
    for column in range(columns):
        for row in range(rows):
            low = (float(xs[column]) + 0.005, float(ys[row]) + 0.005, face)
            high = (float(xs[column + 1]) - 0.005, float(ys[row + 1]) - 0.005, z1)
            canvas.add(material, block(low, high, 0.006))
            canvas.add(m.METAL, _handle(low, high, column, columns, knob=knob))


def _handle(low: Point3, high: Point3, column: int, columns: int, *, knob: bool) -> Shape:
    z0, z1 = high[2], high[2] + HANDLE
    if knob:
        x, y = (low[0] + high[0]) / 2, high[1] - min(0.06, 0.35 * (high[1] - low[1]))
        return block((x - 0.05, y - 0.006, z0), (x + 0.05, y + 0.006, z1))
    opens_right = column % 2 == 0 and columns > 1
    x = high[0] - 0.04 if opens_right else low[0] + 0.04
    y = low[1] + min(0.5 * (high[1] - low[1]), 1.0)
    return block((x - 0.008, y - 0.12, z0), (x + 0.008, y + 0.12, z1))
