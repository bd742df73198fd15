"""Sending a call until it is answered: what to try again, and after how long. No waiting here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, Generic, TypeVar

import httpx

from planner_service.client.errors import error_of, not_ours, unreachable
from planner_service.client.requests import Call

T = TypeVar("T")
TRIES: Final = 4
MAX_WAIT_SECONDS: Final = 60.0
"""Seconds; a service that wants more is not waited for."""
LOOPBACK: Final = ("localhost", "127.0.0.1", "[::1]")


def http_options(base_url: str, key: str | None, timeout: float) -> dict[str, Any]:
    """What an httpx client is made of. ValueError for what is no address of a service."""
    if not base_url.startswith(("http://", "https://")):
        raise ValueError(f"base_url must begin with http:// or https://, not {base_url!r}")
    return {
        "base_url": base_url,
        "timeout": timeout,
        "headers": {"Authorization": f"Bearer {key}"} if key else {},
        # A proxy that the environment names cannot reach this very machine.
        "mounts": {f"all://{host}": None for host in LOOPBACK},
    }


@dataclass
class Sending(Generic[T]):
    """One call on its way."""

    call: Call[T]
    base_url: str
    tries: int = 0
    wait: float = 0.0
    """Seconds before it is sent again."""

    def request(self) -> dict[str, Any]:
        """What httpx is to send."""
        call = self.call
        sent = {"method": call.method, "url": call.path, "params": call.query, "headers": call.headers}
        if call.files:
            return sent | {"files": call.files, "data": call.body or {}}
        if call.content is not None:
            return sent | {"content": call.content}
        return sent | ({} if call.body is None else {"json": call.body})

    def broke(self, error: httpx.TransportError) -> None:
        """The connection broke off. Unreachable, unless it is worth another try."""
        # A service that is not there is no better after a second; who was cut off in between may have been heard.
        if isinstance(error, httpx.ConnectError) or not self._again(0.2 * 2**self.tries):
            raise unreachable(self.base_url, error) from error

    def answered(self, response: httpx.Response) -> bool:
        """Whether the answer can be read. ApiError, unless a later try may fare better."""
        if response.is_success:
            return True
        error = error_of(response)
        after = response.headers.get("retry-after", "")
        if error.status not in (429, 503) or not after.isdecimal() or not self._again(float(after)):
            raise error
        return False

    def read(self, response: httpx.Response) -> T:
        """What was answered. ClientError when another service did."""
        try:
            return self.call.read(response)
        except (ValueError, KeyError, TypeError) as error:
            raise not_ours(response) from error

    def _again(self, wait: float) -> bool:
        self.wait = wait
        self.tries += 1
        return self.call.repeatable and self.tries < TRIES and wait <= MAX_WAIT_SECONDS
