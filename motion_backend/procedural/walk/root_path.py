"""Where the root of a walking body is at every frame: along a path, turning in place before and after.

The numbers are in data/gait/root_path.toml.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.pose import smooth
from motion_backend.rotations import Array
from scene_graphs.data_tables import read_table, table

SPACING = 0.03
"""Metres between the samples of a path."""
SAME_PLACE, STRAIGHT = 1e-9, 1e-6
"""Points nearer to each other than this are one (metres); a way that bends less is straight (radians a metre)."""


@table
class TurningInPlace:
    """Turns on the spot."""

    min_rad: float
    """What of a turn finds no room on the way is done on the spot, if it is more than this."""
    rad_per_s: float
    more_s: float
    """How much longer a turn takes."""
    ease_s: float
    """How long it takes to get going and to end,"""
    ease_before_s: float
    """of which this is over at the first frame."""


@table
class Shuffle:
    """Short ways, over which a body does not turn into the direction of travel."""

    below_m: float
    turn_max_rad: float
    """It turns by less than this as it goes, by more when it is there."""
    rad_per_s: float
    mps: float
    min_s: float


@table
class TurningOnTheWay:
    """A body turns into its way, and to what it goes to, while it steps along: aside or backwards as it begins."""

    m_per_rad: tuple[float, float]
    """Over so much of the way, as it begins and as it ends,"""
    min_m: float
    """no less than this,"""
    min_m_per_rad: tuple[float, float]
    """and over less of a short way, but no less than this."""
    still_m: float
    """It is done so long before the end, which is the slow part."""


@table
class PathSpeed:
    """How fast a way is gone."""

    bends_m: float
    """A way's direction is averaged over about three times this."""
    aside_max_mps2: float
    turn_max_rad_per_s: float
    end_mps: float
    """At both ends."""
    push_per_s: float
    """How fast it quickens, for its speed, and"""
    brake_per_s: float
    """slows down,"""
    push_from_mps: float
    """as if it were no slower."""
    runs_mps: float
    """Who is to be faster than this runs: he takes bends and starts and stops the harder, the faster he is to be."""
    backwards_mps: float
    """Who goes aside or backwards, while turning, is no faster."""


@table
class RootPathTable:
    """data/gait/root_path.toml."""

    turn: TurningInPlace
    way: TurningOnTheWay
    shuffle: Shuffle
    speed: PathSpeed


def root_path_table() -> RootPathTable:
    """The numbers of going along a way."""
    rows: RootPathTable = read_table("motion_backend", "gait/root_path.toml", RootPathTable)
    return rows


@dataclass(frozen=True)
class Route:
    """The root on the floor over T frames."""

    position: Array
    """(T, 2) as [x, z]."""
    heading: Array
    """(T,) yaw, continuous (not wrapped)."""
    speed: Array
    """(T,) metres a second."""

    def after(self, place: Array, heading: float, speed: float) -> Route:
        """The same route with the frame before it, where the body came from."""
        return Route(
            np.concatenate([place[None], self.position]),
            np.concatenate([[heading], self.heading]),
            np.concatenate([[speed], self.speed]),
        )

    def reaches(self, length: float) -> int:
        """The first frame that has so much of the way behind it (metres); the last one of a shorter way."""
        gone = np.cumsum(np.linalg.norm(np.diff(self.position, axis=0, prepend=self.position[:1]), axis=1))
        return min(int(np.searchsorted(gone, length)), len(gone) - 1)


