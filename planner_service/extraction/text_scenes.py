"""Scenes of a text: of a screenplay by its sluglines, of a narrative by paragraphs, of subtitles by pauses."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Final, NamedTuple

from planner_service.extraction.screenplay import is_screenplay, parts_of
from planner_service.extraction.subtitles import Cue
from planner_service.themes.verb_finder import has_verb

PAUSE: Final = 5.0
"""Seconds without a subtitle after which another scene begins."""
_MAX_SCENE_SECONDS: Final = 90.0
"""Seconds of subtitles that are one scene at most."""
_MAX_SENTENCE_LENGTH: Final = 300
"""Letters after which subtitles are no longer joined."""
_RUNS_ON: Final = 2.0
"""Seconds between two subtitles of one sentence."""
_ENOUGH: Final = 12
"""Words of a narrative that are a scene: shorter paragraphs are read together."""
_QUOTED: Final = re.compile(r"“[^“”]{0,2000}”|\"[^\"]{0,2000}\"|«[^«»]{0,2000}»|„[^„“”]{0,2000}[“”]")
_BREAK: Final = re.compile(
    r"^\s*(?:[*#~=_–—-][\s*#~=_–—-]*|(?:chapter|part|scene)\s+[\divxlc]+\b.{0,60}|#+\s.*)$", re.I
)
_UNFINISHED: Final = re.compile(r"[^\W\d_],?\s*$")
"""A line whose sentence goes on."""
_ADDRESSED: Final = re.compile(
    r"\b(?:I|you|we|me|us|my|your|our|mine|yours|let's)\b|\b(?:he|she|it|that|there|they|who|what)['’]\w", re.IGNORECASE
)
_OF_SOMEBODY: Final = re.compile(
    r"^(?:he|she|they|someone|(?:the|an?) (?:\w+ )?(?:man|woman|boy|girl|person|character)|[A-Z][a-z]+)\s+\w", re.ASCII
)


class Line(NamedTuple):
    """Some sentences of a scene."""

    text: str
    spoken: bool = False
    """Whether somebody says it: then it counts for the feeling only."""
    start: float | None = None
    """Seconds, where they are known."""
    end: float | None = None


@dataclass(frozen=True)
class TextScene:
    """What happens in one place, or without a pause."""

    lines: tuple[Line, ...]
    place: str = ""
    """What a slugline says of where."""
    outside: bool = False
    """Whether it plays beyond the home."""

    @property
    def told(self) -> str:
        """What is told of people."""
        return " ".join(line.text for line in self.lines if not line.spoken)

    @property
    def spoken(self) -> str:
        """What people say."""
        return " ".join(line.text for line in self.lines if line.spoken)

    @property
    def start(self) -> float | None:
        """Where in a film it begins (seconds)."""
        return min((line.start for line in self.lines if line.start is not None), default=None)

    @property
    def end(self) -> float | None:
        """Where in a film it ends (seconds)."""
        return max((line.end for line in self.lines if line.end is not None), default=None)


def scenes_of_text(text: str) -> tuple[TextScene, ...]:
    """The scenes of a screenplay or a narrative, in order."""
    return tuple(_played(text) if is_screenplay(text) else _narrated(text))


def scenes_of_cues(cues: Iterable[Cue]) -> tuple[TextScene, ...]:
    """The scenes of subtitles: what they tell of somebody ("She sits down.") is told, all else is speech."""
    scenes: list[list[Line]] = []
    lines = _sentences(sorted(cues, key=lambda cue: (cue.start, cue.end)))
    for line in sorted(lines, key=lambda line: line.start or 0.0):
        last = scenes[-1] if scenes else []
        near = last and (line.start or 0.0) - (last[-1].end or 0.0) < PAUSE
        if near and (line.end or 0.0) - (last[0].start or 0.0) <= _MAX_SCENE_SECONDS:
            last.append(line)
        else:
            scenes.append([line])
    return tuple(TextScene(tuple(lines)) for lines in scenes)


def _sentences(cues: Sequence[Cue]) -> Iterator[Line]:
    """Subtitles with the next ones, where a sentence runs on, and the sounds told in them."""
    text, speaker, start, end = "", None, 0.0, 0.0
    for cue in cues:
        runs_on = not re.search(r"[.!?…\"”]$", text) and cue.start - end < _RUNS_ON and cue.speaker in (None, speaker)
        if text and cue.text and not (runs_on and len(text) < _MAX_SENTENCE_LENGTH):
            yield _line(text, speaker, start, end)
            text = ""
        if cue.text:
            if not text:
                speaker, start = cue.speaker, cue.start
            text, end = f"{text} {' '.join(cue.text.split())}".strip(), cue.end
        for sound in cue.sounds:
            yield _line(sound[:1].upper() + sound[1:], None, cue.start, cue.end)
    if text:
        yield _line(text, speaker, start, end)


def _line(text: str, speaker: str | None, start: float, end: float) -> Line:
    told = not speaker and "?" not in text and not _ADDRESSED.search(text) and _OF_SOMEBODY.match(text)
    return Line(text, not (told and has_verb(text)), start, end)


def _played(text: str) -> Iterator[TextScene]:
    """Scenes of a screenplay."""
    place, outside, lines = "", False, list[Line]()
    for part in parts_of(text):
        if part.kind in ("scene", "outside"):
            if lines:
                yield TextScene(tuple(lines), place, outside)
            place, outside, lines = part.text, part.kind == "outside", []
        else:
            lines.append(Line(part.text, spoken=part.kind == "speech"))
    if lines:
        yield TextScene(tuple(lines), place, outside)


def _narrated(text: str) -> Iterator[TextScene]:
    """Scenes of a narrative: its paragraphs, short ones together."""
    lines: list[Line] = []
    words = 0
    for paragraph in [*_paragraphs(text), None]:
        if (paragraph is None or words >= _ENOUGH) and lines:
            yield TextScene(tuple(lines))
            lines, words = [], 0
        if paragraph is not None:
            lines += _said_and_done(paragraph)
            words += len(paragraph.split())


def _paragraphs(text: str) -> Iterator[str | None]:
    """Paragraphs, and None for a break between them; where nothing shows that lines are wrapped, each is one."""
    lines = text.strip().splitlines()
    wrapped = any(not line.strip() or _UNFINISHED.search(line) for line in lines[:-1])
    for kind, group in groupby(lines, key=lambda line: 0 if not line.strip() else 1 if _BREAK.match(line) else 2):
        block = list(group)
        if kind == 1:
            yield None
        elif kind == 2:
            yield from [" ".join(block)] if wrapped else block


def _said_and_done(paragraph: str) -> list[Line]:
    said = [Line(quoted[0].strip('"“”„«» '), spoken=True) for quoted in _QUOTED.finditer(paragraph)]
    done = " ".join(_QUOTED.sub(" ", paragraph).split())
    return [*said, Line(done)] if re.search(r"[^\W\d_]", done) else said
