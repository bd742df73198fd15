"""Top-down drawings of rooms and homes: furniture with its fronts, doors, windows, spots, ways walked, graph edges.

Drawn as seen from above: x to the right, z down the page, so that left and right are not mirrored.

Names on a drawing: each in or right beside its thing, none over another.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from threading import Lock
from typing import IO, TYPE_CHECKING, Final

import numpy as np
import shapely
from numpy.typing import ArrayLike
from shapely.geometry.base import BaseGeometry

from scene_graphs.affordances.affordances import Spot
from scene_graphs.furniture import display_name, group_of, is_minor
from scene_graphs.furniture_shapes import parts_of
from scene_graphs.home import Home
from scene_graphs.layout import Array, Layout, Opening, Placed
from scene_graphs.navigation.clearance import part_outline

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


POINTS: Final = 7
"""Size of the letters."""
PLATE: Final = {"boxstyle": "round,pad=0.12", "facecolor": "#ffffff8c", "edgecolor": "none"}
"""Behind a name, so that it is read over lines."""
_SHIFTS: Final = (0, 1, -1, 2, -2)
Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class Name:
    """What is to be written where."""

    text: str
    """One or more lines."""
    x: float
    z: float
    """The middle of the text, in the units of the axes."""
    turned: bool = False
    """Written upwards."""


def letter(ax: Axes, names: Iterable[Name], above: float) -> None:
    """Write names, the first ones first, in the layer `above` others; one that would cover another is left out.

    The axes must have their final limits.
    """
    ax.apply_aspect()
    ends = ax.transData.transform([[0.0, 0.0], [1.0, 0.0]])
    point = ax.figure.dpi / 72 / float(np.ptp(ends[:, 0]))
    taken: list[Box] = []
    for name in names:
        for lines in _SHIFTS:
            x, z, box = _place(name, lines, point)
            if not any(_meet(box, other) for other in taken):
                taken.append(box)
                label = ax.text(
                    x, z, name.text, fontsize=POINTS, ha="center", va="center", color="#222222", parse_math=False
                )
                label.set(rotation=90.0 if name.turned else 0.0, bbox=PLATE, zorder=above)
                break


def _place(name: Name, lines: int, point: float) -> tuple[float, float, Box]:
    """Where a name is when moved across by as many times its height, and about what it covers; a letter's point is
    that many units of the axes."""
    rows = name.text.split("\n")
    width, height = 0.62 * POINTS * point * max(map(len, rows)), (1.25 * len(rows) + 0.2) * POINTS * point
    shift = lines * (height / 2 + 0.6 * POINTS * point)
    x, z = (name.x + shift, name.z) if name.turned else (name.x, name.z + shift)
    across, along = (height / 2, width / 2) if name.turned else (width / 2, height / 2)
    return x, z, (x - across, z - along, x + across, z + along)


def _meet(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


GROUP_COLORS = {
    "sit": "#8fb3a3",
    "bed": "#9db4d3",
    "surface": "#d9b98a",
    "storage": "#b99674",
    "media": "#8c8f99",
    "light": "#f2d98c",
    "decor": "#b7cfa0",
}
OTHER_COLOR = "#c9c5c0"
FLOOR, WALL, DOOR, WINDOW = "#f7f4ee", "#4a4a4a", "#c98a5a", "#7fb8d8"
EDGE_COLOR, ROUTE_COLOR = "#b03a8c", "#7a3fa0"
SPOT_COLORS = {"sit": "#1b7f5c", "lie": "#2f5fa8", "touch": "#c2493d"}
_PIXELS_AN_INCH = 110
_SAVING = Lock()


def draw_layout(
    scene: Layout | Home,
    path: str | Path | None = None,
    ax: Axes | None = None,
    *,
    spots: Iterable[Spot] = (),
    route: ArrayLike | None = None,
    edges: Iterable[tuple[str, str]] = (),
    outlined: Mapping[str, str] | None = None,
) -> Figure:
    """Draw a room or home from above; writes an image if a path is given (its ending says which kind).

    `spots` are drawn with their surfaces and standing points, `route` is a walked polyline (N, 2) of [x, z], `edges`
    are pairs of object ids, `outlined` gives objects, by id, the colour of a thick outline. With `ax` the drawing goes
    into those axes. Returns the figure.
    """
    from matplotlib.figure import Figure

    outlines, walls, doors, windows, title = _shell(scene)
    if ax is None:
        extent = np.ptp(np.concatenate(outlines), axis=0)
        scale = 9.0 / float(extent.max())
        figure = Figure(figsize=(extent[0] * scale + 1, extent[1] * scale + 1.2), dpi=_PIXELS_AN_INCH)
        ax = figure.add_subplot()
    _draw_shell(ax, outlines, walls, doors, windows)
    for placed in sorted(scene.objects, key=lambda placed: (placed.category != "rug", placed.top)):
        _draw_object(ax, placed)
    shown, edges = list(spots), list(edges)
    _draw_surfaces(ax, scene.objects, shown)
    _outline(ax, scene.objects, outlined or {})
    _draw_edges(ax, scene.objects, edges)
    _draw_spots(ax, shown)
    if route is not None:
        points = np.asarray(route, dtype=float)
        ax.plot(points[:, 0], points[:, 1], color=ROUTE_COLOR, linewidth=2.2, zorder=8)
        ax.plot(*points[-1], marker="o", color=ROUTE_COLOR, markersize=6, zorder=8)
    _finish(ax, title)
    letter(ax, _names(scene.objects), above=9)
    _explain(ax, shown, bool(edges), route is not None)
    whole = ax.get_figure(root=True)
    if not isinstance(whole, Figure):
        raise ValueError("ax must belong to a figure")
    if path is not None:
        save_figure(whole, path)
    return whole


def save_figure(figure: Figure, file: str | Path | IO[bytes], ending: str | None = None) -> None:
    """Write a figure; the same figure gives the same bytes. `ending` says the kind where the file has no name."""
    from matplotlib import rc_context

    kind = ending or Path(str(file)).suffix[1:]
    stamp = {"Date": None} if kind == "svg" else {"Software": None}
    # Settings are those of the whole process.
    with _SAVING, rc_context({"svg.hashsalt": "sims", "svg.fonttype": "none"}):
        figure.savefig(file, format=kind, bbox_inches="tight", facecolor="white", metadata=stamp)


def _shell(scene: Layout | Home) -> tuple[list[Array], list[Array], list[Opening], list[Opening], str]:
    """Room outlines, wall segments, doors, windows and a title."""
    if isinstance(scene, Home):
        outlines = [scene.room_polygon(index) for index in range(len(scene.rooms))]
        walls = [np.array(wall.segment) for wall in scene.walls]
        windows = [opening for wall in scene.walls for opening in wall.openings if opening.bottom > 0.1]
        title = " · ".join(room.layout.id for room in scene.rooms)
        return outlines, walls, list(scene.doorways), windows, title
    outline = np.array(scene.floor_polygon)
    walls = [np.array(pair) for pair in zip(outline, np.roll(outline, -1, axis=0), strict=True)]
    return [outline], walls, list(scene.doors), list(scene.windows), f"{scene.id} ({scene.room_type.replace('_', ' ')})"


def _draw_shell(
    ax: Axes, outlines: list[Array], walls: list[Array], doors: list[Opening], windows: list[Opening]
) -> None:
    for outline in outlines:
        ax.fill(outline[:, 0], outline[:, 1], color=FLOOR, zorder=0)
    for wall in walls:
        ax.plot(wall[:, 0], wall[:, 1], color=WALL, linewidth=4, solid_capstyle="projecting", zorder=1)
    for openings, color in ((windows, WINDOW), (doors, DOOR)):
        for opening in openings:
            ends = np.array(opening.segment)
            ax.plot(ends[:, 0], ends[:, 1], color="white", linewidth=6, solid_capstyle="butt", zorder=2)
            ax.plot(ends[:, 0], ends[:, 1], color=color, linewidth=4, solid_capstyle="butt", zorder=2)


def _draw_object(ax: Axes, placed: Placed) -> None:
    color = GROUP_COLORS.get(group_of(placed.category), OTHER_COLOR)
    hangs = placed.position[1] > 1.3
    style = {"alpha": 0.25, "linestyle": "--"} if hangs or placed.category == "rug" else {"alpha": 1.0}
    layer = 2.5 if placed.category == "rug" else 3.0 + placed.top / 10
    flat = hangs or placed.category == "rug"
    for corners in [placed.footprint] if flat else _seen_from_above(placed):
        ax.fill(*corners.T, facecolor=color, edgecolor="#555555", linewidth=0.9, zorder=layer, **style)
    if flat:
        return
    for part in sorted(parts_of(placed), key=lambda part: part.top):
        outline = part_outline(placed, part.low, part.high)
        ax.fill(*outline.T, facecolor="none", edgecolor="#00000040", linewidth=0.6, zorder=layer)
    if group_of(placed.category) not in ("light", "decor"):
        _draw_front(ax, placed, layer)


def _seen_from_above(placed: Placed) -> list[Array]:
    """The outlines of what an object covers: the floor between the wings of a corner sofa is free. (N, 2) each."""
    return [np.asarray(piece.exterior.coords) for piece in shapely.get_parts(_covered(placed))]


@lru_cache(maxsize=512)
def _covered(placed: Placed) -> BaseGeometry:
    outlines = [part_outline(placed, part.low, part.high) for part in parts_of(placed)]
    return shapely.union_all([shapely.Polygon(outline) for outline in outlines or [placed.footprint]])


def _middle(placed: Placed) -> tuple[float, float]:
    """The middle of an object, or a point of it where its box is hollow there."""
    middle = shapely.Point(placed.position[0], placed.position[2])
    inside = middle if _covered(placed).distance(middle) < 1e-9 else _covered(placed).representative_point()
    return inside.x, inside.y


def _draw_front(ax: Axes, placed: Placed, layer: float) -> None:
    """A small triangle at the middle of the front edge, pointing out."""
    w, _, d = placed.size
    size = min(0.12, 0.3 * w)
    front = max((part.high[2] for part in parts_of(placed) if part.low[0] <= 0 <= part.high[0]), default=d / 2)
    tip = placed.to_world(np.array([[-size, 0, front], [size, 0, front], [0, 0, front + 0.9 * size]]))[:, [0, 2]]
    ax.fill(*tip.T, color="#555555", zorder=layer)


def _names(objects: Sequence[Placed]) -> Iterator[Name]:
    """The names of what stands on the floor, those of large things first."""
    for placed in sorted(objects, key=lambda placed: -placed.size[0] * placed.size[2]):
        if placed.category in ("picture", "ceiling_lamp", "pendant_lamp") or placed.parent is not None:
            continue
        text = display_name(placed.category).replace(" ", "\n" if placed.size[0] < 1.0 else " ")
        if placed.category == "rug":
            yield Name(text, placed.footprint[:, 0].min() + 0.25, placed.footprint[:, 1].max() - 0.1)
            continue
        along_z = abs(np.cos(placed.yaw)) < 0.5 and placed.size[0] > 1.3 * placed.size[2]
        yield Name(text, *_middle(placed), along_z)


def _draw_surfaces(ax: Axes, objects: Sequence[Placed], spots: Sequence[Spot]) -> None:
    """Tint what is sat or lain on: the part of the object right under the spot."""
    by_id = {placed.id: placed for placed in objects}
    tinted: set[tuple[str, int]] = set()
    for spot in spots:
        if spot.affordance not in ("sit", "lie") or spot.object_id not in by_id:
            continue
        placed = by_id[spot.object_id]
        x, y, z = placed.to_local(spot.point)
        for number, part in enumerate(parts_of(placed)):
            over = part.low[0] <= x <= part.high[0] and part.low[2] <= z <= part.high[2]
            if over and abs(part.top - y) < 0.02 and (placed.id, number) not in tinted:
                tinted.add((placed.id, number))
                outline = part_outline(placed, part.low, part.high)
                ax.fill(*outline.T, facecolor=SPOT_COLORS[spot.affordance] + "38", edgecolor="none", zorder=6.5)


def _outline(ax: Axes, objects: Sequence[Placed], outlined: Mapping[str, str]) -> None:
    for placed in objects:
        if (color := outlined.get(placed.id)) is not None:
            corners = placed.footprint
            ax.fill(corners[:, 0], corners[:, 1], facecolor="none", edgecolor=color, linewidth=3, zorder=6.6)


def _draw_edges(ax: Axes, objects: Sequence[Placed], edges: Iterable[tuple[str, str]]) -> None:
    by_id = {placed.id: placed for placed in objects}
    for first, second in edges:
        a, b = by_id[first], by_id[second]
        # Relations of lamps, rugs and plants count a quarter of the others, and are drawn so.
        minor = is_minor(a.category) or is_minor(b.category)
        (ax_, az), (bx, bz) = _middle(a), _middle(b)
        width, alpha = (0.8, 0.35) if minor else (1.5, 0.75)
        ax.plot([ax_, bx], [az, bz], color=EDGE_COLOR, zorder=7, linewidth=width, alpha=alpha)
        for x, z in ((ax_, az), (bx, bz)):
            ax.plot(x, z, marker="o", markersize=2.5 if minor else 4, color=EDGE_COLOR, zorder=7)


def _draw_spots(ax: Axes, spots: Iterable[Spot]) -> None:
    for spot in spots:
        color, touch = SPOT_COLORS[spot.affordance], spot.affordance == "touch"
        x, z = spot.point[0], spot.point[2]
        weight = 0.7 if touch else 1.4
        ax.plot([x, spot.standing[0]], [z, spot.standing[1]], color=color, linewidth=weight, linestyle=":", zorder=8)
        ax.plot(x, z, marker="o", markersize=3 if touch else 5, color=color, zorder=8)
        size = 4 if touch else 7
        ax.plot(*spot.standing, marker="o", markersize=size, markerfacecolor="none", markeredgecolor=color, zorder=8)
        ax.plot(*_arrow(spot.standing, spot.approach), color=color, linewidth=weight, zorder=8)
        if not touch:
            ax.plot(*_arrow((x, z), spot.facing), color=color, linewidth=weight, alpha=0.6, zorder=8)


def _arrow(start: tuple[float, float], yaw: float, length: float = 0.18) -> Iterator[list[float]]:
    yield [start[0], start[0] + length * float(np.sin(yaw))]
    yield [start[1], start[1] + length * float(np.cos(yaw))]


def _finish(ax: Axes, title: str) -> None:
    ax.set_aspect("equal")
    if not ax.yaxis_inverted():
        ax.invert_yaxis()
    ax.set_title(title, fontsize=10, parse_math=False)
    ax.set_xlabel("x (m)", fontsize=8)
    ax.set_ylabel("z (m), down the page", fontsize=8)
    ax.tick_params(labelsize=7)
    for spine in ax.spines.values():
        spine.set_visible(False)


def _explain(ax: Axes, spots: Sequence[Spot], edges: bool, route: bool) -> None:
    """A legend of what is drawn over the furniture, below the axes."""
    from matplotlib.lines import Line2D

    met = {spot.affordance for spot in spots}
    verbs = {"sit": "sits", "lie": "lies", "touch": "touches"}
    handles = [
        Line2D([], [], marker="o", linestyle=":", color=SPOT_COLORS[one], label=f"{verb} (ring: stands before)")
        for one, verb in verbs.items()
        if one in met
    ]
    if edges:
        handles.append(Line2D([], [], color=EDGE_COLOR, label="near and not obstructed"))
    if route:
        handles.append(Line2D([], [], color=ROUTE_COLOR, linewidth=2.2, label="a path"))
    if handles:
        below = (0.5, -0.09)
        ax.legend(handles=handles, loc="upper center", bbox_to_anchor=below, ncols=3, fontsize=7, frameon=False)
