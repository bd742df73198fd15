"""Layouts: the library of rooms, what a body can do in each, and the rooms that fit a graph of furniture best."""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Callable
from functools import partial
from importlib.metadata import version
from typing import Annotated, Final, Literal, ParamSpec, TypeVar

from anyio import to_thread
from fastapi import APIRouter, Depends, Path, Query, Request, Response
from fastapi.concurrency import run_in_threadpool

from motion_backend.formats.glb_film import scene_glb
from planner_service.api.dependencies import PartsDep, parsed
from planner_service.api.errors import Conflict, NotFound, TooLarge, Unavailable, Unprocessable
from planner_service.api.layouts.graph_endpoints import graph_of, nodes_of
from planner_service.api.layouts.schemas import (
    LayoutAsk,
    LayoutMatches,
    LayoutPage,
    LayoutShown,
    LayoutsImported,
    RetrieveAsk,
)
from planner_service.api.layouts.views import (
    layout_given,
    path_of,
    retrieved,
    retrieved_to_dict,
    room_shown,
    room_summary,
)
from planner_service.api.rate_limit import MAX_BYTES
from planner_service.api.web_page import Cursor, Limit, page_of, unchanging
from planner_service.components import Parts
from planner_service.library.import_layouts import take_in
from planner_service.library.library import AbsentError, FixedError, FullError, TakenError
from planner_service.output.room_pictures import Shown, picture
from scene_graphs.furniture import ROOM_TYPES, canonical_room
from scene_graphs.home import home_from_layouts
from scene_graphs.json_fields import Json
from scene_graphs.layout import Layout, LayoutError, layout_to_dict
from scene_graphs.loaders import Options, Source
from scene_graphs.retrieval.layout_index import LayoutIndex, NoSuitableRoom

P = ParamSpec("P")
T = TypeVar("T")


def _shown_over(
    graph: Annotated[bool, Query(description="Whether the furniture graph is drawn.")] = True,
    spots: Annotated[bool, Query(description="Whether surfaces and standing points are drawn.")] = True,
    path: Annotated[bool, Query(description="Whether a path from the door is drawn.")] = True,
    to: Annotated[str | None, Query(max_length=200, description="The object the path leads to.")] = None,
) -> Shown:
    return Shown(graph, spots, path, to)


ShownDep = Annotated[Shown, Depends(_shown_over)]
layouts_router = APIRouter(prefix="/v1/layouts", tags=["layouts"])
LayoutId = Annotated[str, Path(max_length=400, description="The id of a room; it may hold slashes.")]
GLB: Final = "model/gltf-binary"
SVG: Final = "image/svg+xml"
PNG: Final = "image/png"
OTHER: Final = "application/octet-stream"
"""A scene file of another format, sent as it is."""
Format = Literal["native", "3d-front", "procthor", "virtualhome", "glb", "obj"]
"""What is one file; scans that are folders of files are taken in on the command line."""
MAX_UNPACKED_BYTES: Final = 32 << 20
"""Bytes of a scene file that was sent packed."""
MAX_WAITING: Final = 8
"""Scene files that wait to be read, each held in memory."""
MAX_ROOMS: Final = 200
"""Of one scene file: each is looked over while the caller waits, about 0.1 s."""
DRAWN: Final = {"Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'"}
"""A picture that is opened by itself runs nothing and loads nothing."""
REVALIDATED: Final = {"Cache-Control": "private, no-cache"}
"""Kept, but asked for again each time: a room may be removed and another be given its id."""


@layouts_router.get("", response_model=LayoutPage)
def list_layouts(
    parts: PartsDep,
    limit: Limit = 20,
    cursor: Cursor = None,
    room: Annotated[str | None, Query(min_length=1, max_length=60, description="Only rooms of this type.")] = None,
) -> Json:
    """The rooms there are, in the order of their ids."""
    kind = None if room is None else canonical_room(room)
    wanted = {
        layout.id: layout
        for layout in parts.shelves.rooms().values()
        if kind is None or kind == layout.room_type or kind in layout.tags
    }
    shown, following = page_of(wanted, limit, cursor)
    return {"items": [room_summary(parts.shelves, layout) for layout in shown], "next": following}


