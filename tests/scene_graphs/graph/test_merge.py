"""Every script is found again in the merged graph, which has no more pieces than it must."""

from __future__ import annotations

from collections import Counter
from typing import Literal

import networkx as nx
import pytest
from examples import tries
from graphs_at_random import CATEGORIES, GENERIC, graphs
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.furniture import Furniture
from scene_graphs.graph.furniture_graph import FurnitureGraph, graph_from_uses
from scene_graphs.graph.merge import categorised, merge, side_by_side

Method = Literal["canonical", "aligned"]
METHODS = st.sampled_from(["canonical", "aligned"])
SCRIPTS = st.lists(graphs(5, CATEGORIES[:5] + GENERIC, "needs"), max_size=4)
QUICK = tries(60)


def same(first: FurnitureGraph, second: FurnitureGraph) -> bool:
    def content(graph: FurnitureGraph) -> tuple[object, ...]:
        return dict(graph.nodes(data="needs")), {frozenset(edge) for edge in graph.edges}

    return content(first) == content(second)


def counts(graph: FurnitureGraph) -> Counter[str]:
    return Counter(node.category for node in graph)


@given(SCRIPTS, METHODS)
@QUICK
def test_every_script_is_a_subgraph_under_its_instance_map(scripts: list[FurnitureGraph], method: Method) -> None:
    merged = merge(scripts, method)
    assert not any(a == b for a, b in merged.graph.edges)
    for script, names in zip(scripts, merged.instance_maps, strict=True):
        assert set(names) == set(script)
        assert len(set(names.values())) == len(names)
        assert all(merged.graph.has_edge(names[a], names[b]) for a, b in script.edges)
        for old, new in names.items():
            assert old.category == new.category
            assert script.nodes[old]["needs"] <= merged.graph.nodes[new]["needs"]


@given(SCRIPTS, METHODS)
@QUICK
def test_of_every_category_there_are_as_many_as_one_script_needs(scripts: list[FurnitureGraph], method: Method) -> None:
    most: Counter[str] = Counter()
    for script in scripts:
        most |= counts(script)
    merged = merge(scripts, method).graph
    assert counts(merged) == most
    assert {node.instance for node in merged} <= set(range(1, 1 + max(most.values(), default=0)))


@given(st.lists(graphs(5, CATEGORIES[:2]), min_size=3, max_size=4), METHODS)
@QUICK
def test_the_order_of_scripts_does_not_matter(scripts: list[FurnitureGraph], method: Method) -> None:
    merged = merge(scripts, method).graph
    assert same(merged, merge(scripts[::-1], method).graph)
    assert same(merged, merge([*scripts[1:], scripts[0]], method).graph)


@given(SCRIPTS, METHODS)
@QUICK
def test_merging_again_with_itself_changes_nothing(scripts: list[FurnitureGraph], method: Method) -> None:
    merged = merge(scripts, method).graph
    assert same(merge([merged, merged], method).graph, merged)


@given(graphs(5, needs := CATEGORIES[:5]), graphs(5, needs), graphs(5, needs))
@QUICK
def test_the_canonical_merge_is_associative(a: FurnitureGraph, b: FurnitureGraph, c: FurnitureGraph) -> None:
    left = merge([merge([a, b]).graph, c]).graph
    assert same(left, merge([a, merge([b, c]).graph]).graph)
    assert same(left, merge([a, b, c]).graph)


@given(graphs(6, CATEGORIES[:4]), graphs(6, CATEGORIES[:4]))
@QUICK
def test_aligning_two_scripts_never_makes_more_edges(a: FurnitureGraph, b: FurnitureGraph) -> None:
    aligned, canonical = (merge([a, b], method).graph.number_of_edges() for method in ("aligned", "canonical"))
    assert aligned <= canonical


