"""Who plays is read from the theme; what is given wins, and what cannot be is refused by name."""

from __future__ import annotations

from typing import Any

import pytest
from for_each import for_each

from motion_backend.body.cast import GIVEN, Look, cast
from motion_backend.motion import Action, Character, Emotion, Skill
from planner_service.cast_choice import CharacterError, cast_for, named_as
from planner_service.cli.cast_command import character_given
from planner_service.pipeline import StoryRequest, actor, request_from_dict, request_to_dict, role_of
from planner_service.scripts.script import LongScript, Person, PlannedKeyframe
from scene_graphs.errors import UserError


def seen(theme: str, seed: int = 0, **given: Any) -> Character:
    return cast_for(theme, named_as(theme, Character(**given)), seed)


@for_each(
    ("theme", "expected"),
    [
        ("A tired nurse comes home and falls asleep on the sofa.", {"outfit": "nurse", "age": "adult"}),
        ("Anna, a nurse, comes home.", {"outfit": "nurse", "pronouns": "she"}),
        ("The old widower waters the plants.", {"age": "old", "pronouns": "he"}),
        ("My grandfather reads the newspaper.", {"age": "old", "pronouns": "he"}),
        ("Grandma knits on the sofa.", {"age": "old", "pronouns": "she"}),
        ("A girl of six plays in the living room.", {"age": "child", "pronouns": "she", "height": 1.17}),
        ("A six-year-old boy jumps around.", {"age": "child", "pronouns": "he", "height": 1.17}),
        ("Lena, aged nine, does her homework.", {"age": "child", "height": 1.33}),
        ("A teenage boy plays a game.", {"age": "teen", "pronouns": "he", "height": 1.7, "member": "finn"}),
        ("A sixteen-year-old girl does her homework.", {"age": "teen", "pronouns": "she", "member": "zoe"}),
        ("The teenager practises the guitar.", {"age": "teen"}),
        ("The grandmother of a teenager knits on the sofa.", {"age": "old", "pronouns": "she"}),
        ("She is 80 years old and looks for her book.", {"age": "old", "pronouns": "she"}),
        ("A thirty-year-old man reads.", {"age": "adult", "pronouns": "he"}),
        ("A bald man in a suit paces up and down.", {"hair": "bald", "outfit": "office"}),
        ("The blonde teacher reads.", {"hair_color": "blond"}),
        ("She cannot sleep and walks around.", {"outfit": "pyjamas"}),
        ("She comes home from work, and then she cannot sleep.", {}),
        ("He does yoga in the living room.", {"outfit": "sports"}),
        ("Henrik, 74, waters the plants.", {"age": "old"}),
        ("Henrik (74) waters the plants.", {"age": "old", "name": "Henrik"}),
        ("Mia is six. She jumps.", {"age": "child"}),
        ("Ida, who is eight, builds a tower.", {"age": "child"}),
        ("Leo was supposed to do his homework.", {"age": "teen"}),
        ("The teacher marks her homework.", {"age": "adult"}),
        ("Her son does his homework while Ruth cooks.", {"age": "adult"}),
        ("Room 12, 74 boxes. Tom carries them.", {"age": "adult"}),
        ("A retired sailor writes a letter.", {"age": "old", "outfit": "cardigan"}),
        ("The nurse waits for the old doctor.", {"age": "adult", "outfit": "nurse"}),
        ("He sits on the old sofa.", {"age": "adult"}),
        ("A little boy jumps while his grandmother reads.", {"age": "child", "pronouns": "he"}),
    ],
)
def test_words_about_the_person_choose_who_plays_and_in_what(theme: str, expected: dict[str, object]) -> None:
    found = vars(seen(theme))
    assert {name: found[name] for name in expected} == expected
    if "cannot sleep" in theme and "home" in theme:
        assert found["outfit"] != "pyjamas", "who comes home is dressed"


def test_pronouns_agree_with_who_plays_for_every_seed() -> None:
    for seed in range(8):
        assert cast().named(seen("She reads.", seed).member).pronouns == "she"
        assert cast().named(seen("He reads.", seed).member).pronouns == "he"
    assert len({seen("Thunder rolls.", seed).member for seed in range(8)}) > 3, (
        "where nothing is said, the seed chooses"
    )


def test_the_same_theme_and_seed_choose_the_same() -> None:
    assert seen("She reads a book.", 3) == seen("She reads a book.", 3)


