"""What makes a furnished room look lived in: plants in corners, rugs, pictures, a lamp under the ceiling."""

from __future__ import annotations

import shapely

from scene_graphs.arranging import groups
from scene_graphs.arranging.arrangement import Arrangement, Group, Item
from scene_graphs.layouts import Placed

PICTURE_HEIGHT = 1.35
"""Height of a picture's lower edge, and the height above which furniture hides it."""


def finish(room: Arrangement) -> None:
    """Add plants, a rug, pictures and a lamp, each only where it fits."""
    _plants(room)
    _rug(room)
    _pictures(room)
    if not any(placed.category == "pendant_lamp" for placed in room.placed):
        lamp = groups.size_of(room.rng, "ceiling_lamp")
        room.add(Item("ceiling_lamp", 0.0, 0.0, lamp, 0.0, round(room.shell.height - lamp[1], 3)), (0.0, 0.0), 0.0)


def _plants(room: Arrangement) -> None:
    for _ in range(int(room.rng.choice([0, 1, 1, 2]))):
        size = groups.size_of(room.rng, "plant")
        group = Group((Item("plant", 0.0, size[2] / 2 + 0.05, size),))
        corner = 1 if room.rng.random() < 0.5 else -1
        room.against_wall(group, corner=corner)


def _rug(room: Arrangement) -> None:
    """A rug in the middle of what it belongs to: beside a bed, under a desk or table, unless there is one."""
    anchors = [placed for placed in room.placed if placed.category in ("double_bed", "single_bed", "desk")]
    if not anchors or room.rng.random() > 0.7 or any(placed.category == "rug" for placed in room.placed):
        return
    anchor = anchors[0]
    on_bed = anchor.category != "desk"
    size = (round(anchor.size[0] + (1.1 if on_bed else 0.9), 2), 0.012, 1.6 if on_bed else 2.0)
    ahead = 0.35 * anchor.size[2] if on_bed else 0.9
    middle = anchor.to_world((0.0, 0.0, ahead))
    rug = Item("rug", 0.0, 0.0, size)
    trial = Placed("", "rug", (float(middle[0]), 0.0, float(middle[2])), size, anchor.yaw)
    if shapely.Polygon(room.shell.outline).buffer(-0.05).contains(shapely.Polygon(trial.footprint)):
        room.add(rug, (float(middle[0]), float(middle[2])), anchor.yaw)


def _pictures(room: Arrangement) -> None:
    """Pictures on free stretches of wall, above low furniture first."""
    wanted = int(room.rng.integers(1, 4))
    for side in (int(index) for index in room.rng.permutation(4)):
        wall = room.shell.sides[side]
        low = [wall.along((p.position[0], p.position[2])) for p in room.placed if _stands_at(room, p, side)]
        for along in [*low, float(room.rng.uniform(-0.3, 0.3)) * wall.length]:
            if wanted == 0:
                return
            size = groups.size_of(room.rng, "picture")
            if _is_free_wall(room, side, along, size[0] / 2 + 0.1):
                item = Item("picture", 0.0, size[2] / 2, size, 0.0, PICTURE_HEIGHT)
                room.add(item, wall.at(along, 0.0), wall.yaw)
                wanted -= 1
                break


def _stands_at(room: Arrangement, placed: Placed, side: int) -> bool:
    """Whether a wide piece has its back to that wall and is low enough to hang something over."""
    wall = room.shell.sides[side]
    away = shapely.Point(placed.position[0], placed.position[2]).distance(
        shapely.LineString([wall.at(-wall.length / 2, 0.0), wall.at(wall.length / 2, 0.0)])
    )
    return placed.size[0] > 0.9 and away < placed.size[2] / 2 + 0.15 and 0.1 < placed.top < PICTURE_HEIGHT


def _is_free_wall(room: Arrangement, side: int, along: float, half: float) -> bool:
    wall = room.shell.sides[side]
    if abs(along) + half > wall.length / 2 - 0.1:
        return False
    if any(low - half < along < high + half for low, high in room.shell.spans(side)):
        return False
    strip = shapely.LineString([wall.at(along - half, 0.0), wall.at(along + half, 0.0)]).buffer(0.3, cap_style="flat")
    hiding = [
        placed for placed in room.placed if placed.top > PICTURE_HEIGHT - 0.05 and placed.category != "ceiling_lamp"
    ]
    return not any(strip.intersects(shapely.Polygon(placed.footprint)) for placed in hiding)
