"""A story as film.mp4: shots of the body acting it out, its title at the beginning, its told words as captions."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from itertools import pairwise, zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.body.cast import PLAIN, Role
from motion_backend.formats.mp4 import write_mp4
from motion_backend.rendering.film_frames import film_frames
from motion_backend.rendering.film_picture import lay_words
from motion_backend.rendering.film_shots import film_shots
from scene_graphs.errors import UserError

if TYPE_CHECKING:
    from motion_backend.motion import Motion
    from motion_backend.rendering.film_picture import Planes
    from planner_service.narration.told import Told
    from planner_service.pipeline import Story
    from scene_graphs.home import Home

SIZE: Final = (1280, 720)
"""Pixels across and down."""
TITLE_SECONDS: Final = 2.5
MAX_LETTERS: Final = 66
"""Of a line of a caption."""
MAX_LINES: Final = 2
TEXT_HEIGHT, TITLE_HEIGHT = 0.042, 0.085
"""Of the picture's height."""
WORDS_END, TITLE_END = 0.94, 0.92
"""Where in the picture's height they end: a title in the middle would hide who is in the first shot."""
SHADE: Final = 0.62
"""How much of a picture's light stays under its words."""
READ: Final = (3.0, 2.0, 7.0)
"""Seconds that words are shown at least and at most, and besides those that their letters ask for."""
LETTERS: Final = 10.0
"""Read in a second."""
DONE: Final = 2.5
"""Seconds after which what a keyframe does is being done, at most: until then one sits down to it."""
SHORTEST: Final = 1.5
"""Seconds between two that follow each other."""
SENTENCE: Final = re.compile(r"[^.!?…]+[.!?…]*[\"”’']*\s*")


class FilmUnavailableError(UserError):
    """No film can be written here; says what is missing."""


def check_film() -> None:
    """FilmUnavailableError where the library that writes films is not installed; nothing is loaded."""
    if find_spec("av") is None:
        raise FilmUnavailableError(
            "writing film.mp4 needs a library that is not installed", 'pip install "sims-stories[video]"', at="--film"
        )


@dataclass(frozen=True)
class Subtitle:
    """Words that are shown from frame start to stop (exclusive)."""

    start: int
    stop: int
    text: str


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
        return Filmed(story.planned.home, story.motion, story.planned.told, story.segments, story.role)


def write_film(
    filmed: Filmed, path: Path, size: tuple[int, int] = SIZE, show: Callable[[float], None] = lambda _: None
) -> Path:
    """Film a story; `show` is told which share is done, and what it raises ends the film. FilmUnavailableError."""
    check_film()
    motion, told = filmed.motion, filmed.told
    shots = film_shots(filmed.home, motion, [start for start, _ in filmed.segments], size[0] / size[1], filmed.role)
    title = _lettered(told.title, size, TITLE_HEIGHT)
    titled = round(TITLE_SECONDS * motion.fps) if told.title else 0
    lines = subtitles(told, filmed.segments, motion.fps, titled)
    words = [(line, _lettered(line.text, size, TEXT_HEIGHT)) for line in lines]

    def dressed(frame: int, picture: Planes) -> Planes:
        for line, letters in words:
            if line.start <= frame < line.stop:
                lay_words(picture, letters, WORDS_END, SHADE)
        if frame < titled:
            lay_words(picture, title, TITLE_END, SHADE)
        return picture

    def counted() -> Iterator[Planes]:
        for number, picture in enumerate(film_frames(motion, shots, size, dressed, filmed.role)):
            show(number / len(motion))
            yield picture

    return write_mp4(counted(), path, motion.fps)


