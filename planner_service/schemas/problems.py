"""What every error looks like over HTTP: RFC 9457's problem details with the faults of the input listed."""

from __future__ import annotations

from typing import Final

from pydantic import BaseModel, ConfigDict, Field

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
