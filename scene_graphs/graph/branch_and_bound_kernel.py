"""The exact search, compiled: bounds of all rooms, branch and bound in one, the nearest k. Imported late: see `search`.

A query node is decided at every level of a search: it is given a node of the room, or left out. Python's own integers
and lists are gone here; what every array holds is said once, at `Asked` and `Rooms`. Nothing is checked: whoever calls
has checked it. The interpreter's lock is released. All of it is in one module, since what was compiled is made anew
only where the very module that calls has changed.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from scene_graphs.jit import compiled

Ints = NDArray[np.int64]
Costs = NDArray[np.int32]
Flags = NDArray[np.bool_]
Bytes = NDArray[np.uint8]

UNMAPPED: Final = -1
NONE: Final = -1
"""No cost: nothing below the given one was found."""
ENDLESS: Final = 1 << 60
_ENTER, _LEFT_OUT = -1, -2
_FULL: Final = 255
_BLOCK: Final = 4096
_BUCKETS: Final = 4096


class Rooms(NamedTuple):
    """The arrays of `packed_graphs.PackedRooms`."""

    categories: NDArray[np.uint32]
    offers: Bytes
    node_starts: Ints
    neighbours: NDArray[np.uint16]
    neighbour_starts: Ints


class Asked(NamedTuple):
    """A query laid out for one set of rooms.

    Words of rooms are coded: the known ones by number, then one code for all that the query does not know, then those
    it does. A term or part of the bound has a counter: how many free nodes of the room it counts.
    """

    rare: Ints
    """The numbers, in the rooms, of words that only query and rooms know."""
    known: int
    """How many words are known."""
    level: Bytes
    """How near a word of the room is: place in `packed_graphs.LEVELS`. (nodes, codes)."""
    change: Ints
    """What mapping a node at each level changes the cost by. (nodes, levels)."""
    most_level: int
    """Levels that may stand in: all, or only the first."""
    needs: Bytes
    delete: Ints
    twin: Ints
    """For every node the last one before it that it could change places with, or -1."""
    first: Ints
    second: Ints
    """The ends of every edge, the earlier first; edges in the order of the second."""
    edge_starts: Ints
    """Where the edges begin whose second end is at a node or later. (nodes + 1,)."""
    lost: int
    saved: int
    """What losing an edge costs, and what keeping one saves."""
    coefficient: Ints
    live: Ints
    """How many terms, from the first, nodes from a position on ask for. (nodes + 1,)."""
    asked: Ints
    """How many nodes from a position on ask for a term. (nodes + 1, terms)."""
    part_starts: Ints
    """Where the parts of each term begin. (terms + 1,)."""
    part_asked: Ints
    """(nodes + 1, parts)."""
    counters: Ints
    """The counters, terms first, that a room's node of each word is counted by, or -1. (codes, 4)."""
    rows: Ints
    """The row of every counter among all counts."""
    edge_rows: Ints
    edge_asked: Ints
    """The same for pairs of groups."""


class There(NamedTuple):
    """What a query finds in some rooms, whose nodes are counted through."""

    node: Ints
    """The place of each node in the arrays of all rooms."""
    shift: Ints
    """The first node of its room."""
    code: Ints
    options: Ints
    """Which nodes may stand in for each query node, nearest level first, so that costs rise. (nodes, room's nodes)."""
    ends: Ints
    """How many do."""
    may: Flags
    """Whether a node may. (nodes, room's nodes)."""
    hopeful: Flags
    """Whether any candidates of an edge's ends are neighbours; else it is lost whatever is done. (edges,)."""


class State(NamedTuple):
    """A mapping of the first query nodes."""

    image: Ints
    """The node that each is given, or `UNMAPPED`."""
    free: Flags
    joined: Flags
    """The neighbours of each query node's image. (nodes, room's nodes)."""
    counted: Ints
    """The free nodes of every counter."""


