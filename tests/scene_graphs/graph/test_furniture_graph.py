"""Scripts and rooms become graphs: who is a node, who is joined, who needs and offers what."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
import shapely
from examples import tries
from hypothesis import given
from hypothesis import strategies as st

from scene_graphs.furniture import Furniture, is_minor
from scene_graphs.graph.furniture_graph import graph_from_layout, graph_from_objects, graph_from_uses, offers
from scene_graphs.layout import NEAR, Layout, Placed

SQUARE = ((0.0, 0.0), (0.0, 6.0), (6.0, 6.0), (6.0, 0.0))


def edges(layout: Layout) -> set[frozenset[str]]:
    return {frozenset((a.category, b.category)) for a, b in graph_from_layout(layout).edges}


def room(*objects: Placed) -> Layout:
    return Layout("room", "bedroom", SQUARE, objects=objects)


def test_pieces_used_one_after_the_other_are_joined() -> None:
    graph = graph_from_uses([("couch", 1), ("sofa", 1), ("tv stand", 1), ("chair", 2)])
    assert set(graph) == {("sofa", 1), ("tv_stand", 1), ("chair", 2)}
    assert {frozenset(edge) for edge in graph.edges} == {
        frozenset({("sofa", 1), ("tv_stand", 1)}),
        frozenset({("tv_stand", 1), ("chair", 2)}),
    }


def test_the_floor_is_no_node_and_parts_what_it_stands_between() -> None:
    graph = graph_from_uses([("bed", 1), ("floor", 1), ("desk", 1)])
    assert len(graph) == 2
    assert not graph.edges


def test_a_script_on_the_floor_has_an_empty_graph() -> None:
    assert not graph_from_uses([("floor", 1), ("floor", 1)])


def test_needs_of_all_uses_are_united() -> None:
    graph = graph_from_uses([("sofa", 1), ("desk", 1), ("sofa", 1)], [{"sit"}, {"touch"}, {"lie"}])
    assert graph.nodes[Furniture("sofa")]["needs"] == {"sit", "lie"}


def test_needs_are_counted() -> None:
    with pytest.raises(ValueError, match="got 1 for 2 uses"):
        graph_from_uses([("sofa", 1), ("desk", 1)], [{"sit"}])


def test_near_objects_are_joined_and_far_ones_are_not() -> None:
    bed = Placed("a", "double_bed", (1.0, 0.0, 1.2), (1.6, 0.9, 2.0))
    stand = Placed("b", "nightstand", (2.1, 0.0, 0.4), (0.5, 0.5, 0.4))
    desk = Placed("c", "desk", (5.0, 0.0, 5.0), (1.4, 0.75, 0.6))
    assert edges(room(bed, stand, desk)) == {frozenset({"double_bed", "nightstand"})}


def test_a_third_piece_in_between_parts_two() -> None:
    left = Placed("a", "armchair", (1.0, 0.0, 1.0), (0.8, 0.8, 0.8))
    right = Placed("b", "tv_stand", (2.5, 0.0, 1.0), (0.4, 0.5, 1.4))
    table = Placed("c", "coffee_table", (1.8, 0.0, 1.0), (0.4, 0.4, 2.4))
    rug = Placed("d", "rug", (1.8, 0.0, 1.0), (0.6, 0.01, 2.4))
    assert frozenset({"armchair", "tv_stand"}) in edges(room(left, right, rug))
    assert frozenset({"armchair", "tv_stand"}) not in edges(room(left, right, table))


def test_instances_are_counted_in_order_and_keep_their_object() -> None:
    chairs = [Placed(f"c{i}", "dining_chair", (1.0 + i, 0.0, 1.0), (0.5, 0.9, 0.5)) for i in range(3)]
    graph = graph_from_layout(room(*chairs))
    assert {node: graph.nodes[node]["object_id"] for node in graph} == {
        ("dining_chair", i + 1): f"c{i}" for i in range(3)
    }


def test_lamps_are_minor_and_small_unknown_things_are_left_out() -> None:
    desk = Placed("desk", "desk", (1.0, 0.0, 1.0), (1.4, 0.75, 0.6))
    lamp = Placed("lamp", "table_lamp", (1.0, 0.75, 1.0), (0.3, 0.4, 0.3), parent="desk")
    egg = Placed("egg", "egg", (1.2, 0.75, 1.0), (0.05, 0.06, 0.05), parent="desk")
    graph = graph_from_layout(room(desk, lamp, egg))
    assert {node: graph.nodes[node]["minor"] for node in graph} == {("desk", 1): False, ("table_lamp", 1): True}


def test_lying_is_measured() -> None:
    long = Placed("a", "multi_seat_sofa", (1.0, 0.0, 1.0), (2.3, 0.85, 0.95))
    short = Placed("b", "multi_seat_sofa", (1.0, 0.0, 1.0), (1.3, 0.85, 0.95))
    assert "lie" in offers(long)
    assert "lie" not in offers(short)
    assert "sit" in offers(short)


def test_what_hangs_offers_nothing() -> None:
    assert not offers(Placed("a", "floor_lamp", (1.0, 2.0, 1.0), (0.4, 0.4, 0.4)))


@st.composite
def furnished(draw: st.DrawFn) -> list[Placed]:
    """Objects on a grid of half metres, so that they often touch, overlap or hide one another."""
    words = st.sampled_from(["desk", "stool", "wardrobe", "floor_lamp", "pendant_lamp", "vase"])
    half = st.integers(0, 8).map(lambda number: number / 2)
    sizes = st.tuples(*[st.integers(1, 4).map(lambda number: number / 2)] * 3)
    yaws = st.sampled_from([0.0, 0.3, np.pi / 4, np.pi / 2])
    spots = st.tuples(half, st.sampled_from([0.0, 0.0, 1.6]), half)
    rows = draw(st.lists(st.tuples(words, spots, sizes, yaws, st.booleans()), max_size=9))
    return [
        Placed(f"o{i}", word, place, size, yaw, parent="o0" if i and stands else None)
        for i, (word, place, size, yaw, stands) in enumerate(rows)
    ]


@given(furnished())
@tries(150)
def test_who_is_joined_is_what_looking_at_every_three_finds(objects: list[Placed]) -> None:
    prints = [shapely.Polygon(placed.footprint) for placed in objects]
    solid = [not is_minor(o.category) and o.parent is None and o.position[1] < 1.5 for o in objects]
    joined = set()
    for i, j in combinations(range(len(objects)), 2):
        line = shapely.shortest_line(prints[i], prints[j])
        between = [k for k in range(len(objects)) if k not in (i, j) and solid[k]]
        if line.length <= NEAR and not any(line.intersects(prints[k].buffer(-0.02)) for k in between):
            joined.add(frozenset((f"o{i}", f"o{j}")))
    graph = graph_from_objects(objects)
    assert {frozenset(str(graph.nodes[end]["object_id"]) for end in edge) for edge in graph.edges} == joined


@pytest.mark.sweep
def test_five_hundred_objects_in_a_heap_are_a_graph_within_seconds() -> None:
    rng = np.random.default_rng(0)
    points = rng.uniform(0, 4, (500, 2))
    heap = [
        Placed(f"o{i}", "desk", (x, 0.0, z), (1.4, 0.75, 0.6), yaw=i / 9) for i, (x, z) in enumerate(points.tolist())
    ]
    assert len(graph_from_objects(heap)) == 500
    assert graph_from_objects([]).number_of_nodes() == 0
