"""What the rules know people to do at home: verbs, how the body is while doing it, what it takes in hand, and where.

Small things people take in hand at home, and the furniture they are usually kept on or in.
"""

from __future__ import annotations

import re
from typing import Final, Literal, NamedTuple

from motion_backend.motion import Posture

Kind = Literal["walk", "sit", "lie", "rise", "take", "put", "carry", "touch", "operate", "use", "stand", "never"]
SEATS: Final = "sofa, armchair, chair, lounge chair, bean bag, bench, stool, ottoman, sofa bed, bed"
TABLES: Final = "dining table, table, desk, coffee table, kitchen counter, console table, bar, side table, nightstand"
STORES: Final = "cabinet, shelf, dresser, wardrobe, nightstand, table, side table, TV stand, chest"
KITCHEN: Final = "kitchen counter, stove, kitchen cabinet, console table, dining table, bar, table, cabinet"


class Deed(NamedTuple):
    """A row of verbs with the same ways."""

    verbs: str
    """Base forms between bars; particles may also stand behind the object ("turn the TV on")."""
    kind: Kind
    where: str = ""
    """Furniture where it is done when nobody says where, the usual first."""
    takes: str = ""
    """What must be in hand: a thing, or "=" for the object itself."""
    hands: str = ""
    """The hands it takes: "one", "both", or none."""
    how: str = ""
    """Captions between bars that show it; {hand} is the hand."""
    first: str = ""
    """What is done before it."""
    posture: Posture = Posture.STANDING
    """For `use`: at rest how."""
    why: str = ""
    """Why a body does not do it (never), or what its acting leaves out."""


_S, _L = Posture.SEATED, Posture.LYING
_NOT_DRAWN: Final = "the hand is laid where it would lie; nothing is drawn in it"
_STILL: Final = "the hand is laid on it; nothing moves"
_AT_REST: Final = "the pose is held; nothing is drawn in the hands"
_TABLE: Final = "leaning forward, forearms on the table"
_EASY: Final = "arms loosely, legs open|lying back in chair, arms relaxed at sides|hands behind head, legs straight"
_TOUCH: Final = "touch medium height with the {hand} hand"