def plan_route(
    path: Array,
    start_yaw: float,
    end_yaw: float | None,
    speed: float,
    fps: int,
    aside: float = 0.0,
    begun_mps: float | None = None,
) -> Route:
    """Sample a path (N, 2) in time: ease in and out, slow down in bends, turn first and last where needed.

    The body faces along the path, or `aside` of it (radians) to the side that takes less turning. One that already
    goes at `begun_mps` neither stops to turn nor starts anew.
    """  # fmt: skip
    rows, points = root_path_table(), resample(path)
    length = SPACING * (len(points) - 1)
    end = start_yaw if end_yaw is None else end_yaw
    if length < rows.shuffle.below_m and begun_mps is None:
        turn = float(rotations.wrap(end - start_yaw))
        if length < SPACING or abs(turn) < rows.shuffle.turn_max_rad:
            return _shuffle(points, start_yaw, turn, fps)
        return _joined([_shuffle(points, start_yaw, 0.0, fps), _turn(points[-1], start_yaw, start_yaw + turn, fps)])
    tangent = _tangents(points)
    tangent = tangent + _less_turning(tangent, aside, start_yaw, end_yaw)
    facing = _facing(tangent, end_yaw)
    first = float(rotations.wrap(facing[0] - start_yaw))
    last = 0.0 if end_yaw is None else float(rotations.wrap(end_yaw - facing[-1]))
    turns = _turns_on_the_way(first, last, length, begun_mps is not None)
    before, after = first - turns.first, last - turns.last
    pieces: list[Route] = []
    if before:
        pieces.append(_turn(points[0], start_yaw, start_yaw + before, fps))
    about = start_yaw + first - facing[0]
    pieces.append(_walk(points, (tangent + about, facing + about), turns, (speed, fps, begun_mps)))
    if after:
        arrived = float(pieces[-1].heading[-1])
        pieces.append(_turn(points[-1], arrived, arrived + after, fps))
    return _joined(pieces)


def _facing(tangent: Array, end_yaw: float | None) -> Array:
    """Where a body faces on its way but for its first and last turn: along it, and over its end, where it turns to a
    yaw, as where that begins. (M,)."""
    facing = tangent.copy()
    if end_yaw is not None:
        ends = max(len(tangent) - 1 - int(root_path_table().way.min_m / SPACING), 0)
        facing[ends:] = tangent[ends]
    return facing


@dataclass(frozen=True)
class _Turns:
    """What a body turns while it goes along, beside the bends of its way."""

    first: float
    """Into the way, at its beginning (radians)."""
    last: float
    """To what it goes to, at its end."""
    first_m: float
    """Over so much of the way."""
    last_m: float

    def to_go(self, arc: Array) -> Array:
        """How far it faces from the way so far along it. (M,) radians."""
        row = root_path_table().way
        begun = smooth((arc - arc[-1] + self.last_m + row.still_m) / self.last_m)
        return np.asarray(self.last * begun - self.first * (1 - smooth(arc / self.first_m)))


def _turns_on_the_way(first: float, last: float, length: float, in_stride: bool) -> _Turns:
    """What of the first and the last turn there is room for on a way of that length; who is under way does all."""
    rows = root_path_table()
    row, free = rows.way, max(length - rows.way.still_m, SPACING)
    both = tuple(zip((first, last), row.m_per_rad, row.min_m_per_rad, strict=True))
    wanted = [max(usual * abs(turn), row.min_m) if turn else SPACING for turn, usual, _ in both]
    share = min(1.0, free / sum(wanted))
    done, over = [], []
    for (turn, _, least), metres in zip(both, wanted, strict=True):
        most = metres * share / least
        rest = abs(turn) - most
        done.append(turn if in_stride or rest < rows.turn.min_rad else float(np.sign(turn)) * most)
        over.append(metres * share)
    return _Turns(done[0], done[1], over[0], over[1])


def _joined(pieces: list[Route]) -> Route:
    return Route(
        np.concatenate([p.position for p in pieces]),
        np.concatenate([p.heading for p in pieces]),
        np.concatenate([p.speed for p in pieces]),
    )


def _less_turning(tangent: Array, aside: float, start_yaw: float, end_yaw: float | None) -> float:
    def turning(offset: float) -> float:
        last = 0.0 if end_yaw is None else abs(float(rotations.wrap(end_yaw - tangent[-1] - offset)))
        return abs(float(rotations.wrap(tangent[0] + offset - start_yaw))) + last

    return min((aside, -aside), key=turning)


def resample(path: Array) -> Array:
    """Points every 3 cm along a polyline; its ends are kept. (M, 2)."""
    path = np.asarray(path, dtype=np.float64).reshape(-1, 2)
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    keep = np.concatenate([[True], steps > SAME_PLACE])
    count = max(round(arc[-1] / SPACING), 1) + 1
    at = np.linspace(0.0, arc[-1], count)
    return np.stack([np.interp(at, arc[keep], path[keep, axis]) for axis in (0, 1)], axis=1)


