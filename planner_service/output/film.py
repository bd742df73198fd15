"""A story as film.mp4: shots of the body acting it out, its title at the beginning, its told words as captions."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from motion_backend.body.cast import PLAIN, Role
from motion_backend.formats.mp4 import write_mp4
from motion_backend.rendering.film_frames import film_frames
from motion_backend.rendering.film_picture import lay_words
from motion_backend.rendering.film_shots import FilmShot, film_shots
from motion_backend.rendering.title_place import Place, title_place
from planner_service.output.film_letters import lettered, titled
from planner_service.output.film_pages import subtitles
from scene_graphs.errors import UserError

if TYPE_CHECKING:
    from motion_backend.motion import Motion
    from motion_backend.rendering.film_picture import Planes
    from planner_service.narration.told import Told
    from planner_service.pipeline import Story
    from scene_graphs.home import Home

SIZE: Final = (1280, 720)
"""Pixels across and down."""
TITLE_SECONDS: Final = (1.6, 2.5)
"""At least, and as long as nobody walks under it."""
FIRST_WORDS: Final = 1.0
"""Seconds after which told words may begin under it."""
TEXT_HEIGHT, TITLE_HEIGHT = 0.042, 0.085
"""Of the picture's height."""
WORDS_END: Final = 0.94
"""Where in the picture's height told words end."""
SHADE: Final = 0.62
"""How much of a picture's light stays under its words."""


class FilmUnavailableError(UserError):
    """No film can be written here; says what is missing."""


def check_film() -> None:
    """FilmUnavailableError where the library that writes films is not installed; nothing is loaded."""
    if find_spec("av") is None:
        raise FilmUnavailableError(
            "writing film.mp4 needs a library that is not installed", 'pip install "sims-stories[video]"', at="--film"
        )


@dataclass(frozen=True)
class Filmed:
    """What is filmed of a story."""

    home: Home
    motion: Motion
    told: Told
    segments: tuple[tuple[int, int], ...]
    """First frame and stop frame of every keyframe."""
    role: Role = PLAIN

    @staticmethod
    def of(story: Story) -> Filmed:
        """One that was just made."""
        return Filmed(story.planned.home, story.motion, story.told, story.segments, story.role)


def write_film(
    filmed: Filmed, path: Path, size: tuple[int, int] = SIZE, show: Callable[[float], None] = lambda _: None
) -> Path:
    """Film a story; `show` is told which share is done, and what it raises ends the film. FilmUnavailableError."""
    check_film()
    motion, told = filmed.motion, filmed.told
    shots = film_shots(filmed.home, motion, [start for start, _ in filmed.segments], size[0] / size[1], filmed.role)
    title = titled(told.title, size, TITLE_HEIGHT)
    across, bottom, untitled = 0.0, 0.0, 0
    if title is not None:
        place, untitled, shots = _placed(title.shape, size, shots, motion)
        across, bottom = place.across, place.box((title.shape[0], title.shape[1]), size)[3] / size[1]
    lines = subtitles(told, filmed.segments, motion.fps, round(FIRST_WORDS * motion.fps) if untitled else 0)
    words = [(line, lettered(line.lines, size, TEXT_HEIGHT)) for line in lines]

    def dressed(frame: int, picture: Planes) -> Planes:
        for line, letters in words:
            if letters is not None and line.start <= frame < line.stop:
                lay_words(picture, letters, WORDS_END, SHADE)
        if title is not None and frame < untitled:
            lay_words(picture, title, bottom, SHADE, across)
        return picture

    def counted() -> Iterator[Planes]:
        for number, picture in enumerate(film_frames(motion, shots, size, dressed, filmed.role)):
            show(number / len(motion))
            yield picture

    return write_mp4(counted(), path, motion.fps)


def _placed(
    words: tuple[int, ...], size: tuple[int, int], shots: Iterator[FilmShot], motion: Motion
) -> tuple[Place, int, Iterator[FilmShot]]:
    """Where a title (height, width) stands, the frame at which it goes, and all shots again."""
    least, frames = (round(seconds * motion.fps) for seconds in TITLE_SECONDS)
    first: list[FilmShot] = []
    while not first or first[-1].stop < min(frames, len(motion)):
        first.append(next(shots))
    joints = motion.part(0, min(frames, len(motion))).joint_positions().astype(np.float64)
    place, clear = title_place((words[0], words[1]), size, first, joints)
    return place, max(least, clear), chain(first, shots)
