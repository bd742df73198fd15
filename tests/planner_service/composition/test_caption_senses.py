"""What captions show: a table whose parts are of captions that there are, and deeds that are only stood for."""

from __future__ import annotations

from functools import cache

from for_each import for_each

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Skill
from planner_service.composition.caption_senses import SenseTable, contradicted, shows
from planner_service.composition.compose import compose
from planner_service.scripts.acted_beats import ActedBeats, planned_beats
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.captions import captions
from planner_service.scripts.script_library import Features, ScriptLibrary
from planner_service.themes.sentence_parser import clauses_of_text
from scene_graphs.data_tables import read_table


def test_every_part_of_the_table_is_part_of_a_caption_of_its_skill() -> None:
    known: SenseTable = read_table("planner_service", "caption_senses.toml", SenseTable)
    for sense in known.sense:
        there = [caption.lower() for caption in captions()[sense.skill.value]]
        assert all(any(part in caption for caption in there) for part in sense.captions), sense


@for_each(
    ("text", "skill", "caption", "shown"),
    [
        ("She reads a book.", Skill.SITDOWN, "reading, book held in both hands", True),
        ("She waltzes.", Skill.LOCO, "run and spin", True),
        ("She sits there listening.", Skill.SITDOWN, "sitting still", True),
        ("She picks up the key.", Skill.TOUCH, "pick up with the right hand", True),
        ("She picks up the child.", Skill.TOUCH, "pick up with the right hand", False),
        ("She bakes a cake.", Skill.TOUCH, "touch medium height", False),
        ("She conducts an orchestra.", Skill.LOCO, "run and spin", False),
        ("She looks out.", Skill.LOCO, "stand still", True),
        ("She bangs her fist.", Skill.TOUCH, "touch medium height", True),
        ("She bangs her knee.", Skill.TOUCH, "touch medium height", False),
        ("She answers the phone.", Skill.SITDOWN, "sitting upright, phone at the right ear", True),
        ("She looks at her phone.", Skill.SITDOWN, "sitting upright, phone at the right ear", False),
    ],
)
def test_a_caption_shows_its_own_deed_and_stands_for_any_other(
    text: str, skill: Skill, caption: str, shown: bool
) -> None:
    assert shows(skill, caption, clauses_of_text(text)[0]) == shown


def test_what_is_stood_for_is_not_acted_and_named() -> None:
    found = planned("She conducts an orchestra and sleeps.")
    assert [(one.acted, one.stood_for) for one in found.outcomes] == [(False, True), (True, False)]
    assert found.lines()[0].startswith("1 of 2 beats of your theme are acted, something stands for 1 more")
    assert "not acted as such, something stands for it: conducts an orchestra" in found.lines()


@for_each(
    ("theme", "stood_for"),
    [
        ("She bakes a cake.", False),  # with a hand at the stove
        ("He tries on a shirt.", False),
        ("He listens to the radio.", False),
        ("She finds the child.", True),
        ("She alphabetises her records.", True),  # nothing tells how
        ("She sprains her ankle.", True),
        ("He paints his nails on the bed.", False),
        ("She slams the book against the wardrobe.", False),
        ("She sharpens a pencil on the bed.", False),
    ],
)
def test_what_fair_people_take_for_the_deed_is_not_stood_for(theme: str, stood_for: bool) -> None:
    assert [one.beat.stood_for for one in planned(theme).outcomes] == [stood_for]


def planned(theme: str) -> ActedBeats:
    return planned_beats(compose(theme, library()))


@cache
def library() -> ScriptLibrary:
    return ScriptLibrary(built_in(), Features(HashingEncoder()))


def test_every_part_of_a_contradiction_is_part_of_a_caption() -> None:
    known: SenseTable = read_table("planner_service", "caption_senses.toml", SenseTable)
    there = [caption for some in captions().values() for caption in some]
    for one in known.contradiction:
        assert all(any(part in caption for caption in there) for part in one.captions), one


@for_each(
    ("text", "caption", "never"),
    [
        ("She lets it ring.", "sitting upright, phone at the right ear", True),
        ("She checks her phone.", "walk while talking on the phone with the left hand", True),
        ("She answers the phone.", "sitting upright, phone at the right ear", False),
        ("She plays the violin.", "playing the piano, both hands on the keys", True),
        ("She plays the piano.", "playing the piano, both hands on the keys", False),
        ("She plays solitaire.", "playing a game, controller held in both hands", True),
        ("She plays a video game.", "playing a game, controller held in both hands", False),
        ("She laughs.", "supporting head with hands, head bowed", True),
        ("She cries.", "supporting head with hands, head bowed", False),
        ("She sits on the sofa.", "typing, both hands on the keyboard", True),
        ("She types on the sofa.", "typing, both hands on the keyboard", False),
    ],
)
def test_no_caption_is_played_for_the_opposite_or_for_another_thing_in_the_hands(
    text: str, caption: str, never: bool
) -> None:
    (clause,) = clauses_of_text(text)
    assert any(part in caption for part in contradicted(clause)) == never
