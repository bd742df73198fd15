"""The distance is what brute force says, obeys its axioms, and its bound never exceeds it."""

from __future__ import annotations

from collections import Counter
from itertools import combinations, product

import networkx as nx
import numpy as np
import pytest
from examples import tries
from for_each import for_each
from graphs_at_random import CATEGORIES, GENERIC, brute_force, build, graphs
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from scene_graphs.furniture import Furniture, affordances, class_of, group_of, is_minor
from scene_graphs.graph.edit_distance import exact_distance, lower_bound
from scene_graphs.graph.furniture_graph import FurnitureGraph
from scene_graphs.graph.substitution_costs import CostTable, GroupCosts

QUICK = tries(60)
FEW = tries(40)
WORDS = CATEGORIES + GENERIC
COSTS = CostTable()


def with_offers(graph: FurnitureGraph, offers: frozenset[str] = frozenset({"sit", "lie", "touch"})) -> FurnitureGraph:
    copy = graph.copy()
    nx.set_node_attributes(copy, dict.fromkeys(copy, offers), "offers")
    return copy


def distance(query: FurnitureGraph, room: FurnitureGraph) -> int:
    match = exact_distance(query, with_offers(room))
    assert match.exact
    return match.cost


def extras(query: FurnitureGraph, room: FurnitureGraph) -> int:
    return sum(not is_minor(node.category) for node in room) - sum(not is_minor(node.category) for node in query)


def renamed(graph: FurnitureGraph, seed: int) -> FurnitureGraph:
    """The same graph with shuffled instance numbers."""
    numbers = np.random.default_rng(seed).permutation(np.arange(1, 100))
    return nx.relabel_nodes(graph, {node: Furniture(node.category, int(numbers[i])) for i, node in enumerate(graph)})


@given(graphs(4, WORDS), graphs(5))
@QUICK
def test_it_equals_brute_force(query: FurnitureGraph, room: FurnitureGraph) -> None:
    assert distance(query, room) == brute_force(query, room)


def test_it_equals_brute_force_among_pieces_all_alike() -> None:
    """Where only relations tell one from another, the search goes back the most."""
    rng = np.random.default_rng(0)
    for _ in range(24):
        query, room = (
            build(["dining_chair"] * size, {pair for pair in combinations(range(size), 2) if rng.random() < 0.5})
            for size in (4, 5)
        )
        assert distance(query, room) == brute_force(query, room)


@given(graphs(4, WORDS, "needs"), graphs(5, CATEGORIES, "offers"))
@QUICK
def test_it_equals_brute_force_where_affordances_are_needed(query: FurnitureGraph, room: FurnitureGraph) -> None:
    match = exact_distance(query, room)
    assert match.cost == brute_force(query, room)
    assert match.lower_bound <= match.cost


@given(graphs(4, WORDS), graphs(5))
@FEW
def test_strictly_it_equals_brute_force_without_substitutions(query: FurnitureGraph, room: FurnitureGraph) -> None:
    match = exact_distance(query, with_offers(room), strict=True)
    assert match.cost == brute_force(query, room, strict=True)
    assert match.lower_bound <= match.cost
    assert {pair.level for pair in match.pairs} <= {"same"}


@given(graphs(7, WORDS), graphs(9))
@QUICK
def test_the_mapping_costs_what_is_claimed(query: FurnitureGraph, room: FurnitureGraph) -> None:
    match = exact_distance(query, with_offers(room))
    images = {pair.query: pair.room for pair in match.pairs}
    assert len(set(images.values())) == len(images)
    assert set(images) | set(match.missing) == set(query)
    assert set(images.values()) | set(match.extra) == set(room)
    cost = sum(COSTS.of(node.category).delete for node in match.missing)
    cost += sum(COSTS.of(node.category).insert for node in match.extra)
    cost += sum(COSTS.substitution(pair.query.category, pair.room.category) or 0 for pair in match.pairs)
    cost += 20 * sum(
        a not in images or b not in images or not room.has_edge(images[a], images[b]) for a, b in query.edges
    )
    assert match.cost == cost


@given(graphs(8, WORDS))
@QUICK
def test_a_graph_is_at_no_distance_from_itself(graph: FurnitureGraph) -> None:
    assert distance(graph, graph) == 0


@given(graphs(9), st.data())
@QUICK
def test_a_subgraph_costs_only_the_extra_furniture(room: FurnitureGraph, data: st.DataObject) -> None:
    kept = [node for node in room if data.draw(st.booleans())]
    query: FurnitureGraph = room.subgraph(kept).copy()
    query.remove_edges_from([edge for edge in list(query.edges) if data.draw(st.booleans())])
    assert distance(query, room) == extras(query, room)


