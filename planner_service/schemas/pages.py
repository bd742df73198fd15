"""Lists in pages: how many, from where, and the cursor of the page that follows."""

from __future__ import annotations

from base64 import urlsafe_b64decode, urlsafe_b64encode
from collections.abc import Mapping
from typing import Annotated, Final, TypeVar

from fastapi import Query

from planner_service.errors import Unprocessable

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
