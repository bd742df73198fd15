"""What makes a furnished room look lived in: a rug, pictures, a lamp under the ceiling."""

from __future__ import annotations

from shapely import Polygon

from scene_graphs.furniture import group_of
from scene_graphs.generation.furniture_placement import Arrangement, Item
from scene_graphs.generation.random_choices import Luck, size_of
from scene_graphs.generation.room_recipes import recipe_of
from scene_graphs.generation.room_shell import Rectangle, rectangle
from scene_graphs.layout import Placed, Point2

PICTURE_HEIGHT = 1.35
"""Height of a picture's lower edge, and the height above which furniture hides it."""
RUGS = {
    "double_bed": (1.1, 1.6, 0.35),
    "single_bed": (1.1, 1.6, 0.35),
    "coffee_table": (1.5, 1.9, 0.0),
    "desk": (0.9, 2.0, 1.4),
}
"""What has a rug: how much wider the rug is, how deep, and how far ahead of it in its own depths."""


def finish(room: Arrangement, luck: Luck) -> None:
    """Add a rug, pictures and a lamp, each only where it fits."""
    _rug(room)
    _pictures(room)
    hangs = any(placed.category == "pendant_lamp" for placed in room.placed)
    lit = luck.has("ceiling lamp", recipe_of(luck.kind).ceiling_lamp_share)
    if lit and (luck.kind == "living_dining" or not hangs):
        size = size_of(room.rng, "ceiling_lamp")
        room.add(Item("ceiling_lamp", 0.0, 0.0, size, 0.0, round(room.shell.height - size[1], 3)), _middle(room), 0.0)


def _middle(room: Arrangement) -> Point2:
    """The middle of the floor, which lies in the room for every L too."""
    center = Polygon(room.shell.outline).centroid
    return (float(center.x), float(center.y))


def _rug(room: Arrangement) -> None:
    """A rug in the middle of what it belongs to, if there is one and no cupboard would stand on it."""
    for anchor in room.placed:
        if anchor.category in RUGS and room.rng.random() < 0.75:
            wider, depth, ahead = RUGS[anchor.category]
            size = (round(anchor.size[0] + wider, 2), 0.012, depth)
            x, _, z = anchor.to_world((0.0, 0.0, ahead * anchor.size[2])).tolist()
            lies = rectangle((x, z), size[0], size[2], anchor.yaw)
            heavy = (p for p in room.placed if p.position[1] == 0.0 and group_of(p.category) in ("storage", "media"))
            if room.shell.holds(lies, -0.05) and not any(lies.meets(_covered(placed)) for placed in heavy):
                room.add(Item("rug", 0.0, 0.0, size), (x, z), anchor.yaw)
            return


def _pictures(room: Arrangement) -> None:
    """Pictures on free stretches of wall, above low furniture first."""
    wanted = int(room.rng.integers(1, 4))
    for side in (int(index) for index in room.rng.permutation(len(room.shell.sides))):
        wall = room.shell.sides[side]
        low = [wall.along((p.position[0], p.position[2])) for p in room.placed if _stands_at(room, p, side)]
        for along in [*low, float(room.rng.uniform(-0.3, 0.3)) * wall.length]:
            if wanted == 0:
                return
            size = size_of(room.rng, "picture")
            if _is_free_wall(room, side, along, size[0] / 2 + 0.1):
                item = Item("picture", 0.0, size[2] / 2, size, 0.0, PICTURE_HEIGHT)
                room.add(item, wall.at(along, 0.0), wall.yaw)
                wanted -= 1
                break


def _stands_at(room: Arrangement, placed: Placed, side: int) -> bool:
    """Whether a wide piece has its back to that wall and is low enough to hang something over."""
    wall, here = room.shell.sides[side], (placed.position[0], placed.position[2])
    at_wall = wall.away(here) < placed.size[2] / 2 + 0.15 and abs(wall.along(here)) < wall.length / 2
    return at_wall and placed.size[0] > 0.9 and 0.1 < placed.top < PICTURE_HEIGHT


def _is_free_wall(room: Arrangement, side: int, along: float, half: float) -> bool:
    wall = room.shell.sides[side]
    if abs(along) + half > wall.length / 2 - 0.1:
        return False
    if any(low - half < along < high + half for low, high in room.shell.spans(side)):
        return False
    strip = rectangle(wall.at(along, 0.0), 2 * half, 0.6, wall.yaw)
    return not any(
        strip.meets(_covered(placed))
        for placed in room.placed
        if placed.top > PICTURE_HEIGHT - 0.05 and placed.category != "ceiling_lamp"
    )


def _covered(placed: Placed) -> Rectangle:
    return rectangle((placed.position[0], placed.position[2]), placed.size[0], placed.size[2], placed.yaw)
