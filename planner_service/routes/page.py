"""The page at `/`: built from web/ into planner_service/page, or a note that says how to build it."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from fastapi import APIRouter
from starlette.middleware.gzip import GZipMiddleware
from starlette.responses import FileResponse, HTMLResponse, Response
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Scope

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
<p>and load this page again. Everything else works without it:
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
