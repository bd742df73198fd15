"""`sims train physics`: the policies of the simulated body, taught by model-predictive control or by reward."""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum
from itertools import islice
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from planner_service.output.story_export import check_writable

SUFFIX = ".safetensors"


class Method(StrEnum):
    """How a policy learns."""

    DISTIL = "distil"
    """From what model-predictive control does, and would do."""
    PPO = "ppo"
    """From the task rewards of SIMS."""
    AMP = "amp"
    """From these and a discriminator's verdict on its style."""


class Taught(StrEnum):
    """The paper's five."""

    WALK = "walk"
    SIT = "sit"
    LIE = "lie"
    REACH = "reach"
    GETUP = "getup"


def physics(
    out: Annotated[Path, typer.Option(help="Folder for lessons, checkpoints and weights; a run goes on where it was.")],
    skill: Annotated[Taught, typer.Option(help="What is learned.")] = Taught.SIT,
    method: Annotated[Method, typer.Option(help="How.")] = Method.DISTIL,
    rounds: Annotated[int, typer.Option(min=1, max=100_000, help="Of teaching and learning.")] = 4,
    episodes: Annotated[int, typer.Option(min=1, max=10_000, help="A round; bodies side by side for ppo.")] = 24,
    steps: Annotated[int, typer.Option(min=1, max=1_000_000, help="Batches a round; frames a round for ppo.")] = 2000,
    judged: Annotated[int, typer.Option(min=0, max=10_000, help="Trials at the end, in rooms not learned in.")] = 24,
    seed: Annotated[int, typer.Option(min=0, help="The same seed learns the same.")] = 0,
) -> None:
    """Teach one of the five policies and say how often it does its skill in rooms that it has not learned in."""
    from motion_backend.physics.cloned_policy import CloningConfig
    from motion_backend.physics.policies import PolicyName
    from motion_backend.physics.train import DistilConfig, DistilRun, RewardConfig, RewardRun
    from planner_service.evaluation.skill_episodes import JUDGED_IN, LEARNED_IN, episodes_of

    console = Console(markup=False, highlight=False)
    check_writable(out, (f"{skill.value}{SUFFIX}",))
    name = PolicyName[skill.name]
    source = (one.episode for one in episodes_of(name, LEARNED_IN + seed))
    if method is Method.DISTIL:
        told = DistilConfig(rounds, episodes, cloning=CloningConfig(steps=steps, seed=seed), seed=seed)
        policy = DistilRun(name, source, out, told).run(console.print)
    else:
        config = RewardConfig(rounds, episodes, steps, seed, method is Method.AMP)
        policy = RewardRun(name, list(islice(source, 2 * episodes)), out, config).run(console.print)
    done = [one.judged(policy) for one in islice(episodes_of(name, JUDGED_IN, unseen=True), judged)]
    figures = {**policy.figures, "reached": sum(done) / max(len(done), 1), "trials": len(done)}
    replace(policy, figures=figures).save(out / f"{skill.value}{SUFFIX}")
    console.print(f"{sum(done)} of {len(done)} trials done in rooms that it has not learned in", soft_wrap=True)
    console.print(f"weights in {out}: SIMS_PHYSICS_MODE=policy SIMS_PHYSICS_POLICIES={out}", soft_wrap=True)
