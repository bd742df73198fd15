"""Speech: sound in bounded pieces, a server over real HTTP, good and hostile, and clear words for what is missing."""

from __future__ import annotations

import io
import json
import threading
import wave
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from film_made import Drawn, Making, film_of
from pydantic import SecretStr

from planner_service.extraction import transcription_server
from planner_service.extraction.audio import MAX_AUDIO_SECONDS, RATE, SoundPiece, SpeechError, sound_of
from planner_service.extraction.speech_to_text import hear, load_transcriber
from planner_service.extraction.transcription_server import ServedTranscriber
from planner_service.extraction.video import Film, open_film
from planner_service.settings import Settings, SettingsError


@cache
def sounding() -> bytes:
    return film_of([Drawn(2)], Making(sound=2.0))


Answer = tuple[int, dict[str, str], bytes]
SEGMENTS = {
    "text": "Hello there. Sit down.",
    "segments": [
        {"start": 0.2, "end": 0.9, "text": " Hello there."},
        {"start": 1.0, "end": 99.0, "text": " Sit down. [sighs]"},
    ],
}


def film(data: bytes | None = None) -> Film:
    return open_film(io.BytesIO(sounding() if data is None else data), "a film")


@contextmanager
def speech_server(*answers: Answer | Callable[[], Iterator[bytes]]) -> Iterator[tuple[str, list[tuple[str, bytes]]]]:
    """A server that answers in turn, the last one for ever; and what it was sent: (key, body)."""
    asked: list[tuple[str, bytes]] = []

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"]))
            asked.append((self.headers.get("Authorization", ""), body))
            answer = answers[min(len(asked), len(answers)) - 1]
            status, headers, data = answer if isinstance(answer, tuple) else (200, {}, b"")
            self.send_response(status if self.path == "/v1/audio/transcriptions" else 404)
            for name, value in headers.items():
                self.send_header(name, value)
            self.end_headers()
            try:
                for piece in [data] if isinstance(answer, tuple) else answer():
                    self.wfile.write(piece)
            except OSError:
                pass

        def log_message(self, *_: object) -> None:
            """Silent."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads, server.block_on_close = True, False
    threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/v1", asked
    finally:
        server.shutdown()
        server.server_close()


def good(value: object) -> Answer:
    return 200, {"Content-Type": "application/json"}, json.dumps(value).encode()


def test_sound_comes_as_waves_of_16_khz_on_the_film_s_clock() -> None:
    (piece,) = sound_of(film())
    assert piece.start == pytest.approx(0, abs=0.1)
    assert piece.end == pytest.approx(2, abs=0.15)
    with wave.open(io.BytesIO(piece.wav)) as sound:
        assert (sound.getnchannels(), sound.getsampwidth(), sound.getframerate()) == (1, 2, RATE)
        samples = np.frombuffer(sound.readframes(RATE), np.int16).astype(float)
    tone = np.abs(np.fft.rfft(samples[: RATE // 2]))
    assert int(np.argmax(tone)) * 2 == pytest.approx(440, abs=4)


def test_long_sound_is_cut_into_pieces_that_follow_one_another() -> None:
    pieces = list(sound_of(film(film_of([Drawn(1)], Making("matroska", sound=150.0, sounds="pcm_s16le")))))
    assert len(pieces) >= 3
    assert all(piece.end - piece.start <= MAX_AUDIO_SECONDS for piece in pieces)
    for piece, following in pairwise(pieces):
        assert following.start == pytest.approx(piece.end, abs=0.002)
    assert pieces[-1].end == pytest.approx(150, abs=0.2)


def test_a_silent_film_has_no_pieces_and_nobody_is_asked() -> None:
    assert list(sound_of(film(film_of([Drawn(1)])))) == []
    assert hear(ServedTranscriber("http://127.0.0.1:9/v1", "m"), film(film_of([Drawn(1)]))).cues == ()


def test_a_server_s_segments_become_cues_within_their_piece() -> None:
    told: list[float] = []
    with speech_server(good(SEGMENTS)) as (url, asked):
        heard = hear(ServedTranscriber(url, "whisper-1", "secret-key-1"), film(), lambda _, share: told.append(share))
    assert [cue.start for cue in heard.cues] == pytest.approx([0.2, 1.0], abs=0.1)
    assert [(cue.text, cue.sounds) for cue in heard.cues] == [("Hello there.", ()), ("Sit down.", ("sighs",))]
    assert heard.cues[-1].end <= 2.2
    assert heard.notes == ("what is said was heard by asr:whisper-1",)
    assert told[-1] == 1.0
    ((key, body),) = asked
    assert key == "Bearer secret-key-1"
    assert b"whisper-1" in body
    assert b"RIFF" in body


@pytest.mark.parametrize(
    "value", [{"text": "Only text."}, {"text": "Only text.", "segments": []}, {"text": "Only text.", "segments": None}]
)
def test_a_server_without_times_gives_one_cue_a_piece(value: object) -> None:
    with speech_server(good(value)) as (url, _):
        heard = hear(ServedTranscriber(url, "m"), film())
    assert [cue.text for cue in heard.cues] == ["Only text."]


def test_a_busy_server_is_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transcription_server, "FIRST_WAIT", 0.001)
    with speech_server((503, {}, b""), (429, {"Retry-After": "0"}, b"{}"), good({"text": "At last."})) as (url, asked):
        assert [cue.text for cue in hear(ServedTranscriber(url, "m"), film()).cues] == ["At last."]
    assert len(asked) == 3


def endless() -> Iterator[bytes]:
    while True:
        yield b"x" * 100_000


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        ((401, {}, b'{"error": {"message": "bad key secret-key-1"}}'), "SIMS_ASR_API_KEY"),
        ((404, {}, b"nothing here"), "SIMS_ASR_BASE_URL"),
        ((302, {"Location": "http://127.0.0.1:9/"}, b""), "302"),
        ((500, {}, b""), "tried 4 times"),
        ((429, {"Retry-After": "9999"}, b""), "are over"),
        ((200, {}, b"<html>"), "no JSON object"),
        ((200, {}, b"[1, 2]"), "no JSON object"),
        ((200, {}, b"[" * 5000), "no JSON object"),
        ((200, {}, b'{"text": 7}'), "no text"),
        (endless, "more than"),
    ],
    ids=["key", "path", "moved", "broken", "later", "html", "list", "nested", "number", "endless"],
)
def test_a_bad_server_is_a_clear_error_without_the_key(
    answer: Answer | Callable[[], Iterator[bytes]], says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(transcription_server, "FIRST_WAIT", 0.001)
    with speech_server(answer) as (url, _), pytest.raises(SpeechError, match=says) as error:
        hear(ServedTranscriber(url, "m", "secret-key-1", seconds=5), film())
    assert "secret" not in str(error.value)
    assert "\n" not in str(error.value)


def test_segments_that_lie_are_bounded() -> None:
    rows = [{"start": float("nan"), "end": 1, "text": "x"}, {"start": 5, "end": 1, "text": "x"}, {"text": "x"}, 7]
    with speech_server(good({"segments": [*rows, {"start": -9, "end": 1e300, "text": "all"}]})) as (url, _):
        cues = ServedTranscriber(url, "m").transcribe(SoundPiece(10.0, 20.0, b""))
    assert [(cue.start, cue.end, cue.text) for cue in cues] == [(10, 20, "all")]


def test_a_server_that_is_not_there_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transcription_server, "FIRST_WAIT", 0.001)
    with pytest.raises(SpeechError, match="asr:m: it cannot be reached"):
        ServedTranscriber("http://127.0.0.1:9/v1", "m").transcribe(SoundPiece(0, 1, b""))


def chosen(**given: Any) -> Settings:
    return Settings(_env_file=None, **given)


def test_settings_choose_the_transcriber(tmp_path: Path) -> None:
    assert load_transcriber(chosen()) is None
    served = load_transcriber(chosen(asr_model="w", asr_base_url="http://127.0.0.1:1/v1/"))
    assert served == ServedTranscriber("http://127.0.0.1:1/v1", "w")
    hosted = load_transcriber(chosen(asr_model="w", asr_api_key=SecretStr("k" * 20)))
    assert isinstance(hosted, ServedTranscriber)
    assert hosted.base_url.startswith("https://")
    (tmp_path / "model.bin").write_bytes(b"no model")
    for given, says in (
        ({"asr_model": "w"}, "SIMS_ASR_API_KEY"),
        ({"asr_base_url": "http://127.0.0.1:1/v1"}, "SIMS_ASR_MODEL"),
        ({"asr_model": "w", "asr_base_url": "ftp://x"}, "SIMS_ASR_BASE_URL"),
        ({"asr_folder": tmp_path / "missing"}, "no model.bin"),
    ):
        with pytest.raises(SettingsError, match=says):
            load_transcriber(chosen(**given))


def test_a_local_model_without_its_library_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "model.bin").write_bytes(b"no model")
    monkeypatch.setattr("planner_service.extraction.speech_to_text.find_spec", lambda _: None)
    with pytest.raises(SettingsError, match=r"pip install \"sims-stories\[asr\]\""):
        load_transcriber(chosen(asr_folder=tmp_path))
