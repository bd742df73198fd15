"""What each type of room is furnished with, in the order it is put in; shares follow real rooms (scene-formats 2.4).

Studies, nightstands, wardrobes and coffee tables are more frequent than in the data, since stories ask for them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from scene_graphs.arranging import groups
from scene_graphs.arranging.arrangement import Arrangement, Group, Item

Recipe = Callable[[Arrangement], bool]
"""Furnishes a room; False if something the room cannot do without found no place."""

FOOTAGE: dict[str, tuple[tuple[float, float], tuple[float, float]]] = {
    "bedroom": ((3.4, 3.6), (5.0, 5.2)),
    "living_room": ((4.2, 4.4), (6.6, 6.4)),
    "dining_room": ((4.0, 3.9), (5.8, 5.4)),
    "study": ((3.3, 3.3), (5.0, 4.8)),
}
"""Least and greatest (width, depth) of each room type, in metres."""


def bedroom(room: Arrangement) -> bool:
    """A bed with nightstands, then storage, a place to dress, work or rest, as far as there is space."""
    rng = room.rng
    if not _bed(room):
        return False
    if _chance(rng, 0.9) and room.against_wall(groups.standing_alone(rng, "wardrobe")) is None:
        room.against_wall(groups.standing_alone(rng, "wardrobe"))
    extras = (
        (0.75, groups.dressing_place),
        (0.50, groups.reading_place),
        (0.28, lambda r: groups.work_place(r, "dining_chair")),
        (0.35, _tv_on_its_stand),
        (0.35, lambda r: groups.standing_alone(r, "dresser")),
        (0.25, lambda r: groups.standing_alone(r, "bookshelf")),
        (0.35, lambda r: groups.standing_alone(r, "cabinet")),
        (0.15, lambda r: groups.standing_alone(r, "shelf")),
        (0.12, lambda r: groups.standing_alone(r, "loveseat_sofa")),
        (0.20, lambda r: groups.standing_alone(r, "stool", 0.4)),
        (0.20, lambda r: groups.standing_alone(r, "mirror", 0.6)),
    )
    _add_some(room, extras)
    return True


def living_room(room: Arrangement) -> bool:
    """A sofa with its coffee table, mostly before a tv, then seats and storage along the walls."""
    rng = room.rng
    if not _lounge(room):
        return False
    extras = (
        (0.55, groups.reading_place),
        (0.35, lambda r: groups.standing_alone(r, "loveseat_sofa")),
        (0.70, lambda r: groups.standing_alone(r, "bookshelf")),
        (0.70, lambda r: groups.standing_alone(r, "cabinet")),
        (0.30, lambda r: groups.standing_alone(r, "console_table")),
        (0.30, lambda r: groups.standing_alone(r, "shelf")),
        (0.20, lambda r: groups.standing_alone(r, "floor_lamp", 0.3)),
        (0.20, lambda r: groups.standing_alone(r, "wardrobe")),
        (0.15, groups.work_place),
        (0.25, lambda r: groups.standing_alone(r, str(r.choice(["ottoman", "stool", "bench"])), 0.4)),
    )
    _add_some(room, extras)
    if _chance(rng, 0.35):
        room.in_the_room(groups.dining(rng, int(rng.choice([2, 4]))), spread=2.2)
    return True


def dining_room(room: Arrangement) -> bool:
    """A table with chairs pulled out, under a lamp; sideboards and cabinets along the walls."""
    rng = room.rng
    seats = int(rng.choice([4, 4, 4, 5, 6]))
    if not room.in_the_room(groups.dining(rng, seats), spread=0.35):
        return False
    table = room.placed[0]
    lamp = groups.size_of(rng, "pendant_lamp")
    room.add(Item("pendant_lamp", 0.0, 0.0, lamp, 0.0, room.shell.height - lamp[1]), _plan(table.position), table.yaw)
    extras = (
        (0.70, lambda r: groups.standing_alone(r, "console_table", 0.45)),
        (0.55, lambda r: groups.standing_alone(r, "cabinet", 0.5)),
        (0.35, lambda r: groups.standing_alone(r, "wine_cabinet", 0.5)),
        (0.40, lambda r: groups.standing_alone(r, "shelf", 0.45)),
        (0.25, lambda r: groups.standing_alone(r, "bookshelf", 0.45)),
        (0.35, groups.reading_place),
        (0.15, lambda r: groups.standing_alone(r, "loveseat_sofa")),
        (0.25, lambda r: groups.standing_alone(r, "floor_lamp", 0.3)),
        (0.15, lambda r: groups.standing_alone(r, "refrigerator")),
        (0.25, lambda r: groups.standing_alone(r, "stool", 0.35)),
    )
    _add_some(room, extras)
    return True


def study(room: Arrangement) -> bool:
    """A desk with its chair, books, and often somewhere softer to read."""
    rng = room.rng
    grand = _chance(rng, 0.3) and room.against_wall(groups.free_desk(rng)) is not None
    if not grand and room.against_wall(groups.work_place(rng)) is None:
        return False
    extras = (
        (0.85, lambda r: groups.standing_alone(r, "bookshelf")),
        (0.60, groups.reading_place),
        (0.40, lambda r: groups.standing_alone(r, "bookshelf")),
        (0.22, lambda r: groups.sofa_corner(r, "multi_seat_sofa")),
        (0.18, lambda r: groups.sofa_corner(r, "loveseat_sofa")),
        (0.15, lambda r: groups.standing_alone(r, "chaise_longue_sofa", 0.6)),
        (0.40, lambda r: groups.standing_alone(r, "cabinet")),
        (0.25, lambda r: groups.standing_alone(r, "shelf")),
        (0.20, lambda r: groups.standing_alone(r, "wardrobe")),
        (0.20, lambda r: groups.standing_alone(r, "floor_lamp", 0.3)),
        (0.25, lambda r: groups.standing_alone(r, "stool", 0.35)),
        (0.15, lambda r: groups.standing_alone(r, "dining_chair", 0.6)),
    )
    _add_some(room, extras)
    return True


RECIPES: dict[str, Recipe] = {
    "bedroom": bedroom,
    "living_room": living_room,
    "dining_room": dining_room,
    "study": study,
}


def _bed(room: Arrangement) -> bool:
    """A double bed free at both sides, or a narrow one with its far side in a corner."""
    rng = room.rng
    if _chance(rng, 0.68):
        if room.against_wall(groups.bed(rng, "double_bed"), _windowless(room)) is not None:
            return True
        return room.against_wall(groups.bed(rng, "double_bed", (1,))) is not None
    category = str(rng.choice(["single_bed", "single_bed", "single_bed", "kids_bed", "bunk_bed"]))
    free_side = 1 if _chance(rng, 0.5) else -1
    return room.against_wall(groups.bed(rng, category, (free_side,)), corner=-free_side) is not None


def _lounge(room: Arrangement) -> bool:
    rng = room.rng
    sofa = str(rng.choice(["multi_seat_sofa", "l_shaped_sofa", "loveseat_sofa"], p=[0.58, 0.28, 0.14]))
    if _chance(rng, 0.82):
        for side in (int(index) for index in rng.permutation(4)):
            for _ in range(3):
                group = groups.lounge(rng, room.shell.sides[side].reach, sofa)
                if group is not None and room.against_wall(group, [side], tries=6) is not None:
                    return True
    against = "multi_seat_sofa" if sofa == "l_shaped_sofa" else sofa
    return room.against_wall(groups.sofa_corner(rng, against)) is not None


def _tv_on_its_stand(rng: np.random.Generator) -> Group:
    stand, tv = groups.size_of(rng, "tv_stand"), groups.size_of(rng, "tv")
    z = stand[2] / 2 + groups.BEHIND
    items = (Item("tv_stand", 0.0, z, stand), Item("tv", 0.0, z, tv, 0.0, stand[1], 0))
    return Group(items, ((-stand[0] / 2, stand[0] / 2, stand[2], stand[2] + 0.7),))


def _add_some(room: Arrangement, extras: tuple[tuple[float, Callable[[np.random.Generator], Group]], ...]) -> None:
    """Try each group with its own chance, in random order, so that none always gets the last free wall."""
    for index in room.rng.permutation(len(extras)):
        share, build = extras[int(index)]
        if _chance(room.rng, share):
            room.against_wall(build(room.rng), tries=8)


def _windowless(room: Arrangement) -> list[int]:
    """The walls in random order, those without a window first: a headboard hides one."""
    order = [int(side) for side in room.rng.permutation(4)]
    with_window = {side for side, _, _ in room.shell.windows}
    return sorted(order, key=lambda side: side in with_window)


def _chance(rng: np.random.Generator, share: float) -> bool:
    return bool(rng.random() < share)


def _plan(position: tuple[float, float, float]) -> tuple[float, float]:
    return (position[0], position[2])
