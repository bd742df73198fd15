"""The nearest rooms are the ones a full scan finds, in the same order, and misses are told."""

from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import networkx as nx
import numpy as np
import pytest
from examples import tries
from graphs_at_random import CATEGORIES, GENERIC, build, graphs
from hypothesis import assume, given
from hypothesis import strategies as st

from scene_graphs.furniture import Furniture, typical_size
from scene_graphs.graph.branch_and_bound import CodedQuery, Hunt
from scene_graphs.graph.edit_distance import exact_distance, lower_bound
from scene_graphs.graph.furniture_graph import FurnitureGraph, graph_from_layout
from scene_graphs.graph.merge import side_by_side
from scene_graphs.graph.packed_graphs import PackedRooms
from scene_graphs.graph.substitution_costs import CostTable
from scene_graphs.layout import Layout, Placed
from scene_graphs.retrieval.layout_index import LayoutIndex, NoSuitableRoom, pack, retrieve_rooms

SQUARE = ((0.0, 0.0), (0.0, 8.0), (8.0, 8.0), (8.0, 0.0))
WORDS = CATEGORIES + GENERIC
SIT, LIE = frozenset({"sit"}), frozenset({"lie"})


def room(name: str, categories: list[str], room_type: str = "bedroom", seed: int = 0) -> Layout:
    """Furniture strewn over a square."""
    rng = np.random.default_rng(seed)
    objects = [
        Placed(f"o{i}", category, (float(x), 0.0, float(z)), typical_size(category))
        for i, (category, (x, z)) in enumerate(zip(categories, rng.uniform(0, 6, (len(categories), 2)), strict=True))
    ]
    return Layout(name, room_type, SQUARE, objects=tuple(objects), tags=(room_type,))


@st.composite
def libraries(draw: st.DrawFn) -> list[Layout]:
    """Up to a dozen rooms; few categories, so that ties are common."""
    pool = draw(st.lists(st.sampled_from(CATEGORIES), min_size=1, max_size=4))
    sizes = draw(st.lists(st.lists(st.sampled_from(pool), max_size=6), min_size=1, max_size=12))
    return [room(f"r{i * 7 % 13}", categories, seed=i % 3) for i, categories in enumerate(sizes)]


@given(libraries(), graphs(5, WORDS, "needs"), st.integers(1, 5), st.sampled_from([1, 2, 5, 64]))
@tries(60)
def test_the_nearest_are_those_of_a_full_scan(
    layouts: list[Layout], query: FurnitureGraph, k: int, first_stage: int
) -> None:
    assume(len(query))
    found = LayoutIndex(layouts, first_stage=first_stage).search(query, k)
    matches = {layout.id: exact_distance(query, graph_from_layout(layout)) for layout in layouts}
    scan = sorted((match.cost, match.lower_bound, name) for name, match in matches.items())
    assert [(match.distance, match.lower_bound, match.layout_id) for match in found] == scan[:k]
    assert all(match.exact for match in found)


@given(libraries(), graphs(6, WORDS))
@tries(40)
def test_the_bounds_of_all_rooms_are_those_of_each(layouts: list[Layout], query: FurnitureGraph) -> None:
    index = LayoutIndex(layouts)
    bounds = index.bounds(CodedQuery.of(query, index.costs))
    assert list(bounds) == [lower_bound(query, graph_from_layout(layout)) for layout in index.layouts]
    strict = index.bounds(CodedQuery.of(query, index.costs, strict=True))
    assert list(strict) == [lower_bound(query, graph_from_layout(layout), strict=True) for layout in index.layouts]


@given(libraries(), graphs(5, WORDS, "needs"))
@tries(40)
def test_a_match_names_every_piece_of_query_and_room_once(layouts: list[Layout], query: FurnitureGraph) -> None:
    assume(len(query))
    index = LayoutIndex(layouts)
    match = index.search(query)[0]
    nodes = [node for node, _, _ in match.mapping]
    used = [object_id for _, object_id, _ in match.mapping]
    assert sorted([*nodes, *match.missing]) == sorted(query)
    assert sorted([*used, *match.extra]) == sorted(placed.id for placed in index.layout(match.layout_id).objects)


def test_unused_furniture_breaks_ties_then_the_id() -> None:
    rooms = [room("b", ["double_bed"]), room("c", ["double_bed", "wardrobe"]), room("a", ["double_bed"])]
    found = LayoutIndex(rooms).search(build(["bed"], set()), 10)
    assert [match.layout_id for match in found] == ["a", "b", "c"]
    assert [match.distance for match in found] == [0, 0, 1]