class Nearest(NamedTuple):
    """The best of several sets of rooms, nearest first; empty places have the cost `ENDLESS`."""

    cost: Ints
    bound: Ints
    place: Ints
    capped: Flags
    images: Ints
    """For every query node the place of its image among the nodes of the set's rooms, or `UNMAPPED`. (k, nodes)."""


@compiled
def bounds_of(asked: Asked, table: Bytes, rare: Bytes, bases: Costs) -> Costs:
    """The lower bound of every room, from the counts in `table` and, for rows after those, in `rare`. (rooms,)."""
    bounds = np.empty(len(bases), dtype=np.int32)
    constant = asked.lost * len(asked.first)
    for delete in asked.delete:
        constant += delete
    saved = np.empty(_BLOCK, dtype=np.int32)
    wanted = np.empty(_BLOCK, dtype=np.uint8)  # a query has fewer than 255 nodes
    terms = len(asked.coefficient)
    for start in range(0, len(bases), _BLOCK):
        size = min(_BLOCK, len(bases) - start)
        saved[:] = 0
        for term in range(terms):
            coefficient = np.int32(asked.coefficient[term])
            most = np.uint8(asked.asked[0, term])
            row = _row(table, rare, asked.rows[term])[start : start + size]
            if asked.part_starts[term] == asked.part_starts[term + 1]:
                for room in range(size):
                    saved[room] += coefficient * (row[room] if row[room] < most else most)
                continue
            wanted[:] = most
            for part in range(asked.part_starts[term], asked.part_starts[term + 1]):
                number = np.uint8(asked.part_asked[0, part])
                own = _row(table, rare, asked.rows[terms + part])[start : start + size]
                for room in range(size):
                    wanted[room] += own[room] if own[room] < number else number
            for room in range(size):
                saved[room] += coefficient * (row[room] if row[room] < wanted[room] else wanted[room])
        for pair in range(len(asked.edge_rows)):
            coefficient = np.int32(asked.saved)
            row = _row(table, rare, asked.edge_rows[pair])[start : start + size]
            if asked.edge_asked[pair] < _FULL:
                most = np.uint8(asked.edge_asked[pair])
                for room in range(size):
                    saved[room] += coefficient * (row[room] if row[room] < most else most)
            else:
                for room in range(size):
                    # A count that stops at 255 may stand for any number.
                    saved[room] += coefficient * (asked.edge_asked[pair] if row[room] == _FULL else row[room])
        for room in range(size):
            bounds[start + room] = bases[start + room] + constant - saved[room]
    return bounds


@compiled
def _row(table: Bytes, rare: Bytes, row: int) -> Bytes:
    found: Bytes = table[row] if row < len(table) else rare[row - len(table)]
    return found


@compiled
def nodes_ahead(asked: Asked, depth: int, left_out: Ints, free: Ints) -> int:
    """At least what the nodes from `depth` on add, edges aside, by clipped counts over the room's free nodes."""
    bound = left_out[depth]
    terms = len(asked.coefficient)
    for term in range(asked.live[depth]):
        wanted = asked.asked[depth, term]
        for part in range(asked.part_starts[term], asked.part_starts[term + 1]):
            wanted += min(asked.part_asked[depth, part], free[terms + part])
        bound -= asked.coefficient[term] * min(wanted, free[term])
    return int(bound)


@compiled
def _count(asked: Asked, code: int, count: Ints, change: int) -> None:
    """A room's node of that word becomes free, or is taken."""
    for slot in range(asked.counters.shape[1]):
        if asked.counters[code, slot] >= 0:
            count[asked.counters[code, slot]] += change