def _tangents(points: Array) -> Array:
    """Directions of travel as continuous yaw, averaged over a third of a metre. (M,)."""
    from scipy.ndimage import gaussian_filter1d

    step = np.diff(points, axis=0)
    yaw = np.unwrap(np.arctan2(step[:, 0], step[:, 1]))
    yaw = np.concatenate([yaw, yaw[-1:]])
    return np.asarray(gaussian_filter1d(yaw, root_path_table().speed.bends_m / SPACING, mode="nearest"))


def _walk(points: Array, yaws: tuple[Array, Array], turns: _Turns, pace: tuple[float, int, float | None]) -> Route:
    """Along points (M, 2) that lead to one yaw and are gone facing another, (M,) each."""
    (speed, fps, begun), row, (tangent, facing) = pace, root_path_table().speed, yaws
    arc = SPACING * np.arange(len(points), dtype=np.float64)
    to_go = turns.to_go(arc) + facing - tangent
    limit = _speed_limits(tangent, to_go, speed, row, begun)
    time = np.concatenate([[0.0], np.cumsum(2 * SPACING / (limit[1:] + limit[:-1]))])
    at = np.arange(1, int(np.ceil(time[-1] * fps)) + 1) / fps
    along = np.interp(at, time, arc)
    position = np.stack([np.interp(along, arc, points[:, axis]) for axis in (0, 1)], axis=1)
    return Route(position, np.interp(along, arc, tangent + to_go), np.interp(at, time, limit))


def _speed_limits(tangent: Array, to_go: Array, speed: float, row: PathSpeed, begun: float | None) -> Array:
    """How fast each point of a path is passed by a body that faces `to_go` (M,) from it: slowly in bends and turns,
    quickening and slowing down as bodies can. (M,)."""
    bend, turn = (np.maximum(np.abs(np.gradient(yaw, SPACING)), STRAIGHT) for yaw in (tangent, tangent + to_go))
    harder = max(speed / row.runs_mps, 1.0)
    limit = np.minimum(speed, harder * (row.aside_max_mps2 / bend) ** 0.5)
    limit = np.minimum(limit, row.turn_max_rad_per_s / turn)
    ahead = np.clip(np.cos(to_go), 0.0, 1.0)
    limit = np.minimum(limit, row.backwards_mps + ahead * max(speed - row.backwards_mps, 0.0))
    limit[0], limit[-1] = row.end_mps if begun is None else begun, row.end_mps
    push = row.push_per_s * harder**2 * max(speed, row.push_from_mps)
    brake = row.brake_per_s * harder * max(speed, row.push_from_mps)
    for i in range(1, len(limit)):
        limit[i] = min(limit[i], np.sqrt(limit[i - 1] ** 2 + 2 * push * SPACING))
    for i in range(len(limit) - 2, -1, -1):
        limit[i] = min(limit[i], np.sqrt(limit[i + 1] ** 2 + 2 * brake * SPACING))
    if begun is not None:
        # Who comes along quickly cannot be slower at once.
        arc = SPACING * np.arange(len(limit))
        limit = np.maximum(limit, np.sqrt(np.maximum(begun**2 - 2 * brake * arc, 0.0)))
    return np.asarray(limit)


def evenly(frames: int, fps: int) -> Array:
    """Share of a turn done at each of its frames: at one rate, with a short ease at both ends. (frames,).

    With a peak, single steps would have to turn further than feet can.
    """
    row, at = root_path_table().turn, (np.arange(frames) + 0.5) / fps
    left = frames / fps - at
    starting, ending = smooth((at + row.ease_before_s) / row.ease_s), smooth((left + row.ease_before_s) / row.ease_s)
    done = np.cumsum(starting * ending)
    return np.asarray(done / done[-1])


def _turn(point: Array, start: float, end: float, fps: int) -> Route:
    row = root_path_table().turn
    frames = max(int(np.ceil((abs(end - start) / row.rad_per_s + row.more_s) * fps)), 1)
    share = evenly(frames, fps)
    return Route(np.repeat(point[None], frames, axis=0), start + share * (end - start), np.zeros(frames))


def _shuffle(points: Array, start: float, turn: float, fps: int) -> Route:
    row, length = root_path_table().shuffle, SPACING * (len(points) - 1)
    frames = max(int(np.ceil(max(abs(turn) / row.rad_per_s, length / row.mps, row.min_s) * fps)), 1)
    share = evenly(frames, fps)
    position = points[0] + share[:, None] * (points[-1] - points[0])
    return Route(position, start + share * turn, np.full(frames, length / frames * fps))
