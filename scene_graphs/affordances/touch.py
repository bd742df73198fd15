"""Places for a hand: points on the fronts and tops of a piece at three heights, each with room to stand before it."""

from __future__ import annotations

from collections.abc import Iterator
from math import atan2

from scene_graphs.affordances.spot import FORWARD, Spot, ahead, dot, extent, plan_distance, to_world
from scene_graphs.furniture_shapes import Part
from scene_graphs.layout import Placed, Point2, Point3, wrap

TOUCH_HEIGHTS = {"medium": (0.68, 1.0, 1.15), "low": (0.30, 0.45, 0.55), "high": (1.38, 1.76, 1.76)}
"""Least, wanted and greatest height above the floor of a touched point."""
AWAY = {"medium": (0.38, 0.45), "low": (0.50,), "high": (0.45,)}
"""How far from it one stands: right up to what is at hand if its foot allows that, with room to squat or to stretch
(metres)."""
AWAY_OVER = 0.50
"""The same from what stands on something else."""
SHOULDERS = 1.3
"""Up to this height tops are touched rather than fronts (metres above the piece's bottom)."""
DISC = 0.22
"""Radius of a standing body seen from above."""
_UNTOUCHED = frozenset({"rug", "foliage", "pillow", "foot", "leg"})


def touching(placed: Placed, solid: list[Part]) -> Iterator[Spot]:
    """Spots to touch, the front first, then the sides and the back; at each the medium height first."""
    directions = [FORWARD, (1.0, 0.0), (-1.0, 0.0), (0.0, -1.0)]
    touchable = [part for part in solid if part.role not in _UNTOUCHED]
    for u in directions:
        seen: set[tuple[Point3, Point3]] = set()
        width = placed.size[0] if u[0] == 0 else placed.size[2]
        shifts = (0.0, width / 4, -width / 4) if width >= 1.0 else (0.0,)
        for height, (least, wanted, most) in TOUCH_HEIGHTS.items():
            band = (least - placed.position[1], wanted - placed.position[1], most - placed.position[1])
            for shift in shifts:
                found = _touch_point(touchable, u, shift, band)
                if found is not None and found not in seen:
                    seen.add(found)
                    yield from _touch_spot(placed, solid, found, u, height)


def _touch_spot(
    placed: Placed, solid: list[Part], found: tuple[Point3, Point3], u: Point2, height: str
) -> Iterator[Spot]:
    local, normal = found
    tries = [ahead(local, u, away) for away in ((AWAY_OVER,) if placed.parent else AWAY[height])]
    below = [part for part in solid if part.low[1] + placed.position[1] < 1.7]
    free = [stand for stand in tries if all(plan_distance(part, stand) >= DISC for part in below)]
    if not free:
        return
    stand = free[0]
    facing = wrap(placed.yaw + atan2(-u[0], -u[1]))
    point, standing = to_world(placed, local), to_world(placed, stand)
    turned = to_world(placed, normal)
    out = (turned[0] - placed.position[0], turned[1] - placed.position[1], turned[2] - placed.position[2])
    yield Spot("touch", placed.id, point, out, facing, (standing[0], standing[2]), facing, height=height)


def _touch_point(
    solid: list[Part], u: Point2, shift: float, band: tuple[float, float, float]
) -> tuple[Point3, Point3] | None:
    """The point and normal of the outermost face or top towards u in a band of heights, near the wanted height."""
    v = (u[1], -u[0])
    best: tuple[float, float, Point3, Point3] | None = None
    for part in solid:
        middle, half = dot(part.center, v), extent(part, v) / 2
        lateral = min(max(shift, middle - half + min(half, 0.04)), middle + half - min(half, 0.04))
        if abs(lateral - shift) > 0.6:
            continue
        rim = dot(part.center, u) + extent(part, u) / 2
        for y, inset, normal in _faces(part, u, band):
            out = rim - inset
            # A top counts as if touched at its rim, and a little further: a hand is laid on a table, not on its edge.
            # Above the shoulders it is the other way round: an arm does not go over an edge.
            preferred = rim + (0.0 if not inset else 0.02 if y < SHOULDERS else -0.02)
            rank = (round(abs(lateral - shift) - preferred, 3), abs(y - band[1]))
            point = (u[0] * out + v[0] * lateral, y, u[1] * out + v[1] * lateral)
            if best is None or rank < best[:2]:
                best = (*rank, point, normal)
    return None if best is None else (best[2], best[3])


def _faces(part: Part, u: Point2, band: tuple[float, float, float]) -> Iterator[tuple[float, float, Point3]]:
    """Height, inset from the rim and normal of a part's touchable faces: its top, and its side towards u."""
    least, wanted, most = band
    if part.role == "shade":
        wanted = part.center[1]
    elif least <= part.top <= most:
        yield part.top, min(0.06, extent(part, u) / 2), (0.0, 1.0, 0.0)
    low, high = max(least, part.low[1] + 0.01), min(most, part.top - 0.03)
    if low <= high:
        yield min(max(wanted, low), high), 0.0, (u[0], 0.0, u[1])
