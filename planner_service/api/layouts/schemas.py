"""Rooms over HTTP: the native JSON of a layout, what a body can do there, and how well rooms fit a graph.

Graphs of furniture over HTTP: the pieces that scripts use and which of them belong together.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from planner_service.api.stories.schemas import Ask, SubstitutionShown
from scene_graphs.boxes import MAX_PARTS, ROLES
from scene_graphs.graph.edit_distance import MAX_NODES
from scene_graphs.home import MAX_ROOMS
from scene_graphs.json_fields import MAX_COORDINATE
from scene_graphs.layout import MAX_CORNERS, MAX_OBJECTS, MAX_SIZE, MAX_TAGS, MIN_ROOM_HEIGHT, MIN_SIZE

Affordance = Literal["sit", "lie", "touch"]
MAX_GRAPHS = 12
"""As many as a story has short scripts."""
MAX_EDGES = 200
Place = Annotated[int, Field(ge=0, lt=MAX_NODES)]
Edge = Annotated[list[Place], Field(min_length=2, max_length=2)]


class NodeAsk(Ask):
    """A piece of furniture that a script uses."""

    category: str = Field(min_length=1, max_length=60, description='A furniture word, such as "sofa".')
    instance: int = Field(1, ge=1, le=99, description="Tells two pieces of a kind apart.")
    needs: list[Affordance] = Field([], max_length=3, description="What a body must be able to do there.")


class GraphAsk(Ask):
    """Furniture, and which pieces belong together."""

    nodes: list[NodeAsk] = Field(min_length=1, max_length=MAX_NODES)
    edges: list[Edge] = Field([], max_length=MAX_EDGES, description="Pairs of places in `nodes`.")


class MergeAsk(Ask):
    """One graph a script."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "graphs": [
                        {
                            "nodes": [{"category": "sofa", "needs": ["sit"]}, {"category": "coffee table"}],
                            "edges": [[0, 1]],
                        },
                        {
                            "nodes": [{"category": "couch"}, {"category": "sofa", "instance": 2}, {"category": "lamp"}],
                            "edges": [[1, 2]],
                        },
                    ]
                }
            ]
        }
    )

    graphs: list[GraphAsk] = Field(min_length=1, max_length=MAX_GRAPHS)
    method: Literal["canonical", "aligned"] = Field(
        "canonical", description="Pieces numbered in their order, as in the paper; or so that most edges are shared."
    )


class GraphNode(BaseModel):
    """A piece of furniture."""

    category: str
    instance: int


class MergedNode(GraphNode):
    """A piece of furniture that one or several scripts use."""

    needs: list[Affordance] = Field(description="All that any of the scripts does there.")
    minor: bool = Field(description="Whether it is a less important node (SIMS 3.2).")


class MergedGraph(BaseModel):
    """The furniture of all scripts: of every category as many pieces as the script has that uses most."""

    nodes: list[MergedNode]
    edges: list[tuple[int, int]] = Field(description="Pairs of places in `nodes`, the smaller first.")


class Merged(BaseModel):
    """One graph for many scripts, and where every script's own pieces went in it."""

    graph: MergedGraph
    instance_maps: list[list[int]] = Field(
        description="For each graph that was sent, and each of its nodes, the place in `graph.nodes`."
    )


Name = Annotated[str, Field(min_length=1, max_length=200)]
Coordinate = Annotated[float, Field(ge=-MAX_COORDINATE, le=MAX_COORDINATE)]
Length = Annotated[float, Field(ge=MIN_SIZE, le=MAX_SIZE)]
Point2 = Annotated[list[Coordinate], Field(min_length=2, max_length=2)]
Point3 = Annotated[list[Coordinate], Field(min_length=3, max_length=3)]
Size3 = Annotated[list[Length], Field(min_length=3, max_length=3)]
MAX_OPENINGS = 100
Box = Annotated[list[str | Point3], Field(min_length=3, max_length=3)]
EXAMPLE: dict[str, Any] = {
    "id": "my-nook",
    "room_type": "study",
    "floor_polygon": [[-1.5, -1.5], [-1.5, 1.5], [1.5, 1.5], [1.5, -1.5]],
    "doors": [{"segment": [[-1.5, -0.4], [-1.5, 0.4]]}],
    "objects": [
        {"id": "armchair_1", "category": "armchair", "position": [0.8, 0.0, -0.8], "size": [0.8, 0.9, 0.8], "yaw": 0.0},
        {"id": "bookshelf_1", "category": "bookshelf", "position": [1.0, 0.0, 1.3], "size": [0.8, 1.9, 0.3], "yaw": 3},
    ],
}  # fmt: skip


