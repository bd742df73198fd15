"""Retrieval in bounded time: what it says is proven is what an unbounded search finds."""

from __future__ import annotations

import numpy as np
import pytest
from examples import tries

from planner_service.api.layouts import views
from planner_service.api.layouts.views import retrieved
from scene_graphs.graph.furniture_graph import FurnitureGraph, graph_from_uses
from scene_graphs.layout import Layout, Placed
from scene_graphs.retrieval.layout_index import LayoutIndex

WORDS = ("stool", "dining_chair", "desk")
TYPES = ("bedroom", "study")


def library(rng: np.random.Generator) -> LayoutIndex:
    """A few rooms of two types with pieces that are easily taken for one another, often as many of each."""
    words, layouts = rng.choice(WORDS, 8), []
    for number in range(6):
        pieces = []
        for place, word in enumerate(words[: int(rng.choice([5, 8]))].tolist()):
            x, z = rng.uniform(-2.5, 2.5, 2).tolist()
            pieces.append(Placed(f"{word}_{place}", word, (x, 0.0, z), (0.4, 0.5, 0.4)))
        floor = ((-3.0, -3.0), (-3.0, 3.0), (3.0, 3.0), (3.0, -3.0))
        layouts.append(Layout(f"room-{number}", TYPES[number % 3 == 0], floor, objects=tuple(pieces)))
    return LayoutIndex(layouts)


def query(rng: np.random.Generator) -> FurnitureGraph:
    return graph_from_uses([(WORDS[int(rng.integers(3))], int(rng.integers(1, 4))) for _ in range(8)])


ROUNDS = tries(100).max_examples


@pytest.mark.parametrize("k", [1, 2])
@pytest.mark.parametrize("types", [pytest.param(TYPES[:1], marks=pytest.mark.sweep), TYPES])
def test_what_is_called_proven_is_what_is_found_without_a_limit(
    types: tuple[str, ...], k: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng, proven = np.random.default_rng(0), 0
    for _ in range(ROUNDS):
        index, graph = library(rng), query(rng)
        right = retrieved(index, graph, k, types)
        for steps in (2, 5, 8, 12):
            with monkeypatch.context() as patch:
                patch.setattr(views, "MIN_STEPS", steps)
                patch.setattr(views, "MAX_STEPS", steps)
                found = retrieved(index, graph, k, types)
            for one, other in zip(found, right, strict=True):
                if one.told.exact:
                    proven += 1
                    assert (one.layout_ids, one.told.distance) == (other.layout_ids, other.told.distance)
    assert proven
