"""Subtitles: SRT, WebVTT and ASS from bytes of any encoding to cues.

The subtitles that a film carries within itself.

What one cue says: words without tags, each part with its speaker, and the sounds apart.
"""

from __future__ import annotations

import html
import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Final

from planner_service.extraction.text_files import decode
from planner_service.extraction.video import Film, text_tracks
from planner_service.extraction.video_container import load_av, opened, said
from scene_graphs.errors import UserError

_TAG: Final = re.compile(r"</?(?![vV][.\s])[a-zA-Z0-9:.][^<>]{0,200}>|<\d[\d:.]{3,15}>|</[a-zA-Z]>")
_VOICE: Final = re.compile(r"<[vV](?:\.[^\s<>]{0,60})?\s+([^<>]{1,60})>")
_OVERRIDE: Final = re.compile(r"\{\\[^{}]{0,500}\}")
_SOUND: Final = re.compile(r"\[([^\[\]]{1,200})\]|\(([^()]{1,200})\)|\*([^*]{1,200})\*")
_MUSIC: Final = re.compile(r"[♪♫#]+")
_NAME: Final = re.compile(r"^([^\W\d_][\w .'’&-]{1,39}):(?=\s|$)\s*")
_DASH: Final = re.compile(r"^[-–—‐]\s*(?=\S)")
_INVISIBLE: Final = re.compile(r"[\u200b-\u200f\u202a-\u202e\u2060-\u2069\ufeff\x00-\x08\x0b-\x1f\x7f]")


@dataclass(frozen=True)
class Part:
    """What one of those who speak in a cue says."""

    text: str
    speaker: str | None
    sounds: tuple[str, ...]


def spoken(text: str) -> Iterator[Part]:
    """The parts of a cue: a new one where a line begins with a dash, a name in capitals or a voice tag."""
    text = _OVERRIDE.sub("", text.replace(r"\N", "\n").replace(r"\n", "\n").replace(r"\h", " "))
    text = _VOICE.sub(lambda voice: f"\n\x02{' '.join(voice[1].split())}\x03", text)
    words: list[str] = []
    sounds: list[str] = []
    speaker: str | None = None
    for line in text.split("\n"):
        heard: list[str] = []
        line, who, begins = _opened(line, heard)
        if begins and (words or sounds):
            yield Part(" ".join(words), speaker, tuple(sounds))
            words, sounds, speaker = [], [], None
        speaker = who or speaker
        sounds += heard
        words += line.split()
    yield Part(" ".join(words), speaker, tuple(sounds))


def _opened(line: str, sounds: list[str]) -> tuple[str, str | None, bool]:
    """A line without tags, sounds, dash and name; who is named; and whether somebody begins to speak."""
    who, begins = None, False
    if line.startswith("\x02"):
        who, _, line = line[1:].partition("\x03")
        begins = True
    line = _INVISIBLE.sub("", html.unescape(_TAG.sub("", line))).strip()
    begins = begins or _DASH.match(line) is not None
    line = _MUSIC.sub(" ", _SOUND.sub(lambda sound: _heard(sound, sounds), _DASH.sub("", line))).strip()
    line = _DASH.sub("", line)
    if (name := _NAME.match(line)) is not None and name[1].isupper():
        line, who, begins = line[name.end() :], name[1].strip(), True
    return line, who, begins


def _heard(sound: re.Match[str], sounds: list[str]) -> str:
    """Keep what is in brackets as a sound."""
    heard = " ".join((sound[1] or sound[2] or sound[3]).split())
    if heard:
        sounds.append(heard)
    return " "


MAX_SUBTITLE_BYTES: Final = 10_000_000
"""Bytes of a subtitle file."""
MAX_CUES: Final = 50_000
MAX_CUE_SECONDS: Final = 24 * 3600.0
"""Seconds; no cue is later."""
_SHOWN: Final = 2.0
"""Seconds that a cue is given whose end is not after its beginning."""
_MAX_CUE_LENGTH: Final = 2000
"""Letters of one cue."""
_TIME: Final = r"(-?)(?:(\d{1,4}):)?(\d{1,3}):(\d{1,2})[.,:](\d{1,3})"
_ARROW: Final = re.compile(rf"^\s*{_TIME}\s*-->\s*{_TIME}")
_ASS_TIME: Final = re.compile(_TIME)
_ASS_FIELDS: Final = ("layer", "start", "end", "style", "name", "marginl", "marginr", "marginv", "effect", "text")
_DRAWING: Final = re.compile(r"\\p[1-9]")
_CONTROL: Final = re.compile(r"[\x00-\x08\x0b\x0e-\x1f]")
_LINES: Final = re.compile(r"\r\n?|\n")