@compiled
def _found_there(asked: Asked, rooms: Rooms, numbers: Ints) -> There:
    """What a query finds in some rooms side by side."""
    size = 0
    for number in numbers:
        size += rooms.node_starts[number + 1] - rooms.node_starts[number]
    pieces, filled = len(asked.delete), 0
    there = There(
        np.empty(size, dtype=np.int64),
        np.empty(size, dtype=np.int64),
        np.empty(size, dtype=np.int64),
        np.empty((pieces, size), dtype=np.int64),
        np.zeros(pieces, dtype=np.int64),
        np.zeros((pieces, size), dtype=np.bool_),
        np.zeros(len(asked.first), dtype=np.bool_),
    )
    for number in numbers:
        begin = filled
        for place in range(rooms.node_starts[number], rooms.node_starts[number + 1]):
            word = np.int64(rooms.categories[place])
            there.node[filled], there.shift[filled] = place, begin
            there.code[filled] = word if word < asked.known else asked.known
            for rare in range(len(asked.rare)):
                if asked.rare[rare] == word:
                    there.code[filled] = asked.known + 1 + rare
            filled += 1
    for piece in range(pieces):
        for level in range(asked.most_level):
            for r in range(size):
                fits = asked.level[piece, there.code[r]] == level
                if fits and asked.needs[piece] & ~rooms.offers[there.node[r]] == 0:
                    there.options[piece, there.ends[piece]] = r
                    there.ends[piece] += 1
                    there.may[piece, r] = True
    for edge in range(len(asked.first)):
        a, b = asked.first[edge], asked.second[edge]
        for choice in range(there.ends[a]):
            r = there.options[a, choice]
            for at in range(rooms.neighbour_starts[there.node[r]], rooms.neighbour_starts[there.node[r] + 1]):
                if there.may[b, rooms.neighbours[at] + there.shift[r]]:
                    there.hopeful[edge] = True
                    break
            if there.hopeful[edge]:
                break
    return there


@compiled
def _take(asked: Asked, rooms: Rooms, there: There, state: State, depth: int, r: int) -> None:
    """Give the query node at this depth a node of the room."""
    state.image[depth] = r
    state.free[r] = False
    _count(asked, there.code[r], state.counted, -1)
    for at in range(rooms.neighbour_starts[there.node[r]], rooms.neighbour_starts[there.node[r] + 1]):
        state.joined[depth, rooms.neighbours[at] + there.shift[r]] = True


@compiled
def _give_back(asked: Asked, rooms: Rooms, there: There, state: State, depth: int) -> None:
    """Undo that."""
    r = state.image[depth]
    state.image[depth] = UNMAPPED
    state.free[r] = True
    _count(asked, there.code[r], state.counted, 1)
    for at in range(rooms.neighbour_starts[there.node[r]], rooms.neighbour_starts[there.node[r] + 1]):
        state.joined[depth, rooms.neighbours[at] + there.shift[r]] = False


@compiled
def _edges_ahead(asked: Asked, rooms: Rooms, there: There, state: State, depth: int) -> tuple[int, int]:
    """At most how many edges of the node at this depth to earlier ones can be kept, and how many of later nodes."""
    own, later = 0, 0
    for edge in range(asked.edge_starts[depth], len(asked.first)):
        a, b = asked.first[edge], asked.second[edge]
        possible = a >= depth and there.hopeful[edge]
        if a < depth and state.image[a] != UNMAPPED:
            r = state.image[a]
            for at in range(rooms.neighbour_starts[there.node[r]], rooms.neighbour_starts[there.node[r] + 1]):
                other = rooms.neighbours[at] + there.shift[r]
                if state.free[other] and there.may[b, other]:
                    possible = True
                    break
        if possible and b == depth:
            own += 1
        elif possible:
            later += 1
    return own, later


