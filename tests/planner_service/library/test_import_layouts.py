"""Scene files of other formats over HTTP: their rooms come in whole with a report, or not at all with a reason."""

from __future__ import annotations

import asyncio
import gzip
import hashlib
import json
import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import httpx
import pytest
from databases import DATABASES
from fastapi import FastAPI
from for_each import for_each
from layers import sampled
from service_app import app_on, calling, check_problem

from planner_service.api.layouts.endpoints import MAX_ROOMS
from planner_service.api.layouts.schemas import LayoutsImported
from planner_service.api.rate_limit import LARGER

BINARY = {"Content-Type": "application/octet-stream"}


def house(bed: str = "Bed_13") -> dict[str, Any]:
    """A ProcTHOR house of one room with a bed and a thing that is no furniture."""
    corners = [(0, 0), (0, 3.5), (4, 3.5), (4, 0)]
    wall = [{"x": x, "y": y, "z": 0} for x, y in ((0, 0), (4, 0), (0, 2.7), (4, 2.7))]
    floor = [{"x": x, "y": 0, "z": z} for x, z in corners]
    return {
        "rooms": [{"id": "room|2", "roomType": "Bedroom", "floorPolygon": floor}],
        "walls": [{"id": "wall|2|0|0|4|0", "roomId": "room|2", "polygon": wall}],
        "doors": [
            {
                "id": "door|1|2", "room0": "room|2", "room1": "room|2", "wall0": "wall|2|0|0|4|0",
                "assetId": "Doorway_1", "holePolygon": [{"x": 0.4, "y": 0, "z": 0}, {"x": 1.3, "y": 2.1, "z": 0}],
            }
        ],
        "objects": [
            {
                "id": "2|0", "assetId": bed, "position": {"x": 3.0, "y": 0.45, "z": 2.2},
                "rotation": {"x": 0, "y": 180, "z": 0}, "kinematic": True, "children": [],
            },
            {
                "id": "2|1", "assetId": "Chair_1", "position": {"x": "far", "y": 0.45, "z": 2.2},
                "rotation": {"x": 0, "y": 0, "z": 0}, "kinematic": True, "children": [],
            },
        ],
    }  # fmt: skip


def room(name: str, category: str) -> dict[str, Any]:
    """A room of our own with a bed and a thing of some name."""
    bed = {"id": "bed", "category": "double_bed", "position": [0, 0, 0], "size": [1.6, 0.6, 2]}
    thing = {"id": "<img onerror=x>", "category": category, "position": [1.5, 0, 1.5], "size": [0.5, 0.5, 0.5]}
    corners = [[-2, -2], [-2, 2], [2, 2], [2, -2]]
    return {"id": name, "room_type": "bedroom", "floor_polygon": corners, "objects": [bed, thing]}


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def app(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FastAPI]:
    with app_on(tmp_path_factory.mktemp("importing"), rate="1000000/minute") as app:
        yield app


async def send(app: FastAPI, format_name: str, body: bytes, **options: Any) -> httpx.Response:
    async with calling(app) as client:
        query = {"format": format_name} | options
        return await client.post("/v1/layouts", params=query, content=body, headers=BINARY)


@pytest.mark.anyio
async def test_a_house_comes_in_with_a_report_and_its_rooms_are_there(app: FastAPI) -> None:
    answer = await send(app, "procthor", gzip.compress(json.dumps(house()).encode()))
    assert answer.status_code == 201, answer.text
    taken = LayoutsImported.model_validate(answer.json())
    (room,) = taken.items
    assert room.room_type == "bedroom"
    assert taken.report.rooms == 1
    assert taken.report.objects == {"double_bed": 1} or taken.report.objects == {"single_bed": 1}
    assert sum(dropped.count for dropped in taken.report.dropped) == 1
    assert taken.report.estimated
    async with calling(app) as client:
        shown = (await client.get(room.links.self)).json()
    assert [placed["category"] for placed in shown["objects"]] == list(taken.report.objects)
    assert any(spot["affordance"] == "lie" and spot["usable"] for spot in shown["spots"])
    # Its ids are taken now: a second time nothing comes in.
    check_problem(await send(app, "procthor", json.dumps(house()).encode()), 409)


@pytest.mark.anyio
@for_each(
    ("format_name", "body", "status", "told"),
    [
        ("procthor", b"", 422, "not JSON"),
        ("procthor", b"\x1f\x8b\x08 cut off", 422, "cut off"),
        ("procthor", b'{"rooms": 3}', 422, "rooms"),
        ("glb", b"glTF", 422, "body"),
        ("3d-front", b"[1, 2", 422, "not JSON"),
        ("hologram", b"{}", 422, "3d-front"),
        ("native", b"{}", 415, "application/json"),
    ],
)
async def test_what_is_no_scene_is_refused_by_name(
    app: FastAPI, format_name: str, body: bytes, status: int, told: str
) -> None:
    before = len(app.state.parts.shelves.rooms())
    assert told in json.dumps(check_problem(await send(app, format_name, body), status))
    assert len(app.state.parts.shelves.rooms()) == before


