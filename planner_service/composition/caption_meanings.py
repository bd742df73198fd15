"""The captions as a list in words: each with the deeds that it is seen as, and other words for it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

from motion_backend.motion import Skill
from planner_service.composition.caption_senses import senses
from planner_service.composition.deed_table import DeedRow, deed_table
from planner_service.scripts.captions import captions, synonyms

MOST: Final = 5
"""Deeds that are named of one caption."""
_PLAIN: Final = re.compile(r"[a-z]+(?:\|[a-z]+)*")
"""Ways to say a deed in one word."""
_WORD: Final = re.compile(r"[^\W_]+")


@dataclass(frozen=True)
class CaptionWords:
    """A caption that the body knows, and what it means."""

    skill: Skill
    caption: str
    shows: tuple[str, ...]
    """Deeds of a theme that are seen in it, in base form: "clap", "applaud"; empty: none but its own words."""
    others: tuple[str, ...]
    """Other ways to say it, which mean it too."""

    def has(self, asked: Sequence[str]) -> bool:
        """Whether some word of it, or of what it means, begins as each word that is asked for."""
        words = [word for text in (self.caption, *self.shows, *self.others) for word in _words(text)]
        words += [*_words(self.skill.words), self.skill.value]
        return all(any(word.startswith(one) for word in words) for one in asked)


@cache
def known_captions() -> tuple[CaptionWords, ...]:
    """All of them, skill after skill."""
    said = synonyms()
    return tuple(
        CaptionWords(skill, text, tuple(_shown(skill, text)), tuple(said.get(skill.value, {}).get(text, ())))
        for skill in Skill
        for text in captions()[skill.value]
    )


def find_captions(words: str = "", skill: Skill | None = None) -> list[CaptionWords]:
    """Those of a skill, or of any, that have every one of some words, or how it begins."""
    asked = _words(words)
    return [one for one in known_captions() if skill in (None, one.skill) and one.has(asked)]


def _words(text: str) -> list[str]:
    return _WORD.findall(text.lower())


def _shown(skill: Skill, caption: str) -> list[str]:
    """Of a gesture what the table of gestures has it for, of others what it is looked at as: verbs, else phrases."""
    rows = [row for row in deed_table().gesture if caption in _captions_of(row, skill)]
    says = [*(way for row in rows for way in row.says), *senses(skill, caption, own=True)]
    verbs = [verb for way in says if _PLAIN.fullmatch(way) for verb in way.split("|")]
    return list(dict.fromkeys(verbs or map(_legible, says)))[:MOST]


def _captions_of(row: DeedRow, skill: Skill) -> Iterator[str]:
    """The captions of a skill that a row has for its deed."""
    yield from row.captions if row.skill is skill else ()
    yield from row.seated if skill is Skill.SITDOWN else ()
    yield from row.lying if skill is Skill.LIEDOWN else ()


def _legible(way: str) -> str:
    """A way to say a deed by the first of its words: "comb ... hair" of "comb|brush ... hair|locks"."""
    words = (word.partition("|")[0] for word in way.split() if word != "$")
    return re.sub(r" (?:the|an?)$", "", " ".join("…" if word == "..." else word for word in words))
