"""Groups of furniture that belong together, with the space people need around them.

Sizes are drawn around the medians of real rooms. Chairs stand pulled out, so that one can step between seat and table.
"""

from __future__ import annotations

from math import pi

import numpy as np

from scene_graphs.arranging.arrangement import Group, Item, Rect
from scene_graphs.layouts import Point3

Rng = np.random.Generator
BEHIND = 0.03
"""Gap between a wall and what stands against it."""
PULLED_OUT = 0.50
"""Space between a table's edge and the front of a chair's seat."""
SOFA_TO_TABLE = 0.58
"""Space between the front of a sofa and a coffee table."""
SIZES: dict[str, tuple[Point3, Point3]] = {
    "double_bed": ((1.5, 0.85, 2.05), (1.9, 1.1, 2.2)),
    "single_bed": ((0.95, 0.8, 2.0), (1.2, 1.0, 2.1)),
    "kids_bed": ((0.9, 0.75, 1.85), (1.05, 0.9, 1.95)),
    "bunk_bed": ((1.0, 1.7, 2.0), (1.15, 1.8, 2.1)),
    "nightstand": ((0.42, 0.45, 0.38), (0.56, 0.58, 0.45)),
    "table_lamp": ((0.24, 0.42, 0.24), (0.3, 0.52, 0.3)),
    "floor_lamp": ((0.36, 1.5, 0.36), (0.44, 1.7, 0.44)),
    "pendant_lamp": ((0.4, 0.9, 0.4), (0.6, 1.1, 0.6)),
    "ceiling_lamp": ((0.45, 0.14, 0.45), (0.6, 0.18, 0.6)),
    "wardrobe": ((1.0, 2.0, 0.56), (1.9, 2.3, 0.62)),
    "cabinet": ((0.8, 1.3, 0.38), (1.2, 1.8, 0.45)),
    "wine_cabinet": ((0.7, 1.7, 0.36), (0.95, 1.95, 0.42)),
    "bookshelf": ((0.8, 1.7, 0.28), (1.3, 2.05, 0.36)),
    "shelf": ((0.6, 1.3, 0.3), (0.9, 1.75, 0.38)),
    "dresser": ((0.85, 0.8, 0.42), (1.2, 1.0, 0.5)),
    "console_table": ((1.0, 0.78, 0.34), (1.5, 0.9, 0.42)),
    "tv_stand": ((1.3, 0.42, 0.4), (1.9, 0.55, 0.46)),
    "tv": ((1.0, 0.6, 0.1), (1.3, 0.75, 0.12)),
    "desk": ((1.2, 0.74, 0.58), (1.6, 0.77, 0.7)),
    "dressing_table": ((0.9, 1.25, 0.42), (1.2, 1.4, 0.48)),
    "dining_table": ((1.4, 0.74, 0.8), (1.9, 0.77, 1.0)),
    "coffee_table": ((0.9, 0.36, 0.5), (1.25, 0.43, 0.68)),
    "side_table": ((0.4, 0.5, 0.4), (0.5, 0.58, 0.5)),
    "round_end_table": ((0.42, 0.5, 0.42), (0.52, 0.58, 0.52)),
    "multi_seat_sofa": ((2.0, 0.8, 0.88), (2.5, 0.9, 0.98)),
    "loveseat_sofa": ((1.5, 0.78, 0.84), (1.75, 0.86, 0.92)),
    "l_shaped_sofa": ((2.4, 0.8, 1.5), (2.8, 0.88, 1.7)),
    "chaise_longue_sofa": ((1.8, 0.78, 0.78), (1.95, 0.85, 0.86)),
    "armchair": ((0.78, 0.8, 0.78), (0.9, 0.95, 0.86)),
    "lounge_chair": ((0.66, 0.78, 0.72), (0.76, 0.88, 0.8)),
    "lazy_sofa": ((0.82, 0.7, 0.82), (0.95, 0.8, 0.92)),
    "dining_chair": ((0.44, 0.84, 0.5), (0.5, 0.94, 0.55)),
    "dressing_chair": ((0.44, 0.78, 0.48), (0.5, 0.86, 0.52)),
    "office_chair": ((0.56, 0.92, 0.58), (0.64, 1.05, 0.64)),
    "stool": ((0.36, 0.43, 0.36), (0.46, 0.47, 0.42)),
    "ottoman": ((0.5, 0.4, 0.45), (0.7, 0.45, 0.55)),
    "bench": ((1.1, 0.43, 0.36), (1.4, 0.47, 0.42)),
    "refrigerator": ((0.65, 1.7, 0.64), (0.85, 1.85, 0.7)),
    "plant": ((0.4, 0.9, 0.4), (0.6, 1.4, 0.6)),
    "vase": ((0.14, 0.3, 0.14), (0.2, 0.42, 0.2)),
    "mirror": ((0.5, 1.5, 0.06), (0.7, 1.7, 0.08)),
    "picture": ((0.5, 0.4, 0.04), (1.0, 0.7, 0.04)),
    "rug": ((2.0, 0.012, 1.4), (2.8, 0.012, 2.0)),
}
"""Least and greatest width, height and depth our rooms use, in metres."""


