"""A motion in its home as the pictures of a film, one after the other."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Final

import numpy as np

from motion_backend.body.cast import PLAIN, Role
from motion_backend.motion import Character, Motion
from motion_backend.props import PropTrack
from motion_backend.rendering.film_backdrop import Backdrop
from motion_backend.rendering.film_picture import Planes
from motion_backend.rendering.film_shots import FilmShot, film_shots
from motion_backend.rendering.motion_figures import Acting, lying_solids
from motion_backend.rotations import IDENTITY
from motion_backend.skeleton import build_skeleton

WORKERS: Final = 2
"""Pictures drawn at once; compiled code lets go of the interpreter."""
BATCH: Final = 15
"""Frames whose bodies are worked out at once."""
AHEAD: Final = 4
"""Batches that wait to be taken, so that whoever writes slowly does not fill the memory."""
SMALL: Final = (64, 36)
"""Pixels across and down of a picture that nobody looks at."""


def film_frames(
    motion: Motion,
    shots: Iterable[FilmShot],
    size: tuple[int, int],
    dressed: Callable[[int, Planes], Planes] = lambda _, picture: picture,
    role: Role = PLAIN,
) -> Iterator[Planes]:
    """Every frame of a motion as a picture of that size (width, height), both even; see `film_picture`.

    `dressed` gets a frame's number and its picture, and gives the picture that is shown.
    """
    acting = Acting.of(motion, role)

    def batch(scene: Future[Backdrop], frames: range, lying: Sequence[PropTrack]) -> list[Planes]:
        bodies = acting.solids(frames, but=lying)
        return [dressed(i, scene.result().with_body(body)) for i, body in zip(frames, bodies, strict=True)]

    with ThreadPoolExecutor(WORKERS) as pool:
        waiting: deque[Future[list[Planes]]] = deque()
        before: list[tuple[FilmShot, list[PropTrack], int, Future[Backdrop]]] = []
        for shot in shots:
            for start in range(shot.start, shot.stop, BATCH):
                frames = range(start, min(start + BATCH, shot.stop))
                lying = acting.lying(frames.start, frames.stop)
                # Behind a close-up the shot that it stands in goes on.
                same = (
                    drawn for one, here, at, drawn in before
                    if one.scene is shot.scene and _same(here, at, lying, start)
                )  # fmt: skip
                if (scene := next(same, None)) is None:
                    whole = [*shot.scene, *lying_solids(lying, start, shot.camera)]
                    scene = pool.submit(Backdrop.of, whole, shot.camera, size)
                if not before or before[-1][3] is not scene:
                    before = [*before[-1:], (shot, lying, start, scene)]
                waiting.append(pool.submit(batch, scene, frames, lying))
                while len(waiting) > AHEAD:
                    yield from waiting.popleft().result()
        while waiting:
            yield from waiting.popleft().result()


def _same(some: Sequence[PropTrack], at: int, others: Sequence[PropTrack], now: int) -> bool:
    """Whether what lies at one frame is what lies at another, and where it did: a door may have shut between."""
    return len(some) == len(others) and all(
        one is other
        and np.array_equal(one.positions[at - one.start], one.positions[now - one.start])
        and np.array_equal(one.turns[at - one.start], one.turns[now - one.start])
        for one, other in zip(some, others, strict=True)
    )


def compile_film() -> None:
    """Film one small picture, so that what draws films and pictures is compiled and kept on disk: half a minute on a
    fresh machine, else a second."""
    from scene_graphs.home import home_from_layouts
    from scene_graphs.layout_library import built_in_layouts

    home = home_from_layouts(built_in_layouts()[:1], seed=0)
    skeleton = build_skeleton(Character().height)
    x, z = home.room_polygon(0).mean(axis=0)
    stands = Motion(
        root_positions=np.array([[x, skeleton.standing_height, z]], np.float32),
        local_rotations=np.tile(np.float32(IDENTITY), (1, len(skeleton.names), 1)),
        contacts=np.ones((1, 4), np.float32),
        skeleton=skeleton,
        actions=np.zeros(1, np.int32),
    )
    width, height = SMALL
    for _ in film_frames(stands, film_shots(home, stands, [0], width / height), SMALL):
        pass
