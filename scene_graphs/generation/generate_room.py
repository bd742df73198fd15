"""Seeded procedural rooms: the layouts we ship, and as many more as one wants."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial

import numpy as np

from scene_graphs.affordances.room_validation import RoomCheck
from scene_graphs.furniture import ROOM_TYPES, categories_of
from scene_graphs.generation.furniture_placement import Arrangement
from scene_graphs.generation.random_choices import Luck
from scene_graphs.generation.room_decor import finish
from scene_graphs.generation.room_recipes import furnished, recipe_of
from scene_graphs.generation.room_shell import build_shell
from scene_graphs.layout import Layout

ATTEMPTS = 200
GROWTH = 0.012
"""How much larger a room is tried each time its furniture found no place."""
CHUNK = 20
"""Rooms a process is asked for at once."""
DINERS = 4
"""Chairs at a table from which on a living room also serves as a dining room."""


def generate_room(room_type: str, seed: int) -> Layout:
    """A furnished room of one of `ROOM_TYPES`, some of them L-shaped; the same type and seed give the same room.

    Of odd seeds living rooms also dine and dining rooms have a kitchen. What falls to a room follows real rooms
    (`room_recipes`) within every `random_choices.BLOCK` seeds. Nothing overlaps or blocks a door, and everything to
    sit, lie or touch can be walked to from the door (`RoomCheck.problems` finds nothing). ValueError for another room
    type.
    """
    if room_type not in ROOM_TYPES:
        raise ValueError(f"room_type must be one of {', '.join(ROOM_TYPES)}, got {room_type!r}")
    if seed < 0:
        raise ValueError(f"seed must not be negative, got {seed}")
    luck = luck_of(room_type, seed)
    rng = np.random.default_rng([seed, ROOM_TYPES.index(room_type)])
    for attempt in range(ATTEMPTS):
        layout = _try_room(rng, room_type, luck, 1 + GROWTH * attempt)
        if layout is not None:
            return replace(layout, id=f"{room_type.replace('_', '-')}-{seed:04d}", tags=_tags(layout))
    raise RuntimeError(f"no {room_type} came out of seed {seed} in {ATTEMPTS} attempts; take another seed")


def generate_library(count: int, seed: int = 0) -> list[Layout]:
    """`count` rooms, the types in turn, seeds counting up from `seed`: a longer library begins with a shorter one."""
    return list(generate_rooms(count, seed))


def generate_rooms(count: int, seed: int = 0, processes: int = 1) -> Iterator[Layout]:
    """The rooms of `generate_library` one after the other, made by that many processes at once."""
    make = partial(_library_room, seed)
    if processes == 1:
        yield from map(make, range(count))
        return
    with ProcessPoolExecutor(processes) as pool:
        yield from pool.map(make, range(count), chunksize=CHUNK)


def luck_of(room_type: str, seed: int) -> Luck:
    """What falls to the room of that type and seed."""
    if room_type == "living_room":
        return Luck("living_dining" if seed % 2 else "living_room", seed // 2)
    if room_type == "dining_room" and seed % 2:
        return Luck("kitchen_diner", seed // 2)
    return Luck(room_type, seed)


def _library_room(seed: int, index: int) -> Layout:
    return generate_room(ROOM_TYPES[index % len(ROOM_TYPES)], seed + index // len(ROOM_TYPES))


def _try_room(rng: np.random.Generator, room_type: str, luck: Luck, growth: float) -> Layout | None:
    """One attempt to find a place for everything that falls to the room, where it can be used."""
    steps, recipe = furnished(luck), recipe_of(luck.kind)
    area = growth * (recipe.floor_m2 + recipe.floor_per_extra_m2 * len(steps)) * float(rng.uniform(0.9, 1.15))
    shell = build_shell(rng, area, luck.has("L shape", recipe.l_shaped_share))
    room = Arrangement(shell, rng)
    if not all(step(room) for step in steps):
        return None
    finish(room, luck)
    layout = Layout(
        id="",
        room_type=room_type,
        floor_polygon=shell.outline,
        height=shell.height,
        doors=shell.door_openings(),
        windows=shell.window_openings(),
        objects=tuple(room.placed),
    )
    return None if RoomCheck(layout).problems() else layout


def _tags(layout: Layout) -> tuple[str, ...]:
    """Every room type the layout can serve: a table with four chairs also dines, a desk with a chair also works."""
    there = [placed.category for placed in layout.objects]
    tags = [layout.room_type]
    if "dining_table" in there and there.count("dining_chair") >= DINERS and layout.room_type == "living_room":
        tags.append("dining_room")
    if "desk" in there and categories_of("chair") & set(there) and layout.room_type != "study":
        tags.append("study")
    return tuple(tags)
