"""Moments of a motion as a small moving picture (WebP) that begins anew: what a page shows before a film is played."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from motion_backend.body.cast import PLAIN, Role
from motion_backend.motion import Motion
from motion_backend.rendering.film_frames import film_frames
from motion_backend.rendering.film_picture import to_rgb
from motion_backend.rendering.film_shots import film_shots

if TYPE_CHECKING:
    from scene_graphs.home import Home

EVERY: Final = 3
"""Which of a film's frames it has: ten a second."""
QUALITY, EFFORT = 60, 4
"""As WebP counts them, to 100 and to 6."""


def moment(segment: tuple[int, int], seconds: float, fps: int) -> range:
    """The frames around the middle of a segment (start, stop) for so many seconds, as far as it has them."""
    middle, half = sum(segment) // 2, round(seconds * fps / 2)
    return range(max(middle - half, segment[0]), min(middle + half, segment[1]))


def write_loop(
    home: Home,
    motion: Motion,
    segments: Sequence[tuple[int, int]],
    moments: Sequence[range],
    path: Path,
    size: tuple[int, int],
    role: Role = PLAIN,
) -> Path:
    """The moments one after the other, as the film shows them; `segments` are frames of all keyframes."""
    from PIL import Image

    shots = film_shots(home, motion, [start for start, _ in segments], size[0] / size[1], role)
    wanted = [
        replace(shot, start=max(shot.start, one.start), stop=min(shot.stop, one.stop))
        for shot in shots
        for one in moments
        if max(shot.start, one.start) < min(shot.stop, one.stop)
    ]
    drawn = list(film_frames(motion, wanted, size, role=role))[::EVERY]
    pictures = [Image.fromarray(to_rgb(picture)) for picture in drawn]
    pause = round(1000 * EVERY / motion.fps)
    pictures[0].save(
        path, save_all=True, append_images=pictures[1:], duration=pause, loop=0, quality=QUALITY, method=EFFORT
    )
    return path