@layouts_router.post(
    "",
    status_code=201,
    response_model=LayoutShown | LayoutsImported,
    response_model_exclude_unset=True,
    responses={409: {"description": "The id of a room is taken, or the library is full."}},
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {
                "application/json": {"schema": {"$ref": "#/components/schemas/LayoutAsk"}},
                OTHER: {"schema": {"type": "string", "format": "binary"}},
            },
        }
    },
)
async def create(
    request: Request,
    response: Response,
    parts: PartsDep,
    format_name: Annotated[Format, Query(alias="format", description="What the body is written in.")] = "native",
    name: Annotated[
        str, Query(min_length=1, max_length=120, description="The file's name; rooms that have none are named by it.")
    ] = "body",
    scan: Annotated[
        str | None, Query(max_length=200, description="procthor: the numbers of the houses to take, 17 or 0-99.")
    ] = None,
    room: Annotated[str | None, Query(max_length=60, description="The room type, where the file does not say.")] = None,
    up: Annotated[Literal["y", "z"], Query(description="glb, obj: the axis that points up.")] = "y",
    front: Annotated[Literal["+z", "-z", "+x", "-x"], Query(description="glb, obj: where fronts point.")] = "+z",
    unit: Annotated[float, Query(gt=0, le=1000, description="glb, obj: metres a unit; 0.01 for centimetres.")] = 1.0,
) -> Json:
    """Add a room of your own in our native JSON, or all rooms of a scene file in another format.

    A room with problems is kept; the answer says what they are. Of another format the body is the file itself (gzip is
    unpacked), and the answer lists the rooms with what was kept, dropped and guessed.
    """
    if format_name != "native" and parts.importing.statistics().tasks_waiting >= MAX_WAITING:
        raise Unavailable("other scene files are being read; send it again", retry_after=10)
    body = await request.body()
    if format_name == "native":
        if len(body) > MAX_BYTES:
            raise TooLarge(f"a body of this format has at most {MAX_BYTES} bytes")
        layout = layout_given(await run_in_threadpool(parsed, LayoutAsk, request, body))
        await run_in_threadpool(_adding, parts.shelves.add_layouts, layout)
        response.headers["Location"] = path_of(layout.id)
        return await run_in_threadpool(room_shown, parts.shelves, layout)
    options = Options(scan=scan, room_type=room, up=up, front=front, unit=unit, most_rooms=MAX_ROOMS)
    source = Source.of_bytes(name, body, MAX_UNPACKED_BYTES)
    try:
        take = partial(_adding, take_in, parts.shelves, source, format_name, options)
        taken = await to_thread.run_sync(take, limiter=parts.importing)
    except LayoutError as error:
        raise Unprocessable("", str(error)) from error
    return {
        "items": [room_summary(parts.shelves, layout) for layout in taken.imported.layouts],
        "problems": {name: list(found) for name, found in taken.problems.items() if found},
        "report": taken.imported.report.to_dict(),
    }


@layouts_router.post("/retrieve", response_model=LayoutMatches)
def retrieve(ask: RetrieveAsk, parts: PartsDep) -> Json:
    """The rooms that have the furniture of a graph, nearest first, and what would stand for each of its pieces; or,
    with `max_rooms` above 1, the homes of one room and more."""
    query = graph_of(ask.graph, "/graph")
    index = parts.shelves.layouts()
    for place, room in enumerate(ask.rooms):
        if not _has(index, room):
            raise Unprocessable(f"/rooms/{place}", f"there is no room of this type; try {', '.join(ROOM_TYPES)}")
    found = retrieved(index, query, ask.k, ask.rooms, ask.max_rooms)
    return {"matches": [retrieved_to_dict(index, one, nodes_of(ask.graph)) for one in found]}


