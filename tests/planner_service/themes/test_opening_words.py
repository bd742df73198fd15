"""Doors and windows are found in a theme's words, behind "it" too."""

from __future__ import annotations

from for_each import for_each

from motion_backend.motion import Skill
from planner_service.themes.opening_words import goes_out, goes_to_window, leaves_the_room, opening_of, spelt_out


@for_each(
    ("said", "before", "opening"),
    [
        ("opens it", ("stands at the window", "the rain stops"), "window"),
        ("closes it again", ("walks to the front door", "hesitates", "opens it"), "door"),
        ("opens it", ("walks to the window", "picks up a letter"), None),
        ("opens it", ("walks to the window", "takes a box from the shelf"), None),
        ("opens it", (), None),
        ("whisks them by the open window", (), None),
        ("drew the curtains on the grey street", (), "window"),
        ("knocks on the bathroom door", (), "door"),
        ("knocks again", (), "door"),
        ("knocks on the table", (), None),
    ],
)
def test_it_is_the_last_that_can_be_opened(said: str, before: tuple[str, ...], opening: str | None) -> None:
    assert opening_of(Skill.TOUCH, spelt_out(said, before)) == opening


@for_each(
    ("said", "goes"),
    [
        ("carries it to the window", True),
        ("walks over to the kitchen window", True),
        ("looks out of the window", False),
        ("sits down on the window seat", False),
        ("walks to the window seat", False),
    ],
)
def test_a_way_may_lead_to_a_window(said: str, goes: bool) -> None:
    assert goes_to_window(said) == goes


@for_each(
    ("said", "goes"),
    [
        ("runs out of the door without breakfast", True),
        ("leaves", True),
        ("leaves for work", True),
        ("walks out into the rain", True),
        ("leaves a note", False),
        ("leaves the room", False),
        ("storms out of the kitchen", False),
        ("takes the bin out", False),
    ],
)
def test_who_leaves_the_home_goes_to_its_door(said: str, goes: bool) -> None:
    assert goes_out(said) == goes
    assert (opening_of(Skill.LOCO, said) == "door") == goes


@for_each(
    ("said", "leaves"),
    [
        ("rushes out of the room", True),
        ("leaves the kitchen", True),
        ("storms out of her bedroom.", True),
        ("takes a plate out of the kitchen cabinet", False),
        ("leaves the room key on the table", False),
        ("walks through the room", False),
    ],
)
def test_who_leaves_a_room_is_known_from_who_takes_things_out_of_it(said: str, leaves: bool) -> None:
    assert leaves_the_room(said) == leaves
