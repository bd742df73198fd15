"""`sims layouts find` reads words and files, finds what the index finds, and names what it cannot read."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from planner_service.cli.layouts import app, graph_of_file, graph_of_words
from planner_service.pipeline import RequestError
from scene_graphs.furniture import AFFORDANCES, Furniture
from scene_graphs.graph.furniture_graph import graph_from_uses
from scene_graphs.layout_library import built_in_layouts
from scene_graphs.retrieval.layout_index import LayoutIndex
from scene_graphs.retrieval.match_explanation import explain

GRAPH = {"nodes": [{"category": "sofa", "needs": ["sit"]}, {"category": "bookshelf"}], "edges": [[0, 1]]}
SUPPER_AND_BED = "bed:lie wardrobe nightstand, dining_table dining_chair dining_chair2 dining_chair3 dining_chair4"
WORD = st.tuples(
    st.sampled_from(["sofa", "dining_chair", "coffee_table", "lamp"]),
    st.integers(1, 12),
    st.sets(st.sampled_from(AFFORDANCES)),
)


@given(st.lists(st.lists(WORD, min_size=1, max_size=4), min_size=1, max_size=4))
def test_words_mean_what_a_script_means_that_uses_them_in_order(
    chains: list[list[tuple[str, int, set[str]]]],
) -> None:
    def written(word: str, number: int, needs: set[str]) -> str:
        return f"{word}{number if number > 1 else ''}{':' if needs else ''}{'+'.join(sorted(needs))}"

    text = " , ".join(" ".join(written(*word) for word in chain) for chain in chains)
    graph = graph_of_words(text.split(" "))
    uses = [use for chain in chains for use in [*chain, ("floor", 1, set())]]
    same = graph_from_uses([(word, number) for word, number, _ in uses], [needs for *_, needs in uses])
    assert dict(graph.nodes(data="needs")) == dict(same.nodes(data="needs"))
    assert {frozenset(edge) for edge in graph.edges} == {frozenset(edge) for edge in same.edges}


@for_each("word", ["7", ":sit", "sofa:", "sofa:fly", "sofa:sit+", "chair0", "chair123", "a:b:c"])
def test_a_word_that_is_none_is_named(word: str) -> None:
    with pytest.raises(RequestError, match="WORDS: ") as caught:
        graph_of_words(["lamp", word])
    assert repr(word) in str(caught.value)


@pytest.mark.parametrize("words", [[","], [""], [" , ", ","]])
def test_no_words_are_refused(words: list[str]) -> None:
    with pytest.raises(RequestError, match="no furniture is named"):
        graph_of_words(words)


@pytest.mark.parametrize("whole", [GRAPH, {"graph": GRAPH, "k": 3}])
def test_a_file_holds_what_is_sent_over_http(tmp_path: Path, whole: Any) -> None:
    (tmp_path / "graph.json").write_text(json.dumps(whole))
    graph = graph_of_file(tmp_path / "graph.json")
    assert set(graph.edges) == {(Furniture("sofa"), Furniture("bookshelf"))}
    assert graph.nodes[Furniture("sofa")]["needs"] == {"sit"}


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("{", "graph.json: is not JSON"),
        ("[" * 100_000, "graph.json: is not JSON"),
        ("[]", "graph.json: the graph"),
        ('{"nodes": []}', "graph.json: nodes"),
        ('{"nodes": [{"category": "sofa", "needs": ["fly"]}]}', "graph.json: nodes.0.needs.0"),
        ('{"nodes": [{"category": "sofa"}, {"category": "sofa"}]}', "/nodes/1: the same piece"),
        ('{"nodes": [{"category": "sofa"}], "edges": [[0, 0]]}', "/edges/0"),
        (" " * 1_100_000, "at most 1 MB"),
    ],
)
def test_a_file_that_holds_no_graph_is_refused_by_the_place(tmp_path: Path, text: str, named: str) -> None:
    (tmp_path / "graph.json").write_text(text)
    with pytest.raises(RequestError) as caught:
        graph_of_file(tmp_path / "graph.json")
    assert named in str(caught.value)


def test_what_is_found_is_printed_with_its_reasons(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SIMS_DATA_DIR", str(tmp_path))
    done = CliRunner().invoke(app, ["find", "sofa:sit", "bookshelf,", "piano", "-k", "3", "--room", "study"])
    assert done.exit_code == 0, done.output
    index = LayoutIndex(built_in_layouts())
    query = graph_of_words(["sofa:sit", "bookshelf,", "piano"])
    expected = []
    for match in index.search(query, 3, "study"):
        told = explain(query, index.graph(match.layout_id), match)
        expected += [match.layout_id, *(f"  {line}" for line in told.lines())]
    assert done.output.splitlines() == expected
    assert "  piano: missing, there is nothing of its kind, 100" in expected


def test_homes_are_found_where_more_rooms_are_allowed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SIMS_DATA_DIR", str(tmp_path))
    done = CliRunner().invoke(app, ["find", SUPPER_AND_BED, "--rooms", "2", "-k", "1"])
    assert done.exit_code == 0, done.output
    first, second = done.output.splitlines()[0].split(" + ")
    assert first.startswith("bedroom-")
    assert second.startswith(("dining-room-", "living-room-"))
    assert "50 more rooms" in done.output.splitlines()[1]