def subtitles(told: Told, segments: Sequence[tuple[int, int]], fps: int, titled: int = 0) -> list[Subtitle]:
    """The told words, each half of its reading time before its last keyframe is being done, none before frame `titled`.

    What tells no keyframe is shown with what follows, and what is done at nearly the same time together. `segments` are
    frames of keyframes.
    """
    begun: list[_Line] = []
    waiting = ""
    for text, keyframes in _in_time(_pieces(told)):
        waiting += text
        if not keyframes:
            continue
        start, (last, end) = max(segments[min(keyframes)][0], titled), segments[max(keyframes)]
        aim = last + min((end - last) // 2, round(DONE * fps))
        if begun and start - begun[-1].start < SHORTEST * fps:
            begun[-1] = _Line(begun[-1].start, aim, begun[-1].text + waiting)
        else:
            begun.append(_Line(start, aim, waiting))
        waiting = ""
    if waiting and begun:
        begun[-1] = replace(begun[-1], text=begun[-1].text + waiting)
    starts = [max(line.start, line.aim - round(line.seconds / 2 * fps)) for line in begun]
    return [
        Subtitle(page.start, min(page.stop, page.start + round(_read(page.text) * fps)), page.text)
        for line, start, stop in zip(begun, starts, [*starts[1:], segments[-1][1]], strict=False)
        if stop > start
        for page in _pages(start, stop, line.text)
    ]


@dataclass(frozen=True)
class _Line:
    """Words, the frame where what they tell begins, and that where the last of it does."""

    start: int
    aim: int
    text: str

    @property
    def seconds(self) -> float:
        """That all of its pages are read in."""
        return sum(_read(page.text) for page in _pages(0, 0, self.text))


def _in_time(pieces: Iterable[tuple[str, list[int]]]) -> list[tuple[str, list[int]]]:
    """Pieces of which each tells what is done after the piece before: those told in another order are one."""
    found: list[tuple[str, list[int]]] = []
    for text, keyframes in pieces:
        while keyframes and any(found_of and max(found_of) > min(keyframes) for _, found_of in found):
            before, earlier = found.pop()
            text, keyframes = before + text, [*earlier, *keyframes]
        found.append((text, keyframes))
    return found


def _pieces(told: Told) -> Iterator[tuple[str, list[int]]]:
    """The told text sentence by sentence, and in one that tells of several keyframes what tells of each; with these."""
    for sentence in SENTENCE.finditer(told.text):
        spans = [span for span in told.spans if sentence.start() <= span.start < sentence.end()]
        start = sentence.start()
        for span, following in zip_longest(spans, spans[1:]):
            stop = sentence.end()
            if following is not None:
                # A comma stays with what is before it, an "and" goes with what follows.
                stop = max(told.text.find(" ", span.end, following.start), span.end)
            yield told.text[start:stop], list(span.keyframes)
            start = stop
        if not spans:
            yield sentence.group(), []


def _read(text: str) -> float:
    """Seconds in which words are read at ease, once more where one looked away."""
    return min(max(READ[0], READ[1] + len(text) / LETTERS), READ[2])


def _pages(start: int, stop: int, text: str) -> Iterator[Subtitle]:
    """Words that do not fit into one picture follow each other, each for as long as its letters ask."""
    lines = textwrap.wrap(" ".join(text.split()), MAX_LETTERS)
    pages = ["\n".join(lines[i : i + MAX_LINES]) for i in range(0, len(lines), MAX_LINES)]
    letters = np.cumsum([0, *map(len, pages)])
    cuts = (start + (stop - start) * letters / max(letters[-1], 1)).round().astype(int).tolist()
    return (Subtitle(*cut, page) for cut, page in zip(pairwise(cuts), pages, strict=True))


def _lettered(text: str, size: tuple[int, int], share: float) -> NDArray[np.float32]:
    """White words as how much of each pixel they cover, cut to what they fill. (h, w)."""
    from matplotlib import font_manager
    from PIL import Image as Pictures
    from PIL import ImageDraw, ImageFont

    font = ImageFont.truetype(font_manager.findfont("DejaVu Sans"), round(share * size[1]))
    page = Pictures.new("L", size)
    ImageDraw.Draw(page).multiline_text((size[0] / 2, size[1] / 2), text, 255, font, anchor="mm", align="center")
    box = page.getbbox() or (0, 0, 1, 1)
    pad = round(0.3 * share * size[1])
    low, high = (max(box[0] - 2 * pad, 0), max(box[1] - pad, 0)), (box[2] + 2 * pad, box[3] + pad)
    cover = np.asarray(page.crop((*low, *high)), dtype=np.float32)
    return cover / np.float32(255)
