"""The JSON body of a call that also takes other kinds of bodies: read and refused as FastAPI does it for all others."""

from __future__ import annotations

import json
from typing import TypeVar

from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, ValidationError
from starlette.requests import Request

from planner_service.errors import WrongMedia

T = TypeVar("T", bound=BaseModel)


def parsed(model: type[T], request: Request, body: bytes) -> T:
    """The body as a model. WrongMedia where it is not sent as JSON, RequestValidationError where it is wrong."""
    media = request.headers.get("content-type", "").split(";")[0].strip().lower()
    if media != "application/json" and not media.endswith("+json"):
        raise WrongMedia(f"Content-Type is {media or 'missing'!r:.80}; send JSON as application/json")
    try:
        row = json.loads(body)
    except json.JSONDecodeError as error:
        fault = {"type": "json_invalid", "loc": ("body", error.pos), "msg": error.msg, "ctx": {"error": error.msg}}
        raise RequestValidationError([fault], body=error.doc) from error
    except (ValueError, RecursionError) as error:  # not UTF-8, a number of thousands of digits, brackets without end
        fault = {"type": "json_invalid", "loc": ("body", 0), "msg": str(error), "ctx": {"error": str(error)}}
        raise RequestValidationError([fault], body="") from error
    try:
        return model.model_validate(row)
    except ValidationError as error:
        faults = [{**fault, "loc": ("body", *fault["loc"])} for fault in error.errors(include_url=False)]
        raise RequestValidationError(faults, body=row) from error
