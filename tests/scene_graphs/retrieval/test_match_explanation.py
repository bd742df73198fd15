"""Every match says what stands for what, what is missing and why, and its costs add up to the distance."""

from __future__ import annotations

from dataclasses import replace

import networkx as nx
import pytest
from examples import tries
from graphs_at_random import CATEGORIES, GENERIC, NEEDS, build, graphs
from hypothesis import given
from hypothesis import strategies as st
from rooms_at_random import searches, strewn

from scene_graphs.furniture import Furniture, group_of
from scene_graphs.graph.edit_distance import exact_distance
from scene_graphs.graph.furniture_graph import FurnitureGraph
from scene_graphs.graph.merge import side_by_side
from scene_graphs.graph.substitution_costs import CostTable, GroupCosts
from scene_graphs.layout import Layout
from scene_graphs.retrieval.home_retrieval import retrieve_home
from scene_graphs.retrieval.layout_index import LayoutIndex, retrieve_rooms
from scene_graphs.retrieval.match_explanation import explain

WORDS = CATEGORIES + GENERIC
TABLES = st.builds(
    CostTable,
    key=st.just(GroupCosts(90, 3, 20, 50)),
    minor=st.just(GroupCosts(11, 2, 5, 6)),
    lost_edge=st.integers(0, 40),
    extra_edge=st.integers(0, 9),
)
SIT, LIE = frozenset({"sit"}), frozenset({"lie"})


@given(graphs(4, WORDS, "needs"), graphs(6, CATEGORIES, "offers"), TABLES, st.booleans(), st.sampled_from([3, 100_000]))
@tries(150)
def test_the_costs_of_a_match_add_up_to_its_distance(
    query: FurnitureGraph, room: FurnitureGraph, costs: CostTable, strict: bool, limit: int
) -> None:
    match = exact_distance(query, room, costs, strict=strict, limit=limit)
    told = explain(query, room, match, costs)
    split = told.costs
    assert split.total == told.distance == match.cost
    assert told.exact == match.exact
    assert split.missing == sum(costs.of(node.category).delete for node in match.missing)
    assert split.lost_relations == costs.lost_edge * len(told.lost)
    assert split.extra_relations == costs.extra_edge * (len(room.edges) - len(query.edges) + len(told.lost))
    assert (split.substitutions == 0) == all(pair.cost == 0 for pair in told.substitutions)
    assert len(told.extra) == len(room) - len(told.given)
    assert len(told.lines()) == 1 + len(query) + len(told.lost)
    assert all(line.isprintable() for line in told.lines())


@given(searches(nodes=5))
@tries(60)
def test_matches_of_an_index_explain_themselves_too(search: tuple[list[Layout], FurnitureGraph]) -> None:
    index, query = LayoutIndex(search[0]), search[1]
    for strict in (False, True):
        for match in index.search(query, 3, strict=strict):
            told = explain(query, index.graph(match.layout_id), match)
            assert told.costs.total == match.distance
            assert sorted(told.extra) == sorted(match.extra)
            assert [(pair.asked, pair.object_id, pair.level) for pair in told.given] == sorted(match.mapping)
    empty: FurnitureGraph = nx.Graph()
    trivial = retrieve_rooms(index, {"bedroom": empty})["bedroom"]
    assert explain(empty, index.graph(trivial.layout_id), trivial).costs.total == trivial.distance


@given(graphs(4, WORDS, "needs"), graphs(6, CATEGORIES, "offers"))
@tries(100)
def test_what_is_missing_is_missing_for_the_reason_that_is_told(query: FurnitureGraph, room: FurnitureGraph) -> None:
    match = exact_distance(query, room)
    used = {pair.room for pair in match.pairs}
    for gap in explain(query, room, match).missing:
        group = [node for node in room if group_of(node.category) == group_of(gap.asked.category)]
        fit = [node for node in group if query.nodes[gap.asked]["needs"] <= room.nodes[node]["offers"]]
        assert gap.why == ("taken" if fit else "unfit" if group else "absent")
        assert used.issuperset(fit)
        assert (gap.nearest is None) == (not group)
        if gap.nearest is not None:
            assert gap.nearest in (fit or group)
            assert bool(gap.unmet) == (gap.why == "unfit")


