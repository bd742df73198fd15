"""Random furniture graphs and a distance by brute force, sharing no code with the search."""

from __future__ import annotations

from itertools import combinations, product

import networkx as nx
from hypothesis import strategies as st

from scene_graphs.furniture import Furniture, catalogue, categories_of, class_of
from scene_graphs.graph.furniture_graph import FurnitureGraph

CATEGORIES: tuple[str, ...] = (
    *("dining_chair", "armchair", "stool", "multi_seat_sofa", "loveseat_sofa", "double_bed", "single_bed"),
    *("dining_table", "nightstand", "wardrobe", "bookshelf", "floor_lamp", "table_lamp", "vase", "piano"),
)
GENERIC: tuple[str, ...] = ("chair", "sofa", "bed", "lamp", "table")
NEEDS = (frozenset[str](), frozenset({"sit"}), frozenset({"lie"}), frozenset({"touch"}), frozenset({"sit", "touch"}))


def build(words: list[str], edges: set[tuple[int, int]], **sets: list[frozenset[str]]) -> FurnitureGraph:
    graph: FurnitureGraph = nx.Graph()
    nodes: list[Furniture] = []
    for index, word in enumerate(words):
        nodes.append(Furniture(word, 1 + words[:index].count(word)))
        graph.add_node(nodes[-1], **{name: values[index] for name, values in sets.items()})
    graph.add_edges_from((nodes[a], nodes[b]) for a, b in edges)
    return graph


@st.composite
def graphs(
    draw: st.DrawFn, most: int = 4, words: tuple[str, ...] = CATEGORIES, constrained: str | None = None
) -> FurnitureGraph:
    """A random graph; `constrained` names the node attribute ("needs" or "offers") that is drawn too."""
    pool = draw(st.lists(st.sampled_from(words), min_size=1, max_size=5))
    labels = draw(st.lists(st.sampled_from(pool), max_size=most))
    pairs = list(combinations(range(len(labels)), 2))
    edges = draw(st.sets(st.sampled_from(pairs))) if pairs else set()
    sets = {}
    if constrained:
        sets[constrained] = [draw(st.sampled_from(NEEDS)) for _ in labels]
    return build(labels, edges, **sets)


def brute_force(query: FurnitureGraph, room: FurnitureGraph, lost: int = 20, *, strict: bool = False) -> int:
    """The distance by trying every partial injection."""
    nodes, others = list(query), list(room)
    joined = {frozenset(edge) for edge in room.edges}
    best = None
    for images in product([None, *others], repeat=len(nodes)):
        hit = [image for image in images if image is not None]
        if len(set(hit)) < len(hit):
            continue
        cost = sum(0 if _minor(r) else 1 for r in others if r not in hit)
        steps = [_step(query, room, q, r, strict) for q, r in zip(nodes, images, strict=True)]
        if None in steps:
            continue
        where = dict(zip(nodes, images, strict=True))
        cost += sum(step for step in steps if step is not None)
        cost += lost * sum(frozenset((where[a], where[b])) not in joined for a, b in query.edges)
        best = cost if best is None else min(best, cost)
    assert best is not None
    return best


def _step(query: FurnitureGraph, room: FurnitureGraph, q: Furniture, r: Furniture | None, strict: bool) -> int | None:
    if r is None:
        return 25 if _minor(q) else 100
    if not query.nodes[q].get("needs", frozenset()) <= room.nodes[r].get("offers", NEEDS[4] | {"lie"}):
        return None
    if r.category == q.category or (q.category in catalogue().kinds and r.category in categories_of(q.category)):
        return 0
    if strict:
        return None
    if class_of(q.category) == class_of(r.category):
        return 8 if _minor(q) else 30
    if _group(q) == _group(r):
        return 15 if _minor(q) else 60
    return None


def _group(node: Furniture) -> str:
    return catalogue().group_of_class.get(class_of(node.category), node.category)


def _minor(node: Furniture) -> bool:
    return _group(node) in ("light", "decor")
