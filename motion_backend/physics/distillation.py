"""A policy taught by model-predictive control: its controls, and how they answer to states that are others.

Every frame of the teacher gives a control u and a matrix K by which it answers to other states (a Riccati gain), so
that each is the label u + K δ of any number of states near by. First the teacher acts, with noise, and then the policy
does while the teacher says what it would have done (DAgger, Ross et al. 2011).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend.datasets.normalization import Floats
from motion_backend.physics.engine import engine
from motion_backend.physics.linear_model import NX
from motion_backend.physics.mjcf_character import NU, NV
from motion_backend.physics.mpc import MOST_OFFSET, Effort, Moment, Roll
from motion_backend.physics.observations import heightmap
from motion_backend.physics.policy_player import Acts, PolicyPlayer
from motion_backend.physics.policy_view import View, bodies_of
from motion_backend.physics.tracker import fallen
from motion_backend.rotations import Array
from motion_backend.scene import scene_of

NOISE, LASTS = 0.02, 0.8
"""What the teacher's controls are disturbed by (radians), and what is left of it from frame to frame. With 0.06 it fell
in half of its reaches, and its answers were more than twice as large."""
SPREAD: Final = np.repeat([0.01, 0.02, 0.025, 0.06, 0.12, 0.25, 0.03], [3, 3, NV - 6, 3, 3, NV - 6, NU])
"""Of states near by: pelvis (metres, radians), joints, their rates, and the control that is held. (102,)."""
PERTURBED: Final = 8
"""States near by that are learned for each that was visited."""


class Episode(NamedTuple):
    """A task to be learned: what is seen of it, how the body begins, and how many frames it takes."""

    view: View
    start: Moment
    frames: int


@dataclass(frozen=True)
class Lesson:
    """What the teacher said in the N frames of an episode."""

    qpos: Array
    """(N, 45) where the body was."""
    qvel: Array
    """(N, 36)."""
    held: Array
    """(N, 30) the control it held."""
    control: Array
    """(N, 30) the control to go to."""
    answer: Array
    """(N, 30, 102) how that answers to other states and held controls."""
    frames: NDArray[np.int_]
    """(N,) of the plan."""
    fell: bool
    """Whether it fell before the end."""

    def save(self, path: Path) -> None:
        """As npz; answers in half precision."""
        path.parent.mkdir(parents=True, exist_ok=True)
        aside = path.with_suffix(".writing.npz")
        np.savez(
            aside,
            **{name: self.__dict__[name] for name in _KEPT},
            answer=self.answer.astype(np.float16),
            fell=self.fell,
        )
        aside.replace(path)

    @staticmethod
    def load(path: Path) -> Lesson:
        """What `save` wrote."""
        with np.load(path) as file:
            kept = {name: file[name] for name in _KEPT}
            return Lesson(**kept, answer=file["answer"].astype(np.float64), fell=bool(file["fell"]))


_KEPT: Final = ("qpos", "qvel", "held", "control", "frames")


def teach(episode: Episode, policy: Acts | None, rng: np.random.Generator, taken_over: float = 0.0) -> Lesson:
    """Let a policy act, or where there is none the teacher with noise, and write down what the teacher would do.

    In a share of its plans, drawn by chance, the teacher acts in place of the policy (the β of DAgger), so that a
    policy that knows little does not fall before anything can be learned.
    """
    player, now, ahead = PolicyPlayer.of(episode.view), episode.start, np.zeros((0, NU))
    reference, effort, noise = episode.view.task.reference, Effort(), np.zeros(NU)
    rows: list[tuple[Array | int, ...]] = []
    at, fell = 0, False
    while at < episode.frames and not fell:
        roll = player.controller(at).improve(now, at, ahead, effort)
        played = min(effort.played, episode.frames - at)
        own = policy is None or rng.random() < taken_over
        for index in range(played):
            told, answer = _told(player, roll, index, now, at)
            rows.append((now.state.qpos, now.state.qvel, now.control, told, answer, at))
            noise = LASTS * noise + rng.normal(0.0, NOISE * np.sqrt(1 - LASTS**2), NU)
            planned = reference.controls[at + 1]
            if policy is None or own:
                asked = told - planned + noise * (policy is None)
            else:
                asked = policy.offsets(player.observe(now, at))[0]
            now, _ = player.step(now, at, asked)
            at += 1
            if fell := fallen(now, reference.qpos[at]):
                break
        ahead = roll.offsets[played:]
    qpos, qvel, held, control, answers, frames = (np.array(column) for column in zip(*rows, strict=True))
    return Lesson(qpos, qvel, held, control, answers, frames, fell)


def _told(player: PolicyPlayer, roll: Roll, index: int, now: Moment, at: int) -> tuple[Array, Array]:
    """The teacher's control (30,) where the body is now, and its answer (30, 102) to where it might be."""
    reference, controller = player.view.task.reference, player.controller(at)
    answer = roll.answers[index] if roll.answers else np.zeros((NU, NX + NU))
    before = now.control - reference.controls[at]
    off = np.zeros(NX + NU)
    if index:
        # Of the first frame the plan was made for exactly this state.
        off[:NX] = controller.difference(now.state, roll.states[index])
        off[NX:] = before - roll.offsets[index - 1]
    offset = np.clip(roll.offsets[index] + answer @ off, -MOST_OFFSET, MOST_OFFSET)
    return reference.controls[at + 1] + offset, answer


def samples(
    episode: Episode, lesson: Lesson, rng: np.random.Generator, count: int = PERTURBED
) -> Iterator[tuple[Floats, Floats]]:
    """Observations (N, O) and offsets of controls (N, 30) of a lesson: as it was, and `count` times near by."""
    view, frames = episode.view, lesson.frames
    seen = bodies_of(lesson.qpos, lesson.qvel, view.task.reference.wrists[frames], view.task)
    # What is moved by 2 cm sees what it saw: heights are sampled every 8.
    heights = heightmap(scene_of(view.task.home), view.target, seen).reshape(len(frames), -1)
    for turn in range(count + 1):
        off = rng.normal(0.0, 1.0, (len(frames), NX + NU)) * SPREAD * rng.choice([0.3, 1.0], (len(frames), 1))
        off *= turn > 0
        qpos = moved(lesson.qpos, off[:, :NV], view)
        qvel, held = lesson.qvel + off[:, NV:NX], lesson.held + off[:, NX:]
        bodies = bodies_of(qpos, qvel, view.task.reference.wrists[frames], view.task)
        observed = view.joined(bodies, held, view.off_plan(qpos, qvel, held, frames), heights, frames)
        told = lesson.control - view.task.reference.controls[frames + 1] + np.einsum("nij,nj->ni", lesson.answer, off)
        yield observed.astype(np.float32), np.clip(told, -MOST_OFFSET, MOST_OFFSET).astype(np.float32)


def moved(qpos: Array, off: Array, view: View) -> Array:
    """Positions (N, 45) changed in the tangent space by (N, 36)."""
    model, found = view.task.models_at(0).fine, qpos.copy()
    for row, change in zip(found, off, strict=True):
        engine().mj_integratePos(model, row, change, 1.0)
    return found


def explained(told: Sequence[Array], guessed: Sequence[Array]) -> float:
    """The share of the controls' variance that guesses explain."""
    wanted, given = np.concatenate(told), np.concatenate(guessed)
    return float(1 - ((wanted - given) ** 2).sum() / ((wanted - wanted.mean(axis=0)) ** 2).sum())
