"""A story as film.mp4: shots of the body acting it out, its title at the beginning, its told words as captions.

Frames are numbered as the motion's are; what the film leaves out of it has none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from importlib.util import find_spec
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from motion_backend.body.cast import PLAIN, Role
from motion_backend.formats.mp4 import write_mp4
from motion_backend.motion import Skill
from motion_backend.rendering.film_edit import FilmEdit, last_deed
from motion_backend.rendering.film_frames import film_frames
from motion_backend.rendering.film_picture import lay_words
from motion_backend.rendering.film_shots import FilmShot, film_shots
from motion_backend.rendering.title_place import Place, title_place
from planner_service.grounding.keyframes_to_actions import stays
from planner_service.output.film_deeds import deeds
from planner_service.output.film_letters import lettered, titled
from planner_service.output.film_pages import Subtitle, subtitles
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
TEXT_HEIGHT, TITLE_HEIGHT, LEGEND_HEIGHT = 0.042, 0.085, 0.028
"""Of the picture's height."""
WORDS_END, LEGEND_ENDS = 0.94, 0.985
"""Where in the picture's height told words end, and what their slanted letters mean."""
LEGEND: Final = ("in italics", ": told, not seen")
"""Slanted and upright: under the first words of which some are slanted."""
SHADE: Final = 0.42
"""How much of a picture's light stays under its words: white letters are 4.5 times as bright as a white wall there
(WCAG 2.2, contrast), whatever is behind them."""


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

    @cached_property
    def words(self) -> list[Subtitle]:
        """The told words, by frames of the motion."""
        titled = round(FIRST_WORDS * self.motion.fps) if self.told.title.strip() else 0
        own = deeds(self.told, self.motion, self.segments, self.role)
        return subtitles(self.told, self.segments, self.motion.fps, titled, own)

    @cached_property
    def edit(self) -> FilmEdit:
        """What the film shows of the motion."""
        title = [(0, round(TITLE_SECONDS[1] * self.motion.fps))] if self.told.title.strip() else []
        told = [*title, *((line.start, line.stop) for line in self.words)]
        return FilmEdit.of(self.motion, told, self._ends)

    @cached_property
    def _ends(self) -> int:
        """The frame at which it leaves the motion: on its last deed, as soon as its words were read; at its end where
        that is to sleep or to wait."""
        last = len(self.segments) - 1
        skill, caption = self.role.captions.get(last, (None, ""))
        if last < 0 or last in self.role.asleep or (skill is Skill.LOCO and stays(caption)):
            return len(self.motion)
        read = max((line.read(self.motion.fps) for line in self.words), default=0)
        return max(read, last_deed(self.motion, self.segments[last][0]))

    def edited_to_dict(self) -> dict[str, Any]:
        """How long the film is, and from where to where it leaves the motion out (seconds of the motion)."""
        fps = self.motion.fps
        gaps = [{"start": round(start / fps, 3), "stop": round(stop / fps, 3)} for start, stop in self.edit.left_out]
        return {"seconds": round(len(self.edit) / fps, 3), "left_out": gaps}


@dataclass(frozen=True)
class FilmPlan:
    """A film before it is drawn."""

    shots: Iterator[FilmShot]
    """Each is chosen when it is asked for."""
    dressed: Callable[[int, Planes], Planes]
    """Lays the title and the told words of a frame of the motion onto its picture."""


def film_plan(filmed: Filmed, size: tuple[int, int] = SIZE) -> FilmPlan:
    """The shots and words of a story's film, for pictures of that size."""
    motion = filmed.motion
    starts = [start for start, _ in filmed.segments]
    shots = film_shots(filmed.home, motion, starts, size[0] / size[1], filmed.role, filmed.edit)
    title = titled(filmed.told.title, size, TITLE_HEIGHT)
    across, bottom, untitled = 0.0, 0.0, 0
    if title is not None:
        place, untitled, shots = _placed(title.shape, size, shots, motion)
        across, bottom = place.across, place.box((title.shape[0], title.shape[1]), size)[3] / size[1]
    words = [(line, WORDS_END, lettered(line.lines, size, TEXT_HEIGHT)) for line in filmed.words]
    legend = [(letter, slanted) for part, slanted in zip(LEGEND, (True, False), strict=True) for letter in part]
    first = [line for line in filmed.words if line.slanted][:1]
    words += [(line, LEGEND_ENDS, lettered([legend], size, LEGEND_HEIGHT)) for line in first]

    def dressed(frame: int, picture: Planes) -> Planes:
        for line, end, letters in words:
            if letters is not None and line.start <= frame < line.stop:
                lay_words(picture, letters, end, SHADE)
        if title is not None and frame < untitled:
            lay_words(picture, title, bottom, SHADE, across)
        return picture

    return FilmPlan(shots, dressed)


def write_film(
    filmed: Filmed, path: Path, size: tuple[int, int] = SIZE, show: Callable[[float], None] = lambda _: None
) -> Path:
    """Film a story; `show` is told which share is done, and what it raises ends the film. FilmUnavailableError."""
    check_film()
    plan, motion = film_plan(filmed, size), filmed.motion

    def counted() -> Iterator[Planes]:
        for number, picture in enumerate(film_frames(motion, plan.shots, size, plan.dressed, filmed.role)):
            show(number / len(filmed.edit))
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
