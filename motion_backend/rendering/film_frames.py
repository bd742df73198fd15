"""A motion in its home as the pictures of a film, one after the other."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, Final

from motion_backend.motion import Motion
from motion_backend.rendering.film_backdrop import Backdrop
from motion_backend.rendering.film_shots import FilmShot
from motion_backend.rendering.motion_figures import around, body_solids, home_props
from motion_backend.rendering.renderer import Image

if TYPE_CHECKING:
    from scene_graphs.home import Home

WORKERS: Final = 2
"""Pictures drawn at once; compiled code lets go of the interpreter."""
BATCH: Final = 15
"""Frames whose bodies are worked out at once."""
AHEAD: Final = 4
"""Batches that wait to be taken, so that whoever writes slowly does not fill the memory."""


def film_frames(
    home: Home,
    motion: Motion,
    shots: Sequence[FilmShot],
    size: tuple[int, int],
    dressed: Callable[[int, Image], Image] = lambda _, picture: picture,
) -> Iterator[Image]:
    """Every frame of a motion as a picture (height, width, 3) of that size (width, height).

    `dressed` gets a frame's number and its picture, and gives the picture that is shown.
    """
    props = home_props(home)
    joints = motion.joint_positions()

    def backdrop(shot: FilmShot) -> Backdrop:
        points = joints[shot.start : shot.stop : BATCH].reshape(-1, 3)
        x, _, z = joints[(shot.start + shot.stop) // 2, 0].tolist()
        return Backdrop.of(around(props, shot.camera, points, home.room_at((x, z)), 7.0), shot.camera, size)

    def batch(scene: Future[Backdrop], frames: range) -> list[Image]:
        bodies = body_solids(motion, frames)
        return [dressed(i, scene.result().with_body(body)) for i, body in zip(frames, bodies, strict=True)]

    with ThreadPoolExecutor(WORKERS) as pool:
        waiting: deque[Future[list[Image]]] = deque()
        for shot in shots:
            scene = pool.submit(backdrop, shot)
            for start in range(shot.start, shot.stop, BATCH):
                waiting.append(pool.submit(batch, scene, range(start, min(start + BATCH, shot.stop))))
                while len(waiting) > AHEAD:
                    yield from waiting.popleft().result()
        while waiting:
            yield from waiting.popleft().result()
