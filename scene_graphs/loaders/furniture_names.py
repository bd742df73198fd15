"""What the names in scene files mean: models ("TV_Stand_212_1"), nodes ("SofaLeft.001"), and what a room serves.

The exact category of what a source only calls "bed" or "sofa", by its box.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from functools import cache
from typing import Final

from scene_graphs.boxes import Point3
from scene_graphs.furniture import ROOM_TYPES, canonical, catalogue, class_of, group_of, is_known

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
    "dustbin": "trash_can",
    "wastepaper_basket": "trash_can",
    "trash": "trash_can",
    "laundry_bin": "hamper",
    "toy_bin": "chest",
    "storage_bin": "chest",
    "bread_bin": "bread_box",
    "drape": "curtain",
    "drapes": "curtain",
    "blinds": "curtain",
    "tv_unit": "tv_stand",
    "flower_bed": "plant",
    "car_seat": "car_seat",
    "toilet_seat": "toilet",
    "wall_decor_photo": "picture",
    "laundry_hamper": "hamper",
}
"""Compounds that are no kind of what their last word names, or whose last word says nothing."""
_MAKES: Final = (
    ("bedroom", ("bed",)),
    ("bathroom", ("toilet", "bathtub", "shower")),
    ("living_room", ("sofa",)),
    ("kitchen", ("refrigerator", "stove", "kitchen_counter", "kitchen_cabinet", "dishwasher")),
    ("study", ("desk",)),
    ("dining_room", ("dining_table",)),
)
"""What makes a room of a type, categories, classes or groups; the first row that fits counts."""
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
        compound = _NOT_WHAT_THEY_END_IN.get("_".join(words[start:])) or _unbroken().get("".join(words[start:]))
        if compound is not None:
            return compound
    return canonical("_".join(words))


@cache
def _unbroken() -> dict[str, str]:
    """What we know, written as one word: "armchair", "coffeetable"."""
    known = catalogue()
    names = (*known.categories, *known.kinds, *known.aliases)
    return {name.replace("_", ""): canonical(name) for name in names}


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
    there = {word for category in categories for word in (category, class_of(category), group_of(category))}
    return next((room_type for room_type, making in _MAKES if not there.isdisjoint(making)), "room")


SINGLE, LOVESEAT, CORNER = 1.30, 1.85, 1.60
"""A bed narrower than the first is single, a sofa narrower than the second a loveseat; one that is as deep as the third
has a corner. Metres."""
BARSTOOL, LOW, SMALL = 0.62, 0.55, 0.70
"""A stool this high is a barstool; a table lower than the second or narrower than the third is none to sit at."""
_HANGS, _STANDS = 1.4, 0.9


def exact_category(word: str, size: Point3, bottom: float = 0.0) -> str:
    """The category of a piece that has a generic name, its size [w, h, d] in metres and how high its bottom is.

    Any other word stays as it is.
    """
    short, height, long = min(size[0], size[2]), size[1], max(size[0], size[2])
    match word:
        case "bed":
            return "single_bed" if short < SINGLE else "double_bed"
        case "sofa":
            return "l_shaped_sofa" if short >= CORNER else "loveseat_sofa" if long < LOVESEAT else "multi_seat_sofa"
        case "chair":
            return "dining_chair"
        case "stool":
            return "barstool" if height >= BARSTOOL else "stool"
        case "table":
            return "side_table" if long <= SMALL else "coffee_table" if height < LOW else "dining_table"
        case "lamp":
            return "ceiling_lamp" if bottom > _HANGS else "floor_lamp" if height >= _STANDS else "table_lamp"
    return word
