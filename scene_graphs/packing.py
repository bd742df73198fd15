"""Rooms' graphs as a few flat arrays: 100,000 rooms in some fifty megabytes, in a form that compiled code reads."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import networkx as nx
import numpy as np
from numpy.typing import NDArray

from scene_graphs.costs import CostTable
from scene_graphs.furniture import Furniture, canonical, is_minor
from scene_graphs.graph import FurnitureGraph
from scene_graphs.texts import Ints, Texts, offsets, places_of
from scene_graphs.vocabulary import EVERYTHING, KNOWN, MINOR, NUMBER, affordances_of, flags

MAX_OBJECTS_IN_ROOM: Final = 65_535
"""Neighbours are kept in two bytes."""
DEAREST_ROOM: Final = 1 << 30
"""Distances are kept in four bytes."""


@dataclass(frozen=True, eq=False)
class PackedRooms:
    """Rooms by number. The nodes of a room, and the neighbours of a node, are a run of the arrays after one another.

    `node_starts` are the places where each room's nodes begin, `neighbour_starts` where each node's neighbours do.
    """

    ids: Texts
    words: tuple[str, ...]
    """The furniture words that are not `KNOWN`, in order; their numbers follow on the known ones'."""
    categories: NDArray[np.uint32]
    """Of every node the number of its word. (nodes,)."""
    offers: NDArray[np.uint8]
    """Of every node its affordances as bits. (nodes,)."""
    object_ids: Texts
    node_starts: Ints
    neighbours: NDArray[np.uint16]
    """Places in the room, rising. (2 x edges,)."""
    neighbour_starts: Ints
    serves: tuple[str, ...]
    """Names of room types, in order."""
    types: NDArray[np.uint32]
    """What each room can serve as: its own type first, then its tags. (types of all rooms,)."""
    type_starts: Ints

    def __post_init__(self) -> None:
        # Compiled code is made anew, for seconds, for arrays of another kind; let there be one.
        kinds = {"categories": np.uint32, "offers": np.uint8, "neighbours": np.uint16, "types": np.uint32}
        kinds |= {"node_starts": np.int64, "neighbour_starts": np.int64, "type_starts": np.int64}
        for name, kind in kinds.items():
            object.__setattr__(self, name, np.require(getattr(self, name), kind, ["C", "W", "A"]))

    def __len__(self) -> int:
        return len(self.node_starts) - 1

    @classmethod
    def of(
        cls,
        graphs: Sequence[FurnitureGraph],
        ids: Sequence[str] | None = None,
        serves: Sequence[Sequence[str]] | None = None,
    ) -> PackedRooms:
        """Pack graphs; a room's nodes are put in order, so that the order they were added in does not matter.

        Without `ids` rooms are called by their numbers. ValueError if a graph has too many nodes or one is joined with
        itself.
        """
        rooms = [sorted(graph) for graph in graphs]
        for graph, nodes in zip(graphs, rooms, strict=True):
            _check(graph, nodes)
        names = [canonical(node[0]) for nodes in rooms for node in nodes]
        words = tuple(sorted({name for name in names if name not in NUMBER}))
        numbers = NUMBER | {word: len(KNOWN) + place for place, word in enumerate(words)}
        data = [graph.nodes[node] for graph, nodes in zip(graphs, rooms, strict=True) for node in nodes]
        around = [_around(graph, nodes) for graph, nodes in zip(graphs, rooms, strict=True)]
        types = [list(dict.fromkeys(one)) for one in serves or [()] * len(graphs)]
        kinds = tuple(sorted({kind for one in types for kind in one}))
        place_of = {kind: place for place, kind in enumerate(kinds)}
        return cls(
            Texts.of(ids if ids is not None else map(str, range(len(graphs)))),
            words,
            np.array([numbers[name] for name in names], dtype=np.uint32),
            np.array([flags(frozenset(node.get("offers", ()))) & EVERYTHING for node in data], dtype=np.uint8),
            Texts.of(str(node.get("object_id") or "") for node in data),
            offsets(len(nodes) for nodes in rooms),
            np.array([place for one in around for places in one for place in places], dtype=np.uint16),
            offsets(len(places) for one in around for places in one),
            kinds,
            np.array([place_of[kind] for one in types for kind in one], dtype=np.uint32),
            offsets(len(one) for one in types),
        )

    def take(self, numbers: Ints) -> PackedRooms:
        """The rooms with these numbers, in that order."""
        nodes = places_of(self.node_starts, numbers)
        kinds = places_of(self.type_starts, numbers)
        sizes, counts = np.diff(self.node_starts)[numbers], np.diff(self.type_starts)[numbers]
        return PackedRooms(
            self.ids.take(numbers),
            self.words,
            self.categories[nodes],
            self.offers[nodes],
            self.object_ids.take(nodes),
            offsets(sizes),
            self.neighbours[places_of(self.neighbour_starts, nodes)],
            offsets(np.diff(self.neighbour_starts)[nodes]),
            self.serves,
            self.types[kinds],
            offsets(counts),
        )

    @staticmethod
    def join(several: Sequence[PackedRooms]) -> PackedRooms:
        """One set of rooms after the other."""
        words = tuple(sorted({word for rooms in several for word in rooms.words}))
        serves = tuple(sorted({kind for rooms in several for kind in rooms.serves}))
        return PackedRooms(
            Texts.join([rooms.ids for rooms in several]),
            words,
            np.concatenate([renumbered(rooms.categories, rooms.words, words, len(KNOWN)) for rooms in several]),
            np.concatenate([rooms.offers for rooms in several]),
            Texts.join([rooms.object_ids for rooms in several]),
            offsets(np.concatenate([np.diff(rooms.node_starts) for rooms in several])),
            np.concatenate([rooms.neighbours for rooms in several]),
            offsets(np.concatenate([np.diff(rooms.neighbour_starts) for rooms in several])),
            serves,
            np.concatenate([renumbered(rooms.types, rooms.serves, serves) for rooms in several]),
            offsets(np.concatenate([np.diff(rooms.type_starts) for rooms in several])),
        )

    def number_of(self, word: str) -> int:
        """The number of a word, or -1 where no room can have it."""
        if word in NUMBER:
            return NUMBER[word]
        place = bisect_left(self.words, word)
        return len(KNOWN) + place if place < len(self.words) and self.words[place] == word else -1

    def word(self, number: int) -> str:
        """The word of that number."""
        return KNOWN[number] if number < len(KNOWN) else self.words[number - len(KNOWN)]

    def nodes(self, number: int) -> range:
        """The places of a room's nodes."""
        return range(int(self.node_starts[number]), int(self.node_starts[number + 1]))

    def graph(self, number: int) -> FurnitureGraph:
        """The graph of a room, its instances counted from 1 in the order of its nodes."""
        graph: FurnitureGraph = nx.Graph()
        counts: dict[str, int] = {}
        nodes: list[Furniture] = []
        for place in self.nodes(number):
            category = self.word(int(self.categories[place]))
            counts[category] = counts.get(category, 0) + 1
            nodes.append(Furniture(category, counts[category]))
            graph.add_node(
                nodes[-1],
                needs=frozenset(),
                offers=affordances_of(int(self.offers[place])),
                object_id=self.object_ids[place],
                minor=is_minor(category),
            )
        for first, place in enumerate(self.nodes(number)):
            around = self.neighbours[self.neighbour_starts[place] : self.neighbour_starts[place + 1]]
            graph.add_edges_from((nodes[first], nodes[int(second)]) for second in around if first < second)
        return graph

    def of_type(self, room_type: str) -> Ints:
        """Numbers of the rooms that can serve as a type, rising."""
        if room_type not in self.serves:
            return np.empty(0, dtype=np.int64)
        places = np.flatnonzero(self.types == self.serves.index(room_type))
        rooms: Ints = np.unique(np.searchsorted(self.type_starts, places, side="right") - 1)
        return rooms

    def room_type(self, number: int) -> str:
        """The type of a room that has one."""
        return self.serves[int(self.types[self.type_starts[number]])]

    @cached_property
    def room_types(self) -> tuple[str, ...]:
        """The types that rooms are of, in order."""
        own = self.types[self.type_starts[:-1][np.diff(self.type_starts) > 0]]
        return tuple(self.serves[place] for place in np.unique(own))

    def bases(self, costs: CostTable) -> NDArray[np.int32]:
        """The cost of every room if nothing of it is used. (rooms,). ValueError if one is beyond all bounds."""
        minor = MINOR[np.minimum(self.categories, len(KNOWN) - 1)] & (self.categories < len(KNOWN))
        cost = offsets(np.where(minor, costs.minor.insert, costs.key.insert))
        edges = self.neighbour_starts[self.node_starts[1:]] - self.neighbour_starts[self.node_starts[:-1]]
        bases = cost[self.node_starts[1:]] - cost[self.node_starts[:-1]] + costs.extra_edge * (edges // 2)
        if bases.max(initial=0) > DEAREST_ROOM:
            raise ValueError(f"a room costs {bases.max()} where nothing of it is used; lower insert or extra_edge")
        return bases.astype(np.int32)

    @property
    def nbytes(self) -> int:
        """Memory of the arrays."""
        texts = self.ids.nbytes + self.object_ids.nbytes
        arrays = (self.categories, self.offers, self.node_starts, self.neighbours, self.neighbour_starts, self.types)
        return texts + self.type_starts.nbytes + sum(array.nbytes for array in arrays)


def renumbered(
    places: NDArray[np.uint32], old: Sequence[str], new: Sequence[str], first: int = 0
) -> NDArray[np.uint32]:
    """Numbers into `old` as numbers into `new`, which has all of it; those below `first` stay."""
    place_of = {name: place for place, name in enumerate(new, start=first)}
    table = np.array([*range(first), *(place_of[name] for name in old)], dtype=np.uint32)
    return table[places]


def _check(graph: FurnitureGraph, nodes: Sequence[Furniture]) -> None:
    if len(nodes) > MAX_OBJECTS_IN_ROOM:
        raise ValueError(f"a room may have at most {MAX_OBJECTS_IN_ROOM} nodes, got {len(nodes)}; split it")
    refuse_loops(graph)


def refuse_loops(graph: FurnitureGraph) -> None:
    """ValueError if a node is joined with itself."""
    for node in nx.nodes_with_selfloops(graph):
        raise ValueError(f"{node[0]} {node[1]} is joined with itself; leave that edge out")


def _around(graph: FurnitureGraph, nodes: Sequence[Furniture]) -> list[list[int]]:
    """The places of each node's neighbours, rising."""
    place_of = {node: place for place, node in enumerate(nodes)}
    return [sorted(place_of[other] for other in graph.adj[node]) for node in nodes]
