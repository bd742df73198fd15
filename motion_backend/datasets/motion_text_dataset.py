"""Captioned clips as a learner draws them: 300 frames each, in any of their wordings, mirrored or not (SIMS 4.1)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.datasets.normalization import Floats
from motion_backend.mocap.augmentation import mirror_words
from motion_backend.mocap.dataset_file import Entry
from motion_backend.motion import Motion, Skill
from motion_backend.physics.observations import mirror_state, moments_of, state

SAMPLED: Final = 300
"""Frames drawn of every clip (SIMS 3.3, after MotionCLIP)."""
SPARED: Final = 0.1
"""A share up to this is left out at both ends of a clip that is learned from: clips do not begin alike in life."""
MIN_FRAMES: Final = 15
"""Half a second: what is shorter shows nothing."""


@dataclass(frozen=True)
class MotionText:
    """A clip and all the words for it."""

    name: str
    states: NDArray[np.float16]
    """(T, STATE_SIZE) s of every frame, in its own units."""
    wordings: tuple[str, ...]
    """Its caption first, then other ways to say it."""
    group: str
    """Which captions mean the same as its own; those of recorded clips are too loose to be told apart: empty."""


@dataclass(frozen=True)
class Drawn:
    """A batch of B clips."""

    states: Floats
    """(B, SAMPLED, STATE_SIZE), in their own units."""
    wordings: tuple[str, ...]
    """One a clip."""
    groups: tuple[str, ...]
    """As in `MotionText`, of what is shown: a mirrored clip is of the mirrored group."""


@dataclass(frozen=True)
class MotionTextDataset:
    """Clips that are learned from."""

    clips: tuple[MotionText, ...]
    grouped: dict[str, tuple[str, ...]] = field(init=False)
    """All wordings of every group, mirrored ones too."""

    def __post_init__(self) -> None:
        if not self.clips:
            raise ValueError("clips: there is none to learn from")
        found: dict[str, set[str]] = {}
        for clip in self.clips:
            for group, wordings in ((clip.group, clip.wordings), *_mirrored_words(clip)):
                found.setdefault(group, set()).update(wordings)
        found.pop("", None)
        object.__setattr__(self, "grouped", {group: tuple(sorted(found[group])) for group in sorted(found)})

    @property
    def wordings(self) -> tuple[str, ...]:
        """All that may be drawn or asked for, in an order of their own."""
        said = {wording for clip in self.clips for wording in (*clip.wordings, *map(mirror_words, clip.wordings))}
        return tuple(sorted(said.union(*self.grouped.values())))

    def draw(self, count: int, rng: np.random.Generator) -> Drawn:
        """Some clips by chance, half of those that may be mirrored."""
        rows, wordings, groups = [], [], []
        for index in rng.integers(len(self.clips), size=count):
            clip = self.clips[index]
            frames = len(clip.states)
            start, stop = rng.uniform(0.0, SPARED * frames), frames - rng.uniform(0.0, SPARED * frames)
            states, group = clip.states[skip_sample(start, stop)], clip.group
            wording = clip.wordings[rng.integers(len(clip.wordings))]
            if rng.random() < 0.5 and may_mirror(clip):
                states, wording, group = mirror_state(states), mirror_words(wording), mirror_words(group)
            rows.append(states)
            wordings.append(wording)
            groups.append(group)
        return Drawn(np.stack(rows).astype(np.float32), tuple(wordings), tuple(groups))


def skip_sample(start: float, stop: float) -> NDArray[np.int_]:
    """300 frames spread evenly from `start` to `stop` (exclusive), so that all of a clip is in them. (SAMPLED,).

    The paper skips frames "for the motion clips that are shorter than 10 seconds", which have none to skip: longer ones
    are meant, and of shorter ones frames come more than once. Velocities are those of the whole clip either way.
    """
    return np.floor(start + (stop - start) * (np.arange(SAMPLED) + 0.5) / SAMPLED).astype(int)


def states_of(motion: Motion) -> NDArray[np.float16]:
    """s of every frame, kept in half the room; spins are cut at what half precision holds. (T, STATE_SIZE)."""
    most = float(np.finfo(np.float16).max)
    return np.clip(state(moments_of(motion)), -most, most).astype(np.float16)


def motion_texts(entries: Iterable[Entry], grouped: bool = True) -> tuple[MotionText, ...]:
    """Clips of a collection with their words; what is shorter than half a second is left out."""
    return tuple(
        MotionText(entry.name, states_of(entry.motion), entry.captions, entry.style if grouped else "")
        for entry in entries
        if len(entry.motion) >= MIN_FRAMES
    )


def may_mirror(clip: MotionText) -> bool:
    """Whether the mirrored clip still shows its words: a touch that names no hand is the right one's."""
    sided = mirror_words(clip.wordings[0]) != clip.wordings[0] or "both" in clip.wordings[0]
    return sided or f"/{Skill.TOUCH}/" not in clip.name


def _mirrored_words(clip: MotionText) -> Sequence[tuple[str, tuple[str, ...]]]:
    if not may_mirror(clip):
        return ()
    return ((mirror_words(clip.group), tuple(map(mirror_words, clip.wordings))),)
