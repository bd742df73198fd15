"""Contact sheets: each motion a row of poses from two sides, and where feet and pelvis went seen from above.

A row's pictures are parallel views of one scale: in the side view the white line is the floor exactly.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.body.cast import PLAIN, Role
from motion_backend.motion import Motion
from motion_backend.rendering.hand_deed import from_hanging
from motion_backend.rendering.motion_figures import Acting, Prop, home_props
from motion_backend.rendering.rasterizer import Camera
from motion_backend.rendering.renderer import Image, Solid, render
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from scene_graphs.home import Home


CELL = (150, 176)
"""Pixels of one pose."""
HEAD, GAP = 22, 6
"""Pixels above a row for its title, and under it."""
DPI = 100
QUARTER, SIDE = (0.8, 0.30), (np.pi / 2, 0.0)
"""Yaw (radians, from where the body faces to the side of the hand that does most) and pitch of the two views."""
ALIKE = 0.02
"""Metres by which hands differ that do the same."""
MARGIN = 0.16
"""Metres left free around the poses."""
AROUND = 1.1
"""Furniture this near to the body (metres) is shown with it."""
TALL = 1.2
"""And what stands before the body is left away from this height (metres)."""
FLAT = 0.05
"""What is no higher (metres) is walked over: rugs."""
UNDER = 0.12
"""The floor's height in a picture, as a share of its height from below."""
SUN = np.array([0.35, 0.86, 0.37])
FEET = {"left": "#1864ab", "right": "#c92a2a"}
INK, WAY = "#23262b", "#868e96"


def sheet(
    motions: Sequence[tuple[str, Motion]], home: Home | None = None, columns: int = 8, roles: Sequence[Role] = ()
) -> Image:
    """A page with a row for every motion, under its title; all furniture near the body is drawn where a home is given.

    A row shows `columns` moments evenly spread over its motion: above from the front quarter, below from the side.
    `roles` say for each of them who acts it, and what is in the hands.
    """
    from matplotlib.figure import Figure

    if not motions:
        raise ValueError("motions: a contact sheet needs at least one motion")
    props = [] if home is None else [prop for prop in home_props(home) if prop.side is None]
    tall = HEAD + 2 * CELL[1] + GAP
    width, height = columns * CELL[0] + 2 * CELL[1], len(motions) * tall
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, facecolor="white")
    plain: dict[str, Any] = {"color": INK, "va": "center", "parse_math": False}
    for place, (title, motion) in enumerate(motions):
        row = _Row(motion, props, columns, roles[place] if roles else PLAIN)
        bottom = height - (place + 1) * tall + GAP
        headline = (bottom + 2 * CELL[1] + HEAD / 2) / height
        figure.text(6 / width, headline, title, fontsize=10, weight="bold", **plain)
        figure.text(1 - 6 / width, headline, facts(motion), fontsize=8, ha="right", **plain)
        figure.figimage(row.picture(), 0, bottom, origin="upper")
        for column, frame in enumerate(row.frames):
            where = ((column * CELL[0] + 5) / width, (bottom + 2 * CELL[1] - 9) / height)
            figure.text(*where, f"{frame / motion.fps:.1f} s", fontsize=7, **plain)
        axes = figure.add_axes((columns * CELL[0] / width, bottom / height, 2 * CELL[1] / width, 2 * CELL[1] / height))
        _draw_plan(axes, motion, home)
    pixels = BytesIO()
    with warnings.catch_warnings():
        # Titles are other people's: a letter that the font lacks is a box.
        warnings.filterwarnings("ignore", message="Glyph")
        figure.savefig(pixels, format="rgba", dpi=DPI)
    return np.frombuffer(pixels.getvalue(), dtype=np.uint8).reshape(height, width, 4)[..., :3]


def facts(motion: Motion) -> str:
    """How long a motion takes, how far it goes, and what was not done."""
    steps = np.diff(motion.root_positions[:, [0, 2]].astype(np.float64), axis=0)
    way = float(np.linalg.norm(steps, axis=1).sum())
    undone = "" if motion.completed else f"  ·  NOT DONE: {motion.reason}"
    return f"{motion.duration:.1f} s  ·  {way:.1f} m{undone}"


