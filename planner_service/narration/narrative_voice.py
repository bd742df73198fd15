"""Who a story is about: pronouns, and a sentence about "the character" told of that person in the past tense."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass
from string import Formatter
from typing import Final

from motion_backend.motion import Character
from planner_service.narration.tense import before_past, days_to_past, is_past, stem, word_to_past

_BLANKS: Final = ("they", "them", "their", "theirs", "themself", "were")
_FORMS: Final = {
    "he": dict(zip(_BLANKS, ("he", "him", "his", "his", "himself", "was"), strict=True)),
    "she": dict(zip(_BLANKS, ("she", "her", "her", "hers", "herself", "was"), strict=True)),
    "they": dict(zip(_BLANKS, _BLANKS, strict=True)),
}
_SPOKEN_OF: Final = {
    "he": "they", "she": "they", "they": "they", "him": "them", "them": "them", "his": "their", "her": "their",
    "their": "their", "hers": "theirs", "theirs": "theirs",
    "himself": "themself", "herself": "themself", "themselves": "themself", "themself": "themself",
}  # fmt: skip
"""Every pronoun to the name of its blank."""
_MENTION: Final = re.compile(
    r"\b(?:(?:the|an?) (?P<kind>(?!(?:other|another|whole)\b)\w+ )?(?:character|person|protagonist)|^character"
    r"|^(?:the|an?) (?:man|woman|guy|boy|girl|user)|^someone)\b(?P<own>['’]s\b)?",
    re.IGNORECASE,
)
_TOKEN: Final = re.compile(r"⟦[^⟧]*⟧|\w+(?:['’-]\w+)*|[^\w\s]+")
_OPENS_CLAUSE: Final = frozenset(
    {"", ",", ".", ";", ":", "!", "?", "and", "but", "or", "so", "that", "while", "because", "as", "when", "until"}
    | {"before", "after", "then", "if", "where", "though", "since", "once"}
)
_OBJECT_FOLLOWS: Final = frozenset(
    {"", ",", ".", ";", ":", "!", "?", "and", "but", "or", "to", "in", "on", "at", "with", "from", "for", "that", "as"}
    | {"because", "when", "while", "into", "off", "up", "down", "home", "out", "so", "by", "a", "the", "feel", "about"}
)
_NOT_OURS: Final = re.compile(r"\b(?:I|you|we|me|us|my|your|our)\b", re.IGNORECASE)


_REPORTS: Final = frozenset(
    ("find", "tell", "hear", "learn", "see", "realise", "realize", "discover", "notice", "read")
)
"""What is heard or found lies before it: "found that he had won"."""


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

    def __getitem__(self, blank: str) -> str:
        return {**_FORMS[self.pronouns], "name": self.name}[blank]

    def fill(self, template: str, **words: str) -> str:
        """A template with {they}, {them}, {their}, {themself}, {were}, {name} and `words` filled in."""
        return template.format(**{**_FORMS[self.pronouns], "name": self.name, **words})

    def owner(self) -> str:
        """Emily's; James's."""
        return self.name + "'s"


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


def retell(text: str, voice: Voice, named: bool = False, others: frozenset[str] = frozenset()) -> str | None:
    """A present-tense text about "the character", told of the voice in the past; None where that is not safe.

    The first mention says the name unless `named`; the later ones a pronoun where that cannot be mistaken. Not safe
    means that no finite verb was found, that someone else might be meant, or that it speaks to the reader.
    """
    lower = {word.lower() for word in re.findall(r"\w+", text)}
    if _NOT_OURS.search(text) or ({"he", "his", "him"} & lower and {"she", "her", "hers"} & lower):
        return None
    marked = _MENTION.sub(lambda m: f"⟦{(m['kind'] or '').strip()}{'|own' if m['own'] else ''}⟧", text.strip())
    they_is_ours = not {"he", "she", "his", "her", "him"} & lower
    told = _Telling(voice, named, others if they_is_ours else others | {"they", "them", "their", "theirs"})
    for match in _TOKEN.finditer(marked):
        follows = _TOKEN.search(marked, match.end())
        told.add(match[0], follows[0].lower() if follows else "", marked[told.end : match.start()])
        told.end = match.end()
    return days_to_past(_capitalised("".join(told.words))) if told.finite else None


class _Telling:
    """One text on its way through `retell`, word by word."""

    def __init__(self, voice: Voice, named: bool, others: frozenset[str]) -> None:
        self.voice = voice
        self.named = named
        self.others = others  # pronouns that stand for somebody else
        self.words: list[str] = []
        self.before = ""
        self.end = 0
        self.finite = 0
        self.subject = False  # whether the word before, adverbs aside, is our person as a subject
        self.reporting = ""  # the verb of "is told that he fails" whose clause is still to come
        self.reported = False  # whether the clause is such a verb's
        self.plural = False  # whether the verb in reach agrees with "they"

    def add(self, token: str, follows: str, space: str) -> None:
        """Tell one more word; `space` stood in front of it."""
        lower = token.lower()
        if token.startswith("⟦"):
            told = self._mention(token[1:-1], follows)
        elif lower in _SPOKEN_OF and lower not in self.others:
            told = self._pronoun(lower, follows)
        else:
            told = self._word(token)
        self._report(lower, follows)
        self.words += [space, told]
        self.before = lower

    def _report(self, lower: str, follows: str) -> None:
        """Note where a clause begins that is told by "finds that" or "is told on the phone that", and where it ends."""
        if stem(lower) in _REPORTS:
            self.reporting, self.reported = stem(lower), follows in ("he", "she", "they")
        elif lower == "that" and self.reporting and (self.reporting == "tell" or stem(self.before) == self.reporting):
            self.reported, self.reporting = True, ""
        elif lower in _OPENS_CLAUSE - {""}:
            self.reporting, self.reported = "", False

    def _mention(self, mark: str, follows: str) -> str:
        kind, _, own = mark.partition("|")
        if own:
            told = self.voice["their"] if self.named else self.voice.owner()
        elif kind:
            told, self.subject = f"the {kind} {self.voice.name}", True
        elif self.named and self.before in _OPENS_CLAUSE and follows != ",":
            told, self.subject = self.voice["they"], True
        else:
            told, self.subject = self.voice.name, True
        self.plural = told == "they"
        self.named = True
        return told

    def _pronoun(self, lower: str, follows: str) -> str:
        blank = _SPOKEN_OF[lower]
        if lower == "her" and follows in _OBJECT_FOLLOWS:
            blank = "them"
        if blank == "they":
            told = self.voice["they"] if self.named else self.voice.name
            self.subject, self.plural, self.named = True, told == "they", True
            return told
        if blank == "them" and not self.named:
            self.named = True
            return self.voice.name
        return self.voice[blank]

    def _word(self, token: str) -> str:
        after_subject = self.subject
        told = word_to_past(token, "they" if after_subject and self.before == "they" else self.before, after_subject)
        if told.lower() in ("was", "were") and (after_subject or self.before in ("and", "then", "but", "or")):
            told = "were" if self.plural else "was" if after_subject else told
        if self.reported and (told != token or after_subject):
            told = before_past(told)
        self.finite += told != token or is_past(told.lower())
        if not (
            token.lower().endswith("ly") or token.lower() in ("then", "now", "also", "soon", "still", "just", "never")
        ):
            self.subject = False
        return told


def _capitalised(text: str) -> str:
    """Capitals at the start of every sentence."""
    return re.sub(r"(^|[.!?]\s+)([a-z])", lambda m: m[1] + m[2].upper(), text)
