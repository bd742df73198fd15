"""Shots to scenes: cut where the picture changes for good and nobody is speaking."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from typing import Final

import numpy as np

from planner_service.extraction.album import FIRST, Album
from planner_service.extraction.film import Film
from planner_service.extraction.shots import Progress, Shot, shots_of
from planner_service.extraction.subtitles import Cue

MAX_SCENES: Final = 60
"""Scenes of a film: a question to a model each, so that a longer film has longer ones."""
MAX_FRAMES: Final = 24
"""Frames that show a scene, one a second at most."""
MIN_SCENE_SECONDS: Final = 6.0
MAX_SCENE_SECONDS: Final = 60.0
"""Seconds of a scene, where the film is not longer than `MAX_SCENES` of them."""
_NEW: Final = 0.3
"""From where on a boundary between two shots is one between scenes."""
_QUIET: Final = 2.0
"""Seconds without speech that part scenes."""
_BACK: Final = 3
"""Shots that are looked back and ahead: two who talk are shown in turn."""


@dataclass(frozen=True)
class Scene:
    """Shots that belong together, what is said in them, and when to look (seconds)."""

    number: int
    """From 1."""
    start: float
    end: float
    shots: tuple[Shot, ...]
    cues: tuple[Cue, ...]
    times: tuple[float, ...]
    """When the frames are taken that show it."""


def scenes_of(
    film: Film, cues: Sequence[Cue], progress: Progress | None = None, album: Album | None = None
) -> list[Scene]:
    """The scenes of a film in order; together they are all of it. Reads the film once, fills the album. FilmError."""
    return scenes_in(shots_of(film, progress, album), cues)


def scenes_in(shots: Sequence[Shot], cues: Sequence[Cue]) -> list[Scene]:
    """The scenes that shots make: at most `MAX_SCENES`, which leave nothing out."""
    end = shots[-1].end
    longest = max(MAX_SCENE_SECONDS, ceil(2 * end / MAX_SCENES))
    bounds = [shots[0].start]
    for index, shot in enumerate(shots):
        if index and _ends(shots, index, cues, shot.start - bounds[-1], longest):
            bounds.append(shot.start)
        while shot.end - bounds[-1] > longest:
            bounds.append(_inside(shot, bounds[-1], longest))
    if len(bounds) > 1 and end - bounds[-1] < MIN_SCENE_SECONDS:
        bounds.pop()
    while len(bounds) > MAX_SCENES:
        lengths = [after - before for before, after in zip(bounds, [*bounds[2:], end], strict=False)]
        bounds.pop(1 + int(np.argmin(np.round(lengths, 4))))
    return [
        _scene(number, start, stop, shots, cues)
        for number, (start, stop) in enumerate(zip(bounds, [*bounds[1:], end], strict=True), 1)
    ]


def _ends(shots: Sequence[Shot], index: int, cues: Sequence[Cue], length: float, longest: float) -> bool:
    """Whether a scene ends before the shot `index`, `length` seconds after it began."""
    if length < MIN_SCENE_SECONDS:
        return False
    shot = shots[index]
    if shot.end - shot.start + length > longest:
        return True
    before, after = shots[max(0, index - _BACK) : index], shots[index : index + _BACK]
    unlike = min(_unlike(one, other) for one in before for other in after)
    spoken = any(cue.start < shot.start < cue.end for cue in cues)
    near = any(cue.start - _QUIET < shot.start < cue.end + _QUIET for cue in cues)
    return round(unlike - (0.4 if spoken else 0.1 if near else 0.0), 4) >= _NEW


def _unlike(one: Shot, other: Shot) -> float:
    """How far the brightness and colours of two shots are apart, from 0 to 1."""
    return float(np.abs(np.subtract(one.look, other.look)).sum() / (2 * 3 * 255))


def _inside(shot: Shot, begun: float, longest: float) -> float:
    """Where a scene ends within a shot that is too long for it: parts of it are as long as each other."""
    parts = ceil((shot.end - begun) / longest)
    return round(begun + (shot.end - begun) / parts, 3)


def _scene(number: int, start: float, end: float, shots: Sequence[Shot], cues: Sequence[Cue]) -> Scene:
    return Scene(
        number,
        start,
        end,
        tuple(shot for shot in shots if shot.start < end and shot.end > start),
        tuple(cue for cue in cues if start <= (cue.start + cue.end) / 2 < end),
        _times(start, end),
    )


def _times(start: float, end: float) -> tuple[float, ...]:
    """Moments of a scene as far from each other as can be, of those that an album holds; its middle if it is short."""
    first, last = ceil(start - FIRST), ceil(end - FIRST)
    seconds = range(first, last)
    count = min(MAX_FRAMES, len(seconds))
    times = tuple(FIRST + seconds[(2 * index + 1) * len(seconds) // (2 * count)] for index in range(count))
    return times or (round((start + end) / 2, 3),)
