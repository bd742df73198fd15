"""What can go wrong for a client, in one tree.

ClientError
├── ApiError        the service answered with a problem: status, title, detail, errors
├── Unreachable     nobody answered at the address
├── StoryFailed     a story or extraction that was waited for could not be made; `story.error` says why
├── StoryCancelled  a story or extraction that was waited for was cancelled
└── WaitTimeout     a story or extraction was not ready in time; it is still being made
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import httpx

from planner_service.client.responses import Job

PROBLEM: Final = "application/problem+json"


class ClientError(Exception):
    """Anything that a client raises for what it met on the way."""


class ApiError(ClientError):
    """The service refused; `errors` name every fault of the input, each with `pointer` and `detail`."""

    def __init__(
        self, status: int, title: str, detail: str, errors: Sequence[dict[str, str]] = (), kind: str = "about:blank"
    ) -> None:
        super().__init__(f"{status} {title}: {detail}")
        self.status, self.title, self.detail = status, title, detail
        self.errors = tuple(errors)
        self.kind = kind

    @property
    def not_ready(self) -> bool:
        """Whether it will be there later."""
        return self.kind == "urn:sims:problem:not-ready"


class Unreachable(ClientError):  # noqa: N818
    """Nobody answered."""


class StoryEnded(ClientError):  # noqa: N818
    """A story, or an extraction, ended otherwise than hoped."""

    def __init__(self, story: Job) -> None:
        super().__init__(f"{type(story).__name__.lower()} {story.id}: {story.error or story.state}")
        self.story = story


class StoryFailed(StoryEnded):
    """A story could not be made."""


class StoryCancelled(StoryEnded):
    """A story was cancelled."""


class WaitTimeout(ClientError, TimeoutError):  # noqa: N818
    """A story was not ready in time."""


def error_of(response: httpx.Response) -> ApiError:
    """The problem that an answer tells; one from a proxy in between is told by its status."""
    body: Any = None
    if response.headers.get("content-type", "").startswith(PROBLEM):
        try:
            body = response.json()
        except ValueError:
            body = None
    if not isinstance(body, dict):
        detail = f"{response.request.method} {response.request.url} was not answered by the service itself"
        return ApiError(response.status_code, response.reason_phrase or "Error", detail)
    return ApiError(
        response.status_code,
        str(body.get("title", response.reason_phrase)),
        str(body.get("detail", "")),
        body.get("errors") or (),
        str(body.get("type", "about:blank")),
    )


def not_ours(response: httpx.Response) -> ClientError:
    """An answer that this service does not give."""
    return ClientError(f"{response.request.url} is no call of this service; is base_url right?")


def unreachable(base_url: str, error: Exception) -> Unreachable:
    """Nobody answered at an address: the remedy is mostly to start the service."""
    if isinstance(error, httpx.ConnectError):
        return Unreachable(f"nothing answers at {base_url}; start the service with `sims serve`, or give its base_url")
    return Unreachable(f"{base_url} broke off: {str(error) or type(error).__name__}")
