"""Rooms over HTTP: listed, looked over, added, retrieved; whatever is sent is read or refused by name."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from examples import tries
from fastapi import FastAPI
from for_each import for_each
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from service_app import app_on, calling, check_problem

from motion_backend.formats.gltf_document import read_glb
from planner_service.api.layouts.schemas import EXAMPLE, HomeMatch, LayoutMatches, LayoutPage, LayoutShown
from planner_service.api.layouts.views import problem_of
from planner_service.grounding.room_report import MAX_CELLS, survey
from scene_graphs.affordances.room_validation import RoomCheck
from scene_graphs.errors import FieldPath
from scene_graphs.generation.generate_room import generate_room
from scene_graphs.graph.furniture_graph import graph_from_layout, graph_from_uses
from scene_graphs.home import home_from_dict, home_from_layouts, home_to_dict
from scene_graphs.layout import LayoutError, layout_from_dict, layout_to_dict
from scene_graphs.layout_library import built_in_layouts
from scene_graphs.plots.floor_plan import EDGE_COLOR
from scene_graphs.retrieval.layout_index import LayoutIndex

ROOM = layout_to_dict(generate_room("living_room", 3)) | {"id": "mine"}
HOME = home_to_dict(home_from_layouts([generate_room("study", 1), generate_room("bedroom", 2)], 0))
QUERY = {"nodes": [{"category": "couch", "needs": ["sit"]}, {"category": "bookcase"}], "edges": [[0, 1]]}


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def app(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FastAPI]:
    with app_on(tmp_path_factory.mktemp("layouts"), rate="1000000/minute") as app:
        yield app


async def ask(app: FastAPI, path: str, method: str = "GET", **options: Any) -> httpx.Response:
    async with calling(app) as client:
        return await client.request(method, path, **options)


@pytest.mark.anyio
async def test_pages_hold_every_room_once_in_the_order_of_ids(app: FastAPI) -> None:
    met: list[str] = []
    cursor: str | None = ""
    while cursor is not None:
        query = {"limit": "77"} | ({"cursor": cursor} if cursor else {})
        page = LayoutPage.model_validate((await ask(app, "/v1/layouts", params=query)).json())
        met += [item.id for item in page.items]
        cursor = page.next
    assert met == sorted(app.state.parts.shelves.rooms())


@pytest.mark.anyio
async def test_rooms_of_a_type_are_those_that_can_serve_as_it(app: FastAPI) -> None:
    page = LayoutPage.model_validate((await ask(app, "/v1/layouts?limit=100&room=library")).json())
    assert len(page.items) >= 60
    assert all("study" in (item.room_type, *item.tags) for item in page.items)
    assert all(item.built_in and item.licence == "MIT" for item in page.items if item.source == "generated")


@pytest.mark.anyio
@pytest.mark.parametrize("name", ["living-room-0016", "study-0003", "bedroom-0020"])
async def test_a_room_is_shown_whole_with_what_can_be_done_in_it(app: FastAPI, name: str) -> None:
    layout = next(one for one in built_in_layouts() if one.id == name)
    answer = await ask(app, f"/v1/layouts/{name}")
    shown = LayoutShown.model_validate(answer.json())
    assert layout_from_dict(answer.json()) == layout
    assert shown.problems == []
    check = RoomCheck(layout)
    usable = {(spot.object_id, spot.affordance) for spot in shown.spots if spot.usable}
    for placed in layout.objects:
        for affordance in ("sit", "lie", "touch"):
            if (placed.id, affordance) in usable:
                assert next(check.usable(placed, affordance), None) is not None
    graph = graph_from_layout(layout)
    named = [(node.category, node.instance, node.object_id) for node in shown.graph.nodes]
    assert named == [(node.category, node.instance, graph.nodes[node]["object_id"]) for node in graph]
    assert len(shown.graph.edges) == len(graph.edges)
    nodes = list(graph)
    assert all(graph.has_edge(nodes[one], nodes[other]) for one, other in shown.graph.edges)


@pytest.mark.anyio
@pytest.mark.parametrize("path", ["/v1/layouts/study-0003", "/v1/layouts/study-0003/scene.glb"])
async def test_who_has_a_room_is_not_sent_it_again(app: FastAPI, path: str) -> None:
    first = await ask(app, path)
    etag = first.headers["etag"]
    again = await ask(app, path, headers={"If-None-Match": etag})
    assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", etag)
    assert (await ask(app, path, headers={"If-None-Match": '"other"'})).content == first.content


@pytest.mark.anyio
async def test_the_scene_of_a_room_holds_its_furniture(app: FastAPI) -> None:
    answer = await ask(app, "/v1/layouts/living-room-0016/scene.glb")
    assert answer.headers["content-type"] == "model/gltf-binary"
    names = {node.get("name") for node in read_glb(answer.content)[0]["nodes"]}
    assert {"floor", "wall", "door", "furniture"} <= names


@pytest.mark.anyio
@for_each("name", ["nothing", "study-0003/x", "x" * 300, "scene.glb", "%00", "..%2f..", "study-0003/"])
async def test_a_room_that_is_not_there_is_a_404(app: FastAPI, name: str) -> None:
    for path in (f"/v1/layouts/{name}", f"/v1/layouts/{name}/scene.glb"):
        check_problem(await ask(app, path), 404)


@pytest.mark.anyio
async def test_a_room_that_was_added_is_there_with_what_was_checked(app: FastAPI) -> None:
    blocked = copy.deepcopy(EXAMPLE) | {"id": "house/blocked"}
    blocked["objects"].append(blocked["objects"][0] | {"id": "twin"})
    for row, found in ((EXAMPLE, []), (blocked, ["armchair_1 and twin overlap"])):
        answer = await ask(app, "/v1/layouts?format=native", "POST", json=row)
        assert answer.status_code == 201, answer.text
        assert answer.headers["location"] == f"/v1/layouts/{row['id']}"
        shown = LayoutShown.model_validate(answer.json())
        assert [problem for problem in shown.problems if "overlap" in problem] == found
        assert not shown.built_in
        assert (await ask(app, answer.headers["location"])).json() == answer.json()
        assert (await ask(app, f"{answer.headers['location']}/scene.glb")).status_code == 200
        check_problem(await ask(app, "/v1/layouts", "POST", json=row), 409)


@pytest.mark.anyio
async def test_a_room_that_was_added_can_be_removed_and_ours_cannot(app: FastAPI) -> None:
    row = EXAMPLE | {"id": "house/soon-gone"}
    assert (await ask(app, "/v1/layouts", "POST", json=row)).status_code == 201
    assert (await ask(app, "/v1/layouts/house/soon-gone", "DELETE")).status_code == 204
    for method in ("GET", "DELETE"):
        check_problem(await ask(app, "/v1/layouts/house/soon-gone", method), 404)
    check_problem(await ask(app, "/v1/layouts/study-0003", "DELETE"), 409)
    assert (await ask(app, "/v1/layouts/study-0003")).status_code == 200


def changed(**fields: Any) -> dict[str, Any]:
    return copy.deepcopy(ROOM) | {"id": "bad"} | fields


def with_object(place: int, **fields: Any) -> dict[str, Any]:
    row = changed()
    row["objects"][place] |= fields
    return row


@pytest.mark.anyio
@for_each(
    ("row", "pointer"),
    [
        (with_object(1, size=[1, -1, 1]), "/objects/1/size/1"),
        (with_object(1, size=[1, 1]), "/objects/1/size"),
        (with_object(0, position=["a", 0, 0]), "/objects/0/position/0"),
        (with_object(2, parent="nobody"), "/objects/2/parent"),
        (with_object(2, colour="red"), "/objects/2/colour"),
        (with_object(1, id=ROOM["objects"][0]["id"]), "/objects/1/id"),
        (with_object(0, yaw=1e9), "/objects/0/yaw"),
        (with_object(0, category="\x07bell"), "/objects/0/category"),
        (changed(floor_polygon=[[0, 0], [4, 4], [4, 0], [0, 4]]), "/floor_polygon"),
        (changed(floor_polygon=[[0, 0], [0, 90], [90, 90], [90, 0]]), "/floor_polygon"),
        (changed(floor_polygon=[[0, 0], [0, 2000], [9, 9]]), "/floor_polygon/1/1"),
        (changed(height=0), "/height"),
        (changed(doors=[{"segment": [[0, 0], [1, 0]], "bottom": 2, "top": 1}]), "/doors/0/top"),
        (changed(id="a b"), "/id"),
        (changed(id="study-0000/scene.glb"), "/id"),
        (changed(mood="blue"), "/mood"),
        (changed(objects=[with_object(0)["objects"][0] | {"id": f"c{i}", "position": [0, 0, 0]} for i in range(400)]),
         "/objects"),
        ({}, "/id"),
        ([], ""),
        (7, ""),
    ],
)  # fmt: skip
async def test_what_is_wrong_with_a_room_is_named_by_its_place(app: FastAPI, row: Any, pointer: str) -> None:
    problem = check_problem(await ask(app, "/v1/layouts", "POST", json=row), 422)
    assert problem["errors"][0]["pointer"] == pointer


@pytest.mark.anyio
@for_each(
    ("query", "pointer"),
    [("limit=0", "?limit"), ("limit=101", "?limit"), ("limit=x", "?limit"), ("cursor=!!", "?cursor"),
     ("cursor=YWJj0", "?cursor"), ("cursor=", "?cursor"), ("room=", "?room")],
)  # fmt: skip
async def test_a_page_that_cannot_be_is_refused(app: FastAPI, query: str, pointer: str) -> None:
    problem = check_problem(await ask(app, f"/v1/layouts?{query}"), 422)
    assert problem["errors"][0]["pointer"] == pointer


@pytest.mark.anyio
async def test_the_nearest_rooms_are_those_of_the_index(app: FastAPI) -> None:
    asked = {"graph": QUERY, "k": 7, "rooms": ["living room", "study"]}
    matches = (await ask(app, "/v1/layouts/retrieve", "POST", json=asked)).json()["matches"]
    graph = graph_from_uses([("couch", 1), ("bookcase", 1)], [["sit"], []])
    index = LayoutIndex(tuple(app.state.parts.shelves.rooms().values()))
    ours = {m.layout_id: m for kind in ("living_room", "study") for m in index.search(graph, 7, kind)}
    best = sorted(ours.values(), key=lambda m: (m.distance, m.lower_bound, m.layout_id))[:7]
    assert [(m["layout_id"], m["distance"]) for m in matches] == [(m.layout_id, m.distance) for m in best]
    for match in matches:
        layout = index.layout(match["layout_id"])
        places = sorted([*(pair["node"] for pair in match["mapping"]), *match["missing"]])
        assert places == [0, 1]
        used = [pair["object_id"] for pair in match["mapping"]]
        assert sorted([*used, *match["extra"]]) == sorted(placed.id for placed in layout.objects)


WANTING = {
    "nodes": [{"category": "bed", "needs": ["lie"]}, {"category": "wardrobe"}, {"category": "dining table"},
              {"category": "chair", "needs": ["sit"]}, {"category": "piano"}, {"category": "desk", "needs": ["lie"]}],
    "edges": [[0, 1], [2, 3], [3, 4]],
}  # fmt: skip


@pytest.mark.anyio
@pytest.mark.parametrize("most", [1, 2, pytest.param(4, marks=pytest.mark.sweep)])
async def test_a_match_says_what_every_part_of_its_distance_is_for(app: FastAPI, most: int) -> None:
    asked = {"graph": WANTING, "k": 4, "max_rooms": most}
    answer = LayoutMatches.model_validate((await ask(app, "/v1/layouts/retrieve", "POST", json=asked)).json())
    assert len(answer.matches) == 4
    for match in answer.matches:
        costs = match.costs
        assert sum(costs.model_dump().values()) == match.distance
        assert costs.substitutions == sum(pair.cost for pair in match.mapping)
        assert len(match.substitutions) == sum(pair.level != "same" for pair in match.mapping)
        assert [reason.node for reason in match.reasons] == match.missing
        why = {reason.node: reason.why for reason in match.reasons}
        assert (why[4], why[5]) == ("absent", "unfit")
        assert next(reason.unmet for reason in match.reasons if reason.node == 5) == ["lie"]
        assert costs.lost_relations == 20 * len(match.lost)
        assert (3, 4) in match.lost
        assert match.explanation[0].startswith(f"graph distance {match.distance} = ")
        assert len(match.explanation) == 7 + len(match.lost)


@pytest.mark.anyio
async def test_of_homes_each_piece_is_in_a_room_that_is_named(app: FastAPI) -> None:
    rooms = app.state.parts.shelves.rooms()
    chairs = [{"category": "dining chair", "instance": number} for number in (1, 2, 3)]
    graph = {"nodes": [{"category": "bed"}, {"category": "wardrobe"}, {"category": "dining table"}, *chairs]}
    asked = {"graph": graph, "k": 3, "max_rooms": 2, "rooms": ["bedroom", "dining room"]}
    matches = (await ask(app, "/v1/layouts/retrieve", "POST", json=asked)).json()["matches"]
    alone = (await ask(app, "/v1/layouts/retrieve", "POST", json=asked | {"max_rooms": 1})).json()["matches"]
    assert matches[0]["distance"] < alone[0]["distance"]
    for match in matches:
        home = HomeMatch.model_validate(match)
        assert len(home.rooms) == 2
        assert all({"bedroom", "dining_room"} & set(rooms[room.layout_id].tags) for room in home.rooms)
        assert home.costs.more_rooms == 50
        there = {
            f"{place}/{piece.id}": piece.category
            for place, room in enumerate(home.rooms)
            for piece in rooms[room.layout_id].objects
        }
        assert all(there[pair.object_id] == pair.given for pair in home.mapping)
        assert sorted([*(pair.object_id for pair in home.mapping), *home.extra]) == sorted(there)


@pytest.mark.anyio
@for_each(
    ("body", "pointer"),
    [
        ({"graph": {"nodes": []}}, "/graph/nodes"),
        ({"graph": {"nodes": [{"category": "sofa"}] * 2}}, "/graph/nodes/1"),
        ({"graph": {"nodes": [{"category": " "}]}}, "/graph/nodes/0/category"),
        ({"graph": {"nodes": [{"category": "sofa"}], "edges": [[0, 1]]}}, "/graph/edges/0"),
        ({"graph": {"nodes": [{"category": "sofa"}], "edges": [[0, 0]]}}, "/graph/edges/0"),
        ({"graph": {"nodes": [{"category": "sofa", "instance": i + 1} for i in range(53)]}}, "/graph/nodes"),
        ({"graph": {"nodes": [{"category": "sofa", "needs": ["fly"]}]}}, "/graph/nodes/0/needs/0"),
        ({"graph": QUERY, "k": 51}, "/k"),
        ({"graph": QUERY, "rooms": ["attic"]}, "/rooms/0"),
        ({"graph": QUERY, "max_rooms": 5}, "/max_rooms"),
        ({"graph": QUERY, "max_rooms": 0}, "/max_rooms"),
        ({}, "/graph"),
    ],
)
async def test_a_query_that_cannot_be_is_refused_by_its_place(app: FastAPI, body: Any, pointer: str) -> None:
    problem = check_problem(await ask(app, "/v1/layouts/retrieve", "POST", json=body), 422)
    assert problem["errors"][0]["pointer"] == pointer


WILD = (
    st.none() | st.booleans() | st.integers(-(10**30), 10**30) | st.floats() | st.text(max_size=8)
    | st.lists(st.floats(-5, 5), max_size=4) | st.sampled_from([{}, [], "", 1e308, -0.0, 1e-12, 0, 30, 61, "0/sofa_1"])
)  # fmt: skip


def spread(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Every place in a JSON value."""
    yield path
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        yield from spread(inner, (*path, key))


