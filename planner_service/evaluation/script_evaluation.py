"""Whole scripts acted from beginning to end: how many, and how much of them, succeed (SIMS 4.5, Table 2).

A script is two to six interactions among sitting, lying and touching, in words of the short scripts we ship, grounded
in one room of the library. What is between them is put in as in a story: rising from a rest, and the walk to the next.
"""

from __future__ import annotations

import json
import zlib
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np

from motion_backend.backends import DEFAULT_BACKEND
from motion_backend.director import Director, shares
from motion_backend.metrics.contact_error import outcome
from motion_backend.metrics.joint_trajectories import Kinematics
from motion_backend.motion import Action, Character, Motion, Skill, moment
from motion_backend.physics.physics_record import physics_of
from motion_backend.rotations import Array
from motion_backend.state_machine import ENDS
from planner_service.evaluation.intervals import RESAMPLES, wilson
from planner_service.evaluation.trials import FLOOR, Setting, places_for, setting
from planner_service.grounding.keyframes_to_actions import Place, UnreachableError, act
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.caption_actions import look_of
from planner_service.scripts.caption_fallbacks import usual
from planner_service.scripts.script import Keyframe
from planner_service.scripts.script_repair import RISES
from scene_graphs import furniture
from scene_graphs.layout_library import built_in_index

Level = Literal["simple", "mid", "hard"]
Placed = tuple[Keyframe, Place]
LEVELS: Final[Mapping[Level, tuple[int, int]]] = {"simple": (2, 2), "mid": (3, 4), "hard": (4, 6)}
"""How many interactions a script has, at least and at most."""
INTERACTIONS: Final = (Skill.SITDOWN, Skill.LIEDOWN, Skill.TOUCH)
MAX_DRAWS: Final = 1000
"""Wordings looked at for one script; a room in which so many do not help has too little in it."""
Progress = Callable[[int, int], None]


@dataclass(frozen=True, order=True)
class ScriptTrial:
    """What is acted where: the script follows from the three."""

    room: str
    seed: int
    level: Level


@dataclass(frozen=True)
class ScriptResult:
    """What came of one script."""

    trial: ScriptTrial
    interactions: int
    steps: int
    """Interactions done, with all that leads to them, before anything failed."""
    steps_any: int
    """The same where one frame within the threshold is enough, as in the paper."""
    errors: tuple[float, ...]
    """Metres from joint to goal at the end of each contact."""
    fault: str = ""
    """What failed first."""
    resets: int = 0
    """How often a simulated body was set back onto its plan; what that happened in is not done."""
    rewinds: int = 0
    """How often a simulation went back before a fall."""
    seconds: float = 0.0
    """How long the motion is."""

    @property
    def success(self) -> bool:
        """Whether all of it was done."""
        return self.steps == self.interactions

    @property
    def success_any(self) -> bool:
        """Whether all of it was done by the paper's rule."""
        return self.steps_any == self.interactions


@dataclass(frozen=True)
class ScriptFigure:
    """A figure over all scripts of a level, with its 95 % interval over rooms and seeds."""

    name: str
    level: Level
    value: float
    low: float
    high: float


def plan_script_trials(rooms: int, seeds: int) -> list[ScriptTrial]:
    """Every level in the largest rooms of each type, with every seed; room by room."""
    by_type: dict[str, list[tuple[float, str]]] = defaultdict(list)
    for layout in built_in_index().layouts:
        by_type[layout.room_type].append((-layout.area, layout.id))
    chosen = [room for some in by_type.values() for _, room in sorted(some)[:rooms]]
    return sorted(ScriptTrial(room, seed, level) for room in chosen for seed in range(seeds) for level in LEVELS)


def run_script_trials(
    trials: Sequence[ScriptTrial],
    progress: Progress = lambda _done, _all: None,
    backend: str = DEFAULT_BACKEND,
    kept: Path | None = None,
) -> list[ScriptResult]:
    """Write, ground and act all of them, one after the other; what a file of JSON lines has is not acted again, and
    what is new is added to it."""
    known = {one.trial: one for one in _read(kept)}
    found = []
    for index, trial in enumerate(trials):
        if trial not in known:
            known[trial] = run_script(trial, backend)
            if kept is not None:
                with kept.open("a", encoding="utf-8") as out:
                    out.write(json.dumps(asdict(known[trial]), ensure_ascii=False) + "\n")
        found.append(known[trial])
        progress(index + 1, len(trials))
    return found


def _read(kept: Path | None) -> Iterator[ScriptResult]:
    if kept is not None and kept.exists():
        for line in kept.read_text(encoding="utf-8").splitlines():
            row = json.loads(line)
            yield ScriptResult(ScriptTrial(**row.pop("trial")), errors=tuple(row.pop("errors")), **row)


def run_script(trial: ScriptTrial, backend: str = DEFAULT_BACKEND) -> ScriptResult:
    """Write, ground and act one script; one that cannot be grounded fails at its first step."""
    where = setting(trial.room)
    luck = np.random.default_rng([trial.seed, zlib.crc32(f"{trial.room} {trial.level}".encode())])
    least, most = LEVELS[trial.level]
    count = int(luck.integers(least, most + 1))
    try:
        keyframes, places = zip(*_joined(_interactions(count, where, luck)), strict=True)
        actions = act(keyframes, places, where.home, int(luck.integers(1 << 31)))
    except UnreachableError as error:
        return ScriptResult(trial, count, 0, 0, (), str(error))
    return _acted(trial, actions, where, backend)


