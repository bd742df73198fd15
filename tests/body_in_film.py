"""How much of a film's decoded pictures is the body: told from pixels, by pictures of the same camera without it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.rendering.film_backdrop import Backdrop
from motion_backend.rendering.film_picture import Planes, split
from motion_backend.rendering.film_shots import film_shots
from motion_backend.rendering.motion_figures import Acting
from planner_service.output.film import Filmed

BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
SEEN: Final = 40
"""Steps of brightness between a black and a white body from which a pixel is the body's: its shadow stays the same."""
STANDS_OUT: Final = 16
"""Steps of brightness between a picture with the body and one without, from which a pixel shows which of them it is."""
PRESENT: Final = 0.003
"""The share of a picture that has to be of the body: a figure 35 pixels wide and 80 high of 1280 × 720."""


def body_shares(film: list[Planes], filmed: Filmed, every: int) -> dict[int, float]:
    """Of every so many frames of a decoded film (yuv420p) the share of pixels that show the body and not what is
    behind it. They are the body's where a black one and a white one differ; words and shadows are not."""
    height, width = split(film[0])[0].shape
    acting = Acting.of(filmed.motion, filmed.role)
    starts = [start for start, _ in filmed.segments]
    shares = {}
    for shot in film_shots(filmed.home, filmed.motion, starts, width / height, filmed.role):
        frames = range(shot.start + -shot.start % every, shot.stop, every)
        backdrop = Backdrop.of(shot.scene, shot.camera, (width, height)) if frames else None
        for frame, body in zip(frames, acting.solids(frames) if frames else (), strict=True):
            assert backdrop is not None
            black, white = (_bright(backdrop.with_body(replace(body, color=color))) for color in (BLACK, WHITE))
            there, empty = _bright(backdrop.with_body(body)), _bright(backdrop.planes)
            shown = _bright(film[frame])
            its = (white - black > SEEN) & (np.abs(there - empty) > STANDS_OUT)
            shares[frame] = float(np.mean(its & (np.abs(shown - there) < np.abs(shown - empty))))
    return shares


def decoded(path: str) -> Iterator[Planes]:
    """The pictures of a film as it keeps them. (3 height / 2, width) uint8 each."""
    import av

    with av.open(path) as film:
        for picture in film.decode(video=0):
            yield picture.to_ndarray(format="yuv420p")


def _bright(planes: Planes) -> NDArray[np.int16]:
    return split(planes)[0].astype(np.int16)
