"""The five policies of SIMS 3.4, π_w, π_s, π_l, π_r and π_g: which skill is whose, what each sees, and its network.

These are networks that can be trained. No weights are shipped: nothing here has learned to move a body.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from typing import Final

import torch
from torch import Tensor, nn

from motion_backend.motion import Skill
from motion_backend.physics.linear_model import NX
from motion_backend.physics.mjcf_character import NU, NV
from motion_backend.physics.observations import GOAL_SIZE, HEIGHTMAP, STATE_SIZE

EMBEDDING_SIZE: Final = 64
"""Of z (SIMS 3.3)."""
AHEAD: Final = (1, 3, 6, 10, 15, 20)
"""Frames later in which a policy sees where its plan is: as far as the teacher looks, and leans before a step."""
SOLES: Final = 4 * len(AHEAD)
"""Numbers of planted soles: both heels and balls, in each of these."""
PLAN_SIZE: Final = NX + NU + NV * len(AHEAD) + SOLES
"""Numbers of how far a body is off its plan, of the offsets it holds, of how the plan goes on, and of planted soles."""
SUPPORTS: Final = 4
"""A plan stands on no foot, the right, the left or both; each has a linear answer of its own."""
SMALL: Final = 0.01
"""What the last layer begins with, against the usual: a new policy does next to nothing."""
LOG_STD_RANGE: Final = (-4.0, 0.5)


class PolicyName(StrEnum):
    """The paper's letters."""

    WALK = "w"
    SIT = "s"
    LIE = "l"
    REACH = "r"
    GETUP = "g"


POLICY_OF: Final[dict[Skill, PolicyName]] = {
    Skill.LOCO: PolicyName.WALK,
    Skill.SITDOWN: PolicyName.SIT,
    Skill.LIEDOWN: PolicyName.LIE,
    Skill.TOUCH: PolicyName.REACH,
    Skill.STANDUP: PolicyName.GETUP,
    Skill.GETUP: PolicyName.GETUP,
}
"""Who does each skill; getting up from a seat and from lying are one policy (SIMS 4.2)."""
WITH_TEXT: Final = frozenset({PolicyName.WALK, PolicyName.SIT, PolicyName.LIE})
"""Reach and GetUp get no text (SIMS 4.2)."""


@dataclass(frozen=True)
class PolicyConfig:
    """Sizes of one policy."""

    actions: int
    """Numbers of a control."""
    heights: int = HEIGHTMAP.size**2
    goal: int = GOAL_SIZE
    state: int = STATE_SIZE + NU + PLAN_SIZE
    """s, the controls that the body holds (the teacher prices their change, so that its answer hangs on them), and how
    it is off its plan."""
    text: int = EMBEDDING_SIZE
    """0 for a policy without text."""
    seen: int = 64
    """What a heightmap is brought down to before it joins the rest."""
    hidden: tuple[int, ...] = (512, 256)

    @staticmethod
    def of(name: PolicyName, actions: int) -> PolicyConfig:
        """The sizes of one of the five."""
        return PolicyConfig(actions, text=EMBEDDING_SIZE if name in WITH_TEXT else 0)


class Policy(nn.Module):  # type: ignore[misc]  # torch is not read by mypy
    """π(a | s, h, g, z): a Gaussian whose mean a network gives and whose spread is learned beside it."""

    def __init__(self, config: PolicyConfig) -> None:
        super().__init__()
        self.config = config
        self.look = mlp(config.heights, (2 * config.seen,), config.seen)
        self.act = mlp(config.state + config.seen + config.goal + config.text, config.hidden, config.actions)
        self.answer = nn.Parameter(torch.zeros(SUPPORTS, PLAN_SIZE + 1, config.actions))
        with torch.no_grad():
            self.act[-1].weight *= SMALL
        self.log_std = nn.Parameter(torch.full((config.actions,), -1.0))

    @property
    def input_sizes(self) -> tuple[int, int, int, int]:
        """Of s, h, g and z in an observation, which has them in this order."""
        return self.config.state, self.config.heights, self.config.goal, self.config.text

    def forward(self, observed: Tensor) -> Tensor:
        """Mean controls of observations (B, s + h + g + z). (B, actions)."""
        s, h, g, z = observed.split(self.input_sizes, dim=-1)
        linear = torch.einsum("bm,bs,msa->ba", *supported(s), self.answer)
        return linear + self.act(torch.cat([s, self.look(h), g, z], dim=-1))


def supported(s: Tensor) -> tuple[Tensor, Tensor]:
    """By which feet a plan stands next, one of (B, SUPPORTS), and what is seen of it with a 1, (B, PLAN_SIZE + 1), from
    the states (B, S) of normalised observations, in which what is not planted is below 0."""
    plan = s[:, -PLAN_SIZE:]
    left, right = (plan[:, -SOLES:][:, :4] > 0).view(-1, 2, 2).any(-1).long().unbind(-1)
    ones = torch.ones(len(s), 1, dtype=s.dtype)
    return nn.functional.one_hot(2 * left + right, SUPPORTS).to(s.dtype), torch.cat([plan, ones], dim=-1)


class Value(nn.Module):  # type: ignore[misc]  # torch is not read by mypy
    """What a state is worth to a policy: the critic of PPO, on the same observation."""

    def __init__(self, size: int, hidden: Sequence[int] = (512, 256)) -> None:
        super().__init__()
        self.net = mlp(size, hidden, 1)

    def forward(self, observed: Tensor) -> Tensor:
        """(B, size) to (B,)."""
        return self.net(observed)[..., 0]


def five_policies(actions: int, seed: int) -> dict[PolicyName, Policy]:
    """The five networks as they begin; the same for a seed."""
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        return {name: Policy(PolicyConfig.of(name, actions)) for name in PolicyName}


def log_probability(mean: Tensor, log_std: Tensor, actions: Tensor) -> Tensor:
    """Of actions (B, A) under a Gaussian with a mean (B, A) and a spread an axis (A,). (B,)."""
    scaled = (actions - mean) / log_std.exp()
    return (-0.5 * scaled**2 - log_std - 0.5 * math.log(2 * math.pi)).sum(-1)


def mlp(inputs: int, hidden: Sequence[int], outputs: int) -> nn.Sequential:
    """Linear layers with ELU between them."""
    sizes = [inputs, *hidden]
    layers = [part for a, b in pairwise(sizes) for part in (nn.Linear(a, b), nn.ELU())]
    return nn.Sequential(*layers, nn.Linear(sizes[-1], outputs))
