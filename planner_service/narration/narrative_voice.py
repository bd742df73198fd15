"""Who a story is about: the name and the pronouns, and templates with blanks for them."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass
from string import Formatter
from typing import Final

from motion_backend.motion import Character
from planner_service.narration.tense import form_of
from planner_service.themes.verb_finder import is_plural

_BLANKS: Final = ("they", "them", "their", "theirs", "themself")
_FORMS: Final = {
    "he": dict(zip(_BLANKS, ("he", "him", "his", "his", "himself"), strict=True)),
    "she": dict(zip(_BLANKS, ("she", "her", "her", "hers", "herself"), strict=True)),
    "they": dict(zip(_BLANKS, _BLANKS, strict=True)),
    "I": dict(zip(_BLANKS, ("I", "me", "my", "mine", "myself"), strict=True)),
}
_NOT_OURS: Final = re.compile(r"\b(?:I|you|we|me|us|my|your|our)\b", re.IGNORECASE)


@dataclass(frozen=True)
class Voice:
    """The person a story tells of."""

    name: str
    pronouns: str

    @classmethod
    def of(cls, character: Character) -> Voice:
        """The voice of a character; unknown pronouns are they."""
        word = character.pronouns.strip().lower().split("/")[0]
        return cls(character.name.strip() or "Sam", word if word in _FORMS else "they")

    def in_theme_of(self, hero: str) -> Voice:
        """The voice for a theme about `hero`: who tells of themselves goes on so, unless somebody else is named."""
        unnamed = self == Voice.of(Character())
        return Voice("I", "I") if hero == "I" and unnamed else self

    def was(self, subject: str) -> str:
        """Was or were, for its name or its pronoun: "the twins were", "the old couple was"."""
        several = (subject == "they" and self.pronouns != "I") or (
            subject == self.name and subject.islower() and is_plural(subject.split()[-1])
        )
        return "were" if several else "was"

    def __getitem__(self, blank: str) -> str:
        return _FORMS[self.pronouns][blank]

    def fill(self, template: str, **words: str) -> str:
        """A template with {they}, {them}, {their}, {theirs}, {themself}, {name} and `words` filled in."""
        return template.format(**{**_FORMS[self.pronouns], "name": self.name, **words})


def require_blanks(place: str, templates: object, blanks: Collection[str]) -> None:
    """ValueError, with the place in a table, for a template with a blank that is neither these nor a voice's."""
    if isinstance(templates, str):
        found = {name for _, name, _, _ in Formatter().parse(templates) if name is not None}
        if wrong := found - {*blanks, *_BLANKS, "name"}:
            raise ValueError(f"{place}: there is no blank {{{min(wrong)}}} to fill in {templates!r}")
    elif isinstance(templates, tuple):
        for template in templates:
            require_blanks(place, template, blanks)
    else:
        for key, inside in (templates if isinstance(templates, dict) else vars(templates)).items():
            require_blanks(f"{place}.{key}".strip("."), inside, blanks)


def tells_of_one(summary: str) -> bool:
    """Whether a summary tells, in the present, of one person: it speaks to nobody and has no second one."""
    words = re.findall(r"[a-z]+", summary.lower())
    two = bool({"he", "his", "him"} & {*words}) and bool({"she", "her", "hers"} & {*words})
    return not two and not _NOT_OURS.search(summary) and any(form_of(word) == "present" for word in words)
