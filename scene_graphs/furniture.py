"""The words for furniture: categories, their classes and groups, generic kinds, and what a body can do with each.

The furniture we know: what stands in which class and group, what a body can do with it, how large it usually is.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Final, NamedTuple

Size = tuple[float, float, float]


class Entry(NamedTuple):
    """One category of furniture."""

    class_: str
    affordances: frozenset[str]
    size: Size
    """Usual width x, height y, depth z in metres."""


SEAT: Final = frozenset({"sit", "touch"})
COUCH: Final = frozenset({"sit", "lie", "touch"})
TOUCH: Final = frozenset({"touch"})
NONE: Final[frozenset[str]] = frozenset()

GROUP_OF_CLASS: Final = {
    "seat": "sit",
    "sofa": "sit",
    "bed": "bed",
    "table": "surface",
    "side": "surface",
    "closet": "storage",
    "shelf": "storage",
    "media": "media",
    "appliance": "appliance",
    "light": "light",
    "decor": "decor",
}
"""The tree that sets costs. Affordances are a property of their own and never decide a class."""

MINOR_GROUPS: Final = frozenset({"light", "decor"})
"""Objects "with minimal interaction possibilities, such as lamps or vases" (SIMS 3.2)."""

CATALOGUE: Final[dict[str, Entry]] = {
    "dining_chair": Entry("seat", SEAT, (0.47, 0.87, 0.54)),
    "armchair": Entry("seat", SEAT, (0.84, 0.86, 0.83)),
    "lounge_chair": Entry("seat", SEAT, (0.72, 0.84, 0.76)),
    "stool": Entry("seat", SEAT, (0.46, 0.46, 0.40)),
    "dressing_chair": Entry("seat", SEAT, (0.48, 0.80, 0.50)),
    "office_chair": Entry("seat", SEAT, (0.57, 0.94, 0.62)),
    "chinese_chair": Entry("seat", SEAT, (0.58, 0.98, 0.50)),
    "folding_chair": Entry("seat", SEAT, (0.45, 0.82, 0.50)),
    "barstool": Entry("seat", SEAT, (0.43, 0.76, 0.43)),
    "ottoman": Entry("seat", SEAT, (0.63, 0.43, 0.50)),
    "bench": Entry("seat", SEAT, (1.40, 0.46, 0.38)),
    "multi_seat_sofa": Entry("sofa", COUCH, (2.30, 0.85, 0.95)),
    "loveseat_sofa": Entry("sofa", SEAT, (1.62, 0.82, 0.89)),
    "l_shaped_sofa": Entry("sofa", COUCH, (2.60, 0.85, 1.65)),
    "chaise_longue_sofa": Entry("sofa", COUCH, (1.75, 0.80, 0.80)),
    "lazy_sofa": Entry("sofa", SEAT, (0.90, 0.75, 0.90)),
    "double_bed": Entry("bed", COUCH, (1.66, 0.95, 2.15)),
    "single_bed": Entry("bed", COUCH, (1.05, 0.90, 2.08)),
    "kids_bed": Entry("bed", COUCH, (1.00, 0.85, 1.90)),
    "bunk_bed": Entry("bed", COUCH, (1.10, 1.75, 2.10)),
    "sofa_bed": Entry("bed", COUCH, (1.90, 0.85, 1.00)),
    "dining_table": Entry("table", TOUCH, (1.60, 0.76, 0.95)),
    "coffee_table": Entry("table", SEAT, (1.15, 0.40, 0.65)),
    "desk": Entry("table", TOUCH, (1.40, 0.75, 0.62)),
    "console_table": Entry("table", TOUCH, (1.30, 0.85, 0.40)),
    "dressing_table": Entry("table", TOUCH, (1.10, 0.76, 0.45)),
    "kitchen_counter": Entry("table", TOUCH, (1.83, 0.94, 0.61)),
    "bar": Entry("table", TOUCH, (1.60, 1.05, 0.55)),
    "nightstand": Entry("side", TOUCH, (0.52, 0.52, 0.43)),
    "side_table": Entry("side", TOUCH, (0.50, 0.55, 0.50)),
    "corner_side_table": Entry("side", TOUCH, (0.50, 0.55, 0.50)),
    "round_end_table": Entry("side", TOUCH, (0.50, 0.55, 0.50)),
    "wardrobe": Entry("closet", TOUCH, (1.50, 2.10, 0.60)),
    "cabinet": Entry("closet", TOUCH, (1.10, 1.50, 0.42)),
    "children_cabinet": Entry("closet", TOUCH, (1.00, 1.20, 0.42)),
    "dresser": Entry("closet", TOUCH, (1.03, 0.95, 0.46)),
    "chest": Entry("closet", TOUCH, (0.95, 0.50, 0.50)),
    "shoe_cabinet": Entry("closet", TOUCH, (0.90, 1.00, 0.35)),
    "kitchen_cabinet": Entry("closet", TOUCH, (0.90, 0.90, 0.55)),
    "bathroom_cabinet": Entry("closet", TOUCH, (0.80, 0.85, 0.45)),
    "bookshelf": Entry("shelf", TOUCH, (0.95, 1.85, 0.33)),
    "shelf": Entry("shelf", TOUCH, (0.70, 1.60, 0.35)),
    "wine_cabinet": Entry("shelf", TOUCH, (0.90, 1.90, 0.40)),
    "wall_shelf": Entry("shelf", TOUCH, (0.80, 0.30, 0.25)),
    "tv_stand": Entry("media", TOUCH, (1.60, 0.52, 0.44)),
    "tv": Entry("media", TOUCH, (1.20, 0.70, 0.10)),
    "monitor": Entry("media", TOUCH, (0.60, 0.45, 0.20)),
    "refrigerator": Entry("appliance", TOUCH, (0.85, 1.80, 0.72)),
    "stove": Entry("appliance", TOUCH, (0.70, 0.92, 0.62)),
    "dishwasher": Entry("appliance", TOUCH, (0.60, 0.88, 0.60)),
    "washing_machine": Entry("appliance", TOUCH, (0.62, 0.88, 0.62)),
    "microwave": Entry("appliance", TOUCH, (0.52, 0.32, 0.40)),
    "pendant_lamp": Entry("light", NONE, (0.60, 0.60, 0.60)),
    "ceiling_lamp": Entry("light", NONE, (0.60, 0.25, 0.60)),
    "wall_lamp": Entry("light", NONE, (0.20, 0.30, 0.20)),
    "floor_lamp": Entry("light", TOUCH, (0.42, 1.60, 0.42)),
    "table_lamp": Entry("light", TOUCH, (0.30, 0.48, 0.30)),
    "vase": Entry("decor", NONE, (0.22, 0.40, 0.22)),
    "plant": Entry("decor", TOUCH, (0.50, 1.10, 0.50)),
    "picture": Entry("decor", NONE, (0.80, 0.60, 0.05)),
    "rug": Entry("decor", NONE, (2.20, 0.02, 1.60)),
    "mirror": Entry("decor", TOUCH, (0.60, 1.60, 0.08)),
    "curtain": Entry("decor", NONE, (1.40, 2.30, 0.12)),
    "clock": Entry("decor", NONE, (0.35, 0.35, 0.06)),
    "statue": Entry("decor", NONE, (0.30, 0.60, 0.30)),
    "trash_can": Entry("decor", NONE, (0.30, 0.40, 0.30)),
    "pet_bed": Entry("decor", NONE, (0.70, 0.20, 0.55)),
    "book": Entry("decor", NONE, (0.20, 0.04, 0.15)),
    "pillow": Entry("decor", NONE, (0.50, 0.15, 0.35)),
}

KINDS: Final[dict[str, tuple[str, ...]]] = {
    "chair": ("dining_chair", "office_chair", "lounge_chair", "dressing_chair", "chinese_chair", "folding_chair"),
    "sofa": ("multi_seat_sofa", "loveseat_sofa", "l_shaped_sofa", "chaise_longue_sofa"),
    "bed": ("double_bed", "single_bed", "kids_bed", "bunk_bed"),
    "table": ("dining_table", "coffee_table", "desk", "console_table", "dressing_table"),
    "lamp": ("floor_lamp", "table_lamp", "pendant_lamp", "ceiling_lamp", "wall_lamp"),
    "cabinet": ("cabinet", "children_cabinet", "dresser", "shoe_cabinet"),
    "shelf": ("shelf", "bookshelf", "wall_shelf"),
}
"""Generic words of scripts. The kinds inside one class must not share a category: the lower bound counts on it."""

ALIASES: Final = {
    "couch": "sofa",
    "settee": "sofa",
    "seat": "chair",
    "three_seat_sofa": "multi_seat_sofa",
    "sofa_multi_seat": "multi_seat_sofa",
    "loveseat": "loveseat_sofa",
    "two_seat_sofa": "loveseat_sofa",
    "l_shape_sofa": "l_shaped_sofa",
    "u_shaped_sofa": "l_shaped_sofa",
    "corner_sofa": "l_shaped_sofa",
    "sectional": "l_shaped_sofa",
    "sectional_sofa": "l_shaped_sofa",
    "chaise": "chaise_longue_sofa",
    "chaise_longue": "chaise_longue_sofa",
    "chaise_lounge": "chaise_longue_sofa",
    "daybed": "chaise_longue_sofa",
    "bean_bag": "lazy_sofa",
    "beanbag": "lazy_sofa",
    "couch_bed": "sofa_bed",
    "futon": "sofa_bed",
    "king_size_bed": "double_bed",
    "king_bed": "double_bed",
    "queen_bed": "double_bed",
    "bed_frame": "single_bed",
    "childrens_bed": "kids_bed",
    "easy_chair": "armchair",
    "recliner": "armchair",
    "rocking_chair": "armchair",
    "cafe_chair": "lounge_chair",
    "lounge_chair_cafe_chair_office_chair": "lounge_chair",
    "lounge_chair/cafe_chair/office_chair": "lounge_chair",
    "desk_chair": "office_chair",
    "computer_chair": "office_chair",
    "swivel_chair": "office_chair",
    "study_chair": "office_chair",
    "kitchen_chair": "dining_chair",
    "vanity_chair": "dressing_chair",
    "classic_chinese_chair": "chinese_chair",
    "hanging_chair": "lounge_chair",
    "bar_stool": "barstool",
    "footstool": "stool",
    "footrest": "ottoman",
    "pouf": "ottoman",
    "sofastool": "ottoman",
    "bed_end_stool": "bench",
    "footstool/sofastool/bed_end_stool/stool": "stool",
    "dinner_table": "dining_table",
    "kitchen_table": "dining_table",
    "tea_table": "coffee_table",
    "writing_desk": "desk",
    "study_desk": "desk",
    "computer_desk": "desk",
    "work_table": "desk",
    "vanity": "dressing_table",
    "vanity_table": "dressing_table",
    "makeup_table": "dressing_table",
    "sideboard": "console_table",
    "side_cabinet": "console_table",
    "sideboard/side_cabinet/console_table": "console_table",
    "console": "console_table",
    "counter": "kitchen_counter",
    "countertop": "kitchen_counter",
    "bedside_table": "nightstand",
    "night_table": "nightstand",
    "night_stand": "nightstand",
    "end_table": "side_table",
    "closet": "wardrobe",
    "armoire": "wardrobe",
    "drawer": "dresser",
    "drawers": "dresser",
    "chest_of_drawers": "dresser",
    "drawer_chest": "cabinet",
    "corner_cabinet": "cabinet",
    "drawer_chest/corner_cabinet": "cabinet",
    "cupboard": "cabinet",
    "trunk": "chest",
    "bookcase": "bookshelf",
    "bookcase/jewelry_armoire": "bookshelf",
    "wine_rack": "wine_cabinet",
    "tv_cabinet": "tv_stand",
    "television_stand": "tv_stand",
    "television": "tv",
    "fridge": "refrigerator",
    "oven": "stove",
    "light": "lamp",
    "chandelier": "pendant_lamp",
    "bedside_lamp": "table_lamp",
    "desk_lamp": "table_lamp",
    "standing_lamp": "floor_lamp",
    "houseplant": "plant",
    "potted_plant": "plant",
    "painting": "picture",
    "carpet": "rug",
    "bin": "trash_can",
    "wastebasket": "trash_can",
}

DISPLAY_NAMES: Final = {
    "multi_seat_sofa": "sofa",
    "loveseat_sofa": "loveseat",
    "l_shaped_sofa": "corner sofa",
    "chaise_longue_sofa": "chaise longue",
    "lazy_sofa": "bean bag",
    "kids_bed": "children's bed",
    "children_cabinet": "children's cabinet",
    "tv_stand": "TV stand",
    "tv": "TV",
    "corner_side_table": "side table",
    "round_end_table": "end table",
}
"""Categories whose slug does not read as a person would say it."""


ROOM_TYPES: Final = ("bedroom", "living_room", "dining_room", "study")
AFFORDANCES: Final = ("sit", "lie", "touch")

remembered: Final = lru_cache(maxsize=1 << 14)
"""Words come from users too: what is remembered of them is bounded."""
_ROOM_WORDS: Final = {"library": "study", "office": "study", "living": "living_room", "lounge": "living_room"}
_UNKNOWN_SIZE: Final[Size] = (0.6, 0.8, 0.5)
_PLURALS: Final = (("ves", "f"), ("ies", "y"), ("es", ""), ("s", ""))
_CLASS_OF: Final = {kind: CATALOGUE[members[0]].class_ for kind, members in KINDS.items()} | {
    category: entry.class_ for category, entry in CATALOGUE.items()
}


class Furniture(NamedTuple):
    """A node of a furniture graph, "(c, i), where the first number represents the category and the second the
    instance" (SIMS 3.2)."""

    category: str
    """A category, a generic kind, or a word we do not know."""
    instance: int = 1