@given(graphs(6, WORDS), graphs(8), st.integers(0, 999))
@QUICK
def test_instance_numbers_do_not_matter(query: FurnitureGraph, room: FurnitureGraph, seed: int) -> None:
    assert distance(renamed(query, seed), renamed(room, seed + 1)) == distance(query, room)


@given(graphs(7, WORDS), graphs(9))
@QUICK
def test_the_bound_lies_between_zero_and_the_distance(query: FurnitureGraph, room: FurnitureGraph) -> None:
    bound = lower_bound(query, room)
    assert 0 <= bound <= distance(query, room)
    assert exact_distance(query, with_offers(room)).lower_bound == bound


@given(graphs(7, CATEGORIES), graphs(9))
@QUICK
def test_the_bound_is_a_sum_of_clipped_counts(query: FurnitureGraph, room: FurnitureGraph) -> None:
    bound = sum(COSTS.of(node.category).delete for node in query) + 20 * query.number_of_edges()
    bound += sum(COSTS.of(node.category).insert for node in room)
    for of, upper, lower in (
        (str, "sub_class", None),
        (class_of, "sub_group", "sub_class"),
        (group_of, None, "sub_group"),
    ):
        asked, there = (Counter(of(node.category) for node in graph) for graph in (query, room))
        for name, number in asked.items():
            costs = COSTS.of(next(node.category for node in query if of(node.category) == name))
            most = costs.delete + costs.insert if upper is None else getattr(costs, upper)
            bound -= (most - (getattr(costs, lower) if lower else 0)) * min(number, there[name])
    asked_pairs, there_pairs = (
        Counter(tuple(sorted((group_of(a.category), group_of(b.category)))) for a, b in graph.edges)
        for graph in (query, room)
    )
    bound -= 20 * sum(min(number, there_pairs[pair]) for pair, number in asked_pairs.items())
    assert lower_bound(query, room) == bound


@given(graphs(4, WORDS), graphs(5), st.integers(0, 40), st.integers(0, 9), st.integers(0, 9))
@QUICK
def test_with_other_costs_it_is_the_least_sum_too(
    query: FurnitureGraph, room: FurnitureGraph, sub_class: int, more: int, extra_edge: int
) -> None:
    """Where a relation of the room that is not asked for costs something, as in the definition."""
    costs = CostTable(GroupCosts(40, 3, sub_class, sub_class + more % 4), lost_edge=11, extra_edge=extra_edge)
    match = exact_distance(query, with_offers(room), costs)
    assert match.lower_bound <= match.cost == by_hand(query, room, costs)


def by_hand(query: FurnitureGraph, room: FurnitureGraph, costs: CostTable) -> int:
    """The distance by trying every partial injection, for any costs."""
    least = None
    for images in product([None, *room], repeat=len(query)):
        hit = [image for image in images if image is not None]
        where = dict(zip(query, images, strict=True))
        if len(set(hit)) < len(hit):
            continue
        steps = [
            costs.of(q.category).delete if r is None else costs.substitution(q.category, r.category)
            for q, r in where.items()
        ]
        if None in steps:
            continue
        ends = [(where[a], where[b]) for a, b in query.edges]
        kept = sum(a is not None and b is not None and room.has_edge(a, b) for a, b in ends)
        cost = sum(step for step in steps if step is not None)
        cost += sum(costs.of(r.category).insert for r in room if r not in hit)
        cost += costs.lost_edge * (query.number_of_edges() - kept) + costs.extra_edge * (room.number_of_edges() - kept)
        least = cost if least is None else min(least, cost)
    assert least is not None
    return least


@given(graphs(7, WORDS), graphs(9))
@QUICK
def test_without_edges_the_bound_is_the_distance_and_the_best_assignment(
    query: FurnitureGraph, room: FurnitureGraph
) -> None:
    query, room = nx.create_empty_copy(query), nx.create_empty_copy(room)
    assert lower_bound(query, room) == distance(query, room) == best_assignment(query, room)


@given(graphs(6, ("chair", "dining_chair", "armchair", "sofa")), graphs(8, CATEGORIES[:5]))
@QUICK
def test_a_kind_beside_categories_of_its_own_is_bounded_exactly(query: FurnitureGraph, room: FurnitureGraph) -> None:
    query, room = nx.create_empty_copy(query), nx.create_empty_copy(room)
    for strict in (False, True):
        match = exact_distance(query, with_offers(room), strict=strict)
        assert match.lower_bound == match.cost


