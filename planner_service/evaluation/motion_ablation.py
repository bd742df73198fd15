"""What each thing that the learned body is told, and each step of its sampling, is worth: figures without it.

What is left out is left out of sampling: the same weights, which were trained with it (and without it one time in ten).
Walks are judged as `learned_walks` has them; parts at furniture are those of trials in rooms that nothing was learned
in, made by the model after the plan of the procedural body.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Final

import numpy as np

from motion_backend.backend_protocol import PartKind
from motion_backend.diffusion.conditions import Conditions
from motion_backend.diffusion.guidance import Guide
from motion_backend.diffusion.plan_follower import Followed, PlanFollower
from motion_backend.diffusion.planned_passages import passages_of
from motion_backend.diffusion.sampler import DDIM_STEPS, Sampler
from motion_backend.director import Director
from motion_backend.metrics.foot_skate import support_slip
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.penetration import CLEARLY_IN, penetration
from motion_backend.mocap.dataset_file import Dataset
from motion_backend.motion import Skill
from motion_backend.rotations import Array
from motion_backend.scene import scene_of
from planner_service.evaluation.acted_motion import is_for_training
from planner_service.evaluation.learned_walks import judged
from planner_service.evaluation.overheard_parts import Overheard, Step
from planner_service.evaluation.trials import Trial, act_trial, places_for, setting
from planner_service.grounding.keyframes_to_actions import UnreachableError
from planner_service.scripts.captions import captions
from scene_graphs.home import Home
from scene_graphs.layout_library import built_in_index
from scene_graphs.navigation.path_planner import NoPath

SKILLS: Final = {
    Skill.SITDOWN: PartKind.SIT, Skill.LIEDOWN: PartKind.LIE, Skill.STANDUP: PartKind.RISE,
    Skill.GETUP: PartKind.RISE, Skill.TOUCH: PartKind.REACH,
}  # fmt: skip
"""What is acted at furniture, and the part of it that is judged."""
SEED: Final = 1502


@dataclass(frozen=True)
class Ablation:
    """What is left out or sampled otherwise."""

    name: str
    untold: tuple[str, ...] = ()
    """Of text, scene, pelvis, hand and frame."""
    steps: int = DDIM_STEPS
    """Of DDIM."""
    fresh: bool | None = None
    """Whether each step draws fresh noise; None: as it ships."""
    walks: bool = True
    """Whether walks know of it: they see no scene, and their frame number is zero as it is."""


ABLATIONS: Final = (
    Ablation("as it ships"),
    Ablation("no scene", ("scene",), walks=False),
    Ablation("no text", ("text",)),
    Ablation("no frame numbers", ("frame",), walks=False),
    Ablation("no fresh noise", fresh=False),
    Ablation("5 steps", steps=5),
    Ablation("20 steps", steps=20),
    Ablation("100 steps of DDIM", steps=100, fresh=False),
    Ablation("100 steps of DDPM", steps=100, fresh=True),
)


@dataclass(frozen=True)
class AblatedSampler(Sampler):
    """A sampler that does not pass on all that it is told."""

    untold: tuple[str, ...] = ()

    @staticmethod
    def of(sampler: Sampler, ablation: Ablation) -> AblatedSampler:
        """The same weights under an ablation."""
        own = {field.name: getattr(sampler, field.name) for field in fields(Sampler)}
        fresh = sampler.fresh if ablation.fresh is None else ablation.fresh
        return AblatedSampler(**{**own, "steps": ablation.steps, "fresh": fresh}, untold=ablation.untold)

    def windows(self, history: Array, given: Conditions, seed: int | list[int], guide: Guide | None = None) -> Array:
        """As a sampler's, but for what is not told."""
        return super().windows(history, given.without(*self.untold), seed, guide)


@dataclass(frozen=True)
class Ablated:
    """Figures of one ablation, by name; what has none is left out."""

    name: str
    figures: Mapping[str, float]

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {"name": self.name, **{key: round(value, 4) for key, value in self.figures.items()}}


def ablate_walks(
    sampler: Sampler, dataset: Dataset, people: int, chosen: Sequence[Ablation] = ABLATIONS
) -> Iterator[Ablated]:
    """Straight walks of so many bodies, judged by people of the dataset's test side."""
    for ablation in chosen:
        if ablation.walks:
            begun = time.process_time()
            found = dict(judged(AblatedSampler.of(sampler, ablation), dataset, people))
            yield Ablated(ablation.name, {**found, "core_seconds": time.process_time() - begun})


def ablate_parts(
    follower: PlanFollower, parts: Sequence[tuple[Home, Step]], chosen: Sequence[Ablation] = ABLATIONS
) -> Iterator[Ablated]:
    """Parts at furniture, each made anew after the procedural body's plan."""
    for ablation in chosen:
        acting, walking = (AblatedSampler.of(one, ablation) for one in (follower.acting, follower.walking))
        told = replace(follower, acting=acting, walking=walking)
        begun = time.process_time()
        made = [(home, step, _followed(told, home, step)) for home, step in parts]
        yield Ablated(ablation.name, {**_summed(made, follower.name), "core_seconds": time.process_time() - begun})


def unseen_parts(count: int, seed: int = SEED) -> list[tuple[Home, Step]]:
    """So many parts of each skill, as the procedural body does them in rooms by chance that are never learned from."""
    rng = np.random.default_rng(seed)
    rooms = [layout.id for layout in built_in_index().layouts if not is_for_training(layout.id)]
    found: list[tuple[Home, Step]] = []
    for skill, kind in SKILLS.items():
        own: list[tuple[Home, Step]] = []
        while len(own) < count:
            caption, room = str(rng.choice(captions()[skill])), str(rng.choice(rooms))
            step = _step_of(Trial(skill, caption, room, int(rng.integers(1 << 31))), kind)
            if step is not None:
                own.append((setting(room).home, step))
        found += own
    return found


def _step_of(trial: Trial, kind: PartKind) -> Step | None:
    """The last part of that kind of a trial; None where its room has no place for it, or it was not done."""
    if not places_for(trial.skill, trial.caption, setting(trial.room)):
        return None
    overheard = Overheard()
    try:
        _, _, motions = act_trial(trial, Director(overheard))
    except (UnreachableError, NoPath):
        return None
    own = [step for step in overheard.steps if step.part.kind is kind and step.motion.completed]
    return own[-1] if own and motions[-1].completed else None


def _followed(follower: PlanFollower, home: Home, step: Step) -> Followed:
    return follower.follow(passages_of(home, step.part, step.motion), step.motion.notes, step.state)


def _summed(made: Sequence[tuple[Home, Step, Followed]], name: str) -> dict[str, float]:
    """Of parts that were made: how much is the model's, how far it was off, and how it stands."""
    frames = {True: 0, False: 0}
    for _, _, done in made:
        for phase in done.motion.phases:
            frames[phase.backend == name] += phase.stop - phase.start
    off = [missed.metres for _, _, done in made for missed in done.missed]
    bodies = [Kinematics.of(done.motion) for _, _, done in made]
    deep = [
        float((penetration(body, scene_of(home).obstacles, step.part.action) > CLEARLY_IN).mean())
        for (home, step, _), body in zip(made, bodies, strict=True)
    ]
    found = {
        "own": frames[True] / max(sum(frames.values()), 1),
        "in_furniture": float(np.mean(deep)),
        "slip": float(np.mean([support_slip(body) for body in bodies])),
    }
    return found | ({"off": float(np.median(off)), "off_most": float(np.max(off))} if off else {})