def test_strictly_the_same_category_wins_over_kept_relations() -> None:
    beside = (
        Placed("a", "armchair", (1.0, 0.0, 1.0), (0.8, 0.8, 0.8)),
        Placed("d", "desk", (2.5, 0.0, 1.0), (1.4, 0.75, 0.6)),
    )
    apart = (
        Placed("s", "stool", (0.5, 0.0, 0.5), (0.4, 0.45, 0.4)),
        Placed("d", "desk", (6.0, 0.0, 6.0), (1.4, 0.75, 0.6)),
        *(Placed(f"w{i}", "wardrobe", (6.0, 0.0, 0.5 + i / 9), (1.0, 2.0, 0.5)) for i in range(11)),
    )
    rooms = [Layout("beside", "bedroom", SQUARE, objects=beside), Layout("apart", "bedroom", SQUARE, objects=apart)]
    index, query = LayoutIndex(rooms), build(["stool", "desk"], {(0, 1)})
    assert index.search(query)[0].layout_id == "beside"
    strict = index.search(query, strict=True)[0]
    assert strict.layout_id == "apart"
    assert {level for _, _, level in strict.mapping} == {"same"}


def test_where_the_strict_stage_finds_nothing_classes_help_out() -> None:
    match = LayoutIndex([room("a", ["double_bed"])]).search(build(["single_bed"], set()), strict=True)[0]
    assert match.mapping == ((Furniture("single_bed", 1), "o0", "class"),)
    assert not match.missing


def test_an_affordance_is_never_relaxed() -> None:
    match = LayoutIndex([room("a", ["loveseat_sofa"])]).search(build(["sofa"], set(), needs=[LIE]))[0]
    assert match.missing == (Furniture("sofa", 1),)


def test_a_room_found_at_the_node_limit_is_marked_but_not_dropped() -> None:
    query = build(["dining_chair"] * 7, {(i, j) for i in range(7) for j in range(i)})
    index = LayoutIndex([room("a", ["dining_chair"] * 20)], limit=10)
    match = index.search(query)[0]
    assert not match.exact
    assert match.lower_bound <= match.distance


@pytest.mark.parametrize("first_stage", [1, 2, 3])
def test_a_room_whose_bound_promises_too_much_comes_second_in_any_stage(first_stage: int) -> None:
    query = build(["desk", "stool"], {(0, 1)})
    # Its stool stands by a table, not by the desk: a bound of 1, but a distance of 21.
    hopeful, honest = build(["desk", "stool", "coffee_table"], {(1, 2)}), build(["desk", "stool"], set())
    rooms = [room("honest", []), room("hopeful", [])]
    index = LayoutIndex.of_packed(pack([honest, hopeful], rooms), rooms, first_stage=first_stage)
    found = [(match.layout_id, match.lower_bound, match.distance) for match in index.search(query, 2)]
    assert found == [("honest", 20, 20), ("hopeful", 1, 21)]
    assert index.search(query)[0].layout_id == "honest"


def test_of_rooms_as_far_the_one_that_promised_more_comes_first() -> None:
    query = build(["desk", "stool"], {(0, 1)})
    hopeful = build(["desk", "stool", "coffee_table"], {(1, 2)})
    honest = build(["desk", "stool", "coffee_table"], set())
    rooms = [room("honest", []), room("hopeful", [])]
    found = LayoutIndex.of_packed(pack([honest, hopeful], rooms), rooms).search(query, 2)
    assert [(match.layout_id, match.lower_bound, match.distance) for match in found] == [
        ("hopeful", 1, 21),
        ("honest", 21, 21),
    ]


def test_a_room_is_not_called_the_nearest_while_one_that_met_the_limit_may_be_nearer() -> None:
    query = build(["stool"] * 3, {(0, 1), (1, 2)})
    apart, hidden = build(["stool"] * 3, set()), build(["stool"] * 6, {(3, 4), (4, 5)})
    rooms = [room("apart", []), room("hidden", [])]
    offers = frozenset({"sit"})
    for graph in (apart, hidden):
        nx.set_node_attributes(graph, dict.fromkeys(graph, offers), "offers")
    index = LayoutIndex.of_packed(pack([apart, hidden], rooms), rooms)
    assert [(match.layout_id, match.distance) for match in index.search(query, 2)] == [("hidden", 3), ("apart", 40)]
    (match,) = index.search(query, limit=4)
    assert (match.layout_id, match.distance, match.lower_bound) == ("apart", 40, 40)
    assert not match.exact


