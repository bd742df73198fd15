"""Where in a home there is room to run: the way with the longest straight piece that leads to a place, or to any.

Who runs needs three or four metres to get up to speed and to stop again. A place that is nearer is gone round to: away
from it first, to where the way back to it is long.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from motion_backend.motion import Action, Skill
from motion_backend.procedural.walk.walk_styles import walk_style
from scene_graphs.navigation.path_planner import Walkable

Point = tuple[float, float]
LONG_ENOUGH, WORTH = 3.5, 4.5
"""A straight way on which a body gets up to 2.2 m/s and stops again (metres), and up to where a longer one is
worth more."""
TRIES: Final = 60
"""Places of a room that are looked at."""
SPARE: Final = 0.05
"""What such a place leaves free beyond what the body needs (metres)."""
DETOUR: Final = 0.1
"""What a metre of way costs (metres of the straight piece)."""


class Run(NamedTuple):
    """A way to run."""

    by: Point | None
    """Where it first leads; None where it leads straight to its goal."""
    goal: Point
    straight: float
    """Its longest straight piece (metres)."""


def runs(action: Action) -> bool:
    """Whether an action is a run."""
    return action.skill is Skill.LOCO and walk_style(action.emotion, action.caption).double < 0


def way_to_run(
    walkable: Walkable, start: Point, room: int, rng: np.random.Generator, goal: Point | None = None
) -> Run | None:
    """The way from a place with the longest straight piece, over places of a room: to `goal` where there is one, else
    to any of them. None where nothing in the room can be walked to."""
    found = walkable.free_points(rng, room, TRIES, SPARE)
    points = found[[walkable.reachable(start, (x, z)) for x, z in found.tolist()]]
    if not len(points):
        return None
    ends = points if goal is None else np.array([goal])
    here = np.array([start])
    # Rows are places that are gone by, the first of them the start itself: the way then leads straight to its goal.
    stops = np.concatenate([here, points])
    first, second = walkable.straight(here, stops)[0], walkable.straight(stops, ends)
    pieces = np.minimum(np.maximum(first[:, None], second), WORTH)
    ways = np.linalg.norm(stops - here, axis=1)[:, None] + np.linalg.norm(stops[:, None] - ends[None], axis=2)
    stop, end = np.unravel_index(int(np.argmax(pieces - DETOUR * ways)), pieces.shape)
    by, to = ((float(x), float(z)) for x, z in (stops[stop], ends[end]))
    return Run(by if stop else None, to, float(pieces[stop, end]))
