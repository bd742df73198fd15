"""Where a film cuts: differences of small histograms, held against what is usual around them.

Shots to scenes: cut where the picture changes for good and nobody is speaking.
"""

from __future__ import annotations

from array import array
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from planner_service.extraction.subtitles import Cue
from planner_service.extraction.video import Film, pictures
from planner_service.extraction.video_frames import FIRST, Album

if TYPE_CHECKING:
    from av import VideoFrame


Floats = NDArray[np.float32]
Progress = Callable[[str, float], None]
"""Told what is done and how much of it, from 0 to 1."""

CUT: Final = 0.1
"""What a cut differs more than `STEEP` times the largest change around it, of 1."""
STEEP: Final = 2.0
"""A cut, or a fade, differs so many times more than any change around it."""
FADE: Final = 0.35
"""The least difference of what is before and after a fade."""
MIN_SHOT_SECONDS: Final = 0.6
"""Seconds of a shot."""
SLOW: Final = 1.5
"""Seconds from a fade to any other cut."""
STEP: Final = 0.25
"""Seconds between the samples in which fades are looked for."""
_AROUND: Final = 6
"""Pictures before and after, that are usual."""
_CELLS: Final = 3
_BINS: Final = 16
_ACROSS: Final = 64
"""Dots of a thumbnail, from left to right."""
_PLANAR: Final = ("yuv420p", "yuvj420p", "yuv422p", "yuvj422p", "yuv444p", "yuvj444p")
_SPANS: Final = (2, 4, 6, 8)
"""Samples from before to after a fade."""
_TOLD: Final = 500
"""Pictures between two words about progress."""


@dataclass(frozen=True)
class Shot:
    """A stretch of film without a cut (seconds)."""

    start: float
    end: float
    look: tuple[int, ...]
    """Its brightness and colours: three histograms of 16 bins, each of sum 255 but for rounding."""


@dataclass(frozen=True)
class _Samples:
    """What is kept of a film's pictures: times, differences, and a few looks a second."""

    times: NDArray[np.float64]
    steps: Floats
    """(T,) difference to the picture before."""
    leaps: Floats
    """(T,) difference to the picture `_AROUND` before."""
    looked: NDArray[np.float64]
    """(S,) when the looks were taken."""
    looks: Floats
    """(S, B)"""


def shots_of(film: Film, progress: Progress | None = None, album: Album | None = None) -> tuple[Shot, ...]:
    """The shots of a film in order, from its first picture to its last; every cut and fade parts two. FilmError.

    An album is filled on the way.
    """
    samples = _sampled(film, progress, album)
    end = float(samples.times[-1]) + 1 / film.rate
    if film.claimed is not None and film.claimed > end + 2:
        film.faults["seconds less than it says it has"] = round(film.claimed - end)
    cuts = _apart(_hard_cuts(samples), [], MIN_SHOT_SECONDS)
    cuts = sorted(_apart(_fades(samples, cuts), cuts, SLOW))
    bounds = [0.0, *(cut for cut in cuts if MIN_SHOT_SECONDS <= cut <= end - MIN_SHOT_SECONDS), end]
    return tuple(_shot(samples, start, stop) for start, stop in pairwise(bounds))


