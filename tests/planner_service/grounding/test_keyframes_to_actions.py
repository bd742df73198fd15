"""Keyframes become actions that can be done: spots that can be walked to, hands, heights, and ends for every walk."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from for_each import for_each

from motion_backend.motion import Action, Emotion, Skill
from motion_backend.scene import scene_of
from planner_service.grounding.keyframes_to_actions import (
    Kept,
    Place,
    UnreachableError,
    act,
    can_stand,
    height_of,
    stays,
)
from planner_service.grounding.walk_direction import heading_after
from planner_service.scripts.script import Keyframe
from scene_graphs.affordances.affordances import spots
from scene_graphs.furniture import catalogue
from scene_graphs.home import Home, Room, home_from_layouts
from scene_graphs.layout import Layout, Placed
from scene_graphs.navigation.path_planner import Walkable

ROOM = Layout(
    "room",
    "living_room",
    ((0.0, 0.0), (0.0, 5.0), (6.0, 5.0), (6.0, 0.0)),
    objects=(
        Placed("sofa", "multi_seat_sofa", (5.4, 0.0, 2.5), (2.3, 0.85, 0.95), -np.pi / 2),
        Placed("shelf", "bookshelf", (3.2, 0.0, 0.2), (0.9, 1.9, 0.35), 0.0),
        Placed("stool", "stool", (1.0, 0.0, 4.0), (0.45, 0.45, 0.4), 0.0),
    ),
)
HOME = home_from_layouts([ROOM], 0)
WALKABLE = Walkable(HOME)


def keyframe(skill: str, caption: str = "x", furniture: str = "floor") -> Keyframe:
    return Keyframe(skill=Skill(skill), caption=caption, furniture=furniture, emotion="neutral")


def grounded(*rows: tuple[str, str, str | None], home: Home = HOME, seed: int = 0):
    keyframes = [keyframe(skill, caption, object_id or "floor") for skill, caption, object_id in rows]
    places = [Place(0, f"0/{object_id}" if object_id else None) for _, _, object_id in rows]
    return act(keyframes, places, home, seed)


def test_a_walk_ends_where_the_next_contact_with_the_same_thing_begins() -> None:
    walk, sit = grounded(("loco", "walk", "sofa"), ("sitdown", "sit", "sofa"))
    assert sit.spot is not None
    assert (walk.goal, walk.facing) == (sit.spot.standing, sit.spot.approach)


def test_a_walk_to_a_thing_nobody_uses_ends_beside_it() -> None:
    (walk,) = grounded(("loco", "walk", "shelf"))
    shelf = HOME.object("0/shelf")
    assert walk.goal is not None
    assert np.hypot(walk.goal[0] - shelf.position[0], walk.goal[1] - shelf.position[2]) < 1.2


def test_nothing_is_touched_through_a_wall() -> None:
    """Cabinets stand with their backs to every wall: behind some of them is free floor of the other room."""
    cabinets = tuple(
        Placed(
            f"cabinet_{number}",
            "cabinet",
            (2.0 + 1.82 * np.sin(yaw) + x, 0.0, 2.0 + 1.82 * np.cos(yaw) + z),
            (0.6, 1.2, 0.34),
            yaw + np.pi,
        )
        for number, (yaw, x, z) in enumerate(
            [(0.0, 1.2, 0.0), (np.pi / 2, 0.0, 1.2), (np.pi, 1.2, 0.0), (-np.pi / 2, 0.0, 1.2)]
        )
    )
    room = Layout("one", "study", ((0.0, 0.0), (0.0, 4.0), (4.0, 4.0), (4.0, 0.0)), objects=cabinets)
    home = home_from_layouts([room, replace(room, id="two")], 0)
    walkable = Walkable(home)
    start = walkable.random_point(np.random.default_rng(0), 0)
    beside = [(placed, spot) for placed in home.objects for spot in spots(placed, "touch")]
    through = [placed.id for placed, spot in beside if home.room_at(spot.standing) not in (None, int(placed.id[0]))]
    assert through
    for placed, spot in beside:
        if can_stand(walkable, start, spot):
            assert home.room_at(spot.standing) == int(placed.id[0])
    assert {placed.id for placed, spot in beside if can_stand(walkable, start, spot)} == {p.id for p in home.objects}


def test_wandering_goes_some_way_and_stays_on_free_floor() -> None:
    first, second = grounded(("loco", "walk", None), ("loco", "walk", None))
    assert first.goal is not None
    assert second.goal is not None
    assert WALKABLE.is_free(first.goal)
    assert WALKABLE.is_free(second.goal)
    assert np.hypot(first.goal[0] - second.goal[0], first.goal[1] - second.goal[1]) > 1.0


def test_who_wanders_on_turns_back_less_often_than_not_on_the_way_to_a_thing_too() -> None:
    back = []
    for seed in range(30):
        walks = grounded(("loco", "walk", None), ("loco", "walk", None), ("loco", "walk", "shelf"), seed=seed)
        ways = np.diff([scene_of(HOME).beginning(seed)[0], *(walk.goal for walk in walks)], axis=0)
        lengths = np.linalg.norm(ways, axis=1)
        assert lengths.min() > 0.5
        back += [float(one @ other) for one, other in pairwise(ways / lengths[:, None])]
    # In a room of 6 m many do all the same: 72 of 100 where it is not minded.
    assert np.mean(np.array(back) < -0.8) < 0.55


def test_the_first_walk_sets_out_from_where_the_body_begins() -> None:
    for seed in range(8):
        (walk,) = grounded(("loco", "walk", None), seed=seed)
        begins = scene_of(HOME).beginning(seed)[0]
        assert walk.goal is not None
        assert np.hypot(walk.goal[0] - begins[0], walk.goal[1] - begins[1]) > 1.0


def test_a_body_that_begins_shut_in_makes_no_home_unusable() -> None:
    """No door leads from the first room to the second."""
    room = Layout("one", "study", ((0.0, 0.0), (0.0, 4.0), (4.0, 4.0), (4.0, 0.0)))
    home = Home((Room(room, (0.0, 0.0, 0.0), 0.0), Room(replace(room, id="two"), (5.0, 0.0, 0.0), 0.0)), ())
    (walk,) = act([keyframe("loco", "walk")], [Place(1)], home, 0)
    assert walk.goal is not None
    assert home.room_at(walk.goal) == 1


@pytest.mark.parametrize("skill", ["sitdown", "liedown"])
def test_the_floor_can_be_sat_and_lain_on_where_there_is_room(skill: str) -> None:
    (action,) = grounded((skill, "x", None))
    assert action.spot is not None
    assert action.spot.point[1] == 0
    assert WALKABLE.clearance((action.spot.point[0], action.spot.point[2])) > 0.3


def test_a_body_looks_where_it_was_told_to_or_as_its_last_walk_came_in() -> None:
    walk = Action(Skill.LOCO, "walk", Emotion.NEUTRAL, goal=(4.0, 3.5))
    assert heading_after([(replace(walk, facing=0.7), (2.5, 2.0))], WALKABLE) == 0.7
    assert heading_after([(walk, (2.5, 2.0))], WALKABLE) == pytest.approx(np.arctan2(1.5, 1.5), abs=0.2)
    assert heading_after([(walk, (4.0, 2.0))], WALKABLE) == pytest.approx(0.0, abs=0.2)
    assert heading_after([(walk, None)], WALKABLE) is None


def test_nothing_can_be_touched_in_the_air() -> None:
    with pytest.raises(UnreachableError, match="moment 1"):
        grounded(("touch", "touch medium height", None))


def test_a_bed_walled_in_by_cupboards_is_refused_by_name() -> None:
    bed = Placed("bed", "single_bed", (0.6, 0.0, 1.0), (1.1, 0.5, 2.0), 0.0)
    beside = Placed("beside", "wardrobe", (1.5, 0.0, 1.3), (2.6, 2.0, 0.6), np.pi / 2)
    below = Placed("below", "wardrobe", (0.6, 0.0, 2.35), (1.2, 2.0, 0.6), 0.0)
    home = home_from_layouts([Layout("full", "bedroom", ROOM.floor_polygon, objects=(bed, beside, below))], 0)
    with pytest.raises(UnreachableError, match="0/bed"):
        grounded(("liedown", "lie", "bed"), home=home)


@for_each(
    ("caption", "height"),
    [
        ("An act of reaching high", "high"),
        ("touch medium height with the left hand", "medium"),
        ("Low touch from a prone position", "low"),
        ("touch", "medium"),
    ],
)
def test_the_caption_says_how_high_to_touch(caption: str, height: str) -> None:
    assert height_of(caption) == height
    (action,) = grounded(("touch", caption, "shelf"))
    assert action.spot is not None
    assert action.spot.height == height


def test_the_caption_names_the_hand() -> None:
    left, right = grounded(("touch", "touch with the left hand", "shelf"), ("touch", "touch medium height", "shelf"))
    assert (left.hand, right.hand) == ("left", "right")


def test_rising_knows_what_was_rested_on() -> None:
    sit, rise = grounded(("sitdown", "sit", "stool"), ("standup", "stand up", "stool"))
    assert rise.spot == sit.spot


def test_the_same_seed_grounds_alike() -> None:
    rows = (("loco", "walk", None), ("touch", "touch", "shelf"), ("liedown", "lie", None))
    assert grounded(*rows, seed=5) == grounded(*rows, seed=5)


@pytest.mark.parametrize(
    "caption", ["stand still", "wave with the right hand", "standing there, waving", "clapping hands", "squatting"]
)
def test_who_does_something_on_the_spot_goes_nowhere_and_takes_the_time_it_needs(caption: str) -> None:
    _, stay, _ = grounded(("touch", "touch", "shelf"), ("loco", caption, None), ("loco", "walk", None))
    assert (stay.goal, stay.facing) == (None, None)
    assert stay.hold == stays(caption) > 0
    # Who is to do it at a piece of furniture walks there first.
    (towards,) = grounded(("loco", caption, "shelf"))
    assert towards.goal is not None
    assert towards.stands >= stays(caption)
    (walk,) = grounded(("loco", "walk waving", None))
    assert walk.goal is not None


@for_each(("side", "sign"), [("left", 1), ("right", -1)])
@for_each("before", [("touch", "touch", "shelf"), ("sitdown", "sit", "sofa"), ("liedown", "lie", "sofa")])
def test_front_left_and_right_are_seen_from_the_body(before: tuple[str, str, str], side: str, sign: int) -> None:
    start, still, walk = grounded(before, ("loco", "stand still", None), ("loco", f"walk to the front {side}", None))
    assert start.spot is not None
    assert still.goal is None
    assert walk.goal is not None
    way = np.subtract(walk.goal, start.spot.standing)
    looks = start.spot.approach if before[0] == "liedown" else start.spot.facing
    turn = (np.arctan2(way[0], way[1]) - looks + np.pi) % (2 * np.pi) - np.pi
    if before[0] != "touch":  # before the shelf there is no room ahead: any walk will do
        assert 0.4 < sign * turn < 1.3
    assert WALKABLE.is_free(walk.goal)


def test_a_second_walk_to_the_front_goes_on_from_where_the_first_came_to() -> None:
    _, first, second = grounded(
        ("sitdown", "sit", "sofa"), ("loco", "walk to the front left", None), ("loco", "walk to the front right", None)
    )
    assert first.goal is not None
    assert second.goal is not None
    assert first.goal != second.goal


def test_the_free_hand_touches_while_the_other_holds_the_phone() -> None:
    phone = "walk while talking on the phone with the right hand"
    _, touch = grounded(("loco", phone, "shelf"), ("touch", "touch medium height", "shelf"))
    assert touch.hand == "left"


@for_each(("between", "stays"), [((), True), ((("loco", "walk", None),), False)])
def test_nobody_walks_round_a_thing_to_touch_it_again(between: tuple[tuple[str, str, None], ...], stays: bool) -> None:
    """The first touch is made to be on the side that has less room; who has walked on may come to the other."""
    table = Placed("table", "dining_table", (2.2, 0.0, 2.5), (1.4, 0.75, 1.4), 0.0)
    home = home_from_layouts([replace(ROOM, objects=(table,))], 0)
    rows = [("touch", "touch medium height", "table"), *between, ("touch", "touch medium height", "table")]
    keyframes = [keyframe(skill, caption, object_id or "floor") for skill, caption, object_id in rows]
    places = [Place(0, f"0/{object_id}" if object_id else None) for _, _, object_id in rows]
    narrow = min(spots(home.object("0/table"), "touch"), key=lambda spot: spot.standing[0])
    first = replace(act(keyframes[:1], places[:1], home, 0)[0], spot=narrow)
    last = act(keyframes, places, home, 0, kept=[Kept(first), *[None] * (len(rows) - 1)])[-1]
    assert last.spot is not None
    assert (np.hypot(*np.subtract(last.spot.standing, narrow.standing)) < 1.0) == stays


def _before_front(action: Action, home: Home) -> bool:
    """Whether one stands before the front of what one touches and looks at it."""
    assert action.spot is not None
    placed = home.object(action.spot.object_id)
    x, _, z = placed.to_local((action.spot.standing[0], 0.0, action.spot.standing[1]))
    return bool(z > placed.size[2] / 2 and abs(x) <= placed.size[0] / 2 and abs(action.spot.point[1]) < 2.2)


@pytest.mark.parametrize("category", ["cabinet", "wardrobe", "refrigerator", "dresser", "nightstand", "bookshelf"])
@pytest.mark.parametrize("yaw", [0.0, 1.2, np.pi / 2, np.pi, -2.0])
def test_hands_go_to_the_front_of_what_has_one_wherever_one_comes_from(category: str, yaw: float) -> None:
    size = catalogue().categories[category].size_m
    piece = Placed("piece", category, (3.0, 0.0, 2.5), size, yaw)
    home = home_from_layouts([replace(ROOM, objects=(piece, *ROOM.objects[2:]))], 0)
    for seed, caption in enumerate(("touch medium height", "touch low height with the left hand", "slam it shut")):
        *_, touch = grounded(("loco", "walk", None), ("touch", caption, "piece"), home=home, seed=seed)
        assert _before_front(touch, home), (caption, touch.spot)


def test_what_has_its_front_to_the_wall_is_touched_where_one_gets_to() -> None:
    piece = Placed("piece", "cabinet", (3.0, 0.0, 4.75), (1.1, 1.5, 0.42), 0.0)
    home = home_from_layouts([replace(ROOM, objects=(piece,))], 0)
    (touch,) = grounded(("touch", "touch medium height", "piece"), home=home)
    assert touch.spot is not None
    assert can_stand(Walkable(home), Walkable(home).random_point(np.random.default_rng(0), 0), touch.spot)
    assert not _before_front(touch, home)
