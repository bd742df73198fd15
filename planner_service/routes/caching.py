"""Answers that never change: named by an ETag, kept by whoever has them, and not made again for those who do."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from starlette.requests import Request
from starlette.responses import Response

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
