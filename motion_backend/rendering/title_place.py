"""Where in a film's first pictures a title stands, and until when: above the told words, beside the body, and over it
only if it fills all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from motion_backend.rendering.camera import FOV
from motion_backend.rotations import Array

if TYPE_CHECKING:
    from motion_backend.rendering.film_shots import FilmShot

EVERY: Final = 5
"""Frames between two looks."""
SKIN: Final = 0.16
"""Metres around a joint that hands, feet, hair and skin reach, with some air."""


@dataclass(frozen=True)
class Place:
    """How much of a picture's free width is on the left of words, of its free height above them: they always fit."""

    across: float
    down: float

    def box(self, words: tuple[int, int], size: tuple[int, int]) -> tuple[float, float, float, float]:
        """Left, top, right and bottom of words (height, width), in pixels of a picture (width, height)."""
        left, top = self.across * (size[0] - words[1]), self.down * (size[1] - words[0])
        return left, top, left + words[1], top + words[0]


PLACES: Final = (
    *(Place(across, 0.04) for across in (0.05, 0.95, 0.5)),
    *(Place(across, down) for down in (0.37, 0.68) for across in (0.05, 0.95)),
)
"""The most wanted first."""


def title_place(
    words: tuple[int, int], size: tuple[int, int], shots: Sequence[FilmShot], joints: Array
) -> tuple[Place, int]:
    """The place in which words (height, width) lie for longest on nothing of the body, in the first T pictures
    (width, height), which these shots show, and the frame until which they do; of places alike the one with least of
    the body, then the first. `joints` (T, 22, 3) are the body's in the world."""
    hidden = np.zeros(len(PLACES))
    clear = np.full(len(PLACES), len(joints))
    for shot in shots:
        for frame in range(shot.start, min(shot.stop, len(joints)), EVERY):
            x, y, nearness = np.moveaxis(shot.camera.project(shot.camera.view(joints[frame]), size), -1, 0)
            skin = SKIN * nearness * size[1] / (2 * np.tan(FOV / 2))
            for number, place in enumerate(PLACES):
                left, top, right, bottom = place.box(words, size)
                over = (x + skin > left) & (x - skin < right) & (y + skin > top) & (y - skin < bottom)
                hidden[number] += np.count_nonzero(over)
                if over.any():
                    clear[number] = min(clear[number], frame)
    best = int(np.lexsort((hidden, -clear))[0])
    return PLACES[best], int(clear[best])
