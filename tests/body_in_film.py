"""How much of a film's decoded pictures is the body: told from pixels, beside pictures of that camera without it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import av
import numpy as np
from numpy.typing import NDArray

from motion_backend.rendering.film_backdrop import Backdrop
from motion_backend.rendering.film_picture import Planes, split
from motion_backend.rendering.film_shots import film_shots
from motion_backend.rendering.motion_figures import Acting
from motion_backend.rendering.renderer import Solid
from planner_service.output.film import Filmed

BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
PAINTED: Final = 40
"""Steps of brightness between a black and a white body from which a pixel is the body's; its shadow stays the same."""
STANDS_OUT: Final = 16
"""Steps of brightness between a picture with the body and one without, from which a pixel tells which of them it is."""
PRESENT: Final = 0.006
"""The share of a picture that is to be of the body: a figure 55 pixels wide and 100 high of 1280 × 720. The band behind
a title, without any body, may look like two thirds of that."""


def decoded(path: Path) -> Iterator[Planes]:
    """The pictures of a film as it keeps them. (3 height / 2, width) uint8 each."""
    with av.open(str(path)) as film:
        for picture in film.decode(video=0):
            yield picture.to_ndarray(format="yuv420p").astype(np.uint8)


def body_shares(film: Sequence[Planes], filmed: Filmed, every: int) -> dict[int, float]:
    """For every so many frames of a decoded film the share of its pixels that show the body.

    They are where a black body and a white one would differ, and the film is as a picture with the body is and as one
    of what is behind it is not. Words, shadows, and what looks like what is behind it do not count.
    """
    height, width = split(film[0])[0].shape
    acting = Acting.of(filmed.motion, filmed.role)
    starts = [start for start, _ in filmed.segments]
    shares = {}
    for shot in film_shots(filmed.home, filmed.motion, starts, width / height, filmed.role, filmed.edit):
        if frames := range(shot.start + -shot.start % every, shot.stop, every):
            backdrop = Backdrop.of(shot.scene, shot.camera, (width, height))
            for frame, body in zip(frames, acting.solids(frames), strict=True):
                shares[frame] = _share(film[filmed.edit.frame(frame)], backdrop, body)
    return shares


def _share(picture: Planes, backdrop: Backdrop, body: Solid) -> float:
    black, white = (_bright(backdrop.with_body(replace(body, color=color))) for color in (BLACK, WHITE))
    there, empty, shown = (_bright(one) for one in (backdrop.with_body(body), backdrop.planes, picture))
    its = (white - black > PAINTED) & (np.abs(there - empty) > STANDS_OUT)
    return float(np.mean(its & (np.abs(shown - there) < STANDS_OUT / 2)))


def _bright(planes: Planes) -> NDArray[np.int16]:
    return split(planes)[0].astype(np.int16)
