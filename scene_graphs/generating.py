"""Seeded procedural rooms: the layouts we ship, and as many more as one wants."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scene_graphs.arranging.arrangement import Arrangement
from scene_graphs.arranging.finishing import finish
from scene_graphs.arranging.recipes import FOOTAGE, RECIPES
from scene_graphs.arranging.shell import build_shell
from scene_graphs.checking import RoomCheck
from scene_graphs.furniture import ROOM_TYPES, categories_of
from scene_graphs.layouts import Layout, Placed

ATTEMPTS = 200
_ESSENTIAL = {
    "bedroom": ("bed",),
    "living_room": ("sofa", "coffee_table"),
    "dining_room": ("dining_table", "dining_chair"),
    "study": ("desk", "chair"),
}
_LEAST_PIECES = 4


def generate_room(room_type: str, seed: int) -> Layout:
    """A furnished rectangular room of one of `ROOM_TYPES`; the same type and seed give the same room.

    Nothing overlaps or blocks a door, and everything to sit, lie or touch can be walked to from the door
    (`checking.validate` finds nothing). ValueError for another room type.
    """
    if room_type not in RECIPES:
        raise ValueError(f"room_type must be one of {', '.join(RECIPES)}, got {room_type!r}")
    if seed < 0:
        raise ValueError(f"seed must not be negative, got {seed}")
    rng = np.random.default_rng([seed, ROOM_TYPES.index(room_type)])
    for _ in range(ATTEMPTS):
        layout = _try_room(rng, room_type, f"{room_type.replace('_', '-')}-{seed:04d}")
        if layout is not None:
            return layout
    raise RuntimeError(f"no {room_type} came out of seed {seed} in {ATTEMPTS} attempts; take another seed")


def generate_library(count: int, seed: int = 0) -> list[Layout]:
    """`count` rooms, the types in turn, seeds counting up from `seed`: a longer library begins with a shorter one."""
    return [generate_room(ROOM_TYPES[i % len(ROOM_TYPES)], seed + i // len(ROOM_TYPES)) for i in range(count)]


def _try_room(rng: np.random.Generator, room_type: str, name: str) -> Layout | None:
    """One attempt: furnish a shell, then take away what nobody can use; None if the essentials do not stay."""
    shell = build_shell(rng, *FOOTAGE[room_type])
    room = Arrangement(shell, rng)
    if not RECIPES[room_type](room):
        return None
    finish(room)
    layout = Layout(
        id=name,
        room_type=room_type,
        floor_polygon=shell.outline,
        height=shell.height,
        doors=shell.door_openings(),
        windows=shell.window_openings(),
        objects=tuple(room.placed),
    )
    for _ in range(6):
        check = RoomCheck(layout)
        if not _has_essentials(layout):
            return None
        useless = {object_id for object_id, _ in check.unreachable()}
        if not useless:
            return None if check.problems() else replace(layout, tags=_tags(layout))
        # A coffee table stays without its armchair, but goes with its sofa.
        for group in room.groups:
            useless |= set(group) if group[0] in useless else set()
        layout = replace(layout, objects=_without(layout.objects, useless))
    return None


def _without(objects: tuple[Placed, ...], names: set[str]) -> tuple[Placed, ...]:
    """The objects left when those of these names go, with what stands on them."""
    return tuple(placed for placed in objects if placed.id not in names and placed.parent not in names)


def _has_essentials(layout: Layout) -> bool:
    there = {placed.category for placed in layout.objects}
    chairs = sum(placed.category == "dining_chair" for placed in layout.objects)
    if layout.room_type == "dining_room" and chairs < 4:
        return False
    standing = [
        placed for placed in layout.objects if placed.parent is None and 0.1 < placed.size[1] < placed.top + 0.1
    ]
    on_floor = [placed for placed in standing if placed.position[1] == 0.0]
    return len(on_floor) >= _LEAST_PIECES and all(categories_of(word) & there for word in _ESSENTIAL[layout.room_type])


def _tags(layout: Layout) -> tuple[str, ...]:
    """Every room type the layout can serve: a table with two chairs also dines, a desk with a chair also works."""
    there = [placed.category for placed in layout.objects]
    tags = [layout.room_type]
    if "dining_table" in there and there.count("dining_chair") >= 2 and layout.room_type == "living_room":
        tags.append("dining_room")
    if "desk" in there and categories_of("chair") & set(there) and layout.room_type != "study":
        tags.append("study")
    return tuple(tags)
