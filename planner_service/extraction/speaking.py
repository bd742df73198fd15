"""What one cue says: words without tags, each part with its speaker, and the sounds apart."""

from __future__ import annotations

import html
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

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
