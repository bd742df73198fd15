"""The storyboard: for every keyframe the room from above and the body at work, with its caption, in one picture."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from motion_backend.body.cast import PLAIN, Role
from motion_backend.motion import Motion, Skill
from motion_backend.props import held_in, replaced
from motion_backend.rendering.camera import Shot, choose_camera, choose_frames
from motion_backend.rendering.motion_figures import Acting, Prop, around, home_props
from motion_backend.rendering.rasterizer import Camera
from motion_backend.rendering.renderer import Image, render
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, PARENTS
from scene_graphs.home import Home

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


SIDE = (356, 268)
PLAN = (268, 268)
"""Pixels of a keyframe's two pictures."""
TEXT, GAP, HEAD = 62, 18, 52
"""Pixels under a pair for its caption, between pairs, and above them all."""
COLUMNS = 3
DPI = 100
INK, WAY, BODY = "#23262b", "#d9480f", "#1c5d99"
WHOLE = 0.98
"""Of its size: what is held is drawn where it is there."""
WORKERS = 2
"""Pictures drawn at once; numpy lets go of the interpreter for most of the work."""


class Caption(Protocol):
    """What is told of a keyframe: `planner_service.scripts.script.Keyframe`, or anything alike."""

    @property
    def skill(self) -> Skill: ...

    @property
    def caption(self) -> str: ...

    @property
    def furniture(self) -> str: ...

    @property
    def emotion(self) -> str: ...


@dataclass(frozen=True)
class _Stage:
    """What every panel draws from."""

    home: Home
    motion: Motion
    joints: NDArray[np.float32]
    props: list[Prop]
    acting: Acting
    role: Role


@dataclass(frozen=True)
class _Panel:
    """One keyframe's frames, and the pictures drawn of them."""

    index: int
    keyframe: Caption
    target: str | None
    start: int
    stop: int
    shot: Shot
    window: tuple[float, float, float, float]
    """The floor its plan shows: low x, low z, high x, high z."""
    unfilmed: int
    """How many of its frames the film leaves out."""


def storyboard(
    home: Home,
    motion: Motion,
    keyframes: Sequence[Caption],
    path: Path | str,
    title: str = "",
    targets: Sequence[str | None] = (),
    role: Role = PLAIN,
    left_out: Sequence[tuple[int, int]] = (),
) -> Path:
    """Draw all keyframes a motion serves and save the picture as a PNG; `targets` are ids of the objects they use,
    `left_out` the frames that are in no picture of its film."""
    props = home_props(home, replaced(role))
    stage = _Stage(home, motion, motion.joint_positions(), props, Acting.of(motion, role), role)
    served = np.unique(motion.actions).tolist()
    panels = [_panel(stage, i, keyframes[i], targets[i] if targets else None, left_out) for i in served]
    windows = sorted({panel.window for panel in panels})
    with ThreadPoolExecutor(max_workers=WORKERS) as pool:
        pictures = list(pool.map(lambda panel: _picture(stage, panel.shot, _camera(stage, panel.shot)), panels))
        plans = dict(zip(windows, pool.map(lambda window: _plan(stage, window), windows), strict=True))
    figure, corners = _sheet(len(panels), title or "Storyboard")
    for panel, picture, corner in zip(panels, pictures, corners, strict=True):
        _draw_pair(figure, stage, panel, (plans[panel.window], picture), corner)
    figure.savefig(path, dpi=DPI, pil_kwargs={"compress_level": 3})
    return Path(path)


def _panel(
    stage: _Stage, index: int, keyframe: Caption, target: str | None, left_out: Sequence[tuple[int, int]]
) -> _Panel:
    frames = np.flatnonzero(stage.motion.actions == index)
    start, stop = int(frames[0]), int(frames[-1]) + 1
    shot = choose_frames(stage.motion, stage.joints, start, stop, Skill(keyframe.skill))
    shot = _with_held(stage, shot, start, stop, Skill(keyframe.skill))
    unfilmed = sum(max(min(stop, last) - max(start, first), 0) for first, last in left_out)
    return _Panel(index, keyframe, target, start, stop, shot, _window(stage, start, stop, shot), unfilmed)


