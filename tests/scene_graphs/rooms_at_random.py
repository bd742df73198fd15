"""Small rooms strewn with furniture, and libraries of them, for the tests of searching."""

from __future__ import annotations

import numpy as np
from graphs_at_random import CATEGORIES, GENERIC, build, graphs
from hypothesis import strategies as st

from scene_graphs.furniture import typical_size
from scene_graphs.graph.furniture_graph import FurnitureGraph
from scene_graphs.layout import Layout, Placed

SCATTERED = (
    *("double_bed", "desk", "dining_table", "bookshelf", "floor_lamp"),
    *("piano", "stool", "armchair", "wardrobe", "tv_stand"),
)
SQUARE = ((0.0, 0.0), (0.0, 8.0), (8.0, 8.0), (8.0, 0.0))


def strewn(name: str, categories: list[str], seed: int = 0, room_type: str = "bedroom") -> Layout:
    """Furniture strewn over a square."""
    points = np.random.default_rng(seed).uniform(0, 6, (len(categories), 2))
    objects = (
        Placed(f"o{i}", category, (float(x), 0.0, float(z)), typical_size(category))
        for i, (category, (x, z)) in enumerate(zip(categories, points, strict=True))
    )
    return Layout(name, room_type, SQUARE, objects=tuple(objects))


@st.composite
def searches(
    draw: st.DrawFn, fewest: int = 1, most: int = 9, objects: int = 4, nodes: int = 5
) -> tuple[list[Layout], FurnitureGraph]:
    """A library and a query of the same few words, so that rooms have different parts of it and ties are common."""
    pool = draw(st.lists(st.sampled_from(CATEGORIES), min_size=1, max_size=5))
    rooms = draw(st.lists(st.lists(st.sampled_from(pool), max_size=objects), min_size=fewest, max_size=most))
    layouts = [
        strewn(f"r{i * 7 % 13}", room, seed=i % 3, room_type=("bedroom", "study")[i % 2])
        for i, room in enumerate(rooms)
    ]
    query = draw(graphs(nodes, (*pool, *pool, draw(st.sampled_from(GENERIC))), "needs").filter(len))
    return layouts, query


def scattered(seed: int, rooms: int = 9) -> tuple[list[Layout], FurnitureGraph]:
    """Rooms of one to three pieces and a query for five to eight: most take three or four rooms."""
    rng = np.random.default_rng(seed)
    layouts = [
        strewn(f"r{i}", [SCATTERED[j] for j in rng.choice(len(SCATTERED), rng.integers(1, 4), replace=False)], seed=i)
        for i in range(rooms)
    ]
    words = [SCATTERED[j] for j in rng.choice(len(SCATTERED), rng.integers(5, 9))]
    joined = [sorted(int(end) for end in rng.choice(len(words), 2, replace=False)) for _ in range(3)]
    return layouts, build(words, {(low, high) for low, high in joined})
