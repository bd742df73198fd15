"""Finding rooms by exact graph edit distance: as fast as it must be, with the answers of brute force and a full scan,
against networkx' own search for the same distance in the same run."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any, Final

import networkx as nx
import numpy as np

from benchmarks.figure import Figure
from benchmarks.stories import timed
from benchmarks.synthetic import queries_at_random, rooms_at_random
from scene_graphs.furniture import Furniture
from scene_graphs.graph.branch_and_bound import CodedQuery
from scene_graphs.graph.edit_distance import exact_distance
from scene_graphs.graph.furniture_graph import FurnitureGraph, needs_of
from scene_graphs.graph.packed_graphs import PackedRooms
from scene_graphs.graph.substitution_costs import CostTable
from scene_graphs.layout import Array
from scene_graphs.retrieval.layout_index import LayoutIndex
from scene_graphs.retrieval.packed_graphs_file import read_packed, write_packed

K: Final = 10
QUERIES: Final = 200
ROUNDS: Final = 3
"""Every query is asked so often, and the best of its times counts."""
LIMITS: Final = {10_000: (1.0, 10.0), 100_000: (2.0, 15.0)}
"""Milliseconds a query may take on average, and in one case of a hundred, by the number of rooms."""
SCANNED: Final = {10_000: 10, 100_000: 2}
"""Queries whose answer is compared with that of verifying every single room."""
BEST: Final = f"each query's best of {ROUNDS}, as for the mean"
PAIRS: Final = 40
PATIENCE: Final = 5.0
"""Seconds networkx gets for one room."""
COMPARED: Final = 1_000
"""Rooms in the loop that networkx is compared in."""
FORBIDDEN: Final = 100_000
"""A cost that no mapping pays."""
FIRST_ANSWER: Final = """
from scene_graphs.graph.furniture_graph import graph_from_uses
from scene_graphs.layout_library import built_in_index
built_in_index().search(graph_from_uses([("sofa", 1), ("tv stand", 1), ("chair", 1)]), 10)
"""
COSTS: Final = CostTable()


def retrieval_figures() -> list[Figure]:
    """Speed, memory and agreement of retrieval."""
    queries = queries_at_random(QUERIES, seed=2)
    figures: list[Figure] = []
    for count, (mean, rare) in LIMITS.items():
        rooms = rooms_at_random(count, seed=1)
        if count == max(LIMITS):
            loading, rooms = _loading(rooms)
            figures += loading
        index = LayoutIndex.of_packed(rooms, range(count))  # type: ignore[arg-type]
        taken = _milliseconds(index, queries)
        agreed = f"{_scanned(index, queries[: SCANNED[count]])} answers are those of a full scan"
        told = (
            f"random rooms, {len(queries)} graphs of {np.mean([len(query) for query in queries]):.1f} pieces; {agreed}"
        )
        name = f"nearest {K} of {count:,} rooms, exact"
        figures += [
            Figure(f"{name}, mean", float(taken.mean()), "ms", mean, note=told, digits=2),
            Figure(f"{name}, 99 of 100", float(np.percentile(taken, 99)), "ms", rare, note=BEST, digits=2),
        ]
    figures.append(_against_networkx(queries))
    return figures + _first_answers()


def _milliseconds(index: LayoutIndex, queries: Sequence[FurnitureGraph]) -> Array:
    """What each query takes. (queries,)."""
    index.search(queries[0], K)
    taken = np.full((ROUNDS, len(queries)), np.inf)
    for turn, place in np.ndindex(taken.shape):
        started = time.perf_counter()
        found = index.search(queries[place], K)
        taken[turn, place] = time.perf_counter() - started
        if not all(match.exact for match in found):
            raise AssertionError(f"an answer is not proven: {sorted(queries[place])}")
    best: Array = 1000 * taken.min(axis=0)
    return best


def _scanned(index: LayoutIndex, queries: Sequence[FurnitureGraph]) -> int:
    """How many answers were compared with a full scan; AssertionError if one is another."""
    for query in queries:
        hunt = index.hunt(CodedQuery.of(query, index.costs))
        costs = [hunt.search([number]).cost for number in range(len(index.rooms))]
        best = np.lexsort((np.arange(len(costs)), hunt.bounds(), np.array(costs)))[:K]
        found = index.search(query, K)
        if [(match.layout_id, match.distance) for match in found] != [(index.rooms.ids[n], costs[n]) for n in best]:
            raise AssertionError(f"a full scan finds other rooms than the search for {sorted(query)}")
    return len(queries)


def _loading(rooms: PackedRooms) -> tuple[list[Figure], PackedRooms]:
    """The time and memory of an index of rooms in a file, and the rooms as they were read."""
    with tempfile.TemporaryDirectory(prefix="sims-bench-") as folder:
        path = Path(folder) / "rooms.npz"
        write_packed(path, rooms)
        there, reading = timed(lambda: read_packed(path))
        index, building = timed(lambda: LayoutIndex.of_packed(there, range(len(there))))  # type: ignore[arg-type]
        size = path.stat().st_size / 1e6
    pieces, relations = there.node_starts[-1] / len(there), len(there.neighbours) / 2 / len(there)
    told = f"{pieces:.1f} pieces, {relations:.1f} relations a room"
    return [
        Figure(f"index of {len(there):,} rooms", index.nbytes / 1e6, "MB", 100.0, note=told),
        Figure(
            f"loading {len(there):,} rooms", reading + building, "s", 3.0, note=f"a file of {size:.1f} MB", digits=2
        ),
    ], there


def _against_networkx(queries: Sequence[FurnitureGraph]) -> Figure:
    """A search among rooms, against networkx' for some pairs of query and room, counted up to a loop over all."""
    rooms = rooms_at_random(COMPARED, seed=3)
    index = LayoutIndex.of_packed(rooms, range(COMPARED))  # type: ignore[arg-type]
    ours = float(_milliseconds(index, queries).mean())
    sample = np.random.default_rng(4)
    pairs = [(query, rooms.graph(int(sample.integers(COMPARED)))) for query in queries[:PAIRS]]
    exact = [exact_distance(query, room).cost for query, room in pairs]
    theirs = [_by_networkx(query, room) for query, room in pairs]
    if any(cost > other for cost, (other, _) in zip(exact, theirs, strict=True)):
        raise AssertionError("networkx finds a smaller distance than the exact one")
    seconds = float(np.mean([taken for _, taken in theirs])) * COMPARED
    same = sum(cost == other for cost, (other, _) in zip(exact, theirs, strict=True))
    told = (
        f"{COMPARED:,} rooms: {ours:.2f} ms to {seconds:.0f} s, from {PAIRS} pairs of which {same} are the same and "
        f"{PAIRS - same} dearer; {_brute_forced(queries)} of ours are those of brute force"
    )
    return Figure("against networkx.graph_edit_distance", 1000 * seconds / ours, "×", 1e5, "least", note=told, digits=0)


