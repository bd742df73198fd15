"""Which clips are learned from and which are kept back: everything of one subject, or of one room, is on one side."""

from __future__ import annotations

from collections.abc import Sequence
from hashlib import sha256
from typing import Final

TRAIN, TEST = "train", "test"
TEST_SHARE: Final = 0.2


def splits(subjects: Sequence[tuple[str, int]], seed: int = 0) -> dict[str, str]:
    """Every subject's side, train or test, from (subject, frames): about a fifth of all frames is for testing.

    Subjects come in an order that only their names and the seed decide; one alone is for training.
    """
    frames: dict[str, int] = {}
    for subject, count in subjects:
        frames[subject] = frames.get(subject, 0) + count
    order = sorted(frames, key=lambda subject: sha256(f"{seed}:{subject}".encode()).digest())
    left = TEST_SHARE * sum(frames.values())
    sides = dict.fromkeys(frames, TRAIN)
    for subject in order:
        if frames[subject] <= 1.25 * left and len(order) > 1:
            sides[subject] = TEST
            left -= frames[subject]
    return sides
