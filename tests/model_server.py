"""A server of language models that speaks OpenAI's and Anthropic's HTTP, well or as badly as a test wants it to."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

Json = dict[str, Any]


@dataclass(frozen=True)
class Asked:
    """One request as it came."""

    path: str
    headers: Mapping[str, str]
    body: Json

    @property
    def system(self) -> str:
        """What is said before the conversation."""
        if self.path.endswith("/messages"):
            return "".join(part["text"] for part in self.body.get("system", []))
        return "".join(one["content"] for one in self.body["messages"] if one["role"] == "system")

    @property
    def parts(self) -> list[Json]:
        """What the user says: texts and images."""
        content = next(one["content"] for one in self.body["messages"] if one["role"] == "user")
        return [{"type": "text", "text": content}] if isinstance(content, str) else content

    @property
    def prompt(self) -> str:
        """The texts among it."""
        return "".join(part["text"] for part in self.parts if part["type"] == "text")

    @property
    def schema(self) -> Json | None:
        """The schema that the server is to hold the answer to."""
        if self.path.endswith("/messages"):
            return self.body.get("output_config", {}).get("format", {}).get("schema")
        return self.body.get("response_format", {}).get("json_schema", {}).get("schema")


@dataclass(frozen=True)
class Sent:
    """One answer: a status, headers and pieces of a body, sent as they come."""

    body: bytes | Callable[[], Iterator[bytes]]
    status: int = 200
    headers: Mapping[str, str] = field(default_factory=lambda: {"Content-Type": "application/json"})
    length: int | None = None
    """What Content-Length says; None: the truth, or nothing for pieces."""


Behaviour = Callable[[Asked], Sent]


def chat(text: str, path: str = "/v1/chat/completions", tokens: tuple[Any, Any] = (30, 12)) -> Sent:
    """A whole answer of a chat with that text."""
    if path.endswith("/messages"):
        usage = {"input_tokens": tokens[0], "output_tokens": tokens[1]}
        row: Json = {
            "id": "msg_1", "type": "message", "role": "assistant", "model": "m", "usage": usage,
            "content": [{"type": "text", "text": text}], "stop_reason": "end_turn", "stop_sequence": None,
        }  # fmt: skip
    else:
        usage = {"prompt_tokens": tokens[0], "completion_tokens": tokens[1], "total_tokens": 0}
        message = {"role": "assistant", "content": text}
        row = {
            "id": "c1", "object": "chat.completion", "created": 1, "model": "m", "usage": usage,
            "choices": [{"index": 0, "finish_reason": "stop", "message": message}],
        }  # fmt: skip
    return Sent(json.dumps(row).encode())


def saying(answer: Callable[[str], Any]) -> Behaviour:
    """A good server, whose model answers with the text or JSON that `answer` makes of the prompt."""

    def behave(asked: Asked) -> Sent:
        value = answer(asked.prompt)
        return chat(value if isinstance(value, str) else json.dumps(value), asked.path)

    return behave


def failing(status: int, body: Json | bytes = b"", **headers: str) -> Sent:
    """An error; names of headers are written with `_` for `-`."""
    named = {"Content-Type": "application/json"} | {name.replace("_", "-"): value for name, value in headers.items()}
    return Sent(body if isinstance(body, bytes) else json.dumps(body).encode(), status, named)


def in_turn(answers: Sequence[Sent | Behaviour]) -> Behaviour:
    """One answer after the other, and the last one for ever."""
    left = list(answers)

    def behave(asked: Asked) -> Sent:
        answer = left.pop(0) if len(left) > 1 else left[0]
        return answer if isinstance(answer, Sent) else answer(asked)

    return behave


def dripping(seconds: float = 0.05) -> Sent:
    """A body that begins well and comes a byte at a time, for ever."""

    def pieces() -> Iterator[bytes]:
        yield b'{"id": "'
        while True:
            time.sleep(seconds)
            yield b"x"

    return Sent(pieces)


def endless() -> Sent:
    """A body that comes fast and never ends."""

    def pieces() -> Iterator[bytes]:
        yield b'{"id": "c1", "choices": [{"message": {"content": "'
        while True:
            yield b"and then, " * 1000

    return Sent(pieces)


class ModelServer:
    """Serves on a free port until it is left; what it was asked is in `asked`."""

    def __init__(self, behave: Behaviour) -> None:
        self.behave = behave
        self.asked: list[Asked] = []
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), self._handler())
        self._server.daemon_threads = True
        self._server.block_on_close = False
        self.url = f"http://127.0.0.1:{self._server.server_port}/v1"

    @property
    def prompts(self) -> list[str]:
        """What it was asked, as text."""
        return [asked.prompt for asked in self.asked]

    def __enter__(self) -> ModelServer:
        threading.Thread(target=self._server.serve_forever, args=(0.02,), daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._server.server_close()

    def _handler(self) -> type[BaseHTTPRequestHandler]:
        server = self

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def do_POST(self) -> None:
                body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
                asked = Asked(self.path, {name.lower(): value for name, value in self.headers.items()}, body)
                server.asked.append(asked)
                try:
                    self._send(server.behave(asked))
                except OSError:  # the caller has left
                    self.close_connection = True

            def _send(self, sent: Sent) -> None:
                self.send_response(sent.status)
                for name, value in {**sent.headers, "Connection": "close"}.items():
                    self.send_header(name, value)
                whole = len(sent.body) if isinstance(sent.body, bytes) else None
                length = sent.length if sent.length is not None else whole
                if length is not None:
                    self.send_header("Content-Length", str(length))
                self.end_headers()
                for piece in [sent.body] if isinstance(sent.body, bytes) else sent.body():
                    self.wfile.write(piece)
                    self.wfile.flush()
                self.close_connection = True

            def log_message(self, *_: object) -> None:
                """Silent."""

        return Handler