class SubtitleError(UserError):
    """Bytes that are no subtitles we read."""


@dataclass(frozen=True)
class Cue:
    """What is said, by whom, and from when to when (seconds)."""

    start: float
    end: float
    text: str
    """Without tags, names and sounds; empty where only a sound is told."""
    speaker: str | None = None
    sounds: tuple[str, ...] = ()
    """What was in brackets, such as "door slams"."""


@dataclass(frozen=True)
class Subtitles:
    """The cues of a file in the order of time, and how they were read."""

    cues: tuple[Cue, ...]
    form: str
    """srt, vtt or ass."""
    encoding: str
    notes: tuple[str, ...] = ()


@dataclass
class _Faults:
    """How often something was wrong with a cue."""

    seen: dict[str, int] = field(default_factory=dict)

    def count(self, what: str) -> None:
        self.seen[what] = self.seen.get(what, 0) + 1

    @property
    def notes(self) -> tuple[str, ...]:
        return tuple(f"{many} {'cue' if many == 1 else 'cues'} {what}" for what, many in self.seen.items())


def read_subtitles(data: bytes) -> Subtitles:
    """The cues of an SRT, WebVTT or ASS file, whatever it is called. SubtitleError."""
    if len(data) > MAX_SUBTITLE_BYTES:
        raise SubtitleError(
            f"{len(data)} bytes, at most {MAX_SUBTITLE_BYTES} are read", "give those of one film", at="subtitles"
        )
    if not data.strip():
        raise SubtitleError("the file is empty", "give SRT, WebVTT or ASS", at="subtitles")
    decoded = decode(data)
    if len(_CONTROL.findall(decoded.text, 0, 20_000)) > 20:
        raise SubtitleError("these bytes are no text", "give SRT, WebVTT or ASS, best in UTF-8", at="subtitles")
    form = form_of(decoded.text)
    if form is None:
        raise SubtitleError(
            "it is neither SRT nor WebVTT nor ASS", "a cue needs a line of two times with -->", at="subtitles"
        )
    faults = _Faults()
    lines = _LINES.split(decoded.text)
    cues: list[Cue] = []
    for cue in _ass_cues(lines) if form == "ass" else _arrow_cues(lines):
        cues.extend(_tidy(cue, faults))
        if len(cues) > MAX_CUES:
            raise SubtitleError(f"there are more than {MAX_CUES} cues", "give those of one film", at="subtitles")
    if not cues:
        raise SubtitleError("there is no cue with words in it", at="subtitles")
    notes = ([decoded.note] if decoded.note else []) + list(faults.notes)
    return Subtitles(ordered(cues), form, decoded.encoding, tuple(notes))


def form_of(text: str) -> str | None:
    """ "srt", "vtt" or "ass" by what a text holds, None for anything else."""
    if text.lstrip("\ufeff \t\r\n").startswith("WEBVTT"):
        return "vtt"
    if re.search(r"^\s*(Dialogue|Format)\s*:.*,", text, re.MULTILINE) and re.search(r"^\s*\[Events\]", text, re.M):
        return "ass"
    return "srt" if any("-->" in line and _ARROW.match(line) for line in _LINES.split(text)) else None


def ordered(cues: list[Cue]) -> tuple[Cue, ...]:
    """The cues in the order of time, each once."""
    return tuple(sorted(dict.fromkeys(cues), key=lambda cue: (cue.start, cue.end)))


def cues_of(start: float, end: float, text: str, speaker: str | None = None) -> list[Cue]:
    """One cue for each who speaks in a text that may hold tags, names and sounds."""
    return [
        Cue(start, end, part.text, part.speaker or speaker, part.sounds)
        for part in spoken(text[:_MAX_CUE_LENGTH])
        if part.text or part.sounds
    ]


def _tidy(cue: Cue, faults: _Faults) -> list[Cue]:
    """What the cue says, in a time that can be; nothing for a cue before the beginning or without words."""
    if cue.end < 0 or max(cue.start, cue.end) > MAX_CUE_SECONDS:
        faults.count("outside of any film, left out")
        return []
    if cue.start < 0:
        faults.count("with a negative time, moved to the beginning")
        cue = replace(cue, start=0.0)
    if cue.end <= cue.start:
        faults.count(f"that ended before they began, given {_SHOWN:.0f} seconds")
        cue = replace(cue, end=cue.start + _SHOWN)
    if len(cue.text) > _MAX_CUE_LENGTH:
        faults.count(f"of more than {_MAX_CUE_LENGTH} letters, cut")
    return cues_of(round(cue.start, 3), round(cue.end, 3), cue.text, cue.speaker)