def size_of(rng: Rng, category: str) -> Point3:
    """A size between the least and greatest of a category, to the centimetre."""
    low, high = SIZES[category]
    w, h, d = (round(float(rng.uniform(a, b)), 2 if category != "rug" else 3) for a, b in zip(low, high, strict=True))
    return (w, h, d)


def standing_alone(rng: Rng, category: str, front: float = 0.6) -> Group:
    """One piece with its back to the wall and the floor before it clear."""
    size = size_of(rng, category)
    w, _, d = size
    return Group((Item(category, 0.0, d / 2 + BEHIND, size),), ((-w / 2, w / 2, d + BEHIND, d + BEHIND + front),))


def bed(rng: Rng, category: str, sides: tuple[int, ...] = (-1, 1), lamps: bool = True) -> Group:
    """A bed with a nightstand and a lamp at each of its free sides (-1, 1), clear along those sides."""
    size, stand = size_of(rng, category), size_of(rng, "nightstand")
    w, _, d = size
    items = [Item(category, 0.0, d / 2 + BEHIND, size)]
    clear: list[Rect] = []
    lamp = size_of(rng, "table_lamp")
    for side in sides:
        x, z = side * (w / 2 + 0.06 + stand[0] / 2), stand[2] / 2 + BEHIND
        items.append(Item("nightstand", x, z, stand))
        if lamps:
            items.append(Item("table_lamp", x, z, lamp, 0.0, stand[1], len(items) - 1))
        near, far = sorted((side * (w / 2), side * (w / 2 + 0.75)))
        clear.append((near, far, stand[2] + 0.08, d))
    return Group(tuple(items), tuple(clear))


def lounge(rng: Rng, reach: float, sofa: str, with_tv: bool = True) -> Group | None:
    """A tv on its stand, a sofa facing it from across a coffee table, and armchairs beside the table.

    `reach` is the distance between the tv's wall and the one opposite; the sofa stands against that one if it is near
    enough, and free in the room otherwise. None if the room is too short.
    """
    stand, couch, table = (size_of(rng, name) for name in ("tv_stand", sofa, "coffee_table"))
    body = min(0.98, 0.62 * couch[2]) if sofa == "l_shaped_sofa" else couch[2]
    front = stand[2] + BEHIND if with_tv else 0.0
    free = reach - front - couch[2] - BEHIND
    view = free if free <= 3.45 else float(rng.uniform(2.5, min(3.2, free - 0.85)))
    nearest = SOFA_TO_TABLE + table[2] + 0.7
    # Depth the chaise of an L takes from the view: the table stands beside it.
    if view + (couch[2] - body) < nearest or view < 0.9:
        return None
    back = front + view + couch[2]
    items = [Item(sofa, 0.0, back - couch[2] / 2, couch, pi)]
    nook = 0.0
    if sofa == "l_shaped_sofa":
        chaise = couch[0] / 2 - 0.17 - min(0.78, 0.38 * couch[0])
        table = (min(table[0], 0.95), table[1], table[2])
        nook = min(couch[0] / 2 - table[0] / 2, -chaise + 0.42 + table[0] / 2)
    table_z = back - body - SOFA_TO_TABLE - table[2] / 2
    items.append(Item("coffee_table", nook, table_z, table))
    if with_tv:
        items.append(Item("tv_stand", 0.0, stand[2] / 2 + BEHIND, stand))
        tv = size_of(rng, "tv")
        items.append(Item("tv", 0.0, stand[2] / 2 + BEHIND, tv, 0.0, stand[1], len(items) - 1))
    items += _beside_the_table(rng, items[1], couch)
    rug = (round(couch[0] + 0.3, 2), 0.012, 1.9)
    items.append(Item("rug", 0.0, table_z, rug))
    strip = (-couch[0] / 2, couch[0] / 2, front, back - body)
    return Group(tuple(items), (strip,))


