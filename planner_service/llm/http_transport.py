"""Carries one question to a server and back: patient with one that is busy, and never without end.

An answer is read whole, up to a bound, before anybody looks at it; what is no JSON never gets further. 429 and 5xx are
tried again, after Retry-After where the server says so, and everything ends by the deadline.

How long a server of models is waited for, and what it says when it refuses.
"""

from __future__ import annotations

import asyncio
import json
import re
import time
from dataclasses import dataclass, field
from email.utils import parsedate_to_datetime
from http import HTTPStatus
from typing import Final

import httpx2

from planner_service.llm.protocol import ModelError
from planner_service.user_errors import printable

ATTEMPTS: Final = 4
BUSY: Final = frozenset({408, 425, 429, 500, 502, 503, 504, 529})
"""Statuses that may be better a little later; 529 is Anthropic's "overloaded"."""
FIRST_WAIT: Final = 0.5
"""Seconds, doubled each time."""


def message_of(body: bytes) -> str:
    """What a server says went wrong, if it says so in JSON as OpenAI, Ollama, vLLM or Anthropic do."""
    try:
        value = json.loads(body)
    except (ValueError, RecursionError):
        return ""
    error = value.get("error", value) if isinstance(value, dict) else None
    said = error.get("message", "") if isinstance(error, dict) else error
    return said if isinstance(said, str) else ""


def retry_after(header: str, now: float) -> float:
    """Seconds to wait as Retry-After says, in seconds or as a date; 0 for what cannot be read."""
    if re.fullmatch(r"\d{1,9}(\.\d{1,6})?", header.strip()):
        return float(header)
    try:
        return max(0.0, parsedate_to_datetime(header).timestamp() - now)
    except (ValueError, OverflowError, TypeError):
        return 0.0


def without_key(text: str, key: str) -> str:
    """A server's words, in which our key and every part of it is hidden."""

    def hidden(found: re.Match[str]) -> str:
        return "…" if key and (found[0] in key or key in found[0]) else found[0]

    return re.sub(r"[\w.~-]{6,}", hidden, text.replace(key, "…") if key else text)


MAX_ANSWER_BYTES: Final = 2_000_000
"""Bytes of a body."""
_SAID: Final = 200
_REMEDIES: Final = {
    401: "check SIMS_LLM_API_KEY",
    402: "its account has no credit left",
    403: "check SIMS_LLM_API_KEY and what it may be used for",
    404: "check the model in SIMS_LLM_MODEL and the address in SIMS_LLM_BASE_URL",
    413: "the prompt is too long for it",
}


class ServerError(ModelError):
    """No answer came from a model's server that can be read; `status` is HTTP's, 0 where there was none."""

    def __init__(self, text: str, status: int = 0) -> None:
        super().__init__(text)
        self.status = status


@dataclass(frozen=True)
class Carrier(httpx2.AsyncBaseTransport):
    """One question's way: the connection, what to call the server, its key (never shown), and the end of patience."""

    inner: httpx2.AsyncBaseTransport
    server: str
    key: str = field(repr=False)
    deadline: float
    """On the clock of `time.monotonic`."""

    async def handle_async_request(self, request: httpx2.Request) -> httpx2.Response:
        """The answer, read whole, of status 2xx and JSON. ServerError."""
        for attempt in range(ATTEMPTS):
            wait = FIRST_WAIT * 2**attempt
            try:
                response = await self._once(request)
            except httpx2.TransportError as error:
                failure = ServerError(f"{self.server} cannot be reached or broke off: {self._shown(str(error))}")
            else:
                if response.is_success:
                    return self._json(response)
                failure = self._refusal(response)
                if response.status_code not in BUSY:
                    raise failure
                wait = max(retry_after(response.headers.get("retry-after", ""), time.time()), wait)
            if attempt + 1 == ATTEMPTS:
                raise ServerError(f"{failure}; tried {ATTEMPTS} times", failure.status) from None
            if time.monotonic() + wait >= self.deadline:
                told = f"{failure}; it should be asked again in {wait:.0f} s, and SIMS_LLM_TIMEOUT ends before"
                raise ServerError(told, failure.status) from None
            await asyncio.sleep(wait)
        raise AssertionError("the last attempt returns or raises")

    async def aclose(self) -> None:
        """Close the connection."""
        await self.inner.aclose()

    async def _once(self, request: httpx2.Request) -> httpx2.Response:
        """One exchange; the body is in memory and the connection free when it returns."""
        response = await self.inner.handle_async_request(request)
        try:
            encoding = response.headers.get("content-encoding", "identity")
            if encoding != "identity":
                raise ServerError(f"{self.server} answered in {printable(encoding, 40)}, which was not asked for")
            claimed = response.headers.get("content-length", "")
            body = bytearray()
            assert isinstance(response.stream, httpx2.AsyncByteStream)
            async for chunk in response.stream:
                body += chunk
                if len(body) > MAX_ANSWER_BYTES or (claimed.isdecimal() and int(claimed[:20]) > MAX_ANSWER_BYTES):
                    raise ServerError(f"{self.server} sent more than {MAX_ANSWER_BYTES} bytes for one answer")
        finally:
            await response.aclose()
        kept = {name: response.headers[name] for name in ("content-type", "retry-after") if name in response.headers}
        return httpx2.Response(response.status_code, headers=kept, content=bytes(body), request=request)

    def _json(self, response: httpx2.Response) -> httpx2.Response:
        """The answer if it says that it is JSON."""
        kind = response.headers.get("content-type", "").partition(";")[0].strip().lower()
        if kind != "application/json":
            said = printable(kind, 60) or "something of no type"
            raise ServerError(f"{self.server} answered {said} instead of JSON; check SIMS_LLM_BASE_URL")
        return response

    def _refusal(self, response: httpx2.Response) -> ServerError:
        status = response.status_code
        phrase = HTTPStatus(status).phrase if status in set(HTTPStatus) else "a status of its own"
        said = self._shown(message_of(response.content))
        text = f"{self.server} answered {status} ({phrase}){': ' + said if said else ''}"
        if 300 <= status < 400:
            text += "; redirections are not followed, check SIMS_LLM_BASE_URL"
        return ServerError(text + (f"; {_REMEDIES[status]}" if status in _REMEDIES else ""), status)

    def _shown(self, text: str) -> str:
        """A short line of a server's words, without our key or a part of it."""
        return printable(without_key(text, self.key), _SAID)