def best_assignment(query: FurnitureGraph, room: FurnitureGraph) -> int:
    """The node part of the distance by scipy's assignment: a square of substitutions, deletions and insertions."""
    rows, columns = list(query), list(room)
    table = np.full((len(rows) + len(columns), len(columns) + len(rows)), 10_000)
    table[len(rows) :, len(columns) :] = 0
    for i, q in enumerate(rows):
        table[i, len(columns) + i] = COSTS.of(q.category).delete
        for j, r in enumerate(columns):
            cost = COSTS.substitution(q.category, r.category)
            table[i, j] = 10_000 if cost is None else cost
    for j, r in enumerate(columns):
        table[len(rows) + j, j] = COSTS.of(r.category).insert
    return int(table[linear_sum_assignment(table)].sum())


@given(graphs(5, WORDS), graphs(7), st.data())
@QUICK
def test_a_relation_more_in_the_room_never_costs(
    query: FurnitureGraph, room: FurnitureGraph, data: st.DataObject
) -> None:
    absent = list(nx.non_edges(room))
    assume(absent)
    more = room.copy()
    more.add_edge(*data.draw(st.sampled_from(absent)))
    assert distance(query, more) <= distance(query, room)


@given(graphs(5, WORDS), graphs(7), st.sampled_from(CATEGORIES), st.data())
@QUICK
def test_a_piece_more_in_the_room_costs_at_most_its_insertion(
    query: FurnitureGraph, room: FurnitureGraph, category: str, data: st.DataObject
) -> None:
    more = room.copy()
    more.add_edges_from((Furniture(category, 99), node) for node in room if data.draw(st.booleans()))
    more.add_node(Furniture(category, 99))
    assert distance(query, more) <= distance(query, room) + COSTS.of(category).insert


@given(graphs(6, WORDS), graphs(7), st.data())
@QUICK
def test_asking_for_less_costs_less(query: FurnitureGraph, room: FurnitureGraph, data: st.DataObject) -> None:
    assume(len(query))
    whole = distance(query, room)
    if query.number_of_edges():
        fewer = query.copy()
        fewer.remove_edge(*data.draw(st.sampled_from(list(query.edges))))
        assert 0 <= whole - distance(fewer, room) <= COSTS.lost_edge
    smaller = query.copy()
    smaller.remove_node(data.draw(st.sampled_from(list(query))))
    assert distance(smaller, room) <= whole + COSTS.key.insert


@given(graphs(4, WORDS), graphs(5), graphs(5))
@QUICK
def test_the_triangle_inequality_holds(a: FurnitureGraph, b: FurnitureGraph, c: FurnitureGraph) -> None:
    assert distance(a, c) <= distance(a, b) + distance(b, c)


@given(graphs(4), graphs(5), graphs(4), graphs(5))
@FEW
def test_two_queries_in_two_rooms_cost_no_more_together(
    a: FurnitureGraph, room_a: FurnitureGraph, b: FurnitureGraph, room_b: FurnitureGraph
) -> None:
    assert distance(together(a, b), together(room_a, room_b)) <= distance(a, room_a) + distance(b, room_b)


def together(first: FurnitureGraph, second: FurnitureGraph) -> FurnitureGraph:
    moved = nx.relabel_nodes(second, {node: Furniture(node.category, node.instance + 50) for node in second})
    union: FurnitureGraph = nx.union(first, moved)
    return union


@given(graphs(5), graphs(8), st.integers(0, 60))
@FEW
def test_a_room_with_everything_beats_any_room_that_lacks_a_key_group(
    query: FurnitureGraph, room: FurnitureGraph, more: int
) -> None:
    keys = {group_of(node.category) for node in query if not is_minor(node.category)}
    assume(keys - {group_of(node.category) for node in room})
    full = together(query, build(["wardrobe"] * more, set()))
    assert distance(query, full) <= 64 < 100 <= distance(query, room)


def test_a_double_bed_stands_in_for_a_single_one_and_a_chair_for_a_stool() -> None:
    query = build(["single_bed", "stool"], set())
    match = exact_distance(query, with_offers(build(["double_bed", "dining_chair"], set())))
    assert match.cost == 60
    assert [pair.level for pair in match.pairs] == ["class", "class"]


def test_nothing_stands_in_across_groups() -> None:
    match = exact_distance(build(["double_bed"], set()), with_offers(build(["multi_seat_sofa"], set())))
    assert match.missing == (Furniture("double_bed", 1),)
    assert match.cost == 101


def test_one_chair_is_not_two() -> None:
    match = exact_distance(build(["chair", "chair"], set()), with_offers(build(["dining_chair"], set())))
    assert len(match.missing) == 1


def test_a_kind_leaves_what_is_asked_for_by_name_to_that() -> None:
    query = build(["chair", "dining_chair"], set())
    match = exact_distance(query, with_offers(build(["dining_chair", "office_chair", "stool"], set())))
    assert match.cost == match.lower_bound == 1
    assert {pair.level for pair in match.pairs} == {"same"}


