"""Which piece of a home is meant by a hand on it, and doors and curtains of rooms as pieces: as they are drawn."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest
import shapely
from for_each import for_each

from motion_backend import rotations
from motion_backend.body.cast import Worked, worked_from_dict, worked_to_dict
from motion_backend.formats.glb_film import props_glb
from motion_backend.motion import Action, Emotion, PhaseKind, Skill
from motion_backend.props import prop_tracks
from motion_backend.props.prop_hands import Hands
from planner_service import Pipeline, StoryRequest
from planner_service.grounding.opening_places import opening_piece
from planner_service.grounding.worked_pieces import worked_pieces
from planner_service.pipeline import Story
from planner_service.scripts.script import LongScript, PlannedKeyframe
from scene_graphs.affordances.affordances import spots
from scene_graphs.home import home_from_layouts
from scene_graphs.layout import Layout, Opening, Placed
from scene_graphs.meshes.interior_mesh import wall_meshes
from scene_graphs.meshes.mesh_primitives import Mesh
from scene_graphs.meshes.moving_parts import Moving, mechanisms

ROOM = Layout(
    "room",
    "living_room",
    ((0.0, 0.0), (0.0, 5.0), (6.0, 5.0), (6.0, 0.0)),
    objects=(
        Placed("stand", "tv_stand", (3.0, 0.0, 0.3), (1.6, 0.5, 0.44), 0.0),
        Placed("tv", "tv", (3.0, 0.5, 0.3), (1.2, 0.7, 0.1), 0.0, "stand"),
        Placed("cabinet", "cabinet", (5.5, 0.0, 2.5), (1.1, 1.5, 0.42), -np.pi / 2),
        Placed("sofa", "multi_seat_sofa", (3.0, 0.0, 2.6), (2.0, 0.85, 0.95), np.pi),
    ),
    doors=(Opening(((1.0, 5.0), (1.9, 5.0)), 0.0, 2.05),),
    windows=(Opening(((0.0, 1.8), (0.0, 3.2)), 0.9, 2.1),),
)
HOME = home_from_layouts([ROOM], 0)


def touched(piece: str, furniture: str, **words: str) -> tuple[Action, LongScript]:
    """A hand on a piece, as a script's only keyframe."""
    caption = words.pop("caption", "touch medium height")
    keyframe = PlannedKeyframe.model_validate({"skill": "touch", "caption": caption, "furniture": furniture, **words})
    spot = spots(HOME.object(f"0/{piece}"), "touch")[0]
    action = Action(Skill.TOUCH, caption, Emotion.NEUTRAL, furniture, object_id=spot.object_id, spot=spot)
    return action, LongScript(theme="", beats=(), short_scripts=(), keyframes=(keyframe,), seed=0)


def worked(piece: str, furniture: str, **words: str) -> list[tuple[str, str]]:
    action, script = touched(piece, furniture, **words)
    return [(one.does, one.piece.id) for one in worked_pieces([action], script, HOME).values()]


@pytest.mark.parametrize(
    ("piece", "furniture", "words", "found"),
    [
        ("stand", "tv stand", {"does": "on"}, [("on", "0/tv")]),
        ("stand", "tv stand", {"does": "open"}, [("open", "0/stand")]),
        ("cabinet", "cabinet", {"does": "into"}, [("into", "0/cabinet")]),
        ("cabinet", "wardrobe", {"does": "open"}, [("open", "0/cabinet")]),
        ("cabinet", "curtain", {"does": "open"}, []),
        ("cabinet", "cabinet", {"does": "on"}, []),
        ("cabinet", "cabinet", {}, []),
        ("sofa", "sofa", {"does": "open"}, []),
        ("cabinet", "cabinet", {"caption": "slamming with the right hand"}, [("close", "0/cabinet")]),
    ],
)
def test_the_piece_under_the_hand_or_what_stands_on_it_is_meant_where_it_has_what_moves(piece, furniture, words, found):
    assert worked(piece, furniture, **words) == found


def box(mesh: Mesh) -> np.ndarray:
    return np.array([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)])


