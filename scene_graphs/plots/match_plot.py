"""The match view: a query's graph beside the rooms that were found for it, each piece with what stands in for it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Final

import numpy as np

from scene_graphs.furniture import Furniture, display_name
from scene_graphs.graph.furniture_graph import FurnitureGraph, graph_from_layout
from scene_graphs.graph.substitution_costs import Level
from scene_graphs.layout import Layout
from scene_graphs.plots.floor_plan import EDGE_COLOR, draw_layout, save_figure
from scene_graphs.retrieval.layout_index import LayoutMatch

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from scene_graphs.retrieval.home_retrieval import HomeMatch

LEVEL_COLORS: Final[dict[Level, str]] = {"same": "#1b7f5c", "class": "#d08a1d", "group": "#c25a2b"}
LEVEL_NAMES: Final[dict[Level, str]] = {
    "same": "what was asked for",
    "class": "of the same class",
    "group": "of the same group",
}
MISSING_COLOR: Final = "#9a9a9a"


def draw_match(
    query: FurnitureGraph,
    layouts: Sequence[Layout],
    match: LayoutMatch | HomeMatch,
    path: str | Path | None = None,
    lines: Sequence[str] = (),
) -> Figure:
    """Draw a query beside the room, or the rooms, found for it; writes an image if a path is given.

    A query node is drawn where its object stands, rooms from left to right, so that the pictures can be compared; what
    is missing stands below. `lines` explain the match underneath. Returns the figure.
    """
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    figure = Figure(figsize=(6.75 * (1 + len(layouts)), 6.6), dpi=100)
    left, *others = figure.subplots(1, 1 + len(layouts))
    images = _images(match, len(layouts))
    colors = {node: LEVEL_COLORS[images[node][2]] if node in images else MISSING_COLOR for node in query}
    kept = _kept_edges(query, layouts, images)
    for number, (layout, ax) in enumerate(zip(layouts, others, strict=True)):
        inside = [(name, level) for place, name, level in images.values() if place == number]
        edges = [(images[a][1], images[b][1]) for a, b in kept if images[a][0] == number]
        draw_layout(layout, ax=ax, edges=edges, outlined={name: LEVEL_COLORS[level] for name, level in inside})
        ax.set_title(layout.id, fontsize=10)
    _draw_query(left, query, _places(query, layouts, images), colors, kept)
    left.set_title(
        f"what is asked for; distance {match.distance}{'' if match.exact else ', not proven least'}", fontsize=10
    )
    handles = [
        Line2D([], [], marker="o", linestyle="", color=LEVEL_COLORS[level], label=name)
        for level, name in LEVEL_NAMES.items()
    ]
    handles.append(Line2D([], [], marker="o", linestyle="", color=MISSING_COLOR, label="missing"))
    handles.append(Line2D([], [], color=EDGE_COLOR, label="relation kept"))
    handles.append(Line2D([], [], color=MISSING_COLOR, linestyle="--", label="relation lost"))
    left.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=3, fontsize=8, frameon=False)
    if lines:
        text = "\n".join(fill(line, 75 * (1 + len(layouts))) for line in lines)
        figure.text(0.06, 0.01, text, fontsize=9, va="top", family="monospace", color="#333333", parse_math=False)
    if path is not None:
        save_figure(figure, path)
    return figure


Images = dict[Furniture, tuple[int, str, Level]]
"""For every mapped query node the room's number, the object's id there, and how near the two are."""


def _images(match: LayoutMatch | HomeMatch, rooms: int) -> Images:
    images: Images = {}
    for node, name, level in match.mapping:
        number, _, own = name.partition("/") if hasattr(match, "layout_ids") else ("0", "", name)
        if int(number) >= rooms:
            raise ValueError(f"the match is of more rooms than the {rooms} given")
        images[node] = (int(number), own, level)
    return images


def _kept_edges(query: FurnitureGraph, layouts: Sequence[Layout], images: Images) -> set[tuple[Furniture, Furniture]]:
    """The query's edges that a room has too."""
    graphs = [graph_from_layout(layout) for layout in layouts]
    nodes = [{str(data["object_id"]): node for node, data in graph.nodes(data=True)} for graph in graphs]
    kept = set()
    for a, b in query.edges:
        if a in images and b in images and images[a][0] == images[b][0]:
            number = images[a][0]
            if graphs[number].has_edge(nodes[number][images[a][1]], nodes[number][images[b][1]]):
                kept.add((a, b))
    return kept


def _places(query: FurnitureGraph, layouts: Sequence[Layout], images: Images) -> dict[Furniture, tuple[float, float]]:
    """Where every query node is drawn: on its object, or, where nothing stands in, in a row below the rooms."""
    shifts, end, lowest = [], 0.0, 0.0
    for layout in layouts:
        low, high = np.min(layout.floor_polygon, axis=0), np.max(layout.floor_polygon, axis=0)
        shifts.append((end - float(low[0]), -float(low[1])))
        end += float(high[0] - low[0]) + 1.0
        lowest = max(lowest, float(high[1] - low[1]))
    places = {}
    for node, (number, name, _) in images.items():
        x, _, z = layouts[number].object(name).position
        places[node] = (x + shifts[number][0], z + shifts[number][1])
    missing = [node for node in sorted(query) if node not in images]
    for place, node in enumerate(missing, start=1):
        places[node] = (end * place / (len(missing) + 1), lowest + 0.6)
    return places


def _draw_query(
    ax: Axes,
    query: FurnitureGraph,
    places: dict[Furniture, tuple[float, float]],
    colors: dict[Furniture, str],
    kept: set[tuple[Furniture, Furniture]],
) -> None:
    for a, b in query.edges:
        (ax_, az), (bx, bz) = places[a], places[b]
        style = {"color": EDGE_COLOR, "linewidth": 1.6} if (a, b) in kept else {"color": MISSING_COLOR, "ls": "--"}
        ax.plot([ax_, bx], [az, bz], zorder=1, **style)
    for node in query:
        x, z = places[node]
        ax.plot(x, z, marker="o", markersize=15, color=colors[node], zorder=2)
        ax.text(x, z, str(node.instance), color="white", fontsize=8, ha="center", va="center", zorder=3)
        needs = ", ".join(sorted(query.nodes[node].get("needs", ())))
        label = display_name(node.category) + (f"\n({needs})" if needs else "")
        ax.annotate(label, (x, z), (0, -13), textcoords="offset points", ha="center", va="top", fontsize=8, zorder=3)
    ax.set_aspect("equal")
    ax.invert_yaxis()
    ax.margins(0.18)
    ax.axis("off")
