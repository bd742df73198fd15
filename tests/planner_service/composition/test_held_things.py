"""What the theme names is in the hands in the keyframes that take, use, carry and put it down, and in no others."""

from __future__ import annotations

from for_each import for_each

from motion_backend.motion import Skill
from planner_service.composition.held_things import CARRIED, as_hands_hold, is_handled, things_in, with_things
from planner_service.scripts.script import PlannedKeyframe
from planner_service.themes.beats import beats_of
from planner_service.themes.sentence_parser import clauses_of_text

WALK, TOUCH, SIT = "smoothly forward walk", "touch medium height", "hands on thighs"
SIP = "drinking from a cup in the right hand"


def frame(skill: Skill, caption: str, furniture: str, beat: int, also: tuple[int, ...] = ()) -> PlannedKeyframe:
    return PlannedKeyframe(skill=skill, caption=caption, furniture=furniture, beat=beat, also=also)


def to(furniture: str, beat: int, caption: str = WALK) -> PlannedKeyframe:
    return frame(Skill.LOCO, caption, furniture, beat)


def at(furniture: str, beat: int, caption: str = TOUCH) -> PlannedKeyframe:
    return frame(Skill.TOUCH, caption, furniture, beat)


def on(furniture: str, beat: int, caption: str = SIT, also: tuple[int, ...] = ()) -> PlannedKeyframe:
    return frame(Skill.SITDOWN, caption, furniture, beat, also)


def held(theme: str, *keyframes: PlannedKeyframe) -> list[str]:
    return [one.held for one in with_things(beats_of(theme), keyframes)]


@for_each(
    ("text", "thing"),
    [
        ("She takes a beer from the fridge.", "beer"),
        ("He picks the letter up.", "letter"),
        ("He picks up two heavy bags.", "bag"),
        ("She pours herself a glass of wine.", "wine"),
        ("She opens a bottle of wine.", "bottle"),
        ("He carries a pile of books upstairs.", "book"),
        ("She hugs her teddy bear.", "teddy bear"),
        ("He comes in with a suitcase.", "suitcase"),
        ("She puts on her glasses.", "glasses"),
        ("He fills two glasses.", "glass"),
        ("She cleans the coffee table.", ""),
        ("He walks to the book shelf.", ""),
        ("She looks for her keys.", ""),
        ("He puts it on the tray.", ""),
        ("She feeds the dragon.", ""),
        ("He comes home drunk.", ""),
        ("He sharpens the knives.", "knife"),
    ],
)
def test_the_thing_is_what_the_deed_is_done_to(text: str, thing: str) -> None:
    assert things_in(clauses_of_text(text)[0])[:1] == [thing] * bool(thing)


def test_where_things_are_taken_at_several_places_each_is_named_where_it_is() -> None:
    assert held("She grabs her keys and her bag.", at("table", 0), to("wardrobe", 0), at("wardrobe", 0))[::2] == [
        "key",
        "bag",
    ]


def test_what_is_taken_is_carried_to_where_it_is_used() -> None:
    theme = "He takes a beer from the fridge, sits down on the sofa and drinks it."
    keyframes = (to("refrigerator", 0), at("refrigerator", 0), to("sofa", 1), on("sofa", 1), on("sofa", 2, SIP))
    assert held(theme, *keyframes) == ["", "beer", "beer", "beer", "beer"]


def test_what_is_put_down_is_in_the_hand_on_the_way_there_and_no_longer() -> None:
    theme = "She puts the plate on the table and sits down."
    assert held(theme, to("table", 0), at("table", 0), to("chair", 1), on("chair", 1)) == ["plate", "plate", "", ""]


def test_it_is_what_was_named_before() -> None:
    theme = "He picks up a letter, carries it to the desk and opens it."
    assert held(theme, to("table", 0), at("table", 0), to("desk", 1), at("desk", 2)) == ["", *["letter"] * 3]