@st.composite
def mutated(draw: st.DrawFn, whole: dict[str, Any]) -> dict[str, Any]:
    """A good row with one to three values replaced, left out or put in twice."""
    row = copy.deepcopy(whole)
    for _ in range(draw(st.integers(1, 3))):
        *path, last = draw(st.sampled_from(sorted((p for p in spread(row) if p), key=str)))
        inner = row
        for key in path:
            inner = inner[key]
        what = draw(st.sampled_from(["replace", "shift", "remove", "twice"]))
        if what == "shift" and isinstance(inner[last], float):
            inner[last] += draw(st.floats(-3, 3))
        elif what == "remove":
            del inner[last]
        elif what == "twice" and isinstance(inner, list):
            inner.append(copy.deepcopy(inner[last]))
        else:
            inner[last] = draw(WILD)
    return row


@tries(150)
@given(mutated(ROOM))
def test_a_damaged_room_is_refused_by_name_or_can_be_looked_over(row: dict[str, Any]) -> None:
    try:
        layout = layout_from_dict(row, FieldPath(("body",)))
    except LayoutError as error:
        problem = problem_of(error, "")
        assert problem.errors[0].pointer.startswith("/")
        assert problem.errors[0].detail
        return
    survey(layout)
    assert layout_from_dict(layout_to_dict(layout)) == layout
    assert len(json.dumps(layout_to_dict(layout), allow_nan=False)) < 100_000


