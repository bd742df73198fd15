"""The OpenAPI document: what FastAPI knows of the routes, with every problem that can be met and how to get in."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from planner_service.api.authentication import COOKIE, is_open
from planner_service.api.errors import PROBLEM_MEDIA, ProblemDetails
from planner_service.api.extractions.schemas import ExtractAsk
from planner_service.api.layouts.schemas import LayoutAsk

DESCRIPTION: Final = """\
A story theme becomes a long script, a furnished home, a told story and a human body acting it out.

`POST /v1/stories` answers 202 with a story that is then made; follow it at `/v1/stories/{id}/events` and fetch
what is ready: the motion as arrays, the home and the film as GLB. Every error is `application/problem+json`.
"""
TAGS: Final = [
    {"name": "stories", "description": "From a theme to a film."},
    {"name": "motions", "description": "Keyframes of one's own, acted out in a room of one's own."},
    {"name": "task plans", "description": "An instruction becomes steps, and keyframes that act them."},
    {"name": "short scripts", "description": "The library of short scripts that stories are put together from."},
    {"name": "extractions", "description": "Short scripts out of films, subtitles and texts."},
    {"name": "long scripts", "description": "Planning alone: a theme becomes keyframes."},
    {"name": "layouts", "description": "The library of furnished rooms."},
    {"name": "layout graphs", "description": "Which furniture stands by which, merged over several scripts."},
    {"name": "vocabularies", "description": "What the fields of a keyframe may be."},
    {"name": "service", "description": "Health, figures and logging in."},
]
ALWAYS: Final = {
    429: "More requests than one caller may send; wait `Retry-After` seconds.",
    500: "A fault of ours; the detail names the request id under which it was written down.",
    503: "The database is busy or away, or what is to move the body cannot be loaded; ask again after `Retry-After` "
    "seconds.",
}
REFUSED: Final = {
    401: "A key is needed, or the one sent is wrong.",
    403: "Refused whatever the key: a Host or an Origin that is not let in.",
}
WITH_BODY: Final = {
    400: "The body is not JSON in UTF-8, or a form that breaks off.",
    413: "The body has more than 4 MiB, or 32 MiB where it is a scene file of another format; a film may be larger.",
    415: "The body is not sent as application/json, or as what else the call takes.",
    507: "No room is left on the disk.",
}
UNREADABLE: Final = "Read, but it does not make sense; `errors` names the fields."
UNKNOWN: Final = "There is no such thing, or it is not ready yet."
OWN: Final = ("HTTPValidationError", "ValidationError")
"""FastAPI's own schemas of errors, which nothing answers with."""


def document(app: FastAPI, locked: bool) -> dict[str, Any]:
    """The document of an app; `locked` when keys are needed."""
    found = get_openapi(
        title=app.title, version=app.version, description=DESCRIPTION, routes=app.routes, tags=TAGS,
        separate_input_output_schemas=app.separate_input_output_schemas,
    )  # fmt: skip
    schemas = found.setdefault("components", {}).setdefault("schemas", {})
    for name in OWN:
        schemas.pop(name, None)
    problem = ProblemDetails.model_json_schema(ref_template="#/components/schemas/{model}")
    schemas.update(problem.pop("$defs"), ProblemDetails=problem)
    # The bodies that FastAPI does not know of: their calls take files as well.
    for body in (LayoutAsk, ExtractAsk):
        schema = body.model_json_schema(ref_template="#/components/schemas/{model}")
        schemas.update(schema.pop("$defs", {}), **{body.__name__: schema})
    found["components"]["securitySchemes"] = {
        "bearer": {"type": "http", "scheme": "bearer", "description": "One of the service's keys."},
        "cookie": {"type": "apiKey", "in": "cookie", "name": COOKIE, "description": "Set by POST /session."},
    }
    for path, operation in _operations(found):
        _describe_problems(path, operation)
        if not locked or is_open(path):
            operation["security"] = [{}, {"bearer": []}, {"cookie": []}]
    found["security"] = [{"bearer": []}, {"cookie": []}]
    return found


def _operations(found: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for path, methods in found["paths"].items():
        for operation in methods.values():
            yield path, operation


def _describe_problems(path: str, operation: dict[str, Any]) -> None:
    """Add those that any such call can meet; those that a route names keep its words."""
    answers = operation["responses"]
    wanted = dict(ALWAYS) | REFUSED
    has_body, has_parameters = "requestBody" in operation, bool(operation.get("parameters"))
    if has_body:
        wanted |= WITH_BODY
    if has_body or has_parameters:
        wanted[422] = UNREADABLE
    if "{" in path:
        wanted[404] = UNKNOWN
    if not (has_body or has_parameters) or "HTTPValidationError" in str(answers.get("422")):
        answers.pop("422", None)
    for status, description in wanted.items():
        answers.setdefault(str(status), {"description": description})
    answers.setdefault("default", {"description": "Any other problem."})
    for status, answer in answers.items():
        if status == "default" or (int(status) >= 400 and "content" not in answer):
            answer["content"] = {PROBLEM_MEDIA: {"schema": {"$ref": "#/components/schemas/ProblemDetails"}}}
    operation["responses"] = dict(sorted(answers.items()))
