"""Forward kinematics that gradients pass through: from features to the joints that are shown."""

from __future__ import annotations

import torch
from torch import Tensor
from torch.nn import functional

from motion_backend.diffusion.motion_features import JOINT_COUNT, PLACES, ROOT, TURNS
from motion_backend.skeleton import build_skeleton


class Kinematics:
    """Of the body of 1.70 m, in which lengths of features are told."""

    def __init__(self, device: torch.device | str = "cpu") -> None:
        skeleton = build_skeleton()
        self.offsets = torch.tensor(skeleton.offsets, dtype=torch.float32, device=device)
        self.levels = [
            (
                self.offsets[list(joints)][:, :, None],
                torch.tensor(list(joints), device=device),
                list(joints),
                list(parents),
            )
            for joints, parents in skeleton._levels
        ]
        """Offsets (n, 3, 1) and indices of joints of one depth, and the same and their parents as numbers."""

    def joints(self, features: Tensor) -> Tensor:
        """Positions by rotations and bones, in the heading frame. (..., 202) to (..., 22, 3)."""
        local = matrices(features[..., TURNS].reshape(*features.shape[:-1], JOINT_COUNT, 6))
        world: list[Tensor] = [local[..., 0, :, :]] * JOINT_COUNT
        places: list[Tensor] = [features[..., ROOT]] * JOINT_COUNT
        for offsets, index, joints, parents in self.levels:
            above = torch.stack([world[parent] for parent in parents], dim=-3)
            steps = (above @ offsets)[..., 0]
            turned = above @ local.index_select(-3, index)
            for place, (joint, parent) in enumerate(zip(joints, parents, strict=True)):
                places[joint] = places[parent] + steps[..., place, :]
                world[joint] = turned[..., place, :, :]
        return torch.stack(places, dim=-2)


def told_joints(features: Tensor) -> Tensor:
    """The positions that stand in features beside the rotations. (..., 202) to (..., 22, 3)."""
    root = features[..., None, ROOT]
    over_floor = torch.stack([root[..., 0], torch.zeros_like(root[..., 1]), root[..., 2]], dim=-1)
    rest = features[..., PLACES].reshape(*features.shape[:-1], JOINT_COUNT - 1, 3) + over_floor
    return torch.cat([root, rest], dim=-2)


def matrices(six: Tensor) -> Tensor:
    """Rotation matrices from their first two columns, made orthonormal. (..., 6) to (..., 3, 3)."""
    first = functional.normalize(six[..., :3], dim=-1)
    second = six[..., 3:] - (first * six[..., 3:]).sum(-1, keepdim=True) * first
    second = functional.normalize(second, dim=-1)
    return torch.stack([first, second, torch.cross(first, second, dim=-1)], dim=-1)
