"""How often every room has what is counted: a table of bytes, a row for each known word, class, group, kind and pair.

Words that we do not know are counted when they are asked for: each would need a row of its own.
"""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graphs.graph.packed_graphs import Ints, PackedRooms, vocabulary
from scene_graphs.graph.substitution_costs import Key

MAX_COUNT: Final = 255
"""A count stops there: it may stand for more."""
ANY_NUMBER: Final = 1 << 16
_BLOCK: Final = 4096


class Counts:
    """The counts of rooms."""

    def __init__(self, rooms: PackedRooms) -> None:
        self.rooms = rooms
        known, of_group = len(vocabulary()), vocabulary().group_of
        count_of_groups = len(vocabulary().groups)
        self.table = np.empty((len(vocabulary().counted), len(rooms)), dtype=np.uint8)
        """(len(vocabulary().counted), rooms)."""
        rare_nodes, rare_edges = [], []
        for start in range(0, len(rooms), _BLOCK):
            stop = min(start + _BLOCK, len(rooms))
            words, ends, room_of, room_of_edge = _unpacked(rooms, start, stop)
            groups = np.where(words < known, of_group[np.minimum(words, known - 1)], words - known + count_of_groups)
            pairs = np.sort(groups[ends], axis=1)
            rare = (words >= known, pairs[:, 1] >= count_of_groups)
            self._count(start, stop, words[~rare[0]], room_of[~rare[0]], pairs[~rare[1]], room_of_edge[~rare[1]])
            rare_nodes.append((words[rare[0]], room_of[rare[0]] + start))
            rare_edges.append((_coded(pairs[rare[1]], rooms.words), room_of_edge[rare[1]] + start))
        self._rare = [_sorted(rare_nodes), _sorted(rare_edges)]

    def column(self, key: Key) -> NDArray[np.int32]:
        """How often each room has one thing, or `ANY_NUMBER` where the count may stand for more. (rooms,)."""
        row = vocabulary().counted.get(key)
        counts = (self.rare(key) if row is None else self.table[row]).astype(np.int32)
        return np.where(counts == MAX_COUNT, ANY_NUMBER, counts)

    def rare(self, key: Key) -> NDArray[np.uint8]:
        """How often each room has one thing that has no row in the table. (rooms,)."""
        numbers = [self._number(name, key[0] == "edge") for name in key[1:]]
        if min(numbers) < 0:
            return np.zeros(self.table.shape[1], dtype=np.uint8)
        own = np.sort(np.array([numbers], dtype=np.int64), axis=1)
        codes, rooms = self._rare[key[0] == "edge"]
        code = _coded(own, self.rooms.words)[0] if key[0] == "edge" else own[0, 0]
        inside = slice(*np.searchsorted(codes, [code, code + 1]))
        return _clipped(np.bincount(rooms[inside], minlength=self.table.shape[1]))

    @property
    def nbytes(self) -> int:
        """Memory."""
        return self.table.nbytes + sum(array.nbytes for codes in self._rare for array in codes)

    def _number(self, name: str, of_group: bool) -> int:
        """The number of a word or, for edges, of a group: words that are not known are groups of their own; or -1."""
        groups = vocabulary().groups
        if of_group and name in groups:
            return groups.index(name)
        number = self.rooms.number_of(name)
        return number + (len(groups) - len(vocabulary())) * of_group if number >= 0 else -1

    def _count(self, start: int, stop: int, words: Ints, room_of: Ints, pairs: Ints, room_of_edge: Ints) -> None:
        """Fill the table for some rooms."""
        size, known = stop - start, vocabulary()
        of_word = np.bincount(words * size + room_of, minlength=len(known) * size).reshape(len(known), size)
        of_class = np.add.reduceat(of_word, known.class_starts)
        of_group = np.add.reduceat(of_class, np.searchsorted(known.class_starts, known.group_starts))
        of_kind = [of_word[inside].sum(axis=0) for key, inside in known.counts.items() if key[0] == "kind"]
        rows = _pair_numbers()[pairs[:, 0], pairs[:, 1]]
        of_pair = np.bincount(rows * size + room_of_edge, minlength=len(known.pairs) * size)
        of_pair = of_pair.reshape(len(known.pairs), size)
        self.table[:, start:stop] = _clipped(np.concatenate([of_word, of_class, of_group, of_kind, of_pair]))


@cache
def _pair_numbers() -> Ints:
    """The number of the pair of every two groups. (groups, groups)."""
    known = vocabulary()
    return np.array([[known.pairs.index((min(a, b), max(a, b))) for b in known.groups] for a in known.groups])


def _unpacked(rooms: PackedRooms, start: int, stop: int) -> tuple[Ints, Ints, Ints, Ints]:
    """Words of the nodes of some rooms, ends of their edges among them, and the room of each node and edge."""
    begins = rooms.node_starts[start : stop + 1] - rooms.node_starts[start]
    nodes = slice(rooms.node_starts[start], rooms.node_starts[stop])
    around = rooms.neighbour_starts[nodes.start : nodes.stop + 1]
    room_of = np.repeat(np.arange(stop - start), np.diff(begins))
    first = np.repeat(np.arange(len(room_of)), np.diff(around))
    second = begins[room_of[first]] + rooms.neighbours[around[0] : around[-1]]
    ends = np.stack([first, second], axis=1)[first < second]
    return rooms.categories[nodes].astype(np.int64), ends, room_of, room_of[ends[:, 0]]


def _coded(pairs: Ints, words: tuple[str, ...]) -> Ints:
    """One number a pair of groups."""
    codes: Ints = pairs[:, 0] * (len(vocabulary().groups) + len(words)) + pairs[:, 1]
    return codes


def _sorted(blocks: list[tuple[Ints, Ints]]) -> tuple[Ints, Ints]:
    """Codes in order, and the room of each."""
    codes = np.concatenate([np.empty(0, dtype=np.int64), *(codes for codes, _ in blocks)])
    rooms = np.concatenate([np.empty(0, dtype=np.int64), *(rooms for _, rooms in blocks)])
    order = np.argsort(codes, kind="stable")
    return codes[order], rooms[order]


def _clipped(counts: Ints) -> NDArray[np.uint8]:
    return np.minimum(counts, MAX_COUNT).astype(np.uint8)
