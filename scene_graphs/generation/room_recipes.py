"""What each kind of room is furnished with, in the order it is put in; shares follow real rooms (scene-formats 2.4).

A recipe says what falls to a room; where it goes is tried until all of it fits.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from scene_graphs.generation import furniture_groups
from scene_graphs.generation.furniture_placement import Arrangement, Group, Item
from scene_graphs.generation.random_choices import Luck, size_of

Step = Callable[[Arrangement], bool]
"""Puts something into a room; False if it found no place."""
Build = Callable[[np.random.Generator], Group]
Extras = tuple[tuple[str, float, Step], ...]
"""What it is, the share of rooms that have it, and how it is put there."""

OVERSAMPLED = {
    ("bedroom", "nightstand"): 0.88,
    ("bedroom", "wardrobe"): 0.80,
    ("living_room", "coffee_table"): 0.97,
    ("living_dining", "coffee_table"): 0.97,
}
"""Share of rooms with what stories ask for more often than real rooms have it. Studies are a quarter of all rooms."""

FLOOR = {
    "bedroom": (11.0, 1.3),
    "living_room": (16.5, 1.25),
    "living_dining": (27.0, 1.2),
    "dining_room": (14.0, 0.9),
    "study": (7.8, 1.3),
}
"""Square metres of a room with the least in it, and for every extra."""
L_SHAPED = {"bedroom": 0.16, "living_room": 0.24, "living_dining": 0.5, "dining_room": 0.16, "study": 0.12}
"""Share of rooms with six corners instead of four."""


def at_wall(build: Build, tries: int = 8) -> Step:
    """Puts a group somewhere along a wall."""
    return lambda room: room.against_wall(build(room.rng), tries=tries) is not None


def alone(category: str, front: float = 0.6) -> Step:
    """Puts a piece by itself along a wall, with that much floor before it."""
    return at_wall(lambda rng: furniture_groups.standing_alone(rng, category, front))


def in_corner(category: str) -> Step:
    """Puts a piece in a corner of the room, or where there is none free at a wall."""

    def put(room: Arrangement) -> bool:
        size = size_of(room.rng, category)
        group = Group((Item(category, 0.0, size[2] / 2 + 0.05, size),))
        corners = [1, -1] if room.rng.random() < 0.5 else [-1, 1]
        return any(room.against_wall(group, corner=corner, tries=4) is not None for corner in [*corners, 0])

    return put


def bedroom(luck: Luck) -> list[Step]:
    """A bed with nightstands, then storage, a place to dress, work or rest."""
    dresser_seat = luck.choose("dressing seat", {"dressing_chair": 0.5, "stool": 0.5})
    extras: Extras = (
        ("wardrobe", OVERSAMPLED["bedroom", "wardrobe"], alone("wardrobe")),
        (
            "desk",
            0.17,
            at_wall(lambda rng: furniture_groups.work_place(rng, "dining_chair", luck.has("desk lamp", 0.3))),
        ),
        ("dressing table", 0.17, at_wall(lambda rng: furniture_groups.dressing_place(rng, dresser_seat))),
        ("tv stand", 0.22, at_wall(furniture_groups.watching_place)),
        (
            "armchair",
            0.12,
            at_wall(lambda rng: furniture_groups.reading_place(rng, "armchair", luck.has("reading lamp", 0.4))),
        ),
        ("loveseat", 0.04, alone("loveseat_sofa")),
        ("dresser", 0.12, alone("dresser")),
        ("cabinet", 0.14, alone("cabinet")),
        ("bookshelf", 0.10, alone("bookshelf")),
        ("shelf", 0.06, alone("shelf")),
        ("mirror", 0.15, alone("mirror")),
        ("plant", 0.14, in_corner("plant")),
    )
    return [_bed(luck), *wanted(luck, extras)]


def living_room(luck: Luck) -> list[Step]:
    """A sofa with its coffee table, mostly before a tv, sometimes a small table to eat at, storage along the walls."""
    eats = {"": 0.46, "2": 0.16, "3": 0.14, "4": 0.24}
    seats = luck.choose("dining seats", eats)
    table = [_dining(int(seats))] if seats else []
    return [_lounge(luck), *table, *wanted(luck, _living_extras(luck, books=0.34, storage=1.15))]


def living_dining(luck: Luck) -> list[Step]:
    """A lounge and a table to dine at in one large room."""
    seats = luck.choose("dining seats", {"4": 0.58, "5": 0.1, "6": 0.26, "benches": 0.04, "2": 0.02})
    table = _dining(0 if seats == "benches" else int(seats), luck.has("lamp over the table", 0.5))
    return [_lounge(luck), table, *wanted(luck, _living_extras(luck, books=0.2, storage=1.3))]


def dining_room(luck: Luck) -> list[Step]:
    """A table with chairs pulled out, under a lamp; sideboards and cabinets along the walls."""
    seats = luck.choose("dining seats", {"4": 0.56, "5": 0.1, "6": 0.28, "benches": 0.06})
    table = _dining(0 if seats == "benches" else int(seats), luck.has("lamp over the table", 0.72), spread=0.25)
    small = _one_of(luck, "small table", "side_table", "round_end_table")
    extras: Extras = (
        ("sofa", 0.09, alone("multi_seat_sofa")),
        ("refrigerator", 0.10, alone("refrigerator")),
        ("sideboard", 0.38, alone("console_table", 0.5)),
        ("cabinet", 0.18, alone("cabinet", 0.5)),
        ("wine cabinet", 0.22, alone("wine_cabinet", 0.5)),
        (
            "armchair",
            0.12,
            at_wall(lambda rng: furniture_groups.reading_place(rng, "armchair", luck.has("lamp", 0.5), small)),
        ),
        ("bookshelf", 0.14, alone("bookshelf", 0.5)),
        ("shelf", 0.15, alone("shelf", 0.45)),
        ("stool", 0.15, alone("stool", 0.35)),
        ("floor lamp", 0.12, alone("floor_lamp", 0.3)),
        ("plant", 0.24, in_corner("plant")),
    )
    return [table, *wanted(luck, extras)]


def study(luck: Luck) -> list[Step]:
    """A desk with its chair and books, or books and a place to read them; often somewhere softer to sit."""
    seat = luck.choose("desk seat", {"office_chair": 0.6, "dining_chair": 0.25, "stool": 0.15})
    lamp = luck.has("desk lamp", 0.3)
    has_desk, is_grand = luck.has("desk", 0.80), luck.has("grand desk", 0.3)

    def work(room: Arrangement) -> bool:
        if is_grand and room.against_wall(furniture_groups.free_desk(room.rng, seat, lamp), tries=6) is not None:
            return True
        return room.against_wall(furniture_groups.work_place(room.rng, seat, lamp)) is not None

    reads = at_wall(lambda rng: furniture_groups.reading_place(rng, reader, luck.has("floor lamp", 0.6), small))
    reader = luck.choose("reading seat", {"armchair": 0.7, "lounge_chair": 0.15, "lazy_sofa": 0.15})
    small = _one_of(luck, "small table", "side_table", "round_end_table")
    first = [work] if has_desk else [alone("bookshelf"), reads]
    extras: Extras = (
        (
            "sofa",
            0.08,
            at_wall(lambda rng: furniture_groups.sofa_corner(rng, "multi_seat_sofa", luck.has("coffee table", 0.5))),
        ),
        ("chaise longue", 0.02, alone("chaise_longue_sofa")),
        ("wardrobe", 0.12, alone("wardrobe")),
        ("books", 0.34, alone("bookshelf")),
        ("more books", 0.2, alone("bookshelf")),
        ("cabinet", 0.14, alone("cabinet")),
        ("shelf", 0.10, alone("shelf")),
        ("visitor's chair", 0.07, alone("dining_chair")),
        ("plant", 0.40, in_corner("plant")),
    )
    reading: Extras = (("reading place", 0.30, reads),) if has_desk else ()
    return [*first, *wanted(luck, reading + extras)]


RECIPES: dict[str, Callable[[Luck], list[Step]]] = {
    "bedroom": bedroom,
    "living_room": living_room,
    "living_dining": living_dining,
    "dining_room": dining_room,
    "study": study,
}


def wanted(luck: Luck, extras: Extras) -> list[Step]:
    """The steps of what falls to a room."""
    return [step for word, share, step in extras if luck.has(word, share)]


def _living_extras(luck: Luck, books: float, storage: float) -> Extras:
    """What stands in living rooms beside the lounge, with the share of bookshelves and how much other storage."""
    reader = luck.choose("reading seat", {"armchair": 0.85, "lounge_chair": 0.1, "lazy_sofa": 0.05})
    small = _one_of(luck, "small table", "side_table", "round_end_table")
    lamp = luck.has("reading lamp", 0.75)
    return (
        ("loveseat", 0.08, alone("loveseat_sofa")),
        (
            "desk",
            0.10,
            at_wall(lambda rng: furniture_groups.work_place(rng, "office_chair", luck.has("desk lamp", 0.3))),
        ),
        ("reading place", 0.28, at_wall(lambda rng: furniture_groups.reading_place(rng, reader, lamp, small))),
        ("sideboard", 0.3 * storage, alone("console_table")),
        ("cabinet", 0.28 * storage, alone("cabinet")),
        ("bookshelf", books, alone("bookshelf")),
        ("wine cabinet", 0.14 * storage, alone("wine_cabinet")),
        ("shelf", 0.20 * storage, alone("shelf")),
        ("end table", 0.36 * storage, alone("round_end_table", 0.45)),
        ("ottoman", 0.18, alone("ottoman", 0.4)),
        ("stool", 0.20, alone("stool", 0.4)),
        ("floor lamp", 0.28, alone("floor_lamp", 0.3)),
        ("plant", 0.36, in_corner("plant")),
    )


def _bed(luck: Luck) -> Step:
    """A double bed free at both sides, a narrow one with its far side in a corner, or a sofa to sleep on."""
    category = luck.choose(
        "bed", {"double_bed": 0.74, "single_bed": 0.17, "kids_bed": 0.03, "bunk_bed": 0.02, "sofa_bed": 0.04}
    )
    # A sofa bed has none, so that the others have a little more.
    stands = int(luck.has("nightstand", OVERSAMPLED["bedroom", "nightstand"] / 0.96))
    lamps = luck.has("bedside lamps", 0.15)
    if category == "sofa_bed":
        return at_wall(furniture_groups.sofa_bed, 12)
    if category == "double_bed":
        stands *= 1 + int(luck.has("second nightstand", 0.85))

        def wide(room: Arrangement) -> bool:
            sides = (-1, 1) if room.rng.random() < 0.5 else (1, -1)
            return room.against_wall(furniture_groups.bed(room.rng, category, sides, stands, lamps)) is not None

        return wide

    def narrow(room: Arrangement) -> bool:
        side = 1 if room.rng.random() < 0.5 else -1
        return (
            room.against_wall(furniture_groups.bed(room.rng, category, (side,), stands, lamps), corner=-side)
            is not None
        )

    return narrow


def _lounge(luck: Luck) -> Step:
    """A sofa before a tv or at a wall, or two armchairs; a coffee table before them."""
    sofa = luck.choose(
        "sofa", {"multi_seat_sofa": 0.62, "l_shaped_sofa": 0.28, "loveseat_sofa": 0.07, "armchairs": 0.03}
    )
    tv = luck.has("tv stand", 0.76)
    table = luck.has("coffee table", OVERSAMPLED["living_room", "coffee_table"])
    chair = luck.choose("lounge seat", {"armchair": 0.85, "lounge_chair": 0.1, "lazy_sofa": 0.05})
    seats = (chair,) * (int(luck.has("lounge seats", 0.2)) * (1 + int(luck.has("two of them", 0.5))))
    end = luck.choose("sofa end", {"": 0.5, "side_table": 0.25, "round_end_table": 0.25})

    def before_tv(room: Arrangement) -> bool:
        for side in (int(index) for index in room.rng.permutation(len(room.shell.sides))):
            group = furniture_groups.lounge(room.rng, room.shell.sides[side].reach, sofa, seats, table)
            if group is not None and room.against_wall(group, [side], tries=6) is not None:
                return True
        return False

    def at_a_wall(room: Arrangement) -> bool:
        against = "multi_seat_sofa" if sofa == "l_shaped_sofa" else sofa
        return room.against_wall(furniture_groups.sofa_corner(room.rng, against, table, end or None)) is not None

    if sofa == "armchairs":
        return at_wall(furniture_groups.two_armchairs, 12)
    return before_tv if tv else at_a_wall


def _dining(seats: int, lamp: bool = False, spread: float = 0.85) -> Step:
    """A table with that many chairs (0: with benches) in the room, perhaps under a lamp."""

    def put(room: Arrangement) -> bool:
        rng = room.rng
        group = furniture_groups.dining(rng, seats) if seats else furniture_groups.dining_on_benches(rng)
        if not room.in_the_room(group, spread, tries=60):
            return False
        table = next(placed for placed in room.placed if placed.category == "dining_table")
        if lamp:
            size = size_of(rng, "pendant_lamp")
            hung = Item("pendant_lamp", 0.0, 0.0, size, 0.0, room.shell.height - size[1])
            room.add(hung, (table.position[0], table.position[2]), table.yaw)
        return True

    return put


def _one_of(luck: Luck, word: str, first: str, second: str) -> str | None:
    """One of two categories to half of the rooms, neither to the other half."""
    return luck.choose(word, {first: 0.25, second: 0.25, "": 0.5}) or None