@compiled
def search(
    asked: Asked, rooms: Rooms, numbers: Ints, base: int, upper: int, limit: int, images: Ints
) -> tuple[int, int, bool]:
    """The cheapest mapping of a query into some rooms side by side that costs less than `upper`, into `images`.

    Returns its cost, or `NONE` where there is none, the search nodes expanded, and whether their limit ended it: it is
    then the best so far, or where there was none whatever mapping the search came to next.
    """
    pieces, there = len(asked.delete), _found_there(asked, rooms, numbers)
    state = State(
        np.full(pieces, UNMAPPED, dtype=np.int64),
        np.ones(len(there.node), dtype=np.bool_),
        np.zeros((pieces, len(there.node)), dtype=np.bool_),
        np.zeros(len(asked.rows), dtype=np.int64),
    )
    for code in there.code:
        _count(asked, code, state.counted, 1)
    left_out = np.zeros(pieces + 1, dtype=np.int64)
    for piece in range(pieces - 1, -1, -1):
        left_out[piece] = left_out[piece + 1] + asked.delete[piece]
    # At every depth: the cost so far, at least what later nodes add, at most what edges to earlier ones save, and the
    # place among its options that is next.
    cost = np.zeros(pieces + 1, dtype=np.int64)
    ahead = np.zeros(pieces + 1, dtype=np.int64)
    most = np.zeros(pieces + 1, dtype=np.int64)
    option = np.full(pieces + 1, _ENTER, dtype=np.int64)
    cost[0] = base + asked.lost * len(asked.first)
    best, expanded, depth, capped = NONE, 0, 0, False
    while depth >= 0:
        if option[depth] == _ENTER:
            if expanded >= limit:
                capped = True
                if best != NONE:
                    break
                upper = ENDLESS  # Go on to the next whole mapping, whatever it costs.
            expanded += 1
            if depth == pieces:
                if cost[depth] < upper:
                    best = upper = cost[depth]
                    for piece in range(pieces):
                        images[piece] = state.image[piece]
                depth -= 1
                continue
            own, later = _edges_ahead(asked, rooms, there, state, depth)
            kept = own + later
            if cost[depth] + nodes_ahead(asked, depth, left_out, state.counted) - asked.saved * kept >= upper:
                depth -= 1
                continue
            ahead[depth] = nodes_ahead(asked, depth + 1, left_out, state.counted) - asked.saved * later
            most[depth] = asked.saved * own
            option[depth] = 0
            if asked.twin[depth] >= 0 and state.image[asked.twin[depth]] == UNMAPPED:
                option[depth] = there.ends[depth]
        elif state.image[depth] != UNMAPPED:
            _give_back(asked, rooms, there, state, depth)
        if option[depth] == _LEFT_OUT:
            depth -= 1
            continue
        # Twins take nodes in rising order: anything else is the same again.
        above = state.image[asked.twin[depth]] if asked.twin[depth] >= 0 else -1
        at_option = option[depth]
        while at_option < there.ends[depth]:
            r = there.options[depth, at_option]
            change = asked.change[depth, asked.level[depth, there.code[r]]]
            if cost[depth] + change - most[depth] + ahead[depth] >= upper:
                at_option = there.ends[depth]
                break
            at_option += 1
            if r <= above or not state.free[r]:
                continue
            kept = 0
            for edge in range(asked.edge_starts[depth], asked.edge_starts[depth + 1]):
                if state.joined[asked.first[edge], r]:
                    kept += 1
            cost[depth + 1] = cost[depth] + change - asked.saved * kept
            if cost[depth + 1] + ahead[depth] < upper:
                _take(asked, rooms, there, state, depth, r)
                break
        option[depth] = at_option
        if state.image[depth] == UNMAPPED:
            option[depth] = _LEFT_OUT
            cost[depth + 1] = cost[depth] + asked.delete[depth]
            if cost[depth + 1] + ahead[depth] >= upper:
                depth -= 1
                continue
        depth += 1
        option[depth] = _ENTER
    return best, expanded, capped


