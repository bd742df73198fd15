"""Doors, drawers and lights do what hands do to them: properties of every piece of which something moves."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from for_each import for_each
from sample_motions import standing_still

from motion_backend import rotations
from motion_backend.body.cast import Role, Worked, worked_from_dict, worked_to_dict
from motion_backend.formats.glb_film import props_glb
from motion_backend.motion import Does, Motion, Skill
from motion_backend.props import PropTrack, prop_tracks, works
from motion_backend.props.fixture_tracks import IN_THE_WAY, MOVES, RECOILS, SLAMS
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX
from scene_graphs.furniture import catalogue, typical_size
from scene_graphs.layout import Placed
from scene_graphs.meshes.moving_parts import mechanisms

LONG = 60
"""Frames of a keyframe."""
PIECES = [Placed("a", one, (0.0, 0.0, 0.0), typical_size(one)) for one in sorted(catalogue().categories)]
FRONTS, LIGHTS = ([one.category for one in PIECES if works(one, does)] for does in ("open", "on"))
AHEAD = 0.9
"""Metres from the body to the front that it stands before."""


def played(category: str, *does: Does | None, captions: str = "touch", yaw: float = 0.0) -> tuple[Motion, Role, Placed]:
    """Somebody who stands before a piece, a hand on its front, for one keyframe a deed."""
    motion = standing_still(LONG * len(does))
    motion = replace(motion, actions=np.repeat(np.arange(len(does)), LONG).astype(np.int32))
    size = typical_size(category)
    away = AHEAD + size[2] / 2
    piece = Placed(f"0/{category}_1", category, (-np.sin(yaw) * away, 0.0, -np.cos(yaw) * away), size, yaw)
    palm = motion.joint_positions()[0, INDEX["right_wrist"]]
    at = (float(palm[0]), float(palm[1]), float(palm[2]))
    worked = {number: Worked(one, piece, at) for number, one in enumerate(does) if one is not None}
    said = dict.fromkeys(range(len(does)), (Skill.TOUCH, captions))
    return motion, Role(captions=said, worked=worked), piece


def open_in(category: str, *does: Does | None, captions: str = "touch") -> Array:
    """In which frames anything of a piece is open, or on. (T,)."""
    motion, role, _ = played(category, *does, captions=captions)
    there = np.zeros(len(motion), dtype=bool)
    for track in prop_tracks(motion, role):
        there[track.start : track.stop] = True
    return there


def corners(track: PropTrack, frame: int) -> Array:
    """The vertices of what a track shows. (N, 3)."""
    return track.shape.moved(track.positions[frame], track.turns[frame], 1.0)[0].astype(np.float64)


def test_what_has_doors_drawers_or_a_light_is_known():
    assert {"refrigerator", "wardrobe", "cabinet", "dresser", "nightstand", "desk", "kitchen_cabinet"} <= {*FRONTS}
    assert {"floor_lamp", "table_lamp", "ceiling_lamp", "tv", "stove", "kitchen_sink"} <= {*LIGHTS}
    assert not {"dining_chair", "bookshelf", "double_bed", "dining_table"} & {*FRONTS, *LIGHTS}


@for_each("category", FRONTS)
def test_what_is_opened_is_open_until_it_is_shut(category: str):
    there = open_in(category, None, "open", None, "close", None)
    begins, ends = np.flatnonzero(there)[[0, -1]]
    assert there[begins : ends + 1].all()
    assert LONG <= begins <= LONG + 3
    assert 3 * LONG - 3 <= ends <= 3 * LONG


@for_each("category", FRONTS)
def test_what_nobody_shuts_stays_open_and_what_is_only_shut_stood_open(category: str):
    assert open_in(category, None, "open", None)[LONG + 3 :].all()
    there = open_in(category, None, "close", None)
    assert there[: LONG - 1].all()
    assert not there[LONG:].any()


@for_each("category", FRONTS)
def test_what_a_hand_reaches_into_is_shut_behind_it_unless_it_was_open(category: str):
    motion, role, _ = played(category, None, "into", None, None)
    there = open_in(category, None, "into", None, None)
    assert there[LONG + 5 : 2 * LONG - 1].all()
    assert not there[2 * LONG + round(MOVES * motion.fps) + 1 :].any()
    assert open_in(category, "open", "into", None, None)[5:].all()
    assert open_in(category, "into", None, "close", None)[5 : 2 * LONG - 1].all()
    assert role.worked[1].does == "into"


@for_each("category", LIGHTS)
def test_what_is_switched_on_shines_until_it_is_switched_off(category: str):
    there = open_in(category, None, "on", None, "off", None)
    begins, ends = np.flatnonzero(there)[[0, -1]]
    assert there[begins : ends + 1].all()
    assert (begins // LONG, ends // LONG) == (1, 3)
    assert open_in(category, None, "off", None)[:LONG].all()
    assert open_in(category, None, "on")[-1]


@for_each("category", FRONTS)
def test_a_door_stays_on_its_hinge_and_a_drawer_on_its_rails(category: str):
    motion, role, piece = played(category, None, "open", None, yaw=0.7)
    hole, leaf = (track for track in prop_tracks(motion, role) if "front" in track.prop)
    assert np.ptp(hole.positions, axis=0).max() < 1e-9
    assert np.ptp(hole.turns, axis=0).max() < 1e-9
    ways = piece.to_local(leaf.positions)
    turns = rotations.quat_to_matrix(rotations.compose(rotations.inverse(rotations.yaw_to_quat(piece.yaw)), leaf.turns))
    np.testing.assert_allclose(turns[:, 1, 1], 1.0, atol=1e-6)  # upright
    if np.ptp(turns, axis=0).max() > 1e-6:
        assert np.ptp(ways, axis=0).max() < 1e-9
        assert np.degrees(np.arccos(np.clip(turns[-1, 0, 0], -1, 1))) > 80
    else:
        assert np.ptp(ways[:, :2], axis=0).max() < 1e-9
        assert (np.diff(ways[:, 2]) >= -1e-9).all()
        assert ways[-1, 2] - ways[0, 2] > 0.1


@for_each("category", FRONTS)
def test_what_is_open_keeps_to_the_width_and_height_of_its_piece(category: str):
    motion, role, piece = played(category, None, "open", None)
    w, h, d = piece.size
    for track in prop_tracks(motion, role):
        for frame in range(0, len(track.positions), 7):
            x, y, z = piece.to_local(corners(track, frame)).T
            assert x.min() > -w / 2 - 0.02
            assert x.max() < w / 2 + 0.02
            assert y.min() > -0.01
            assert y.max() < h + 0.01
            assert z.min() > -d / 2 - 0.03
            assert z.max() < d / 2 + max(w, 0.4) + 0.02


@for_each("category", FRONTS)
def test_closed_it_hides_the_front_that_is_drawn(category: str):
    """Or the front would be seen through it: what moves stands before that, and not so far that it jumps."""
    piece = Placed("a", category, (0.0, 0.0, 0.0), typical_size(category))
    for one in mechanisms(piece):
        if one.kind == "front":
            hole, leaf = (np.concatenate([v for _, (v, _) in part.painted]) + part.pivot for part in one.moving)
            assert hole[:, 2].max() > one.high[2] + 0.012
            assert 0 < leaf[:, 2].max() - one.high[2] < 0.04
            np.testing.assert_allclose(hole[:, :2].min(axis=0), one.low[:2], atol=2e-3)
            np.testing.assert_allclose(hole[:, :2].max(axis=0), one.high[:2], atol=2e-3)


@for_each("category", ["wardrobe", "cabinet", "kitchen_cabinet", "refrigerator"])
def test_a_door_waits_for_the_body_and_opens_once_that_is_gone(category: str):
    motion, role, _ = played(category, "open", None, None)
    near = AHEAD - 0.3
    root = motion.root_positions.copy()
    root[: 2 * LONG, 2] = -near
    root[2 * LONG :, 2] = 3.0
    moved = replace(motion, root_positions=root)
    at = moved.joint_positions()[0, INDEX["right_wrist"]]
    role = replace(role, worked={0: replace(role.worked[0], at=(float(at[0]), float(at[1]), float(at[2])))})
    leaf = next(track for track in prop_tracks(moved, role) if track.prop.endswith("_1"))
    angle = 2 * np.arccos(np.clip(np.abs(leaf.turns[:, 3]), 0, 1))
    assert (np.diff(angle) >= -1e-6).all()
    assert np.degrees(angle[-1]) > 80
    for frame in range(2 * LONG - leaf.start):
        away = corners(leaf, frame)[:, [0, 2]] - moved.root_positions[leaf.start + frame, [0, 2]]
        assert np.linalg.norm(away, axis=1).min() > IN_THE_WAY - 0.05


def test_a_slam_is_quick_and_ends_as_the_hand_hits():
    there = open_in("cabinet", None, "close", None, captions="slamming with the right hand")
    motion, role, _ = played("cabinet", None, "close", None, captions="slamming with the right hand")
    leaf = next(track for track in prop_tracks(motion, role) if track.prop.endswith("_1"))
    speed = np.abs(np.diff(leaf.turns[:, 1]))
    moving = np.flatnonzero(speed > 1e-6)
    back = round(RECOILS[1] * motion.fps) + 1
    assert not there[LONG + back :].any(), "it is shut once it has sprung back"
    assert len(moving) <= round(SLAMS * motion.fps) + 1
    assert (np.diff(speed[moving[:-1]]) > 0).all(), "it flies faster and faster"


def test_a_hand_that_never_gets_there_opens_nothing():
    motion, role, _ = played("wardrobe", None, "open", None)
    far = {1: replace(role.worked[1], at=(5.0, 1.0, 0.0))}
    assert prop_tracks(motion, replace(role, worked=far)) == ()


def test_nothing_moves_in_a_story_that_opens_nothing():
    motion, role, _ = played("wardrobe", None, None)
    assert role.worked == {}
    assert prop_tracks(motion, role) == ()
    chair = Placed("0/chair_1", "dining_chair", (0.0, 0.0, -0.8), typical_size("dining_chair"))
    at_chair = replace(
        role, worked={0: Worked("open", chair, (0.0, 1.0, 0.0)), 1: Worked("on", chair, (0.0, 1.0, 0.0))}
    )
    assert prop_tracks(motion, at_chair) == ()


def test_it_is_of_the_world_and_not_of_the_hands():
    """Cameras look for what hands hold."""
    motion, role, _ = played("wardrobe", "open", "close")
    for track in prop_tracks(motion, role):
        assert track.held == ()
        assert not any(track.is_held(frame) for frame in range(len(motion)))


@pytest.mark.parametrize("category", ["floor_lamp", "tv"])
def test_what_shines_shines_in_a_glb(category: str):
    motion, role, _ = played(category, None, "on")
    data = props_glb(motion, role)
    document = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
    assert any(max(material.get("emissiveFactor", [0])) > 0.9 for material in document["materials"])
    for material in document["materials"]:
        values = material["pbrMetallicRoughness"]["baseColorFactor"] + material.get("emissiveFactor", [])
        assert all(0 <= value <= 1 for value in values)
    assert props_glb(motion, role) == data


def test_what_is_worked_survives_json():
    _, role, _ = played("wardrobe", "open", "into")
    for one in role.worked.values():
        assert worked_from_dict(json.loads(json.dumps(worked_to_dict(one)))) == one


def test_what_moves_sets_off_in_a_frame_and_what_stays_in_none() -> None:
    ways = np.array([[0.0, 0.0, 0.0]] * 5 + [[0.1, 0.0, 0.0]] * 5)
    track = PropTrack("door", 10, ways, np.tile(rotations.IDENTITY, (10, 1)), np.ones(10))
    assert track.sets_off(0, 30) == 14
    assert track.sets_off(15, 30) is track.sets_off(0, 14) is track.sets_off(40, 50) is None
