"""The service itself: health, readiness, figures, logging in, and the page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Final

from fastapi import APIRouter, Depends, Request, Response
from prometheus_client import CONTENT_TYPE_LATEST, generate_latest
from sqlalchemy import text
from starlette.responses import JSONResponse

from planner_service.access import COOKIE, COOKIE_SECONDS, Gate
from planner_service.answering import database_problem
from planner_service.commands.errors import explain
from planner_service.parts import Parts, PartsDep
from planner_service.routes.page import page_is_built
from planner_service.schemas.service import Check, Health, Login, Readiness, Session
from planner_service.telemetry import Figures

service_router = APIRouter(tags=["service"])
UNBUILT: Final = "the page is not built; `make page` builds it (needs Node 20 or newer), all else works without"


async def gate_of(request: Request) -> Gate:
    """The keys and origins of the app that a request came to."""
    gate: Gate = request.app.state.gate
    return gate


async def figures_of(request: Request) -> Figures:
    """The figures of the app that a request came to."""
    figures: Figures = request.app.state.figures
    return figures


@service_router.get("/healthz")
def healthz() -> Health:
    """Is the process alive? Looks at nothing else."""
    return Health()


@service_router.get(
    "/readyz", responses={503: {"model": Readiness, "description": "Something that is needed is not there."}}
)
def readyz(parts: PartsDep) -> Response:
    """Can stories be made? Looks at the database and the library; says whether the page is built."""
    checks = [_check("database", parts, _database), _check("library", parts, _library)]
    built = page_is_built()
    checks.append(Check(name="page", ok=built, needed=False, detail="built" if built else UNBUILT))
    ready = all(check.ok for check in checks if check.needed)
    body = Readiness(status="ready" if ready else "not ready", checks=checks)
    return JSONResponse(body.model_dump(), 200 if ready else 503, {"Cache-Control": "no-store"})


def _check(name: str, parts: Parts, look: Callable[[Parts], str]) -> Check:
    try:
        return Check(name=name, ok=True, needed=True, detail=look(parts))
    except Exception as error:
        known = database_problem(error)
        return Check(name=name, ok=False, needed=True, detail=known.detail if known else explain(error)[:300])


def _database(parts: Parts) -> str:
    with parts.engine.connect() as connection:
        connection.execute(text("SELECT 1"))
    return str(parts.engine.dialect.name)


def _library(parts: Parts) -> str:
    return f"{len(parts.shelves.scripts())} short scripts, {len(parts.shelves.layouts().layouts)} rooms"


@service_router.get("/metrics", response_class=Response, responses={200: {"content": {"text/plain": {}}}})
def metrics(figures: Annotated[Figures, Depends(figures_of)]) -> Response:
    """Figures for Prometheus: requests, stages, queue, failures. Needs a key where keys are set."""
    return Response(generate_latest(figures.registry), headers={"Content-Type": CONTENT_TYPE_LATEST})


@service_router.get("/session")
def session(request: Request, gate: Annotated[Gate, Depends(gate_of)]) -> Session:
    """Whether a key is needed here, and whether this caller has shown one."""
    return Session(required=gate.locked, authenticated=request.state.caller is not None)


@service_router.post("/session", status_code=204, response_class=Response)
def log_in(login: Login, request: Request, gate: Annotated[Gate, Depends(gate_of)]) -> Response:
    """Show a key once and get a cookie for it, for 30 days: pages cannot send a key with downloads and streams."""
    value = gate.log_in(login.key, request.scope)
    answer = Response(status_code=204, headers={"Cache-Control": "no-store"})
    if value is not None:
        answer.set_cookie(COOKIE, value, max_age=COOKIE_SECONDS, **_cookie_rules(request))
    return answer


@service_router.delete("/session", status_code=204, response_class=Response)
def log_out(request: Request) -> Response:
    """Forget the cookie."""
    answer = Response(status_code=204, headers={"Cache-Control": "no-store"})
    answer.delete_cookie(COOKIE, **_cookie_rules(request))
    return answer


def _cookie_rules(request: Request) -> dict[str, Any]:
    return {"path": "/", "secure": request.url.scheme == "https", "httponly": True, "samesite": "strict"}