def sofa_corner(rng: Rng, sofa: str) -> Group:
    """A sofa against the wall with a coffee table before it and a side table or floor lamp at one end."""
    couch, table = size_of(rng, sofa), size_of(rng, "coffee_table")
    table = (min(table[0], 0.65 * couch[0]), table[1], min(table[2], 0.55))
    front = couch[2] + BEHIND
    items = [Item(sofa, 0.0, couch[2] / 2 + BEHIND, couch)]
    items.append(Item("coffee_table", 0.0, front + SOFA_TO_TABLE + table[2] / 2, table))
    items += _at_the_end(rng, couch[0] / 2, front / 2)
    strip = (-couch[0] / 2, couch[0] / 2, front, front + SOFA_TO_TABLE)
    return Group(tuple(items), (strip,))


def _at_the_end(rng: Rng, half: float, z: float) -> list[Item]:
    side = 1.0 if rng.random() < 0.5 else -1.0
    category = str(rng.choice(["floor_lamp", "side_table", "round_end_table"]))
    size = size_of(rng, category)
    return [Item(category, side * (half + 0.08 + size[0] / 2), z, size)]


def _beside_the_table(rng: Rng, table: Item, couch: Point3) -> list[Item]:
    """None, one or two armchairs facing the table from its ends, and a lamp by the sofa."""
    items: list[Item] = []
    sides = [-1.0, 1.0] if table.x == 0.0 else [float(np.sign(table.x))]
    chosen = str(rng.choice(["armchair", "armchair", "lounge_chair", "lazy_sofa"]))
    size = size_of(rng, chosen)
    for side in sides[: int(rng.integers(0, 3))]:
        x = table.x + side * (table.size[0] / 2 + 0.62 + size[2] / 2)
        if abs(x) < couch[0] / 2 + 0.1 and table.x != 0.0:
            continue
        yaw = -side * pi / 2 + float(rng.uniform(-0.25, 0.25))
        items.append(Item(chosen, round(x, 3), table.z - float(rng.uniform(0.0, 0.25)), size, yaw))
    return items


def dining(rng: Rng, seats: int) -> Group:
    """A dining table with two chairs at each long side, and from five seats on at its ends; all pulled out."""
    table, chair = size_of(rng, "dining_table"), size_of(rng, "dining_chair")
    if seats == 2:
        table = (1.1, table[1], 0.8)
    w, _, d = table
    out = PULLED_OUT + chair[2] / 2
    across = [-0.24 * w, 0.24 * w] if seats >= 4 else [0.0]
    places = [(x, side * (d / 2 + out), pi / 2 + side * pi / 2) for side in (1.0, -1.0) for x in across]
    places += [(side * (w / 2 + out), 0.0, -side * pi / 2) for side in (1.0, -1.0)][: max(0, seats - 4)]
    items = [Item("dining_table", 0.0, 0.0, table)]
    for x, z, yaw in places:
        push = float(rng.uniform(0.0, 0.06))
        drift = push * np.array([np.sin(yaw), np.cos(yaw)])
        turn = float(rng.uniform(-0.16, 0.16))
        items.append(Item("dining_chair", round(x - drift[0], 3), round(z - drift[1], 3), chair, yaw + turn))
    vase = size_of(rng, "vase")
    items.append(Item("vase", 0.0, 0.0, vase, 0.0, table[1], 0))
    return Group(tuple(items))