@remembered
def canonical(word: str) -> str:
    """The category or generic kind a word means ("Couches" -> "sofa"), or its slug where we know neither.

    Tries aliases and plurals first, then drops leading words, so that "big wooden chair" is a chair.
    """
    slug = _slug(word)
    words = slug.split("_")
    for start in range(len(words)):
        if (known := _known_word("_".join(words[start:]))) is not None:
            return known
    return slug


def canonical_room(word: str) -> str:
    """The room type a word means ("Library" -> "study"), or its slug where it is none of `ROOM_TYPES`."""
    slug = _slug(word)
    return _ROOM_WORDS.get(slug, slug)


def is_known(word: str) -> bool:
    """Whether the word means a category or a generic kind."""
    return canonical(word) in _CLASS_OF


@remembered
def categories_of(word: str) -> frozenset[str]:
    """The categories a word names exactly: several for a generic kind, else the category itself."""
    name = canonical(word)
    return frozenset(KINDS.get(name, (name,)))


@remembered
def class_of(category: str) -> str:
    """The class, inside which furniture stands in for other furniture; an unknown word is a class of its own."""
    name = canonical(category)
    return _CLASS_OF.get(name, name)


@remembered
def group_of(category: str) -> str:
    """The group, outside which nothing is ever substituted; an unknown word is a group of its own."""
    class_ = class_of(category)
    return GROUP_OF_CLASS.get(class_, class_)


