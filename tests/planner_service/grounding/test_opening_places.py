"""Windows are looked out of and opened, doors are gone to and opened, where there are some; without one the body's note
says so. Who comes in begins at the door."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motion_backend.director import Director
from motion_backend.motion import Action, Character, Skill
from motion_backend.scene import scene_of
from planner_service.grounding.keyframes_to_actions import LOOKS_OUT, Place, act
from planner_service.grounding.opening_places import LACKS, entry, opening_place
from planner_service.scripts.script import Keyframe
from planner_service.themes.opening_words import comes_in, opening_of
from scene_graphs.home import Home, home_from_layouts
from scene_graphs.layout import Layout, Opening, Placed
from scene_graphs.layout_library import built_in_layouts
from scene_graphs.meshes.interior_mesh import wall_meshes

ROOM = Layout(
    "room",
    "bedroom",
    ((0.0, 0.0), (0.0, 5.0), (6.0, 5.0), (6.0, 0.0)),
    objects=(
        Placed("bed", "double_bed", (4.9, 0.0, 2.5), (1.6, 0.5, 2.0), -np.pi / 2),
        Placed("shelf", "bookshelf", (3.2, 0.0, 0.2), (0.9, 1.9, 0.35), 0.0),
    ),
    windows=(Opening(((0.0, 1.8), (0.0, 3.2)), 0.9, 2.1),),
)
HOME = home_from_layouts([ROOM], 0)
BLIND = home_from_layouts([replace(ROOM, windows=(), objects=ROOM.objects[:1])], 0)
LOOK, OPEN = ("loco", "stand still", "floor"), ("touch", "An act of reaching high", "bed")


def grounded(*rows: tuple[str, str, str], said: tuple[str, ...], home: Home = HOME) -> tuple[Action, ...]:
    keyframes = [Keyframe(skill=Skill(skill), caption=caption, furniture=thing) for skill, caption, thing in rows]
    places = [Place(0, None if thing == "floor" else f"0/{thing}") for _, _, thing in rows]
    return act(keyframes, places, home, 0, said=said)


@pytest.mark.parametrize(
    ("skill", "said", "asks"),
    [
        ("loco", "looks out of the window", True), ("loco", "watches the snow", True), ("loco", "stands still", False),
        ("touch", "opens the window", True), ("touch", "draws the heavy curtains", True),
        ("touch", "puts a vase on the table by the window", False), ("touch", "opens the drawer", False),
        ("touch", "opens a letter by the window", False), ("sitdown", "sits by the window", False),
    ],
)  # fmt: skip
def test_a_window_is_asked_for_by_who_looks_out_and_who_opens_it(skill: str, said: str, asks: bool) -> None:
    assert (opening_of(Skill(skill), said) == "window") == asks


def test_who_looks_out_of_the_window_goes_to_it_and_faces_out_of_it() -> None:
    (look,) = grounded(LOOK, said=("looks out of the window at the rain",))
    assert look.goal is not None
    assert look.facing is not None
    assert (look.stands, look.lacks) == (LOOKS_OUT, "")
    ahead = np.array([np.sin(look.facing), np.cos(look.facing)])
    x, z = np.asarray(look.goal) + look.goal[0] * ahead  # where the eyes meet the wall, which is at x = 0
    assert x == pytest.approx(0.0, abs=1e-9)
    assert 1.8 <= z <= 3.2
    assert look.goal[0] < 1.0
    (stays,) = grounded(LOOK, said=("stands there",))
    assert (stays.goal, stays.facing) == (None, None)


def test_who_opens_the_window_lays_a_hand_on_it_and_the_walk_leads_there() -> None:
    walk, touch = grounded(("loco", "walk", "bed"), OPEN, said=("opens the window",) * 2)
    assert touch.spot is not None
    assert touch.object_id == "window"
    assert touch.spot.point[0] == pytest.approx(0.0, abs=1e-9)
    assert ROOM.windows[0].bottom < touch.spot.point[1] < ROOM.windows[0].top
    assert walk.goal == touch.spot.standing
    motion = Director.of("procedural").act(
        HOME, touch, Director.of("procedural").begin(HOME, Character(), 0)
    )[0]  # fmt: skip
    assert motion.completed, motion.reason
    assert not motion.notes


@pytest.mark.parametrize("row", [LOOK, OPEN])
def test_without_a_window_it_is_done_without_one_and_the_motion_says_so(row: tuple[str, str, str]) -> None:
    (action,) = grounded(row, said=("opens the window and looks out of it",), home=BLIND)
    assert action.lacks == LACKS["window"]
    director = Director.of("procedural")
    motion, _ = director.act(BLIND, action, director.begin(BLIND, Character(), 0))
    assert LACKS["window"] in [note.words for note in motion.notes]


def test_in_nearly_all_rooms_one_can_stand_at_a_window_looking_straight_out_of_it() -> None:
    found = 0
    for layout in (some := built_in_layouts()[::25]):
        home = home_from_layouts([layout], 0)
        walkable = scene_of(home).walkable
        place = opening_place(home, walkable, "window", 0, None)
        if place is None:  # a table stands before the only one
            continue
        found += 1
        assert home.room_at(place.standing) == 0
        assert walkable.is_free(place.standing)
        ahead = np.array([np.sin(place.facing), np.cos(place.facing)])
        away = float(np.hypot(*np.subtract(place.middle, place.standing)))
        assert np.asarray(place.standing) + away * ahead == pytest.approx(np.asarray(place.middle), abs=1e-6)
        x, z = np.asarray(place.middle) + 0.3 * ahead
        assert home.room_at((float(x), float(z))) is None, "outside"
    assert found >= 0.9 * len(some)


def test_who_stretches_beside_a_bed_reaches_for_what_is_high_and_not_down_to_the_mattress() -> None:
    walk, touch = grounded(("loco", "walk", "bed"), OPEN, said=("stretches",) * 2)
    assert touch.spot is not None
    assert (touch.object_id, touch.spot.height) == ("0/shelf", "high")
    assert walk.goal == touch.spot.standing
    (low,) = grounded(OPEN, said=("stretches",), home=BLIND)
    assert low.object_id == "0/bed", "there is nothing else, and the body's own note says so"


DOOR = home_from_layouts([replace(ROOM, windows=(), doors=(Opening(((2.0, 0.0), (2.9, 0.0))),))], 0)
TURN = ("touch", "rotate with the right hand", "bed")


@pytest.mark.parametrize(
    ("skill", "said", "asks"),
    [
        ("touch", "slams the door behind her", True), ("touch", "answers the knock", True),
        ("touch", "lets the cat out", True), ("touch", "locks the front door", True),
        ("loco", "steadily walking forward; leaves", True), ("loco", "leaves the cup there", False),
        ("loco", "runs to the door", True), ("loco", "waits by the door", True),
        ("touch", "opens the fridge door", False), ("touch", "opens the door of the oven", False),
        ("touch", "opens the cupboard", False), ("loco", "walks to the cupboard door", False),
        ("sitdown", "sits by the door", False),
    ],
)  # fmt: skip
def test_a_door_is_asked_for_by_who_opens_it_and_who_goes_to_it(skill: str, said: str, asks: bool) -> None:
    assert (opening_of(Skill(skill), said) == "door") == asks


def test_who_opens_the_door_lays_a_hand_on_its_handle() -> None:
    walk, touch = grounded(("loco", "walk", "bed"), TURN, said=("opens the door",) * 2, home=DOOR)
    assert touch.spot is not None
    assert touch.object_id == "door"
    assert walk.goal == touch.spot.standing
    handles = [mesh for mesh in wall_meshes(DOOR) if mesh.name.startswith("door handle")]
    (handle,) = (np.asarray(mesh.vertices) for mesh in handles)
    assert (np.asarray(touch.spot.point) >= handle.min(axis=0) - 0.02).all()
    assert (np.asarray(touch.spot.point) <= handle.max(axis=0) + 0.02).all()
    director = Director.of("procedural")
    motion = director.act(DOOR, touch, director.begin(DOOR, Character(), 0))[0]
    assert motion.completed, motion.reason


def test_without_a_door_it_is_done_where_it_was_planned_and_noted() -> None:
    (touch,) = grounded(TURN, said=("opens the door",), home=BLIND)
    assert (touch.object_id, touch.lacks) == ("0/bed", LACKS["door"])


@pytest.mark.parametrize(
    ("said", "comes"),
    [
        ("comes home tired", True), ("gets in late", True), ("came back from the office", True), ("got home", True),
        ("bursts through the door", True), ("walks in circles", False), ("gets in bed", False),
        ("walks in the living room", False), ("gets up and comes to", False), ("paces up and down", False),
        ("is home alone", False), ("was home all day", False), ("came down in tears", False),
        ("is back from work", True), ("gets back to work", False), ("walks in soaked", True),
    ],
)  # fmt: skip
def test_who_comes_in_is_told_from_who_is_there(said: str, comes: bool) -> None:
    assert comes_in(said) == comes


def test_who_comes_in_begins_outside_the_door_looks_into_the_room_and_walks_in() -> None:
    rows = (("loco", "excited walk", "floor"), TURN)
    walk, _ = grounded(*rows, said=("comes home", "tidies"), home=DOOR)
    assert walk.begins is not None
    inside = entry(DOOR, scene_of(DOOR).walkable, 0)
    assert inside is not None
    assert walk.begins[2] == inside.inward
    assert walk.begins[1] < -0.2, "the door is at z = 0"
    stands, _ = grounded(("loco", "stand still", "floor"), TURN, said=("comes home", "tidies"), home=DOOR)
    assert stands.begins is not None
    assert stands.begins[:2] == inside.standing, "who only stands there does so inside"
    director = Director.of("procedural")
    state = director.begin(DOOR, Character(), 0, walk)
    x, _, z = state.pelvis
    assert np.hypot(x - walk.begins[0], z - walk.begins[1]) < 0.1
    motion = director.act(DOOR, walk, state)[0]
    assert motion.completed, motion.reason
    assert motion.root_positions[-1, 2] > 0.3
    assert grounded(*rows, said=("paces", "tidies"), home=DOOR)[0].begins is None
    assert grounded(*rows, said=("comes home", "tidies"), home=BLIND)[0].begins is None, "no door"


def test_who_leaves_the_room_last_of_all_goes_out_by_its_door_and_whoever_does_something_after_it_does_not() -> None:
    walk = ("loco", "walking quickly", "floor")
    (last,) = grounded(walk, said=("rushes out of the room",), home=DOOR)
    (out,) = grounded(walk, said=("rushes out of the door",), home=DOOR)
    before, _ = grounded(walk, walk, said=("rushes out of the room", "paces up and down"), home=DOOR)
    assert last.goal == out.goal
    assert before.goal != out.goal


def test_who_goes_out_walks_on_through_the_door_and_who_waits_by_it_stays_inside() -> None:
    (walk,) = grounded(("loco", "walking quickly", "floor"), said=("rushes out of the door",), home=DOOR)
    assert walk.goal is not None
    assert walk.goal[1] < -0.2, "the door is at z = 0"
    assert walk.stands == 0, "nobody is seen standing outside"
    director = Director.of("procedural")
    motion = director.act(DOOR, walk, director.begin(DOOR, Character(), 0))[0]
    assert motion.completed, motion.reason
    assert motion.root_positions[-1, 2] < -0.2
    (wait,) = grounded(("loco", "stand still", "floor"), said=("waits by the door",), home=DOOR)
    assert wait.goal is not None
    assert wait.goal[1] > 0.3
    (blind,) = grounded(("loco", "walking quickly", "floor"), said=("rushes out of the door",), home=BLIND)
    assert blind.lacks == LACKS["door"]
