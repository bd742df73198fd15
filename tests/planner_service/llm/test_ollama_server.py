"""Whether a model waits on this machine: looked for in a moment, told in a line, never taken unasked."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer

from for_each import for_each

from planner_service.cli.story import hint
from planner_service.llm.ollama_server import ollama_models

TWO = json.dumps({"models": [{"name": "qwen3:8b"}, {"name": "gemma3"}]}).encode()


@contextmanager
def serving(body: bytes, status: int = 200, wait: float = 0.0) -> Iterator[str]:
    """A server that says this of its models."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            time.sleep(wait)
            self.send_response(status if self.path == "/api/tags" else 404)
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            """Silent."""

    server = HTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        server.server_close()


def test_its_models_are_named() -> None:
    with serving(TWO) as url:
        assert ollama_models(url, 5.0) == ("qwen3:8b", "gemma3")


@for_each(
    ("body", "found"),
    [
        (b"", None), (b"<html>", None), (b"[]", None), (b'{"models": 3}', None), (b'{"models": []}', ()),
        (b'{"models": [{"name": "a b"}, {"name": 3}, 4, {"name": "x\\u001b[31m"}, {"name": "good"}]}', ("good",)),
    ],
)  # fmt: skip
def test_what_is_no_list_of_models_is_none(body: bytes, found: tuple[str, ...] | None) -> None:
    with serving(body) as url:
        assert ollama_models(url, 5.0) == found
    with serving(TWO, 500) as url:
        assert ollama_models(url, 5.0) is None


def test_a_server_that_is_away_or_slow_is_none() -> None:
    with serving(TWO) as url:
        pass
    assert ollama_models(url, 5.0) is None
    with serving(TWO, wait=0.5) as slow:
        assert ollama_models(slow, 0.05) is None
    for address in ("", "nonsense", "ftp://127.0.0.1", "http://[::1", "http://127.0.0.1:99999"):
        assert ollama_models(address, 5.0) is None


def test_one_line_says_that_a_model_is_there_and_none_that_there_is_none() -> None:
    assert hint(None) == hint(()) == ""
    line = hint(["qwen3:8b", "gemma3"])
    assert "--model ollama:qwen3:8b" in line
    assert line.startswith("planned by rules;")
    assert "\n" not in line
