"""Short scripts over HTTP: texts at once, films as jobs that go on where they were, and what is refused on the way."""

from __future__ import annotations

import errno
import io
import json
import os
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import anyio
import httpx
import pytest
from examples import tries
from fastapi import FastAPI
from film_made import Drawn, Making, film_of, sound_alone
from for_each import for_each
from good_model import seen_in
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel
from service_app import app_on, calling, check_problem, running
from starlette.requests import Request
from stories import GERMAN, NARRATIVE, SUBTITLES

from planner_service.api import multipart
from planner_service.api.errors import Problem
from planner_service.api.extractions.endpoints import LETTERS_AT_ONCE
from planner_service.api.extractions.views import extraction_events
from planner_service.api.multipart import FormReader, title_of
from planner_service.components import MAX_UPLOADS, Parts
from planner_service.extraction.text_files import ExtractionError
from planner_service.jobs.extraction_stages import Reader
from planner_service.jobs.uploads import KEPT, Receiving, Uploads
from planner_service.llm.fake_model import ScriptedModel
from planner_service.llm.protocol import LanguageModel
from planner_service.scripts.script import ShortScript
from planner_service.scripts.script_repair import check
from planner_service.store.extraction_store import extraction_request
from planner_service.store.story_store import Stories

Json = dict[str, Any]
CUES = ((0.5, 1.5, "She storms through the room."), (8.0, 9.5, "He lies down on the bed."))
TEXT = "Anna comes home, tired. She slumps onto the sofa. Then she lies down on the bed and sleeps."
EXTRACT = "/v1/short-scripts/extract"


@pytest.fixture(scope="module")
def film() -> bytes:
    """Fourteen seconds, two scenes."""
    return film_of([Drawn(7, 0), Drawn(7, 1)], Making(rate=4, subtitles=CUES))


@pytest.fixture(scope="module")
def mute() -> bytes:
    return film_of([Drawn(1, 0)], Making(rate=4))


@pytest.fixture
def app(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[FastAPI]:
    monkeypatch.setattr("motion_backend.language.minilm.weights_folder", lambda: None)
    with app_on(tmp_path, upload_mb=1) as app:
        yield app


@pytest.fixture(scope="module")
def refusing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FastAPI]:
    """One for all that is refused: nothing of it is kept."""
    with app_on(tmp_path_factory.mktemp("refusing"), upload_mb=1) as app:
        yield app


def post(app: FastAPI, **sent: Any) -> httpx.Response:
    return ask(app, "POST", EXTRACT, **sent)


def ask(app: FastAPI, method: str, path: str, **sent: Any) -> httpx.Response:
    async def asked() -> httpx.Response:
        async with calling(app) as client:
            return await client.request(method, path, **sent)

    return anyio.run(asked)


def parts(app: FastAPI) -> Parts:
    found: Parts = app.state.parts
    return found


def library(app: FastAPI) -> set[str]:
    return {script.id for script in parts(app).shelves.scripts().scripts}


def kept(app: FastAPI) -> list[Path]:
    """Files of uploads that are on the disk."""
    return [path for path in parts(app).uploads.folder.rglob("*") if path.is_file()]


def scripts_in(shown: Json) -> list[ShortScript]:
    return [ShortScript.model_validate(one["short_script"]) for one in shown["scripts"]]


def reader(app: FastAPI, model: LanguageModel | None = None, uploads: Uploads | None = None) -> Reader:
    """A worker's desk, as if its process had just begun."""
    found = parts(app)
    return Reader(Stories(found.engine), found.shelves, uploads or found.uploads, "worker-0", model)


def work(desk: Reader, extraction_id: str) -> None:
    """As a worker does without interruption."""
    if desk.begin(extraction_id):
        desk.listen(extraction_id)
    for index in range(desk.cut(extraction_id)):
        desk.read(extraction_id, index)
    desk.gather(extraction_id)
    desk.close(extraction_id)


