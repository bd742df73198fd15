"""What training makes small: distance to the clean window, bones and features that disagree, velocities, sliding feet.

Distances to the clean window are in the network's own units; all else is of joints that follow from the rotations and
are shown, in metres.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Final

import torch
from torch import Tensor
from torch.nn import functional

from motion_backend.diffusion.body_kinematics import Kinematics, told_joints
from motion_backend.diffusion.motion_features import CONTACTS, FEATURES, HISTORY, PLACES, ROOT, TURNS
from motion_backend.diffusion.sampler import Scale
from motion_backend.skeleton import INDEX, JOINTS

FEET: Final = [INDEX[name] for name in ("left_ankle", "left_foot", "right_ankle", "right_foot")]
"""As contacts have them."""
LOWEST: Final = (0.05, 0.022, 0.05, 0.022)
"""Heights under which these joints are in the floor (metres)."""
TELLING: Final = ("pelvis", "left_ankle", "right_ankle", "left_foot", "right_foot", "left_wrist", "right_wrist")
"""Joints that what is done depends on."""


@dataclass(frozen=True)
class LossWeights:
    """Of each part; the first four of features, by what they are."""

    root: float = 3.0
    heading: float = 2.0
    """Of the pelvis' rotation."""
    places: float = 1.5
    contacts: float = 0.7
    bones: float = 15.0
    """Joints by bones against those of the clean window."""
    telling: float = 3.0
    """Of the joints in `TELLING`, in that."""
    velocity: float = 30.0
    """Metres a frame."""
    slide: float = 50.0
    """Of feet in contact."""
    floor: float = 60.0
    """Of feet in the floor."""


CONTACT_LOSSES: Final = LossWeights()
"""What is acted at furniture: joints that are shown have to be where they are to be."""
WALK_LOSSES: Final = LossWeights(bones=5.0, floor=20.0)
"""A walk: bones weigh less, so that how people move is learned before where to the centimetre."""


@dataclass(frozen=True)
class Losses:
    """Of a batch, before they are weighed."""

    clean: Tensor
    bones: Tensor
    velocity: Tensor
    slide: Tensor
    floor: Tensor

    def total(self, weights: LossWeights) -> Tensor:
        """What gradients are taken of."""
        return (
            self.clean
            + weights.bones * self.bones
            + weights.velocity * self.velocity
            + weights.slide * self.slide
            + weights.floor * self.floor
        )

    def told(self) -> dict[str, Tensor]:
        """For the curve, where they were worked out; bones in metres (root mean square)."""
        found = {name: value.detach() for name, value in vars(self).items()}
        return found | {"bones": found["bones"].sqrt()}

    def numbers(self) -> dict[str, float]:
        """The same as numbers."""
        return {name: float(value) for name, value in self.told().items()}


def losses(guess: Tensor, clean: Tensor, scale: Scale, kinematics: Kinematics, weights: LossWeights) -> Losses:
    """Of guessed windows against clean ones, both as the network sees them. (B, 16, 202)."""
    new = slice(HISTORY, None)
    gap = functional.smooth_l1_loss(guess[:, new], clean[:, new], reduction="none")
    told, true = scale.decode(guess), scale.decode(clean)
    wanted = told_joints(true)[:, HISTORY - 1 :]  # (B, 15, 22, 3), the last known frame first
    made = torch.cat([wanted[:, :1], kinematics.joints(told[:, new])], dim=1)
    speeds, wanted_speeds = made.diff(dim=1), wanted.diff(dim=1)
    contacts = true[:, HISTORY - 1 :, CONTACTS]
    standing = contacts[:, 1:] * contacts[:, :-1]  # (B, 14, 4)
    feet, low = _feet(str(gap.device))
    lowest = torch.minimum(wanted[:, 1:, :, 1].index_select(2, feet), low)
    return Losses(
        clean=(gap * _feature_weights(weights, str(gap.device))).mean(),
        bones=((made - wanted)[:, 1:].square().sum(-1) * _joint_weights(weights, str(gap.device))).mean(),
        velocity=(speeds - wanted_speeds).square().sum(-1).mean(),
        slide=(speeds.index_select(2, feet).square().sum(-1) * standing).mean(),
        floor=functional.relu(lowest - made[:, 1:, :, 1].index_select(2, feet)).square().mean(),
    )


# On the device they are needed on, once: what is sent to a GPU in every step is waited for in every step.
@cache
def _feet(device: str) -> tuple[Tensor, Tensor]:
    return torch.tensor(FEET, device=device), torch.tensor(LOWEST, device=device)


@cache
def _feature_weights(weights: LossWeights, device: str) -> Tensor:
    found = torch.ones(FEATURES)
    found[ROOT], found[PLACES], found[CONTACTS] = weights.root, weights.places, weights.contacts
    found[TURNS.start : TURNS.start + 6] = weights.heading
    return found.to(device)


@cache
def _joint_weights(weights: LossWeights, device: str) -> Tensor:
    found = torch.tensor([weights.telling if name in TELLING else 1.0 for name in JOINTS])
    return (found / found.mean()).to(device)