def at(piece: Placed, moving: Moving, share: float) -> np.ndarray:
    """The vertices of something that moves along its way, in the home. (N, 3)."""
    points = np.concatenate([vertices for _, (vertices, _) in moving.painted])
    return piece.to_world(points + np.array(moving.pivot) + share * np.array(moving.way))


def test_the_leaf_of_a_door_is_the_one_that_is_drawn():
    piece = opening_piece(HOME, True, (1.4, 4.5))
    assert piece is not None
    (one,) = mechanisms(piece)
    leaf = one.moving[-1]
    drawn = {mesh.name.split(" ")[1]: box(mesh) for mesh in wall_meshes(HOME) if mesh.name.startswith("door ")}
    closed = at(piece, leaf, 0.0)
    x, _, z = closed.T
    assert np.ptp(x) == pytest.approx(np.ptp(drawn["leaf"][:, 0]), abs=2e-3)
    np.testing.assert_allclose([x.min(), x.max()], drawn["leaf"][:, 0], atol=2e-3)
    assert z.max() == pytest.approx(drawn["leaf"][1, 2], abs=2e-3)
    assert drawn["handle"][0, 2] == pytest.approx(z.min(), abs=0.01)
    hinge = piece.to_world(leaf.pivot)
    handle = drawn["handle"].mean(axis=0)
    assert abs(hinge[0] - handle[0]) > 0.6  # on the other side
    cos, sin = np.cos(leaf.turn), np.sin(leaf.turn)
    points = np.concatenate([vertices for _, (vertices, _) in leaf.painted])
    swung = np.stack(
        [cos * points[:, 0] + sin * points[:, 2], points[:, 1], cos * points[:, 2] - sin * points[:, 0]], 1
    )
    assert piece.to_world(swung + np.array(leaf.pivot))[:, 2].min() < 4.4  # into the room


def test_drawn_curtains_cover_their_window_and_open_ones_hang_where_they_always_do():
    piece = opening_piece(HOME, False, (0.5, 2.5))
    assert piece is not None
    (one,) = mechanisms(piece)
    hanging = box(next(mesh for mesh in wall_meshes(HOME) if mesh.name.startswith("window curtain")))
    shut = np.concatenate([at(piece, fold, 1.0) for fold in one.moving])
    opened = np.concatenate([at(piece, fold, 0.0) for fold in one.moving])
    covered = np.sort(np.concatenate([np.linspace(v[:, 2].min(), v[:, 2].max(), 20)
                                      for v in (at(piece, fold, 1.0) for fold in one.moving)]))  # fmt: skip
    assert covered[0] <= 1.83
    assert covered[-1] >= 3.17
    assert np.diff(covered).max() < 0.01
    np.testing.assert_allclose([shut[:, 1].min(), shut[:, 1].max()], hanging[:, 1], atol=1e-3)
    assert opened[:, 2].min() > hanging[0, 2] - 0.03
    assert opened[:, 2].max() < hanging[1, 2] + 0.03
    assert not ((opened[:, 2] > 1.9) & (opened[:, 2] < 3.1)).any()


def test_curtains_and_the_hall_outside_are_seen_from_the_room_alone():
    """Or they would hide who is seen past a wall that is cut away."""
    for is_door in (True, False):
        piece = opening_piece(HOME, is_door, (1.4, 4.5))
        assert piece is not None
        (one,) = mechanisms(piece)
        eye = np.array([0.0, 1.5, 0.3 if is_door else 3.0])
        for moving in one.moving[:1] if is_door else one.moving:
            for _, (vertices, faces) in moving.painted:
                a, b, c = (vertices[faces[:, corner]] + np.array(moving.pivot) for corner in range(3))
                assert (np.sum(np.cross(b - a, c - a) * (eye - a), axis=1) > 0).all()