@given(libraries(), graphs(6, WORDS), st.integers(1, 5), st.integers(1, 30), st.integers(0, 200))
@tries(60)
def test_no_limit_drops_a_room_or_hides_that_it_may_be_wrong(
    layouts: list[Layout], query: FurnitureGraph, k: int, limit: int, effort: int
) -> None:
    assume(len(query))
    index = LayoutIndex(layouts)
    everywhere = np.ones(len(layouts), dtype=np.uint8)
    hunt = index.hunt(CodedQuery.of(query, index.costs))
    found, doubtful = hunt.nearest(everywhere, min(k, len(layouts)), 1, limit, effort)
    assert len(found) == min(k, len(layouts))
    exact, _ = hunt.nearest(everywhere, min(k, len(layouts)), 1)
    for entry, right in zip(found, exact, strict=True):
        assert entry.cost >= right.cost
        if not entry.found.capped and (doubtful > entry.cost or doubtful == entry.cost > entry.bound):
            assert entry[:3] == right[:3]


@given(libraries(), graphs(5, WORDS), st.integers(0, 60))
@tries(40)
def test_below_a_distance_a_room_is_found_if_it_is_nearer(
    layouts: list[Layout], query: FurnitureGraph, upper: int
) -> None:
    index = LayoutIndex(layouts)
    hunt = index.hunt(CodedQuery.of(query, index.costs))
    for number in range(len(layouts)):
        whole = hunt.search([number]).cost
        assert whole is not None
        assert hunt.search([number], whole + 1).cost == whole
        assert hunt.search([number], whole + upper + 1).cost == whole
        assert hunt.search([number], whole - upper).cost is None


@given(libraries(), graphs(5, WORDS, "needs"))
@tries(40)
def test_rooms_side_by_side_are_searched_as_one(layouts: list[Layout], query: FurnitureGraph) -> None:
    index = LayoutIndex(layouts)
    hunt = index.hunt(CodedQuery.of(query, index.costs))
    numbers = list(range(min(3, len(layouts))))
    union = side_by_side({number: index.graph(index.layouts[number].id) for number in numbers})
    assert hunt.search(numbers).cost == exact_distance(query, union).cost


def test_relations_of_every_room_side_by_side_count() -> None:
    rooms = PackedRooms.of([build(["double_bed", "wardrobe"], {(0, 1)}), build(["desk", "stool"], {(0, 1)})])
    hunt = Hunt(CodedQuery.of(build(["double_bed", "desk", "stool"], {(1, 2)}), CostTable()), rooms)
    assert hunt.search([0, 1]).cost == hunt.search([1, 0]).cost == 1


def test_the_effort_is_that_of_all_rooms_together() -> None:
    rooms = [room(f"r{i:02}", ["stool", "stool", "desk"], seed=i) for i in range(30)]
    index = LayoutIndex(rooms)
    hunt = index.hunt(CodedQuery.of(build(["stool", "stool", "desk"], {(0, 1), (1, 2)}), index.costs))
    everywhere = np.ones(len(rooms), dtype=np.uint8)
    for effort, is_capped in ((100_000, False), (100, True)):
        found, _ = hunt.nearest(everywhere, len(rooms), 1, effort=effort)
        assert len(found) == len(rooms)
        assert any(entry.found.capped for entry in found) == is_capped


def test_searches_at_once_find_what_they_find_alone() -> None:
    words = list(CATEGORIES[:6])
    rooms = [room(f"r{i:02}", words[i % 3 :], seed=i) for i in range(40)]
    queries = [build([words[i % 6], words[(i + 2) % 6], "chair"], {(0, 1), (1, 2)}) for i in range(12)]
    index = LayoutIndex(rooms)
    alone = [index.search(query, 5) for query in queries]
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(lambda query: index.search(query, 5), queries * 3)) == alone * 3


def test_words_that_nobody_knows_are_found_by_their_own_name_only() -> None:
    rooms = [room("a", ["harp", "desk"]), room("b", ["lyre", "desk"]), room("c", ["desk"])]
    query = build(["lyre", "desk"], {(0, 1)})
    found = LayoutIndex(rooms).search(query, 3)
    assert [match.layout_id for match in found] == ["b", "c", "a"]
    assert [node for match in found for node in match.missing] == [("lyre", 1)] * 2
    strange = LayoutIndex(rooms).search(build(["zither"], set()), 3)
    assert {match.missing for match in strange} == {(Furniture("zither", 1),)}


