"""Graphs of furniture over HTTP: merged as the engine merges them, and good as a query."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator
from itertools import combinations
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from for_each import for_each
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from service_app import app_on, calling, check_problem
from tries import tries

from planner_service.api.layouts.schemas import Merged
from scene_graphs.furniture import canonical

pytestmark = pytest.mark.anyio
WORDS = ("sofa", "couch", "armchair", "lamp", "coffee table", "big wooden chair", "thingamajig")


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def app(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FastAPI]:
    with app_on(tmp_path_factory.mktemp("graphs"), rate="1000000/minute") as app:
        yield app


async def ask(app: FastAPI, path: str, body: Any) -> httpx.Response:
    async with calling(app, timeout=60) as client:
        return await client.post(path, json=body)


@st.composite
def graphs(draw: st.DrawFn) -> dict[str, Any]:
    """A graph as a client may send it."""
    pieces = draw(st.lists(st.tuples(st.sampled_from(WORDS), st.integers(1, 3)), min_size=1, max_size=6, unique=True))
    needs = st.lists(st.sampled_from(["sit", "lie", "touch"]), max_size=2)
    nodes = [{"category": word, "instance": number, "needs": draw(needs)} for word, number in pieces]
    pairs = list(combinations(range(len(nodes)), 2))
    edges = draw(st.lists(st.sampled_from(pairs), max_size=6)) if pairs else []
    return {"nodes": nodes, "edges": [list(pair) for pair in edges]}


@tries(80, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(graphs(), min_size=1, max_size=4), st.sampled_from(["canonical", "aligned"]))
async def test_every_graph_is_found_in_the_merged_one_with_edges_and_needs(
    app: FastAPI, sent: list[dict[str, Any]], method: str
) -> None:
    answer = await ask(app, "/v1/layout-graphs/merge", {"graphs": sent, "method": method})
    merged = Merged.model_validate(answer.json())
    edges = set(merged.graph.edges)
    assert all(first < second for first, second in edges)
    for graph, places in zip(sent, merged.instance_maps, strict=True):
        assert len(set(places)) == len(places) == len(graph["nodes"])
        for node, place in zip(graph["nodes"], places, strict=True):
            assert merged.graph.nodes[place].category == canonical(node["category"])
            assert set(node["needs"]) <= set(merged.graph.nodes[place].needs)
        for first, second in graph["edges"]:
            assert tuple(sorted((places[first], places[second]))) in edges
    counts = [Counter(canonical(node["category"]) for node in graph["nodes"]) for graph in sent]
    most = {word: max(count[word] for count in counts) for count in counts for word in count}
    assert Counter(node.category for node in merged.graph.nodes) == most


async def test_the_answer_is_a_question_for_a_room(app: FastAPI) -> None:
    graph = {"nodes": [{"category": "sofa", "needs": ["sit"]}, {"category": "bookshelf"}], "edges": [[0, 1]]}
    merged = (await ask(app, "/v1/layout-graphs/merge", {"graphs": [graph, graph]})).json()["graph"]
    query = {
        "nodes": [{name: node[name] for name in ("category", "instance", "needs")} for node in merged["nodes"]],
        "edges": merged["edges"],
    }
    answer = await ask(app, "/v1/layouts/retrieve", {"graph": query, "k": 1})
    assert answer.status_code == 200
    assert answer.json()["matches"][0]["missing"] == []


@for_each(
    ("body", "pointer"),
    [
        ({"graphs": []}, "/graphs"),
        ({"graphs": [{"nodes": [{"category": "sofa"}]}] * 13}, "/graphs"),
        ({"graphs": [{"nodes": []}]}, "/graphs/0/nodes"),
        ({"graphs": [{"nodes": [{"category": "sofa"}] * 2}]}, "/graphs/0/nodes/1"),
        ({"graphs": [{"nodes": [{"category": "sofa"}], "edges": [[0, 1]]}]}, "/graphs/0/edges/0"),
        ({"graphs": [{"nodes": [{"category": "sofa"}], "edges": [[0]]}]}, "/graphs/0/edges/0"),
        ({"graphs": [{"nodes": [{"category": "sofa"}], "edges": [[0, 99]]}]}, "/graphs/0/edges/0/1"),
        ({"graphs": [{"nodes": [{"category": "sofa", "instance": 0}]}]}, "/graphs/0/nodes/0/instance"),
        ({"graphs": [{"nodes": [{"category": "sofa"}]}], "method": "magic"}, "/method"),
    ],
)
async def test_what_is_wrong_with_a_graph_is_named_by_its_place(app: FastAPI, body: Any, pointer: str) -> None:
    problem = check_problem(await ask(app, "/v1/layout-graphs/merge", body), 422)
    assert problem["errors"][0]["pointer"] == pointer


def hostile(kinds: int, size: int, edges: int) -> dict[str, Any]:
    """Many alike pieces with many relations: what makes aligning and searching slow."""
    words = ("armchair", "dining_chair", "office_chair", "stool", "plant", "vase", "lamp", "picture")[:kinds]
    nodes = [{"category": words[i % kinds], "instance": i // kinds + 1} for i in range(size)]
    return {"nodes": nodes, "edges": [list(pair) for pair in list(combinations(range(size), 2))[-edges:]]}


@pytest.mark.sweep
@pytest.mark.parametrize("kinds", [1, 4])
async def test_the_worst_that_may_be_asked_ends_in_seconds(app: FastAPI, kinds: int) -> None:
    started = time.process_time()
    merging = {"graphs": [hostile(kinds, 52, 25)] * 12, "method": "aligned"}
    assert (await ask(app, "/v1/layout-graphs/merge", merging)).status_code == 200
    searching = {"graph": hostile(kinds, 52, 200), "k": 50}
    assert (await ask(app, "/v1/layouts/retrieve", searching)).status_code == 200
    assert (await ask(app, "/v1/layouts/retrieve", searching | {"max_rooms": 4})).status_code == 200
    assert time.process_time() - started < 60
    too_much = {"graphs": [hostile(kinds, 52, 200)] * 2}
    assert check_problem(await ask(app, "/v1/layout-graphs/merge", too_much), 422)["errors"][0]["pointer"] == "/graphs"
