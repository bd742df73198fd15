"""What every route is handed: the parts of the service.

Query parameters that a call does not know are refused: `frm=0` must not quietly mean everything.

The JSON body of a call that also takes other kinds of bodies: read and refused as FastAPI does it for all others.
"""

from __future__ import annotations

import json
from typing import Annotated, TypeVar

from fastapi import Depends, Request
from fastapi.dependencies.utils import get_flat_params
from fastapi.exceptions import RequestValidationError
from fastapi.params import Query
from fastapi.routing import APIRoute
from pydantic import BaseModel, ValidationError
from starlette.requests import HTTPConnection

from planner_service.api.errors import Unprocessable, WrongMedia
from planner_service.components import Parts


async def parts_of(connection: HTTPConnection) -> Parts:
    """The parts of the app that a request came to; async, since a thread for it would cost more than it does."""
    parts: Parts = connection.app.state.parts
    return parts


PartsDep = Annotated[Parts, Depends(parts_of)]


async def only_known_parameters(request: Request) -> None:
    """Unprocessable names the parameter that the call lacks, and those it has; async, since it waits for nothing."""
    route = request.scope["route"]
    if not (request.query_params and isinstance(route, APIRoute) and route.include_in_schema):
        return
    taken = get_flat_params(route.dependant)
    known = [field.alias for field in taken if isinstance(field.field_info, Query)]
    for name in request.query_params:
        if name not in known:
            raise Unprocessable(f"?{name}", f"there is no such parameter here; there are {', '.join(known) or 'none'}")


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
