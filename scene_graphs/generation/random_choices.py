"""How large our furniture is: drawn about the medians of real rooms (scene-formats 2.4).

What falls to a room by its number: shares that hold in every few rooms, not only in thousands.

A Latin hypercube: of every `BLOCK` rooms of a kind that follow each other, each has its own fiftieth of every draw, and
a share of 0.3 comes out as 15 of 50.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from zlib import crc32

import numpy as np

from scene_graphs.layout import Point3

SIZES: dict[str, tuple[Point3, Point3]] = {
    "double_bed": ((1.8, 0.95, 2.1), (2.15, 1.15, 2.3)),
    "single_bed": ((1.05, 0.85, 2.0), (1.3, 1.0, 2.15)),
    "kids_bed": ((0.95, 0.75, 1.85), (1.1, 0.9, 1.95)),
    "bunk_bed": ((1.0, 1.7, 2.0), (1.15, 1.8, 2.1)),
    "sofa_bed": ((1.95, 0.82, 0.95), (2.2, 0.9, 1.05)),
    "nightstand": ((0.44, 0.5, 0.38), (0.58, 0.58, 0.46)),
    "table_lamp": ((0.24, 0.42, 0.24), (0.3, 0.52, 0.3)),
    "floor_lamp": ((0.36, 1.5, 0.36), (0.44, 1.7, 0.44)),
    "pendant_lamp": ((0.4, 0.9, 0.4), (0.6, 1.1, 0.6)),
    "ceiling_lamp": ((0.45, 0.14, 0.45), (0.6, 0.18, 0.6)),
    "wardrobe": ((1.4, 2.12, 0.56), (2.2, 2.35, 0.64)),
    "cabinet": ((0.95, 1.55, 0.36), (1.4, 1.95, 0.44)),
    "wine_cabinet": ((0.7, 1.7, 0.36), (0.95, 1.95, 0.42)),
    "bookshelf": ((0.8, 1.75, 0.3), (1.25, 2.1, 0.38)),
    "shelf": ((0.45, 1.5, 0.33), (0.65, 1.85, 0.42)),
    "dresser": ((0.85, 0.88, 0.38), (1.12, 1.08, 0.46)),
    "console_table": ((1.15, 0.82, 0.36), (1.55, 0.96, 0.44)),
    "tv_stand": ((1.65, 0.46, 0.4), (2.15, 0.6, 0.48)),
    "tv": ((1.0, 0.6, 0.1), (1.3, 0.75, 0.12)),
    "desk": ((1.2, 0.73, 0.58), (1.55, 0.77, 0.68)),
    "dressing_table": ((1.0, 1.18, 0.43), (1.25, 1.36, 0.5)),
    "dining_table": ((1.35, 0.74, 0.8), (1.75, 0.78, 0.95)),
    "coffee_table": ((0.95, 0.38, 0.6), (1.3, 0.46, 0.78)),
    "side_table": ((0.45, 0.5, 0.45), (0.56, 0.6, 0.55)),
    "round_end_table": ((0.45, 0.5, 0.45), (0.56, 0.6, 0.55)),
    "multi_seat_sofa": ((2.1, 0.8, 0.9), (2.55, 0.9, 1.0)),
    "loveseat_sofa": ((1.68, 0.76, 0.84), (1.95, 0.86, 0.94)),
    "l_shaped_sofa": ((2.4, 0.8, 1.5), (2.8, 0.88, 1.7)),
    "chaise_longue_sofa": ((1.8, 0.78, 0.78), (1.95, 0.85, 0.86)),
    "armchair": ((0.76, 0.78, 0.8), (0.9, 0.92, 0.9)),
    "lounge_chair": ((0.64, 0.78, 0.66), (0.74, 0.88, 0.76)),
    "lazy_sofa": ((0.82, 0.7, 0.82), (0.95, 0.8, 0.92)),
    "dining_chair": ((0.46, 0.82, 0.52), (0.54, 0.92, 0.57)),
    "dressing_chair": ((0.46, 0.78, 0.5), (0.54, 0.86, 0.56)),
    "office_chair": ((0.56, 0.88, 0.56), (0.64, 1.02, 0.64)),
    "stool": ((0.4, 0.43, 0.37), (0.5, 0.47, 0.43)),
    "ottoman": ((0.55, 0.4, 0.43), (0.72, 0.45, 0.52)),
    "bench": ((1.1, 0.43, 0.36), (1.4, 0.47, 0.42)),
    "refrigerator": ((0.65, 1.7, 0.64), (0.85, 1.85, 0.7)),
    "plant": ((0.4, 0.9, 0.4), (0.6, 1.4, 0.6)),
    "vase": ((0.14, 0.3, 0.14), (0.2, 0.42, 0.2)),
    "mirror": ((0.5, 1.5, 0.06), (0.7, 1.7, 0.08)),
    "picture": ((0.5, 0.4, 0.04), (1.0, 0.7, 0.04)),
    "rug": ((2.0, 0.012, 1.4), (2.8, 0.012, 2.0)),
}
"""Least and greatest width, height and depth our rooms use, in metres."""


def size_of(rng: np.random.Generator, category: str) -> Point3:
    """A size between the least and greatest of a category, to the centimetre."""
    low, high = SIZES[category]
    w, h, d = (round(float(rng.uniform(a, b)), 2 if category != "rug" else 3) for a, b in zip(low, high, strict=True))
    return (w, h, d)


BLOCK = 50
SPREAD = 0.8
"""How much more often rooms of plenty get something than poor ones: 0 not at all, 1 nearly always."""


@dataclass(frozen=True)
class Luck:
    """The draws of room `number` of a kind. The same word gives the same draw."""

    kind: str
    number: int

    def draw(self, word: str) -> float:
        """A number in (0, 1), evenly spread over the rooms of a block."""
        return _draws(f"{self.kind} {word}", self.number // BLOCK)[self.number % BLOCK]

    def has(self, word: str, share: float) -> bool:
        """Whether it falls to this room, as to that share of its block: to rooms of plenty more often."""
        return self.number % BLOCK in _chosen(self.kind, word, share, self.number // BLOCK)

    def choose(self, word: str, shares: dict[str, float]) -> str:
        """One of several words with its share; what is left to 1 is the last one's."""
        drawn = self.draw(word)
        for name, share in shares.items():
            drawn -= share
            if drawn < 0:
                return name
        return name


@lru_cache(maxsize=4096)
def _draws(word: str, block: int) -> tuple[float, ...]:
    """The middles of as many equal parts of 0..1 as a block has rooms, in random order."""
    order = np.random.default_rng([crc32(word.encode()), block]).permutation(BLOCK)
    return tuple(((order + 0.5) / BLOCK).tolist())


@lru_cache(maxsize=4096)
def _chosen(kind: str, word: str, share: float, block: int) -> frozenset[int]:
    """The rooms of a block that get a thing: those of the least draws, after what is taken off for plenty."""
    draws, plenty = (np.array(_draws(f"{kind} {name}", block)) for name in (word, "plenty"))
    late = np.argsort(draws - 2 * SPREAD * plenty * min(share, 1 - share), kind="stable")
    return frozenset(late[: round(share * BLOCK)].tolist())
