"""Top-down drawings of rooms and homes: furniture with its fronts, doors, windows, spots, ways walked, graph edges.

Drawn as seen from above: x to the right, z down the page, so that left and right are not mirrored.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from scene_graphs.clearance import part_outline
from scene_graphs.forms import parts
from scene_graphs.furniture import display_name, group_of
from scene_graphs.homes import Home
from scene_graphs.layouts import Array, Layout, Opening, Placed
from scene_graphs.surfaces import Spot

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

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
SPOT_COLORS = {"sit": "#1b7f5c", "lie": "#2f5fa8", "touch": "#c2493d"}
_PIXELS_AN_INCH = 110


def draw_layout(
    scene: Layout | Home,
    path: str | Path | None = None,
    ax: Axes | None = None,
    *,
    spots: Iterable[Spot] = (),
    route: ArrayLike | None = None,
    edges: Iterable[tuple[str, str]] = (),
) -> Figure:
    """Draw a room or home from above; writes an image if a path is given (its ending says which kind).

    `spots` are drawn with their standing points, `route` is a walked polyline (N, 2) of [x, z], `edges` are pairs of
    object ids. With `ax` the drawing goes into those axes. Returns the figure.
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
    _draw_labels(ax, scene.objects)
    _draw_edges(ax, scene.objects, edges)
    _draw_spots(ax, spots)
    if route is not None:
        points = np.asarray(route, dtype=float)
        ax.plot(points[:, 0], points[:, 1], color="#7a3fa0", linewidth=2.2, zorder=8)
        ax.plot(*points[-1], marker="o", color="#7a3fa0", markersize=6, zorder=8)
    _finish(ax, title)
    whole = ax.get_figure(root=True)
    if not isinstance(whole, Figure):
        raise ValueError("ax must belong to a figure")
    if path is not None:
        whole.savefig(path, bbox_inches="tight", facecolor="white")
    return whole


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
    corners = placed.footprint
    layer = 2.5 if placed.category == "rug" else 3.0 + placed.top / 10
    ax.fill(corners[:, 0], corners[:, 1], facecolor=color, edgecolor="#555555", linewidth=0.9, zorder=layer, **style)
    if hangs or placed.category == "rug":
        return
    for part in sorted(parts(placed.category, placed.size), key=lambda part: part.top):
        outline = part_outline(placed, part.low, part.high)
        ax.fill(*outline.T, facecolor="none", edgecolor="#00000040", linewidth=0.6, zorder=layer)
    if group_of(placed.category) not in ("light", "decor"):
        _draw_front(ax, placed, layer)


def _draw_front(ax: Axes, placed: Placed, layer: float) -> None:
    """A small triangle at the middle of the front edge, pointing out."""
    w, _, d = placed.size
    size = min(0.12, 0.3 * w)
    tip = placed.to_world(np.array([[-size, 0, d / 2], [size, 0, d / 2], [0, 0, d / 2 + 0.9 * size]]))[:, [0, 2]]
    ax.fill(*tip.T, color="#555555", zorder=layer)


def _draw_labels(ax: Axes, objects: Sequence[Placed]) -> None:
    for placed in objects:
        if placed.category in ("picture", "ceiling_lamp", "pendant_lamp") or placed.parent is not None:
            continue
        flat = placed.category == "rug"
        x, z = placed.position[0], placed.position[2]
        if flat:
            x, z = placed.footprint[:, 0].min() + 0.25, placed.footprint[:, 1].max() - 0.1
        text = display_name(placed.category).replace(" ", "\n" if placed.size[0] < 1.0 else " ")
        along_z = not flat and abs(np.cos(placed.yaw)) < 0.5 and placed.size[0] > 1.3 * placed.size[2]
        turned = 90.0 if along_z else 0.0
        ax.text(x, z, text, fontsize=7, ha="center", va="center", rotation=turned, color="#222222", zorder=9)


def _draw_edges(ax: Axes, objects: Sequence[Placed], edges: Iterable[tuple[str, str]]) -> None:
    where = {placed.id: (placed.position[0], placed.position[2]) for placed in objects}
    for first, second in edges:
        (ax_, az), (bx, bz) = where[first], where[second]
        ax.plot([ax_, bx], [az, bz], color="#b03a8c", linewidth=1.2, alpha=0.7, zorder=7)


def _draw_spots(ax: Axes, spots: Iterable[Spot]) -> None:
    for spot in spots:
        color = SPOT_COLORS[spot.affordance]
        x, z = spot.point[0], spot.point[2]
        ax.plot([x, spot.standing[0]], [z, spot.standing[1]], color=color, linewidth=1.0, linestyle=":", zorder=8)
        ax.plot(x, z, marker="o", markersize=5, color=color, zorder=8)
        ax.plot(*spot.standing, marker="o", markersize=7, markerfacecolor="none", markeredgecolor=color, zorder=8)
        ax.plot(*_arrow(spot.standing, spot.approach), color=color, linewidth=1.4, zorder=8)
        ax.plot(*_arrow((x, z), spot.facing), color=color, linewidth=1.4, alpha=0.6, zorder=8)


def _arrow(start: tuple[float, float], yaw: float, length: float = 0.18) -> Iterator[list[float]]:
    yield [start[0], start[0] + length * float(np.sin(yaw))]
    yield [start[1], start[1] + length * float(np.cos(yaw))]


def _finish(ax: Axes, title: str) -> None:
    ax.set_aspect("equal")
    if not ax.yaxis_inverted():
        ax.invert_yaxis()
    ax.set_title(title, fontsize=10)
    ax.set_xlabel("x (m)", fontsize=8)
    ax.set_ylabel("z (m), down the page", fontsize=8)
    ax.tick_params(labelsize=7)
    for spine in ax.spines.values():
        spine.set_visible(False)
