"""Rooms' graphs as a few flat arrays: 100,000 rooms in some fifty megabytes, in a form that compiled code reads.

Many short texts as one run of bytes: a tenth of the memory that as many Python strings take.

The furniture words as numbers, and the rows in which a room's furniture is counted.

A number below `len(vocabulary())` is a known word; higher ones are words that only one set of rooms knows, in its own
order.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise
from typing import Final, overload

import networkx as nx
import numpy as np
from numpy.typing import NDArray

from scene_graphs.furniture import (
    AFFORDANCES,
    Furniture,
    canonical,
    catalogue,
    categories_of,
    class_of,
    group_of,
    is_minor,
)
from scene_graphs.graph.furniture_graph import FurnitureGraph
from scene_graphs.graph.substitution_costs import CostTable, Key, level_between

Ints = NDArray[np.int64]


def offsets(sizes: Iterable[int] | Ints) -> Ints:
    """Where each of several runs begins, and where the last ends. (runs + 1,)."""
    array = np.fromiter(sizes, dtype=np.int64) if not isinstance(sizes, np.ndarray) else sizes
    return np.concatenate([np.zeros(1, dtype=np.int64), np.cumsum(array, dtype=np.int64)])


def places_of(starts: Ints, numbers: Ints) -> Ints:
    """The places in the runs with these numbers, run after run."""
    sizes = starts[numbers + 1] - starts[numbers]
    begins = offsets(sizes)
    places: Ints = np.repeat(starts[numbers] - begins[:-1], sizes) + np.arange(begins[-1])
    return places


@dataclass(frozen=True, eq=False)
class Texts(Sequence[str]):
    """Texts by number; `starts` are the places in the UTF-8 `letters` where each begins, and where the last ends."""

    letters: NDArray[np.uint8]
    starts: Ints

    @classmethod
    def of(cls, texts: Iterable[str]) -> Texts:
        """Pack texts."""
        encoded = [text.encode() for text in texts]
        letters = np.frombuffer(b"".join(encoded), dtype=np.uint8)
        return cls(letters, offsets(len(text) for text in encoded))

    def __len__(self) -> int:
        return len(self.starts) - 1

    @overload
    def __getitem__(self, number: int) -> str: ...
    @overload
    def __getitem__(self, number: slice) -> list[str]: ...
    def __getitem__(self, number: int | slice) -> str | list[str]:
        if isinstance(number, slice):
            start, stop, step = number.indices(len(self))
            if step != 1 or stop <= start:
                return [self[one] for one in range(start, stop, step)]
            ends = self.starts[start : stop + 1].tolist()
            letters, first = self.letters[ends[0] : ends[-1]].tobytes(), ends[0]
            return [letters[a - first : b - first].decode() for a, b in pairwise(ends)]
        place = range(len(self))[number]
        return self.letters[self.starts[place] : self.starts[place + 1]].tobytes().decode()

    def find(self, text: str) -> int | None:
        """The number of a text among texts that are in order, or None. Bytes are in the order of letters in UTF-8."""
        place = bisect_left(self, text)
        return place if place < len(self) and self[place] == text else None

    def take(self, numbers: Ints) -> Texts:
        """The texts with these numbers."""
        sizes = self.starts[numbers + 1] - self.starts[numbers]
        return Texts(self.letters[places_of(self.starts, numbers)], offsets(sizes))

    @staticmethod
    def join(several: Sequence[Texts]) -> Texts:
        """One run after the other."""
        sizes = np.concatenate([np.diff(texts.starts) for texts in several])
        return Texts(np.concatenate([texts.letters for texts in several]), offsets(sizes))

    @property
    def nbytes(self) -> int:
        """Memory."""
        return self.letters.nbytes + self.starts.nbytes


LEVELS: Final = ("same", "class", "group")
"""How near two words are, by number; `FAR` is across groups."""
FAR: Final = len(LEVELS)
EVERYTHING: Final = (1 << len(AFFORDANCES)) - 1
"""All affordances, as bits."""


class Vocabulary:
    """The furniture words we know as numbers."""

    def __init__(self) -> None:
        known = catalogue()
        names = {canonical(name) for name in (*known.group_of_class, *known.group_of_class.values())}
        self.words: Final = tuple(
            sorted({*known.class_of, *names}, key=lambda word: (group_of(word), class_of(word), word))
        )
        """Every category and generic kind, and the names of classes and groups where somebody calls a thing so, in such
        an order that classes and groups are runs of numbers."""
        self.number: Final = {word: number for number, word in enumerate(self.words)}
        classes, groups = [class_of(word) for word in self.words], [group_of(word) for word in self.words]
        self.groups: Final = tuple(dict.fromkeys(groups))
        self.class_starts: Final = np.array([classes.index(name) for name in dict.fromkeys(classes)])
        """The first word of every class."""
        self.group_starts: Final = np.array([groups.index(name) for name in self.groups])
        """The first word of every group."""
        self.group_of: Final = np.array([self.groups.index(name) for name in groups], dtype=np.int64)
        self.minor: Final = np.array([is_minor(word) for word in self.words])
        self.counts: Final[dict[Key, Ints]] = {
            **{("category", word): np.array([number]) for word, number in self.number.items()},
            **{("class", name): _places(classes, name) for name in dict.fromkeys(classes)},
            **{("group", name): _places(groups, name) for name in self.groups},
            **{
                ("kind", kind): np.array(sorted(self.number[word] for word in {*categories_of(kind), kind}))
                for kind in sorted(known.kinds)
            },
        }
        """The words that count as each category, class, group and generic kind; a kind names its categories and
        itself."""
        self.pairs: Final = tuple((a, b) for index, a in enumerate(self.groups) for b in self.groups[index:])
        """Unordered pairs of groups, in alphabetical order."""
        counted: list[Key] = [*self.counts, *(("edge", *pair) for pair in self.pairs)]
        self.counted: Final = {key: row for row, key in enumerate(counted)}
        """The row of everything known that is counted."""

    def __len__(self) -> int:
        return len(self.words)


@cache
def vocabulary() -> Vocabulary:
    """The words of the catalogue, numbered."""
    return Vocabulary()


def _places(names: Sequence[str], name: str) -> Ints:
    return np.flatnonzero(np.array(names) == name)


def numbered(names: Iterable[str]) -> tuple[tuple[str, ...], dict[str, int]]:
    """The names that are not known, in order, and the number of every word, theirs after the known ones'."""
    known = vocabulary().number
    words = tuple(sorted({name for name in names if name not in known}))
    return words, known | {word: len(known) + place for place, word in enumerate(words)}


