"""Guesses pulled to goals: by a share, from where a window begins, with the sway and the other arm left alone."""

from __future__ import annotations

import numpy as np
import torch
from small_home import small_home

from motion_backend.diffusion.guidance import HERE, along, posed, reaching, towards
from motion_backend.diffusion.motion_features import FEATURES, PLACES, Poses, from_features, to_features
from motion_backend.motion import Character
from motion_backend.procedural.backend import ProceduralBackend
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, build_skeleton


def test_the_last_frame_comes_a_share_nearer_to_its_goal() -> None:
    guess, goal = torch.zeros(2, 14, FEATURES), torch.tensor([[1.0, 2.0], [0.0, -4.0]])
    found = towards(goal, (0, 2), pull=0.5)(guess)
    assert torch.allclose(found[:, -1, [0, 2]], goal / 2)
    assert torch.equal(found[..., 1], guess[..., 1])
    assert (found[0, :, 0].diff() > 0).all()


def test_a_walk_beside_its_way_comes_to_it_and_goes_on_swaying() -> None:
    sway = torch.tensor([0.03, -0.03] * 7)
    way = torch.stack([torch.linspace(0.1, 1.0, 14) * 0.2, torch.linspace(0.1, 1.4, 14)], dim=1)[None]
    guess = torch.zeros(1, 14, FEATURES)
    guess[..., 2] = way[..., 1]
    guess[..., 0] = sway
    found = along(way, pull=1.0)(guess)
    off = found[0, :, 0] - way[0, :, 0]
    assert (off - sway).abs().max() < 0.02
    assert torch.allclose(found[..., 2], guess[..., 2], atol=1e-4)


def test_a_bend_is_followed_the_closer_the_higher_the_order() -> None:
    """There and back again: a parabola's guess at that stays far from it."""
    bend = torch.sin(torch.linspace(0.1, 1.0, 14) * 5.0) * 0.3
    way, guess = torch.stack([bend, torch.linspace(0.1, 1.0, 14)], dim=1)[None], torch.zeros(1, 14, FEATURES)
    off = [(along(way, 1.0, order)(guess)[0, :, 0] - bend).abs().mean() for order in (2, 4)]
    assert off[1] < 0.3 * off[0]


def stood() -> Array:
    """Features of a body that stands for 14 frames, (14, 202)."""
    history, skeleton = ProceduralBackend().begin(small_home(), Character(), 3).history, build_skeleton()
    root, local = history.root_positions[-1:] * [0.0, 1.0, 0.0], history.local_rotations[-1:]
    poses = Poses(np.repeat(root, 14, axis=0), np.repeat(local, 14, axis=0), np.ones((14, 4)))
    return to_features(poses, HERE, skeleton)


def test_a_hand_comes_nearer_by_trunk_and_arm_and_feet_stay() -> None:
    features, skeleton, wrist = stood(), build_skeleton(), INDEX["left_wrist"]
    hangs = features[0, PLACES][3 * (wrist - 1) : 3 * wrist]
    goal, shares = hangs + np.array([0.0, 0.25, 0.0]), np.linspace(0.0, 1.0, 14)
    guess = torch.from_numpy(features.astype(np.float32))[None]
    for _ in range(10):
        guess = reaching(goal, True, shares)(guess)
    before, after = (
        skeleton.forward_kinematics(poses.roots, poses.local)[0]
        for poses in (from_features(features, HERE), from_features(guess[0].double().numpy(), HERE))
    )
    away = np.linalg.norm(after[:, wrist] - goal, axis=1)
    assert away[-1] < 0.02
    assert away[0] > 0.2
    assert np.abs(after - before)[:, [INDEX["left_foot"], INDEX["right_foot"], 0]].max() < 1e-4


def test_a_pose_is_come_to_by_shares_where_it_is_held() -> None:
    guess, wanted = torch.zeros(1, 14, FEATURES), torch.ones(14, FEATURES)
    found = posed(wanted, torch.linspace(0.0, 1.0, 14), pull=0.5)(guess)
    assert torch.equal(found[0, 0], guess[0, 0])
    assert torch.allclose(found[0, -1, :135], torch.full((135,), 0.5))
    assert torch.equal(found[0, :, 135:], guess[0, :, 135:])