@given(SCRIPTS, METHODS)
@QUICK
def test_no_script_and_empty_scripts_add_nothing(scripts: list[FurnitureGraph], method: Method) -> None:
    empty: FurnitureGraph = nx.Graph()
    assert same(merge([], method).graph, empty)
    with_empty = merge([empty, *scripts, empty], method)
    assert same(with_empty.graph, merge(scripts, method).graph)
    assert with_empty.instance_maps[0] == with_empty.instance_maps[-1] == {}


@given(SCRIPTS, METHODS)
@QUICK
def test_less_important_pieces_are_marked(scripts: list[FurnitureGraph], method: Method) -> None:
    marks = merge(scripts, method).graph.nodes(data="minor")
    assert {node.category for node, minor in marks if minor} <= {"floor_lamp", "table_lamp", "vase", "lamp"}
    assert all(minor for node, minor in marks if node.category in {"floor_lamp", "table_lamp", "vase", "lamp"})


@given(SCRIPTS, METHODS)
@QUICK
def test_what_is_joined_to_itself_is_not_once_merged(scripts: list[FurnitureGraph], method: Method) -> None:
    looped = [graph.copy() for graph in scripts]
    for graph in looped:
        graph.add_edges_from((node, node) for node in list(graph)[::2])
    assert same(merge(looped, method).graph, merge(scripts, method).graph)


@given(st.lists(graphs(5, CATEGORIES[:4], "offers"), max_size=4))
@QUICK
def test_rooms_side_by_side_keep_all_they_have_and_nothing_joins_them(rooms: list[FurnitureGraph]) -> None:
    for graph in rooms:
        for number, node in enumerate(graph):
            graph.nodes[node]["object_id"] = f"o{number}"
    places = {3 * number: graph for number, graph in enumerate(rooms)}
    union = side_by_side(places)
    named = {str(name): node for node, name in union.nodes(data="object_id")}
    assert len(named) == len(union) == sum(map(len, rooms))
    for place, graph in places.items():
        for node, data in graph.nodes(data=True):
            twin = named[f"{place}/{data['object_id']}"]
            assert (twin.category, union.nodes[twin]["offers"]) == (node.category, data["offers"])
            around = {named[f"{place}/{graph.nodes[other]['object_id']}"] for other in graph[node]}
            assert set(union[twin]) == around


def test_chair_seven_alone_becomes_the_first_chair() -> None:
    merged = merge(
        [
            graph_from_uses([("sofa", 1), ("tv_stand", 1), ("floor", 1), ("chair", 1), ("desk", 1)]),
            graph_from_uses([("chair", 1), ("table", 1), ("chair", 2)]),
            graph_from_uses([("chair", 7), ("desk", 3)]),
        ]
    )
    assert len(merged.graph) == 6
    assert merged.graph.number_of_edges() == 4
    assert merged.instance_maps[2] == {("chair", 7): ("chair", 1), ("desk", 3): ("desk", 1)}


def test_aligning_invents_no_relation_that_renaming_avoids() -> None:
    first = graph_from_uses([("chair", 1), ("table", 1), ("floor", 1), ("chair", 2), ("desk", 1)])
    second = graph_from_uses([("chair", 1), ("desk", 1)])
    assert merge([first, second]).graph.number_of_edges() == 3
    aligned = merge([first, second], "aligned")
    assert aligned.graph.number_of_edges() == 2
    assert aligned.instance_maps[1][Furniture("chair", 1)] == Furniture("chair", 2)


def test_many_chairs_are_aligned_without_trying_everything() -> None:
    party = graph_from_uses([(word, i) for i in range(1, 10) for word in ("dining_chair", "dining_table")])
    merged = merge([party, party], "aligned").graph
    assert same(merged, merge([party]).graph)


def test_words_for_one_category_are_counted_together() -> None:
    graph = graph_from_uses([("sofa", 1)])
    graph.add_node(Furniture("couch", 1), needs=frozenset())
    assert set(categorised(graph).values()) == {("sofa", 1), ("sofa", 2)}


def test_an_unknown_method_is_named() -> None:
    with pytest.raises(ValueError, match="canonical or aligned, got 'greedy'"):
        merge([], "greedy")  # type: ignore[arg-type]  # no such method
