"""What the service says of itself over HTTP: alive, ready, logged in."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class Health(BaseModel):
    """The process answers."""

    status: Literal["ok"] = "ok"


class Check(BaseModel):
    """One thing that must be there before stories can be made."""

    name: str = Field(description="database, library or page.")
    ok: bool
    needed: bool = Field(description="Whether the service is not ready without it.")
    detail: str = Field(description="What was found, or what is wrong and the remedy.")


class Readiness(BaseModel):
    """Whether requests should be sent here, and why not."""

    status: Literal["ready", "not ready"]
    checks: list[Check]


class Login(BaseModel):
    """A key, once, for a cookie."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"key": "0123456789abcdef01234567"}]})

    key: str = Field(min_length=1, max_length=500)


class Session(BaseModel):
    """Whether a key is needed, and whether this caller has shown one."""

    required: bool
    authenticated: bool
