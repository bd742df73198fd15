"""The told words of a film: when each part of a story is shown, what of it is slanted, and where it is parted."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise, zip_longest
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from planner_service.narration.told import Told
    from planner_service.output.film_letters import Letter

MAX_LETTERS: Final = 66
"""Of a line of a caption."""
MAX_LINES: Final = 2
READ: Final = (3.0, 2.0, 7.0)
"""Seconds that words are shown at least and at most, and besides those that their letters ask for."""
LETTERS: Final = 10.0
"""Read in a second."""
DONE: Final = 1.5
"""Seconds after which what a keyframe does is being done, at most: until then one sits down to it."""
STAYS: Final = 5.0
"""Seconds that words stand while what they tell is being done, though they were read before."""
APART: Final = 3.0
"""Seconds between two deeds of one clause from which on it is parted between them."""
SHORTEST: Final = 1.5
"""Seconds between two that follow each other."""
FASTEST: Final = 16.0
"""Letters a second at most, with signs and gaps, at which words are read that others follow soon."""
QUICK: Final = 0.7
"""Share of their reading time that words are shown at least, though what they tell is over."""
SENTENCE: Final = re.compile(r"[^.!?…]+[.!?…]*[\"”’')\]]*\s*")
JOINT: Final = re.compile(r"(?<=[,;:–—])\s+|\s+(?=(?:and|but|then|so|while|until|before|after|because|when)\b)")
"""Where a sentence may be parted: what stands before and after can be read by itself."""
GAP: Final = re.compile(r"\s+")
GOES_ON: Final = "…"
"""At the end of words that the next ones go on."""
_OPEN: Final = " ,;:–—"


@dataclass(frozen=True)
class Subtitle:
    """Words that are shown from frame start to stop (exclusive)."""

    start: int
    stop: int
    text: str
    slanted: tuple[tuple[int, int], ...] = ()
    """First and stop letter of what is told and not seen."""

    def read(self, fps: int) -> int:
        """The frame at which they were read."""
        return self.start + round(_read(self) * fps)

    @property
    def lines(self) -> list[list[Letter]]:
        """Letter by letter, and whether each is slanted."""
        lines: list[list[Letter]] = [[]]
        for at, letter in enumerate(self.text):
            if letter == "\n":
                lines.append([])
            else:
                lines[-1].append((letter, any(start <= at < stop for start, stop in self.slanted)))
        return lines


@dataclass(frozen=True)
class _Piece:
    """Letters of a told text from start to stop (exclusive), and the keyframes they tell."""

    start: int
    stop: int
    keyframes: tuple[int, ...]

    def joined(self, other: _Piece) -> _Piece:
        """Both, which follow each other."""
        return _Piece(self.start, other.stop, (*self.keyframes, *other.keyframes))


@dataclass(frozen=True)
class _Line:
    """A piece, the frame where what it tells begins, that where the last of it is being done, that where it is over,
    and its pages."""

    piece: _Piece
    begins: int
    aim: int
    over: int
    pages: tuple[_Page, ...]

    def start(self, fps: int) -> int:
        """The frame at which half of its reading time is left until it is being done, all until it is over."""
        read = round(sum(map(_read, self.pages)) * fps)
        return max(self.begins, min(self.aim - read // 2, self.over - read))

    def needs(self, fps: int) -> int:
        """Frames in which its words can just be read."""
        return sum(round(max(SHORTEST, len(page.text) / FASTEST) * fps) + 1 for page in self.pages)

    def stop(self, fps: int) -> int:
        """The frame at which what it tells is over, as soon as its words could be read quickly."""
        return max(self.over, self.start(fps) + round(QUICK * sum(map(_read, self.pages)) * fps))


@dataclass(frozen=True)
class _Page:
    """Words that are shown together, and which of their letters are slanted."""

    text: str
    slanted: tuple[tuple[int, int], ...]


def subtitles(
    told: Told,
    segments: Sequence[tuple[int, int]],
    fps: int,
    titled: int = 0,
    deeds: Sequence[int] = (),
) -> list[Subtitle]:
    """The told words, each half of its reading time before its last keyframe is being done, and no longer than until
    that is over if they can be read by then; none before frame `titled`, nor before what they tell, whose first frames
    `deeds` may name by keyframe, unless they could not be read then.

    What tells no keyframe is shown with what follows, and what is done at nearly the same time together. What is told
    and not seen is slanted; whole sentences of it that would stand alone are left out. `segments` are frames of
    keyframes.
    """
    ways = (
        [(max(start, deed), stop) for (start, stop), deed in zip(segments, deeds, strict=True)] if deeds else segments
    )
    lines = _lines(told, ways, fps, titled)
    end = max((stop for _, stop in segments), default=0)
    starts = _legible(lines, fps, titled, end)
    shown: list[Subtitle] = []
    for line, start, latest in zip(lines, starts, [*starts[1:], end], strict=False):
        stop = min(latest, max(line.stop(fps), start + line.needs(fps)))
        letters = list(accumulate((len(page.text) for page in line.pages), initial=0))
        cuts = [start + round((stop - start) * part / max(letters[-1], 1)) for part in letters]
        shown += [
            Subtitle(begin, min(end, begin + round(max(_read(page), STAYS) * fps)), page.text, page.slanted)
            for page, (begin, end) in zip(line.pages, pairwise(cuts), strict=True)
            if end > begin
        ]
    return shown


def _legible(lines: Sequence[_Line], fps: int, titled: int, end: int) -> list[int]:
    """When lines are shown: earlier than they would be where the next ones, or the end, leave no time to read them."""
    starts: list[int] = []
    for line in reversed(lines):
        end = min(line.start(fps), end - line.needs(fps))
        starts.insert(0, end)
    before = titled
    for at, line in enumerate(lines):
        starts[at] = max(starts[at], before)
        before = starts[at] + line.needs(fps) if at + 1 < len(lines) else before
    return starts


def _lines(told: Told, segments: Sequence[tuple[int, int]], fps: int, titled: int) -> list[_Line]:
    """The pieces of a story with their times: of two that would be shown at nearly the same time one is made."""

    def line_of(piece: _Piece) -> _Line:
        begins, (last, end) = max(segments[min(piece.keyframes)][0], titled), segments[max(piece.keyframes)]
        aim = last + min((end - last) // 2, round(DONE * fps))
        return _Line(piece, begins, aim, end, tuple(_pages(told, piece)))

    lines: list[_Line] = []
    begins = [start for start, _ in segments]
    for piece in _in_time(_with_following(_pieces(told, begins, round(APART * fps)))):
        lines.append(line_of(piece))
        while len(lines) > 1 and lines[-1].start(fps) - lines[-2].start(fps) < SHORTEST * fps:
            one, other = lines[-2:]
            whole = one.piece.joined(other.piece)
            lines[-2:] = [replace(line_of(whole), begins=min(one.begins, other.begins))]
    return [line for line in lines if line.pages]


def _with_following(pieces: Iterable[_Piece]) -> Iterator[_Piece]:
    """Pieces that tell no keyframes made one with what follows, the last with what is before."""
    kept: _Piece | None = None
    waiting: _Piece | None = None
    for piece in pieces:
        whole = piece if waiting is None else waiting.joined(piece)
        if not whole.keyframes:
            waiting = whole
            continue
        if kept is not None:
            yield kept
        kept, waiting = whole, None
    if kept is not None:
        yield kept if waiting is None else kept.joined(waiting)


def _in_time(pieces: Iterable[_Piece]) -> list[_Piece]:
    """Pieces in the order in which what they tell is done, whichever is told first."""
    return sorted(pieces, key=lambda piece: min(piece.keyframes))


def _pieces(told: Told, begins: Sequence[int], apart: int) -> Iterator[_Piece]:
    """The told text sentence by sentence, and one that tells of several keyframes in parts, wherever a clause of it
    ends between two of them, or words do of which the deeds begin so many frames apart."""
    for sentence in SENTENCE.finditer(told.text):
        spans = [span for span in told.spans if sentence.start() <= span.start < sentence.end()]
        start, keyframes = sentence.start(), list[int]()
        for span, following in zip_longest(spans, spans[1:]):
            keyframes += span.keyframes
            if following is None:
                continue
            # What is said between two deeds leads to the second: "wrote to her, | and while he waited, ate".
            joint = JOINT.search(told.text, span.end - 1, following.start + len("because"))
            if (joint is None or joint.start() > following.start) and keyframes and following.keyframes:
                waits = begins[min(following.keyframes)] - begins[max(keyframes)]
                joint = GAP.search(told.text, span.end - 1) if waits >= apart else None
            if joint is not None and joint.start() <= following.start:
                yield _Piece(start, joint.start(), tuple(keyframes))
                start, keyframes = joint.start(), []
        yield _Piece(start, sentence.end(), tuple(keyframes))


def _pages(told: Told, piece: _Piece) -> Iterator[_Page]:
    """The words of a piece, as many at a time as fit into one picture, without whole sentences of what is not seen, nor
    something that stands for it."""
    thought = [False] * len(told.text)
    for span in told.thoughts:
        thought[span.start : span.end] = [True] * (span.end - span.start)
    for start, stop in _fitting(told.text, piece):
        words = told.text[start:stop]
        seen = [not thought[start + at] for at, letter in enumerate(words) if letter.isalnum()]
        played = any(span.start < stop and start < span.end for span in told.spans)
        if seen and (played or any(seen) or not _is_whole(told.text, start, stop)):
            yield _page(told.text, start, stop, thought)


def _fitting(text: str, piece: _Piece) -> Iterator[tuple[int, int]]:
    """From where to where the letters of a piece are shown together: whole sentences, else clauses, else what fits."""
    start = piece.start
    while len(_wrapped(text[start : piece.stop])) > MAX_LINES:
        words = [one.end() for one in re.finditer(r"\S+", text[start : piece.stop])]
        most = next(end for end, more in pairwise(words) if len(_wrapped(text[start : start + more])) > MAX_LINES)
        ends = [one.end() for one in SENTENCE.finditer(text, start, start + most + 1)]
        ends = [end for end in ends if re.search(r"[.!?…][\"”’')\]]*\s*$", text[start:end])]
        joints = [one.start() for one in JOINT.finditer(text, start + most // 3, start + most + 1)]
        stop = max(ends, default=0) or max(joints, default=0) or start + most
        yield start, stop
        start = stop
    yield start, piece.stop


def _is_whole(text: str, start: int, stop: int) -> bool:
    """Whether words begin and end with sentences."""
    before, own = text[:start].rstrip(" \n\"“‘'(["), text[start:stop].rstrip(" \n\"”’')]")
    return (not before or before[-1] in ".!?…") and own[-1:] in tuple(".!?…")


def _page(text: str, start: int, stop: int, thought: Sequence[bool]) -> _Page:
    """Letters of a text on lines; with a sign that they go on where the sentence does."""
    letters = " ".join(text[start:stop].split())
    if not re.search(r"[.!?…][\"”’')\]]*$", letters) and text[stop:].strip():
        letters = letters.rstrip(_OPEN) + GOES_ON
    shown = "\n".join(_wrapped(letters))
    marks = iter([thought[at] for at in range(start, stop) if not text[at].isspace()])
    slanted: list[bool] = []
    for letter in shown:
        follows = slanted[-1] if slanted else False
        slanted.append(follows if letter.isspace() or letter == GOES_ON else next(marks, follows))
    edges = [at for at, (one, other) in enumerate(pairwise([False, *slanted, False])) if one != other]
    return _Page(shown, tuple(zip(edges[::2], edges[1::2], strict=True)))


def _wrapped(text: str) -> list[str]:
    return textwrap.wrap(" ".join(text.split()), MAX_LETTERS, break_on_hyphens=False)


def _read(page: _Page | Subtitle) -> float:
    """Seconds in which words are read at ease, once more where one looked away."""
    return min(max(READ[0], READ[1] + len(page.text) / LETTERS), READ[2])
