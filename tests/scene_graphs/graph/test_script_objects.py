"""Every script finds its own objects, in its own room first."""

from __future__ import annotations

import pytest

from scene_graphs.furniture import Furniture
from scene_graphs.graph.furniture_graph import graph_from_uses
from scene_graphs.graph.script_objects import ground_script
from scene_graphs.home import Home, Room
from scene_graphs.layout import Layout, Placed

SQUARE = ((0.0, 0.0), (0.0, 6.0), (6.0, 6.0), (6.0, 0.0))


@pytest.fixture(scope="module")
def home() -> Home:
    bedroom = (
        Placed("bed", "double_bed", (1.0, 0.0, 1.2), (1.6, 0.9, 2.0)),
        Placed("near", "dining_chair", (4.0, 0.0, 4.2), (0.5, 0.9, 0.5)),
        Placed("far", "dining_chair", (1.0, 0.0, 5.0), (0.5, 0.9, 0.5)),
        Placed("desk", "desk", (4.0, 0.0, 5.0), (1.4, 0.75, 0.6)),
    )
    study = (
        Placed("shelf", "bookshelf", (1.0, 0.0, 0.3), (1.0, 1.9, 0.3)),
        Placed("chair", "office_chair", (2.0, 0.0, 2.0), (0.6, 0.9, 0.6)),
    )
    rooms = (Room(Layout("a", "bedroom", SQUARE, objects=bedroom)), Room(Layout("b", "study", SQUARE, objects=study)))
    return Home((rooms[0], Room(rooms[1].layout, (6.12, 0.0, 0.0))), ())


def test_the_chair_by_the_desk_is_the_one_used_with_the_desk(home: Home) -> None:
    script = graph_from_uses([("chair", 1), ("desk", 1)], [{"sit"}, {"touch"}])
    grounding = ground_script(script, home, 0)
    assert grounding.objects == {Furniture("chair"): "0/near", Furniture("desk"): "0/desk"}
    assert not grounding.missing


def test_a_script_plays_in_its_own_room(home: Home) -> None:
    script = graph_from_uses([("chair", 1)], [{"sit"}])
    assert ground_script(script, home, 1).objects == {Furniture("chair"): "1/chair"}
    assert ground_script(script, home, 0).objects[Furniture("chair")].startswith("0/")


def test_only_what_its_room_lacks_comes_from_another(home: Home) -> None:
    script = graph_from_uses([("chair", 1), ("bookshelf", 1)], [{"sit"}, {"touch"}])
    objects = ground_script(script, home, 0).objects
    assert objects[Furniture("bookshelf")] == "1/shelf"
    assert objects[Furniture("chair")].startswith("0/")


def test_what_is_nowhere_is_missing(home: Home) -> None:
    script = graph_from_uses([("piano", 1), ("bed", 1)], [{"touch"}, {"lie"}])
    grounding = ground_script(script, home)
    assert grounding.missing == (Furniture("piano", 1),)
    assert grounding.objects == {Furniture("bed"): "0/bed"}


def test_substitutions_are_told(home: Home) -> None:
    grounding = ground_script(graph_from_uses([("stool", 1)], [{"sit"}]), home, 0)
    assert grounding.levels[Furniture("stool")] == "class"


def test_an_object_that_cannot_be_used_is_passed_over(home: Home) -> None:
    script = graph_from_uses([("chair", 1), ("desk", 1)], [{"sit"}, {"touch"}])
    grounding = ground_script(script, home, 0, offers={"0/near": frozenset()})
    assert grounding.objects[Furniture("chair")] == "0/far"


def test_two_chairs_are_two_objects(home: Home) -> None:
    script = graph_from_uses([("chair", 1), ("desk", 1), ("chair", 2)], [{"sit"}, {"touch"}, {"sit"}])
    assert set(ground_script(script, home, 0).objects.values()) == {"0/near", "0/far", "0/desk"}
