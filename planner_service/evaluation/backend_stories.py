"""Whole stories acted by several backends, beside each other: who made their frames, and what these are worth.

Each theme is planned once; every backend acts the same keyframes in the same home from the same seed. Figures are put
together over all stories, frame by frame and keyframe by keyframe.
"""

from __future__ import annotations

import json
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.backend_protocol import PartKind
from motion_backend.backends import DIFFUSION
from motion_backend.diffusion.backend import DiffusionBackend
from motion_backend.diffusion.plan_follower import Missed
from motion_backend.director import Director
from motion_backend.metrics.caption_predicates import judge_caption
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.metrics.penetration import CLEARLY_IN, penetration
from motion_backend.motion import Motion
from motion_backend.rotations import Array
from motion_backend.scene import scene_of
from planner_service.pipeline import Pipeline, Planned, Story, StoryRequest, judge, move

THEMES: Final = Path(__file__).resolve().parents[1] / "data" / "evaluation" / "seven_themes.json"
INSIDE: Final = 0.99
"""Quantile of the changes of speed inside passages that those at seams are held against."""


@lru_cache(maxsize=1)
def seven_themes() -> Mapping[str, str]:
    """The seven themes of SIMS 8.2 and Tables 10, 11 and 13, as printed there, by a name of ours."""
    told: dict[str, str] = json.loads(THEMES.read_text(encoding="utf-8"))
    return told


@dataclass(frozen=True)
class Acted:
    """One story by one backend."""

    name: str
    story: Story
    motions: tuple[Motion, ...]
    """Of each keyframe."""
    missed: tuple[Missed, ...]
    """How far passages of the learned body ended from their goals, before they were brought there."""
    core_seconds: float
    """Of moving."""

    @property
    def seams(self) -> Seams:
        """Changes of speed where one passage meets the next, and elsewhere."""
        return seams_of(self.story.motion)


@dataclass(frozen=True)
class Seams:
    """How fast the fastest joint changes its speed, m/s from frame to frame."""

    at: Array
    """(S,) where maker, phase or keyframe changes: the larger of the two changes across."""
    inside: Array
    """(N,) in all other frames."""


def act_stories(
    names: Sequence[str], backends: Sequence[str], pipeline: Pipeline, seed: int
) -> Iterator[tuple[str, Acted]]:
    """Stories of some of the seven themes, by each backend in turn; (backend, story)."""
    for name in names:
        planned = pipeline.plan(StoryRequest(seven_themes()[name], seed=seed))
        for backend in backends:
            yield backend, act_story(name, planned, backend, pipeline)


def act_story(name: str, planned: Planned, backend: str, pipeline: Pipeline) -> Acted:
    """A planned story moved by a backend, and judged."""
    actions = pipeline.act(planned.request, planned.stage)
    director, missed = Director.of(backend), list[Missed]()
    if backend == DIFFUSION:
        director = replace(director, backend=DiffusionBackend(watch=missed.append))
    before = time.process_time()
    motions = move(director, planned, actions, _silent)
    taken = time.process_time() - before
    return Acted(name, judge(planned, actions, motions, _silent), tuple(motions), tuple(missed), taken)


def _silent(stage: str, share: float) -> None:
    """Progress that nobody watches."""


def summed(acted: Sequence[Acted], backend: str) -> dict[str, float]:
    """All stories of one backend in figures; what there is none of is left out."""
    figures = [figure for one in acted for figure in one.story.figures]
    frames = sum(len(one.story.motion) for one in acted)
    phases = [phase for one in acted for phase in one.story.motion.phases if phase.backend == backend]
    own = sum(phase.stop - phase.start for phase in phases)
    laid = sum(phase.stop - phase.start for phase in phases if phase.fallback)
    deep = [_depth(one) for one in acted]
    seams = [one.seams for one in acted]
    at, inside = (np.concatenate(values) for values in zip(*((one.at, one.inside) for one in seams), strict=True))
    usual = float(np.quantile(inside, INSIDE))
    slips = np.array([one.story.report["slip"] for one in acted])
    seconds = np.array([one.story.motion.duration for one in acted])
    errors = [figure.contact_error for figure in figures if figure.contact_error is not None]
    found = {
        "own": own / frames, "laid_over": laid / frames,
        "keyframes": float(len(figures)), "reached": float(sum(figure.reached for figure in figures)),
        "contact_error": float(np.mean(errors)), "in_furniture": float((np.concatenate(deep) > CLEARLY_IN).mean()),
        "deepest": float(max(one.max(initial=0.0) for one in deep)),
        "slip": float(slips @ seconds / seconds.sum()), "slip_most": float(slips.max()),
        "seam": float(np.median(at)), "seam_most": float(at.max()), "seams_beyond": float((at > usual).mean()),
        "inside": usual, "disobeyed": float(sum(map(_disobeyed, acted))),
        "seconds": float(seconds.sum()), "core_seconds": sum(one.core_seconds for one in acted),
    }  # fmt: skip
    for kind in PartKind:
        off = [missed.metres for one in acted for missed in one.missed if missed.kind is kind]
        if off:
            found |= {f"off {kind}": float(np.median(off)), f"off_most {kind}": float(np.max(off))}
    return found


def left_to_others(one: Acted, backend: str) -> dict[str, float]:
    """Seconds of a story that another backend made, or had a part in, by kind of phase and reason."""
    return left_to_others_of(one.story.motion, backend)


def left_to_others_of(motion: Motion, backend: str) -> dict[str, float]:
    """The same of any motion."""
    found = Counter[str]()
    for phase in motion.phases:
        if phase.fallback:
            who = "" if phase.backend == backend else f"{phase.backend}: "
            found[f"{phase.kind}, {who}{phase.fallback}"] += phase.stop - phase.start
    return {why: round(count / motion.fps, 1) for why, count in found.most_common()}


def seams_of(motion: Motion) -> Seams:
    """Changes of speed at and off the seams of a motion."""
    places = motion.joint_positions().astype(np.float64)
    changes = np.linalg.norm(np.diff(places, 2, axis=0), axis=-1).max(axis=1) * motion.fps
    frames = sorted(_borders(motion))
    across: NDArray[np.bool_] = np.zeros(len(changes), dtype=np.bool_)
    at = []
    for frame in frames:
        near = slice(max(frame - 2, 0), min(frame, len(changes)))
        if changes[near].size:
            across[near] = True
            at.append(changes[near].max())
    return Seams(np.array(at), changes[~across])


def _borders(motion: Motion) -> set[int]:
    """First frames of all passages but the first."""
    phases = {phase.start for phase in motion.phases}
    keyframes = {int(frame) + 1 for frame in np.flatnonzero(np.diff(motion.actions))}
    return (phases | keyframes) - {0}


def _depth(one: Acted) -> Array:
    """How deep the body is in furniture in each frame of a story. (T,) metres."""
    obstacles = scene_of(one.story.planned.home).obstacles
    pairs = zip(one.motions, one.story.actions, strict=True)
    return np.concatenate([penetration(Kinematics.of(made), obstacles, action) for made, action in pairs if len(made)])


def _disobeyed(one: Acted) -> int:
    """Keyframes of a story that do not look like their captions, and say nothing of it."""
    pairs = zip(one.motions, one.story.actions, strict=True)
    verdicts = [judge_caption(made, action) for made, action in pairs if len(made)]
    return sum(verdict is not None and not verdict.kept for verdict in verdicts)
