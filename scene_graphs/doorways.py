"""Where several rooms stand beside each other so that a doorway joins each of them to another (SIMS 8.2)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import islice
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray

from scene_graphs.errors import UserError
from scene_graphs.layout import Array, Layout, Opening, Point2, wrap
from scene_graphs.navigation.clearance import BODY_RADIUS, find_footing, obstacles, rectangles_of

WALL_GAP: Final = 0.12
"""Between the facing walls of two rooms, in metres."""
DOOR_WIDTH: Final = 0.95
DOOR_HEIGHT: Final = 2.1
CLEAR: Final = 0.75
"""Free space we want on both sides of the way through a doorway and half a metre on; `TIGHT` is the least we take."""
TIGHT: Final = 0.4
_MAX_DOOR: Final = 1.4
_MIN_DOOR: Final = 0.75
_FROM_CORNER: Final = 0.1
_STEP: Final = 0.2
_ENTERED: Final = 0.5
"""How far into the room the way through a doorway is kept free; from there the rest of the room must be reached."""
_BESIDE: Final = 0.03
"""Furniture may come this near to the frame of a door."""
_CANDIDATES: Final = 4000
_COMPARED: Final = 60
_ATTEMPTS: Final = 8
_Stretch = tuple[Array, float, float, float]


class HomeError(UserError):
    """Rooms that cannot be made one home: says which room and why."""


@dataclass(frozen=True)
class Pose:
    """Where a room stands in the home: p_home = R_y(yaw) p + offset."""

    offset: Point2 = (0.0, 0.0)
    yaw: float = 0.0

    def turn(self, vectors: Array) -> Array:
        """Turn [x, z] vectors of the room's frame into the home's. (..., 2)."""
        turned: Array = vectors @ self._turning
        return turned

    @cached_property
    def _turning(self) -> Array:
        """What a row vector [x, z] is multiplied by. (2, 2)."""
        cos, sin = np.cos(self.yaw), np.sin(self.yaw)
        return np.array([[cos, -sin], [sin, cos]])

    def to_home(self, points: Array) -> Array:
        """Turn and move [x, z] points of the room's frame into the home's. (..., 2)."""
        moved: Array = self.turn(points) + np.asarray(self.offset)
        return moved


@dataclass(frozen=True, eq=False)
class Site:
    """A place in a room's wall for a doorway, in the room's frame."""

    center: Array
    inward: Array
    """Unit vector into the room."""
    width: float
    top: float
    cost: float
    """0 is a free stretch of wall; less where there is a door already, more where it is tight."""


@dataclass(frozen=True)
class Plan:
    """A pose a room, and the doorways (on the middle line between two walls) that join them."""

    poses: tuple[Pose, ...]
    doorways: tuple[Opening, ...]


def arrangements(layouts: Sequence[Layout], seed: int) -> Iterator[Plan]:
    """Ways to place rooms side by side, all different and at most a few; the first room keeps its own frame.

    HomeError if a room has no stretch of wall where a doorway would be free, or fits nowhere beside the others.
    """
    if len(layouts) == 1:
        yield Plan((Pose(),), ())
        return
    sites = [doorway_sites(layout) for layout in layouts]
    stuck: HomeError | None = None
    for attempt in range(_ATTEMPTS):
        try:
            plan = _arrange(layouts, sites, np.random.default_rng((seed, attempt)))
        except HomeError as error:
            stuck = error
        else:
            stuck = None
            yield plan
    if stuck is not None:
        raise stuck


@lru_cache(maxsize=512)
def doorway_sites(layout: Layout) -> tuple[Site, ...]:
    """Every place of a room's walls where a doorway would open on free, connected floor. HomeError if there is none."""
    floor = shapely.Polygon(layout.floor_polygon)
    furniture = np.array([outline for _, outline in obstacles(layout.objects)], dtype=object)
    footing = find_footing(floor, rectangles_of(furniture), BODY_RADIUS)
    main = 1 + int(np.argmax(np.bincount(footing.regions.ravel())[1:])) if footing.free.any() else -1
    found = []
    for start, along, inward, length in _edges(layout):
        for center, width, top, penalty in _stretches(layout, start, along, length):
            entered, half = center + _ENTERED * inward, along * width / 2
            clear = _gap(furniture, center, entered)
            framed = _gap(furniture, center - half, center + half) >= _BESIDE
            leads_on = footing.region_at((float(entered[0]), float(entered[1]))) == main
            if clear >= TIGHT and framed and leads_on:
                found.append(Site(center, inward, width, top, penalty + 4 * max(CLEAR - clear, 0.0)))
    if not found:
        raise HomeError(
            f"room {layout.id!r} has no stretch of wall {DOOR_WIDTH} m wide that is free of furniture and "
            "leads to its floor",
            "take another room or move furniture off the walls",
        )
    return tuple(found)


def _edges(layout: Layout) -> Iterator[tuple[Array, Array, Array, float]]:
    """Start, unit direction, unit normal into the room and length of every wall."""
    corners = np.asarray(layout.floor_polygon, dtype=float)
    ends = np.roll(corners, -1, axis=0)
    area = float(np.sum(corners[:, 0] * ends[:, 1] - ends[:, 0] * corners[:, 1]))
    for start, end in zip(corners, ends, strict=True):
        length = float(np.hypot(*(end - start)))
        if length > 0:
            along = (end - start) / length
            yield start, along, np.array([-along[1], along[0]]) * np.sign(area), length