class Opening(Ask):
    """A door or window."""

    segment: Annotated[list[Point2], Field(min_length=2, max_length=2)] = Field(
        description="Two [x, z] points on the outline."
    )
    bottom: float = Field(0.0, ge=0, le=MAX_SIZE, description="Height in metres where the opening begins.")
    top: float = Field(2.1, ge=0, le=MAX_SIZE, description="Height in metres where it ends.")


class Piece(Ask):
    """A piece of furniture."""

    id: Name
    category: Name = Field(description='A furniture word; synonyms such as "couch" are read as the word we use.')
    position: Point3 = Field(description="Centre of the bottom face: [x, y, z] in metres, y up.")
    size: Size3 = Field(description="Width x, height y and depth z in metres, at yaw 0.")
    yaw: float = Field(0.0, ge=-100, le=100, description="Radians about +Y, counter-clockwise from above; 0 faces +Z.")
    parent: Name | None = Field(None, description="The object it stands on.")
    mesh: Name | None = Field(None, description="A name of the maker's for its shape; kept, not used.")
    shape: list[Box] | None = Field(
        None,
        max_length=MAX_PARTS,
        description="Solid boxes it is made of, each [role, low, high] in its own frame (origin at the bottom centre, "
        f"front +z), with a role of {', '.join(sorted(ROLES))}; left out: the usual form of its category.",
    )


class LayoutAsk(Ask):
    """One furnished room in our native format: right-handed, y up, metres, radians."""

    model_config = ConfigDict(json_schema_extra={"examples": [EXAMPLE]})

    id: str = Field(min_length=1, max_length=120, description="Letters, digits and _.:- between slashes.")
    source: Name = Field("user", description="Where the room comes from.")
    licence: Name = Field("unknown", description="Under which it may be passed on.")
    room_type: Name = Field(description='"bedroom", "living_room", "dining_room", "study", or another name.')
    tags: list[Name] = Field([], max_length=MAX_TAGS, description="Every room type it can serve as.")
    floor_polygon: list[Point2] = Field(
        min_length=3, max_length=MAX_CORNERS, description="[x, z] corners in order, not closed."
    )
    height: float = Field(2.7, ge=MIN_ROOM_HEIGHT, le=MAX_SIZE, description="Metres.")
    doors: list[Opening] = Field([], max_length=MAX_OPENINGS)
    windows: list[Opening] = Field([], max_length=MAX_OPENINGS)
    objects: list[Piece] = Field([], max_length=MAX_OBJECTS)


class LayoutLinks(BaseModel):
    """Where else to ask about a room."""

    self: str
    scene: str = Field(description="The room as GLB.")
    drawing: str = Field(description="The room from above, as SVG.")


class LayoutSummary(BaseModel):
    """A room in a list."""

    id: str
    room_type: str
    tags: list[str]
    source: str
    licence: str
    built_in: bool = Field(description="Whether it is shipped with the service.")
    area: float = Field(description="Of the floor, in square metres.")
    objects: int = Field(description="How many pieces of furniture.")
    furniture: dict[str, int] = Field(description="How many of each category.")
    links: LayoutLinks


class LayoutPage(BaseModel):
    """Rooms, in the order of their ids."""

    items: list[LayoutSummary]
    next: str | None = Field(description="The cursor of the next page; null on the last.")


class SpotShown(BaseModel):
    """A place on an object where a body can do one thing, and where it stands before and after."""

    object_id: str
    affordance: Affordance
    point: Point3 = Field(description="On the surface: under the pelvis, or where the hand goes.")
    normal: Point3 = Field(description="Unit, out of the surface.")
    facing: float = Field(description="Yaw the body looks to; lying: yaw from the pelvis to the head.")
    standing: Point2 = Field(description="[x, z] of the pelvis standing before and after.")
    approach: float = Field(description="Yaw of the body at `standing`, just before.")
    height: Literal["low", "medium", "high"] = Field(description="Of what is touched.")
    usable: bool = Field(description="Whether a body gets to `standing` from the door and fits there.")


class RoomNode(GraphNode):
    """A piece of furniture in a room's graph."""

    object_id: str
    minor: bool = Field(description="Whether it is a less important node (SIMS 3.2).")


class RoomGraph(BaseModel):
    """The furniture of a room; an edge joins what stands near each other with nothing between."""

    nodes: list[RoomNode]
    edges: list[tuple[int, int]] = Field(description="Pairs of places in `nodes`, the smaller first.")


