"""Which triangle is nearest in every pixel of a picture; compiled.

Imported late: see `renderer`. Nothing is checked: whoever calls has checked it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion_backend.rendering.rasterizer import Ints, Real
from motion_backend.rotations import Array
from scene_graphs.jit import filling


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
def draw_body(points: Real, faces: NDArray[np.integer], nearest: Ints, best: Array) -> None:
    """The same for a closed body: faces (F, 3) of points (V, 3), those that show their outside; numbers from 0."""
    height, width = best.shape
    for face in range(len(faces)):
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        x0, y0, x1, y1, x2, y2 = points[a, 0], points[a, 1], points[b, 0], points[b, 1], points[c, 0], points[c, 1]
        area = (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0)
        if area > -1e-9:
            continue
        left, right = max(int(np.ceil(min(x0, x1, x2) - 0.5)), 0), min(int(np.ceil(max(x0, x1, x2) - 0.5)), width)
        top, bottom = max(int(np.ceil(min(y0, y1, y2) - 0.5)), 0), min(int(np.ceil(max(y0, y1, y2) - 0.5)), height)
        if left >= right or top >= bottom:
            continue
        n0, n1, n2 = points[a, 2], points[b, 2], points[c, 2]
        for row in range(top, bottom):
            y = row + 0.5
            for column in range(left, right):
                x = column + 0.5
                # Twice the areas of the three parts that a point cuts the triangle into: all negative inside.
                p, q = (x1 - x) * (y2 - y) - (y1 - y) * (x2 - x), (x2 - x) * (y0 - y) - (y2 - y) * (x0 - x)
                r = area - p - q
                if p <= 0 and q <= 0 and r <= 0:
                    near = (p * n0 + q * n1 + r * n2) / area
                    if near >= best[row, column]:
                        best[row, column] = near
                        nearest[row, column] = face
