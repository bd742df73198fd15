"""Errors of the HTTP service: one tree, and one way to answer any of them as application/problem+json.

Problem                     500  the root; any of these may be raised anywhere below a route
├── Malformed               400  not JSON, or not HTTP that we read
├── Unauthorised            401  no key, or a wrong one
├── Forbidden               403  a key would not help: wrong Host, wrong Origin
├── NotFound                404  no such thing
│   └── NotReady            404  it is still being made
├── TooSlow                 408  the rest of it did not come; the connection ends
├── Conflict                409  it is not in a state for that
├── TooLarge                413  more bytes than are read
├── WrongMedia              415  not application/json
├── Unprocessable           422  read, but it does not make sense; names the field
├── TooMany                 429  later, please; with Retry-After
├── NotProvided             501  what it needs is not installed here; names the remedy
├── ModelFailed             502  the language model did not give a usable answer
├── Unavailable             503  the database is busy or away; with Retry-After
└── StorageFull             507  no room left for what was asked for

What every error looks like over HTTP: RFC 9457's problem details with the faults of the input listed.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from http import HTTPStatus
from typing import ClassVar, Final

from pydantic import BaseModel, ConfigDict, Field
from starlette.responses import Response

from planner_service.user_errors import printable

PROBLEM_MEDIA: Final = "application/problem+json"


class Fault(BaseModel):
    """One thing that is wrong with what was sent."""

    model_config = ConfigDict(extra="forbid")

    pointer: str = Field(
        description="Where: a JSON pointer into the body (`/character/height`, empty for the whole of it), `?limit` "
        "for a query parameter, `header:Last-Event-ID` for a header, `path:id` for a part of the path.",
    )
    detail: str = Field(description="What is wrong there and what would be right.")


class ProblemDetails(BaseModel):
    """Why a request was not done, and what would be right (RFC 9457)."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={
            "examples": [
                {
                    "type": "about:blank",
                    "title": "Unprocessable Entity",
                    "status": 422,
                    "detail": "/character/height: Input should be less than or equal to 2.2",
                    "instance": "/v1/stories",
                    "errors": [{"pointer": "/character/height", "detail": "Input should be less than or equal to 2.2"}],
                }
            ]
        },
    )

    type: str = Field(description="`about:blank` where the status says it all, else a name of this kind of problem.")
    title: str = Field(description="The kind of problem in a few words.")
    status: int = Field(ge=400, le=599, description="The HTTP status.")
    detail: str = Field(description="What was wrong this time, and the remedy.")
    instance: str | None = Field(None, description="The path that was asked for.")
    errors: list[Fault] | None = Field(None, description="Every fault of the input that was found, at most 20.")


MAX_DETAIL_LENGTH: Final = 600
MAX_POINTER_LENGTH: Final = 200
MAX_FAULTS: Final = 20


class Problem(Exception):  # noqa: N818 - the word of RFC 9457
    """A request that cannot be done; `detail` says what was wrong and the remedy."""

    status: int = 500
    kind: ClassVar[str] = "about:blank"
    title: ClassVar[str] = ""
    """Empty: the phrase of the status."""

    def __init__(self, detail: str, errors: Sequence[Fault] = (), headers: Mapping[str, str] | None = None) -> None:
        super().__init__(detail)
        self.detail = detail
        self.errors = tuple(errors)
        self.headers = dict(headers or {})

    def details(self, path: str) -> ProblemDetails:
        """The members of RFC 9457, every text of them short and printable."""
        faults = [
            Fault(
                pointer=printable(fault.pointer, MAX_POINTER_LENGTH), detail=printable(fault.detail, MAX_DETAIL_LENGTH)
            )
            for fault in self.errors[:MAX_FAULTS]
        ]
        return ProblemDetails(
            type=self.kind,
            title=self.title or HTTPStatus(self.status).phrase,
            status=self.status,
            detail=printable(self.detail, MAX_DETAIL_LENGTH),
            instance=printable(path, MAX_POINTER_LENGTH),
            errors=faults or None,
        )

    def response(self, path: str) -> Response:
        """The answer to a request for `path`."""
        content = json.dumps(self.details(path).model_dump(exclude_none=True), ensure_ascii=False)
        return Response(content, self.status, {"Cache-Control": "no-store", **self.headers}, PROBLEM_MEDIA)


class Malformed(Problem):
    """What was sent cannot be read at all."""

    status = 400


class Unauthorised(Problem):
    """A key is needed."""

    status = 401

    def __init__(self, detail: str) -> None:
        super().__init__(detail, headers={"WWW-Authenticate": 'Bearer realm="sims"'})


class Forbidden(Problem):
    """Refused, whoever asks."""

    status = 403


class NotFound(Problem):
    """There is no such thing."""

    status = 404


class NotReady(NotFound):
    """It will be there: it is still being made."""

    kind = "urn:sims:problem:not-ready"
    title = "Not Ready Yet"

    def __init__(self, detail: str, retry_after: int = 1) -> None:
        super().__init__(detail, headers={"Retry-After": str(retry_after)})


class TooSlow(Problem):
    """Who sends it has stopped before its end; the connection ends, since what may still come belongs to nothing."""

    status = 408

    def __init__(self, detail: str) -> None:
        super().__init__(detail, headers={"Connection": "close"})


class Conflict(Problem):
    """The thing is not in a state for that."""

    status = 409


class TooLarge(Problem):
    """More bytes than are read."""

    status = 413


class WrongMedia(Problem):
    """The body is not of the type that is read here."""

    status = 415


class Unprocessable(Problem):
    """Read and understood, but wrong; `pointer` names where."""

    status = 422

    def __init__(self, pointer: str, detail: str) -> None:
        super().__init__(f"{pointer}: {detail}" if pointer else detail, (Fault(pointer=pointer, detail=detail),))


class TooMany(Problem):
    """Enough for now; `retry_after` in seconds."""

    status = 429

    def __init__(self, detail: str, retry_after: int) -> None:
        super().__init__(detail, headers={"Retry-After": str(retry_after)})


class NotProvided(Problem):
    """What it needs is not installed here."""

    status = 501


class ModelFailed(Problem):
    """The language model gave no usable answer."""

    status = 502
    kind = "urn:sims:problem:language-model"
    title = "Language Model Failed"


class Unavailable(Problem):
    """Something we need is busy or away; `retry_after` in seconds."""

    status = 503

    def __init__(self, detail: str, retry_after: int = 2) -> None:
        super().__init__(detail, headers={"Retry-After": str(retry_after)})


class StorageFull(Problem):
    """Nothing more can be written."""

    status = 507
