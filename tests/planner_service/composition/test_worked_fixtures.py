"""What becomes of furniture under the hands is read off the theme's verbs, and told as unseen where nothing moves."""

from __future__ import annotations

from for_each import for_each

from planner_service import Pipeline, StoryRequest
from planner_service.composition.worked_fixtures import done_to
from planner_service.scripts.still_things import still_in
from planner_service.themes.sentence_parser import clauses_of_text

DONE = [
    ("She turns on the lamp.", "floor lamp", "on"),
    ("She switches the light off.", "table lamp", "off"),
    ("He turns the television on.", "tv stand", "on"),
    ("He lights the stove.", "stove", "on"),
    ("Lamp on.", "floor lamp", "on"),
    ("Lights out.", "table lamp", "off"),
    ("Coat off.", "wardrobe", ""),
    ("He turns off the tap.", "kitchen sink", "off"),
    ("He turns off the alarm.", "nightstand", ""),
    ("She puts on the kettle.", "stove", ""),
    ("She opens the wardrobe.", "wardrobe", "open"),
    ("She throws the cupboard open.", "cabinet", "open"),
    ("He slams the cabinet.", "cabinet", "close"),
    ("He shuts the fridge.", "refrigerator", "close"),
    ("He pushes the drawer shut.", "dresser", "close"),
    ("She opens the curtains.", "curtain", "open"),
    ("She draws the curtains.", "curtain", "close"),
    ("She draws back the curtains.", "curtain", "open"),
    ("He looks into the fridge.", "refrigerator", "into"),
    ("He takes the milk out of the fridge.", "refrigerator", "into"),
    ("He gets a beer.", "refrigerator", "into"),
    ("She puts the plates in the cupboard.", "cabinet", "into"),
    ("She puts the vase on the cabinet.", "cabinet", ""),
    ("She puts the book on the nightstand.", "nightstand", ""),
    ("She opens a letter.", "desk", ""),
    ("She wipes the cabinet.", "cabinet", ""),
    ("He touches the lamp.", "floor lamp", ""),
]


@for_each("text, piece, does", DONE)
def test_a_deed_says_what_becomes_of_the_piece(text: str, piece: str, does: str):
    (clause,) = clauses_of_text(text)
    assert done_to(clause, piece) == does


def test_it_is_what_was_opened_or_switched_before():
    off, shut = clauses_of_text("He switches it off."), clauses_of_text("He closes it.")
    assert [done_to(off[0], "sofa", last) for last in ("", "on", "open")] == ["", "off", ""]
    assert [done_to(shut[0], "wardrobe", last) for last in ("", "on", "open")] == ["", "", "close"]


@for_each("text, seen, named", [
    ("opens the wardrobe", "open", "that the wardrobe moves"),
    ("slams the cabinet", "close", "that the cabinet moves"),
    ("turns off the lamp", "off", "that it goes off"),
    ("turns on the television", "on", "that it goes on"),
    ("lights the stove", "on", "that it goes on"),
    ("looks into the fridge", "into", "that the fridge opens"),
    ("takes the milk out of the fridge", "into", "that the fridge opens"),
])  # fmt: skip
def test_what_is_seen_to_move_or_light_is_not_named_and_what_is_not_is(text: str, seen, named: str):
    assert still_in(text, {seen}) == ()
    assert still_in(text) == (named,)
    assert still_in(text, {"on" if seen != "on" else "off"}) == (named,)


@for_each("text", ["puts on a coat", "reads in the armchair", "looks out of the window", "switches on", "lights up"])
def test_nothing_is_said_of_what_would_not_move(text: str):
    assert still_in(text) == ()


def test_drawers_are_where_drawers_are_and_what_is_shut_is_what_was_opened():
    planned = Pipeline().plan(StoryRequest("Emil opens the drawer, dances and closes the drawer.", seed=0))
    done = {one.does: one for one in planned.script.keyframes if one.does}
    assert [*done] == ["open", "close"]
    assert done["open"].furniture == done["close"].furniture == "dresser"


def test_a_story_that_opens_nothing_does_nothing_to_its_pieces():
    planned = Pipeline().plan(StoryRequest("She reads on the sofa, cries and falls asleep.", seed=0))
    assert all(one.does == "" for one in planned.script.keyframes)
