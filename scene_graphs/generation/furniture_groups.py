"""Groups of furniture that belong together, with the space people need around them.

Chairs stand pulled out, so that one can step between seat and table.
"""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi, sin

import numpy as np

from scene_graphs.generation.furniture_placement import Group, Item, Rect
from scene_graphs.generation.random_choices import size_of
from scene_graphs.layout import Point3

Rng = np.random.Generator
BEHIND = 0.03
"""Gap between a wall and what stands against it."""
PULLED_OUT = 0.50
"""Space between a table's edge and the front of a chair's seat."""
SOFA_TO_TABLE = 0.58
"""Space between the front of a sofa and a coffee table."""
BEYOND_TABLE = 0.4
"""Space on the far side of a coffee table."""
ROUND_FOOT = 0.5
"""Space from a bed's side on beyond its foot."""
BEHIND_CHAIR = 0.2
"""Space behind a chair at a table."""
TO_PASS = 0.68
"""The same where one can get to a chair from behind alone."""

JOINT = 0.005
"""Gap between pieces of a kitchen that stand side by side."""
BEFORE_KITCHEN = 0.9
"""Free floor before a kitchen."""


def standing_alone(rng: Rng, category: str, front: float = 0.6) -> Group:
    """One piece with its back to the wall and the floor before it clear."""
    size = size_of(rng, category)
    w, _, d = size
    return Group((Item(category, 0.0, d / 2 + BEHIND, size),), ((-w / 2, w / 2, d + BEHIND, d + BEHIND + front),))


def bed(rng: Rng, category: str, sides: tuple[int, ...], stands: int, lamps: bool) -> Group:
    """A bed that is clear along its free sides (-1, 1), with that many nightstands at them, with lamps or without."""
    size, stand, lamp = (size_of(rng, name) for name in (category, "nightstand", "table_lamp"))
    w, _, d = size
    items = [Item(category, 0.0, d / 2 + BEHIND, size)]
    clear: list[Rect] = []
    for number, side in enumerate(sides):
        x, z = side * (w / 2 + 0.06 + stand[0] / 2), stand[2] / 2 + BEHIND
        beside = stand[2] + 0.08 if number < stands else 0.3
        if number < stands:
            items.append(Item("nightstand", x, z, stand))
            if lamps:
                items.append(Item("table_lamp", x, z, lamp, 0.0, stand[1], len(items) - 1))
        near, far = sorted((side * (w / 2), side * (w / 2 + 0.75)))
        clear.append((near, far, beside, d + ROUND_FOOT))
    return Group(tuple(items), tuple(clear))


def sofa_bed(rng: Rng) -> Group:
    """A sofa one sleeps on, with a small table at one end."""
    couch = size_of(rng, "sofa_bed")
    front = couch[2] + BEHIND
    items = (
        Item("sofa_bed", 0.0, couch[2] / 2 + BEHIND, couch),
        *_at_the_end(rng, "side_table", couch[0] / 2, front / 2),
    )
    return Group(items, ((-couch[0] / 2, couch[0] / 2, front, front + 0.8),))


def lounge(rng: Rng, reach: float, sofa: str, seats: tuple[str, ...], has_table: bool) -> Group | None:
    """A tv on its stand, a sofa facing it from across a coffee table, and seats for one at the table's ends.

    `reach` is the distance between the tv's wall and the one opposite; the sofa stands against that one if it is near
    enough, and free in the room otherwise. None if the room is too short.
    """
    stand, couch, table = (size_of(rng, name) for name in ("tv_stand", sofa, "coffee_table"))
    body = min(0.98, 0.62 * couch[2]) if sofa == "l_shaped_sofa" else couch[2]
    front = stand[2] + BEHIND
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
    middle = Item("coffee_table", nook, table_z, table)
    items += [*tv_on_its_stand(rng, stand, 1), *_beside_the_table(rng, middle, couch, seats)]
    items += [middle] if has_table else []
    return Group(tuple(items), ((-couch[0] / 2, couch[0] / 2, front, back - body),))


