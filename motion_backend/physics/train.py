"""The runs that teach policies; each goes on where it was ended, and is the same for a seed.

`distil` is DAgger with a teacher that also says how it would answer (`distillation.py`). A round is: some episodes with
the policy so far, then learning from all lessons there are.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import torch
from safetensors import safe_open
from safetensors.torch import save_file

from motion_backend.datasets.normalization import Normalization
from motion_backend.physics.cloned_policy import CloningConfig, Rows, clone, new_policy
from motion_backend.physics.discriminator import DiscriminatorConfig, DiscriminatorTrainer
from motion_backend.physics.distillation import PERTURBED, Episode, Lesson, samples, teach
from motion_backend.physics.environment import SkillEnvironment, StyledEnvironment
from motion_backend.physics.linear_answers import linear_answers
from motion_backend.physics.mirrored_body import CONTROLS, mirrored_observation
from motion_backend.physics.mjcf_character import NU
from motion_backend.physics.policies import WITH_TEXT, Policy, PolicyConfig, PolicyName, Value
from motion_backend.physics.ppo import PPO, PPOConfig, VectorEnvironment
from motion_backend.physics.trained_policy import TrainedPolicy
from motion_backend.physics.training_fault import TrainingFaultError
from motion_backend.rotations import Array

Report = Callable[[str], None]


@dataclass(frozen=True)
class DistilConfig:
    """How long is taught, and learned, and how often."""

    rounds: int = 4
    episodes: int = 24
    """A round."""
    perturbed: int = PERTURBED
    cloning: CloningConfig = field(default_factory=CloningConfig)
    seed: int = 0
    taken_over: tuple[float, ...] = (0.6, 0.4, 0.2)
    """Shares of its plans in which the teacher acts, in the second round and on; later the policy acts alone."""


class DistilRun:
    """A policy that is being distilled; all that it was taught is in a folder."""

    def __init__(self, name: PolicyName, episodes: Iterator[Episode], folder: Path, config: DistilConfig) -> None:
        self.name, self.folder, self.config = name, folder, config
        self._source, self._drawn = episodes, list[Episode]()

    def run(self, report: Report = lambda _line: None) -> TrainedPolicy:
        """All rounds. TrainingFaultError, with the batch saved in the folder."""
        policy: TrainedPolicy | None = None
        for number in range(self.config.rounds):
            lessons = self._taught(number, policy)
            policy = self._learned(number, policy, report)
            frames, fell = sum(len(one.frames) for one in lessons), sum(one.fell for one in lessons)
            report(f"round {number + 1} of {self.config.rounds}: {frames} frames, {fell} of {len(lessons)} fell")
        if policy is None:
            raise ValueError("rounds: at least one")
        return policy

    def _episode(self, index: int) -> Episode:
        while len(self._drawn) <= index:
            self._drawn.append(next(self._source))
        return self._drawn[index]

    def _taught(self, number: int, policy: TrainedPolicy | None) -> list[Lesson]:
        """The lessons of a round; those that a run before has kept are not taught again."""
        found = []
        for index in range(number * self.config.episodes, (number + 1) * self.config.episodes):
            kept = self.folder / "lessons" / f"{index:04d}.npz"
            if not kept.is_file():
                rng = np.random.default_rng([self.config.seed, index])
                share = dict(enumerate(self.config.taken_over, 1)).get(number, 0.0)
                teach(self._episode(index), policy, rng, share).save(kept)
            found.append(Lesson.load(kept))
        return found

    def _learned(self, number: int, policy: TrainedPolicy | None, report: Report) -> TrainedPolicy:
        """What comes of all lessons so far."""
        kept = self.folder / f"round-{number:02d}.safetensors"
        if kept.is_file():
            return TrainedPolicy.load(kept)
        rows = self._rows((number + 1) * self.config.episodes)
        policy = policy or new_policy(self.name, rows, self.config.seed, self._answers(self.config.episodes))
        losses = clone(policy, rows, self.config.cloning, self.folder)
        report(f"{len(rows.seen)} states; loss {np.mean(losses[:SHOWN]):.3f} to {np.mean(losses[-SHOWN:]):.3f}")
        policy = TrainedPolicy(
            policy.name, policy.network, policy.seen, policy.done, self._told(number, len(rows.seen))
        )
        policy.save(kept)
        # What is gone on with is what a run that was ended would read.
        return TrainedPolicy.load(kept)

    def _rows(self, count: int) -> Rows:
        seen, done = [], []
        for index in range(count):
            lesson = self._lesson(index)
            rng = np.random.default_rng([self.config.seed, index, 1])
            for observed, controls in samples(self._episode(index), lesson, rng, self.config.perturbed):
                seen.append(observed)
                done.append(controls)
                if self._mirrored:
                    seen.append(mirrored_observation(observed, self.name))
                    done.append(CONTROLS(controls))
        return Rows(np.concatenate(seen), np.concatenate(done))

    def _answers(self, count: int) -> Array:
        """What a teacher's answers have in common, of episodes in which it did not fall, if there are any."""
        taught = [(self._episode(at), self._lesson(at)) for at in range(count)]
        return linear_answers([one for one in taught if not one[1].fell] or taught, self._mirrored)

    @property
    def _mirrored(self) -> bool:
        """Whether lessons are learned in the mirror too: words have none, whose sides would be the wrong ones."""
        return self.name not in WITH_TEXT

    def _lesson(self, index: int) -> Lesson:
        return Lesson.load(self.folder / "lessons" / f"{index:04d}.npz")

    def _told(self, number: int, states: int) -> dict[str, Any]:
        return {"method": "distil", "rounds": number + 1, "episodes": self.config.episodes, "states": states}


