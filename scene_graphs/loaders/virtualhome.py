"""VirtualHome v1 scene graphs: flats whose nodes have boxes but no rotation."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

from scene_graphs.boxes import Point3
from scene_graphs.errors import FieldPath
from scene_graphs.json_fields import MAX_COORDINATE, LayoutError, Row, read_point3, read_rows, read_text
from scene_graphs.layout import Layout, Placed
from scene_graphs.loaders.doors_and_windows import Gap, gap_around, gaps_of_rooms
from scene_graphs.loaders.floor_polygon import floor_around, floor_from_boxes
from scene_graphs.loaders.frames import point_from_unity
from scene_graphs.loaders.front_direction import faced
from scene_graphs.loaders.furniture_names import exact_category, meaning, rooms_served
from scene_graphs.loaders.plan_boxes import UprightBox
from scene_graphs.loaders.room_builder import Intake, RoomIntake
from scene_graphs.loaders.scene_source import Source

MAX_NODES: Final = 20_000
MAX_EDGES: Final = 2_000_000
MAX_ROOMS_PER_FLAT: Final = 100
FURNISHING: Final = frozenset({"Furniture", "Appliances", "Electronics", "Lamps", "Decor"})
"""Node categories that furnish a room; the rest is the building, or small things to pick up."""
_BUILDING: Final = frozenset({"Walls", "Ceiling", "Doors", "Windows"})
_LEFT_OUT: Final = frozenset({"stall", "showerstall", "faucet", "breadslice"})
"""Classes that stand around or in other furniture and have no use of their own."""
_HANGING: Final = frozenset({"curtain", "curtains"})
_WORDS: Final = {
    "bathroomcounter": "bathroom_counter",
    "cabinet": "dresser",
    "ceilingfan": "ceiling_fan",
    "coatrack": "coat_rack",
    "coffeemaker": "coffee_maker",
    "coffeepot": "coffee_pot",
    "cpuscreen": "monitor",
    "dishbowl": "bowl",
    "garbagecan": "trash_can",
    "kitchencabinets": "kitchen_cabinet",
    "kitchencounterdrawer": "kitchen_cabinet",
    "lightswitch": "light_switch",
    "mousemat": "mouse_mat",
    "orchid": "plant",
    "oventray": "oven_tray",
    "photoframe": "picture",
    "pianobench": "bench",
    "powersocket": "power_socket",
    "remotecontrol": "remote_control",
    "shelf": "bookshelf",
    "stovefan": "range_hood",
    "wallphone": "wall_phone",
    "wallpictureframe": "picture",
}
_ROOMS: Final = {"livingroom": "living_room", "home_office": "study", "diningroom": "dining_room"}
_TURNED: Final = (("CPU_chair", "office_chair", 0.62), ("Recliner", "armchair", 0.67))
"""Prefabs that stand at any angle, whose stored size is no box but a turned vector: their word and square footprint."""
_BED_HEIGHT: Final = 0.65
"""Bed boxes end at .29 although pillows lie at .56."""
_HOVER: Final = 0.15
"""Furniture stands on the floor although its box begins a little above or below it."""
_THINNEST: Final = 0.005
"""Sinks have no height at all."""
_ON: Final = 0.12


class _Node(NamedTuple):
    """A thing with its box, in our frame."""

    id: str
    category: str
    class_name: str
    prefab: str
    middle: Point3
    size: Point3

    @property
    def bottom(self) -> float:
        return self.middle[1] - self.size[1] / 2

    @property
    def box(self) -> UprightBox:
        return UprightBox((self.middle[0], self.bottom, self.middle[2]), self.size)


def read_virtualhome(source: Source, intake: Intake) -> list[Layout]:
    """Every room of a flat's graph {nodes, edges}, or of a program's file that has it as `init_graph`.

    The graph stores no rotation: fronts are chosen by `faced`, and the report counts them. LayoutError if it is no
    graph.
    """
    graph = source.json()
    graph = graph.get("init_graph", graph) if isinstance(graph, dict) else graph
    if not isinstance(graph, dict) or not {"nodes", "edges"} <= graph.keys():
        raise LayoutError(f"{source.name} must be a VirtualHome graph with nodes and edges")
    flat = _Flat(graph, source.name, intake)
    stem = source.name.split(".")[0]
    rooms = [flat.fill(node, room_id, stem) for room_id, node in flat.rooms.items()]
    floors = [room.floor for room in rooms]
    for room, gaps in zip(rooms, gaps_of_rooms(flat.gaps, floors), strict=True):
        room.open(gaps)
    return [layout for room in rooms if (layout := room.finish()) is not None]


@dataclass(frozen=True)
class _Flat:
    """One graph being read."""

    graph: Row
    name: str
    intake: Intake

    @cached_property
    def nodes(self) -> dict[str, _Node]:
        """The nodes that have a box, by id."""
        found: dict[str, _Node] = {}
        for row, where in read_rows(self.graph, "nodes", FieldPath((self.name,)), MAX_NODES):
            try:
                node = _read_node(row, where)
            except LayoutError as error:
                self.intake.drop("one of the nodes that cannot be read", str(error))
                continue
            if node.id in found:
                self.intake.drop("a node whose id occurs before", node.id)
                continue
            found[node.id] = node
        return found

    @cached_property
    def rooms(self) -> dict[str, _Node]:
        """The nodes that are rooms, by id."""
        rooms = {name: node for name, node in self.nodes.items() if node.category == "Rooms"}
        if len(rooms) > MAX_ROOMS_PER_FLAT:
            raise LayoutError(f"{self.name} holds more than {MAX_ROOMS_PER_FLAT} rooms")
        return rooms

    @cached_property
    def edges(self) -> Mapping[tuple[str, str], list[str]]:
        """The targets by (relation, source)."""
        found: dict[tuple[str, str], list[str]] = defaultdict(list)
        for row, _ in read_rows(self.graph, "edges", FieldPath((self.name,)), MAX_EDGES):
            relation = row.get("relation_type")
            if relation in ("INSIDE", "ON"):
                found[relation, str(row.get("from_id"))].append(str(row.get("to_id")))
        return found

    @cached_property
    def members(self) -> Mapping[str, list[_Node]]:
        """What is inside each room, by the room's id."""
        members: dict[str, list[_Node]] = defaultdict(list)
        for node in self.nodes.values():
            if node.category == "Rooms":
                continue
            home = next((to for to in self.edges.get(("INSIDE", node.id), ()) if to in self.rooms), None)
            if home is None:
                self.intake.drop("it is inside no room", f"{node.class_name} {node.id}")
                continue
            members[home].append(node)
        return members

    @property
    def gaps(self) -> list[Gap]:
        """Doorways and windows; the box of a door's leaf has no use, that of its frame is exact."""
        frames = {"doorjamb": True, "window": False}
        found = (
            gap_around(node.box.corners, frames[node.class_name])
            for node in self.nodes.values()
            if node.class_name in frames
        )
        return [gap for gap in found if gap is not None]

    def fill(self, node: _Node, room_id: str, stem: str) -> RoomIntake:
        """A room with all that furnishes it."""
        tiles = [_plan_box(tile) for tile in self.members[room_id] if tile.class_name == "floor"]
        floor = floor_from_boxes(tiles)
        if floor is None:
            # The room's own box is up to one tile too large.
            self.intake.guess("floor")
            floor = floor_from_boxes([_plan_box(node)])
        room_type = _ROOMS.get(node.class_name, node.class_name)
        room = self.intake.room(f"{stem}/{room_id}", room_type, floor, source="virtualhome", height=node.size[1])
        self._furnish(room, self.members[room_id])
        outline = floor or (floor_around(room.objects) if room.objects else ())
        room.objects = faced(room.objects, outline, {placed.id for placed in room.objects})
        for _ in room.objects:
            self.intake.guess("front")
        room.tags = rooms_served(room.tags[0], [placed.category for placed in room.objects])
        return room

    def _furnish(self, room: RoomIntake, members: list[_Node]) -> None:
        # What carries something begins below it, so that it comes first.
        placed_by_node: dict[str, Placed] = {}
        places: set[tuple[str, Point3, Point3]] = set()
        for node in sorted(members, key=lambda node: node.bottom):
            what = f"{node.class_name} {node.id}"
            if node.class_name == "floor" or node.category in _BUILDING:
                continue
            if node.category not in FURNISHING:
                self.intake.drop("a small thing to pick up, or nobody's furniture", what)
                continue
            if node.class_name in _LEFT_OUT:
                self.intake.drop("it stands around or in other furniture", what)
                continue
            if (node.class_name, node.middle, node.size) in places:
                self.intake.drop("the same thing twice at one place", what)
                continue
            places.add((node.class_name, node.middle, node.size))
            word, position, size = _furniture(node)
            parent = self._parent(node, placed_by_node)
            placed = room.add(node.id, word, position, size, 0.0, parent.id if parent else None)
            if placed is not None:
                placed_by_node[node.id] = placed

    def _parent(self, node: _Node, placed: Mapping[str, Placed]) -> Placed | None:
        """What the node stands on or is built into, if that furnishes the room too."""
        if node.bottom < _ON or node.class_name in _HANGING:
            return None
        below = [placed[to] for to in self.edges.get(("ON", node.id), ()) if to in placed]
        on = [o for o in below if o.category != "rug" and o.position[1] < node.bottom + _ON]
        within = [placed[to] for to in self.edges.get(("INSIDE", node.id), ()) if to in placed]
        return min([*on, *within], key=lambda o: abs(o.top - node.bottom), default=None)