def test_no_teenager_has_a_beard_whoever_plays() -> None:
    for member in (one.name for one in cast().member if one.age != "child"):
        look, grown = (Look.of(Character(member=member, age=age)) for age in ("teen", "adult"))
        assert not look.beard
        assert look.proportions.girth < grown.proportions.girth


def test_what_is_given_wins_over_what_is_read() -> None:
    found = seen("A girl of six plays.", member="walter", outfit="work")
    assert (found.member, found.age, found.outfit, found.pronouns, found.height) == (
        "walter",
        "old",
        "work",
        "he",
        1.70,
    )
    assert seen("The old woman reads.", age="adult").age == "adult"
    assert cast_for("A girl plays.", Character(pronouns="she", height=1.3), 0).height == 1.3


def test_who_was_asked_for_gives_the_name_where_the_theme_has_none() -> None:
    assert StoryRequest("The phone rings.", character=Character(member="ruth")).character.name == "Ruth"
    named = StoryRequest("Anna reads.", character=Character(member="ruth")).character
    assert (named.name, named.pronouns) == ("Anna", "she")


def test_nobody_who_is_grown_is_acted_otherwise_for_the_looks() -> None:
    for member in cast().member:
        height = seen("Somebody reads.", member=member.name).height
        assert (height == 1.70) == (member.age != "child")


@for_each(
    ("given", "at", "says"),
    [
        ({"member": "gandalf"}, "member", "walter"),
        ({"outfit": "armour"}, "outfit", "pyjamas"),
        ({"hair_color": "blue"}, "hair_color", "grey"),
        ({"member": "nora", "pronouns": "he"}, "pronouns", "tom"),
        ({"member": "mia", "age": "old"}, "age", "ruth"),
        ({"age": "child", "height": 1.9}, "height", "1.1 to 1.62"),
        ({"member": "tom", "height": 1.2}, "height", "1.4 to 2.2"),
        ({"height": 1.05}, "height", "1.1 to 2.2"),
    ],
)
def test_what_cannot_be_is_refused_by_field_and_remedy(given: dict[str, object], at: str, says: str) -> None:
    with pytest.raises(UserError, match=says) as refused:
        StoryRequest("She reads.", character=Character(**given))  # type: ignore[arg-type]
    assert str(refused.value.at) == at


def test_the_option_reads_a_member_and_words() -> None:
    given = character_given("Nora, outfit=nurse, hair_color=grey", Character(height=1.6))
    assert given == Character(height=1.6, member="nora", outfit="nurse", hair_color="grey")
    assert character_given("", Character()) == Character()
    for wrong in ("shoes=red", "tom,ruth", "=x"):
        with pytest.raises(CharacterError):
            character_given(wrong, Character())


def test_a_request_keeps_what_was_given_through_the_store() -> None:
    asked = StoryRequest("The phone rings.", character=Character(member="leo", outfit="pyjamas"))
    again = request_from_dict(request_to_dict(asked))
    assert again == asked
    assert again.acted_by == asked.acted_by


def test_the_age_that_a_model_read_is_played() -> None:
    request = StoryRequest("Robin plays with the blocks.")
    script = LongScript(
        theme=request.theme, beats=(), short_scripts=(), keyframes=(), person=Person(pronouns="she", age=6)
    )
    found = actor(request, script)
    assert (found.age, found.height, found.pronouns) == ("child", 1.17, "she")


def test_who_is_told_to_sleep_has_shut_eyes_also_in_a_script_of_ones_own() -> None:
    """Keyframes cut out of a story may name beats that are not there; who shuffles sleepily looks where they go."""
    own = [
        PlannedKeyframe(skill=Skill.LOCO, emotion="tired", caption="shuffling sleepily forward", furniture="floor"),
        PlannedKeyframe(skill=Skill.LIEDOWN, emotion="tired", caption="he falls asleep", furniture="bed", beat=7),
    ]
    script = LongScript(theme="", beats=(), short_scripts=(), keyframes=tuple(own))
    actions = [Action(one.skill, one.caption, Emotion.TIRED, keyframe=index) for index, one in enumerate(own)]
    role = role_of(Character(member="tom"), actions, script)
    assert role.asleep == {1}
    assert role.emotions == {0: Emotion.TIRED, 1: Emotion.TIRED}


@for_each("field", GIVEN)
def test_every_word_that_may_be_given_has_a_look(field: str) -> None:
    for word in cast().known(field):
        given: dict[str, Any] = {field: word}
        look = Look.of(Character(**given))
        assert look.clothes.name == look.outfit
        assert look.proportions