SHOWN: Final = 50
"""Steps that a loss is averaged over where it is told."""
REACHES: Final = 0.1
"""Radians of a control's offset that an action of 1 is, where rewards teach."""


@dataclass(frozen=True)
class RewardConfig:
    """How a policy learns from rewards."""

    rounds: int = 10
    bodies: int = 16
    frames: int = 64
    """Of each body in a round."""
    seed: int = 0
    style: bool = False
    """Whether a discriminator's verdict is part of the reward (AMP)."""
    ppo: PPOConfig = field(default_factory=PPOConfig)


class RewardRun:
    """A policy that learns by PPO, or AMP, in a folder that keeps where it is; bodies begin anew when it goes on."""

    def __init__(self, name: PolicyName, episodes: Sequence[Episode], folder: Path, config: RewardConfig) -> None:
        self.name, self.folder, self.config = name, folder, config
        self.scale = Normalization(np.zeros(NU, np.float32), np.full(NU, REACHES, np.float32))
        plain = SkillEnvironment(episodes, self.scale, config.bodies, config.seed, name is PolicyName.WALK)
        size = plain.observe().shape[1]
        with torch.random.fork_rng():
            torch.manual_seed(config.seed)
            policy, value = Policy(PolicyConfig.of(name, NU)), Value(size)
        self.ppo = PPO(policy, value, size, config.ppo, config.seed)
        text = policy.config.text
        judge = DiscriminatorTrainer(DiscriminatorConfig(text=text), config.seed)
        self.styled = StyledEnvironment(plain, judge, text) if config.style else None
        self.environment: VectorEnvironment = self.styled or plain

    def run(self, report: Report = lambda _line: None) -> TrainedPolicy:
        """All rounds. TrainingFaultError, with the batch saved in the folder."""
        rng = np.random.default_rng(self.config.seed)
        for number in range(self._resume(), self.config.rounds):
            rollout = self.ppo.collect(self.environment, self.config.frames)
            told = self.ppo.update(rollout, self.folder)
            told["reward"] = float(rollout.rewards.mean())
            if self.styled is not None:
                told |= {f"style {key}": one for key, one in self.styled.learn(rng).items()}
            self._save(number + 1)
            report(f"round {number + 1} of {self.config.rounds}: " + ", ".join(f"{k} {v:.4g}" for k, v in told.items()))
        spread = np.sqrt(self.ppo.scale.variance + 1e-6).astype(np.float32)
        seen = Normalization(self.ppo.scale.mean.astype(np.float32), spread)
        told_of = {"method": "amp" if self.config.style else "ppo", "rounds": self.config.rounds}
        return TrainedPolicy(self.name, self.ppo.policy.eval().requires_grad_(False), seen, self.scale, told_of)

    def _networks(self) -> dict[str, torch.nn.Module]:
        judge = {"judge": self.styled.trainer.discriminator} if self.styled is not None else {}
        return {"policy": self.ppo.policy, "value": self.ppo.value, **judge}

    def _optimizers(self) -> dict[str, torch.optim.Optimizer]:
        judge = {"judge": self.styled.trainer.optimizer} if self.styled is not None else {}
        return {"policy": self.ppo.optimizer, "value": self.ppo.value_optimizer, **judge}

    def _save(self, rounds: int) -> None:
        tensors = {
            f"{net}.{key}": value for net, one in self._networks().items() for key, value in one.state_dict().items()
        }
        for name, one in self._optimizers().items():
            for index, moments in one.state_dict()["state"].items():
                tensors |= {f"optimizer.{name}.{index}.{key}": value for key, value in moments.items()}
        scale = self.ppo.scale
        tensors |= {"scale.mean": torch.from_numpy(scale.mean), "scale.variance": torch.from_numpy(scale.variance)}
        tensors["chance"] = self.ppo.chance.get_state()
        self.folder.mkdir(parents=True, exist_ok=True)
        aside = self.folder / f"{CHECKPOINT}.writing"
        whole = {name: value.contiguous() for name, value in tensors.items()}
        save_file(whole, aside, {"rounds": str(rounds), "seen": str(scale.count), "run": self._settings})
        aside.replace(self.folder / CHECKPOINT)

    @property
    def _settings(self) -> str:
        """What must be the same for a run to be gone on with."""
        return json.dumps([self.name.value, asdict(replace(self.config, rounds=0))], sort_keys=True)

    def _resume(self) -> int:
        """How many rounds a checkpoint has behind it; 0 where there is none. TrainingFaultError for another run's."""
        path = self.folder / CHECKPOINT
        if not path.is_file():
            return 0
        with safe_open(path, "pt") as file:
            told, tensors = file.metadata(), {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
        if told["run"] != self._settings:
            raise TrainingFaultError(f"{path} is of a run with other settings", "give another --out, or move it away")
        for name, network in self._networks().items():
            network.load_state_dict(_under(f"{name}.", tensors))
        for name, optimizer in self._optimizers().items():
            kept: dict[int, dict[str, torch.Tensor]] = {}
            for key, value in _under(f"optimizer.{name}.", tensors).items():
                index, moment = key.split(".")
                kept.setdefault(int(index), {})[moment] = value
            optimizer.load_state_dict({"state": kept, "param_groups": optimizer.state_dict()["param_groups"]})
        scale = self.ppo.scale
        scale.mean, scale.variance = tensors["scale.mean"].numpy(), tensors["scale.variance"].numpy()
        scale.count = int(told["seen"])
        self.ppo.chance.set_state(tensors["chance"])
        return int(told["rounds"])


CHECKPOINT: Final = "checkpoint.safetensors"


def _under(prefix: str, tensors: Mapping[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    return {name.removeprefix(prefix): value for name, value in tensors.items() if name.startswith(prefix)}