def work_place(rng: Rng, seat: str = "office_chair", lamp: bool = True) -> Group:
    """A desk against the wall, a chair before it, a lamp on it."""
    table, chair = size_of(rng, "desk"), size_of(rng, seat)
    side = 1.0 if rng.random() < 0.5 else -1.0
    items = [Item("desk", 0.0, table[2] / 2 + BEHIND, table)]
    if lamp:
        size = size_of(rng, "table_lamp")
        items.append(Item("table_lamp", side * (table[0] / 2 - 0.2), table[2] / 2 + BEHIND, size, 0.0, table[1], 0))
    z = table[2] + BEHIND + PULLED_OUT + float(rng.uniform(0.0, 0.08)) + chair[2] / 2
    x = -side * 0.15 * table[0]
    items.append(Item(seat, round(x, 3), round(z, 3), chair, pi + float(rng.uniform(-0.3, 0.3))))
    return Group(tuple(items), ((-table[0] / 2, table[0] / 2, table[2] + BEHIND, z + chair[2] / 2),))


def free_desk(rng: Rng) -> Group:
    """A desk in the room whose chair has the wall behind it, as in a grand study."""
    table, chair = size_of(rng, "desk"), size_of(rng, "office_chair")
    chair_z = 0.12 + chair[2] / 2
    table_z = chair_z + chair[2] / 2 + PULLED_OUT + 0.04 + table[2] / 2
    side = 1.0 if rng.random() < 0.5 else -1.0
    lamp = size_of(rng, "table_lamp")
    x = side * (table[0] / 2 - 0.2)
    items = (
        Item("desk", 0.0, table_z, table, pi),
        Item("table_lamp", x, table_z, lamp, 0.0, table[1], 0),
        Item("office_chair", round(-side * 0.1, 3), chair_z, chair, float(rng.uniform(-0.2, 0.2))),
    )
    half, far = table[0] / 2, table_z + table[2] / 2
    return Group(items, ((-half, half, chair_z, far + 0.6), (-half - 0.5, half + 0.5, far - 0.5, far)))


def dressing_place(rng: Rng) -> Group:
    """A dressing table with its mirror, and a chair or stool before it."""
    table = size_of(rng, "dressing_table")
    seat = str(rng.choice(["dressing_chair", "stool"]))
    size = size_of(rng, seat)
    z = table[2] + BEHIND + (PULLED_OUT + 0.02 if seat == "dressing_chair" else 0.16) + size[2] / 2
    yaw = pi + float(rng.uniform(-0.15, 0.15)) if seat == "dressing_chair" else 0.0
    items = (Item("dressing_table", 0.0, table[2] / 2 + BEHIND, table), Item(seat, 0.0, round(z, 3), size, yaw))
    half = table[0] / 2
    return Group(items, ((-half, half, table[2] + BEHIND, z + size[2] / 2 + 0.3),))


def reading_place(rng: Rng) -> Group:
    """An armchair a little turned, with a floor lamp at one side and sometimes a small table at the other."""
    category = str(rng.choice(["armchair", "armchair", "armchair", "lounge_chair", "lazy_sofa"]))
    chair, lamp = size_of(rng, category), size_of(rng, "floor_lamp")
    side = 1.0 if rng.random() < 0.5 else -1.0
    turn = side * float(rng.uniform(0.0, 0.35))
    z = chair[2] / 2 + 0.16
    items = [
        Item(category, 0.0, z, chair, -turn),
        Item("floor_lamp", side * (chair[0] / 2 + 0.14 + lamp[0] / 2), lamp[2] / 2 + 0.05, lamp),
    ]
    if rng.random() < 0.5:
        small = str(rng.choice(["side_table", "round_end_table"]))
        size = size_of(rng, small)
        items.append(Item(small, -side * (chair[0] / 2 + 0.16 + size[0] / 2), z - 0.05, size))
    half = chair[0] / 2
    return Group(tuple(items), ((-half, half, z + chair[2] / 2, z + chair[2] / 2 + 0.7),))