DEEDS: Final = (
    Deed("walk|go|move|come|step|head|return|approach|cross|run|rush|hurry|march|tiptoe|skip|stroll|wander", "walk"),
    Deed("walk around|walk about|wander around|wander about|pace|pace around|turn|turn around|turn left|turn right",
         "walk"),
    Deed("sit|sit down|sit back|take a seat|have a seat|be seated", "sit", SEATS),
    Deed("lie|lie down|lay down|go to bed|go to sleep|sleep|nap|take a nap|fall asleep|doze", "lie",
         "bed, sofa bed, sofa"),
    Deed("rest|relax|have a rest|take a break|wait", "sit", SEATS),
    Deed("stand|stand up|get up|rise|wake up|get out of bed", "rise"),
    Deed("stand still|stay|pause", "stand", how="stand still"),
    Deed("wave|wave goodbye", "stand", hands="one", how="wave with the right hand"),
    Deed("dance", "stand", how="dancing steps, arms swinging"),
    Deed("pick up|pick|take|grab|get|fetch|grasp|hold|lift|take out", "take", takes="=", hands="one",
         how="pick up with the {hand} hand", why=_NOT_DRAWN),
    Deed("put down|put|place|set|set down|lay|put back|put away|drop", "put", TABLES, "=", "one",
         "put down with the {hand} hand", why=_NOT_DRAWN),
    Deed("bring|carry|deliver", "carry", takes="=", hands="one", why=_NOT_DRAWN),
    Deed("touch|feel|press|push|pull|tap|knock on|lean on|pat", "touch", hands="one", how=_TOUCH),
    Deed("turn on|switch on|start|light", "operate", hands="one", how="turn on with the right hand", why=_STILL),
    Deed("open|close|shut|lock|unlock|turn off|switch off", "operate", hands="one", how=_TOUCH, why=_STILL),
    Deed("rotate|adjust", "operate", hands="one", how="rotate with the right hand", why=_STILL),
    Deed("clean|wipe|dust|polish|tidy|tidy up|clean up|clear|straighten", "operate", TABLES, "cloth", "one", _TOUCH,
         why=_STILL),
    Deed("wash|rinse|scrub|do", "operate", KITCHEN + ", bathroom cabinet", hands="both", how="wash with both hands",
         why="hands are laid where they would wash; there is no water"),
    Deed("water", "operate", "plant", "watering can", "one", _TOUCH, why=_STILL),
    Deed("make the bed", "operate", "bed", hands="both", how=_TOUCH, why=_STILL),
    Deed("cook|make|prepare|bake|fry|boil|brew|pour|fix|cut|chop|slice|stir|mix|heat|warm up", "operate", KITCHEN,
         hands="both", how=_TOUCH, why="hands are laid where it would be made; nothing moves"),
    Deed("brush", "operate", "bathroom cabinet, mirror, dressing table, cabinet, dresser", "toothbrush", "one", _TOUCH,
         why="a hand is kept at the furniture; no brush moves"),
    Deed("comb", "operate", "mirror, dressing table, dresser, bathroom cabinet", "comb", "one", _TOUCH,
         why="a hand is kept at the furniture; no comb moves"),
    Deed("get dressed|dress|change|put on|take off|undress|wear", "operate", "wardrobe, dresser, shoe cabinet, cabinet",
         hands="both", how=_TOUCH, why="hands are laid on the furniture; clothes do not change"),
    Deed("fold|iron|pack|wrap|sort|feed|set the table", "operate", "bed, " + TABLES, hands="both", how=_TOUCH,
         why=_STILL),
    Deed("search|look for|find|check|inspect|choose", "operate", STORES, hands="one", how=_TOUCH, why=_STILL),
    Deed("take a photo|take photo|take a picture|photograph", "operate", STORES, "camera", "both", _TOUCH, why=_STILL),
    Deed("watch|look at", "use", SEATS, how=_EASY, first="turn on", posture=_S),
    Deed("drink|sip|have", "use", SEATS, "cup", "one", "drinking from a cup in the right hand", posture=_S,
         why=_AT_REST),
    Deed("eat|have breakfast|have lunch|have dinner|have a snack", "use", SEATS, "plate", "one",
         "eating at the table, right hand to the mouth", posture=_S, why=_AT_REST),
    Deed("read", "use", SEATS, "=", "both", "reading, book held in both hands", posture=_S, why=_AT_REST),
    Deed("write|draw|sign", "use", "office chair, chair, " + SEATS, "pen", "one",
         "writing at the table, right hand moving", posture=_S, why=_AT_REST),
    Deed("type|type on|work|work on|work at|study|use the computer|use the laptop|browse", "use",
         "office chair, chair, " + SEATS, hands="both", how="typing, both hands on the keyboard", posture=_S,
         why=_AT_REST),
    Deed("play the piano|play piano|play the drums|play drums", "use", "stool, bench, chair, " + SEATS, hands="both",
         how="playing the piano, both hands on the keys", posture=_S, why=_AT_REST),
    Deed("play|play with|play on", "use", SEATS, "gamepad", "both", "playing a game, controller held in both hands",
         posture=_S, why=_AT_REST),
    Deed("listen|listen to", "use", SEATS, "headphones", "both", "listening to music, both hands at the ears",
         posture=_S, why=_AT_REST),
    Deed("call|phone|ring|talk on the phone|talk on|talk to|make a call|make a phone call|answer|speak on", "use",
         takes="phone", hands="one", how="walk while talking on the phone with the {hand} hand",
         why="a hand is held to the ear; no phone is drawn in it"),
    Deed("think|ponder|think about|meditate", "use", SEATS, how="right hand on chin, thinking", posture=_S),
    Deed("cry|weep", "use", SEATS, how="supporting head with hands, head bowed", posture=_S),
    Deed("stretch out", "lie", "bed, sofa bed, sofa"),
    Deed("throw|toss|throw away|catch|juggle", "never", hands="one", why="the body does not throw or catch"),
    Deed("crawl|climb|climb up|jump|hop|kneel|kneel down|squat|squat down|bend|bend down|bend forward|roll", "never",
         why="the body walks, sits, lies and reaches; it has no such movement"),
    Deed("punch|kick|swing|hit|exercise|do push-ups", "never", why="the body does not swing its limbs"),
    Deed("shower|take a shower|bathe|take a bath|swim", "never", why="there is no water, and no furniture for it"),
    Deed("go upstairs|go downstairs|leave|go out|enter|drive", "never", why="there are no stairs and nothing outside"),
)  # fmt: skip

WALKS: Final = {
    "run": "run with open arms", "rush": "rush anxiously forward", "hurry": "walking quickly",
    "march": "marching with swinging arms", "tiptoe": "walk on tiptoes", "skip": "skip steps running",
    "stroll": "strolling with hands in pockets", "pace": "pacing back and forth",
}  # fmt: skip
"""The caption of a walk by its verb; any other is `WALK`."""
WALK: Final = "smoothly forward walk"
SIT: Final = "sit upright with hands on thighs|hands on thighs|sitting upright, hands placed on thighs"
LIE: Final = "lying down, legs straight|hands on belly|lying still"
LYING: Final = {"read": "reading on the back, book held above the chest"}
"""How it looks lying, by its verb."""
PHONE: Final = {
    "left": "talking on the phone with the left hand",
    "right": "sitting upright, phone at the right ear",
}
"""How a call looks seated, by its hand."""
TOUCH: Final = _TOUCH


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
