"""Nobody does a thing as somebody else does, nor twice alike: what is drawn for one time of it.

Half of its variance is a character's, drawn from the seed of its story, and lasts through that.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, TypeVar

import numpy as np

T = TypeVar("T")
DRAWN: Final = 2.0
"""Nothing is drawn beyond so many standard deviations."""


def drawn_way(nobody: T, spread: Mapping[str, float], seed: tuple[int, int], rng: np.random.Generator) -> T:
    """What one time has of its own: a way like `nobody`'s, of whom all is as the tables say.

    `spread` has standard deviations by the names of its fields with their units; what is no field is left out. `seed`
    is the character's, and what sets this draw apart from others of it.
    """
    always, drawn = np.random.default_rng(seed), {}
    for column, deviation in spread.items():
        name = column.rpartition("_")[0]
        if name in vars(nobody):
            size = np.shape(getattr(nobody, name))
            one = (always.normal(size=size) + rng.normal(size=size)) / np.sqrt(2)
            drawn[name] = deviation * np.clip(one, -DRAWN, DRAWN)
    return type(nobody)(**drawn)
