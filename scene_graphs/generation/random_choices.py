"""How large our furniture is: drawn about the medians of real rooms (scene-formats 2.4).

What falls to a room by its number: shares that hold in every few rooms, not only in thousands.

A Latin hypercube: of every `BLOCK` rooms of a kind that follow each other, each has its own fiftieth of every draw, and
a share of 0.3 comes out as 15 of 50.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, lru_cache
from zlib import crc32

import numpy as np

from scene_graphs.data_tables import read_table, require_known, table
from scene_graphs.furniture import catalogue
from scene_graphs.layout import Point3


@table
class SizeRange:
    """Width, height and depth of the smallest and the largest piece of a category."""

    min_m: Point3
    max_m: Point3


@table
class FurnitureSizes:
    """By category."""

    sizes: dict[str, SizeRange]

    def __post_init__(self) -> None:
        require_known("sizes", self.sizes, catalogue().categories)
        for category, size in self.sizes.items():
            if not all(0 < low <= high for low, high in zip(size.min_m, size.max_m, strict=True)):
                raise ValueError(f"sizes.{category}: {size.min_m} to {size.max_m} is no range of sizes")


@cache
def sizes() -> dict[str, SizeRange]:
    """The sizes that our rooms use by category, from data/furniture_sizes.toml."""
    known: FurnitureSizes = read_table("scene_graphs", "furniture_sizes.toml", FurnitureSizes)
    return known.sizes


def size_of(rng: np.random.Generator, category: str) -> Point3:
    """A size between the least and greatest of a category, to the centimetre."""
    size, digits = sizes()[category], 2 if category != "rug" else 3
    w, h, d = (round(float(rng.uniform(*ends)), digits) for ends in zip(size.min_m, size.max_m, strict=True))
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