def test_what_stands_by_one_desk_does_not_stand_by_another() -> None:
    query = build(["desk", "stool", "wardrobe"], {(0, 1), (0, 2)})
    room = with_offers(build(["desk", "desk", "stool", "wardrobe"], {(0, 2), (1, 3)}))
    assert exact_distance(query, room).cost == 20 + 1


def test_of_two_alike_each_gets_the_one_it_needs() -> None:
    query = build(["stool", "stool"], set(), needs=[frozenset(), frozenset({"sit"})])
    room = build(["stool", "stool"], set(), offers=[frozenset({"sit"}), frozenset()])
    match = exact_distance(query, room)
    assert match.cost == 0
    assert [pair.room.instance for pair in match.pairs] == [2, 1]


def test_who_wants_to_lie_down_gets_no_seat() -> None:
    query = build(["sofa"], set(), needs=[frozenset({"lie"})])
    room = build(["loveseat_sofa"], set(), offers=[affordances("loveseat_sofa")])
    assert exact_distance(query, room).missing == (Furniture("sofa", 1),)


def test_an_unknown_word_costs_the_same_everywhere() -> None:
    query = build(["grand piano"], set())
    rooms = [with_offers(build(words, set())) for words in (["double_bed"], ["stool"], ["wardrobe"])]
    assert {exact_distance(query, room).cost for room in rooms} == {101}


def test_a_room_of_a_hundred_objects_is_searched() -> None:
    room = with_offers(build(["dining_chair"] * 60 + ["dining_table"] * 40, {(0, 70), (1, 70)}))
    query = build(["chair", "chair", "dining_table"], {(0, 2), (1, 2)})
    assert exact_distance(query, room).cost == 97


def test_a_room_of_a_thousand_objects_is_searched() -> None:
    ring = {(i, (i + 1) % 1000) for i in range(1000)}
    room = with_offers(build(["dining_chair", "dining_table"] * 500, ring))
    query = build(["chair", "dining_table", "armchair"], {(0, 1), (1, 2)})
    match = exact_distance(query, room)
    assert match.cost == 997 + 30
    assert match.exact


def test_relations_beyond_a_byte_are_counted() -> None:
    clique = build(["dining_chair"] * 24, set(combinations(range(24), 2)))
    assert clique.number_of_edges() == 276
    match = exact_distance(clique, with_offers(clique))
    assert match.cost == match.lower_bound == 0


def test_what_is_joined_with_itself_is_refused() -> None:
    loop, plain = build(["desk"], {(0, 0)}), build(["desk"], set())
    for query, room in ((loop, plain), (plain, loop)):
        with pytest.raises(ValueError, match="desk 1 is joined with itself; leave that edge out"):
            exact_distance(query, room)


def test_an_empty_query_costs_what_is_there_and_an_empty_room_lacks_all() -> None:
    there = build(["desk", "vase"], {(0, 1)})
    assert exact_distance(nx.Graph(), there).cost == lower_bound(nx.Graph(), there) == 1
    match = exact_distance(there, nx.Graph())
    assert match.cost == match.lower_bound == 100 + 25 + 20
    assert set(match.missing) == set(there)


def test_a_need_that_nothing_can_ever_meet_is_missed() -> None:
    query = build(["desk"], set(), needs=[frozenset({"fly"})])
    room = build(["desk"], set(), offers=[frozenset({"fly", "sit", "lie", "touch"})])
    assert exact_distance(query, room).missing == (Furniture("desk", 1),)


def test_at_the_node_limit_the_best_so_far_is_returned_and_marked() -> None:
    words = ["dining_chair"] * 7
    query = build(words, {(i, j) for i in range(7) for j in range(i)})
    room = with_offers(build(["dining_chair"] * 25, {(i, i + 1) for i in range(24)}))
    match = exact_distance(query, room, limit=50)
    assert not match.exact
    assert match.lower_bound <= match.cost
    assert len(match.pairs) == 7


def test_a_query_of_more_than_fifty_two_pieces_is_refused() -> None:
    with pytest.raises(ValueError, match="at most 52 pieces of furniture, got 53"):
        exact_distance(build(["stool"] * 53, set()), build([], set()))


@for_each("costs", [(100, 1, 60, 30), (100, 1, 30, 102), (100, -1, 0, 0), (1.5, 1, 0, 0), (10_001, 0, 0, 0)])
def test_a_cost_table_that_breaks_the_axioms_is_refused(costs: tuple[int, int, int, int]) -> None:
    with pytest.raises(ValueError, match=r"costs must rise|whole number"):
        GroupCosts(*costs)