@layouts_router.get("/{layout_id:path}/scene.glb", response_class=Response, responses={200: {"content": {GLB: {}}}})
def scene(layout_id: LayoutId, request: Request, parts: PartsDep) -> Response:
    """The room with its walls, floor and furniture."""
    layout = _layout(parts, layout_id)

    def make() -> bytes:
        return scene_glb(home_from_layouts([layout], 0))

    return unchanging(request, f"{_etag(layout)}-scene", make, GLB, REVALIDATED)


@layouts_router.get("/{layout_id:path}/drawing.svg", response_class=Response, responses={200: {"content": {SVG: {}}}})
def drawing_svg(layout_id: LayoutId, request: Request, parts: PartsDep, shown: ShownDep) -> Response:
    """The room from above: names, graph, surfaces and standing points, and a path from the door."""
    return _drawing(_layout(parts, layout_id), shown, request, "svg")


@layouts_router.get("/{layout_id:path}/drawing.png", response_class=Response, responses={200: {"content": {PNG: {}}}})
def drawing_png(layout_id: LayoutId, request: Request, parts: PartsDep, shown: ShownDep) -> Response:
    """The same as pixels."""
    return _drawing(_layout(parts, layout_id), shown, request, "png")


@layouts_router.get("/{layout_id:path}", response_model=LayoutShown)
def show(layout_id: LayoutId, request: Request, parts: PartsDep) -> Response:
    """A room whole: its native JSON, its problems, where a body can sit, lie or touch, and its graph."""
    layout = _layout(parts, layout_id)

    def make() -> bytes:
        return json.dumps(room_shown(parts.shelves, layout), ensure_ascii=False, allow_nan=False).encode()

    return unchanging(request, _etag(layout), make, "application/json", REVALIDATED)


@layouts_router.delete(
    "/{layout_id:path}", status_code=204, responses={409: {"description": "It is shipped, or in SIMS_LAYOUTS."}}
)
def delete(layout_id: LayoutId, parts: PartsDep) -> None:
    """Remove a room that a user added; stories that play there keep their own copy."""
    try:
        parts.shelves.remove_layout(layout_id)
    except AbsentError as error:
        raise NotFound("there is no such room; GET /v1/layouts lists them") from error
    except FixedError as error:
        raise Conflict("this room is shipped with the service and cannot be deleted") from error


def _adding(add: Callable[P, T], *given: P.args, **named: P.kwargs) -> T:
    """What `add` gives; Conflict where the library does not take it."""
    try:
        return add(*given, **named)
    except (TakenError, FullError) as error:
        raise Conflict(str(error)) from error


def _drawing(layout: Layout, shown: Shown, request: Request, ending: str) -> Response:
    if shown.to is not None and all(placed.id != shown.to for placed in layout.objects):
        raise Unprocessable("?to", "the room has no object of this id")

    def make() -> bytes:
        stream = io.BytesIO()
        picture(layout, shown, stream, ending)
        return stream.getvalue()

    drawn = hashlib.sha256(repr(shown).encode()).hexdigest()[:8]
    return unchanging(
        request, f"{_etag(layout)}-{drawn}-{ending}", make, {"svg": SVG, "png": PNG}[ending], REVALIDATED | DRAWN
    )


def _has(index: LayoutIndex, room: str) -> bool:
    try:
        return len(index.of_type(room)) > 0
    except NoSuitableRoom:
        return False


def _layout(parts: Parts, layout_id: str) -> Layout:
    layout = parts.shelves.rooms().get(layout_id)
    if layout is None:
        raise NotFound("there is no such room; GET /v1/layouts lists them")
    return layout


def _etag(layout: Layout) -> str:
    """Of the room and of the program that looks it over."""
    text = json.dumps([version("sims-stories"), layout_to_dict(layout)])
    return hashlib.sha256(text.encode()).hexdigest()[:32]