def is_minor(category: str) -> bool:
    """Whether the graph counts it as a less important node (SIMS 3.2)."""
    return group_of(category) in MINOR_GROUPS


@remembered
def affordances(category: str) -> frozenset[str]:
    """What a body can usually do there, out of `AFFORDANCES`; for a kind, what at least one of it offers.

    An unknown object can at least be touched.
    """
    name = canonical(category)
    if name not in _CLASS_OF:
        return TOUCH
    return NONE.union(*(CATALOGUE[member].affordances for member in categories_of(name)))


def typical_size(category: str) -> Size:
    """Usual (width, height, depth) in metres; of a kind, that of its first category."""
    name = canonical(category)
    entry = CATALOGUE.get(KINDS.get(name, (name,))[0])
    return entry.size if entry else _UNKNOWN_SIZE


def display_name(word: str) -> str:
    """The name as a person would say it: "dining chair", "TV stand"."""
    name = canonical(word)
    return DISPLAY_NAMES.get(name, name.replace("_", " "))


def _slug(word: str) -> str:
    return re.sub(r"[\s_\-]+", "_", re.sub(r"\s*/\s*", "/", word.strip().lower().replace("'", ""))).strip("_")


def _known_word(slug: str) -> str | None:
    """The category or kind this very slug names, in singular or plural."""
    for ending, singular in (("", ""), *_PLURALS):
        if slug.endswith(ending):
            stem = slug[: len(slug) - len(ending)] + singular
            name = ALIASES.get(stem, stem)
            if name in _CLASS_OF:
                return name
    return None