def tv_on_its_stand(rng: Rng, stand: Point3, index: int) -> tuple[Item, Item]:
    """A stand with its back to the wall and a tv on it; `index` is the stand's in its group."""
    z = stand[2] / 2 + BEHIND
    return (Item("tv_stand", 0.0, z, stand), Item("tv", 0.0, z, size_of(rng, "tv"), 0.0, stand[1], index))


def watching_place(rng: Rng) -> Group:
    """A tv on its stand, with the floor before it clear."""
    stand = size_of(rng, "tv_stand")
    return Group(tv_on_its_stand(rng, stand, 0), ((-stand[0] / 2, stand[0] / 2, stand[2], stand[2] + 0.7),))


def sofa_corner(rng: Rng, sofa: str, table: bool = True, end: str | None = None) -> Group:
    """A sofa against the wall, with a coffee table before it and a small table at one end if asked for."""
    couch = size_of(rng, sofa)
    front = couch[2] + BEHIND
    free = front + SOFA_TO_TABLE
    items = [Item(sofa, 0.0, couch[2] / 2 + BEHIND, couch)]
    if table:
        w, h, d = size_of(rng, "coffee_table")
        low = (min(w, 0.65 * couch[0]), h, d)
        items.append(Item("coffee_table", 0.0, free + d / 2, low))
        free += d + BEYOND_TABLE
    if end is not None:
        items += _at_the_end(rng, end, couch[0] / 2, front / 2)
    return Group(tuple(items), ((-couch[0] / 2, couch[0] / 2, front, free),))


def two_armchairs(rng: Rng) -> Group:
    """Two armchairs side by side at a wall, a small table between them and a coffee table before them."""
    chair, small, table = (size_of(rng, name) for name in ("armchair", "side_table", "coffee_table"))
    apart, z = small[0] / 2 + 0.1 + chair[0] / 2, chair[2] / 2 + 0.08
    front = z + chair[2] / 2
    chairs = [Item("armchair", side * apart, z, chair, -0.12 * side) for side in (-1.0, 1.0)]
    items = [*chairs, Item("side_table", 0.0, small[2] / 2 + BEHIND, small)]
    items.append(Item("coffee_table", 0.0, front + SOFA_TO_TABLE + table[2] / 2 + 0.08, table))
    half = apart + chair[0] / 2
    return Group(tuple(items), ((-half, half, front + 0.1, items[-1].z + table[2] / 2 + BEYOND_TABLE),))


def _at_the_end(rng: Rng, category: str, half: float, z: float) -> list[Item]:
    side = 1.0 if rng.random() < 0.5 else -1.0
    size = size_of(rng, category)
    return [Item(category, side * (half + 0.08 + size[0] / 2), z, size)]


def _beside_the_table(rng: Rng, table: Item, couch: Point3, seats: tuple[str, ...]) -> list[Item]:
    """Seats for one that face the table from its ends; beside a chaise there is room for one."""
    items: list[Item] = []
    sides = [-1.0, 1.0] if table.x == 0.0 else [float(np.sign(table.x))]
    for side, category in zip(sides, seats, strict=False):
        size = size_of(rng, category)
        x = table.x + side * (table.size[0] / 2 + 0.62 + size[2] / 2)
        if abs(x) < couch[0] / 2 + 0.1 and table.x != 0.0:
            continue
        yaw = -side * pi / 2 + float(rng.uniform(-0.25, 0.25))
        items.append(Item(category, round(x, 3), table.z - float(rng.uniform(0.0, 0.25)), size, yaw))
    return items


def dining(rng: Rng, seats: int) -> Group:
    """A dining table with chairs at its long sides, a fifth at one end; all pulled out, so that each can be got to."""
    (w, h, d), chair = size_of(rng, "dining_table"), size_of(rng, "dining_chair")
    w, d = {2: (1.1, 0.8), 6: (max(w, 1.85), d)}.get(seats, (w, d))
    out = PULLED_OUT + chair[2] / 2
    across = {2: (0.0,), 6: (-0.33 * w, 0.0, 0.33 * w)}.get(seats, (-0.24 * w, 0.24 * w))
    places = [(x, side * (d / 2 + out), pi / 2 + side * pi / 2) for side in (1.0, -1.0) for x in across]
    places.append((w / 2 + out, 0.0, -pi / 2))
    items = [Item("dining_table", 0.0, 0.0, (w, h, d))]
    for x, z, yaw in places[:seats]:
        push, turn = float(rng.uniform(0.0, 0.06)), float(rng.uniform(-0.16, 0.16))
        items.append(Item("dining_chair", x - push * sin(yaw), z - push * cos(yaw), chair, yaw + turn))
    return Group(
        (*items, _vase(rng, (w, h, d))),
        _around(w, d, PULLED_OUT + chair[2] + (TO_PASS if seats == 6 else BEHIND_CHAIR)),
    )


