"""Bounds on what one caller may send: requests in a moving window, and bytes of a body."""

from __future__ import annotations

import math
import time
from collections import OrderedDict, deque
from collections.abc import Mapping
from typing import Final

from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from planner_service.api.errors import TooLarge, TooMany

MAX_BYTES: Final = 4 << 20
"""Of one body."""
LARGER: Final = {("POST", "/v1/layouts"): 32 << 20}
"""Calls that take other people's files."""
WINDOWS: Final = {"second": 1.0, "minute": 60.0, "hour": 3600.0}
FREE: Final = ("/healthz", "/readyz", "/metrics")
"""Paths that probes ask for often, never counted; neither are the files of the page."""


class Rate:
    """So many events of one name in a moving window, such as "1200/minute". Counted in this process only."""

    def __init__(self, rate: str) -> None:
        count, _, window = rate.partition("/")
        self.said = rate
        self.most = int(count)
        self.seconds = WINDOWS[window]
        self._times: OrderedDict[str, deque[float]] = OrderedDict()
        """When each name's events of the last window were, the name heard of longest ago first."""

    def take(self, name: str, what: str) -> None:
        """Count one event. TooMany, with the seconds to wait, when the window is full."""
        self.check(name, what)
        self._times.setdefault(name, deque()).append(time.monotonic())
        self._times.move_to_end(name)
        self._forget()

    def check(self, name: str, what: str) -> None:
        """TooMany when the window is full; counts nothing."""
        times, now = self._times.get(name, deque()), time.monotonic()
        while times and times[0] <= now - self.seconds:
            times.popleft()
        if len(times) >= self.most:
            wait = max(1, math.ceil(times[0] + self.seconds - now))
            raise TooMany(f"{what}: {self.said.replace('/', ' a ')} are allowed; wait {wait} s", wait)

    def _forget(self) -> None:
        """Let go of names that have not been heard of for a window."""
        name, times = next(iter(self._times.items()))
        if not times or times[-1] <= time.monotonic() - self.seconds:
            del self._times[name]


class Limiting:
    """ASGI: counts the requests of every caller, known by key or by address."""

    def __init__(self, app: ASGIApp, rate: Rate) -> None:
        self.app = app
        self.rate = rate

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, or answer 429 with Retry-After."""
        if scope["type"] == "http" and not is_free(scope["path"]):
            try:
                self.rate.take(counted_as(scope), "too many requests")
            except TooMany as problem:
                await problem.response(scope["path"])(scope, receive, send)
                return
        await self.app(scope, receive, send)


def is_free(path: str) -> bool:
    """Whether requests for it are never counted."""
    return path in FREE or path.startswith("/assets/")


def counted_as(scope: Scope) -> str:
    """The key's fingerprint where there is one, else the address."""
    caller = scope.get("state", {}).get("caller")
    return f"caller {caller}" if caller else address_of(scope)


def address_of(scope: Scope) -> str:
    """Where a request comes from, as a name to count by."""
    client = scope.get("client")
    return f"address {client[0] if client else 'unknown'}"


class BodyLimit:
    """ASGI: no body of more than `MAX_BYTES` is read, whether its length was declared or it comes in chunks.

    Calls that are `larger` may send more.
    """

    def __init__(self, app: ASGIApp, most: int = MAX_BYTES, larger: Mapping[tuple[str, str], int] = LARGER) -> None:
        self.app = app
        self.most = most
        self.larger = larger

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, or answer 413; a body in chunks is broken off where it grows too long."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        most = self.larger.get((scope["method"], scope["path"]), self.most)
        detail = f"a body has at most {most} bytes"
        declared = Headers(scope=scope).get("content-length", "")
        if declared.isdecimal() and int(declared) > most:
            problem = TooLarge(f"{detail}, {int(declared)} were announced")
            await problem.response(scope["path"])(scope, receive, send)
            return
        read = 0

        async def counting() -> Message:
            nonlocal read
            message = await receive()
            read += len(message.get("body", b""))
            if read > most:
                # An HTTPException, because FastAPI turns any other one that comes up while it reads into a 400.
                raise HTTPException(413, detail)
            return message

        await self.app(scope, counting, send)
