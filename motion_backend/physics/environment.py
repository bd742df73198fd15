"""Simulated bodies at their tasks, stepped together: what PPO and AMP learn in (SIMS 4.2).

A trial begins where its task does or, half of the time, somewhere on its plan (reference-state initialisation); tasks
that failed are drawn more often. It ends with a fall, with a contact that would hurt, when it has been where it should
be for a second, and when its time is over.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import torch

from motion_backend.body.capsules import BODIES
from motion_backend.datasets.normalization import Floats, Normalization
from motion_backend.metrics.contact_error import SUSTAINED
from motion_backend.motion import FPS
from motion_backend.physics.discriminator import DiscriminatorTrainer, Steps, style_reward
from motion_backend.physics.distillation import Episode
from motion_backend.physics.mpc import Moment, moment_of
from motion_backend.physics.observations import STATE_FLOOR, STATE_SIZE, BodyMoment, state
from motion_backend.physics.policy_player import PolicyPlayer
from motion_backend.physics.policy_view import bodies_of
from motion_backend.physics.ppo import Outcome
from motion_backend.physics.rewards import Approach, contact_reward, total_reward, walk_reward
from motion_backend.physics.tracker import fallen
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

HURTS: Final = 6000.0
"""Newtons in all from which a contact is extreme: nine times the weight."""
REACHED: Final = 0.2
"""Metres from its goals within which a body has done its task (the paper's for sitting and reaching)."""
PACE: Final = 1.0
"""Metres a second, the speed asked for on the way (g^vel)."""
FROM_PLAN: Final = 0.5
"""Of trials begin on the plan."""
LAST_START: Final = 15
"""Frames before its end after which no trial begins."""
_JOINTS: Final = [INDEX[capsule.joint] for capsule in BODIES]


@dataclass
class _Body:
    """One of them."""

    episode: int
    player: PolicyPlayer
    now: Moment
    at: int
    there: int = 0
    """Frames for which it has been where it should be."""


class SkillEnvironment:
    """N bodies; actions are offsets of controls on the scale of the policy's."""

    def __init__(
        self, episodes: Sequence[Episode], scale: Normalization, count: int, seed: int = 0, walking: bool = False
    ) -> None:
        self.episodes, self.scale, self.walking = episodes, scale, walking
        self.rng = np.random.default_rng(seed)
        self.failed = np.ones(len(episodes))
        """How often each failed, and one more."""
        self.bodies = [self._begun() for _ in range(count)]

    def observe(self) -> Floats:
        """What they see now. (N, O)."""
        return np.concatenate([body.player.observe(body.now, body.at) for body in self.bodies]).astype(np.float32)

    def step(self, actions: Floats) -> Outcome:
        """Do actions (N, 30); those that ended have begun anew when it returns."""
        rows = [self._step(body, offset) for body, offset in zip(self.bodies, self.scale.undo(actions), strict=True)]
        for index, (_, _, terminated, truncated) in enumerate(rows):
            if terminated or truncated:
                self.failed[self.bodies[index].episode] += terminated
                self.bodies[index] = self._begun()
        rewards, observed, *over = (np.array(column) for column in zip(*rows, strict=True))
        return Outcome(rewards.astype(np.float32), observed.astype(np.float32), over[0], over[1])

    def _begun(self) -> _Body:
        index = int(self.rng.choice(len(self.episodes), p=self.failed / self.failed.sum()))
        episode, now, at = self.episodes[index], self.episodes[index].start, 0
        if self.rng.random() < FROM_PLAN:
            at = int(self.rng.integers(max(episode.frames - LAST_START, 1)))
            now = moment_of(episode.view.task.reference, at)
        return _Body(index, PolicyPlayer.of(episode.view), now, at)

    def _step(self, body: _Body, offset: Array) -> tuple[float, Array, bool, bool]:
        """Reward, what is seen after it, and whether it is over for good or in time."""
        before, view = body.now, body.player.view
        body.now, pressure = body.player.step(before, body.at, offset.astype(np.float64))
        body.at += 1
        if fallen(body.now, view.task.reference.qpos[body.at]) or pressure.total > HURTS:
            return 0.0, body.player.observe(before, body.at - 1)[0], True, False
        seen = _bodies(view.task, body.now, body.at)
        away, reward = self._reward(view.places, view.mask, seen, before)
        body.there = body.there + 1 if away < REACHED else 0
        over = body.at >= self.episodes[body.episode].frames or body.there >= SUSTAINED * FPS
        return reward, body.player.observe(body.now, body.at)[0], False, over

    def _reward(self, places: Array, mask: Any, seen: BodyMoment, before: Moment) -> tuple[float, float]:
        """How far the farthest goal is, and Eq. 7 or Eq. 11."""
        joints, target = seen.positions[:, _JOINTS], places[mask][:1] if mask.any() else seen.root
        ahead = (target - seen.root) * [1.0, 0.0, 1.0]
        direction = ahead / np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), 1e-6)
        facing = np.stack([np.sin(seen.heading), np.zeros(1), np.cos(seen.heading)], axis=1)
        approach = Approach(seen.root, target, seen.velocity, np.full(1, PACE), direction, facing)
        away = np.linalg.norm(places - joints[0], axis=1)[mask]
        if self.walking:
            reward = walk_reward(approach, before.state.qvel[None, :3])
        else:
            reward = contact_reward(approach, joints, places[None], mask)
        return float(away.max()) if len(away) else np.inf, float(reward[0])


