"""Furniture graphs at random, in any number and at once, for measuring: the sizes are those of furnished rooms."""

from __future__ import annotations

from typing import Final

import networkx as nx
import numpy as np
from numpy.typing import NDArray

from scene_graphs.furniture import Furniture, affordances, catalogue
from scene_graphs.graph.furniture_graph import FurnitureGraph, graph_from_parts
from scene_graphs.graph.packed_graphs import PackedRooms, Texts, flags, offsets, vocabulary

LIKELY: Final = {
    "bedroom": "double_bed 4 nightstand 8 wardrobe 5 pendant_lamp 5 desk 2 dressing_table 2 dressing_chair 2 "
    "armchair 2 single_bed 2 kids_bed 1 bookshelf 2 cabinet 2 tv_stand 2 ceiling_lamp 2 office_chair 1 rug 2 plant 3 "
    "picture 4",
    "living_room": "multi_seat_sofa 5 loveseat_sofa 2 l_shaped_sofa 2 armchair 4 lounge_chair 3 coffee_table 5 "
    "tv_stand 5 corner_side_table 4 console_table 2 cabinet 2 bookshelf 3 floor_lamp 3 pendant_lamp 4 stool 2 plant 5 "
    "rug 3 vase 2",
    "dining_room": "dining_table 4 dining_chair 18 pendant_lamp 5 console_table 2 wine_cabinet 2 cabinet 3 plant 4 "
    "ceiling_lamp 2 armchair 1 barstool 2 bookshelf 1 picture 3 vase 2 refrigerator 1",
    "study": "desk 5 office_chair 5 bookshelf 6 armchair 2 lounge_chair 1 cabinet 3 shelf 2 pendant_lamp 3 "
    "table_lamp 3 multi_seat_sofa 1 coffee_table 1 plant 4 picture 3 rug 2 chaise_longue_sofa 1 stool 1",
}
"""What is met in a room of each type, and how often beside the rest."""
MIN_NODES, MAX_NODES = 5, 25
SPREAD: Final = 0.78
"""Side of the square that one piece has to itself; pieces nearer than 1 are joined."""
GENERAL: Final = 0.4
"""Of the words in queries that name a kind."""


def rooms_at_random(count: int, seed: int) -> PackedRooms:
    """Packed graphs of 5 to 25 pieces, 11 on average, and twice as many relations."""
    rng = np.random.default_rng(seed)
    sizes = np.minimum(MIN_NODES + rng.poisson(rng.gamma(2.0, 3.15, count)), MAX_NODES)
    categories, kinds = _categories(rng, sizes)
    starts, rooms = offsets(sizes), np.repeat(np.arange(count), sizes)
    known = vocabulary().words
    order = np.lexsort((np.argsort(np.argsort(known))[categories], rooms))
    categories = categories[order]
    neighbours, degrees = _neighbours(rng, sizes)
    offered = np.array([flags(affordances(word)) for word in known], dtype=np.uint8)
    width = len(str(count))
    return PackedRooms(
        ids=Texts.of(f"room-{number:0{width}}" for number in range(count)),
        words=(),
        categories=categories,
        offers=offered[categories],
        object_ids=Texts.of(f"object-{place}" for size in sizes.tolist() for place in range(size)),
        node_starts=starts,
        neighbours=neighbours,
        neighbour_starts=offsets(degrees),
        serves=tuple(sorted(LIKELY)),
        types=kinds,
        type_starts=np.arange(count + 1),
    )


def queries_at_random(count: int, seed: int) -> list[FurnitureGraph]:
    """Parts of such rooms, 3 to 10 pieces, with some relations left out and some words made general."""
    rng = np.random.default_rng(seed)
    rooms = rooms_at_random(count, seed)
    return [_query(rng, rooms.graph(number)) for number in range(count)]


def _query(rng: np.random.Generator, room: FurnitureGraph) -> FurnitureGraph:
    names = sorted(room)
    kind_of = {category: kind for kind, members in catalogue().kinds.items() for category in members}
    size = min(len(names), int(rng.integers(3, 11)))
    start = names[int(rng.integers(len(names)))]
    near = sorted(nx.single_source_shortest_path_length(room, start).items(), key=lambda item: item[1])
    chosen = [name for name, _ in near][:size]
    chosen += [name for name in names if name not in chosen][: size - len(chosen)]
    nodes, counts, needs = [], dict[str, int](), []
    for name in chosen:
        general = name.category in kind_of and rng.random() < GENERAL
        word = kind_of[name.category] if general else name.category
        counts[word] = counts.get(word, 0) + 1
        nodes.append(Furniture(word, counts[word]))
        offered = sorted(affordances(word) & affordances(name.category))
        needs.append({offered[int(rng.integers(len(offered)))]} if offered and rng.random() < 0.5 else set[str]())
    place = {name: index for index, name in enumerate(chosen)}
    edges = [(place[a], place[b]) for a, b in room.subgraph(chosen).edges]
    kept = rng.permutation(len(edges))[: rng.binomial(len(chosen), 0.85)]
    return graph_from_parts(nodes, [edges[i] for i in kept], needs)


def _categories(rng: np.random.Generator, sizes: NDArray[np.int64]) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
    """The words of all pieces, and the type of every room."""
    kinds = rng.integers(len(LIKELY), size=len(sizes)).astype(np.uint32)
    of_piece = np.repeat(kinds, sizes)
    categories = np.empty(len(of_piece), dtype=np.uint32)
    for place, name in enumerate(sorted(LIKELY)):
        words, weights = LIKELY[name].split()[::2], np.array(LIKELY[name].split()[1::2], dtype=float)
        inside = of_piece == place
        numbers = np.array([vocabulary().number[word] for word in words], dtype=np.uint32)
        categories[inside] = rng.choice(numbers, int(inside.sum()), p=weights / weights.sum())
    return categories, kinds


def _neighbours(
    rng: np.random.Generator, sizes: NDArray[np.int64], block: int = 4096
) -> tuple[NDArray[np.uint16], NDArray[np.int64]]:
    """Who stands near whom: the places of every piece's neighbours, and how many it has."""
    found, degrees = [], []
    for start in range(0, len(sizes), block):
        own = sizes[start : start + block]
        points = rng.random((len(own), MAX_NODES, 2)) * SPREAD * np.sqrt(own)[:, None, None]
        apart = ((points[:, :, None] - points[:, None]) ** 2).sum(axis=-1)
        there = np.arange(MAX_NODES) < own[:, None]
        joined = (apart < 1.0) & there[:, :, None] & there[:, None] & ~np.eye(MAX_NODES, dtype=bool)
        found.append(np.nonzero(joined)[2].astype(np.uint16))
        degrees.append(joined.sum(axis=2)[there])
    return np.concatenate(found), np.concatenate(degrees)
