"""The clients against a real service: sync and async say the same, broken connections are taken up again."""

from __future__ import annotations

import io
import json
import socket
import socketserver
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from itertools import pairwise, repeat
from pathlib import Path
from typing import Any

import anyio
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from running import PATIENCE, SHORT, RunningService

from motion_backend.motion import Motion
from planner_service.client import (
    ApiError,
    AsyncClient,
    Client,
    ClientError,
    Story,
    StoryCancelled,
    StoryEvent,
    StoryFailed,
    Unreachable,
    WaitTimeout,
    event_stream_client,
)
from planner_service.client.event_stream_client import EventParser, Message

pytestmark = pytest.mark.service
ROOT = Path(__file__).resolve().parents[3]
SIT = [{"skill": "sitdown", "emotion": "tired", "caption": "sit slumped", "furniture": "sofa"}]
KEY = "0123456789abcdef-first-key"


def test_importing_the_client_loads_nothing_of_the_engine() -> None:
    heavy = ["torch", "numpy", "pydantic", "fastapi", "sqlalchemy", "motion_backend", "scene_graphs"]
    code = f"import sys, planner_service.client; print([name for name in {heavy!r} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


words = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\r\n\0"), max_size=12)
names = words.filter(lambda text: bool(text) and not text.startswith(" "))
messages = st.builds(Message, event=names, data=st.lists(words, min_size=1, max_size=3).map("\n".join), id=names)


def written(message: Message, comment: str) -> list[str]:
    """Lines of text/event-stream, with things between that mean nothing."""
    lines = [f"event: {message.event}", f":{comment}", *(f"data: {part}" for part in message.data.split("\n"))]
    return [*lines, "unknown", "retry: 1000", f"id: {message.id}", ""]


def cut(content: bytes, places: list[int]) -> list[bytes]:
    bounds = [0, *sorted(place % (len(content) + 1) for place in places), len(content)]
    return [content[a:b] for a, b in pairwise(bounds)]


@given(st.lists(messages, max_size=4), words, st.sampled_from(["\n", "\r\n", "\r"]), st.lists(st.integers(0, 999)))
def test_events_are_read_wherever_the_bytes_are_cut(
    sent: list[Message], comment: str, ending: str, places: list[int]
) -> None:
    lines = [line for message in sent for line in written(message, comment)]
    content = "".join(line + ending for line in lines).encode()
    parser = EventParser()
    assert [message for piece in cut(content, places) for message in parser.feed(piece)] == sent


@given(st.lists(st.sampled_from([b"data:", b"id:", b" ", b"\r", b"\n", b":", b"\xef\xbb\xbf", b"\xff", "é".encode()])))
def test_whatever_comes_cutting_it_changes_nothing(parts: list[bytes]) -> None:
    content = b"".join(parts)
    whole, single = EventParser(), EventParser()
    assert whole.feed(content) == [message for byte in content for message in single.feed(bytes([byte]))]


@pytest.fixture(scope="module")
def client(service: RunningService) -> Iterator[Client]:
    with Client(service.url) as client:
        yield client


@pytest.fixture(scope="module")
def story(client: Client) -> Story:
    posted = client.tell(SHORT, seed=1, character={"name": "Ada", "pronouns": "she"})
    assert posted.state in ("queued", "running")
    return client.wait(posted.id, PATIENCE)


def test_a_theme_becomes_a_story_a_film_and_motion(client: Client, story: Story) -> None:
    assert story.state == "succeeded"
    assert story.ended
    assert story.title
    assert story.text is not None
    assert "Ada" in story.text
    assert story.keyframes[-1]["end"] == story.frames
    assert story.report is not None
    assert story.error == ""
    assert story["character"]["pronouns"] == "she"
    assert client.film(story.id)[:4] == client.scene(story.id)[:4] == b"glTF"
    assert client.home(story.id)["rooms"][0]["layout"]["objects"]