class StyledEnvironment:
    """The same with a discriminator's verdict on every step added to the reward (SIMS 3.3)."""

    def __init__(self, inner: SkillEnvironment, trainer: DiscriminatorTrainer, text: int) -> None:
        self.inner, self.trainer, self.text = inner, trainer, text
        self.scale = Normalization.of(np.concatenate([_planned(one) for one in inner.episodes]), STATE_FLOOR)
        self.seen: list[Steps] = []

    def observe(self) -> Floats:
        """What they see now. (N, O)."""
        return self.inner.observe()

    def step(self, actions: Floats) -> Outcome:
        """As the inner one's; its steps are kept for the discriminator."""
        before = self.observe()
        done = self.inner.step(actions)
        steps = self._steps(before, done.observed)
        self.seen.append(steps)
        with torch.no_grad():
            style = style_reward(self.trainer.discriminator(steps.joined)).numpy()
        rewards = total_reward(style, done.rewards.astype(np.float64)).astype(np.float32)
        return Outcome(rewards, done.observed, done.terminated, done.truncated)

    def learn(self, rng: np.random.Generator) -> dict[str, float]:
        """One AMP step on what was seen since the last, against as many steps of plans."""
        seen = Steps(*(torch.cat([getattr(one, part) for one in self.seen]) for part in ("before", "after", "z")))
        self.seen = []
        return self.trainer.step(self._clips(len(seen.before), rng), seen)

    def _steps(self, before: Floats, after: Floats) -> Steps:
        words = before[:, -self.text :] if self.text else np.zeros((len(before), 0), np.float32)
        rows = [self.scale.apply(one[:, :STATE_SIZE]) for one in (before, after)]
        return Steps(*map(torch.from_numpy, (*rows, words)))

    def _clips(self, count: int, rng: np.random.Generator) -> Steps:
        rows = []
        for index in rng.integers(len(self.inner.episodes), size=count):
            episode = self.inner.episodes[index]
            planned = self.scale.apply(_planned(episode))
            at = int(rng.integers(len(planned) - 1))
            rows.append((planned[at], planned[at + 1], episode.view.z[: self.text].astype(np.float32)))
        return Steps(*(torch.from_numpy(np.stack(column)) for column in zip(*rows, strict=True)))


def _bodies(task: Any, now: Moment, at: int) -> BodyMoment:
    return bodies_of(now.state.qpos[None], now.state.qvel[None], task.reference.wrists[at : at + 1], task)


def _planned(episode: Episode) -> Array:
    """s of a plan's frames (T, STATE_SIZE)."""
    reference = episode.view.task.reference.part(slice(episode.frames))
    return state(bodies_of(reference.qpos, reference.qvel, reference.wrists, episode.view.task))