@tries(150)
@given(mutated(HOME))
def test_a_damaged_home_is_refused_by_name_or_read(row: dict[str, Any]) -> None:
    try:
        home = home_from_dict(row, FieldPath(("body",)))
    except LayoutError as error:
        problem = problem_of(error, "/home")
        assert problem.errors[0].pointer.startswith("/home")
        return
    assert home_from_dict(home_to_dict(home)) == home


@pytest.mark.anyio
@tries(60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(mutated(ROOM))
async def test_a_damaged_room_never_breaks_the_service(app: FastAPI, row: dict[str, Any]) -> None:
    body = json.dumps(row).encode("utf-8", "surrogatepass")
    answer = await ask(app, "/v1/layouts", "POST", content=body, headers={"Content-Type": "application/json"})
    if answer.status_code == 201:
        LayoutShown.model_validate(answer.json())
        app.state.parts.shelves.remove_layout(row["id"])
    else:
        check_problem(answer, answer.status_code)
        assert answer.status_code in (400, 409, 422)


def test_a_room_as_large_as_can_be_is_looked_at_more_coarsely() -> None:
    corners = [[-30, -30], [-30, 30], [30, 30], [30, -30]]
    layout = layout_from_dict(EXAMPLE | {"floor_polygon": corners, "doors": []})
    assert survey(layout).problems == ()
    assert layout.area / MAX_CELLS > 0.05**2


@pytest.mark.anyio
async def test_a_room_is_drawn_as_svg_and_png_with_what_is_asked_for(app: FastAPI) -> None:
    links = (await ask(app, "/v1/layouts/bedroom-0001")).json()["links"]
    full = await ask(app, links["drawing"])
    assert full.headers["content-type"].startswith("image/svg+xml")
    bare = await ask(app, links["drawing"], params={"graph": "false", "spots": "false", "path": "false"})
    assert EDGE_COLOR in full.text
    assert EDGE_COLOR not in bare.text
    pixels = await ask(app, links["drawing"].replace(".svg", ".png"))
    assert pixels.content.startswith(b"\x89PNG")
    again = await ask(app, links["drawing"], headers={"If-None-Match": full.headers["etag"]})
    assert again.status_code == 304
    assert full.headers["etag"] != bare.headers["etag"]
    check_problem(await ask(app, links["drawing"], params={"to": "nothing"}), 422)
    check_problem(await ask(app, "/v1/layouts/nothing/drawing.svg"), 404)


@pytest.mark.anyio
async def test_a_room_may_say_of_which_boxes_a_piece_is_made(app: FastAPI) -> None:
    boxes = [["seat", [-0.4, 0.1, -0.2], [0.4, 0.5, 0.4]], ["back", [-0.4, 0.5, -0.4], [0.4, 0.9, -0.2]]]
    row = copy.deepcopy(EXAMPLE) | {"id": "house/shaped"}
    row["objects"][0]["shape"] = boxes
    answer = await ask(app, "/v1/layouts", "POST", json=row)
    assert answer.status_code == 201, answer.text
    shown = LayoutShown.model_validate(answer.json()).model_dump(exclude_unset=True)
    assert shown["objects"][0]["shape"] == boxes
    assert {spot["point"][1] for spot in shown["spots"] if spot["affordance"] == "sit"} == {0.5}
    row["objects"][0]["shape"][0][0] = "throne"
    problem = check_problem(await ask(app, "/v1/layouts", "POST", json=row | {"id": "house/throne"}), 422)
    assert problem["errors"][0]["pointer"].startswith("/objects/0/shape/0")
    assert "seat" in problem["detail"]


@pytest.mark.anyio
async def test_a_side_table_is_no_seat_and_a_book_nothing_to_touch(app: FastAPI) -> None:
    pieces = [
        ("side_table", [-1, 0, -1], [0.5, 0.42, 0.5]),
        ("stool", [1, 0, -1], [0.4, 0.42, 0.4]),
        ("book", [-1, 0, 1], [0.2, 0.9, 0.2]),
    ]
    rows = [{"id": word, "category": word, "position": at, "size": size} for word, at, size in pieces]
    answer = await ask(app, "/v1/layouts", "POST", json=EXAMPLE | {"id": "house/tables", "objects": rows})
    found = {(spot["object_id"], spot["affordance"]) for spot in answer.json()["spots"]}
    assert found == {("side_table", "touch"), ("stool", "sit"), ("stool", "touch")}
