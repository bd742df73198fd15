"""Where the root of a walking body is at every frame: along a path, turning in place before and after."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.pose import smooth
from motion_backend.rotations import Array

SPACING = 0.03
"""Metres between the samples of a path."""
TURN_IN_PLACE = 0.9
"""A body turns on the spot before it walks off in a direction further away than this (radians)."""
MIN_WALK_LENGTH = 0.35
"""Over less than this (metres) a body shuffles without turning into the direction of travel."""

TURN_ON_THE_WAY = 1.2
"""A body that shuffles turns by less than this (radians) as it goes, by more when it is there."""
EASE = 0.4
"""How long a turn takes to get going and to end (seconds)."""


@dataclass(frozen=True)
class Route:
    """The root on the floor over T frames."""

    position: Array
    """(T, 2) as [x, z]."""
    heading: Array
    """(T,) yaw, continuous (not wrapped)."""
    speed: Array
    """(T,) metres a second."""


def plan_route(
    path: Array, start_yaw: float, end_yaw: float | None, speed: float, fps: int, aside: float = 0.0
) -> Route:
    """Sample a path (N, 2) in time: ease in and out, slow down in bends, turn first and last where needed.

    The body faces along the path, or `aside` of it (radians) to the side that takes less turning.
    """
    points = resample(path)
    length = SPACING * (len(points) - 1)
    end = start_yaw if end_yaw is None else end_yaw
    if length < MIN_WALK_LENGTH:
        turn = float(rotations.wrap(end - start_yaw))
        if length < SPACING or abs(turn) < TURN_ON_THE_WAY:
            return _shuffle(points, start_yaw, turn, fps)
        return _joined([_shuffle(points, start_yaw, 0.0, fps), _turn(points[-1], start_yaw, start_yaw + turn, fps)])
    tangent = _tangents(points)
    tangent = tangent + _less_turning(tangent, aside, start_yaw, end_yaw)
    pieces: list[Route] = []
    first_turn = float(rotations.wrap(tangent[0] - start_yaw))
    yaw = start_yaw
    if abs(first_turn) > TURN_IN_PLACE:
        # The last third of the turn is left to the first steps, as people do.
        yaw = start_yaw + first_turn - np.sign(first_turn) * 0.5
        pieces.append(_turn(points[0], start_yaw, yaw, fps))
    last_turn = 0.0 if end_yaw is None else float(rotations.wrap(end_yaw - tangent[-1]))
    walked = _walk(points, tangent, yaw, last_turn if abs(last_turn) <= TURN_IN_PLACE else 0.0, (speed, fps))
    pieces.append(walked)
    if abs(last_turn) > TURN_IN_PLACE:
        pieces.append(_turn(points[-1], float(walked.heading[-1]), float(walked.heading[-1]) + last_turn, fps))
    return _joined(pieces)


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
    keep = np.concatenate([[True], steps > 1e-9])
    count = max(round(arc[-1] / SPACING), 1) + 1
    at = np.linspace(0.0, arc[-1], count)
    return np.stack([np.interp(at, arc[keep], path[keep, axis]) for axis in (0, 1)], axis=1)


def _tangents(points: Array) -> Array:
    """Directions of travel as continuous yaw, averaged over a third of a metre. (M,)."""
    from scipy.ndimage import gaussian_filter1d

    step = np.diff(points, axis=0)
    yaw = np.unwrap(np.arctan2(step[:, 0], step[:, 1]))
    yaw = np.concatenate([yaw, yaw[-1:]])
    return np.asarray(gaussian_filter1d(yaw, 0.12 / SPACING, mode="nearest"))


def _walk(points: Array, tangent: Array, yaw: float, last_turn: float, pace: tuple[float, int]) -> Route:
    speed, fps = pace
    arc = SPACING * np.arange(len(points))
    bend = np.abs(np.gradient(tangent, SPACING))
    limit = np.minimum(speed, 1.0 / np.maximum(bend, 1e-6) ** 0.5)
    limit = np.minimum(limit, 2.2 / np.maximum(bend, 1e-6))
    limit[0] = limit[-1] = 0.12
    push, brake = 0.8 * max(speed, 0.8), 1.1 * max(speed, 0.8)
    for i in range(1, len(limit)):
        limit[i] = min(limit[i], np.sqrt(limit[i - 1] ** 2 + 2 * push * SPACING))
    for i in range(len(limit) - 2, -1, -1):
        limit[i] = min(limit[i], np.sqrt(limit[i + 1] ** 2 + 2 * brake * SPACING))
    time = np.concatenate([[0.0], np.cumsum(2 * SPACING / (limit[1:] + limit[:-1]))])
    at = np.arange(1, int(np.ceil(time[-1] * fps)) + 1) / fps
    along = np.interp(at, time, arc)
    position = np.stack([np.interp(along, arc, points[:, axis]) for axis in (0, 1)], axis=1)
    heading = np.interp(along, arc, tangent)
    heading = heading + float(rotations.wrap(yaw - tangent[0])) * (1 - smooth(along / 0.7))
    heading = heading + last_turn * smooth((along - (arc[-1] - 0.7)) / 0.7)
    # Start from the yaw as given, not wrapped, so that headings of neighbouring pieces join.
    heading = heading + (yaw - float(rotations.wrap(yaw - tangent[0])) - tangent[0])
    return Route(position, heading, np.interp(at, time, limit))


def evenly(frames: int, fps: int) -> Array:
    """Share of a turn done at each of its frames: at one rate, with a short ease at both ends. (frames,).

    With a peak, single steps would have to turn further than feet can.
    """
    at = (np.arange(frames) + 0.5) / fps
    done = np.cumsum(smooth((at + 0.02) / EASE) * smooth((frames / fps - at + 0.02) / EASE))
    return np.asarray(done / done[-1])


def _turn(point: Array, start: float, end: float, fps: int) -> Route:
    frames = max(int(np.ceil((abs(end - start) / 2.1 + 0.15) * fps)), 1)
    share = evenly(frames, fps)
    return Route(np.repeat(point[None], frames, axis=0), start + share * (end - start), np.zeros(frames))


def _shuffle(points: Array, start: float, turn: float, fps: int) -> Route:
    length = SPACING * (len(points) - 1)
    frames = max(int(np.ceil(max(abs(turn) / 2.0, length / 0.35, 0.1) * fps)), 1)
    share = evenly(frames, fps)
    position = points[0] + share[:, None] * (points[-1] - points[0])
    return Route(position, start + share * turn, np.full(frames, length / frames * fps))