def test_motion_comes_as_arrays_and_its_parts_are_the_whole(client: Client, story: Story) -> None:
    whole = client.motion(story.id)
    assert isinstance(whole, Motion)
    assert len(whole) == story.frames
    middle = len(whole) // 2
    halves = client.motion(story.id, 0, middle), client.motion(story.id, middle)
    assert np.array_equal(np.concatenate([half.root_positions for half in halves]), whole.root_positions)
    raw = np.frombuffer(client.motion_file(story.id, "f32", middle), "<f4").reshape(-1, 22, 3)
    assert np.allclose(raw, halves[1].joint_positions(), atol=1e-5)
    assert client.motion_file(story.id, "bvh", 0, 2).startswith(b"HIERARCHY")


def test_events_can_be_taken_up_behind_any_of_them(client: Client, story: Story) -> None:
    events = list(client.events(story.id))
    assert [event.id for event in events] == sorted({event.id for event in events})
    assert [event.last for event in events] == [False] * (len(events) - 1) + [True]
    assert events[-1].name == "done"
    for number in (0, len(events) // 2, len(events) - 1):
        assert list(client.events(story.id, events[number].id)) == events[number + 1 :]


def test_keyframes_of_ones_own_are_acted_in_a_room_and_in_a_home(client: Client, story: Story) -> None:
    posted = [client.act(SIT, layout_id="living-room-0016"), client.act(SIT, home=client.home(story.id))]
    for motion in (client.wait(one.id, PATIENCE) for one in posted):
        assert motion["kind"] == "motion"
        assert motion.keyframes[-1]["skill"] == "sitdown"
        assert motion.keyframes[-1]["reached"]


def test_pages_lead_from_the_newest_to_the_oldest(client: Client, story: Story) -> None:
    client.act(SIT, layout_id="living-room-0016")
    seen, cursor = [], None
    while True:
        page = client.stories(limit=1, cursor=cursor)
        assert len(page) <= 1
        seen += list(page)
        cursor = page.next
        if cursor is None:
            break
    assert story.id in [one.id for one in seen]
    assert [one.id for one in seen] == sorted((one.id for one in seen), reverse=True)
    (listed,) = (one for one in seen if one.id == story.id)
    assert (listed.frames, listed.title, listed.text, listed.keyframes) == (story.frames, story.title, None, [])


def test_one_key_makes_one_story_which_can_be_cancelled_and_deleted(client: Client) -> None:
    posted = client.act(SIT, layout_id="living-room-0016", seed=2, idempotency_key="once")
    assert client.act(SIT, layout_id="living-room-0016", seed=2, idempotency_key="once").id == posted.id
    client.delete(posted.id)
    with pytest.raises(ApiError) as caught:
        client.story(posted.id)
    assert caught.value.status == 404
    assert not caught.value.not_ready


def test_what_is_refused_is_told_with_every_fault(client: Client) -> None:
    with pytest.raises(ApiError, match="422 Unprocessable") as caught:
        client.tell(SHORT, seed=-1, rooms=["kitchen"])
    assert {fault["pointer"] for fault in caught.value.errors} == {"/seed", "/rooms/0"}


def test_a_story_that_cannot_be_made_is_told_with_the_reason(client: Client) -> None:
    posted = client.tell("日本語の物語")
    with pytest.raises(StoryFailed, match="read in English") as caught:
        client.wait(posted.id, PATIENCE)
    assert caught.value.story.state == "failed"


def test_what_is_still_being_made_can_be_told_from_what_is_not_there(client: Client) -> None:
    posted = client.tell(SHORT, seed=3)
    with pytest.raises(ApiError) as caught:
        client.film(posted.id)
    assert caught.value.not_ready
    with pytest.raises(WaitTimeout, match="did not end within 0"):
        client.wait(posted.id, timeout=0)
    assert client.cancel(posted.id).state == "cancelled"
    with pytest.raises(StoryCancelled):
        client.wait(posted.id, PATIENCE)


def answers(client: Client, story: Story) -> list[Any]:
    """What a client says of a story in all its calls."""
    return [
        client.story(story.id).data,
        client.stories(5).next,
        client.home(story.id),
        client.film(story.id),
        client.scene(story.id),
        client.motion_file(story.id, "json", 5, 9),
        list(client.events(story.id)),
        client.wait(story.id).data,
        client.act(SIT, layout_id="living-room-0016", seed=5, idempotency_key="both").id,
    ]


async def answers_awaited(client: AsyncClient, story: Story) -> list[Any]:
    posted = await client.act(SIT, layout_id="living-room-0016", seed=5, idempotency_key="both")
    return [
        (await client.story(story.id)).data,
        (await client.stories(5)).next,
        await client.home(story.id),
        await client.film(story.id),
        await client.scene(story.id),
        await client.motion_file(story.id, "json", 5, 9),
        [event async for event in client.events(story.id)],
        (await client.wait(story.id)).data,
        posted.id,
    ]


def test_both_clients_say_the_same(service: RunningService, client: Client, story: Story) -> None:
    async def ask() -> list[Any]:
        async with AsyncClient(service.url) as awaited:
            return await answers_awaited(awaited, story)

    posted = client.act(SIT, layout_id="living-room-0016", seed=5, idempotency_key="both")
    client.wait(posted.id, PATIENCE)
    assert anyio.run(ask) == answers(client, story)


def test_one_who_waits_hears_that_another_cancels(service: RunningService) -> None:
    async def wait() -> None:
        async with AsyncClient(service.url) as client:
            posted = await client.tell(SHORT, seed=6)
            heard: list[StoryEvent] = []

            async def stop_it() -> None:
                async for event in client.events(posted.id):
                    heard.append(event)
                    if event.name == "stage" and len(heard) == 1:
                        await client.cancel(posted.id)

            async with anyio.create_task_group() as tasks:
                tasks.start_soon(stop_it)
                with pytest.raises(StoryCancelled):
                    await client.wait(posted.id, PATIENCE)
            assert heard[-1].name == "cancelled"
            await client.delete(posted.id)

    anyio.run(wait)


TRUMPET = {
    "id": "polish-the-trumpet",
    "summary": "The character sits down on the sofa and polishes a trumpet.",
    "emotion": "relaxed",
    "room": "living_room",
    "keyframes": SIT,
}
NOOK = {
    "room_type": "study",
    "floor_polygon": [[-1.5, -1.5], [-1.5, 1.5], [1.5, 1.5], [1.5, -1.5]],
    "doors": [{"segment": [[-1.5, -0.4], [-1.5, 0.4]]}],
    "objects": [
        {"id": "armchair_1", "category": "armchair", "position": [0.8, 0, -0.8], "size": [0.8, 0.9, 0.8], "yaw": 0}
    ],
}


def test_short_scripts_are_found_added_and_removed(client: Client) -> None:
    known = client.search_short_scripts("cannot sleep at night", k=3, emotion="tired")
    assert [one["score"] for one in known] == sorted((one["score"] for one in known), reverse=True)
    assert {one["short_script"]["emotion"] for one in known} == {"tired"}
    assert not client.add_short_script(TRUMPET)["built_in"]
    with pytest.raises(ApiError, match="409"):
        client.add_short_script(TRUMPET)
    assert client.short_script("polish-the-trumpet")["summary"] == TRUMPET["summary"]
    changed = client.change_short_script(client.short_script("polish-the-trumpet") | {"summary": "A trumpet shines."})
    assert (changed["version"], client.export_short_scripts(own=True, furniture=["sofa"])) == (
        2, [{name: value for name, value in changed.items() if name != "built_in" and value is not None}],
    )  # fmt: skip
    with pytest.raises(ApiError, match="409"):
        client.change_short_script(TRUMPET)
    client.change_short_script(TRUMPET | {"version": 2})
    assert [one["version"] for one in client.short_script_versions("polish-the-trumpet")] == [1, 2, 3]
    assert client.short_script("polish-the-trumpet", version=2) == changed
    plan = client.long_script("He polishes his trumpet.", seed=1, method="matching")
    assert "polish-the-trumpet" in [one["script"]["id"] for one in plan["short_scripts"]]
    client.delete_short_script("polish-the-trumpet")
    page = client.short_scripts(limit=100, room="study")
    assert {one["room"] for one in page} == {"study"}


def test_rooms_are_found_added_and_played_in(client: Client) -> None:
    added = client.add_layout(NOOK | {"id": "house/nook:1"})
    assert added["problems"] == []
    assert client.layout("house/nook:1")["graph"] == added["graph"]
    assert client.layout_scene("house/nook:1")[:4] == b"glTF"
    keyframes = [{"skill": "sitdown", "caption": "sit down", "furniture": "armchair"}]
    played = client.wait(client.act(keyframes, layout_id="house/nook:1").id, PATIENCE)
    assert played.keyframes[-1]["object_id"] == "0/armchair_1"
    seen = client.layouts(limit=5)
    assert [one["id"] for one in client.layouts(5, seen.next)] > [one["id"] for one in seen]
    assert client.layout_drawing("house/nook:1", "png", path=False)[:4] == b"\x89PNG"
    file = json.dumps([NOOK | {"id": "house/den"}, {"id": "no room"}]).encode()
    with pytest.raises(ApiError, match="415"):
        client.import_layouts(file, "native")
    with pytest.raises(ApiError, match="room"):
        client.import_layouts(file, "procthor")
    client.delete_layout("house/nook:1")
    with pytest.raises(ApiError, match="404"):
        client.layout("house/nook:1")


def test_graphs_are_merged_and_rooms_retrieved(client: Client) -> None:
    graph = {"nodes": [{"category": "sofa", "needs": ["sit"]}, {"category": "bookshelf"}], "edges": [[0, 1]]}
    merged = client.merge_graphs([graph, graph], method="aligned")
    assert {node["category"] for node in merged["graph"]["nodes"]} == {"sofa", "bookshelf"}
    matches = client.retrieve_layouts(graph, k=3)
    assert [match["distance"] for match in matches] == sorted(match["distance"] for match in matches)


@contextmanager
def cutting(url: str, budgets: Iterator[int | None], port: int = 0) -> Iterator[str]:
    """A way to a service that breaks off: each connection after so many bytes of answers."""
    host, _, far_port = url.removeprefix("http://").partition(":")

    class Way(socketserver.BaseRequestHandler):
        def handle(self) -> None:
            budget = next(budgets)
            with socket.create_connection((host, int(far_port))) as onwards:
                threading.Thread(target=pump, args=(self.request, onwards), daemon=True).start()
                while budget is None or budget > 0:
                    piece = onwards.recv(65536 if budget is None else budget)
                    if not piece:
                        return
                    self.request.sendall(piece)
                    budget = None if budget is None else budget - len(piece)

    class Ways(socketserver.ThreadingTCPServer):
        daemon_threads = allow_reuse_address = True

    with Ways(("127.0.0.1", port), Way) as server:
        threading.Thread(target=partial(server.serve_forever, 0.05), daemon=True).start()
        try:
            yield f"http://127.0.0.1:{server.server_address[1]}"
        finally:
            server.shutdown()


def pump(source: socket.socket, target: socket.socket) -> None:
    try:
        while piece := source.recv(65536):
            target.sendall(piece)
    except OSError:
        return


@pytest.mark.parametrize("bytes_each", [700, 1111])
def test_events_go_on_where_the_connection_broke_off(
    client: Client, story: Story, bytes_each: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(event_stream_client, "PAUSE", 0.01)

    async def ask(url: str) -> list[StoryEvent]:
        async with AsyncClient(url) as awaited:
            return [event async for event in awaited.events(story.id)]

    whole = list(client.events(story.id))
    with cutting(client.base_url, repeat(bytes_each)) as url:
        with Client(url) as cut_off:
            assert list(cut_off.events(story.id)) == whole
        assert anyio.run(ask, url) == whole


def test_one_who_follows_stays_while_the_service_is_away(client: Client, story: Story) -> None:
    whole = list(client.events(story.id))
    with cutting(client.base_url, iter([900])) as url:
        follower = Client(url)
        events = follower.events(story.id)
        heard = [next(events)]
    with follower:
        rest = threading.Thread(target=heard.extend, args=[events])
        rest.start()
        time.sleep(0.7)  # the first tries meet nobody
        with cutting(client.base_url, repeat(None), int(url.rpartition(":")[2])):
            rest.join(PATIENCE)
    assert heard == whole


def test_one_who_never_gets_an_answer_gives_up(client: Client, story: Story, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(event_stream_client, "MAX_PAUSE_SECONDS", 0.001)
    with cutting(client.base_url, repeat(40)) as url, Client(url) as cut_off, pytest.raises(Unreachable, match="broke"):
        list(cut_off.events(story.id))


def test_a_post_whose_answer_was_lost_is_repeated_and_makes_one_story(client: Client) -> None:
    before = {one.id for one in client.stories(100)}
    with cutting(client.base_url, iter([100, None])) as url, Client(url) as cut_off:
        posted = cut_off.act(SIT, layout_id="living-room-0016", seed=7)
    assert {one.id for one in client.stories(100)} - before == {posted.id}


def test_a_busy_service_is_asked_again_and_a_locked_one_wants_a_key(tmp_path: Path) -> None:
    rules = {"SIMS_RATE": "6/second", "SIMS_API_KEYS": KEY}
    with RunningService(tmp_path, workers=0, environment=rules) as service:
        with Client(service.url, KEY) as client:
            for _ in range(15):
                assert client.stories().items == []
        for key, told in ((None, "a key is needed"), ("wrong-key-wrong-key", "not one of the service's")):
            with Client(service.url, key) as stranger, pytest.raises(ApiError, match=told) as caught:
                stranger.stories()
            assert caught.value.status == 401


def test_where_nobody_answers_it_says_how_to_start_the_service() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        url = f"http://127.0.0.1:{taken.getsockname()[1]}"
        with Client(url) as client:
            for ask in (client.stories, partial(client.wait, "a", 5), partial(next, client.events("a"))):
                with pytest.raises(Unreachable, match="sims serve"):
                    ask()


def test_what_another_service_says_is_not_taken_for_an_answer() -> None:
    class Other(socketserver.StreamRequestHandler):
        def handle(self) -> None:
            while self.rfile.readline().strip():
                pass
            self.wfile.write(b"HTTP/1.1 200 OK\r\nContent-Length: 4\r\nConnection: close\r\n\r\n<hi>")

    with socketserver.ThreadingTCPServer(("127.0.0.1", 0), Other) as server:
        threading.Thread(target=partial(server.serve_forever, 0.05), daemon=True).start()
        with Client(f"http://127.0.0.1:{server.server_address[1]}") as client:
            for ask in (client.stories, partial(client.motion, "a"), partial(client.wait, "a")):
                with pytest.raises(ClientError, match="is base_url right"):
                    ask()
        server.shutdown()


@pytest.mark.parametrize("url", ["localhost:8000", "", "ftp://localhost"])
def test_an_address_without_a_scheme_is_refused_at_once(url: str) -> None:
    with pytest.raises(ValueError, match="must begin with http"):
        Client(url)


def test_an_npz_that_was_saved_opens_with_numpy(client: Client, story: Story) -> None:
    with np.load(io.BytesIO(client.motion_file(story.id, "npz", 0, 3)), allow_pickle=False) as data:
        assert data["local_rotations"].shape == (3, 22, 4)
        assert list(data["joint_names"][:3]) == ["pelvis", "left_hip", "right_hip"]
