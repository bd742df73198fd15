"""Rooms and homes that have what a graph asks for, found in bounded time, each with its explanation.

Rooms in the body of a request: native JSON read into a Layout or a Home, every fault with its pointer.

Rooms as HTTP shows them: in a list, or whole with problems, spots and graph.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Final
from urllib.parse import quote

from planner_service.api.errors import Unprocessable
from planner_service.api.layouts.graph_endpoints import edges_of
from planner_service.api.layouts.schemas import LayoutAsk
from planner_service.grounding.room_report import survey
from planner_service.library.library import Shelves
from scene_graphs.affordances.affordances import Spot
from scene_graphs.errors import FieldPath
from scene_graphs.furniture import Furniture, canonical_room, display_name
from scene_graphs.graph.furniture_graph import FurnitureGraph
from scene_graphs.graph.merge import side_by_side
from scene_graphs.home import Home, home_from_dict
from scene_graphs.json_fields import Json
from scene_graphs.layout import Layout, LayoutError, layout_from_dict, layout_to_dict
from scene_graphs.retrieval.home_retrieval import HomeMatch, retrieve_home
from scene_graphs.retrieval.layout_index import LayoutIndex, LayoutMatch
from scene_graphs.retrieval.match_explanation import Explanation, explain

EFFORT: Final = 4_000_000
"""Nodes of the query, times steps of the search in all rooms or homes: a second or two at most."""
MIN_STEPS, MAX_STEPS = 50, 100_000
MAX_HOMES: Final = 5_000
"""Homes of several rooms that are searched."""


@dataclass(frozen=True)
class Retrieved:
    """A room, or several, and why."""

    match: LayoutMatch | HomeMatch
    told: Explanation

    @property
    def layout_ids(self) -> tuple[str, ...]:
        """The rooms, one or more."""
        return (self.match.layout_id,) if isinstance(self.match, LayoutMatch) else self.match.layout_ids


def retrieved(
    index: LayoutIndex, query: FurnitureGraph, k: int, rooms: Sequence[str] = (), max_rooms: int = 1
) -> list[Retrieved]:
    """The k nearest rooms of the types, all if none is named; with `max_rooms` above 1 the nearest homes of so many.

    What the bounded effort cannot prove is not `exact`. Raises NoSuitableRoom where there is no room of a type, and
    ValueError for a query that is empty or too large.
    """
    named = list(dict.fromkeys(canonical_room(room) for room in rooms))
    kinds: Sequence[str | None] = named or [None]
    effort = max(EFFORT // max(len(query), 1), MIN_STEPS)
    if max_rooms > 1:
        homes = retrieve_home(index, query, max_rooms, k, named, limit=MAX_STEPS, budget=MAX_HOMES, effort=effort)
        return [Retrieved(match, explain(query, _together(index, match), match, index.costs)) for match in homes]
    size = sum(len(index.of_type(kind)) for kind in kinds)
    steps = min(max(effort // size, MIN_STEPS), MAX_STEPS)
    matches = [match for kind in kinds for match in index.search(query, k, kind, limit=steps)]
    # Where one type's search was cut, its nearest may be missing from all of them.
    proven = len(kinds) == 1 or all(match.exact for match in matches)
    found = {match.layout_id: replace(match, exact=match.exact and proven) for match in matches}
    best = sorted(found.values(), key=lambda match: (match.distance, match.lower_bound, match.layout_id))[:k]
    return [Retrieved(match, explain(query, index.graph(match.layout_id), match, index.costs)) for match in best]


def retrieved_to_dict(index: LayoutIndex, found: Retrieved, nodes: Sequence[Furniture]) -> Json:
    """Plain values for JSON; `nodes` are the query's as they were sent, and named by their places."""
    places = {node: place for place, node in enumerate(nodes)}
    told = found.told
    rooms = [{"layout_id": name, "room_type": index.layout(name).room_type} for name in found.layout_ids]
    return {
        **(rooms[0] if isinstance(found.match, LayoutMatch) else {"rooms": rooms}),
        "distance": told.distance,
        "exact": told.exact,
        "lower_bound": found.match.lower_bound,
        "mapping": [
            {
                "node": places[pair.asked],
                "category": pair.asked.category,
                "instance": pair.asked.instance,
                "object_id": pair.object_id,
                "given": pair.given.category,
                "level": pair.level,
                "cost": pair.cost,
            }
            for pair in sorted(told.given, key=lambda pair: places[pair.asked])
        ],
        "substitutions": [
            {
                "asked": display_name(pair.asked.category),
                "given": display_name(pair.given.category),
                "level": pair.level,
            }
            for pair in told.substitutions
        ],
        "missing": sorted(places[gap.asked] for gap in told.missing),
        "reasons": [
            {
                "node": places[gap.asked],
                "why": gap.why,
                "nearest": None if gap.nearest is None else gap.nearest.category,
                "unmet": list(gap.unmet),
            }
            for gap in sorted(told.missing, key=lambda gap: places[gap.asked])
        ],
        "extra": list(found.match.extra),
        "lost": sorted(sorted((places[first], places[second])) for first, second in told.lost),
        "costs": asdict(told.costs),
        "explanation": told.lines(),
    }


def _together(index: LayoutIndex, match: HomeMatch) -> FurnitureGraph:
    return side_by_side({place: index.graph(name) for place, name in enumerate(match.layout_ids)})


_BODY: Final = "body"
"""How the reader is told to call what it reads."""


def layout_given(ask: LayoutAsk) -> Layout:
    """The room that a body holds. Unprocessable names the field that is wrong."""
    try:
        return layout_from_dict(ask.model_dump(exclude_none=True), FieldPath((_BODY,)))
    except LayoutError as error:
        raise problem_of(error, "") from error


def home_given(row: Json, pointer: str) -> Home:
    """The home that a field of a body holds. Unprocessable names the field that is wrong."""
    try:
        return home_from_dict(row, FieldPath((_BODY,)))
    except LayoutError as error:
        raise problem_of(error, pointer) from error


def problem_of(error: LayoutError, pointer: str) -> Unprocessable:
    """What the reader said of `body.objects[3].size`, at "/objects/3/size"; of anything else, at the pointer."""
    root, *steps = error.at.steps or ("",)
    if root != _BODY:
        return Unprocessable(pointer, str(error))
    return Unprocessable(pointer + FieldPath(tuple(steps)).pointer, error.said)


def path_of(layout_id: str) -> str:
    """The address of a room."""
    return f"/v1/layouts/{quote(layout_id)}"


def _kept(shelves: Shelves, layout: Layout) -> Json:
    path = path_of(layout.id)
    return {
        "built_in": shelves.is_fixed_room(layout),
        "area": round(layout.area, 2),
        "links": {"self": path, "scene": f"{path}/scene.glb", "drawing": f"{path}/drawing.svg"},
    }


def room_summary(shelves: Shelves, layout: Layout) -> Json:
    """A room in a list."""
    counts = Counter(placed.category for placed in layout.objects)
    return {
        "id": layout.id,
        "room_type": layout.room_type,
        "tags": list(layout.tags),
        "source": layout.source,
        "licence": layout.licence,
        "objects": len(layout.objects),
        "furniture": dict(sorted(counts.items())),
        **_kept(shelves, layout),
    }


def room_shown(shelves: Shelves, layout: Layout) -> Json:
    """A room whole, with what was found when it was looked over."""
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
        **_kept(shelves, layout),
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