def test_it_is_also_what_was_only_looked_for() -> None:
    theme = "She looks for her keys, finds them and puts them on the table."
    found = held(theme, at("desk", 0), at("shelf", 1), to("table", 2), at("table", 2))
    assert found == ["", "key", "key", "key"]


def test_who_takes_a_thing_that_is_named_is_seen_taking_it() -> None:
    (clause,) = clauses_of_text("He takes a knife.")
    taken = at("table", 0).model_copy(update={"held": "knife"})
    assert is_handled(clause, [taken])
    assert not is_handled(clause, [at("table", 0)])
    assert not is_handled(clause, [taken.model_copy(update={"held": "fork"})])
    assert not is_handled(clauses_of_text("He sharpens a knife.")[0], [taken])
    assert not is_handled(clauses_of_text("He puts on a hat.")[0], [taken.model_copy(update={"held": "hat"})])


def test_a_thing_goes_when_the_hands_are_needed() -> None:
    theme = "She takes a cup from the shelf and claps."
    assert held(theme, to("shelf", 0), at("shelf", 0), to("floor", 1, "clapping hands")) == ["", "cup", ""]


def test_one_hand_has_one_thing_at_a_time() -> None:
    theme = "He takes a knife and takes an apple."
    assert held(theme, at("table", 0), at("desk", 1)) == ["knife", "apple"]


def test_a_hand_on_a_thing_that_it_does_not_take_has_it_only_there() -> None:
    theme = "She wipes the plate and sits down."
    assert held(theme, to("table", 0), at("table", 0), to("chair", 1), on("chair", 1)) == ["", "plate", "", ""]


def test_captions_that_hold_something_else_keep_it() -> None:
    theme = "He plays the violin."
    assert held(theme, on("chair", 0, "playing the guitar")) == [""]


def test_what_is_only_told_to_be_held_is_held_in_what_is_done_meanwhile() -> None:
    theme = "Holding a candle, she walks through the house."
    (walk,) = with_things(beats_of(theme), (to("floor", 1),))
    assert walk.held == "candle"
    assert 0 in walk.also


def test_who_carries_what_takes_both_hands_walks_so_and_hands_are_not_behind_the_back_then() -> None:
    theme = "She takes the tray from the counter and goes to the table."
    found = as_hands_hold(with_things(beats_of(theme), (at("kitchen counter", 0), to("table", 1))))
    assert [(one.held, one.caption) for one in found] == [("tray", TOUCH), ("tray", CARRIED)]
    theme = "She wanders with a candle."
    stowed = to("floor", 0, "walking slowly, hands behind back")
    (walk,) = as_hands_hold(with_things(beats_of(theme), (stowed,)))
    assert walk.held == "candle"
    assert "behind" not in walk.caption
    assert as_hands_hold((stowed,)) == (stowed,)


def test_the_hand_that_drinks_is_the_hand_that_takes() -> None:
    theme = "He takes a beer and drinks it."
    left = at("table", 0, "pick up with the left hand")
    found = as_hands_hold(with_things(beats_of(theme), (left, on("sofa", 1, SIP))))
    assert found[0].caption == "pick up with the right hand"
    assert as_hands_hold((left, on("sofa", 1, SIP)))[0] == left


def test_a_theme_that_names_nothing_leaves_all_as_it_was() -> None:
    keyframes = (to("sofa", 0), on("sofa", 0), to("floor", 1, "dancing steps, arms swinging"))
    assert with_things(beats_of("She sits on the sofa and dances."), keyframes) == keyframes


def test_a_tool_is_held_at_its_work_and_it_is_what_it_was_used_on() -> None:
    found = held(
        "She irons a shirt, hangs it in the wardrobe, cuts a letter out with scissors and puts it on the fridge.",
        at("table", 0, "wiping with the right hand").model_copy(update={"held": "iron"}),
        at("wardrobe", 1, "put down with the right hand"),
        at("table", 2, "stirring with the right hand"),
        at("refrigerator", 3, "put down with the right hand"),
    )
    assert found == ["iron", "shirt", "scissors", "letter"]
