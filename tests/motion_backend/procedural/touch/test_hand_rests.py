"""Hands lie on the body: on its skin, on the side they are meant for, and on bodies of every size alike."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from for_each import for_each

from motion_backend import rotations
from motion_backend.body import capsules
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import standing
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.pose_solver import solve
from motion_backend.procedural.touch.hand_rests import HOLDS, at_rest, on_thing, sliding
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton, build_skeleton

ON_FOLDED_LEGS = "clasped"
"""Round both knees: not on the skin of a body that stands."""


@cache
def stood(height: float) -> tuple[Pose, Skeleton]:
    skeleton = build_skeleton(height)
    return standing((0.0, 0.0), 0.0, Bearing(), skeleton), skeleton


@cache
def rested(name: str, height: float) -> Pose:
    """Both hands there."""
    pose, skeleton = stood(height)
    return at_rest(pose, (HOLDS[name], HOLDS[name]), skeleton)


def distance(skeleton: Skeleton, points: Array) -> Array:
    """Metres from the skin of a body in its rest pose, below 0 in it. (P, 3) to (P,)."""
    world = np.tile(rotations.IDENTITY, (1, len(skeleton.names), 1))
    starts, ends, radii = capsules.placed(skeleton, skeleton.rest_positions[None], world)
    along = ends[0] - starts[0]
    away = points[:, None] - starts[0]
    share = np.clip((away * along).sum(axis=-1) / np.maximum((along**2).sum(axis=-1), 1e-9), 0.0, 1.0)
    return (np.linalg.norm(away - share[..., None] * along, axis=-1) - radii).min(axis=1)


@for_each("name", [name for name in HOLDS if name != ON_FOLDED_LEGS])
def test_what_a_hand_lies_on_is_skin_and_its_way_out_leads_out(name: str) -> None:
    hold, skeleton = HOLDS[name], build_skeleton(1.7)
    skin = skeleton.rest_positions[INDEX[hold.part]] + hold.palm
    out = rotations.normalize(np.array(hold.normal))
    here, further = distance(skeleton, np.stack([skin, skin + 0.05 * out]))
    assert -0.02 < here < 0.07  # one hand may lie on the other
    assert further - here > 0.01


@for_each("name", list(HOLDS))
def test_hands_rest_on_a_small_and_on_a_large_body_at_the_same_places(name: str) -> None:
    small, usual, large = (
        (rested(name, height).reach - stood(height)[0].pelvis) / stood(height)[1].scale for height in (1.5, 1.7, 2.0)
    )
    np.testing.assert_allclose(small, usual, atol=1e-3)
    np.testing.assert_allclose(large, usual, atol=1e-3)


@for_each("name", list(HOLDS))
def test_both_hands_rest_alike_on_either_side(name: str) -> None:
    pose = rested(name, 1.7)
    np.testing.assert_allclose(pose.reach[1], pose.reach[0] * [-1.0, 1.0, 1.0], atol=1e-6)
    left, right = (rotations.rotate(palm, np.array([0.0, 1.0, 0.0])) for palm in pose.palms)
    np.testing.assert_allclose(right, left * [-1.0, 1.0, 1.0], atol=1e-6)


def test_a_hand_on_a_thing_comes_to_it_and_the_other_stays_as_it_was() -> None:
    pose, skeleton = stood(1.7)
    table = on_thing(np.array([0.2, 1.0, 0.3]), 0.0, 0.0, (0.5, -0.5, -0.5))
    laid = at_rest(pose, (table, None), skeleton)
    root, local = solve(laid.repeat(1), skeleton)
    joints = skeleton.forward_kinematics(root, local)[0][0]
    wrist = joints[INDEX["left_wrist"]]
    assert wrist[1] == pytest.approx(1.042, abs=0.02)
    assert np.linalg.norm(wrist[[0, 2]] - [0.2, 0.3]) < 0.12
    np.testing.assert_allclose(laid.arms[1], pose.arms[1])


def test_hands_on_thighs_slide_a_little_now_and_then_and_lie_at_the_end_where_they_lay() -> None:
    held = rested("thighs", 1.7).repeat(300)
    moved = sliding(held, (HOLDS["thighs"], HOLDS["thighs"]), np.random.default_rng(0), 1.0)
    gone = np.linalg.norm(moved.reach - held.reach, axis=-1)
    assert (gone.max(axis=0) > 0.01).all()
    assert gone.max() < 0.045
    np.testing.assert_allclose(gone[[0, -1]], 0.0, atol=1e-9)
    # Hands that lie on each other, or on a thing, stay.
    folded = sliding(held, (HOLDS["folded"], HOLDS["folded_over"]), np.random.default_rng(0), 1.0)
    np.testing.assert_array_equal(folded.reach, held.reach)