def footprints(motion: Motion, joints: NDArray[np.floating], side: str) -> list[tuple[Array, int]]:
    """Where a foot stood: ankle and toe on the floor plan ((2, 2) [x, z]) and the first frame of every stance."""
    down = motion.contacts[:, 0 if side == "left" else 2] > 0.5
    edges = np.flatnonzero(np.diff(np.concatenate([[False], down, [False]]).astype(np.int8)))
    foot = [INDEX[f"{side}_ankle"], INDEX[f"{side}_foot"]]
    return [
        (joints[(start + stop) // 2, foot][:, [0, 2]].astype(np.float64), int(start))
        for start, stop in zip(edges[::2], edges[1::2], strict=True)
    ]


@dataclass(frozen=True)
class _Row:
    """One motion's pictures."""

    motion: Motion
    props: Sequence[Prop]
    columns: int
    role: Role

    @cached_property
    def acting(self) -> Acting:
        """Who is drawn."""
        return Acting.of(self.motion, self.role)

    @cached_property
    def frames(self) -> list[int]:
        """The moments shown."""
        return [int(frame) for frame in np.linspace(0, len(self.motion) - 1, self.columns).round()]

    @cached_property
    def joints(self) -> Array:
        """World joints of these moments. (columns, 22, 3)."""
        chosen = self.frames
        turned = self.motion.local_rotations[chosen]
        return self.motion.skeleton.forward_kinematics(self.motion.root_positions[chosen], turned)[0].astype(np.float64)

    @cached_property
    def yaws(self) -> Array:
        """Where the body faces, or where its feet point when it lies. (columns,)."""
        turns = self.motion.local_rotations[self.frames, 0].astype(np.float64)
        ahead = rotations.rotate(turns, np.array([0.0, 0.0, 1.0]))
        up = rotations.rotate(turns, np.array([0.0, 1.0, 0.0]))
        lies = np.abs(up[:, 1]) < 0.6
        shown = np.where(lies[:, None], -up, ahead)
        return np.arctan2(shown[:, 0], shown[:, 2])

    @cached_property
    def hand(self) -> int:
        """From which side it is seen, 1 for the left: that of the hand that is away from where it hangs the most."""
        left, right = from_hanging(self.motion.joint_positions().astype(np.float64)).mean(axis=0).tolist()
        return 1 if left > right - ALIKE else -1

    @cached_property
    def span(self) -> float:
        """Metres a picture is high: what holds the widest and the highest pose."""
        level = self.joints[..., [0, 2]]
        wide = float(np.linalg.norm(level - self.middles[:, None], axis=-1).max())
        high = float(self.joints[..., 1].max()) + MARGIN
        return max(high / (1.0 - UNDER), 2 * (wide + MARGIN) * CELL[1] / CELL[0])

    @cached_property
    def middles(self) -> Array:
        """The middle of each pose on the floor plan. (columns, 2)."""
        level = self.joints[..., [0, 2]]
        return np.asarray((level.min(axis=1) + level.max(axis=1)) / 2)

    def picture(self) -> Image:
        """Both views of all moments."""
        cells = [[self._cell(column, *view) for column in range(self.columns)] for view in (QUARTER, SIDE)]
        return np.concatenate([np.concatenate(row, axis=1) for row in cells])

    def _cell(self, column: int, yaw: float, pitch: float) -> Image:
        (x, z), turned = self.middles[column].tolist(), float(self.yaws[column]) + self.hand * yaw
        target = (x, (0.5 - UNDER) * self.span, z)
        level, up = 6.0 * float(np.cos(pitch)), 6.0 * float(np.sin(pitch))
        eye = (x + level * float(np.sin(turned)), target[1] + up, z + level * float(np.cos(turned)))
        camera = Camera(eye, target, span=self.span)
        body = self.acting.solids([self.frames[column]])
        solids = [*body, *self._around(column, camera)]
        if pitch > 0:
            solids += [_shadow(solid) for solid in body]
        picture = render(solids, camera, CELL, ground=0.0 if pitch > 0 else None, shadows=False)
        picture[:, 0] = 205
        if pitch == 0:
            picture[round((1.0 - UNDER) * CELL[1])] = 255
        return picture

    def _around(self, column: int, camera: Camera) -> list[Solid]:
        """The furniture near a pose; what stands before it is seen through, or left away when it is as tall."""
        body, shown = self.joints[column], []
        for prop in self.props:
            gap = np.maximum(np.maximum(prop.low - body, body - prop.high), 0.0)
            if float(np.hypot(gap[:, 0], gap[:, 2]).min()) > AROUND or prop.high[1] < FLAT:
                continue
            nearer = bool(((prop.low + prop.high) / 2 - body.mean(axis=0)) @ camera.axes[2] < 0.1)
            if nearer and prop.high[1] > TALL:
                continue
            solid = prop.solid
            shown.append(replace(solid, opacity=0.5 if nearer else solid.opacity, normals=None))
        return shown


def _shadow(solid: Solid) -> Solid:
    """What a body darkens of the floor."""
    points = np.asarray(solid.vertices, dtype=np.float64)
    flat = points - points[:, 1:2] / SUN[1] * SUN + np.array([0.0, 0.003, 0.0])
    return Solid(flat, solid.faces, (0.60, 0.60, 0.60))


def _draw_plan(axes: Axes, motion: Motion, home: Home | None) -> None:
    """Stances of both feet and the pelvis' way with its seconds, from above; x runs to the right, z down."""
    joints = motion.joint_positions()
    way = motion.root_positions[:, [0, 2]].astype(np.float64)
    points = [way]
    axes.plot(way[:, 0], way[:, 1], color=WAY, linewidth=1.0)
    for side, color in FEET.items():
        for foot, _ in footprints(motion, joints, side):
            axes.plot(foot[:, 0], foot[:, 1], color=color, linewidth=3.0, solid_capstyle="round")
            points.append(foot)
    every = max(1, round(motion.duration / 8)) * motion.fps
    for frame in range(0, len(motion), every):
        axes.plot(*way[frame], marker="o", markersize=2.5, color=INK)
        seconds = f"{frame / motion.fps:.0f}"
        axes.annotate(seconds, way[frame], (3, 3), textcoords="offset points", fontsize=6, color=INK)
    low, high = np.concatenate(points).min(axis=0), np.concatenate(points).max(axis=0)
    (x, z), half = (low + high) / 2, max(0.8, 0.5 * float((high - low).max()) + 0.3)
    if home is not None:
        for index in range(len(home.rooms)):
            walls = home.room_polygon(index)
            axes.fill(walls[:, 0], walls[:, 1], facecolor="none", edgecolor=INK, linewidth=1.2, zorder=0)
        for placed in home.objects:
            outline, color = placed.footprint, "#e9ecef" if placed.size[1] > FLAT else "none"
            axes.fill(outline[:, 0], outline[:, 1], facecolor=color, edgecolor="#adb5bd", linewidth=0.7, zorder=0)
    axes.set_xlim(x - half, x + half)
    axes.set_ylim(z + half, z - half)
    axes.set_xticks([])
    axes.set_yticks([])
    axes.set_title(f"{2 * half:.1f} m across", fontsize=6, color=WAY, y=0.94)
