"""A script gets a home that has what it needs, and says what stands for what."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import lru_cache
from math import pi

import pytest

from motion_backend.motion import Skill
from planner_service.api.stories.schemas import HomeShown
from planner_service.grounding.furnish import FurnishError, called, furnish
from planner_service.grounding.object_assignment import place_in, usable_offers
from planner_service.grounding.seat_access import draw_up
from planner_service.jobs import serialization
from planner_service.scripts.script import Beat, LongScript, PlannedKeyframe
from scene_graphs.affordances.room_validation import validate
from scene_graphs.furniture import class_of
from scene_graphs.graph.furniture_graph import offers
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout, Placed
from scene_graphs.layout_library import built_in_layouts
from scene_graphs.retrieval.layout_index import LayoutIndex


@lru_cache(maxsize=1)
def index() -> LayoutIndex:
    return LayoutIndex(built_in_layouts())


def script(*rows: tuple[str, str, str]) -> LongScript:
    """Keyframes as (skill, furniture, room), one short script a room."""
    rooms = list(dict.fromkeys(room for _, _, room in rows))
    keyframes = tuple(
        PlannedKeyframe(skill=Skill(skill), caption="x", furniture=piece, room=room, short_script=rooms.index(room))
        for skill, piece, room in rows
    )
    return LongScript(theme="t", beats=(Beat(text="t"),), short_scripts=(), keyframes=keyframes)


DAY = script(
    ("loco", "wardrobe", "bedroom"),
    ("touch", "wardrobe", "bedroom"),
    ("loco", "bed", "bedroom"),
    ("sitdown", "bed", "bedroom"),
    ("loco", "floor", "living_room"),
    ("liedown", "sofa", "living_room"),
)


def test_every_keyframe_gets_an_object_of_its_room_that_affords_it() -> None:
    found = furnish(DAY, index())
    categories = [found.home.object(p.object_id).category if p.object_id else None for p in found.places]
    assert categories[1] == "wardrobe"
    assert "bed" in str(categories[3])
    assert "sofa" in str(categories[5])
    assert categories[4] is None
    assert [match.room_type for match in found.matches] == ["bedroom", "living_room"]
    assert all(place.object_id is None or place.object_id.startswith(f"{place.room}/") for place in found.places)


def test_the_two_wardrobes_of_a_script_are_two_objects() -> None:
    two = script(("touch", "wardrobe", "bedroom"), ("touch", "wardrobe 2", "bedroom"))
    found = furnish(two, index())
    assert len({place.object_id for place in found.places}) == 2


def test_a_substitution_is_said() -> None:
    room = Layout(
        "mine",
        "bedroom",
        ((0.0, 0.0), (0.0, 4.0), (4.0, 4.0), (4.0, 0.0)),
        objects=(Placed("a", "stool", (2.0, 0.0, 2.0), (0.45, 0.45, 0.45)),),
    )
    found = furnish(script(("sitdown", "dining chair", "bedroom")), index(), given=[room])
    assert found.places[0].object_id == "0/a"
    assert found.matches[0].substitutions == (("dining chair", "stool", "class"),)
    assert "dining chair → stool" in found.explain()[0]


def test_a_piece_of_the_kind_that_is_called_otherwise_is_said() -> None:
    pieces = {"chaise_longue_sofa": "sofa → chaise longue (one of its kind)", "multi_seat_sofa": ""}
    for category, said in pieces.items():
        placed = Placed("a", category, (2.0, 0.0, 2.0), (1.8, 0.8, 0.85))
        room = Layout("mine", "bedroom", ((0.0, 0.0), (0.0, 4.0), (4.0, 4.0), (4.0, 0.0)), objects=(placed,))
        (line,) = furnish(script(("sitdown", "sofa", "bedroom")), index(), given=[room]).explain()
        assert ("→" in line) == bool(said)
        assert said in line


def test_a_users_room_without_the_very_thing_lends_another_and_says_so() -> None:
    room = Layout(
        "mine",
        "bedroom",
        ((0.0, 0.0), (0.0, 4.0), (4.0, 4.0), (4.0, 0.0)),
        objects=(
            Placed("bed", "single_bed", (3.2, 0.0, 1.2), (1.1, 0.6, 2.0)),
            Placed("table", "dining_table", (1.0, 0.0, 1.0), (1.2, 0.75, 0.8)),
        ),
    )
    found = furnish(script(("touch", "cabinet", "bedroom"), ("liedown", "bed", "bedroom")), index(), given=[room])
    assert [place.object_id for place in found.places] == ["0/table", "0/bed"]
    assert ("cabinet", "dining table", "affordance") in found.matches[0].substitutions
    assert "cabinet" not in found.matches[0].missing


def test_a_users_chair_that_nobody_can_get_to_is_not_used() -> None:
    corner = Placed("corner", "dining_chair", (0.3, 0.0, 0.3), (0.45, 0.9, 0.5))
    guard = [
        Placed("east", "wardrobe", (0.95, 0.0, 0.6), (1.2, 2.0, 0.6), 1.5707963),
        Placed("south", "wardrobe", (0.6, 0.0, 1.5), (1.2, 2.0, 0.6)),
    ]
    free = Placed("free", "dining_chair", (3.0, 0.0, 3.0), (0.45, 0.9, 0.5))
    room = Layout("mine", "bedroom", ((0.0, 0.0), (0.0, 4.0), (4.0, 4.0), (4.0, 0.0)), objects=(corner, *guard, free))
    found = furnish(script(("sitdown", "chair", "bedroom")), index(), given=[room])
    assert found.places[0].object_id == "0/free"


TABLE = Placed("table", "dining_table", (2.0, 0.0, 2.0), (1.6, 0.76, 0.9))
UNDER = Placed("under", "dining_chair", (2.0, 0.0, 2.5), (0.47, 0.87, 0.54), pi)
DINING = Layout(
    "mine", "dining_room", ((0.0, 0.0), (0.0, 4.0), (4.0, 4.0), (4.0, 0.0)), objects=(TABLE, UNDER), source="user"
)


def test_a_chair_pushed_under_a_table_is_pulled_out_and_that_is_said() -> None:
    found = furnish(script(("sitdown", "chair", "dining_room")), index(), given=[DINING])
    (pull,) = found.matches[0].pulls
    assert found.places[0].object_id == "0/under"
    assert found.home.object("0/under").position == pull.end != UNDER.position
    assert found.home.object("0/table").position == TABLE.position
    assert f"dining chair under pulled out by {pull.distance:.2f} m" in found.explain()[0]
    (told,) = found.rooms_to_dicts()[0]["pulled_out"]
    assert told["object_id"] == "under"
    assert told["from"] == {"position": list(UNDER.position), "yaw": UNDER.yaw}
    shown = HomeShown.model_validate({"rooms": found.rooms_to_dicts()})
    assert shown.model_dump(mode="json", by_alias=True)["rooms"] == found.rooms_to_dicts()
    assert serialization.furnished_from_dict(
        json.loads(json.dumps(serialization.furnished_to_dict(found)))
    ).matches == (found.matches)


def test_nothing_is_pulled_out_where_another_chair_is_free_or_nobody_sits() -> None:
    free = Placed("free", "dining_chair", (0.6, 0.0, 3.0), (0.45, 0.9, 0.5))
    room = replace(DINING, objects=(*DINING.objects, free))
    assert furnish(script(("sitdown", "chair", "dining_room")), index(), given=[room]).matches[0].pulls == ()
    assert furnish(script(("touch", "table", "dining_room")), index(), given=[DINING]).matches[0].pulls == ()


def test_the_second_of_two_chairs_minds_where_the_first_was_pulled_to() -> None:
    other = replace(UNDER, id="other", position=(2.0, 0.0, 1.5), yaw=0.0)
    room = replace(DINING, objects=(*DINING.objects, other))
    both = script(("sitdown", "chair", "dining_room"), ("sitdown", "chair 2", "dining_room"))
    found = furnish(both, index(), given=[room])
    assert {place.object_id for place in found.places} == {"0/under", "0/other"}
    assert {pull.object_id for pull in found.matches[0].pulls} == {"under", "other"}
    assert not [problem for problem in validate(found.home.rooms[0].layout) if "chair" in problem]


def test_where_nothing_else_serves_a_body_sits_and_lies_on_the_floor_and_that_is_said() -> None:
    bare = Layout("bare", "bedroom", ((0.0, 0.0), (0.0, 4.0), (4.0, 4.0), (4.0, 0.0)))
    found = furnish(script(("loco", "bed", "bedroom"), ("liedown", "bed", "bedroom")), index(), given=[bare])
    assert [place.object_id for place in found.places] == [None, None]
    assert found.matches[0].substitutions == (("bed", "floor", "affordance"),)
    assert found.matches[0].missing == ()


def test_what_nothing_can_stand_for_is_an_error_that_names_it() -> None:
    empty = Layout("bare", "bedroom", ((0.0, 0.0), (0.0, 4.0), (4.0, 4.0), (4.0, 0.0)))
    with pytest.raises(FurnishError, match="no wardrobe to touch"):
        furnish(script(("touch", "wardrobe", "bedroom")), index(), given=[empty])


@pytest.mark.parametrize("rooms", [["cellar"], ["bedroom"] * 5])
def test_rooms_that_are_not_there_are_refused(rooms: list[str]) -> None:
    with pytest.raises(FurnishError, match="rooms"):
        furnish(DAY, index(), rooms=rooms)


def test_the_same_seed_furnishes_alike_and_seeds_vary() -> None:
    first, again = furnish(DAY, index(), seed=3), furnish(DAY, index(), seed=3)
    assert first.home == again.home
    assert first.places == again.places
    homes = {tuple(m.layout_id for m in furnish(DAY, index(), seed=seed).matches) for seed in range(12)}
    assert len(homes) > 1


def test_a_script_on_the_floor_alone_still_gets_a_room() -> None:
    found = furnish(script(("loco", "floor", "study")), index())
    assert len(found.home.rooms) == 1
    assert found.places[0].object_id is None


def test_no_chair_is_drawn_up_to_where_the_door_to_another_room_leaves_no_way() -> None:
    rooms = {layout.id: layout for layout in built_in_layouts()}
    home = home_from_layouts([rooms["bedroom-0065"], rooms["dining-room-0094"]], seed=0)
    seats = [name for name, use in usable_offers(home).items() if "sit" in use and "dining_chair" in name]
    keyframe = PlannedKeyframe(
        skill=Skill.SITDOWN,
        emotion="neutral",
        caption="eating at the table, right hand to the mouth",
        furniture="dining chair",
    )
    for name in seats:
        drawn, _ = draw_up(home, [keyframe], [place_in(name)])
        assert "sit" in usable_offers(drawn)[name], name


def test_what_joined_rooms_cut_off_is_left_aside() -> None:
    layouts = [one for one in built_in_layouts() if one.id in ("study-0003", "living-room-0070", "dining-room-0023")]
    home = home_from_layouts(
        sorted(layouts, key=lambda one: ["study", "living_room", "dining_room"].index(one.room_type)), 3
    )
    whole = usable_offers(home)
    assert any("lie" in offers(home.object(name)) and "lie" not in found for name, found in whole.items())
    decor = usable_offers(home, checked=True)
    assert decor == {name: found for name, found in whole.items() if name in decor}
    assert {class_of(home.object(name).category) for name in decor} == {"decor"}


def test_who_reads_on_a_sofa_and_dozes_off_there_lies_on_the_sofa_that_was_sat_on() -> None:
    sits = PlannedKeyframe(
        skill=Skill.SITDOWN, caption="reading, book held in both hands", furniture="sofa", room="living_room"
    )
    dozes = PlannedKeyframe(skill=Skill.LIEDOWN, caption="lying still", furniture="sofa", room="living_room")
    story = LongScript(
        theme="t",
        beats=(Beat(text="t"),),
        short_scripts=(),
        keyframes=(sits.model_copy(update={"short_script": 0}), dozes),
    )
    for seed in range(8):
        found = furnish(story, index(), seed=seed)
        assert found.places[0].object_id == found.places[1].object_id is not None
        assert "lie" in offers(found.home.object(str(found.places[0].object_id)))


@pytest.mark.parametrize(
    ("caption", "tables"),
    [("writing at the table, right hand moving", {"table"}), ("crossing arms", set())],
)
def test_who_writes_is_sat_where_a_table_stands_beside_the_chair(caption: str, tables: set[str]) -> None:
    writes = PlannedKeyframe(skill=Skill.SITDOWN, caption=caption, furniture="dining chair")
    rests = writes.model_copy(update={"caption": "crossing arms"})
    story = LongScript(theme="t", beats=(Beat(text="t"),), short_scripts=(), keyframes=(rests, writes))
    found = furnish(story, index())
    asked = {class_of(node.category) for graph in found.graphs.values() for node in graph}
    assert asked == {"seat"} | tables
    assert not any(match.missing for match in found.matches)


def test_hands_at_another_piece_than_is_named_are_told_and_a_bin_is_no_picture() -> None:
    keyframe = PlannedKeyframe(
        skill=Skill.TOUCH, caption="touch medium height", furniture="trash can", room="bedroom", beat=0
    )
    for text, told in (("throws it in the bin", "bin"), ("throws it away", "")):
        asked = LongScript(theme=text, beats=(Beat(text=text),), short_scripts=(), keyframes=(keyframe,))
        found = furnish(asked, index())
        given, _ = found.names[0]
        assert given not in ("picture", "trash can")
        assert found.instead(0) == (f"at the {given} in place of the {told}" if told else "")
    assert not furnish(DAY, index()).instead(1), "a wardrobe is asked for and there"


def roomless(*rows: tuple[str, str, str]) -> LongScript:
    """Keyframes as (skill, caption, furniture), in no certain room."""
    keyframes = tuple(
        PlannedKeyframe(skill=Skill(skill), caption=caption, furniture=piece) for skill, caption, piece in rows
    )
    return LongScript(theme="t", beats=(Beat(text="t"),), short_scripts=(), keyframes=keyframes)


@pytest.mark.parametrize(("then", "rooms"), [("floor lamp", 1), ("desk", 1), ("stove", 2)])
def test_nobody_leaves_a_room_for_what_some_rooms_of_its_kind_have(then: str, rooms: int) -> None:
    stage = furnish(roomless(("liedown", "lying still", "bed"), ("touch", "touch medium height", then)), index())
    assert len({place.room for place in stage.places}) == rooms
    assert not any(match.substitutions for match in stage.matches)


def test_a_chair_a_step_from_its_table_is_drawn_up_for_a_meal_and_for_nothing_else_and_that_is_said() -> None:
    chair = replace(UNDER, id="away", position=(2.0, 0.0, 3.4))
    room = replace(DINING, objects=(TABLE, chair))
    for caption, drawn in (("eating at the table, right hand to the mouth", True), ("arms loosely, legs open", False)):
        stage = furnish(roomless(("sitdown", caption, "dining chair")), index(), given=[room])
        (match,) = stage.matches
        assert [move.object_id for move in match.drawn_up] == ["away"] * drawn
        assert (stage.home.object("0/away").position != chair.position) == drawn
        assert any("drawn up to its table" in line for line in stage.explain()) == drawn
        again = serialization.furnished_from_dict(json.loads(json.dumps(serialization.furnished_to_dict(stage))))
        assert again.matches == stage.matches


BEDSIT = Layout(
    "mine",
    "bedroom",
    ((0.0, 0.0), (0.0, 5.0), (5.0, 5.0), (5.0, 0.0)),
    objects=(
        Placed("bed", "single_bed", (4.2, 0.0, 1.2), (1.1, 0.6, 2.0)),
        Placed("desk", "desk", (1.5, 0.0, 0.5), (1.4, 0.75, 0.7)),
        Placed("seat", "office_chair", (1.5, 0.0, 1.6), (0.5, 0.9, 0.5), pi),
    ),
    tags=("bedroom", "study"),
)


@pytest.mark.parametrize("asked", [("study",), ("dining_room",), ("study", "bedroom"), ("bedroom", "study")])
def test_a_room_with_a_bed_is_called_a_bedroom_wherever_a_story_names_it(asked: tuple[str, ...]) -> None:
    rows = [("liedown", "bed", room) if room == "bedroom" else ("touch", "desk", room) for room in asked]
    made = script(*rows)
    bare = tuple(keyframe.model_copy(update={"short_script": None}) for keyframe in made.keyframes)
    found = furnish(made.model_copy(update={"keyframes": bare}), index(), given=[BEDSIT])
    shown = serialization.summary_of_home(found)
    assert [match.room_type for match in found.matches] == ["bedroom"]
    assert {room for _, room in found.names.values()} == {"bedroom"}
    assert {keyframe["room"] for keyframe in shown["keyframes"]} == {"bedroom"}
    assert {node["room"] for node in shown["graph"]["nodes"]} == {"bedroom"}
    (line,) = found.explain()
    assert line.startswith("bedroom: mine")
    others = sorted(set(asked) - {"bedroom"})
    assert (f"where the script asks for a {others[0].replace('_', ' ')}" in line) is bool(others)


@pytest.mark.parametrize(
    ("own", "tags", "asked", "name"),
    [
        ("living_room", ("living_room", "dining_room"), ["dining_room"], "dining_room"),
        ("living_room", ("living_room", "dining_room"), ["dining_room", "living_room"], "living_room"),
        ("living_room", ("living_room",), ["dining_room"], "living_room"),
        ("kitchen", ("kitchen",), ["dining_room"], "kitchen"),
        ("bedroom", ("bedroom", "study"), ["study"], "bedroom"),
        ("study", ("study",), [], "study"),
    ],
)
def test_a_room_is_called_what_it_is_or_serves_and_never_what_it_is_not(
    own: str, tags: tuple[str, ...], asked: list[str], name: str
) -> None:
    assert called(replace(DINING, room_type=own, tags=tags), asked) == name