def _brute_forced(queries: Sequence[FurnitureGraph]) -> int:
    """How many distances were compared with trying every mapping; AssertionError if one is another."""
    rooms = rooms_at_random(400, seed=5)
    small = [rooms.graph(number) for number in range(len(rooms)) if len(rooms.nodes(number)) <= 6]
    pairs = list(zip([query for query in queries if len(query) <= 4], small, strict=False))
    for query, room in pairs:
        if exact_distance(query, room).cost != _by_brute_force(query, room):
            raise AssertionError(f"brute force finds another distance for {sorted(query)} in {sorted(room)}")
    return len(pairs)


def _by_brute_force(query: FurnitureGraph, room: FurnitureGraph) -> int:
    """The distance by trying every partial injection."""
    nodes = sorted(query)
    steps = {(q, r): _step(query, room, q, r) for q in nodes for r in [None, *room]}
    joined = {(a, b) for edge in room.edges for a, b in (edge, edge[::-1])}
    least = FORBIDDEN
    for images in product([None, *sorted(room)], repeat=len(nodes)):
        hit = [image for image in images if image is not None]
        if len(set(hit)) == len(hit):
            where = dict(zip(nodes, images, strict=True))
            cost = sum(steps[pair] for pair in where.items())
            cost += COSTS.lost_edge * sum((where[a], where[b]) not in joined for a, b in query.edges)
            least = min(least, cost + sum(COSTS.of(r.category).insert for r in room if r not in hit))
    return least


def _step(query: FurnitureGraph, room: FurnitureGraph, q: Furniture, r: Furniture | None) -> int:
    if r is None:
        return COSTS.of(q.category).delete
    cost = COSTS.substitution(q.category, r.category)
    return FORBIDDEN if cost is None or not needs_of(query, q) <= room.nodes[r]["offers"] else cost


def _by_networkx(query: FurnitureGraph, room: FurnitureGraph) -> tuple[float, float]:
    """The distance networkx ends with, which is not always the least, and its seconds."""

    def substitute(asked: dict[str, Any], there: dict[str, Any]) -> float:
        cost = COSTS.substitution(asked["category"], there["category"])
        return FORBIDDEN if cost is None or not asked["needs"] <= there["offers"] else cost

    started = time.perf_counter()
    cost = nx.graph_edit_distance(
        _with_categories(query),
        _with_categories(room),
        node_subst_cost=substitute,
        node_del_cost=lambda asked: COSTS.of(asked["category"]).delete,
        node_ins_cost=lambda there: COSTS.of(there["category"]).insert,
        edge_del_cost=lambda _: COSTS.lost_edge,
        edge_ins_cost=lambda _: COSTS.extra_edge,
        timeout=PATIENCE,
    )
    return float(cost), time.perf_counter() - started


def _with_categories(graph: FurnitureGraph) -> FurnitureGraph:
    """A copy whose nodes carry their category as an attribute, which is all that networkx shows to a cost."""
    copy = graph.copy()
    nx.set_node_attributes(copy, {node: node.category for node in graph}, "category")
    return copy


def _first_answers() -> list[Figure]:
    """From the start of a process to its first answer: where the search was never compiled, and where it was."""
    with tempfile.TemporaryDirectory(prefix="sims-bench-") as folder:
        environment = os.environ | {"NUMBA_CACHE_DIR": folder}
        command = [sys.executable, "-c", FIRST_ANSWER]
        cold, warm = (timed(lambda: subprocess.run(command, env=environment, check=True))[1] for _ in range(2))
    return [
        Figure("first answer, when compiled before", warm, "s", note="process, shipped rooms, search"),
        Figure("first answer, never compiled", cold, "s", note="once an installation"),
    ]
