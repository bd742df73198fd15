"""Short scripts over HTTP: listed, searched by meaning, added and deleted; the command line sees the same."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from examples import tries
from fastapi import FastAPI
from for_each import for_each
from forking import Forked
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from service_app import app_on, calling, check_problem, warm_app_on

from planner_service.api.scripts.schemas import (
    EXAMPLE,
    ShortScriptPage,
    ShortScriptsFound,
    ShortScriptShown,
    ShortScriptVersions,
)
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import ShortScript

pytestmark = pytest.mark.anyio
OURS = built_in()[0]


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def app(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FastAPI]:
    with warm_app_on(tmp_path_factory.mktemp("short_scripts"), rate="1000000/minute") as app:
        yield app


async def ask(app: FastAPI, path: str = "", method: str = "GET", **options: Any) -> httpx.Response:
    async with calling(app, timeout=60) as client:
        return await client.request(method, f"/v1/short-scripts{path}", **options)


async def test_pages_hold_every_script_once_in_the_order_of_ids(app: FastAPI) -> None:
    met: list[str] = []
    cursor: str | None = ""
    while cursor is not None:
        page = ShortScriptPage.model_validate((await ask(app, f"?limit=90&cursor={cursor}" if cursor else "")).json())
        assert all(item.built_in and item.source == "authored" and item.licence == "MIT" for item in page.items)
        met += [item.id for item in page.items]
        cursor = page.next
    assert met == sorted(script.id for script in built_in())


async def test_a_list_keeps_to_the_emotion_and_room_asked_for(app: FastAPI) -> None:
    page = ShortScriptPage.model_validate((await ask(app, "?limit=100&emotion=sad&room=bedroom")).json())
    wanted = sorted(s.id for s in built_in() if (s.emotion, s.room) == ("sad", "bedroom"))
    assert [item.id for item in page.items] == wanted


async def test_a_script_added_is_listed_shown_and_deleted_again(app: FastAPI) -> None:
    answer = await ask(app, method="POST", json=EXAMPLE)
    assert answer.status_code == 201, answer.text
    assert answer.headers["location"] == f"/v1/short-scripts/{EXAMPLE['id']}"
    shown = ShortScriptShown.model_validate(answer.json())
    assert not shown.built_in
    assert ShortScript.model_validate(shown.model_dump(exclude={"built_in"})) == ShortScript.model_validate(EXAMPLE)
    assert (await ask(app, f"/{EXAMPLE['id']}")).json() == answer.json()
    check_problem(await ask(app, method="POST", json=EXAMPLE), 409)
    assert (await ask(app, f"/{EXAMPLE['id']}", "DELETE")).status_code == 204
    for method in ("GET", "DELETE"):
        check_problem(await ask(app, f"/{EXAMPLE['id']}", method), 404)


async def test_ours_cannot_be_deleted_nor_its_id_taken(app: FastAPI) -> None:
    check_problem(await ask(app, f"/{OURS.id}", "DELETE"), 409)
    check_problem(await ask(app, method="POST", json=EXAMPLE | {"id": OURS.id}), 409)
    assert (await ask(app, f"/{OURS.id}")).status_code == 200


async def test_who_has_a_script_is_not_sent_it_again(app: FastAPI) -> None:
    first = await ask(app, f"/{OURS.id}")
    again = await ask(app, f"/{OURS.id}", headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")


async def test_the_nearest_scripts_come_first_and_those_of_users_are_among_them(app: FastAPI) -> None:
    own = EXAMPLE | {"id": "zebra", "summary": "The character rides a zebra through the living room."}
    await ask(app, method="POST", json=own)
    query = {"q": "riding a zebra through the room", "k": "4", "room": "living_room"}
    answer = await ask(app, "/search", params=query)
    found = ShortScriptsFound.model_validate(answer.json())
    assert found.encoder == app.state.parts.shelves.scripts().encoder.name
    assert found.items[0].short_script.id == "zebra"
    assert [item.score for item in found.items] == sorted((item.score for item in found.items), reverse=True)
    assert {item.short_script.room for item in found.items} == {"living_room"}
    await ask(app, "/zebra", "DELETE")
    left = ShortScriptsFound.model_validate((await ask(app, "/search", params=query)).json())
    assert left.items[0].short_script.id != "zebra"


async def listed(app: FastAPI, query: str) -> set[str]:
    answer = await ask(app, f"/export{query}")
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"].startswith("application/jsonl")
    return {ShortScript.model_validate_json(line).id for line in answer.text.splitlines()}


async def test_lists_searches_and_exports_keep_to_the_same_choice(app: FastAPI) -> None:
    ours = built_in()
    for query, wanted in {
        "?furniture=nightstand": {s.id for s in ours if any(k.piece[0] == "nightstand" for k in s.keyframes)},
        "?emotion=sad&room=bedroom": {s.id for s in ours if (s.emotion, s.room) == ("sad", "bedroom")},
        "?source=video": set(),
        "?licence=MIT": {s.id for s in ours if s.licence == "MIT"},
        "?own=true": set(),
        "": {s.id for s in ours},
    }.items():
        assert await listed(app, query) == wanted
    both = await listed(app, "?furniture=bed&furniture=wardrobe")
    assert both == await listed(app, "?furniture=bed") & await listed(app, "?furniture=wardrobe")
    page = (await ask(app, "?furniture=bed&furniture=wardrobe&limit=100")).json()
    assert {item["id"] for item in page["items"]} == set(sorted(both)[:100])
    found = (await ask(app, "/search?q=getting+dressed&k=3&furniture=bed&furniture=wardrobe&licence=MIT")).json()
    assert len(found["items"]) == 3
    assert {item["short_script"]["id"] for item in found["items"]} <= both


async def test_a_script_is_changed_by_its_version_and_the_older_ones_stay(app: FastAPI) -> None:
    path = f"/{EXAMPLE['id']}"
    await ask(app, method="POST", json=EXAMPLE)
    etag = (await ask(app, path)).headers["etag"]
    changed = EXAMPLE | {"summary": "The character waters all plants.", "version": 1}
    answer = await ask(app, path, "PUT", json=changed, headers={"If-Match": etag})
    assert (answer.status_code, answer.json()["version"]) == (200, 2)
    assert (await ask(app, path, "PUT", json=changed)).json() == answer.json()
    check_problem(await ask(app, path, "PUT", json=EXAMPLE | {"summary": "Another."}), 409)
    check_problem(await ask(app, path, "PUT", json=answer.json() | {"built_in": False}), 422)
    late = EXAMPLE | {"summary": "Another.", "version": 2}
    check_problem(await ask(app, path, "PUT", json=late, headers={"If-Match": etag}), 409)
    assert (await ask(app, path)).json() == answer.json()
    assert (await ask(app, f"{path}?version=1")).json()["summary"] == EXAMPLE["summary"]
    versions = ShortScriptVersions.model_validate((await ask(app, f"{path}/versions")).json())
    assert [(one.version, one.summary) for one in versions.items] == [
        (1, EXAMPLE["summary"]), (2, changed["summary"]),
    ]  # fmt: skip
    check_problem(await ask(app, f"{path}?version=3"), 404)
    await ask(app, path, "DELETE")
    for gone in (path, f"{path}?version=1", f"{path}/versions"):
        check_problem(await ask(app, gone), 404)
    check_problem(await ask(app, path, "PUT", json=EXAMPLE), 404)


async def test_ours_cannot_be_changed_nor_one_under_the_path_of_another(app: FastAPI) -> None:
    mine = EXAMPLE | {"id": OURS.id}
    check_problem(await ask(app, f"/{OURS.id}", "PUT", json=mine), 409)
    assert check_problem(await ask(app, f"/{OURS.id}", "PUT", json=EXAMPLE), 422)["errors"][0]["pointer"] == "/id"
    assert [one["version"] for one in (await ask(app, f"/{OURS.id}/versions")).json()["items"]] == [1]


async def test_what_comes_from_a_film_says_its_licence_and_an_export_counts_the_unknown(app: FastAPI) -> None:
    film = EXAMPLE | {"id": "from-a-film", "source": "video", "origin": {"name": "A film", "start": 1, "end": 4}}
    assert check_problem(await ask(app, method="POST", json=film), 422)["errors"][0]["pointer"] == "/licence"
    for licence in ("CC-BY-4.0", "unknown"):
        row = film | {"id": f"from-a-film-{licence[:2].lower()}", "licence": licence}
        assert (await ask(app, method="POST", json=row)).status_code == 201
    whole = await ask(app, "/export?own=true&source=video")
    rows = [json.loads(line) for line in whole.text.splitlines()]
    assert whole.headers["sims-licence-unknown"] == "1"
    assert [(row["licence"], row["origin"]["end"], row["version"]) for row in rows] == [
        ("CC-BY-4.0", 4.0, 1), ("unknown", 4.0, 1),
    ]  # fmt: skip
    assert await listed(app, "?own=true&licence=CC-BY-4.0") == {"from-a-film-cc"}
    for row in rows:
        await ask(app, f"/{row['id']}", "DELETE")


@for_each(
    ("query", "pointer"),
    [
        ("?furniture=spaceship", "?furniture"),
        ("/export?furniture=", "?furniture"),
        ("?source=hearsay", "?source"),
        ("/insomnia-at-three?version=0", "?version"),
        ("?limit=0", "?limit"),
        ("?cursor=nonsense!", "?cursor"),
        ("?emotion=bored", "?emotion"),
        ("?room=attic", "?room"),
        ("/search", "?q"),
        ("/search?q=", "?q"),
        ("/search?q=%20", "?q"),
        (f"/search?q={'x' * 3000}", "?q"),
        ("/search?q=x&k=0", "?k"),
        ("/search?q=x&k=101", "?k"),
        ("/search?q=x&emotion=bored", "?emotion"),
    ],
)
async def test_a_question_that_cannot_be_is_refused(app: FastAPI, query: str, pointer: str) -> None:
    assert check_problem(await ask(app, query), 422)["errors"][0]["pointer"] == pointer


def with_keyframe(**fields: Any) -> dict[str, Any]:
    return EXAMPLE | {"keyframes": [EXAMPLE["keyframes"][0], EXAMPLE["keyframes"][1] | fields]}


@for_each(
    ("body", "pointer"),
    [
        (with_keyframe(furniture="spaceship"), "/keyframes/1/furniture"),
        (with_keyframe(emotion="purple"), "/keyframes/1/emotion"),
        (with_keyframe(skill="fly"), "/keyframes/1/skill"),
        (with_keyframe(colour="red"), "/keyframes/1/colour"),
        (EXAMPLE | {"keyframes": []}, "/keyframes"),
        (EXAMPLE | {"id": "Not A Slug"}, "/id"),
        (EXAMPLE | {"id": "search"}, "/id"),
        (EXAMPLE | {"mood": "blue"}, "/mood"),
        (EXAMPLE | {"summary": ""}, "/summary"),
        ({name: value for name, value in EXAMPLE.items() if name != "room"}, "/room"),
        (EXAMPLE | {"graph": {"nodes": [["sofa", 1]], "edges": [[0, 1]]}}, "/graph/edges"),
        (EXAMPLE | {"graph": {"nodes": [["sofa", True]]}}, "/graph/nodes/0/1"),
        (EXAMPLE | {"graph": {"nodes": [["sofa", 1]] * 25}}, "/graph/nodes"),
        ([EXAMPLE], ""),
    ],
)
async def test_what_is_wrong_with_a_script_is_named_by_its_place(app: FastAPI, body: Any, pointer: str) -> None:
    assert check_problem(await ask(app, method="POST", json=body), 422)["errors"][0]["pointer"] == pointer


WILD = st.none() | st.integers() | st.text(max_size=30) | st.sampled_from([[], {}, "\ud800", "\0", "sofa 2", 1.5])


@tries(120, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.dictionaries(st.sampled_from(sorted(EXAMPLE)), WILD, max_size=2),
    st.dictionaries(st.sampled_from(["skill", "emotion", "caption", "furniture"]), WILD, max_size=2),
)
async def test_a_damaged_script_never_breaks_the_service(
    app: FastAPI, fields: dict[str, Any], keyframe: dict[str, Any]
) -> None:
    body = with_keyframe(**keyframe) | {"graph": {"nodes": [["sofa", 1]], "edges": [[0, 0]]}} | fields
    answer = await ask(app, method="POST", content=json.dumps(body), headers={"Content-Type": "application/json"})
    if answer.status_code == 201:
        script_id = answer.json()["id"]
        assert (await ask(app, f"/{script_id}")).json() == answer.json()
        app.state.parts.shelves.remove_script(script_id)
    else:
        check_problem(answer, answer.status_code)
        assert answer.status_code in (400, 409, 422)


@pytest.mark.service
def test_the_command_line_and_the_service_share_one_library(tmp_path: Path) -> None:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("SIMS_")}
    environment |= {"SIMS_DATA_DIR": str(tmp_path / "data"), "OMP_NUM_THREADS": "1"}
    file = tmp_path / "mine.json"
    file.write_text(json.dumps(EXAMPLE), encoding="utf-8")

    def sims(*words: str) -> str:
        code, output, error = forked.run(words, tmp_path, environment)
        assert code == 0, error.decode()
        return output.decode()

    with Forked() as forked, app_on(tmp_path / "data") as app:
        shelves = app.state.parts.shelves
        before = len(shelves.scripts())
        assert f"the library has {before + 1} scripts" in sims("scripts", "add", str(file))
        assert shelves.scripts().get(str(EXAMPLE["id"])).summary == EXAMPLE["summary"]
        assert f"the library has {before} scripts" in sims("scripts", "remove", str(EXAMPLE["id"]))
        assert len(shelves.scripts()) == before
        sims("layouts", "generate", "--count", "1", "--seed", "1000", "--out", "rooms.jsonl")
        assert "bedroom-1000: all can be used" in sims("layouts", "import", "rooms.jsonl")
        assert "bedroom-1000" in shelves.rooms()
        assert "bedroom-1000" in sims("layouts", "list", "--room", "bedroom")