def look_of(picture: VideoFrame) -> Floats:
    """(B,) histograms of brightness in 3 × 3 cells, then of the two colours, each of sum 1, smoothed over bins."""
    if picture.format.name not in _PLANAR:
        picture = picture.reformat(2 * _ACROSS, 2 * _ACROSS, "yuv420p", interpolation="FAST_BILINEAR")
    luma, *chroma = (_dots(picture, index) for index in range(3))
    rows, columns = (np.arange(side) * _CELLS // side for side in luma.shape)
    cell = rows[:, None] * _CELLS + columns
    parts = _CELLS**2
    counts = np.bincount((cell * _BINS + luma // _BINS).ravel(), minlength=parts * _BINS).reshape(parts, _BINS)
    hues = [np.bincount((dots // _BINS).ravel(), minlength=_BINS) for dots in chroma]
    histograms = np.vstack([counts, *hues]).astype(np.float32)
    histograms /= np.maximum(histograms.sum(axis=1, keepdims=True), 1)
    padded = np.pad(histograms, ((0, 0), (1, 1)), mode="edge")
    return np.asarray((padded[:, :-2] + 2 * histograms + padded[:, 2:]) / 4, np.float32).ravel()


def difference(one: Floats, other: Floats) -> Floats:
    """How unlike looks are, from 0 to 1: half for brightness, half for colours. Shapes (…, B) to (…)."""
    apart = np.abs(one - other).reshape(*np.shape(one)[:-1], -1, _BINS).sum(axis=-1) / 2
    return np.asarray(apart[..., : _CELLS**2].mean(axis=-1) / 2 + apart[..., _CELLS**2 :].mean(axis=-1) / 2)


def _dots(picture: VideoFrame, index: int) -> NDArray[np.uint8]:
    """A plane of a planar picture, every so many-th dot of it."""
    plane = picture.planes[index]
    step = max(1, plane.width // _ACROSS)
    dots: NDArray[np.uint8] = np.frombuffer(memoryview(plane), np.uint8).reshape(plane.height, plane.line_size)
    return dots[::step, : plane.width : step]


def _sampled(film: Film, progress: Progress | None, album: Album | None) -> _Samples:
    times, steps, leaps, looked = array("d"), array("f"), array("f"), array("d")
    looks: list[Floats] = []
    recent: deque[Floats] = deque(maxlen=_AROUND)
    for time, picture in pictures(film, rough=album is None):
        if album is not None:
            album.see(film, time, picture)
        look = look_of(picture)
        steps.append(float(difference(look, recent[-1])) if recent else 0.0)
        leaps.append(float(difference(look, recent[0])) if recent else 0.0)
        if not looked or time >= looked[-1] + STEP - 1e-6:
            looked.append(time)
            looks.append(look.astype(np.float16))
        times.append(time)
        recent.append(look)
        if progress is not None and len(times) % _TOLD == 0:
            progress("shots", min(0.99, time / film.claimed) if film.claimed else 0.0)
    if progress is not None:
        progress("shots", 1.0)
    return _Samples(
        np.array(times), np.array(steps, np.float32), np.array(leaps, np.float32), np.array(looked), np.array(looks)
    )


def _hard_cuts(samples: _Samples) -> list[tuple[float, float]]:
    """(strength, time) of every picture that begins a shot at once; a flash, after which all is as before, does not."""
    steps, found = samples.steps, []
    for at in map(int, np.flatnonzero(steps >= CUT)):
        around = np.concatenate([steps[max(1, at - _AROUND) : at], steps[at + 1 : at + 1 + _AROUND]])
        later = samples.leaps[min(at + _AROUND - 1, len(steps) - 1)]
        if steps[at] >= STEEP * around.max(initial=0.0) + CUT and later >= CUT:
            found.append((round(float(steps[at]), 4), float(samples.times[at])))
    return found


def _fades(samples: _Samples, cuts: list[float]) -> list[tuple[float, float]]:
    """(strength, time) of slow changes between two stretches that are steadier than the change.

    A change is seen from several places: the middle of those where it is strongest is taken.
    """
    looks, looked = samples.looks.astype(np.float32), samples.looked
    found = []
    for span in _SPANS:
        half = span // 2
        if len(looks) <= span + 2:
            break
        over = difference(looks[:-span], looks[span:])  # (S - span,), centred at + half
        still = np.zeros(len(looks), np.float32)
        still[1:] = difference(looks[:-1], looks[1:])
        for at in map(int, np.flatnonzero(over >= FADE)):
            before, after = still[max(1, at - 1) : at + 1], still[at + span + 1 : at + span + 3]
            sides = max(before.max(initial=0.0), after.max(initial=0.0))
            time = float(looked[at + half])
            clear = all(not looked[at] - STEP <= cut <= looked[at + span] + STEP for cut in cuts)
            if clear and over[at] >= STEEP * sides:
                found.append((round(float(over[at]), 4), time))
    return [(strength, _middle(found, strength, time)) for strength, time in found]


def _middle(found: list[tuple[float, float]], strength: float, time: float) -> float:
    """The middle of the places near a time from which a change is seen as strongly, or nearly."""
    near = [other for much, other in found if abs(other - time) < SLOW and much >= 0.9 * strength]
    return (min(near) + max(near)) / 2


def _apart(found: list[tuple[float, float]], taken: list[float], distance: float) -> list[float]:
    """The strongest first, none nearer to another one than `distance` seconds; `taken` stay."""
    kept = list(taken)
    for _, time in sorted(found, key=lambda one: (-one[0], one[1])):
        if all(abs(time - other) >= distance for other in kept):
            kept.append(time)
    return kept


def _shot(samples: _Samples, start: float, end: float) -> Shot:
    inside = (samples.looked >= start) & (samples.looked < end)
    looks = samples.looks[inside if inside.any() else slice(0, 1)].astype(np.float32)
    mean = looks.mean(axis=0).reshape(-1, _BINS)
    three = np.vstack([mean[: _CELLS**2].mean(axis=0), mean[_CELLS**2 :]])
    return Shot(round(start, 3), round(end, 3), tuple(int(value) for value in np.rint(255 * three.ravel())))


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