def dining_on_benches(rng: Rng) -> Group:
    """A dining table between two benches."""
    table, bench = size_of(rng, "dining_table"), size_of(rng, "bench")
    z = table[2] / 2 + PULLED_OUT + bench[2] / 2
    benches = [Item("bench", 0.0, side * z, bench, pi / 2 + side * pi / 2) for side in (1.0, -1.0)]
    return Group(
        (Item("dining_table", 0.0, 0.0, table), *benches, _vase(rng, table)),
        _around(table[0], table[2], PULLED_OUT + bench[2] + BEHIND_CHAIR),
    )


def _around(w: float, d: float, out: float) -> tuple[Rect, Rect]:
    """The floor at a table's ends, from where one steps between table and seats, and `out` from its long sides."""
    beside, beyond = w / 2 + 0.6, d / 2 + PULLED_OUT
    return ((-beside, beside, -beyond, beyond), (-w / 2, w / 2, -d / 2 - out, d / 2 + out))


def _vase(rng: Rng, table: Point3) -> Item:
    return Item("vase", 0.0, 0.0, size_of(rng, "vase"), 0.0, table[1], 0)


def kitchen(rng: Rng, corner: int, goes_round: bool, microwave: bool, dishwasher: bool) -> Group:
    """A level line of counters, a sink and a stove between a cupboard and a refrigerator, from that end of a wall on.

    One that goes round the corner there (-1, 1) has a part of its line along the next wall.
    """
    (wide, h, d), (cupboard, *_) = size_of(rng, "kitchen_counter"), size_of(rng, "kitchen_cabinet")
    (_, tall, deep), (_, top, _) = size_of(rng, "refrigerator"), size_of(rng, "kitchen_cabinet")
    main = ("kitchen_counter", (max(wide, 1.0) + (d if goes_round else 0.0), h, d))
    other = ("kitchen_counter", (round(wide - 0.2, 2), h, d))
    fridge = ("refrigerator", (round(cupboard + 0.1, 2), tall, deep))
    store, stove = ("kitchen_cabinet", (cupboard, top, d)), ("stove", (size_of(rng, "stove")[0], h, d))
    washer = [("dishwasher", (size_of(rng, "dishwasher")[0], h, d))] * dishwasher
    line = [main, stove, store] if goes_round else [fridge, main, *washer, stove, other, store]
    turned = [*washer, other, fridge] if goes_round else []
    items, x, z = [], 0.0, d + BEHIND + JOINT
    for category, size in line:
        items.append(Item(category, x + size[0] / 2, size[2] / 2 + BEHIND, size))
        x += size[0] + JOINT
    for category, size in turned:
        items.append(Item(category, size[2] / 2, z + size[0] / 2, size, pi / 2))
        z += size[0] + JOINT
    side, front = (
        max((item.size[2] for item in part), default=0.0) for part in (items[len(line) :], items[: len(line)])
    )
    clear = [(side, x, front + BEHIND, front + BEHIND + BEFORE_KITCHEN)]
    clear += [(side, side + BEFORE_KITCHEN, front + BEHIND, z)] if turned else []
    counters = [number for number, item in enumerate(items) if item.category == "kitchen_counter"]
    # In the corner nobody stands before the near half of the counter.
    sink_x = items[counters[0]].x + (d / 2 if goes_round else 0.0)
    items.append(replace(_on(rng, items, counters[0], "kitchen_sink"), x=sink_x))
    items += [_on(rng, items, counters[1], "microwave")] if microwave else []
    if corner > 0:
        items = [replace(item, x=-item.x, yaw=-item.yaw) for item in items]
        clear = [(-x1, -x0, z0, z1) for x0, x1, z0, z1 in clear]
    return Group(tuple(items), tuple(clear))


