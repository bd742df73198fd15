"""What is named is what is seen: in the place of a caption's own prop, taken, carried, put down and left lying."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from functools import cache

import numpy as np
import pytest
from for_each import for_each

from motion_backend import rotations
from motion_backend.body.cast import InHand, Role, acted_captions, named_things, thing_from_dict
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Motion, Skill
from motion_backend.props import PropTrack, held_in, prop_shape, prop_tracks, shown_as
from motion_backend.props.prop_table import prop_table, things_named
from motion_backend.rendering.motion_figures import Acting, lying_solids
from motion_backend.rendering.rasterizer import Camera
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX
from planner_service.evaluation.trials import Performance, perform
from planner_service.output.caption_sheets import trial_of

TAKES, PUTS, TOUCHES = "pick up with the right hand", "put down with the right hand", "touch medium height"
SIP = "drinking while standing, cup in the right hand"
IN_HAND = 0.35
"""Metres from the palm to the nearest point of what is in the hand."""


@cache
def acted(skill: Skill, caption: str) -> Performance:
    return perform(trial_of(skill, caption, None, 0))


def named(done: Performance, things: dict[int, str], on_top: bool = True) -> Role:
    """The role of who acts it, with what is named in some keyframes."""
    actions = [replace(one, holds=things.get(one.keyframe)) for one in done.actions]
    found = {index: replace(one, on_top=on_top) for index, one in named_things(actions).items()}
    return Role(captions=acted_captions(actions), things=found)


def seen(caption: str, things: dict[int, str]) -> tuple[Motion, tuple[PropTrack, ...]]:
    done = acted(Skill.TOUCH, caption)
    return done.motion, prop_tracks(done.motion, named(done, things))


def corners(track: PropTrack, frame: int) -> Array:
    now = frame - track.start
    moved, _ = prop_shape(track.prop).moved(track.positions[now], track.turns[now], float(track.sizes[now]))
    return moved.astype(np.float64)


def palm(motion: Motion, frame: int) -> Array:
    body = Kinematics.of(motion)
    wrist = INDEX["right_wrist"]
    return np.asarray(
        body.positions[frame, wrist] + rotations.rotate(body.world[frame, wrist], np.array([-0.075, -0.02, 0.0]))
    )


def test_every_noun_has_a_shape_a_way_to_hold_it_and_is_called_so_by_itself_or_behind_another_word() -> None:
    for word, rows in things_named().items():
        told = word.replace("-", " ")
        assert shown_as(told) in rows
        assert shown_as(f"old {told}") in rows
        assert all(len(prop_shape(row.shape).faces) > 5 for row in rows)
    assert len(things_named()) > 300
    assert shown_as("dragon") is None
    assert shown_as("") is None


def test_who_stands_in_for_a_prop_is_of_its_size_or_less() -> None:
    """What both hands hold apart fits between them; what a hand holds is no larger than what one can."""
    for row in prop_table().called:
        for prop in row.instead:
            own, other = (np.ptp(prop_shape(name).vertices, axis=0).max() for name in (row.shape, prop))
            assert own < max(3.0 * other, 0.45), (row.shape, prop)


@for_each(
    ("skill", "caption", "thing", "props"),
    [
        (Skill.LOCO, SIP, "beer", ["bottle"]),
        (Skill.LOCO, SIP, "wine", ["wine_glass"]),
        (Skill.LOCO, SIP, "coffee", ["cup"]),
        (Skill.LOCO, SIP, "dragon", ["cup"]),
        (Skill.LOCO, SIP, "suitcase", ["cup"]),
        (Skill.TOUCH, "pouring with the right hand", "wine", ["bottle"]),
        (Skill.TOUCH, "stirring with the right hand", "soup", ["spoon", "pot"]),
        (Skill.LOCO, "carrying with both hands", "birthday cake", ["cake"]),
        (Skill.SITDOWN, "reading, book held in both hands", "newspaper", ["newspaper"]),
        (Skill.SITDOWN, "reading, book held in both hands", "book", ["book"]),
        (Skill.SITDOWN, "hugging to the chest while seated", "teddy bear", ["teddy"]),
    ],
)
def test_what_is_named_is_held_in_the_place_of_a_captions_own_prop(
    skill: Skill, caption: str, thing: str, props: list[str]
) -> None:
    held = held_in(skill, caption, thing)
    assert held is not None
    assert [grip.prop for grip in held.props] == props


def test_what_hands_hold_for_want_of_a_name_makes_room_for_what_one_hand_carries() -> None:
    assert held_in(Skill.LOCO, "carrying with both hands", "glass of water") is None
    assert held_in(Skill.LOCO, "carrying with both hands", "dragon") == held_in(Skill.LOCO, "carrying with both hands")


def test_a_named_drink_is_where_the_mug_would_be() -> None:
    done = acted(Skill.LOCO, SIP)
    keyframe = done.actions[-1].keyframe
    (mug,) = prop_tracks(done.motion, named(done, {}))
    (beer,) = prop_tracks(done.motion, named(done, {keyframe: "beer"}))
    assert (mug.prop, beer.prop) == ("cup", "bottle")
    assert mug.start == beer.start
    far = np.linalg.norm(mug.positions - beer.positions, axis=1)
    assert far[np.linalg.norm(mug.positions - head(done.motion)[mug.start :][: len(far)], axis=1) > 0.5].max() < 1e-9
    assert far.max() < 0.25, "at the mouth each is tipped in its own way"


def head(motion: Motion) -> Array:
    return Kinematics.of(motion).positions[:, INDEX["head"]]


def test_names_that_nobody_knows_change_nothing() -> None:
    done = acted(Skill.LOCO, SIP)
    plain, odd = (
        prop_tracks(done.motion, named(done, dict.fromkeys((one.keyframe for one in done.actions), thing)))
        for thing in ("", "dragon")
    )
    assert [(one.prop, one.start, one.positions.tobytes()) for one in plain] == [
        (one.prop, one.start, one.positions.tobytes()) for one in odd
    ]
    touched = acted(Skill.TOUCH, TAKES)
    assert prop_tracks(touched.motion, named(touched, {1: "dragon"})) == ()


@for_each("thing", ["letter", "bottle", "suitcase", "plate", "keys"])
def test_what_is_picked_up_lies_there_until_a_hand_comes_and_is_in_the_hand_from_then_on(thing: str) -> None:
    motion, (track,) = seen(TAKES, {1: thing})
    assert (track.start, track.stop) == (0, len(motion))
    ((taken, end),) = track.held
    assert end == len(motion)
    assert track.lifts == (taken,)
    assert np.ptp(track.positions[: taken - 10], axis=0).max() == 0.0
    for frame in range(taken + 10, len(motion), 5):
        away = np.linalg.norm(corners(track, frame) - palm(motion, frame), axis=1).min()
        assert away < IN_HAND, frame
    assert np.linalg.norm(track.positions[taken] - palm(motion, taken)) < 0.6


@for_each("thing", ["letter", "bottle", "suitcase", "plate", "cake", "keys"])
def test_what_is_put_down_comes_in_the_hand_and_stays_where_it_was_put_on_what_is_there(thing: str) -> None:
    done = acted(Skill.TOUCH, PUTS)
    role = named(done, {0: thing, 1: thing})
    (track,) = prop_tracks(done.motion, role)
    frames, at = len(done.motion), role.things[1].at
    assert at is not None
    (first, *_) = track.held
    assert first[0] < done.actions[1].keyframe * frames / 2
    assert track.stop == frames
    assert track.lies(frames - 10, frames)
    resting = corners(track, frames - 1)
    assert resting[:, 1].min() == pytest.approx(at[1], abs=1e-4)
    assert np.linalg.norm((resting.min(axis=0) + resting.max(axis=0))[[0, 2]] / 2 - np.array(at)[[0, 2]]) < 0.5


@for_each(("thing", "high"), [("coat", 0.12), ("umbrella", 0.12), ("letter", 0.02), ("bottle", 1.0)])
def test_a_coat_that_is_put_down_lies_and_does_not_stand(thing: str, high: float) -> None:
    done = acted(Skill.TOUCH, PUTS)
    (track,) = prop_tracks(done.motion, named(done, {0: thing, 1: thing}))
    extent = np.ptp(corners(track, len(done.motion) - 1), axis=0)
    assert extent[1] < high
    assert (extent[1] == extent.min()) == (thing != "bottle")


def test_what_a_hand_is_only_laid_on_stays_where_it_lies() -> None:
    motion, (track,) = seen(TOUCHES, {1: "letter"})
    assert track.held == ()
    assert track.lies(0, len(motion))


def test_what_is_kept_in_furniture_comes_out_of_it_and_goes_into_it() -> None:
    taking, putting = acted(Skill.TOUCH, TAKES), acted(Skill.TOUCH, PUTS)
    (out,) = prop_tracks(taking.motion, named(taking, {1: "milk"}, on_top=False))
    assert out.start > 0
    assert out.lying is not None
    assert not out.lying.any()
    (into,) = prop_tracks(putting.motion, named(putting, {0: "milk", 1: "milk"}, on_top=False))
    assert into.stop < len(putting.motion)
    assert into.sizes[-1] < 0.2


@for_each(
    ("caption", "things"), [(TAKES, {1: "bucket"}), (PUTS, {0: "bucket", 1: "bucket"}), (TAKES, {0: "bag", 1: "bag"})]
)
def test_a_thing_goes_softly_from_table_to_hand_and_is_there_once(caption: str, things: dict[int, str]) -> None:
    motion, found = seen(caption, things)
    (track,) = found
    assert np.linalg.norm(np.diff(track.positions, axis=0), axis=1).max() < 0.2
    assert np.abs(np.diff(track.sizes)).max() < 0.35
    again = prop_tracks(motion, named(acted(Skill.TOUCH, caption), things))
    assert [one.positions.tobytes() for one in again] == [track.positions.tobytes()]


def test_a_drink_that_is_carried_to_where_it_is_drunk_is_one_thing_all_the_way() -> None:
    done = acted(Skill.LOCO, SIP)
    middle = len(done.motion) // 3
    motion = replace(done.motion, actions=(np.arange(len(done.motion)) >= middle).astype(np.int32))
    said = {0: (Skill.LOCO, "smoothly forward walk"), 1: (Skill.LOCO, SIP)}
    role = Role(captions=said, things={0: InHand("beer"), 1: InHand("beer")})
    (track,) = prop_tracks(motion, role)
    assert track.prop == "bottle"
    assert (track.start, track.stop) == (0, len(motion))
    for frame in range(0, len(motion), 7):
        assert np.linalg.norm(corners(track, frame) - palm(motion, frame), axis=1).min() < IN_HAND
    (mug,) = prop_tracks(motion, Role(captions=said))
    assert len(track.lifts) == len(mug.lifts) == 1
    assert mug.start == middle
    assert np.linalg.norm(track.positions[mug.start + 12 : mug.stop] - mug.positions[12:], axis=1).max() < 0.25


def test_hands_that_hold_something_else_hold_nothing_that_was_carried() -> None:
    done = acted(Skill.LOCO, "carrying with both hands")
    middle = len(done.motion) // 2
    motion = replace(done.motion, actions=(np.arange(len(done.motion)) >= middle).astype(np.int32))
    said = {0: (Skill.LOCO, "smoothly forward walk"), 1: (Skill.LOCO, "carrying with both hands")}
    found = prop_tracks(motion, Role(captions=said, things={0: InHand("beer")}))
    assert [track.prop for track in found] == ["bottle", "box"]
    assert found[0].stop <= found[1].start


def test_things_in_the_hands_come_back_from_what_a_service_keeps_of_them() -> None:
    done = acted(Skill.TOUCH, TAKES)
    for thing in named(done, {0: "red cup", 1: "letter"}).things.values():
        assert thing_from_dict(json.loads(json.dumps(asdict(thing)))) == thing


def test_what_lies_still_can_be_drawn_once_with_the_home_instead_of_with_the_body() -> None:
    done = acted(Skill.TOUCH, TAKES)
    acting = Acting.of(done.motion, named(done, {1: "plate"}))
    (track,) = acting.props
    assert acting.lying(0, 15) == [track]
    assert acting.lying(0, len(done.motion)) == []
    (whole,), (bare,) = acting.solids([5]), acting.solids([5], but=acting.lying(0, 15))
    assert len(whole.faces) - len(bare.faces) == len(prop_shape("plate").faces)
    x, y, z = track.positions[5].tolist()
    near, far = (Camera((at, 3.0, z + 2.0), (at, y, z)) for at in (x, 90.0))
    (drawn,) = lying_solids([track], 5, near)
    np.testing.assert_allclose(drawn.vertices, whole.vertices[len(bare.vertices) :], atol=1e-6)
    assert lying_solids([track], 5, far) == []
