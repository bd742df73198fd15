"""Mode `policy`: a part is done by a policy that passed its bar; where there is none, or it falls, `mpc` does it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from motion_backend.backend_protocol import Part
from motion_backend.embedding.text_motion_embedding import EmbeddingError, TextMotionEmbedding
from motion_backend.motion import Motion
from motion_backend.physics.mpc import Moment
from motion_backend.physics.policies import WITH_TEXT, PolicyName
from motion_backend.physics.policy_player import PolicyPlayer
from motion_backend.physics.policy_view import View, policy_of
from motion_backend.physics.task import Task
from motion_backend.physics.tracker import Tracked, fallen
from motion_backend.physics.trained_policy import PolicyError, TrainedPolicy
from motion_backend.rotations import Array

SHIPPED: Final = "data/policies"
"""In this package."""
BARS: Final = {
    PolicyName.WALK: 0.8, PolicyName.SIT: 0.9, PolicyName.LIE: 0.7, PolicyName.REACH: 0.9, PolicyName.GETUP: 0.7,
}  # fmt: skip
"""The share of trials, in rooms not learned in, that a policy has to do before it may move a body in a story."""
LEAST_TRIALS: Final = 24
"""And of so many trials at least."""


class Played(NamedTuple):
    """What came of asking for a policy."""

    done: Tracked | None
    """None where model-predictive control is to do it."""
    why: str = ""
    """For what reason."""


@dataclass
class PolicyMode:
    """The policies of a folder, each read when it is first wanted."""

    folder: Path | None = None
    """None: those that are shipped."""
    _known: dict[PolicyName, tuple[TrainedPolicy | None, str]] = field(default_factory=dict)
    _embedding: TextMotionEmbedding | None = None

    def play(
        self, task: Task, part: Part, planned: Motion, start: Moment, between: Callable[[], None] = lambda: None
    ) -> Played:
        """Do a part by its policy."""
        name = policy_of(part)
        if name is None:
            return Played(None, "there is no policy for it")
        policy, why = self._policy(name)
        if policy is None:
            return Played(None, why)
        try:
            words = self._words(part.action.caption) if name in WITH_TEXT else np.zeros(0)
        except EmbeddingError as error:
            return Played(None, error.fault)
        player = PolicyPlayer.of(View.of(task, part, planned, words))
        done = player.play(policy, start, len(planned), between)
        if fallen(done.moments[-1], task.reference.qpos[len(done.moments) - 1]):
            return Played(None, f"the policy {name.name.lower()} fell")
        return Played(done)

    def _policy(self, name: PolicyName) -> tuple[TrainedPolicy | None, str]:
        if name not in self._known:
            self._known[name] = self._read(name)
        return self._known[name]

    def _read(self, name: PolicyName) -> tuple[TrainedPolicy | None, str]:
        """A policy that passed its bar, else None and why."""
        file = f"{name.name.lower()}.safetensors"
        try:
            if self.folder is not None:
                found = TrainedPolicy.load(self.folder / file)
            else:
                with resources.as_file(resources.files("motion_backend") / SHIPPED / file) as path:
                    if not path.is_file():
                        return None, f"no policy {name.name.lower()} has passed its bar"
                    found = TrainedPolicy.load(path)
        except PolicyError as error:
            return None, error.fault
        if found.name is not name:
            return None, f"{file} holds another policy: {found.name.name.lower()}"
        share, trials = found.figures.get("reached", 0.0), found.figures.get("trials", 0)
        if share < BARS[name] or trials < LEAST_TRIALS:
            return None, f"the policy {name.name.lower()} did {share:.0%} of {trials} trials and not {BARS[name]:.0%}"
        return found, ""

    def _words(self, caption: str) -> Array:
        self._embedding = self._embedding or TextMotionEmbedding.load()
        return np.asarray(self._embedding.texts([caption])[0], dtype=np.float64)