def test_a_text_is_answered_at_once_and_keeps_nothing_in_the_library(app: FastAPI) -> None:
    before = library(app)
    answer = post(app, json={"text": NARRATIVE, "name": "Martha's day", "licence": "CC0-1.0"})
    shown = answer.json()
    assert (answer.status_code, shown["state"], shown["by"], shown["name"]) == (
        200, "succeeded", "rules", "Martha's day",
    )  # fmt: skip
    scripts = scripts_in(shown)
    assert len(scripts) == len({script.id for script in scripts}) >= 5
    assert not any(check(script) for script in scripts)
    assert {(one.source, one.licence, one.origin and one.origin.name) for one in scripts} == {
        ("text", "CC0-1.0", "Martha's day")
    }
    assert [scene["number"] for scene in shown["scenes"]] == list(range(1, shown["scene_count"] + 1))
    assert ask(app, "GET", answer.headers["location"]).json() == shown
    assert (library(app), kept(app)) == (before, [])


def test_what_stories_are_listed_does_not_change_and_an_extraction_is_no_story(app: FastAPI) -> None:
    shown = post(app, json={"text": TEXT}).json()
    assert ask(app, "GET", "/v1/stories").json()["items"] == []
    assert [one["id"] for one in ask(app, "GET", "/v1/extractions").json()["items"]] == [shown["id"]]
    check_problem(ask(app, "GET", f"/v1/stories/{shown['id']}"), 404)
    check_problem(ask(app, "POST", shown["links"]["cancel"]), 409)
    assert ask(app, "DELETE", shown["links"]["self"]).status_code == 204
    check_problem(ask(app, "GET", shown["links"]["self"]), 404)


def test_one_key_keeps_scripts_once_and_what_is_taken_gets_another_id(app: FastAPI) -> None:
    key = {"Idempotency-Key": "anna"}
    first, again = (post(app, json={"text": TEXT, "add": True}, headers=key).json() for _ in range(2))
    assert first == again
    assert first["added"] == [script.id for script in scripts_in(first)]
    assert set(first["added"]) <= library(app)
    other = post(app, json={"text": TEXT, "add": True}).json()
    assert len(other["added"]) == len(first["added"])
    assert not set(other["added"]) & set(first["added"])
    assert [one["like"] for one in other["scripts"]] == first["added"]
    problem = check_problem(post(app, json={"text": TEXT}, headers=key), 422)
    assert problem["errors"][0]["pointer"] == "header:Idempotency-Key"


def test_an_id_that_was_taken_while_it_was_read_is_changed_everywhere(app: FastAPI, film: bytes) -> None:
    shown = post(app, files={"video": film}, data={"add": "true"}).json()
    desk = reader(app)
    desk.begin(shown["id"])
    desk.listen(shown["id"])
    for index in range(desk.cut(shown["id"])):
        desk.read(shown["id"], index)
    made = scripts_in(ask(app, "GET", shown["links"]["self"]).json())
    parts(app).shelves.add_scripts(made[0])
    desk.gather(shown["id"])
    desk.gather(shown["id"])  # as after a crash: nothing is added twice
    done = ask(app, "GET", shown["links"]["self"]).json()
    assert done["added"] == [script.id for script in scripts_in(done)]
    assert done["added"][0] == f"{made[0].id}-2"
    assert [one for scene in done["scenes"] for one in scene["scripts"]] == done["added"]
    assert set(done["added"]) < library(app)
    assert f"{made[0].id}-3" not in library(app)


def test_subtitles_alone_have_spans_and_their_encoding_is_told(app: FastAPI) -> None:
    words = SUBTITLES.replace("summer", "été à la plage, déjà").encode("cp1252")
    answer = post(app, files={"subtitles": ("../../etc/Der Film.srt", words)})
    shown = answer.json()
    assert (answer.status_code, shown["of"], shown["name"]) == (200, "text", "Der Film")
    assert [(one.origin.start, one.origin.end) for one in scripts_in(shown) if one.origin] == [(4.0, 8.0), (90.0, 93.0)]
    assert any("1252" in note or "latin" in note.lower() for note in shown["notes"])


