"""What a film leaves out of a motion: the middle of walks under which nothing is told, cut where one stride goes over
into another, and its end where nothing is done any more. The motion itself stays whole.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Final

import numpy as np

from motion_backend.motion import Motion, PhaseKind
from motion_backend.rendering.rasterizer import Ints
from motion_backend.rotations import Array

Frames = tuple[int, int]
"""First and stop frame (exclusive)."""
SETS_OFF, ARRIVES = 1.7, 1.5
"""Seconds of a walk that are seen at its beginning and at its end."""
AFTER_WORDS: Final = 0.5
"""Seconds between the last words and a cut: they are not torn off."""
WORTH: Final = 1.0
"""Seconds from which on it is worth a cut."""
FITS: Final = 0.3
"""Seconds by which the cut is moved at either end, so that the legs after it stand as they did before."""
ENDS: Final = 1.5
"""Seconds for which who does no more is seen at the end."""
STIRS: Final = 0.35
"""Metres a second of the fastest joint from which on something is done: who only breathes and shifts is slower."""
LEGS: Final = slice(1, 9)
"""The joints whose turns tell where in a stride a body is: hips, knees, ankles, and the spine between."""


@dataclass(frozen=True)
class FilmEdit:
    """The frames of a motion that its film keeps."""

    kept: tuple[Frames, ...]
    """In order; none is empty."""
    frames: int = 0
    """Of the whole motion, if its end is not kept."""

    @staticmethod
    def whole(frames: int) -> FilmEdit:
        """One that leaves nothing out."""
        return FilmEdit(((0, frames),) if frames else ())

    @staticmethod
    def of(motion: Motion, told: Sequence[Frames], ends: int | None = None) -> FilmEdit:
        """The edit of a motion during which words are shown in these frames, in order: no walk goes on for long
        without any, and nothing is kept from frame `ends` on."""
        last = len(motion) if ends is None else min(ends, len(motion))
        gaps = [gap for gap in _left_out(motion, told) if gap[1] < last]
        edges = [0, *(edge for gap in gaps for edge in gap), last]
        kept = ((start, stop) for start, stop in zip(edges[::2], edges[1::2], strict=True) if stop > start)
        return FilmEdit(tuple(kept), len(motion))

    def __len__(self) -> int:
        """Frames of the film."""
        return sum(stop - start for start, stop in self.kept)

    @cached_property
    def left_out(self) -> tuple[Frames, ...]:
        """The frames of the motion between two cuts, and at its end, that are in no picture."""
        return tuple((one[1], other[0]) for one, other in pairwise([*self.kept, (self.frames, self.frames)])
                     if other[0] > one[1])  # fmt: skip

    def frame(self, frame: int) -> int:
        """The film's frame that shows one of the motion, or what follows where that is left out."""
        return sum(min(max(frame - start, 0), stop - start) for start, stop in self.kept)


def last_deed(motion: Motion, since: int) -> int:
    """The frame at which a film leaves who does no more: a little after the last one, not before `since`, in which a
    joint moves fast."""
    joints = motion.part(since, len(motion)).joint_positions().astype(np.float64)
    fastest = motion.fps * np.linalg.norm(np.diff(joints, axis=0), axis=-1).max(axis=1, initial=0.0)
    stirs = np.flatnonzero(fastest > STIRS)
    done = since + (int(stirs[-1]) + 1 if len(stirs) else 0)
    return min(done + round(ENDS * motion.fps), len(motion))


def _left_out(motion: Motion, told: Sequence[Frames]) -> Iterator[Frames]:
    leave, arrive, after, worth, fits = (
        round(seconds * motion.fps) for seconds in (SETS_OFF, ARRIVES, AFTER_WORDS, WORTH, FITS)
    )
    for start, stop in _walks(motion):
        for first, last in _untold(start, stop, told, after):
            # What words leave of a walk is cut up to its ends, and never nearer to another cut than that.
            gap = max(first, start + leave), min(last, stop - arrive)
            if gap[1] - gap[0] >= worth:
                yield _fitted(motion, gap, fits)


def _walks(motion: Motion) -> Iterator[Frames]:
    """Frames in which a body walks without stopping, over the ends of keyframes too."""
    walks = sorted((one.start, one.stop) for one in motion.phases if one.kind is PhaseKind.WALK)
    joined: list[Frames] = []
    for start, stop in walks:
        if joined and start <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(joined[-1][1], stop))
        else:
            joined.append((start, stop))
    yield from joined


def _untold(start: int, stop: int, told: Sequence[Frames], after: int) -> Iterator[Frames]:
    """The parts of some frames in which no words are shown, nor were so many frames before."""
    at = start
    for first, last in told:
        if first > at and first < stop:
            yield at, first
        at = max(at, last + after) if first < stop else at
    if at < stop:
        yield at, stop


def _fitted(motion: Motion, gap: Frames, fits: int) -> Frames:
    """A gap made a little shorter, so that the legs after it are as they were before it."""
    slack = min(fits, (gap[1] - gap[0]) // 4)
    ends = np.arange(gap[0], gap[0] + slack + 1), np.arange(gap[1] - slack, gap[1] + 1)
    before, after = (_stride(motion, frames) for frames in ends)
    away = np.linalg.norm(before[:, None] - after[None], axis=-1)  # (before, after)
    one, other = np.unravel_index(int(away.argmin()), away.shape)
    return int(ends[0][one]), int(ends[1][other])


def _stride(motion: Motion, frames: Ints) -> Array:
    """How the legs stand, from a camera that goes along. (frames, 32)."""
    turns = motion.local_rotations[np.clip(frames, 0, len(motion) - 1), LEGS].astype(np.float64)
    return np.asarray((turns * np.sign(turns[..., 3:] + 1e-12)).reshape(len(frames), -1))
