"""Layouts: the library of rooms, what a body can do in each, and the rooms that fit a graph of furniture best."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from importlib.metadata import version
from typing import Annotated, Final, Literal
from urllib.parse import quote

from fastapi import APIRouter, Path, Query, Request, Response

from motion_backend.formats.glb import scene_glb
from planner_service.errors import Conflict, NotFound, Unprocessable
from planner_service.parts import Parts, PartsDep
from planner_service.routes.caching import unchanging
from planner_service.routes.layout_graphs import edges_of, graph_of, nodes_of
from planner_service.routes.rooms import layout_given
from planner_service.schemas.layouts import (
    LayoutAsk,
    LayoutMatches,
    LayoutPage,
    LayoutShown,
    RetrieveAsk,
)
from planner_service.schemas.pages import Cursor, Limit, page_of
from planner_service.schemas.stories import Json
from planner_service.shelves import AbsentError, FixedError, FullError, TakenError
from planner_service.surveying import survey
from scene_graphs.furniture import ROOM_TYPES, Furniture, canonical_room
from scene_graphs.homes import home_from_layouts
from scene_graphs.layouts import Layout, layout_to_dict
from scene_graphs.retrieval import LayoutIndex, LayoutMatch, NoSuitableRoom
from scene_graphs.surfaces import Spot

router = APIRouter(prefix="/v1/layouts", tags=["layouts"])
LayoutId = Annotated[str, Path(max_length=400, description="The id of a room; it may hold slashes.")]
GLB: Final = "model/gltf-binary"
REVALIDATED: Final = {"Cache-Control": "private, no-cache"}
"""Kept, but asked for again each time: a room may be removed and another be given its id."""
EFFORT: Final = 4_000_000
"""Rooms, times nodes of the query, times steps of the search in each: some seconds at most."""
LEAST_STEPS, MOST_STEPS = 50, 100_000


@router.get("", response_model=LayoutPage)
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
    return {"items": [_summary(parts, layout) for layout in shown], "next": following}


@router.post(
    "",
    status_code=201,
    response_model=LayoutShown,
    response_model_exclude_unset=True,
    responses={409: {"description": "The id is taken."}},
)
def create(
    ask: LayoutAsk,
    response: Response,
    parts: PartsDep,
    _format: Annotated[Literal["native"], Query(alias="format", description="What the body is written in.")] = "native",
) -> Json:
    """Add a room to the library. The answer says what was found when it was checked; a room with problems is kept."""
    layout = layout_given(ask)
    try:
        parts.shelves.add_layouts(layout)
    except (TakenError, FullError) as error:
        raise Conflict(str(error)) from error
    response.headers["Location"] = _path(layout.id)
    return _shown(parts, layout)


@router.post("/retrieve", response_model=LayoutMatches)
def retrieve(ask: RetrieveAsk, parts: PartsDep) -> Json:
    """The rooms that have the furniture of a graph, nearest first, and what would stand for each of its pieces."""
    query = graph_of(ask.graph, "/graph")
    index = parts.shelves.layouts()
    kinds: list[str | None] = list(dict.fromkeys(canonical_room(room) for room in ask.rooms)) or [None]
    for place, room in enumerate(ask.rooms):
        if not _has(index, room):
            raise Unprocessable(f"/rooms/{place}", f"there is no room of this type; try {', '.join(ROOM_TYPES)}")
    size = sum(len(index.of_type(kind)) for kind in kinds)
    steps = min(max(EFFORT // (size * len(query)), LEAST_STEPS), MOST_STEPS)
    found = {match.layout_id: match for kind in kinds for match in index.search(query, ask.k, kind, limit=steps)}
    best = sorted(found.values(), key=lambda match: (match.distance, match.lower_bound, match.layout_id))[: ask.k]
    places = {node: place for place, node in enumerate(nodes_of(ask.graph))}
    return {"matches": [_matched(index, match, places) for match in best]}


@router.get("/{layout_id:path}/scene.glb", response_class=Response, responses={200: {"content": {GLB: {}}}})
def scene(layout_id: LayoutId, request: Request, parts: PartsDep) -> Response:
    """The room with its walls, floor and furniture."""
    layout = _layout(parts, layout_id)

    def make() -> bytes:
        return scene_glb(home_from_layouts([layout], 0))

    return unchanging(request, f"{_etag(layout)}-scene", make, GLB, REVALIDATED)


@router.get("/{layout_id:path}", response_model=LayoutShown)
def show(layout_id: LayoutId, request: Request, parts: PartsDep) -> Response:
    """A room whole: its native JSON, its problems, where a body can sit, lie or touch, and its graph."""
    layout = _layout(parts, layout_id)

    def make() -> bytes:
        return json.dumps(_shown(parts, layout), ensure_ascii=False, allow_nan=False).encode()

    return unchanging(request, _etag(layout), make, "application/json", REVALIDATED)


@router.delete(
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


def _path(layout_id: str) -> str:
    return f"/v1/layouts/{quote(layout_id)}"


def _kept(parts: Parts, layout: Layout) -> Json:
    path = _path(layout.id)
    return {
        "built_in": parts.shelves.is_fixed_room(layout),
        "area": round(layout.area, 2),
        "links": {"self": path, "scene": f"{path}/scene.glb"},
    }


def _summary(parts: Parts, layout: Layout) -> Json:
    counts = Counter(placed.category for placed in layout.objects)
    return {
        "id": layout.id,
        "room_type": layout.room_type,
        "tags": list(layout.tags),
        "source": layout.source,
        "licence": layout.licence,
        "objects": len(layout.objects),
        "furniture": dict(sorted(counts.items())),
        **_kept(parts, layout),
    }


def _shown(parts: Parts, layout: Layout) -> Json:
    looked = survey(layout)
    graph, nodes = looked.graph, list(looked.graph)
    places = {node: place for place, node in enumerate(nodes)}
    shown = [
        {
            "category": node.category,
            "instance": node.instance,
            "object_id": graph.nodes[node]["object_id"],
            "minor": graph.nodes[node]["minor"],
        }
        for node in nodes
    ]
    return {
        **layout_to_dict(layout),
        **_kept(parts, layout),
        "problems": list(looked.problems),
        "spots": [_spot(spot, usable) for spot, usable in looked.spots],
        "graph": {"nodes": shown, "edges": edges_of(graph, places)},
    }


def _spot(spot: Spot, usable: bool) -> Json:
    return {
        "object_id": spot.object_id,
        "affordance": spot.affordance,
        "point": [round(value, 4) for value in spot.point],
        "normal": [round(value, 4) for value in spot.normal],
        "facing": round(spot.facing, 4),
        "standing": [round(value, 4) for value in spot.standing],
        "approach": round(spot.approach, 4),
        "height": spot.height,
        "usable": usable,
    }


def _matched(index: LayoutIndex, match: LayoutMatch, places: dict[Furniture, int]) -> Json:
    return {
        "layout_id": match.layout_id,
        "room_type": index.layout(match.layout_id).room_type,
        "distance": match.distance,
        "exact": match.exact,
        "lower_bound": match.lower_bound,
        "mapping": [
            {
                "node": places[node],
                "category": node.category,
                "instance": node.instance,
                "object_id": name,
                "level": level,
            }
            for node, name, level in sorted(match.mapping, key=lambda entry: places[entry[0]])
        ],
        "missing": sorted(places[node] for node in match.missing),
        "extra": list(match.extra),
    }
