"""What the names in scene files mean: models ("TV_Stand_212_1"), nodes ("SofaLeft.001"), and what a room serves."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Final

from scene_graphs.catalogue import ALIASES, CATALOGUE, KINDS
from scene_graphs.furniture import ROOM_TYPES, canonical, class_of, group_of, is_known

MAX_NAME_LENGTH: Final = 200
_HUMPS: Final = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
_BREAKS: Final = re.compile(r"[^A-Za-z]+")
_NOISE: Final = frozenset(
    (
        *("mesh", "geo", "geometry", "model", "object", "obj", "node", "group", "grp", "instance", "inst", "copy"),
        *("lod", "high", "low", "poly", "prim", "primitive", "merged", "combined", "default", "static", "root"),
        *("left", "right", "big", "small"),
    )
)
"""Words that say nothing of what a thing is."""
_NOT_WHAT_THEY_END_IN: Final = {
    "dog_bed": "pet_bed",
    "cat_bed": "pet_bed",
    "soap_bar": "soap",
    "bar_soap": "soap",
    "towel_bar": "towel_holder",
    "shelving_unit": "bookshelf",
    "garbage_can": "trash_can",
    "tv_unit": "tv_stand",
    "flower_bed": "plant",
    "car_seat": "car_seat",
    "toilet_seat": "toilet",
    "wall_decor_photo": "picture",
    "laundry_hamper": "hamper",
}
"""Compounds that are no kind of what their last word names, or whose last word says nothing."""
_UNBROKEN: Final = {name.replace("_", ""): canonical(name) for name in (*CATALOGUE, *KINDS, *ALIASES)}
"""What we know, written as one word: "armchair", "coffeetable"."""
_KITCHEN: Final = frozenset({"refrigerator", "stove", "kitchen_counter", "kitchen_cabinet", "dishwasher"})
_BATHROOM: Final = frozenset({"toilet", "bathtub", "shower"})
_NOT_AT_A_TABLE: Final = frozenset({"armchair", "lounge_chair", "lazy_sofa", "barstool", "ottoman"})


def words_of(name: str) -> str:
    """The words of a name in small letters with "_" between: "DiningTable.001" -> "dining_table"."""
    spaced = _BREAKS.sub("_", _HUMPS.sub("_", name[:MAX_NAME_LENGTH]))
    words = [word for word in spaced.lower().split("_") if word]
    while words and (len(words[-1]) == 1 or words[-1] in _NOISE):
        words.pop()
    return "_".join(words)


def meaning(name: str) -> str:
    """The category or kind a name in a scene file means, else its words: "Floor_Lamp_5" -> "floor_lamp".

    It does not matter where a name is broken into words ("arm chair", "coffeetable").
    """
    words = words_of(name).split("_")
    for start in range(len(words)):
        compound = _NOT_WHAT_THEY_END_IN.get("_".join(words[start:])) or _UNBROKEN.get("".join(words[start:]))
        if compound is not None:
            return compound
    return canonical("_".join(words))


def furniture_named(name: str) -> str | None:
    """The category or kind a name means, or None where we know none such."""
    word = meaning(name)
    return word if is_known(word) else None


def rooms_served(room_type: str, categories: Collection[str]) -> tuple[str, ...]:
    """Every room type a room can serve, its own first.

    A dining table with two seats that stand at tables makes a dining room (but not of a bedroom), a desk with a seat
    a study.
    """
    seats = [category for category in categories if class_of(category) == "seat"]
    at_table = [seat for seat in seats if seat not in _NOT_AT_A_TABLE]
    served = [room_type]
    if room_type != "bedroom" and "dining_table" in categories and len(at_table) >= 2:
        served.append("dining_room")
    if seats and "desk" in categories:
        served.append("study")
    return tuple(dict.fromkeys(served))


def likely_room(name: str, categories: Collection[str]) -> str:
    """The room type that a file's name says ("my_bedroom_2"), else the one its furniture makes likeliest."""
    words = words_of(name)
    for room_type in (*ROOM_TYPES, "kitchen", "bathroom"):
        if room_type in words or room_type.replace("_", "") in words:
            return room_type
    if any(group_of(category) == "bed" for category in categories):
        return "bedroom"
    if not _BATHROOM.isdisjoint(categories):
        return "bathroom"
    if any(class_of(category) == "sofa" for category in categories):
        return "living_room"
    if not _KITCHEN.isdisjoint(categories):
        return "kitchen"
    return "study" if "desk" in categories else "dining_room" if "dining_table" in categories else "room"