def _stretches(layout: Layout, start: Array, along: Array, length: float) -> Iterator[_Stretch]:
    """Centre, width, top and penalty of the doorways a wall could have: its doors first, then every `_STEP`."""
    top = min(DOOR_HEIGHT, layout.height - 0.05)
    doors = [span for door in layout.doors if (span := span_on(door, start, along, length)) is not None]
    windows = [span for window in layout.windows if (span := span_on(window, start, along, length)) is not None]
    for low, high in doors:
        if high - low >= _MIN_DOOR:
            yield start + along * (low + high) / 2, min(high - low, _MAX_DOOR), top, -0.5
    half = DOOR_WIDTH / 2
    for middle in np.arange(half + _FROM_CORNER, length - half - _FROM_CORNER + 1e-9, _STEP):
        cut = sum(low < middle + half and high > middle - half for low, high in (*doors, *windows))
        yield start + along * middle, DOOR_WIDTH, top, 0.4 * cut


def span_on(opening: Opening, start: Array, along: Array, length: float) -> tuple[float, float] | None:
    """The stretch of a wall (distances from its start) an opening takes, or None if it is in another wall."""
    ends = np.asarray(opening.segment, dtype=float) - start
    beside = ends @ np.array([-along[1], along[0]])
    low, high = sorted(float(value) for value in ends @ along)
    low, high = max(low, 0.0), min(high, length)
    return (low, high) if np.abs(beside).max() < WALL_GAP + 0.03 and high - low > 0.05 else None


def _gap(furniture: NDArray[np.object_], start: Array, end: Array) -> float:
    """Distance from a line to the nearest furniture."""
    return float(np.min(shapely.distance(shapely.LineString([start, end]), furniture), initial=np.inf))


def _arrange(layouts: Sequence[Layout], sites: Sequence[Sequence[Site]], rng: np.random.Generator) -> Plan:
    """Add room after room at the best of the sampled joints. HomeError for one that fits nowhere."""
    poses, doorways = [Pose()], list[Opening]()
    outlines = [shapely.Polygon(layouts[0].floor_polygon)]
    for index in range(1, len(layouts)):
        corners = np.asarray(layouts[index].floor_polygon, dtype=float)
        taken = shapely.union_all(outlines).buffer(WALL_GAP * 0.9, join_style="mitre")
        joints = (_join(poses[i], a, b) for i, a, b in _pairs(sites[:index], sites[index], rng))
        fitting = (
            (pose, doorway, outline)
            for pose, doorway in joints
            if _apart(doorway, doorways) and not taken.intersects(outline := shapely.Polygon(pose.to_home(corners)))
        )
        best = min(islice(fitting, _COMPARED), key=lambda joint: _sprawl(outlines, joint[2]), default=None)
        if best is None:
            others = ", ".join(repr(layout.id) for layout in layouts[:index])
            raise HomeError(
                f"room {layouts[index].id!r} fits nowhere beside {others}: wherever two free walls meet, rooms "
                "would overlap",
                "take another room or fewer",
            )
        poses.append(best[0])
        doorways.append(best[1])
        outlines.append(best[2])
    return Plan(tuple(poses), tuple(doorways))


def _pairs(
    placed: Sequence[Sequence[Site]], new: Sequence[Site], rng: np.random.Generator
) -> Iterator[tuple[int, Site, Site]]:
    """Sites of placed rooms with sites of the new one, cheapest first, shuffled by up to a tight doorway's cost."""
    pairs = [(i, a, b) for i, sites in enumerate(placed) for a in sites for b in new]
    costs = np.array([a.cost + b.cost for _, a, b in pairs]) + 0.5 * rng.random(len(pairs))
    for at in np.argsort(costs, kind="stable")[:_CANDIDATES]:
        yield pairs[at]


def _join(pose: Pose, old: Site, new: Site) -> tuple[Pose, Opening]:
    """The new room's pose with its site facing the old one across the gap, and the doorway between."""
    inward, center = pose.turn(old.inward), pose.to_home(old.center)
    yaw = float(np.arctan2(-inward[0], -inward[1]) - np.arctan2(new.inward[0], new.inward[1]))
    quarter = round(yaw / (np.pi / 2)) * np.pi / 2
    yaw = quarter if abs(yaw - quarter) < 1e-9 else yaw
    yaw = wrap(yaw)
    offset = center - WALL_GAP * inward - Pose(yaw=yaw).turn(new.center)
    along = np.array([inward[1], -inward[0]]) * min(old.width, new.width) / 2
    middle = center - WALL_GAP / 2 * inward
    start, end = ((float(x), float(z)) for x, z in (middle - along, middle + along))
    return Pose((float(offset[0]), float(offset[1])), yaw), Opening((start, end), 0.0, min(old.top, new.top))


def _apart(doorway: Opening, others: list[Opening]) -> bool:
    """Whether a doorway keeps a step away from all others, so that their frames do not run together."""
    line = shapely.LineString(doorway.segment)
    return all(line.distance(shapely.LineString(other.segment)) >= _ENTERED for other in others)


def _sprawl(outlines: list[shapely.Polygon], added: shapely.Polygon) -> float:
    """Half the way around all rooms: the less, the more they look like one home and not like a train."""
    low_x, low_z, high_x, high_z = shapely.union_all([*outlines, added]).bounds
    return float(high_x - low_x + high_z - low_z)
