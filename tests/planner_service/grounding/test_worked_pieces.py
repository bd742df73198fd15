"""Which piece of a home is meant by a hand on it, and doors and curtains of rooms as pieces: as they are drawn."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from for_each import for_each

from motion_backend.body.cast import worked_from_dict, worked_to_dict
from motion_backend.formats.glb_film import props_glb
from motion_backend.motion import Action, Emotion, Skill
from planner_service import Pipeline, StoryRequest
from planner_service.grounding.opening_places import opening_piece
from planner_service.grounding.worked_pieces import worked_pieces
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
    assert piece.to_world(swung + np.array(leaf.pivot))[:, 2].max() > 5.6  # outside


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


def test_curtains_and_the_day_are_seen_from_the_room_alone():
    """Or they would hide who is seen past a wall that is cut away."""
    for is_door in (True, False):
        piece = opening_piece(HOME, is_door, (1.4, 4.5))
        assert piece is not None
        (one,) = mechanisms(piece)
        for moving in one.moving[:1] if is_door else one.moving:
            vertices, faces = moving.painted[0][1]
            a, b, c = (vertices[faces[:, corner]] for corner in range(3))
            assert (np.cross(b - a, c - a)[:, 2] > 0).all()


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