def _arrow_cues(lines: list[str]) -> Iterator[Cue]:
    """SRT and WebVTT: a line of two times, and the lines below it up to an empty one."""
    arrows = [at for at, line in enumerate(lines) if "-->" in line and _ARROW.match(line)]
    for at, following in pairwise([*arrows, len(lines)]):
        match = _ARROW.match(lines[at])
        assert match is not None
        text = lines[at + 1 : following]
        if following < len(lines) and text and text[-1].strip().isdecimal():
            text = text[:-1]  # the next cue's number, where the empty line before it is missing
        blank = next((index for index, line in enumerate(text) if not line.strip()), len(text))
        times = match.groups()
        yield Cue(_seconds(times[:5]), _seconds(times[5:]), "\n".join(text[:blank]))


def _ass_cues(lines: list[str]) -> Iterator[Cue]:
    """ASS and SSA: the dialogue lines of the events, by the fields that the format line names."""
    fields, inside = list(_ASS_FIELDS), False
    for line in lines:
        kind, _, rest = line.partition(":")
        kind = kind.strip().lower()
        if line.lstrip().startswith("["):
            inside = line.strip().lower() == "[events]"
        elif inside and kind == "format":
            fields = [name.strip().lower() for name in rest.split(",")[:40]]
        elif inside and kind == "dialogue":
            row = dict(zip(fields, rest.split(",", len(fields) - 1), strict=False))
            start, end = (_ASS_TIME.match(row.get(name, "").strip()) for name in ("start", "end"))
            if start and end and not _DRAWING.search(row.get("text", "")):
                name = " ".join(row.get("name", row.get("actor", "")).split())[:60]
                yield Cue(_seconds(start.groups()), _seconds(end.groups()), row.get("text", ""), name or None)


def _seconds(parts: tuple[str | None, ...]) -> float:
    """Of sign, hours, minutes, seconds and a fraction as it is written."""
    sign, hours, minutes, seconds, fraction = parts
    value = int(hours or 0) * 3600 + int(minutes or 0) * 60 + int(seconds or 0) + float(f"0.{fraction}")
    return -value if sign else value


_COMMAS: Final = 8
"""Before the text in an event as FFmpeg gives it: order, layer, style, name, three margins, effect."""
_LONG: Final = 60.0
"""Seconds that a cue stays at most."""


def embedded_cues(film: Film) -> Subtitles | None:
    """The cues of the film's track of letters, on the clock of its pictures; None where there is none.

    Of several tracks with words the English one is read, else the one that is shown by default. Subtitles that are
    pictures are not read. FilmError.
    """
    with opened(film.source, film.form) as container:
        count = len(text_tracks(container))
    empty: list[str] = []
    for place in range(count):
        cues, language = _read(film, place)
        if cues:
            without = f"; nothing in: {', '.join(empty)}" if empty else ""
            notes = (f"{count} tracks of subtitles; read: {language}{without}",) if count > 1 else ()
            return Subtitles(ordered(cues), "embedded", "utf-8", notes)
        empty.append(language)
    return None


def _read(film: Film, place: int) -> tuple[list[Cue], str]:
    """The cues of one of the tracks, counted in the order of `text_tracks`, and its language."""
    error_type = load_av().FFmpegError
    cues: list[Cue] = []
    letters = 0
    with opened(film.source, film.form) as container:
        track = text_tracks(container)[place]
        packets = container.demux(track)
        base = float(track.time_base or 0)
        while len(cues) < MAX_CUES and letters < MAX_SUBTITLE_BYTES:
            try:
                packet = next(packets, None)
                if packet is None:
                    break
                found = packet.decode() if packet.pts is not None and packet.size else []
            except error_type as error:
                film.faults[f"times the subtitles broke off ({said(error)})"] += 1
                continue
            for subtitle in found:
                row = bytes(getattr(subtitle, "ass", b""))
                letters += len(row)
                start = (packet.pts or 0) * base - film.start
                length = packet.duration * base if packet.duration else 2.0
                cues += _cues(row.decode("utf-8", errors="replace"), start, start + min(length, _LONG))
        return cues, track.language or "no language named"


def _cues(row: str, start: float, end: float) -> list[Cue]:
    """What an event in FFmpeg's ASS says; nothing for one before the film."""
    parts = row.split(",", _COMMAS)
    if len(parts) <= _COMMAS or end <= 0:
        return []
    return cues_of(round(max(0.0, start), 3), round(end, 3), parts[-1], parts[3].strip() or None)