def _with_held(stage: _Stage, shot: Shot, start: int, stop: int, skill: Skill) -> Shot:
    """A shot moved to where what is held in these frames is seen: of who is on the way or at something the nearest
    frame, of who rests the one in which it is nearest to the head, without ghosts that would lie over it."""
    number = int(stage.motion.actions[start])
    said, named = stage.role.captions.get(number), stage.role.things.get(number)
    held = None if said is None else held_in(*said, named.thing if named is not None else "")
    own_props = {grip.prop for grip in held.props} if held else set()
    seen = np.zeros(stop - start, dtype=bool)
    away = np.full(stop - start, np.inf)
    for track in stage.acting.props:
        first, last = max(track.start, start), min(track.stop, stop)
        if track.prop not in own_props or first >= last:
            continue
        own = slice(first - track.start, last - track.start)
        seen[first - start : last - start] |= track.sizes[own] > WHOLE * track.sizes.max()
        head = stage.joints[first:last, INDEX["head"]]
        near = np.linalg.norm(track.positions[own] - head, axis=1)
        away[first - start : last - start] = np.minimum(away[first - start : last - start], near)
    frames = start + np.flatnonzero(seen)
    if not len(frames):
        return shot
    if skill in (Skill.SITDOWN, Skill.LIEDOWN):
        # Who sits down with it in the hand is shown seated.
        settled = frames[frames >= max((*shot.ghosts, start))]
        frames = settled if len(settled) else frames
        return Shot(int(frames[np.argmin(away[frames - start])]))
    return replace(shot, frame=int(frames[np.argmin(np.abs(frames - shot.frame))]))


def _held(stage: _Stage, frame: int) -> NDArray[np.floating]:
    """Where what is in the hands is at a frame. (N, 3)."""
    return np.array([one.positions[frame - one.start] for one in stage.acting.props if one.is_held(frame)])


def _window(stage: _Stage, start: int, stop: int, shot: Shot) -> tuple[float, float, float, float]:
    """A square of the floor that holds the room the body is in and the way it went."""
    points = stage.motion.root_positions[start:stop, [0, 2]].astype(np.float64)
    x, _, z = stage.joints[shot.frame, 0].tolist()
    room = stage.home.room_at((x, z))
    if room is not None:
        points = np.concatenate([points, stage.home.room_polygon(room)])
    low, high = points.min(axis=0) - 0.2, points.max(axis=0) + 0.2
    (x, z), half = (low + high) / 2, max(1.5, float((high - low).max()) / 2)
    return round(x - half, 1), round(z - half, 1), round(x + half, 1), round(z + half, 1)


def _camera(stage: _Stage, shot: Shot) -> Camera:
    return choose_camera(stage.home, stage.motion, stage.joints, shot, SIDE[0] / SIDE[1], _held(stage, shot.frame))


def _picture(stage: _Stage, shot: Shot, camera: Camera) -> Image:
    """The body in its pose, with ghosts of the poses before and after."""
    x, _, z = stage.joints[shot.frame, 0].tolist()
    poses = stage.joints[[shot.frame, *shot.ghosts]].reshape(-1, 3)
    solids = around(stage.props, camera, poses, stage.home.room_at((x, z)))
    solids += stage.acting.solids([shot.frame])
    if shot.ghosts:
        solids += stage.acting.solids(shot.ghosts, opacity=0.5)
    return render(solids, camera, SIDE)


def _plan(stage: _Stage, window: tuple[float, float, float, float]) -> Image:
    """That square of the home from above."""
    left, far, right, near = window
    x, z = (left + right) / 2, (far + near) / 2
    camera = Camera((x, 8.0, z), (x, 0.0, z), span=right - left)
    return render([prop.solid for prop in stage.props], camera, PLAN, ground=None)


def _sheet(count: int, title: str) -> tuple[Figure, list[tuple[int, int]]]:
    """An empty page with its title, and the lower left pixel of every pair on it."""
    from matplotlib.figure import Figure

    columns = max(1, min(COLUMNS, count))
    step = (SIDE[0] + PLAN[0] + 4 + 2 * GAP, SIDE[1] + TEXT + GAP)
    width, height = columns * step[0], -(-count // columns) * step[1] + HEAD + GAP
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, facecolor="white")
    figure.text(GAP / width, 1 - 0.5 * HEAD / height, title, fontsize=17, color=INK, va="center", parse_math=False)
    places = [divmod(place, columns) for place in range(count)]
    return figure, [(GAP + column * step[0], height - HEAD - (row + 1) * step[1] + GAP) for row, column in places]


