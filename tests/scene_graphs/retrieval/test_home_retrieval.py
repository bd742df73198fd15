"""Homes of several rooms are the nearest there are: the pairs a full scan finds, never worse than a beam or greed."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import networkx as nx
import pytest
from examples import tries
from graphs_at_random import brute_force, build
from hypothesis import given
from hypothesis import strategies as st
from layers import sampled
from rooms_at_random import scattered, searches, strewn

from scene_graphs.furniture import Furniture
from scene_graphs.graph.edit_distance import exact_distance
from scene_graphs.graph.furniture_graph import FurnitureGraph
from scene_graphs.graph.merge import side_by_side
from scene_graphs.graph.substitution_costs import CostTable
from scene_graphs.layout import Layout
from scene_graphs.retrieval import home_retrieval
from scene_graphs.retrieval.home_retrieval import ANOTHER_ROOM, retrieve_home
from scene_graphs.retrieval.layout_index import LayoutIndex, NoSuitableRoom
from scene_graphs.retrieval.match_explanation import explain

Search = tuple[list[Layout], FurnitureGraph]
Ranked = tuple[int, int, int, tuple[str, ...]]
QUICK = tries(40)


def together(index: LayoutIndex, ids: tuple[str, ...]) -> FurnitureGraph:
    return side_by_side({place: index.graph(name) for place, name in enumerate(ids)})


def ranked(index: LayoutIndex, query: FurnitureGraph, ids: tuple[str, ...]) -> Ranked:
    """Where a home stands in the order."""
    match, fare = exact_distance(query, together(index, ids), index.costs), ANOTHER_ROOM * (len(ids) - 1)
    return match.cost + fare, len(ids), match.lower_bound + fare, ids


def all_homes(index: LayoutIndex, query: FurnitureGraph, most: int) -> list[Ranked]:
    ids = [layout.id for layout in index.layouts]
    return sorted(ranked(index, query, some) for n in range(1, most + 1) for some in combinations(ids, n))


def plain_beam(scan: list[Ranked], start: int, most: int, width: int) -> int:
    """The least distance of a beam that starts from the best homes of a size; of width 1 it is greedy."""
    beam = [entry for entry in scan if entry[1] == start][:width]
    best = beam[:1]
    for size in range(start + 1, most + 1):
        beam = [entry for entry in scan if entry[1] == size and any(set(home[3]) < set(entry[3]) for home in beam)][
            :width
        ]
        best += beam[:1]
    return min(best)[0]


@given(searches(), st.integers(1, 5), st.sampled_from([0, 3]))
@QUICK
def test_homes_of_up_to_two_rooms_are_those_of_a_full_scan(search: Search, k: int, extra_edge: int) -> None:
    index, query = LayoutIndex(search[0], CostTable(extra_edge=extra_edge)), search[1]
    found = retrieve_home(index, query, 2, k)
    scan = all_homes(index, query, 2)
    assert [(m.distance, len(m.layout_ids), m.lower_bound, m.layout_ids) for m in found] == scan[:k]
    assert all(match.exact for match in found)


@given(searches(fewest=2, most=4, objects=3, nodes=3))
@QUICK
def test_the_best_pair_costs_what_trying_every_mapping_says(search: Search) -> None:
    index, query = LayoutIndex(search[0]), search[1]
    ids = [layout.id for layout in index.layouts]
    alone = [brute_force(query, index.graph(name)) for name in ids]
    pairs = [brute_force(query, together(index, pair)) + ANOTHER_ROOM for pair in combinations(ids, 2)]
    assert retrieve_home(index, query, 2)[0].distance == min(alone + pairs)


@given(searches(), st.integers(1, 5))
@QUICK
def test_a_home_of_one_room_is_what_the_index_finds(search: Search, k: int) -> None:
    index, query = LayoutIndex(search[0]), search[1]
    for room_types in ((), ("bedroom",)):
        ours = retrieve_home(index, query, 1, k, room_types)
        theirs = index.search(query, k, *room_types)
        assert [(m.layout_ids, m.distance, m.lower_bound, m.exact) for m in ours] == [
            ((m.layout_id,), m.distance, m.lower_bound, m.exact) for m in theirs
        ]
        for one, other in zip(ours, theirs, strict=True):
            assert one.mapping == tuple((node, f"0/{name}", level) for node, name, level in other.mapping)
            assert (one.missing, one.extra) == (other.missing, tuple(f"0/{name}" for name in other.extra))


@given(searches(most=7, nodes=6), st.sampled_from([1, 2, 20]))
@tries(20)
def test_more_rooms_never_cost_more_and_no_beam_finds_less(search: Search, beam: int) -> None:
    index, query = LayoutIndex(search[0]), search[1]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(home_retrieval, "BEAM", beam)
        costs = [retrieve_home(index, query, most)[0].distance for most in (1, 2, 3, 4)]
    assert costs == sorted(costs, reverse=True)
    scan = all_homes(index, query, 4)
    for most in (3, 4):
        assert costs[most - 1] <= min(plain_beam(scan, 1, most, width) for width in (1, beam))


@given(searches(most=6, objects=3), st.integers(1, 4))
@tries(40)
def test_what_is_called_exact_is_the_nearest_there_is(search: Search, k: int) -> None:
    index, query = LayoutIndex(search[0]), search[1]
    scan = all_homes(index, query, 4)
    for match, (distance, *_) in zip(retrieve_home(index, query, 4, k), scan, strict=False):
        assert match.distance >= distance
        assert match.distance == distance or not match.exact


@given(searches(fewest=2), st.sampled_from([2, 3, 4]))
@QUICK
def test_a_home_names_every_piece_of_query_and_rooms_once(search: Search, most: int) -> None:
    index, query = LayoutIndex(search[0]), search[1]
    for match in retrieve_home(index, query, most, 3):
        union = together(index, match.layout_ids)
        told = explain(query, union, match)
        assert told.costs.total == match.distance
        assert told.costs.more_rooms == ANOTHER_ROOM * (len(match.layout_ids) - 1)
        assert sorted([*(node for node, _, _ in match.mapping), *match.missing]) == sorted(query)
        used = [name for _, name, _ in match.mapping]
        assert sorted([*used, *match.extra]) == sorted(str(name) for _, name in union.nodes(data="object_id"))


@given(searches(fewest=3), st.sampled_from([1, 2, 5]), st.sampled_from([1, 3, 30]), st.sampled_from([1, 40, 9999]))
@tries(40)
def test_what_was_cut_is_never_called_exact(search: Search, budget: int, limit: int, effort: int) -> None:
    index, query = LayoutIndex(search[0]), search[1]
    best = all_homes(index, query, 2)[0][0]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(home_retrieval, "MAX_PAIRED", 2)
        match = retrieve_home(index, query, 2, budget=budget, limit=limit, effort=effort)[0]
        assert retrieve_home(index, query, 4, budget=budget, limit=limit, effort=effort)
    assert match.distance == best or not match.exact
    assert match.lower_bound <= match.distance


@pytest.mark.parametrize(
    ("seed", "beam"), sampled([*((seed, 1) for seed in (28, 52, 104, 133)), (277, 2), (1265, 2)], 4)
)
def test_a_narrow_beam_is_still_as_good_as_others_and_no_single_room_improves_it(
    seed: int, beam: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    layouts, query = scattered(seed)
    index = LayoutIndex(layouts)
    scan = all_homes(index, query, 4)
    monkeypatch.setattr(home_retrieval, "BEAM", beam)
    match = retrieve_home(index, query, 4)[0]
    assert match.distance == next(entry[0] for entry in scan if entry[3] == match.layout_ids)
    for start, width in ((1, 1), (1, beam), (2, beam)):
        assert match.distance <= plain_beam(scan, start, 4, width)
    size, own = len(match.layout_ids), set(match.layout_ids)
    assert match.distance <= min(entry[0] for entry in scan if entry[1] == size and len(own - set(entry[3])) <= 1)


@pytest.mark.parametrize("seed", sampled(range(4), 4))
def test_whatever_is_cut_from_a_search_for_scattered_parts_is_told(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    layouts, query = scattered(seed)
    index = LayoutIndex(layouts)
    pairs, homes = all_homes(index, query, 2), all_homes(index, query, 4)
    cut = [
        *(retrieve_home(index, query, 2, k, budget=budget) for k in (1, 4) for budget in (1, 2, 5)),
        *(retrieve_home(index, query, 2, k, limit=limit) for k in (1, 4) for limit in (1, 5, 9, 14)),
        *(retrieve_home(index, query, 2, k, effort=effort) for k in (1, 4) for effort in (1, 50, 200)),
    ]
    for most in (2, 4):
        monkeypatch.setattr(home_retrieval, "MAX_PAIRED", most)
        cut += [retrieve_home(index, query, 2, k) for k in (1, 4)]
    for found, scan in [*((found, pairs) for found in cut), (retrieve_home(index, query, 4, 6), homes)]:
        for match, (distance, *_) in zip(found, scan, strict=False):
            assert match.distance == distance or (match.distance > distance and not match.exact)
    assert not all(found[0].exact for found in cut)


def test_the_second_best_rooms_alone_may_be_the_best_together() -> None:
    query = build(["double_bed", "wardrobe", "dining_table", "dining_chair"], {(0, 1), (2, 3)})
    rooms = [
        strewn("half", ["double_bed", "dining_table", "bookshelf"]),
        strewn("night", ["double_bed", "wardrobe"]),
        strewn("supper", ["dining_table", "dining_chair"]),
    ]
    assert retrieve_home(LayoutIndex(rooms), query, 2)[0].layout_ids == ("night", "supper")


def test_another_room_is_taken_only_if_it_saves_more_than_it_costs() -> None:
    rooms = [strewn("a", ["double_bed"]), strewn("b", ["floor_lamp"]), strewn("c", ["desk"])]
    index = LayoutIndex(rooms)
    assert retrieve_home(index, build(["bed", "lamp"], set()), 4)[0].layout_ids == ("a",)
    assert retrieve_home(index, build(["bed", "desk"], set()), 4)[0].layout_ids == ("a", "c")
    all_three = retrieve_home(index, build(["bed", "desk", "wardrobe"], set()), 4)[0]
    assert (all_three.distance, all_three.missing) == (150, (Furniture("wardrobe"),))


def test_three_rooms_are_found_where_each_has_its_part() -> None:
    parts = [["double_bed"], ["desk"], ["dining_table"], ["bookshelf"], ["floor_lamp"], ["piano"]]
    index = LayoutIndex([strewn(f"r{i}", part) for i, part in enumerate(parts)])
    query = build(["double_bed", "desk", "dining_table", "piano"], set())
    found = retrieve_home(index, query, 4)
    assert found[0].layout_ids == ("r0", "r1", "r2", "r5")
    assert found[0].distance == 3 * ANOTHER_ROOM
    assert retrieve_home(index, query, 3)[0].distance == 100 + 2 * ANOTHER_ROOM


def test_rooms_are_taken_from_the_types_that_are_named() -> None:
    rooms = [strewn("a", ["desk"], room_type="study"), strewn("b", ["double_bed"]), strewn("c", ["desk"])]
    index, query = LayoutIndex(rooms), build(["desk", "bed"], set())
    assert retrieve_home(index, query, 2)[0].layout_ids in {("a", "b"), ("b", "c")}
    assert retrieve_home(index, query, 2, room_types=["bedroom"])[0].layout_ids == ("b", "c")
    assert retrieve_home(index, query, 2, room_types=["library"])[0].layout_ids == ("a",)
    with pytest.raises(NoSuitableRoom, match="no room of type attic"):
        retrieve_home(index, query, 2, room_types=["study", "attic"])


def test_of_many_rooms_the_nearest_of_each_type_are_paired(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(home_retrieval, "MAX_PAIRED", 4)
    beds = [strewn(f"bed{i}", ["double_bed", "vase"]) for i in range(9)]
    desks = [strewn(f"desk{i}", ["desk"] * (1 + i), room_type="study") for i in range(9)]
    match = retrieve_home(LayoutIndex(beds + desks), build(["bed", "desk"], set()), 2)[0]
    assert match.layout_ids == ("bed0", "desk0")
    assert match.exact


def test_a_home_that_the_node_limit_ended_is_marked() -> None:
    query = build(["dining_chair"] * 7, {(i, j) for i in range(7) for j in range(i)})
    index = LayoutIndex([strewn(name, ["dining_chair"] * 12) for name in "ab"])
    assert not retrieve_home(index, query, 2, limit=20)[0].exact


def test_what_cannot_be_asked_for_is_named() -> None:
    index = LayoutIndex([strewn("a", ["desk"])])
    query = build(["desk"], set())
    for most in (0, 5):
        with pytest.raises(ValueError, match=f"max_rooms must be 1 to 4, got {most}"):
            retrieve_home(index, query, most)
    wrongs: tuple[dict[str, Any], ...] = ({"k": 0}, {"budget": 0}, {"limit": 0}, {"effort": -3})
    for wrong in wrongs:
        with pytest.raises(ValueError, match="k, limit, budget and effort must be at least 1"):
            retrieve_home(index, query, 2, **wrong)
    with pytest.raises(ValueError, match="no furniture"):
        retrieve_home(index, nx.Graph(), 2)
    with pytest.raises(ValueError, match="at most 52 pieces"):
        retrieve_home(index, build(["desk"] * 53, set()), 2)
    with pytest.raises(NoSuitableRoom, match="there are: none"):
        retrieve_home(LayoutIndex([]), query, 2)
    assert len(retrieve_home(index, query, 4, 9)) == 1