@pytest.mark.sweep
@pytest.mark.anyio
async def test_a_small_file_that_unpacks_to_a_huge_one_is_refused(app: FastAPI) -> None:
    bomb = gzip.compress(b"[" + b" " * (200 << 20))
    assert len(bomb) < 1 << 20
    assert "larger than" in check_problem(await send(app, "procthor", bomb), 422)["detail"]


@pytest.mark.anyio
async def test_a_scene_file_may_be_larger_than_other_bodies_but_not_endless(app: FastAPI) -> None:
    (most,) = LARGER.values()
    check_problem(await send(app, "procthor", b" " * (5 << 20)), 422)
    check_problem(await send(app, "procthor", b" " * (most + 1)), 413)
    large = json.dumps({"id": "x" * (5 << 20)}).encode()
    async with calling(app) as client:
        check_problem(
            await client.post("/v1/layouts", content=large, headers={"Content-Type": "application/json"}), 413
        )


@pytest.mark.anyio
@pytest.mark.parametrize("database", DATABASES)
async def test_one_file_sent_many_times_at_once_comes_in_once(
    tmp_path: Path, database: str, request: pytest.FixtureRequest
) -> None:
    url = request.getfixturevalue("postgres_url") if database == "postgresql" else ""
    body = "\n".join(json.dumps(house()) for _ in range(3)).encode()
    with app_on(tmp_path, database_url=url, rate="1000000/minute") as app:
        answers = await asyncio.gather(*(send(app, "procthor", body) for _ in range(6)))
        assert sorted(answer.status_code for answer in answers) == [201, *[409] * 5]
        mine = [name for name in app.state.parts.shelves.rooms() if name.startswith("body/")]
        assert mine == ["body/0/2", "body/1/2", "body/2/2"]


@pytest.mark.anyio
async def test_rooms_that_do_not_all_come_in_do_not_come_in_at_all(app: FastAPI) -> None:
    first = await send(app, "procthor", json.dumps(house()).encode(), name="flat.json")
    assert first.json()["items"][0]["id"] == "flat/0/2"
    before = len(app.state.parts.shelves.rooms())
    two = f"{json.dumps(house())}\n{json.dumps(house())}\n".encode()
    assert "flat/0/2" in check_problem(await send(app, "procthor", two, name="flat.json"), 409)["detail"]
    assert len(app.state.parts.shelves.rooms()) == before
    taken = LayoutsImported.model_validate((await send(app, "procthor", two, name="flat.json", scan="1")).json())
    assert [item.id for item in taken.items] == ["flat/1/2"]


@pytest.mark.anyio
async def test_a_file_of_more_rooms_than_one_call_takes_is_refused(app: FastAPI) -> None:
    many = f"{json.dumps(house())}\n".encode() * (MAX_ROOMS + 1)
    assert "scan 0-99" in check_problem(await send(app, "procthor", many, name="many"), 422)["detail"]


@pytest.mark.anyio
@pytest.mark.parametrize(
    "name", sampled(["../../etc/passwd", "<script>", "\u202e\x1b[2J", "x" * 120, "drawing.svg"], 3)
)
async def test_whatever_a_file_is_called_its_rooms_have_plain_ids(app: FastAPI, name: str) -> None:
    answer = await send(app, "procthor", json.dumps(house()).encode(), name=name)
    assert answer.status_code == 201, answer.text
    [item] = answer.json()["items"]
    assert re.fullmatch(r"[A-Za-z0-9_.:/-]{1,120}", item["id"])
    assert ".." not in item["id"]
    async with calling(app) as client:
        for link in item["links"].values():
            assert (await client.get(link)).status_code == 200


@pytest.mark.anyio
@pytest.mark.parametrize(
    "word",
    sampled(["<script>alert(1)</script>", "$\\frac{$", "]]>", "&amp;\"'", "椅子 🪑", "word " * 39 + "words"], 6),
)
async def test_a_drawing_holds_names_as_text_and_runs_nothing(app: FastAPI, word: str) -> None:
    name = hashlib.sha256(word.encode()).hexdigest()[:12]
    async with calling(app) as client:
        assert (await client.post("/v1/layouts", json=room(name, word))).status_code == 201
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Glyph")
            answers = [await client.get(f"/v1/layouts/{name}/drawing.{ending}") for ending in ("svg", "png")]
    assert [answer.status_code for answer in answers] == [200, 200]
    svg = answers[0]
    assert "default-src 'none'" in svg.headers["content-security-policy"]
    tags = {element.tag.rpartition("}")[2] for element in ElementTree.fromstring(svg.content).iter()}
    assert "text" in tags
    assert tags.isdisjoint({"script", "foreignObject", "image", "a"})


@pytest.mark.anyio
@for_each("body", [b'{"id": ' + b"9" * 5000 + b"}", b"[" * 100_000, b'{"id": "\xff"}', b"NaN"])
async def test_json_that_no_program_reads_is_malformed_and_no_fault_of_ours(app: FastAPI, body: bytes) -> None:
    async with calling(app) as client:
        answer = await client.post("/v1/layouts", content=body, headers={"Content-Type": "application/json"})
    check_problem(answer, answer.status_code)
    assert answer.status_code in (400, 422)