def _on(rng: Rng, items: list[Item], index: int, category: str) -> Item:
    """Something in the middle of a piece's top."""
    below = items[index]
    return replace(below, category=category, size=size_of(rng, category), y=below.size[1], on=index)


def work_place(rng: Rng, seat: str, lamp: bool) -> Group:
    """A desk against the wall, a seat before it, perhaps a lamp on it."""
    table, chair = size_of(rng, "desk"), size_of(rng, seat)
    side = 1.0 if rng.random() < 0.5 else -1.0
    items = [Item("desk", 0.0, table[2] / 2 + BEHIND, table)]
    if lamp:
        items.append(_desk_lamp(rng, table, side, table[2] / 2 + BEHIND))
    z = table[2] + BEHIND + PULLED_OUT + float(rng.uniform(0.0, 0.08)) + chair[2] / 2
    turn = float(rng.uniform(-0.3, 0.3))
    items.append(Item(seat, round(-side * 0.15 * table[0], 3), round(z, 3), chair, pi + turn))
    return Group(tuple(items), ((-table[0] / 2, table[0] / 2, table[2] + BEHIND, z + chair[2] / 2),))


def free_desk(rng: Rng, seat: str, lamp: bool) -> Group:
    """A desk in the room whose seat has the wall behind it, as in a grand study."""
    table, chair = size_of(rng, "desk"), size_of(rng, seat)
    chair_z = 0.12 + chair[2] / 2
    table_z = chair_z + chair[2] / 2 + PULLED_OUT + 0.04 + table[2] / 2
    side = 1.0 if rng.random() < 0.5 else -1.0
    items = [Item("desk", 0.0, table_z, table, pi)]
    if lamp:
        items.append(_desk_lamp(rng, table, side, table_z))
    items.append(Item(seat, round(-side * 0.1, 3), chair_z, chair, float(rng.uniform(-0.2, 0.2))))
    half, far = table[0] / 2, table_z + table[2] / 2
    return Group(tuple(items), ((-half, half, chair_z, far + 0.6), (-half - 0.5, half + 0.5, far - 0.5, far)))


def _desk_lamp(rng: Rng, desk: Point3, side: float, z: float) -> Item:
    return Item("table_lamp", side * (desk[0] / 2 - 0.2), z, size_of(rng, "table_lamp"), 0.0, desk[1], 0)


def dressing_place(rng: Rng, seat: str) -> Group:
    """A dressing table with its mirror, and a chair or stool before it."""
    table, size = size_of(rng, "dressing_table"), size_of(rng, seat)
    z = table[2] + BEHIND + (PULLED_OUT + 0.02 if seat == "dressing_chair" else 0.16) + size[2] / 2
    yaw = pi + float(rng.uniform(-0.15, 0.15)) if seat == "dressing_chair" else 0.0
    items = (Item("dressing_table", 0.0, table[2] / 2 + BEHIND, table), Item(seat, 0.0, round(z, 3), size, yaw))
    half = table[0] / 2
    return Group(items, ((-half, half, table[2] + BEHIND, z + size[2] / 2 + 0.3),))


def reading_place(rng: Rng, category: str, lamp: bool, small: str | None = None) -> Group:
    """A seat for one, a little turned, perhaps with a floor lamp at one side and a small table at the other."""
    chair = size_of(rng, category)
    side = 1.0 if rng.random() < 0.5 else -1.0
    turn = side * float(rng.uniform(0.0, 0.35))
    z = chair[2] / 2 + 0.16
    items = [Item(category, 0.0, z, chair, -turn)]
    if lamp:
        size = size_of(rng, "floor_lamp")
        items.append(Item("floor_lamp", side * (chair[0] / 2 + 0.14 + size[0] / 2), size[2] / 2 + 0.05, size))
    if small is not None:
        size = size_of(rng, small)
        items.append(Item(small, -side * (chair[0] / 2 + 0.16 + size[0] / 2), z - 0.05, size))
    half = chair[0] / 2
    return Group(tuple(items), ((-half, half, z + chair[2] / 2, z + chair[2] / 2 + 0.7),))