def test_there_is_floor_and_a_wall_behind_an_open_door_for_as_far_as_somebody_goes_out():
    piece = opening_piece(HOME, True, (1.4, 4.5))
    assert piece is not None
    (one,) = mechanisms(piece)
    hall = np.concatenate([piece.to_world(vertices) for _, (vertices, _) in one.moving[0].painted])
    assert hall[:, 2].min() == pytest.approx(5.0)
    assert hall[:, 2].max() > 6.2
    assert (hall[:, 0].min(), hall[:, 0].max()) < (0.9, 2.0)
    assert hall[:, 1].max() > 2.5
    assert shapely.intersects_xy(HOME.thresholds, 1.45, 6.2)


def test_who_comes_home_has_the_door_open_behind_and_shut_then():
    story = Pipeline().make(StoryRequest("She comes home and reads on the sofa.", seed=3))
    first = story.role.worked.get(0)
    assert first is not None
    assert (first.does, first.piece.category) == ("close", "room_door")
    assert story.actions[0].begins


@for_each(
    "theme",
    [
        "A tired woman comes home and falls asleep on the sofa.",
        "She opens the curtains and switches on the lamp.",
        "He opens the wardrobe, takes out a coat and closes it.",
    ],
)
def test_what_hands_do_to_pieces_is_the_same_after_it_was_kept(theme: str) -> None:
    story = Pipeline().make(StoryRequest(theme))
    assert story.role.worked
    kept = {at: worked_from_dict(json.loads(json.dumps(worked_to_dict(one)))) for at, one in story.role.worked.items()}
    again = props_glb(story.motion, replace(story.role, worked=kept))
    assert again == props_glb(story.motion, story.role)


FASTEST = np.radians(220.0)
"""A second, of what swings; what slides goes at most as fast as a hand that pulls (metres a second):"""
SLIDES = 2.2
AT_HAND = 0.15
"""A hand that opens or shuts a front is no farther from its handle than this (metres)."""


@for_each(
    "theme",
    [
        "A man walks to the front door, opens it, looks out and closes it again.",
        "He opens the fridge, takes out a bottle, drinks and closes the fridge.",
        "He opens a drawer, takes out a letter and reads it.",
        "She opens the wardrobe, takes out a dress and closes the wardrobe.",
        "He grabs his bag and walks out of the door.",
    ],
)
def test_what_is_opened_moves_with_the_hand_on_its_handle_and_no_faster_than_that(theme: str) -> None:
    """But for a door that is passed: pushed wide on the way through, and shut behind who has gone out by it."""
    story = Pipeline().make(StoryRequest(theme))
    hands = Hands.of(story.motion)
    worked = [one for one in story.role.worked.values() if one.handle is not None]
    assert worked
    leaves = [track for track in prop_tracks(story.motion, story.role) if re.search(r"front\d+_1$", track.prop)]
    assert leaves
    for leaf in leaves:
        mine = [one for one in worked if leaf.prop.startswith(re.sub(r"\W+", "_", one.piece.id))]
        turned = np.linalg.norm(
            rotations.quat_to_rotvec(rotations.compose(rotations.inverse(leaf.turns[:-1]), leaf.turns[1:])), axis=1
        )
        slid = np.linalg.norm(np.diff(leaf.positions, axis=0), axis=1)
        assert turned.max() * story.motion.fps < FASTEST
        assert slid.max() * story.motion.fps < SLIDES
        moves = leaf.start + np.flatnonzero((turned > 1e-3) | (slid > 1e-3))
        assert len(moves)
        assert not all(_is_passing(story, frame, mine[0]) for frame in moves)
        for frame in moves:
            if _is_passing(story, frame, mine[0]):
                continue
            gaps = [
                np.linalg.norm(one.handle.at(np.linspace(0, 1, 50)) - hands.wrists_at[frame, side], axis=1).min()
                for one in mine
                for side in [0 if one.hand == "left" else 1]
                if one.handle is not None
            ]
            assert min(gaps) < AT_HAND


def _is_passing(story: Story, frame: np.integer, worked: Worked) -> bool:
    """Whether somebody walks through a door, a hand no longer on it."""
    phase = next((one.kind for one in story.motion.phases if one.start <= frame < one.stop), None)
    return worked.piece.category == "room_door" and phase is PhaseKind.WALK