def _acted(trial: ScriptTrial, actions: Sequence[Action], where: Setting, backend: str) -> ScriptResult:
    director = where.director if backend == DEFAULT_BACKEND else Director.of(backend)
    state = director.begin(where.home, Character(), trial.seed)
    steps, steps_any, failed, failed_any, fault = 0, 0, False, False, ""
    errors: list[float] = []
    resets, rewinds, seconds = 0, 0, 0.0
    for action, (motion, _) in zip(actions, director.play(where.home, actions, state), strict=True):
        found, told = outcome(action, Kinematics.of(motion)), physics_of(motion) or {"resets": 0, "rewinds": 0}
        own = not told["resets"] and shares(motion) in ({}, {backend: 1.0})
        failed, failed_any = failed or not (found.reached and own), failed_any or not (found.reached_any and own)
        if failed and not fault:
            fault = _why(action, motion, found.reached)
        resets, rewinds, seconds = resets + told["resets"], rewinds + told["rewinds"], seconds + motion.duration
        if action.skill in INTERACTIONS:
            steps, steps_any = steps + (not failed), steps_any + (not failed_any)
            errors += [] if found.error is None else [found.error]
    count = sum(action.skill in INTERACTIONS for action in actions)
    return ScriptResult(trial, count, steps, steps_any, tuple(errors), fault, resets, rewinds, round(seconds, 2))


def _why(action: Action, motion: Motion, reached: bool) -> str:
    """Why a keyframe counts as not done."""
    if motion.reason:
        return motion.reason
    told = ["was not held"] if not reached else [note.words for note in motion.notes]
    others = [phase.fallback for phase in motion.phases if phase.fallback]
    return f"{moment(action.keyframe)}: “{action.caption}” " + "; ".join(dict.fromkeys([*told, *others]))


@cache
def _told() -> Mapping[Skill, tuple[Keyframe, ...]]:
    """Every interaction of the short scripts we ship, by skill, each wording once."""
    found: dict[tuple[Skill, str, str], Keyframe] = {}
    for script in built_in():
        for keyframe in script.keyframes:
            if keyframe.skill in INTERACTIONS:
                found.setdefault((keyframe.skill, look_of(keyframe.caption), keyframe.emotion), keyframe)
    return {skill: tuple(one for key, one in found.items() if key[0] is skill) for skill in INTERACTIONS}


def _interactions(count: int, where: Setting, luck: np.random.Generator) -> list[Placed]:
    """Skills by chance, each in told words and at a piece that the room has for them; no piece twice running."""
    chosen: list[Placed] = []
    for _ in range(MAX_DRAWS):
        if len(chosen) == count:
            return chosen
        told = _told()[INTERACTIONS[int(luck.integers(len(INTERACTIONS)))]]
        keyframe = told[int(luck.integers(len(told)))]
        last = chosen[-1][1].object_id if chosen else None
        pieces = [one for one in places_for(keyframe.skill, keyframe.caption, where) if one not in (FLOOR, last)]
        if pieces:
            piece = pieces[int(luck.integers(len(pieces)))]
            word = furniture.canonical(where.home.object(piece).category).replace("_", " ")
            chosen.append((keyframe.model_copy(update={"furniture": word}), Place(0, piece)))
    raise UnreachableError(f"{where.home.rooms[0].layout.id} has too little to sit on, lie on and touch for a script")


def _joined(interactions: Sequence[Placed]) -> Iterator[Placed]:
    """The interactions with walks to them, and with a rise after each rest that something follows."""
    for index, (keyframe, place) in enumerate(interactions):
        if index:
            before, rested = interactions[index - 1]
            rise = RISES.get(ENDS[before.skill])
            if rise is not None:
                update: dict[str, Any] = {"skill": rise[0], "caption": rise[1]}
                yield before.model_copy(update=update), rested
        walk = usual(Skill.LOCO, keyframe.mood)
        yield keyframe.model_copy(update={"skill": Skill.LOCO, "caption": walk}), place
        yield keyframe, place


def sum_up_scripts(results: Sequence[ScriptResult], seed: int = 0) -> list[ScriptFigure]:
    """Every figure of every level; intervals are Wilson's for shares of scripts, else draw rooms and seeds anew."""
    figures = []
    for name, of in _FIGURES.items():
        for level in LEVELS:
            some = [one for one in results if one.trial.level == level]
            pairs = np.array([of(one) for one in some], dtype=np.float64).reshape(-1, 2)
            if not pairs[:, 1].sum():
                continue
            low, high = wilson(pairs[:, 0]) if name in _SHARES else _drawn(pairs, seed)
            total = pairs.sum(axis=0)
            figures.append(ScriptFigure(name, level, float(total[0] / total[1]), low, high))
    return figures


def _drawn(pairs: Array, seed: int) -> tuple[float, float]:
    """Of the ratio of sums (N, 2), by drawing anew."""
    drawn = pairs[np.random.default_rng(seed).integers(len(pairs), size=(RESAMPLES, len(pairs)))].sum(axis=1)
    low, high = np.quantile(drawn[:, 0] / np.maximum(drawn[:, 1], 1.0), [0.025, 0.975])
    return float(low), float(high)


_FIGURES: Final[Mapping[str, Callable[[ScriptResult], tuple[float, float]]]] = {
    "script_success": lambda one: (one.success, 1),
    "script_success_any": lambda one: (one.success_any, 1),
    "contact_error": lambda one: (sum(one.errors), len(one.errors)),
    "success_steps": lambda one: (one.steps, 1),
    "success_steps_unihsi": lambda one: (one.interactions * one.success, one.success),
    "plan_length": lambda one: (one.interactions, 1),
}
"""Sum and count that each script adds to a mean."""
_SHARES: Final = ("script_success", "script_success_any")
"""Of scripts: their interval is Wilson's."""
