"""What a client may get wrong about stories and motions: each has an answer that names the place and the remedy."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import httpx
import numpy as np
import pytest
from running import SHORT, RunningService, finished

from motion_backend.formats.motion_json import read_json
from motion_backend.formats.npz import read_raw
from planner_service.api.layouts.schemas import EXAMPLE

pytestmark = pytest.mark.service
WALK = {"skill": "loco", "caption": "walk", "furniture": "sofa"}
SIT = {"skill": "sitdown", "caption": "sit", "furniture": "sofa"}
ROOM = "living-room-0016"


@pytest.fixture(scope="module")
def client(service: RunningService) -> Iterator[httpx.Client]:
    with service.client() as client:
        yield client


@pytest.fixture(scope="module")
def story(client: httpx.Client) -> dict[str, Any]:
    return finished(client, client.post("/v1/stories", json={"theme": SHORT}).json()["id"])


def refused(answer: httpx.Response, pointer: str, status: int = 422) -> str:
    """The remedy of the first fault, which must be at the pointer."""
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    fault = answer.json()["errors"][0]
    assert fault["pointer"] == pointer
    return str(fault["detail"])


@pytest.mark.parametrize(
    ("body", "pointer"),
    [
        ({}, "/theme"),
        ({"theme": ""}, "/theme"),
        ({"theme": "   \n "}, "/theme"),
        ({"theme": "12345 !!"}, "/theme"),
        ({"theme": "a" * 2001}, "/theme"),
        ({"theme": 5}, "/theme"),
        ({"theme": SHORT, "colour": "red"}, "/colour"),
        ({"theme": SHORT, "rooms": ["kitchen"]}, "/rooms/0"),
        ({"theme": SHORT, "rooms": ["study"] * 5}, "/rooms"),
        ({"theme": SHORT, "layouts": ["no-such-room"]}, "/layouts/0"),
        ({"theme": SHORT, "layouts": [ROOM, ROOM]}, "/layouts"),
        ({"theme": SHORT, "home": {}}, "/home/rooms"),
        ({"theme": SHORT, "home": {"rooms": [{"layout": 5}]}}, "/home/rooms/0/layout"),
        ({"theme": SHORT, "short_scripts": 13}, "/short_scripts"),
        ({"theme": SHORT, "method": "magic"}, "/method"),
        ({"theme": SHORT, "backend": "magic"}, "/backend"),
        ({"theme": SHORT, "seed": -1}, "/seed"),
        ({"theme": SHORT, "seed": 2**53}, "/seed"),
        ({"theme": SHORT, "seed": True}, "/seed"),
        ({"theme": SHORT, "seed": "7"}, "/seed"),
        ({"theme": SHORT, "character": {"height": 3.0}}, "/character/height"),
        ({"theme": SHORT, "character": {"name": ""}}, "/character/name"),
        ({"theme": SHORT, "character": {"name": "\u0007"}}, "/character/name"),
        ({"theme": SHORT, "character": {"pronouns": "it"}}, "/character/pronouns"),
    ],
)
def test_a_story_that_cannot_be_is_refused_at_once(client: httpx.Client, body: dict[str, Any], pointer: str) -> None:
    before = client.get("/v1/stories?limit=1").json()["items"][:1]
    assert refused(client.post("/v1/stories", json=body), pointer)
    assert client.get("/v1/stories?limit=1").json()["items"][:1] == before


@pytest.mark.parametrize(
    ("body", "pointer"),
    [
        ({"keyframes": [WALK]}, "/layout_id"),
        ({"keyframes": [WALK], "layout_id": ROOM, "home": {"rooms": []}}, "/layout_id"),
        ({"keyframes": [WALK], "layout_id": "no-such-room"}, "/layout_id"),
        ({"keyframes": [], "layout_id": ROOM}, "/keyframes"),
        ({"keyframes": [WALK] * 61, "layout_id": ROOM}, "/keyframes"),
        ({"keyframes": [{**WALK, "skill": "fly"}], "layout_id": ROOM}, "/keyframes/0/skill"),
        ({"keyframes": [{**SIT, "skill": "standup"}], "layout_id": ROOM}, "/keyframes"),
    ],
)
def test_a_motion_that_cannot_be_is_refused_at_once(client: httpx.Client, body: dict[str, Any], pointer: str) -> None:
    assert refused(client.post("/v1/motions", json=body), pointer)


@pytest.mark.parametrize(
    ("query", "pointer"),
    [
        ("from=-1", "?from"),
        ("from=9&to=9", "?to"),
        ("from=x", "?from"),
        ("to=99999999999999999999", "?to"),
        ("format=fbx", "?format"),
        ("from=1000000", "?from"),
        ("frm=0", "?frm"),
    ],
)
def test_ranges_that_cannot_be_are_refused(
    client: httpx.Client, story: dict[str, Any], query: str, pointer: str
) -> None:
    assert refused(client.get(f"{story['links']['motion']}?{query}"), pointer)


@pytest.mark.parametrize("cursor", ["x", "-" * 36, "0" * 36, "' OR 1=1 --"])
def test_a_cursor_that_we_did_not_give_is_refused(client: httpx.Client, cursor: str) -> None:
    assert refused(client.get("/v1/stories", params={"cursor": cursor}), "?cursor")


@pytest.mark.parametrize("path", ["", "/events", "/home", "/motion", "/film.glb", "/scene.glb", "/props.glb"])
@pytest.mark.parametrize("story_id", ["nobody", "01a1fdcc-a358-79d2-b231-f62da6204b41", "..%2F..%2Fetc"])
def test_what_is_not_there_is_a_404(client: httpx.Client, story_id: str, path: str) -> None:
    answer = client.get(f"/v1/stories/{story_id}{path}")
    assert answer.status_code == 404
    assert answer.json()["status"] == 404


def test_frames_of_any_range_are_those_of_the_whole(client: httpx.Client, story: dict[str, Any]) -> None:
    whole = client.get(story["links"]["motion"], params={"format": "f32"})
    positions = read_raw(whole.content)
    assert len(positions) == story["motion"]["frames"] == int(whole.headers["sims-ready"])
    assert whole.headers["sims-complete"] == "true"
    ends = [keyframe["end"] for keyframe in story["keyframes"] if keyframe["end"]]
    for first, last in ((0, 1), (ends[0] - 1, ends[0] + 1), (ends[1], ends[1] + 40), (len(positions) - 5, 10**9)):
        params: dict[str, Any] = {"format": "f32", "from": first, "to": last}
        part = client.get(story["links"]["motion"], params=params)
        assert part.headers["sims-frames"] == f"{first}-{min(last, len(positions))}"
        np.testing.assert_array_equal(read_raw(part.content), positions[first:last])
    motion = read_json(client.get(story["links"]["motion"], params={"format": "json", "to": 50}).content)
    np.testing.assert_allclose(motion.joint_positions(), positions[:50], atol=1e-4)


def test_what_never_changes_need_not_be_sent_twice(client: httpx.Client, story: dict[str, Any]) -> None:
    for path in (*(story["links"][name] for name in ("film", "scene", "home")), f"{story['links']['motion']}?to=30"):
        first = client.get(path)
        assert "immutable" in first.headers["cache-control"]
        again = client.get(path, headers={"If-None-Match": first.headers["etag"]})
        assert (again.status_code, again.content) == (304, b"")
        assert client.get(path, headers={"If-None-Match": '"other"'}).content == first.content


def test_a_home_that_was_had_can_be_played_in_again(client: httpx.Client, story: dict[str, Any]) -> None:
    home = client.get(story["links"]["home"]).json()
    again = finished(client, client.post("/v1/stories", json={"theme": SHORT, "home": home}).json()["id"])
    assert again["state"] == "succeeded", again["error"]
    assert client.get(again["links"]["home"]).json() == home
    assert again["motion"]["frames"] == story["motion"]["frames"]


def test_keyframes_of_ones_own_are_acted_out_and_not_told(client: httpx.Client) -> None:
    body = {"keyframes": [WALK, SIT], "layout_id": ROOM, "seed": 4}
    answer = client.post("/v1/motions", json=body)
    assert answer.status_code == 202
    made = finished(client, answer.json()["id"])
    assert (made["kind"], made["state"], made["planner"]) == ("motion", "succeeded", "given")
    assert (made["title"], made["text"], made["spans"]) == (None, None, [])
    assert [keyframe["skill"] for keyframe in made["keyframes"]] == ["loco", "sitdown"]
    assert made["home"]["rooms"][0]["layout_id"] == ROOM
    assert made["report"]["motion"]["reached"] == 2
    assert client.get(made["links"]["film"]).content[:4] == b"glTF"


def test_a_room_that_lacks_what_is_needed_fails_with_the_reason(client: httpx.Client) -> None:
    rug = {"id": "rug", "category": "rug", "position": [0, 0, 0], "size": [1, 0.02, 1]}
    bare = EXAMPLE | {"id": "inputs/bare", "objects": [rug]}
    client.post("/v1/layouts", json=bare).raise_for_status()
    keyframe = {"skill": "touch", "caption": "take a book", "furniture": "bookshelf"}
    made = client.post("/v1/motions", json={"keyframes": [keyframe], "layout_id": "inputs/bare"}).json()
    made = finished(client, made["id"])
    assert made["state"] == "failed"
    assert "to touch" in made["error"]["detail"]
    assert "--" not in made["error"]["detail"]


def test_bodies_that_are_no_bodies(client: httpx.Client) -> None:
    here = "/v1/stories"
    kind = {"Content-Type": "application/json"}
    for content in (b"", b"{", b"[1,", b"\xff\xfe", b"[" * 100_000, json.dumps(SHORT).encode(), b"null"):
        answer = client.post(here, content=content, headers=kind)
        assert answer.status_code in (400, 422), content[:20]
        assert answer.headers["content-type"] == "application/problem+json"
    assert client.post(here, content=b"x" * (5 << 20), headers=kind).status_code == 413
    assert client.post(here, content=b"theme=x", headers={"Content-Type": "text/plain"}).status_code == 415
    assert client.put(here, json={}).status_code == 405