def _draw_pair(
    figure: Figure, stage: _Stage, panel: _Panel, pictures: tuple[Image, Image], corner: tuple[int, int]
) -> None:
    """One keyframe's plan, picture and caption; `corner` is its lower left pixel."""
    width, height = (float(v) for v in figure.get_size_inches() * DPI)
    left, bottom = corner[0], corner[1] + TEXT
    axes = figure.add_axes((left / width, bottom / height, PLAN[0] / width, PLAN[1] / height))
    _draw_plan(axes, stage, panel, pictures[0])
    figure.figimage(pictures[1], left + PLAN[0] + 4, bottom, origin="upper")
    keyframe, fps = panel.keyframe, stage.motion.fps
    heading = f"{panel.index + 1}  {keyframe.skill.words}  ·  {keyframe.furniture}  ·  {keyframe.emotion}"
    seconds = f"{panel.start / fps:.0f}–{panel.stop / fps:.0f} s"
    if panel.unfilmed:
        seconds += f" · {panel.unfilmed / fps:.1f} s of walking not in the film"
    right = (left + PLAN[0] + SIDE[0] + 4) / width
    plain: dict[str, Any] = {"x": left / width, "color": INK, "va": "top", "parse_math": False}
    figure.text(y=(bottom - 7) / height, s=heading, fontsize=9.5, weight="bold", **plain)
    figure.text(right, (bottom - 7) / height, seconds, fontsize=8.5, color="#70757d", va="top", ha="right")
    caption = textwrap.fill(textwrap.shorten(keyframe.caption, 190, placeholder=" …"), 98)
    figure.text(y=(bottom - 26) / height, s=caption, fontsize=9, linespacing=1.25, **plain)


def _draw_plan(axes: Axes, stage: _Stage, panel: _Panel, plan: Image) -> None:
    """The room from above with the way of these frames, the body as it is in the shot, and where it faces."""
    left, far, right, near = panel.window
    way = stage.motion.root_positions[panel.start : panel.stop, [0, 2]]
    axes.imshow(plan, extent=(left, right, near, far), interpolation="nearest")
    walls = _wall_lines(stage.home)
    axes.plot(walls[:, 0], walls[:, 1], color=INK, linewidth=2.2, solid_capstyle="butt")
    if panel.target is not None:
        outline = stage.home.object(panel.target).footprint
        axes.fill(outline[:, 0], outline[:, 1], facecolor="none", edgecolor=WAY, linewidth=1.3)
    axes.plot(way[:, 0], way[:, 1], color="white", linewidth=3.2, alpha=0.8, solid_capstyle="round")
    axes.plot(way[:, 0], way[:, 1], color=WAY, linewidth=1.7, solid_capstyle="round")
    axes.plot(*way[0], marker="o", markersize=5, color="white", markeredgecolor=WAY)
    body = stage.joints[panel.shot.frame]
    bones = [(joint, parent) for joint, parent in enumerate(PARENTS) if parent >= 0]
    # One line with gaps draws faster than a line a bone.
    broken = np.full((len(bones), 3, 2), np.nan)
    broken[:, :2] = body[np.array(bones)][..., [0, 2]]
    axes.plot(broken[..., 0].ravel(), broken[..., 1].ravel(), color=BODY, linewidth=1.8, solid_capstyle="round")
    _draw_facing(axes, body)
    axes.set_xlim(left, right)
    axes.set_ylim(near, far)
    axes.set_axis_off()


def _wall_lines(home: Home) -> Array:
    """The walls as one broken line of [x, z], open where a door is. (N, 2), NaN between pieces."""
    gap = np.full(2, np.nan)
    points: list[Array] = []
    for wall in home.walls:
        start, end = np.asarray(wall.segment, dtype=np.float64)
        length = float(np.linalg.norm(end - start))
        if length < 1e-6:
            continue
        along = (end - start) / length
        doors = [opening.segment for opening in wall.openings if opening.bottom < 0.2]
        spans = sorted(sorted(float((np.asarray(p) - start) @ along) for p in door) for door in doors)
        stops = [0.0, *(value for span in spans for value in span), length]
        for a, b in zip(stops[::2], stops[1::2], strict=True):
            points += [start + a * along, start + b * along, gap]
    return np.array(points).reshape(-1, 2)


def _draw_facing(axes: Axes, joints: NDArray[np.float32]) -> None:
    """An arrow from the chest the way it faces: right shoulder to left shoulder, turned a quarter."""
    across = joints[16] - joints[17]
    spine = joints[12] - joints[0]
    ahead = np.cross(across, spine)[[0, 2]]
    length = float(np.hypot(*ahead))
    if length < 0.3 * float(np.linalg.norm(across)) * float(np.linalg.norm(spine)):
        return
    (x, z), (dx, dz) = joints[9, [0, 2]].tolist(), (0.45 * ahead / length).tolist()
    axes.annotate("", (x + dx, z + dz), (x, z), arrowprops={"arrowstyle": "-|>", "color": BODY, "linewidth": 1.6})