def _read_node(row: Row, where: FieldPath) -> _Node:
    box = row.get("bounding_box")
    if not isinstance(box, dict):
        raise LayoutError("must have center and size", "a thing without a box has no place", at=where / "bounding_box")
    node_id = row.get("id")
    if not isinstance(node_id, int | str) or isinstance(node_id, bool) or not 0 < len(str(node_id)) <= 60:
        raise LayoutError(f"must be a number or a text, got {node_id!r:.60}", at=where / "id")
    middle = read_point3(box.get("center"), where / "bounding_box" / "center", -MAX_COORDINATE, MAX_COORDINATE)
    size = read_point3(box.get("size"), where / "bounding_box" / "size", -MAX_COORDINATE, MAX_COORDINATE)
    class_name = read_text(row, "class_name", where).lower().replace(" ", "")
    prefab = str(row.get("prefab_name") or "")[:200]
    category = read_text(row, "category", where)
    w, h, d = (abs(extent) for extent in size)
    return _Node(str(node_id), category, class_name, prefab, point_from_unity(middle), (w, h, d))


def _furniture(node: _Node) -> tuple[str, Point3, Point3]:
    """Our word for a node, the centre of its bottom face, and its size as it stands."""
    word = _WORDS.get(node.class_name) or meaning(node.class_name)
    (x, _, z), (w, h, d), bottom = node.middle, node.size, node.bottom
    stands = node.category in ("Furniture", "Appliances") or word == "rug"
    if stands and abs(bottom) <= _HOVER:
        bottom = 0.0
    for prefab, turned, side in _TURNED:
        if prefab in node.prefab:
            return turned, (x, bottom, z), (side, h, side)
    if word == "bed":
        h = max(h, _BED_HEIGHT)
    size = (max(w, _THINNEST), max(h, _THINNEST), max(d, _THINNEST))
    return exact_category(word, size), (x, bottom, z), size


def _plan_box(node: _Node) -> tuple[float, float, float, float]:
    (x, _, z), (w, _, d) = node.middle, node.size
    return (x - w / 2, z - d / 2, x + w / 2, z + d / 2)
