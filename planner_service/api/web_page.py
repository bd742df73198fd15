"""The page, and the service itself: health, readiness, figures, logging in, ETags, lists in pages.

The page at `/`: built from web/ into planner_service/page, or a note that says how to build it.

Answers that never change: named by an ETag, kept by whoever has them, and not made again for those who do.

What the service says of itself over HTTP: alive, ready, logged in.

Lists in pages: how many, from where, and the cursor of the page that follows.
"""

from __future__ import annotations

from base64 import urlsafe_b64decode, urlsafe_b64encode
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any, Final, Literal, TypeVar

from fastapi import APIRouter, Depends, Query, Request, Response
from prometheus_client import CONTENT_TYPE_LATEST, generate_latest
from pydantic import BaseModel, ConfigDict, Field
from sqlalchemy import text
from starlette.middleware.gzip import GZipMiddleware
from starlette.responses import FileResponse, HTMLResponse, JSONResponse
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Scope

from planner_service.api.authentication import COOKIE, COOKIE_SECONDS, Gate
from planner_service.api.dependencies import PartsDep
from planner_service.api.error_handlers import database_problem
from planner_service.api.errors import Unprocessable
from planner_service.api.telemetry import Figures
from planner_service.components import Parts
from planner_service.user_errors import explain

PAGE: Final = Path(__file__).resolve().parents[1] / "page"
POLICY: Final = "; ".join(
    (
        "default-src 'self'",
        "img-src 'self' blob: data:",
        "connect-src 'self' blob: data:",
        "worker-src 'self' blob:",
        "style-src 'self' 'unsafe-inline'",
        "frame-ancestors 'none'",
        "base-uri 'none'",
        "form-action 'self'",
        "object-src 'none'",
    )
)
"""Nothing comes from elsewhere and nobody frames us; three.js makes blobs of textures, and styles are set by script."""
HEADERS: Final = {"Content-Security-Policy": POLICY, "Cache-Control": "no-cache"}
ICON: Final = """\
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32"><rect width="32" height="32" rx="7" fill="#2f3a4f"/>\
<circle cx="16" cy="9" r="3.6" fill="#f3c969"/><path d="M16 13v8m0 0-4 6m4-6 4 6m-9-11 5-2 5 2" fill="none" \
stroke="#f3c969" stroke-width="2.4" stroke-linecap="round" stroke-linejoin="round"/></svg>
"""
NOTE: Final = """\
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>The page is not built</title>
<style>body { font: 1rem/1.6 system-ui, sans-serif; max-width: 38rem; margin: 12vh auto; padding: 0 1.5rem;
color-scheme: light dark }</style>
<h1>The page is not built</h1>
<p>The service runs; only this page is missing. With Node 20 or newer on the path, build it with</p>
<pre><code>make page</code></pre>
<p>in the clone, and load this page again; where the package was installed from a clone, install it anew then.
Everything else works without it:
<a href="/openapi.json">the calls there are</a>, <a href="/readyz">whether the service is ready</a>.</p>
</html>
"""
page_router = APIRouter(include_in_schema=False)


def page_is_built() -> bool:
    """Whether there is a page to show."""
    return (PAGE / "index.html").is_file()


@page_router.get("/")
def page() -> Response:
    """The page, or how to build it."""
    if page_is_built():
        return FileResponse(PAGE / "index.html", headers=HEADERS)
    return HTMLResponse(NOTE, headers=HEADERS)


@page_router.get("/favicon.ico")
@page_router.get("/favicon.svg")
def icon() -> Response:
    """The small picture in the browser's tab."""
    own = PAGE / "favicon.svg"
    headers = {"Cache-Control": "public, max-age=86400"}
    if own.is_file():
        return FileResponse(own, headers=headers, media_type="image/svg+xml")
    return Response(ICON, headers=headers, media_type="image/svg+xml")


class Assets(StaticFiles):
    """Files whose names hold a hash of their content: kept by browsers for ever."""

    def __init__(self, folder: Path) -> None:
        super().__init__(directory=folder, check_dir=False)

    async def check_config(self) -> None:
        """Nothing: where the page is not built there are no files, and that is a 404."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """The file. HTTPException 404 where there is none."""
        answer = await super().get_response(path, scope)
        if answer.status_code in (200, 206, 304):
            answer.headers["Cache-Control"] = "public, max-age=31536000, immutable"
        return answer


def assets() -> ASGIApp:
    """What is mounted at /assets."""
    return GZipMiddleware(Assets(PAGE / "assets"), minimum_size=1024)


FOREVER: Final = "private, max-age=31536000, immutable"


def unchanging(
    request: Request, etag: str, make: Callable[[], bytes], media_type: str, headers: Mapping[str, str] | None = None
) -> Response:
    """What `make` makes, or 304 without making it when the caller has it (If-None-Match)."""
    named = {"ETag": f'"{etag}"', "Cache-Control": FOREVER, **(headers or {})}
    asked = [tag.strip().removeprefix("W/") for tag in request.headers.get("if-none-match", "").split(",")]
    if named["ETag"] in asked or "*" in asked:
        return Response(status_code=304, headers=named)
    return Response(make(), headers=named, media_type=media_type)


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


T = TypeVar("T")
MAX_CURSOR_LENGTH: Final = 600
Limit = Annotated[int, Query(ge=1, le=100, description="Most items of the answer.")]
Cursor = Annotated[str | None, Query(max_length=MAX_CURSOR_LENGTH, description="`next` of the page before.")]


def page_of(items: Mapping[str, T], limit: int, cursor: str | None) -> tuple[list[T], str | None]:
    """The items whose ids come after the cursor, in the order of ids, and the cursor of the next page."""
    after = "" if cursor is None else _id_of(cursor)
    ids = sorted(one for one in items if one > after)
    shown = ids[:limit]
    return [items[one] for one in shown], _cursor_of(shown[-1]) if len(ids) > limit else None


def _cursor_of(last: str) -> str:
    return urlsafe_b64encode(last.encode()).decode().rstrip("=")


def _id_of(cursor: str) -> str:
    try:
        last = urlsafe_b64decode(cursor.encode("ascii") + b"=" * (-len(cursor) % 4)).decode()
    except ValueError:  # UnicodeError and binascii's are of this kind
        last = ""
    if not last or _cursor_of(last) != cursor:
        raise Unprocessable("?cursor", "not a cursor that this service gave; leave it out for the first page")
    return last
