"""A motion in its home as the pictures of a film, one after the other."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Final

from motion_backend.body.cast import PLAIN, Role
from motion_backend.motion import Motion
from motion_backend.rendering.film_backdrop import Backdrop
from motion_backend.rendering.film_picture import Planes
from motion_backend.rendering.film_shots import FilmShot
from motion_backend.rendering.motion_figures import Acting

WORKERS: Final = 2
"""Pictures drawn at once; compiled code lets go of the interpreter."""
BATCH: Final = 15
"""Frames whose bodies are worked out at once."""
AHEAD: Final = 4
"""Batches that wait to be taken, so that whoever writes slowly does not fill the memory."""


def film_frames(
    motion: Motion,
    shots: Sequence[FilmShot],
    size: tuple[int, int],
    dressed: Callable[[int, Planes], Planes] = lambda _, picture: picture,
    role: Role = PLAIN,
) -> Iterator[Planes]:
    """Every frame of a motion as a picture of that size (width, height), both even; see `film_picture`.

    `dressed` gets a frame's number and its picture, and gives the picture that is shown.
    """
    acting = Acting.of(motion, role)

    def batch(scene: Future[Backdrop], frames: range) -> list[Planes]:
        bodies = acting.solids(frames)
        return [dressed(i, scene.result().with_body(body)) for i, body in zip(frames, bodies, strict=True)]

    with ThreadPoolExecutor(WORKERS) as pool:
        waiting: deque[Future[list[Planes]]] = deque()
        for shot in shots:
            scene = pool.submit(Backdrop.of, shot.scene, shot.camera, size)
            for start in range(shot.start, shot.stop, BATCH):
                waiting.append(pool.submit(batch, scene, range(start, min(start + BATCH, shot.stop))))
                while len(waiting) > AHEAD:
                    yield from waiting.popleft().result()
        while waiting:
            yield from waiting.popleft().result()
