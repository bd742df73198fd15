"""Which triangle is nearest in every pixel of a picture; compiled.

Imported late: see `renderer`. Nothing is checked: whoever calls has checked it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion_backend.rendering.rasterizer import Ints, Real
from motion_backend.rotations import Array
from scene_graphs.jit import filling, inlined


@filling
def draw(screen: Real, quarters: Ints, first: int, nearest: Ints, best: Array) -> None:
    """Draw triangles (F, 3, 3), as `Camera.project` gives them, into `nearest` and `best`, both (height, width).

    `nearest` gets the triangle's number, counted from `first`, wherever its nearness is the greatest yet in `best`; of
    two that are equally near the later one wins. `quarters` (F,) says how much of it is there: below 4 it is a pattern
    of holes over four samples.
    """
    height, width = best.shape
    for face in range(len(screen)):
        x0, y0, n0 = screen[face, 0]
        x1, y1, n1 = screen[face, 1]
        x2, y2, n2 = screen[face, 2]
        area = (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0)
        if abs(area) < 1e-9 or max(x0, x1, x2) <= 0 or min(x0, x1, x2) > width:
            continue
        by_x = ((n1 - n0) * (y2 - y0) - (n2 - n0) * (y1 - y0)) / area
        by_y = ((n2 - n0) * (x1 - x0) - (n1 - n0) * (x2 - x0)) / area
        low, high = min(y0, y1, y2), max(y0, y1, y2)
        for row in range(max(int(np.ceil(low - 0.5)), 0), min(int(np.ceil(high - 0.5)), height)):
            middle = row + 0.5
            left, right = np.inf, -np.inf
            for xa, ya, xb, yb in ((x0, y0, x1, y1), (x1, y1, x2, y2), (x2, y2, x0, y0)):
                if ya != yb and min(ya, yb) <= middle <= max(ya, yb):
                    crossing = xa + (xb - xa) * ((middle - ya) / (yb - ya))
                    left, right = min(left, crossing), max(right, crossing)
            start = max(int(np.ceil(max(left, -1.0) - 0.5)), 0)
            stop = min(int(np.ceil(min(right, width + 1.0) - 0.5)), width)
            near = n0 + by_x * (start + 0.5 - x0) + by_y * (middle - y0)
            for column in range(start, stop):
                pattern = (column % 2) * 2 ^ (row % 2) * 3
                if near >= best[row, column] and pattern < quarters[face]:
                    best[row, column] = near
                    nearest[row, column] = first + face
                near += by_x


@filling
def draw_body(points: Real, faces: NDArray[np.integer], nearest: NDArray[np.int32], best: Real) -> None:
    """The same for a closed body: faces (F, 3) of points (V, 3), those that show their outside; numbers from 0."""
    height, width = best.shape
    for face in range(len(faces)):
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        x0, y0, x1, y1, x2, y2 = points[a, 0], points[a, 1], points[b, 0], points[b, 1], points[c, 0], points[c, 1]
        area = (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0)
        if area > -1e-9:
            continue
        top, bottom = max(int(np.ceil(min(y0, y1, y2) - 0.5)), 0), min(int(np.ceil(max(y0, y1, y2) - 0.5)), height)
        if top >= bottom or np.ceil(min(x0, x1, x2) - 0.5) == np.ceil(max(x0, x1, x2) - 0.5):
            continue
        n0, n1, n2 = points[a, 2], points[b, 2], points[c, 2]
        by_x = ((n1 - n0) * (y2 - y0) - (n2 - n0) * (y1 - y0)) / area
        by_y = ((n2 - n0) * (x1 - x0) - (n1 - n0) * (x2 - x0)) / area
        lean0, lean1, lean2 = _lean(x0, y0, x1, y1), _lean(x1, y1, x2, y2), _lean(x2, y2, x0, y0)
        for row in range(top, bottom):
            y = row + 0.5
            left, right = 0.0, float(width)
            # Seen from outside, edges that go down are on the left.
            for xa, ya, yb, lean in ((x0, y0, y1, lean0), (x1, y1, y2, lean1), (x2, y2, y0, lean2)):
                if yb > ya:
                    left = max(left, xa + lean * (y - ya))
                elif yb < ya:
                    right = min(right, xa + lean * (y - ya))
            start = int(np.ceil(left - 0.5))
            near = n0 + by_x * (start + 0.5 - x0) + by_y * (y - y0)
            for column in range(start, int(np.ceil(right - 0.5))):
                if near >= best[row, column]:
                    best[row, column] = near
                    nearest[row, column] = face
                near += by_x


@inlined
def _lean(xa: float, ya: float, xb: float, yb: float) -> float:
    """How far across an edge goes for a step down."""
    return (xb - xa) / (yb - ya) if ya != yb else 0.0
