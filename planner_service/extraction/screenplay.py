"""A screenplay page taken apart: sluglines, action, who speaks, and the parentheticals between (as in Fountain)."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import groupby
from typing import Final, NamedTuple

from planner_service.themes.lexicon import is_verb
from planner_service.themes.verb_finder import has_verb
from scene_graphs import furniture

_SLUG: Final = re.compile(
    r"^\s*(?:\d{1,3}[A-Z]?\.?\s+)?(?P<side>INT\.?\s*/\s*EXT|EXT\.?\s*/\s*INT|I/E|INT|EXT|EST)[.:\s]+(?P<place>\S.*)$"
)
_CUE: Final = re.compile(r"^\s*(?P<name>[A-Z][A-Z .'’-]{0,38}[A-Z.])\s*(?:\([^)]{1,20}\))*\s*\^?$")
_TRANSITION: Final = re.compile(r"^\s*(?:[A-Z ]{2,30} TO:|FADE (?:IN|OUT)[.:]?|THE END\.?|CONTINUED:?|\d{1,3}\.?)\s*$")
_AGE: Final = re.compile(r"\(\s*(?:[^()]*\d[^()]*|[a-z ]*(?:teens|twenties|thirties|forties|fifties|sixties))\s*\)")
_CAPITALS: Final = re.compile(r"\b[A-Z][A-Z'’-]+\b")


class Part(NamedTuple):
    """A stretch of a screenplay."""

    kind: str
    """"scene" (a slugline's place), "outside" (one beyond the home), "action" or "speech"."""
    text: str
    speaker: str = ""


def is_screenplay(text: str) -> bool:
    """Whether there is a slugline in it ("INT. LIVING ROOM - NIGHT")."""
    return any(_SLUG.match(line) for line in text.splitlines())


def parts_of(text: str) -> Iterator[Part]:
    """The parts of a screenplay in order; page numbers and transitions are left out."""
    lines = [line for line in text.splitlines() if not _TRANSITION.match(line) or not line.strip()]
    blocks = [list(block) for told, block in groupby(lines, key=lambda line: bool(line.strip())) if told]
    cast = {_name(block[0]) for block in blocks if _is_speech(block)}
    cast |= {name.title() for name in re.findall(r"\b([A-Z]{2,20})(?=,? \()", text)}
    for block in blocks:
        yield from _parts(block, cast)


def _parts(block: list[str], cast: set[str]) -> Iterator[Part]:
    slug = _SLUG.match(block[0])
    if slug is not None:
        yield Part("outside" if slug["side"] in ("EXT", "EST") else "scene", slug["place"].strip())
        block = block[1:]
    if not block:
        return
    if not _is_speech(block):
        yield Part("action", _in_small_letters(" ".join(block), cast))
        return
    speaker = _name(block[0])
    told = [part for part in re.split(r"(\([^()]*\))", " ".join(block[1:])) if part.strip()]
    for aside, lines in groupby(told, key=lambda part: part.startswith("(")):
        words = " ".join(lines).strip("() ")
        # "(sinks onto the sofa)" is done; "(angrily)" and "(sighing)" are how something is said.
        if aside and is_verb(words.partition(" ")[0]) and has_verb(words) and not re.fullmatch(r"\w+ing", words):
            yield Part("action", f"{speaker} {words}.", speaker)
        elif words:
            yield Part("speech", words, speaker)


def _is_speech(block: list[str]) -> bool:
    return len(block) > 1 and _CUE.match(block[0]) is not None and not _SLUG.match(block[0])


def _name(cue: str) -> str:
    match = _CUE.match(cue)
    return match["name"].strip().title().split()[-1] if match else ""


def _in_small_letters(action: str, cast: set[str]) -> str:
    """What screenplays shout in small letters again: people keep a capital, things and deeds do not."""
    plain = " ".join(_AGE.sub("", action).split())

    def said(match: re.Match[str]) -> str:
        word = match[0]
        known = is_verb(word) or furniture.is_known(word)
        starts = match.start() == 0 or plain[: match.start()].rstrip()[-1:] in ".!?"
        return word.title() if word.title() in cast or (starts and not known) else word.lower()

    return _CAPITALS.sub(said, plain)
