"""What the shared walk driver asks of anything that makes walking frames: motion matching, a diffusion model.

A generator knows neither homes nor parts. It is shown the last frames of a body of 1.70 m and where the pelvis is to be
in the next second and a half, and gives the next frames, as many as it likes; then it is asked again:

    walker = generator.begin(past, rng)      # past: up to ten frames, oldest first; the body may stand or walk
    while not there:
        frames = walker.window(ahead)        # one frame or more at 30 a second, which follow on the last

Y up, metres, 30 frames a second, quaternions xyzw, floor at y = 0. `motion_backend/walk_driver.py` does the rest: the
way through the home, starts, stops and turns on the spot, joints without a seam, feet, furniture, other body heights.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.rotations import Array

LOOK: Final = 42
"""Frames that a generator is told of ahead: 1.4 s, a window of LINGO."""
NEAR: Final = 20
"""Frames of a way that are looked at for the one that the body has come to."""


@dataclass(frozen=True)
class Frames:
    """T frames of a body of 1.70 m."""

    root: Array
    """(T, 3) pelvis in the world."""
    local: Array
    """(T, 22, 4) each joint in its parent's frame, the pelvis in the world's."""

    def __len__(self) -> int:
        return len(self.root)

    def __getitem__(self, taken: slice) -> Frames:
        return Frames(self.root[taken], self.local[taken])

    def then(self, later: Frames) -> Frames:
        """These and then the others."""
        return Frames(np.concatenate([self.root, later.root]), np.concatenate([self.local, later.local]))


@dataclass(frozen=True)
class Ahead:
    """Where a walking body is to go."""

    places: Array
    """(LOOK, 2) [x, z] of the pelvis in each of the coming frames; the last one is LINGO's pelvis goal."""

    @property
    def yaws(self) -> Array:
        """Where the way leads at each of them. (LOOK,), continuous."""
        steps = np.diff(self.places, axis=0, prepend=2 * self.places[:1] - self.places[1:2])
        return np.asarray(np.unwrap(np.arctan2(steps[:, 0], steps[:, 1])))


@dataclass(frozen=True)
class Way:
    """Where the pelvis of a walking body is to be over time; it sways about that."""

    places: Array
    """(N, 2) [x, z], one a frame at 30 a second."""

    @staticmethod
    def along(points: Array, speed: float) -> Way:
        """At one speed (metres a second) along a line (N, 2)."""
        steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
        arc = np.concatenate([[0.0], np.cumsum(steps)])
        at = np.arange(0.0, arc[-1], speed / FPS)
        return Way(np.stack([np.interp(at, arc, points[:, axis]) for axis in (0, 1)], axis=1))

    def __len__(self) -> int:
        return len(self.places)

    @property
    def yaw(self) -> float:
        """Where it sets out to."""
        x, z = self.places[min(FPS // 2, len(self) - 1)] - self.places[0]
        return float(np.arctan2(x, z))

    def reached(self, place: Array, since: int, made: int = 0) -> int:
        """The frame of the way that is nearest to a place (2,), of those that come shortly after one; `made` since."""
        near = self.places[since : since + max(NEAR, made + NEAR // 2)]
        return since + int(np.argmin(np.sum((near - place) ** 2, axis=1)))

    def ahead(self, frame: int) -> Ahead:
        """What comes after a frame; beyond its end a way goes on as it ended."""
        places = self.places[frame + 1 : frame + 1 + LOOK]
        lacking = LOOK - len(places)
        if lacking:
            last, before = self.places[-1], self.places[-2] if len(self) > 1 else self.places[-1]
            beyond = last + np.arange(1, lacking + 1)[:, None] * (last - before)
            places = np.concatenate([places, beyond])
        return Ahead(places)


class Walker(Protocol):
    """One walk in the making."""

    def window(self, ahead: Ahead) -> Frames:
        """The next frames, at least one, from where the last ones ended."""
        ...


class WalkGenerator(Protocol):
    """Something that makes walking frames."""

    name: str
    slowest: float
    """Metres a second below which it does not walk: starts and stops are then the procedural body's."""

    @property
    def pace(self) -> float | None:
        """Metres a second at which it walks where nothing hurries it; None: at any."""
        ...

    def begin(self, past: Frames, rng: np.random.Generator) -> Walker:
        """Go on from the last frames of a body, whoever made them; what is random comes from `rng`."""
        ...


def follow(walker: Walker, past: Frames, way: Way) -> Frames:
    """Walk to the end of a way. (N frames, about as many as the way has.)"""
    made = list(windows(walker, past, way))
    root, local = (np.concatenate(column) for column in zip(*((one.root, one.local) for one in made), strict=True))
    return Frames(root, local)


def windows(walker: Walker, past: Frames, way: Way) -> Iterator[Frames]:
    """One window after the other until the end of the way is reached, or should have been long ago."""
    frame, made = way.reached(past.root[-1, [0, 2]], 0), 0
    while frame < len(way) - 1 and made < 2 * len(way) + LOOK:
        found = walker.window(way.ahead(frame))
        yield found
        made += len(found)
        frame = way.reached(found.root[-1, [0, 2]], frame, len(found))


def yaw_of(turns: Array) -> Array:
    """Where turned bodies face. (…, 4) to (…,)."""
    facing = rotations.rotate(turns, np.array([0.0, 0.0, 1.0]))
    return np.asarray(np.arctan2(facing[..., 0], facing[..., 2]))