def test_every_reason_has_its_words() -> None:
    query = build(
        ["armchair", "bed", "piano", "desk", "stool"],
        {(0, 1), (3, 4)},
        needs=[SIT, LIE, *NEEDS[:1] * 3],
    )
    room = build(
        ["dining_chair", "double_bed", "coffee_table", "vase"],
        {(0, 1)},
        offers=[SIT, SIT, *NEEDS[:1] * 2],
    )
    told = explain(query, room, exact_distance(query, room))
    assert told.lines() == [
        "graph distance 401 = 60 substitutions + 300 missing + 40 lost relations + 1 furniture not used",
        "armchair: dining chair stands in, of the same class, 30",
        "desk: coffee table stands in, of the same class, 30",
        "bed: missing, the double bed there cannot be lain on, 100",
        "piano: missing, there is nothing of its kind, 100",
        "stool: missing, the dining chair there is used already, 100",
        "armchair and bed: not both there, 20",
        "desk and stool: not both there, 20",
    ]
    assert {gap.asked.category: gap.why for gap in told.missing} == {
        "bed": "unfit",
        "piano": "absent",
        "stool": "taken",
    }
    assert next(gap for gap in told.missing if gap.why == "unfit").unmet == ("lie",)


def test_an_object_is_named_and_pieces_of_a_kind_are_told_apart() -> None:
    index = LayoutIndex([strewn("a", ["stool", "dining_chair", "dining_table"])])
    query = build(["chair", "chair", "table"], {(0, 2)})
    lines = explain(query, index.graph("a"), match := index.search(query)[0]).lines()
    assert match.distance == 30 + 20
    assert lines[0] == "graph distance 50 = 30 substitutions + 20 lost relations"
    assert {line.split(":")[0] for line in lines[1:4]} == {"chair 1", "chair 2", "table"}
    assert lines[3] == "table: dining table (o2)"
    assert lines[4] == "chair 1 and table: not near each other, 20"


def test_what_a_strict_search_passes_over_is_said() -> None:
    query, room = build(["stool"], set()), build(["armchair"], set())
    told = explain(query, room, exact_distance(query, room, strict=True))
    assert told.missing[0].why == "spare"
    assert told.lines()[1] == "stool: missing, though there is another armchair, 100"


def test_a_distance_that_is_not_proven_is_said() -> None:
    query = build(["dining_chair"] * 7, {(i, j) for i in range(7) for j in range(i)})
    room = build(["dining_chair"] * 20, {(i, i + 1) for i in range(19)})
    assert explain(query, room, exact_distance(query, room, limit=10)).lines()[0].endswith("(not proven least)")


def test_of_several_rooms_it_is_said_in_which_each_piece_is() -> None:
    index = LayoutIndex([strewn("a", ["double_bed"]), strewn("b", ["desk"])])
    query = build(["desk", "bed"], set())
    match = retrieve_home(index, query, 2)[0]
    told = explain(
        query, side_by_side({place: index.graph(name) for place, name in enumerate(match.layout_ids)}), match
    )
    assert told.lines() == ["graph distance 50 = 50 more rooms", "bed: double bed (0/o0)", "desk: desk (1/o0)"]


def test_a_match_of_something_else_is_refused() -> None:
    index = LayoutIndex([strewn("a", ["double_bed", "desk"]), strewn("b", ["double_bed"])])
    query = build(["bed"], set())
    match = index.search(query)[0]
    assert match.layout_id == "b"
    with pytest.raises(ValueError, match="another room or cost table: it costs 0, not 1"):
        explain(query, index.graph("a"), match)
    with pytest.raises(ValueError, match="another query"):
        explain(build(["desk"], set()), index.graph("b"), match)
    with pytest.raises(ValueError, match="no object 'gone' in this one"):
        explain(query, index.graph("b"), replace(match, mapping=((Furniture("bed"), "gone", "same"),)))
    with pytest.raises(ValueError, match="not all of its nodes"):
        explain(query, build(["desk"], set()), exact_distance(query, index.graph("b")))
    with pytest.raises(ValueError, match="across groups"):
        explain(query, index.graph("a"), replace(match, mapping=((Furniture("bed"), "o1", "same"),)))