@cache
def levels() -> NDArray[np.uint8]:
    """How near a room's known word is to a query's: a place in `LEVELS`, or `FAR`. (query's word, room's word)."""
    words = vocabulary().words
    table = np.full((len(words), len(words)), FAR, dtype=np.uint8)
    for row, word in enumerate(words):
        for column, category in enumerate(words):
            if (level := level_between(word, category)) is not None:
                table[row, column] = LEVELS.index(level)
    return table


def flags(affordances: frozenset[str]) -> int:
    """Affordances as bits; one that is none of `AFFORDANCES` has a bit that nothing offers."""
    known = sum(1 << bit for bit, name in enumerate(AFFORDANCES) if name in affordances)
    return known if affordances <= frozenset(AFFORDANCES) else known | 1 << len(AFFORDANCES)


def affordances_of(bits: int) -> frozenset[str]:
    """The affordances whose bits are set."""
    return frozenset(name for bit, name in enumerate(AFFORDANCES) if bits >> bit & 1)


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
    """The furniture words that `vocabulary` does not know, in order; their numbers follow on the known ones'."""
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
        words, numbers = numbered(names)
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
        known, words = len(vocabulary()), tuple(sorted({word for rooms in several for word in rooms.words}))
        serves = tuple(sorted({kind for rooms in several for kind in rooms.serves}))
        return PackedRooms(
            Texts.join([rooms.ids for rooms in several]),
            words,
            np.concatenate([renumbered(rooms.categories, rooms.words, words, known) for rooms in several]),
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
        known = vocabulary().number
        if word in known:
            return known[word]
        place = bisect_left(self.words, word)
        return len(known) + place if place < len(self.words) and self.words[place] == word else -1

    def word(self, number: int) -> str:
        """The word of that number."""
        known = vocabulary().words
        return known[number] if number < len(known) else self.words[number - len(known)]

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
        known = len(vocabulary())
        minor = vocabulary().minor[np.minimum(self.categories, known - 1)] & (self.categories < known)
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