class LayoutShown(LayoutAsk):
    """A room whole: its native JSON, what was found when it was checked, and its graph."""

    id: str
    built_in: bool
    area: float = Field(description="Of the floor, in square metres.")
    problems: list[str] = Field(description="What is wrong with the room, one sentence each; empty: all can be used.")
    spots: list[SpotShown] = Field(description="Where a body can sit, lie or touch; of each object the usable first.")
    graph: RoomGraph
    links: LayoutLinks


class Dropped(BaseModel):
    """Things of a file that were left out for one reason."""

    why: str
    count: int
    examples: list[str] = Field(description="The first few of them, by name.")


class ImportReport(BaseModel):
    """What a reader made of a file."""

    rooms: int
    objects: dict[str, int] = Field(description="What was kept, by category.")
    dropped: list[Dropped] = Field(description="What was left out and why, the most frequent reason first.")
    estimated: dict[str, int] = Field(description="How often something was guessed that the file does not say.")


class LayoutsImported(BaseModel):
    """The rooms that a file held, now in the library, and what was kept, dropped and guessed."""

    items: list[LayoutSummary]
    problems: dict[str, list[str]] = Field(description="By room: what is wrong with it, where anything is.")
    report: ImportReport


class RetrieveAsk(Ask):
    """The furniture that is needed, and in which kinds of room it is looked for."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "graph": {
                        "nodes": [{"category": "sofa", "instance": 1, "needs": ["sit"]}, {"category": "bookshelf"}],
                        "edges": [[0, 1]],
                    },
                    "k": 3,
                    "rooms": ["living_room"],
                }
            ]
        }
    )

    graph: GraphAsk
    k: int = Field(5, ge=1, le=50, description="How many rooms, or homes, at most.")
    rooms: list[Annotated[str, Field(min_length=1, max_length=60)]] = Field(
        [], max_length=4, description="Room types; empty: any."
    )
    max_rooms: int = Field(1, ge=1, le=MAX_ROOMS, description="Above 1, homes of one to so many rooms are looked for.")


class MappedPiece(BaseModel):
    """What stands in a room for a node of the query."""

    node: int = Field(description="Place in the query's `nodes`.")
    category: str
    instance: int
    object_id: str = Field(description='The room\'s; in a home "place in `rooms`/object".')
    given: str = Field(description="The category of that object.")
    level: Literal["same", "class", "group"] = Field(description="How near it is to what was asked for.")
    cost: int


class MissingPiece(BaseModel):
    """Why nothing stands for a node of the query."""

    node: int = Field(description="Place in the query's `nodes`.")
    why: Literal["absent", "unfit", "taken", "spare"] = Field(
        description="Nothing of its group is there; what is there cannot be used so; all that could is used already; "
        "or something could, but the search ended before it was tried."
    )
    nearest: str | None = Field(description="The category of what came nearest.")
    unmet: list[Affordance] = Field(description="What cannot be done there.")


class CostSplit(BaseModel):
    """What a distance is made of; the sum is the distance."""

    substitutions: int
    missing: int
    extra: int = Field(description="For furniture that the query does not use.")
    lost_relations: int
    extra_relations: int
    more_rooms: int


class Match(BaseModel):
    """How well something has what was asked for (SIMS 3.2), and why."""

    distance: int = Field(description="Simplified graph edit distance; 0: exactly this.")
    exact: bool = Field(description="Whether distance and rank are proven; of several rooms: that none are nearer.")
    lower_bound: int
    mapping: list[MappedPiece]
    substitutions: list[SubstitutionShown] = Field(description="Where something else than asked stands in.")
    missing: list[int] = Field(description="Places in the query's `nodes` of what is lacking.")
    reasons: list[MissingPiece] = Field(description="Why each of those is.")
    extra: list[str] = Field(description="Ids of objects that the query does not use.")
    lost: list[tuple[int, int]] = Field(description="Edges of the query whose pieces do not stand near each other.")
    costs: CostSplit
    explanation: list[str] = Field(description="All of this in plain English.")


class LayoutMatch(Match):
    """How well one room has what was asked for."""

    layout_id: str
    room_type: str


class MatchedRoom(BaseModel):
    """A room of a home."""

    layout_id: str
    room_type: str


class HomeMatch(Match):
    """How well one room or several together have what was asked for."""

    rooms: list[MatchedRoom]


class LayoutMatches(BaseModel):
    """The nearest rooms, nearest first; homes if more than one room was allowed."""

    matches: list[LayoutMatch | HomeMatch]
