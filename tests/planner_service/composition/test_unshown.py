"""What is acted and not all of it seen says what is not: things, places, how often."""

from __future__ import annotations

from for_each import for_each

from motion_backend.motion import Skill
from planner_service.composition.unshown import unseen
from planner_service.scripts.script import PlannedKeyframe
from planner_service.themes.sentence_parser import clauses_of_text


def keyframe(skill: Skill, caption: str, furniture: str) -> PlannedKeyframe:
    return PlannedKeyframe(skill=skill, caption=caption, furniture=furniture)


HAND = keyframe(Skill.TOUCH, "touch medium height", "wardrobe")
AT_THE_PLANT = keyframe(Skill.TOUCH, "pouring with the right hand", "plant")
KNOCKING = keyframe(Skill.TOUCH, "knocking with the right hand", "wardrobe")
DANCING = keyframe(Skill.LOCO, "dancing steps, arms swinging", "table")
WRITING = keyframe(Skill.SITDOWN, "writing at the table, right hand moving", "office chair")
READING = keyframe(Skill.SITDOWN, "reading, book held in both hands", "armchair")
LOW = keyframe(Skill.TOUCH, "touch low height", "bed")
WALKING = keyframe(Skill.LOCO, "steadily walking forward", "floor")
SWEEPING = keyframe(Skill.LOCO, "sweeping the floor with both hands", "floor")
KNEELING = keyframe(Skill.LOCO, "kneeling on the floor, hands on thighs", "wardrobe")
DRESSING = keyframe(Skill.LOCO, "dressing, both hands at the chest", "floor")
SITTING = keyframe(Skill.SITDOWN, "sit upright with hands on thighs", "armchair")
DRINKING = keyframe(Skill.SITDOWN, "drinking at the table, right hand to the mouth", "armchair")
CARRYING = keyframe(Skill.LOCO, "carrying with both hands", "floor")


@for_each(
    ("text", "seen", "left"),
    [
        ("She packs a suitcase in a hurry.", HAND, ("a suitcase",)),
        ("She closes the wardrobe.", HAND, ()),
        ("She scrolls on her phone.", READING, ("on her phone",)),
        ("She scrolls on her phone.", READING.model_copy(update={"held": "phone"}), ()),
        ("She looks for her keys.", HAND, ()),
        ("He turns the music up.", HAND, ()),
        ("He pulls out the battery.", HAND, ("the battery",)),
        ("He waters the plants.", AT_THE_PLANT, ()),
        ("She carries a spider away.", CARRYING, ("a spider",)),
        ("She carries a box away.", CARRYING, ()),
        ("She comes home with a suitcase.", WALKING, ("with a suitcase",)),
        ("He sweeps the floor with a broom.", SWEEPING, ()),
        ("She looks under the bed.", LOW, ("under the bed",)),
        ("She dances on the table.", DANCING, ("on the table",)),
        ("He writes her name in the dust on the shelf.", WRITING, ("on the shelf",)),
        ("He writes at the desk.", WRITING, ()),
        ("She leafs through a magazine.", READING, ()),
        ("She reads in the armchair under a blanket.", READING, ("under a blanket",)),
        ("She checks the wardrobe twice.", HAND, ("twice",)),
        ("She knocks on the wardrobe twice.", KNOCKING, ()),
        ("She opens every drawer.", HAND, ("every",)),
        ("He waters the plant on the windowsill.", AT_THE_PLANT, ("on the windowsill",)),
        ("She reads in the armchair by the fire.", READING, ("by the fire",)),
        ("She reads in the armchair by the window.", READING, ("by the window",)),
        ("She reads next to the bed.", READING, ("next to the bed",)),
        ("He writes by the desk.", WRITING, ()),
        ("She yells at her brother.", WALKING, ("at her brother",)),
        ("She pulls them off the bookcase, the wardrobe, his armchair.", HAND, ("off the bookcase", "his armchair")),
        ("He opens the drawer of the desk.", HAND, ("of the desk",)),
        ("He scrubs the bathtub on his knees.", HAND, ("the bathtub", "on his knees")),
        ("He scrubs the wardrobe on his knees.", KNEELING, ()),
        ("She ties on an apron.", DRESSING, ("an apron",)),
        ("He opens a beer.", SITTING, ("a beer",)),
        ("He opens a beer.", DRINKING, ()),
    ],
)
def test_what_no_keyframe_shows_of_an_acted_beat_is_said(
    text: str, seen: PlannedKeyframe, left: tuple[str, ...]
) -> None:
    assert unseen(clauses_of_text(text)[0], [seen]) == left


@for_each(
    ("text", "held", "left"),
    [
        ("She packs a suitcase in a hurry.", "suitcase", ()),
        ("She picks up her old letters.", "letter", ()),
        ("She packs a suitcase in a hurry.", "hat", ("a suitcase",)),
        ("She comes home with a suitcase.", "suitcase", ()),
        ("She walks about with a glass of wine in her hand.", "wine", ()),
        (
            "He runs about with the toothbrush still in his mouth.",
            "toothbrush",
            ("with the toothbrush still in his mouth",),
        ),
        ("She dances on the table with a hat.", "hat", ("on the table",)),
    ],
)
def test_what_is_held_by_name_is_seen_and_nothing_else_is(text: str, held: str, left: tuple[str, ...]) -> None:
    seen = WALKING if "with" in text else HAND
    assert unseen(clauses_of_text(text)[0], [seen.model_copy(update={"held": held})]) == left