def test_a_long_text_waits_for_a_worker_and_cancelling_throws_it_away(app: FastAPI) -> None:
    answer = post(app, json={"text": f"{NARRATIVE}\n" * 40})
    shown = answer.json()
    assert (answer.status_code, shown["state"], shown["scene_count"]) == (202, "queued", None)
    assert [len(path.name) for path in kept(app)] == [64]
    assert ask(app, "POST", shown["links"]["cancel"]).json()["state"] == "cancelled"
    assert kept(app) == []
    assert [event.name for event in extraction_events(Stories(parts(app).engine).get(shown["id"]))] == ["cancelled"]


@pytest.mark.parametrize(
    "model", [None, ScriptedModel(lambda _prompt, _schema: {"scripts": []})], ids=["rules", "model"]
)
@pytest.mark.parametrize(("size", "status"), [(LETTERS_AT_ONCE * 4 // 5, 200), (LETTERS_AT_ONCE * 6 // 5, 202)])
def test_one_giant_paragraph_waits_for_a_worker_though_it_is_one_piece(
    app: FastAPI, model: LanguageModel | None, size: int, status: int
) -> None:
    app.state.parts = replace(parts(app), model=model)
    said = '"I am so very tired of all this, and of the two of you." '
    text = f"She sits down on the sofa. {said * (size // len(said))}"
    answer = post(app, json={"text": text})
    assert answer.status_code == status, answer.text


def test_a_film_is_kept_by_its_content_read_scene_by_scene_and_thrown_away(app: FastAPI, film: bytes) -> None:
    answer = post(app, files={"video": ("..\\..\\A quiet evening.mp4", film)}, data={"licence": "CC-BY-4.0"})
    assert answer.status_code == 202
    shown = answer.json()
    assert (shown["name"], shown["of"], len(kept(app))) == ("A quiet evening", "film", 1)
    work(reader(app), shown["id"])
    record = Stories(parts(app).engine).get(shown["id"])
    done = ask(app, "GET", shown["links"]["self"]).json()
    assert (done["progress"], done["stage"], kept(app)) == (1.0, "gather", [])
    scripts = scripts_in(done)
    assert [one.keyframes[-1].skill for one in scripts] == ["loco", "liedown"]
    for script, (start, end, _) in zip(scripts, CUES, strict=True):
        assert script.origin is not None
        assert (script.origin.start, script.origin.end) == pytest.approx((start, end), abs=0.3)
        assert (script.source, script.licence) == ("video", "CC-BY-4.0")
        assert check(script) == ()
    assert any("nobody watched the pictures" in note for note in done["notes"])
    found = list(extraction_events(record))
    assert [event.id for event in found] == sorted({event.id for event in found})
    assert [event.data["stage"] for event in found if event.name == "stage"] == ["listen", "cut", "read", "gather"]
    assert sum(event.name == "scenes" for event in found) == 1


def test_subtitles_beside_a_film_come_before_those_in_it(app: FastAPI, film: bytes) -> None:
    beside = b"1\n00:00:01,000 --> 00:00:02,000\nShe sits down on the sofa.\n"
    shown = post(app, files={"subtitles": beside, "video": film}).json()
    assert len(kept(app)) == 2
    work(reader(app), shown["id"])
    (script,) = scripts_in(ask(app, "GET", shown["links"]["self"]).json())
    assert script.keyframes[-1].skill == "sitdown"


def test_an_extraction_that_was_interrupted_goes_on_without_asking_again(app: FastAPI, film: bytes) -> None:
    whole, halved = (post(app, files={"video": film}).json() for _ in range(2))
    work(reader(app, ScriptedModel(lambda prompt, _: seen_in(prompt))), whole["id"])
    before = ScriptedModel(lambda prompt, _: seen_in(prompt))
    desk = reader(app, before)
    desk.begin(halved["id"])
    desk.listen(halved["id"])
    assert desk.cut(halved["id"]) == 2
    desk.read(halved["id"], 0)
    desk.open[halved["id"]].close()
    after = ScriptedModel(lambda prompt, _: seen_in(prompt))
    work(reader(app, after), halved["id"])
    # Scenes are asked about some at once, so the second may have been before; what was read is not asked about again.
    assert [call.schema for call in before.calls].count("SceneAnswer") <= 2
    assert [call.schema for call in after.calls] == ["SceneAnswer", "FilmedScripts"]
    assert not any("watch scene 1 of" in call.prompt for call in after.calls)
    one, other = (ask(app, "GET", shown["links"]["self"]).json() for shown in (whole, halved))
    assert (one["scripts"], one["scenes"]) == (other["scripts"], other["scenes"])
    assert one["by"] == "llm:scripted"
    spans = [(script.origin.start, script.origin.end) for script in scripts_in(one) if script.origin]
    assert spans == [(0.0, 3.0), (7.0, 10.0)]
    assert kept(app) == []


def test_what_two_scenes_tell_is_kept_once_and_stands_for_both(app: FastAPI, film: bytes) -> None:
    shown = post(app, files={"video": film}, data={"add": "true"}).json()

    def the_same(prompt: str, _schema: type[BaseModel]) -> Json:
        answer: Json = json.loads(json.dumps(seen_in(prompt)).replace("armchair", "sofa"))
        return answer

    work(reader(app, ScriptedModel(the_same)), shown["id"])
    done = ask(app, "GET", shown["links"]["self"]).json()
    (script,) = scripts_in(done)
    assert [scene["scripts"] for scene in done["scenes"]] == [[script.id], [script.id]]
    assert done["added"] == [script.id]
    assert done["notes"][-1] == "1 script said the same again"


def test_a_worker_that_does_not_have_the_film_says_what_must_be_shared(
    app: FastAPI, film: bytes, tmp_path: Path
) -> None:
    shown = post(app, files={"video": film}).json()
    elsewhere = reader(app, uploads=Uploads(tmp_path / "another machine"))
    assert elsewhere.begin(shown["id"])
    with pytest.raises(ExtractionError, match="SIMS_DATA_DIR must be one folder"):
        elsewhere.listen(shown["id"])


@for_each(
    ("files", "pointer", "told"),
    [
        ({"video": b"#EXTM3U\nhttp://example.org/a.ts\n"}, "/video", "playlist"),
        ({"video": ("a.mp4", b"PK\x03\x04" + bytes(5000))}, "/video", "ZIP"),
        ({"video": ("a.mp4", b"Once upon a time")}, "/video", "no container"),
        ({"video": ("img%03d.png", b"/frames/img%03d.png\n")}, "/video", "pattern of picture files"),
        ({"video": ("a.mp4", b"")}, "/video", "is empty"),
        ({"video": sound_alone()}, "/video", "only sound"),
        ({"video": "cut"}, "/video", "give a whole"),
        ({"video": "mute"}, "/video", "without subtitles"),
        ({"video": "film", "subtitles": bytes(range(1, 32)) * 40}, "/subtitles", "no text"),
        ({"subtitles": ("a.srt", b"")}, "/subtitles", "is empty"),
        ({"subtitles": "film"}, "/subtitles", "begins as a film"),
        ({"audio": b"x"}, "/audio", "send video, subtitles"),
        ({"add": (None, "true")}, "/video", "is missing"),
        ({"video": "film", "add": (None, "perhaps")}, "/add", "valid boolean"),
        ({"video": "film", "name": (None, "\x07")}, "/name", "printable"),
        ([("video", "film"), ("video", "film")], "/video", "sent twice"),
    ],
)  # fmt: skip
def test_what_cannot_be_read_is_refused_with_its_place_and_nothing_is_left(
    refusing: FastAPI, film: bytes, mute: bytes, files: Any, pointer: str, told: str
) -> None:
    made = {"film": film, "mute": mute, "cut": film[: len(film) // 3]}
    rows = [(name, made.get(file, file) if isinstance(file, str) else file) for name, file in dict_items(files)]
    problem = check_problem(post(refusing, files=rows), 422)
    assert problem["errors"][0]["pointer"] == pointer
    assert told in problem["errors"][0]["detail"]
    assert ask(refusing, "GET", "/v1/extractions").json()["items"] == []
    assert list(parts(refusing).uploads.folder.iterdir()) == []


def dict_items(files: Any) -> list[tuple[str, Any]]:
    return list(files.items()) if isinstance(files, dict) else files


@for_each(
    ("headers", "body", "status"),
    [
        ("multipart/form-data", b"--x--\r\n", 400),
        ("multipart/form-data; boundary=x", b"--x\r\nContent-Disposition: form-data; name=video\r\n\r\nabc", 400),
        ("multipart/form-data; boundary=x", b"no form at all", 400),
        ("multipart/form-data; boundary=x", b"--x\r\n\r\nnameless\r\n--x--\r\n", 422),
        ("text/plain", b"She sits down.", 415),
        ("application/json", b"{", 400),
        ("application/json", b'{"txt": "She sits down."}', 422),
        ("application/json", b'{"text": ""}', 422),
        ("application/json", b'{"text": "She sits down.", "name": ""}', 422),
        ("application/json", b'{"text": "' + GERMAN.replace("\n", " ").encode() + b'"}', 422),
        ("application/json", b'{"text": "' + b"a " * 2_200_000 + b'"}', 413),
    ],
)
def test_a_body_of_another_kind_is_told_so(refusing: FastAPI, headers: str, body: bytes, status: int) -> None:
    check_problem(post(refusing, content=body, headers={"Content-Type": headers}), status)
    assert kept(refusing) == []


def test_a_film_that_is_too_large_is_broken_off(refusing: FastAPI, film: bytes) -> None:
    problem = check_problem(post(refusing, files={"video": film + bytes(1 << 20)}), 413)
    assert problem["errors"][0]["pointer"] == "/video"
    assert list(parts(refusing).uploads.folder.iterdir()) == []


def test_uploads_that_fall_silent_end_and_their_places_are_free_again(
    refusing: FastAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(multipart, "SILENCE", 0.1)
    beginning = b'--x\r\nContent-Disposition: form-data; name="video"; filename="a.mp4"\r\n\r\n' + bytes(100)
    headers = {"Content-Type": "multipart/form-data; boundary=x", "Content-Length": "9000"}
    with running(refusing) as url, ExitStack() as all_closed:
        sent = httpx.Request("POST", url + EXTRACT, headers=headers)
        head = "".join(f"{name}: {value}\r\n" for name, value in sent.headers.items())
        silent = [
            all_closed.enter_context(socket.create_connection((sent.url.host, sent.url.port), timeout=30))
            for _ in range(MAX_UPLOADS)
        ]
        for one in silent:
            one.sendall(f"POST {EXTRACT} HTTP/1.1\r\n{head}\r\n".encode() + beginning)
        for one in silent:
            with one.makefile("rb") as answer:
                told = answer.read()  # to its end: the connection is closed
            assert told.startswith(b"HTTP/1.1 408 ")
            assert b"application/problem+json" in told
            assert b"nothing was sent for 0.1 seconds" in told
        assert list(parts(refusing).uploads.folder.iterdir()) == []
        check_problem(httpx.post(url + EXTRACT, files={"subtitles": b""}), 422)


def test_a_disk_that_is_full_is_507_and_leaves_no_half_file(
    refusing: FastAPI, film: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Receiving, "write", full)
    check_problem(post(refusing, files={"video": film}), 507)
    assert list(parts(refusing).uploads.folder.iterdir()) == []


class FullDisk(io.RawIOBase):
    """A file to which nothing can be written."""

    def writable(self) -> bool:
        return True

    def write(self, _: object) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")


def test_files_that_a_full_disk_does_not_let_close_are_thrown_away(tmp_path: Path) -> None:
    with Uploads(tmp_path).begin() as coming:
        first, second = (coming.receive(1000) for _ in range(2))
        first.file.close()
        first.file = io.BufferedWriter(FullDisk())
        for one in (first, second):
            one.write(b"held until it is flushed")
        with pytest.raises(OSError, match="No space left"):
            first.finish()
    assert (first.file.closed, second.file.closed) == (True, True)
    assert list(tmp_path.iterdir()) == []


def test_what_belongs_to_no_job_is_swept_away_when_it_is_old(tmp_path: Path) -> None:
    uploads = Uploads(tmp_path)
    with uploads.begin():
        for name in ("old", "fresh", "going-on"):
            (tmp_path / name).mkdir()
            (tmp_path / name / "part-0").write_bytes(b"x")
        past = time.time() - KEPT - 60
        for path in (*(tmp_path / "old").iterdir(), tmp_path / "old", *(tmp_path / "going-on").iterdir()):
            os.utime(path, (past, past))
        os.utime(tmp_path / "going-on", (past, past))
        uploads.sweep({"going-on"})
        assert {path.name.partition("-")[0] for path in tmp_path.iterdir()} == {"coming", "fresh", "going"}
    assert not list(tmp_path.glob("coming-*"))


def read_form(folder: Path, boundary: bytes, pieces: list[bytes]) -> Any:
    """What a form in these pieces gives: files, fields and what was seen, or the status it is refused with."""
    waiting = [{"type": "http.request", "body": piece, "more_body": True} for piece in pieces]
    waiting.append({"type": "http.request", "body": b"", "more_body": False})

    async def receive() -> Json:
        return waiting.pop(0)

    header = b"multipart/form-data; boundary=" + boundary
    request = Request({"type": "http", "headers": [(b"content-type", header)]}, receive)
    with Uploads(folder).begin() as coming:
        try:
            form = anyio.run(FormReader(coming, {"video": 500, "subtitles": 500}, ("name",)).read, request)
        except Problem as problem:
            return problem.status
        return {name: sent.receiving.path.read_bytes() for name, sent in form.files.items()}, dict(form.fields)


@tries(40)
@given(file=st.binary(max_size=400), text=st.text(max_size=50), cuts=st.lists(st.integers(1, 60), max_size=12))
def test_a_form_is_the_same_however_it_is_cut(
    tmp_path_factory: pytest.TempPathFactory, file: bytes, text: str, cuts: list[int]
) -> None:
    sent = httpx.Request("POST", "http://x", files={"video": ("a", file)}, data={"name": text})
    body, boundary = sent.read(), sent.headers["content-type"].partition("boundary=")[2].encode()
    stream = io.BytesIO(body)
    pieces = [stream.read(cut) for cut in cuts]
    whole = read_form(tmp_path_factory.mktemp("form"), boundary, [*pieces, stream.read()])
    assert whole == ({"video": file}, {"name": text.encode("utf-8", "replace").decode()})


@tries(40)
@given(
    body=st.lists(st.sampled_from([b"--x", b"\r\n", b"--", b"Content-Disposition: form-data; name=", b"video", b"\0"]))
)
def test_no_form_is_more_than_refused(tmp_path_factory: pytest.TempPathFactory, body: list[bytes]) -> None:
    given = read_form(tmp_path_factory.mktemp("form"), b"x", body)
    assert given in (400, 413, 422) or isinstance(given, tuple)


@given(st.text(max_size=300))
def test_a_title_is_one_short_printable_line_and_no_path(name: str) -> None:
    title = title_of(name)
    assert title.isprintable()
    assert len(title) <= 200
    assert "/" not in title
    assert "\\" not in title


def test_what_was_asked_for_is_kept_as_it_was(app: FastAPI, film: bytes) -> None:
    shown = post(app, files={"video": film}, data={"name": " The  film ", "add": "TRUE"}).json()
    wanted = extraction_request(parts(app).engine, shown["id"])
    assert (wanted.name, wanted.licence, wanted.add, wanted.film, wanted.subtitles) == (
        "The film", "unknown", True, True, None,
    )  # fmt: skip
