"""Which triangle is nearest in every pixel of a picture, and how much light reaches a point; compiled.

Imported late: see `renderer`. Nothing is checked: whoever calls has checked it.
"""

from __future__ import annotations

import numpy as np

from motion_backend.rendering.rasterizer import Ints, Real
from motion_backend.rotations import Array
from scene_graphs.jit import compiled


@compiled
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


@compiled
def light_shares(places: Real, turns: Real, taps: Real, depth: Array, bias: float) -> Real:
    """The share of taps around places in a shadow map that nothing nearer to the light shades. (N,).

    `places` (N, 3) are x, y and nearness in the map `depth` (height, width); `taps` (K, 2) are in pixels, and turned by
    each place's own angle.
    """
    height, width = depth.shape
    shares = np.zeros(len(places), dtype=np.float32)
    for point in range(len(places)):
        x, y, near = places[point]
        cos, sin = np.cos(turns[point]), np.sin(turns[point])
        lit = 0
        for u, v in taps:
            column = min(max(int(x + (u * cos - v * sin)), 0), width - 1)
            row = min(max(int(y + (u * sin + v * cos)), 0), height - 1)
            lit += depth[row, column] < near + bias
        shares[point] = lit / len(taps)
    return shares