@compiled
def nearest(
    asked: Asked,
    rooms: Rooms,
    bases: Costs,
    bounds: Costs,
    among: Bytes,
    k: int,
    first_stage: int,
    limit: int,
    effort: int,
) -> tuple[Nearest, int]:
    """The k best by (cost, bound, number) of the rooms that are `among` those asked for.

    They are verified in the order of bounds. Stopping at a bound equal to the worst kept cost is exact because ties are
    broken by (bound, number): a later room of equal cost loses. `limit` is that of search nodes for one room and
    `effort` for all. Also returns the least bound of a room whose search was ended by one, or `ENDLESS`.
    """
    best = Nearest(
        np.full(k, ENDLESS, dtype=np.int64),
        np.full(k, ENDLESS, dtype=np.int64),
        np.full(k, -1, dtype=np.int64),
        np.zeros(k, dtype=np.bool_),
        np.full((k, len(asked.delete)), UNMAPPED, dtype=np.int64),
    )
    images = np.empty(len(asked.delete), dtype=np.int64)
    one = np.empty(1, dtype=np.int64)
    doubtful = ENDLESS
    border = _border(asked, bounds, among, first_stage)
    waiting = np.empty(len(bounds), dtype=np.int64)  # a heap of bound and number in one
    for stage in range(2):
        if stage == 1 and best.cost[k - 1] <= border + 1:
            break
        count = 0
        for number in range(len(bounds)):
            bound = np.int64(bounds[number])
            if bound < best.cost[k - 1] and (bound <= border) == (stage == 0) and among[number]:
                waiting[count] = bound * len(bounds) + number
                count += 1
        for root in range(count // 2 - 1, -1, -1):
            _sift(waiting, root, count)
        while count > 0:
            bound, number = waiting[0] // len(bounds), waiting[0] % len(bounds)
            if bound >= best.cost[k - 1]:
                break
            count -= 1
            waiting[0] = waiting[count]
            _sift(waiting, 0, count)
            one[0] = number
            # Of the kind that `search` is given elsewhere, lest it be compiled twice.
            base, allowed = bases[number] + 0, max(min(limit, effort), 1)
            cost, expanded, capped = search(asked, rooms, one, base, best.cost[k - 1], allowed, images)
            effort -= expanded
            if capped:
                doubtful = min(doubtful, bound)
            if cost != NONE:
                _keep(best, cost, bound, number, capped, images)
    return best, doubtful


@compiled
def _sift(heap: Ints, root: int, count: int) -> None:
    """Let a value sink to its place among the first `count` of a heap, whose least value is at the root."""
    value = heap[root]
    while 2 * root + 1 < count:
        child = 2 * root + 1
        if child + 1 < count and heap[child + 1] < heap[child]:
            child += 1
        if value <= heap[child]:
            break
        heap[root] = heap[child]
        root = child
    heap[root] = value


@compiled
def _border(asked: Asked, bounds: Costs, among: Bytes, first_stage: int) -> int:
    """A bound that at least `first_stage` of the chosen rooms do not pass, and few more do."""
    most = asked.lost * len(asked.first)  # what a room without anything costs
    for delete in asked.delete:
        most += delete
    width = most // _BUCKETS + 1
    counts = np.zeros(_BUCKETS, dtype=np.int64)
    for number in range(len(bounds)):
        bucket = bounds[number] // width
        if among[number] and bucket < _BUCKETS:
            counts[bucket] += 1
    passed = 0
    for bucket in range(_BUCKETS):
        passed += counts[bucket]
        if passed >= first_stage:
            return (bucket + 1) * width - 1
    return ENDLESS


@compiled
def _keep(best: Nearest, cost: int, bound: int, place: int, capped: bool, images: Ints) -> None:
    """Put a room in its place among the best; the last falls out."""
    at = len(best.cost) - 1
    if not _before(cost, bound, place, best, at):
        return
    while at > 0 and _before(cost, bound, place, best, at - 1):
        best.cost[at], best.bound[at], best.place[at] = best.cost[at - 1], best.bound[at - 1], best.place[at - 1]
        best.capped[at] = best.capped[at - 1]
        for piece in range(len(images)):
            best.images[at, piece] = best.images[at - 1, piece]
        at -= 1
    best.cost[at], best.bound[at], best.place[at], best.capped[at] = cost, bound, place, capped
    for piece in range(len(images)):
        best.images[at, piece] = images[piece]


@compiled
def _before(cost: int, bound: int, place: int, best: Nearest, at: int) -> bool:
    """Whether a room comes before the one at that rank."""
    if cost != best.cost[at]:
        return bool(cost < best.cost[at])
    if bound != best.bound[at]:
        return bool(bound < best.bound[at])
    return bool(place < best.place[at])
