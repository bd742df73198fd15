"""What a picture gainsays: no way or place is told as acted that a keyframe does not have."""

from __future__ import annotations

from for_each import for_each

from motion_backend.motion import Skill
from planner_service.composition.caption_senses import SenseTable
from planner_service.composition.gainsaid import is_gainsaid
from planner_service.scripts.captions import captions
from planner_service.scripts.script import Keyframe
from planner_service.themes.sentence_parser import clauses_of_text
from scene_graphs.data_tables import read_table

HAND = Keyframe(skill=Skill.TOUCH, caption="touch medium height", furniture="sofa")
LOW = Keyframe(skill=Skill.TOUCH, caption="touch low height", furniture="sofa")
CURLED = Keyframe(skill=Skill.LIEDOWN, caption="curled up on the left side, knees drawn up", furniture="bed")
SEATED = Keyframe(skill=Skill.SITDOWN, caption="sitting still", furniture="chair")
READING = Keyframe(skill=Skill.SITDOWN, caption="reading, book held in both hands", furniture="chair")
STANDING = Keyframe(skill=Skill.LOCO, caption="stand still", furniture="floor")
PUTTING = Keyframe(skill=Skill.TOUCH, caption="put down with the left hand", furniture="sofa")


def test_the_only_captions_of_a_deed_are_parts_of_captions_that_there_are() -> None:
    known: SenseTable = read_table("planner_service", "caption_senses.toml", SenseTable)
    there = [caption.lower() for some in captions().values() for caption in some]
    assert all(any(part in caption for caption in there) for one in known.only for part in one.captions)


@for_each(
    ("text", "keyframe", "gainsaid"),
    [
        ("She hides under the bed.", CURLED, True),
        ("She curls up under the bedclothes.", CURLED, False),
        ("She crawls into bed.", CURLED, False),
        ("She crawls inside the wardrobe.", HAND, True),
        ("She checks under the sofa.", HAND, True),
        ("She checks under the sofa.", LOW, False),
        ("She hides under the sofa.", LOW, True),
        ("She checks the sofa.", HAND, False),
        ("She jumps onto a chair.", SEATED, True),
        ("She sits on a chair.", SEATED, False),
        ("She sits behind her desk.", SEATED, False),
        ("She climbs onto the bed.", CURLED, False),
        ("She throws the cap on the sofa.", PUTTING, True),
        ("She throws open the curtains.", HAND, False),
        ("She puts the cap on the sofa.", PUTTING, False),
        ("She reads it by the window.", STANDING, True),
        ("She reads the letter.", READING, False),
        ("She sits there reading.", SEATED, False),
        ("She bows twice.", STANDING, True),
        ("She keeps looking at her watch.", STANDING, True),
        ("She looks out of the window.", STANDING, False),
        ("She shrieks.", STANDING, True),
    ],
)
def test_a_way_or_a_place_that_a_keyframe_does_not_have_is_gainsaid(
    text: str, keyframe: Keyframe, gainsaid: bool
) -> None:
    assert is_gainsaid(clauses_of_text(text)[0], [keyframe]) == gainsaid


def test_one_keyframe_that_is_what_is_told_is_enough() -> None:
    (clause,) = clauses_of_text("She reads the letter.")
    assert not is_gainsaid(clause, [STANDING, READING])