@pytest.mark.service
def test_importing_retrieval_does_not_wait_for_the_compiler() -> None:
    code = "import sys, scene_graphs.retrieval.layout_index; print([name for name in sys.modules if 'numba' in name])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.service
def test_where_no_folder_takes_compiled_code_it_is_compiled_all_the_same() -> None:
    """As in a container whose every folder is read-only: the compiler then refuses to be asked to keep anything."""
    code = (
        "import numba.core.caching as caching; caching.CacheImpl._locator_classes = []\n"
        "from scene_graphs.graph.branch_and_bound_kernel import bounds_of; print(bounds_of.stats.cache_path)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "None"


def test_rooms_are_found_by_their_type_and_tags() -> None:
    both = Layout("both", "living_room", SQUARE, objects=room("x", ["desk"]).objects, tags=("living_room", "study"))
    index = LayoutIndex([both, room("bed", ["desk"], "bedroom")])
    assert [match.layout_id for match in index.search(build(["desk"], set()), 5, "study")] == ["both"]
    assert index.search(build(["desk"], set()), 5, "Library")[0].layout_id == "both"


def test_more_rooms_than_there_are_cannot_be_found() -> None:
    assert len(LayoutIndex([room("a", ["desk"])]).search(build(["desk"], set()), 10)) == 1


def test_an_empty_query_and_an_absent_type_are_refused() -> None:
    index = LayoutIndex([room("a", ["desk"])])
    with pytest.raises(ValueError, match="every keyframe is on the floor"):
        index.search(nx.Graph())
    with pytest.raises(NoSuitableRoom, match="no room of type study is indexed; there are: bedroom"):
        index.search(build(["desk"], set()), room_type="study")
    for k, limit in ((0, 1), (1, 0)):
        with pytest.raises(ValueError, match=f"k and limit must be at least 1, got {k} and {limit}"):
            index.search(build(["desk"], set()), k, limit=limit)
    with pytest.raises(ValueError, match="at most 52 pieces of furniture, got 1000; split it"):
        index.search(build(["desk"] * 1000, set()))
    with pytest.raises(NoSuitableRoom, match="there are: none"):
        LayoutIndex([]).search(build(["desk"], set()))


def test_ids_must_differ() -> None:
    with pytest.raises(ValueError, match="different ids"):
        LayoutIndex([room("a", []), room("a", [])])


def test_one_room_a_type_is_retrieved() -> None:
    rooms = [room("a", ["double_bed"]), room("b", ["single_bed"]), room("c", ["desk", "office_chair"], "study")]
    graphs_by_type = {"bedroom": build(["single_bed"], set()), "study": build(["chair"], set(), needs=[SIT])}
    matches = retrieve_rooms(LayoutIndex(rooms), graphs_by_type)
    assert {name: match.layout_id for name, match in matches.items()} == {"bedroom": "b", "study": "c"}


def test_a_seed_varies_rooms_that_are_as_good() -> None:
    rooms = [room(f"r{i}", ["double_bed", "wardrobe"][: 1 + i % 2]) for i in range(6)] + [room("z", ["desk"])]
    index = LayoutIndex(rooms)
    graph = build(["bed"], set())
    chosen = {retrieve_rooms(index, {"bedroom": graph}, seed=seed)["bedroom"].layout_id for seed in range(30)}
    assert len(chosen) > 3
    assert "z" not in chosen
    assert retrieve_rooms(index, {"bedroom": graph}, seed=3) == retrieve_rooms(index, {"bedroom": graph}, seed=3)


def test_a_type_without_furniture_gets_a_room_of_it() -> None:
    matches = retrieve_rooms(LayoutIndex([room("a", ["desk"], "study")]), {"study": nx.Graph()})
    assert matches["study"].layout_id == "a"


def test_where_a_home_must_be_complete_what_is_missing_is_named() -> None:
    graph = build(["piano", "floor_lamp", "desk"], set())
    with pytest.raises(NoSuitableRoom, match="no bedroom has all of: piano") as caught:
        retrieve_rooms(LayoutIndex([room("a", ["desk"])]), {"bedroom": graph}, complete=True)
    assert caught.value.missing == (Furniture("piano", 1),)
    matches = retrieve_rooms(LayoutIndex([room("a", ["desk"])]), {"bedroom": graph})
    assert set(matches["bedroom"].missing) == {("piano", 1), ("floor_lamp", 1)}
