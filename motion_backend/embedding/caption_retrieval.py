"""How well words find their motion and motion its words, by groups of captions that mean the same."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Retrieval:
    """Shares over clips and captions."""

    groups: int
    """Of captions, among which each clip's own is to be first."""
    clips: int
    first: float
    """Clips whose own group is first among all."""
    among_three: float
    median_rank: float
    finds: float
    """Captions whose nearest clip is of their group, of those that have a clip at all."""
    taken_for: tuple[tuple[str, str, int], ...]
    """The most frequent mistakes: of which group, for which, how often."""


def retrieve(motions: Floats, groups: Sequence[str], captions: Floats, caption_groups: Sequence[str]) -> Retrieval:
    """Rank all groups of captions for clips (N, 64), and clips for captions (C, 64); a group is as near as its nearest.

    ValueError where a clip's group has no caption.
    """
    names = sorted(set(caption_groups))
    if missing := sorted(set(groups) - set(names)):
        raise ValueError(f"groups: no caption is of {missing[0]!r}")
    alike = motions @ captions.T  # (clips, captions)
    of_group = np.array([names.index(group) for group in caption_groups])
    nearest = np.stack([alike[:, of_group == index].max(axis=1) for index in range(len(names))], axis=1)
    own = np.array([names.index(group) for group in groups])
    ranks = (nearest > nearest[np.arange(len(own)), own][:, None]).sum(axis=1) + 1
    asked = np.isin(of_group, own)
    finds = own[alike.argmax(axis=0)] == of_group
    return Retrieval(
        groups=len(names),
        clips=len(own),
        first=float((ranks == 1).mean()),
        among_three=float((ranks <= 3).mean()),
        median_rank=float(np.median(ranks)),
        finds=float(finds[asked].mean()),
        taken_for=_mistakes(own, nearest.argmax(axis=1), names),
    )


def _mistakes(own: NDArray[np.int_], taken: NDArray[np.int_], names: Sequence[str]) -> tuple[tuple[str, str, int], ...]:
    pairs, times = np.unique(np.stack([own, taken], axis=1)[own != taken], axis=0, return_counts=True)
    found = [(names[a], names[b], int(n)) for (a, b), n in zip(pairs.tolist(), times.tolist(), strict=True)]
    return tuple(sorted(found, key=lambda one: (-one[2], one)))
