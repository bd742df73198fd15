"""Rooms in the body of a request: native JSON read into a Layout or a Home, every fault with its pointer."""

from __future__ import annotations

import re
from typing import Final

from planner_service.errors import Unprocessable
from planner_service.schemas.layouts import LayoutAsk
from planner_service.schemas.stories import Json
from scene_graphs.home_rows import home_from_dict
from scene_graphs.homes import Home
from scene_graphs.layouts import Layout, LayoutError, layout_from_dict

_BODY: Final = "body"
"""How the reader is told to call what it reads."""
_PLACE: Final = re.compile(rf"^{_BODY}((?:\.[a-z_]+|\[\d+\])*)[ ,]?\s*(.*)$", re.DOTALL)


def layout_given(ask: LayoutAsk) -> Layout:
    """The room that a body holds. Unprocessable names the field that is wrong."""
    try:
        return layout_from_dict(ask.model_dump(exclude_none=True), _BODY)
    except LayoutError as error:
        raise problem_of(error, "") from error


def home_given(row: Json, pointer: str) -> Home:
    """The home that a field of a body holds. Unprocessable names the field that is wrong."""
    try:
        return home_from_dict(row, _BODY)
    except LayoutError as error:
        raise problem_of(error, pointer) from error


def problem_of(error: LayoutError, pointer: str) -> Unprocessable:
    """What the reader said, "body.objects[3].size must …", as "/objects/3/size" and "must …"."""
    match = _PLACE.match(str(error))
    if match is None:
        return Unprocessable(pointer, str(error))
    return Unprocessable(pointer + re.sub(r"[.\[]", "/", match[1]).replace("]", ""), match[2])
