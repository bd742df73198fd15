"""Small things people take in hand at home, and the furniture they are usually kept on or in."""

from __future__ import annotations

import re
from typing import Final

from planner_service.tasks.deeds import STORES, TABLES

_TABLETOP: Final = "coffee table, dining table, side table, nightstand, desk, table"
KEPT: Final = {
    "remote|remote control|controller|gamepad|joystick": "coffee table, TV stand, side table, table, cabinet, shelf",
    "book|novel|album|comic|notebook|diary|dictionary": "bookshelf, shelf, nightstand, desk, coffee table, table",
    "newspaper|magazine|letter|mail|paper|map": "coffee table, desk, dining table, side table, table, shelf",
    "pen|pencil|brush|scissors|ruler": "desk, table, console table, cabinet, shelf",
    "phone|cellphone|mobile|smartphone|telephone|tablet": "nightstand, " + _TABLETOP + ", TV stand, console table",
    "cup|mug|glass|teacup|bottle|teapot|kettle|jug": "kitchen cabinet, kitchen counter, dining table, coffee table, "
    "cabinet, wine cabinet, console table, bar, table, desk, nightstand",
    "plate|bowl|dish|fork|spoon|knife|pan|pot|tray": "kitchen cabinet, kitchen counter, dining table, cabinet, "
    "console table, coffee table, table, desk",
    "apple|banana|orange|fruit|sandwich|bread|cake|cookie|snack|pizza|food|egg|milk|juice|beer": "refrigerator, "
    "kitchen counter, dining table, coffee table, cabinet, table, desk",
    "wine": "wine cabinet, cabinet, dining table, coffee table, console table, table",
    "headphones|headset|laptop|keyboard|mouse|computer": "desk, coffee table, dining table, nightstand, table, shelf",
    "toothbrush|comb|towel|soap|hairbrush|razor": "bathroom cabinet, dressing table, dresser, cabinet, wardrobe",
    "cloth|rag|sponge|duster|broom|vacuum": "kitchen cabinet, cabinet, console table, dresser, shelf, " + STORES,
    "watering can": "cabinet, shelf, console table, kitchen counter, table",
    "clothes|shirt|coat|jacket|dress|suit|hat|scarf|bag|shoe": "wardrobe, dresser, shoe cabinet, cabinet, chair",
    "blanket|pillow|cushion|toy|teddy bear": "bed, sofa, armchair, wardrobe, chest",
    "guitar|violin|trumpet|instrument": "shelf, cabinet, sofa, wardrobe, bed, table",
    "camera|photo|key|wallet|purse|umbrella|glasses": "shelf, cabinet, console table, nightstand, desk, table",
}
"""Things between bars, with the furniture where they are looked for, the likeliest first."""
VESSELS: Final = {
    "water|juice|milk|wine|lemonade|whisky": "glass",
    "beer|cola|soda|bottle": "bottle",
    "glass|mug|bottle|teacup|cup": "=",
    "soup|cereal|salad|porridge|noodles|bowl": "bowl",
    "apple|banana|orange|fruit|sandwich|bread|cake|cookie|snack|pizza": "=",
}
"""What food and drink come in, "=" for what is taken in hand itself."""
FIXED: Final = "door|window|curtain|blind|tap|faucet|sink|shower|bathtub|toilet|gate|stair|wall|ceiling"
"""What belongs to the house: no body finds a surface there, since homes do not have them as furniture."""
ANYWHERE: Final = TABLES + ", " + STORES


def kept_at(thing: str) -> tuple[str, ...]:
    """Furniture where a thing is looked for, the likeliest first; anything may lie on a table."""
    found = next((where for names, where in KEPT.items() if is_one(thing, names)), ANYWHERE)
    return words(f"{found}, {TABLES}")


def vessel_of(content: str, usual: str) -> str:
    """What one holds to drink or eat it: "glass" for water, the apple itself; `usual` where nothing is known."""
    head = content.split(" of ")[0]
    for part in (head, content):
        for names, vessel in VESSELS.items():
            if is_one(part, names):
                return head if vessel == "=" else vessel
    return usual


def is_one(thing: str, names: str) -> bool:
    """Whether a noun phrase ends in one of the names between bars, in singular or plural."""
    head = thing.lower().split(" of ")[0]
    return re.search(rf"\b(?:{names})(?:s|es)?$", head) is not None


def words(row: str) -> tuple[str, ...]:
    """The words between commas."""
    return tuple(dict.fromkeys(word.strip() for word in row.split(",") if word.strip()))
