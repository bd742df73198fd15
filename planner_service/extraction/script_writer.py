"""A short script from what was read of it: mended, named, labelled with where it was found and who wrote it down.

Its summary is in the text's own words, told of "the character" now.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

from motion_backend.language.sentence_encoder import SentenceEncoder
from motion_backend.motion import Skill
from planner_service.narration.narrative_voice import tells_of_one
from planner_service.scripts.captions import Vocabulary
from planner_service.scripts.script import MAX_PIECES, Keyframe, ShortScript, Source
from planner_service.scripts.script_duplicates import Likeness, slug_of
from planner_service.scripts.script_library import UNKNOWN, ScriptLibrary
from planner_service.scripts.script_repair import repair
from planner_service.themes.lexicon import is_verb, third_person, verb_of

_MAX_CLAUSE_LENGTH: Final = 110
"""Letters of one clause in a summary."""
_A_SENTENCE: Final = 3
"""Clauses of one sentence."""
_NOW: Final = {
    **dict.fromkeys(("was", "were", "are", "am"), "is"), "could": "can", "would": "will", "might": "may",
    **{modal: modal for modal in ("can", "cannot", "will", "may", "must", "should", "shall")},
}  # fmt: skip
"""The present of words that no dictionary inflects so."""
_OURS: Final = (
    (r"\b(?:him|her|my|them)(?:self|selves)\b", "themself"),
    (r"\b(?:his|my|our)\b", "their"),
    (r"\bher\b(?=\s+(?!(?:to|in|on|at|with|from|for|and|but|into|up|down|out|home|back)\b)\w)", "their"),
    (r"\b(?:me|him|her|us)\b", "them"),
    (r"\b(?:I|he|she|we)\b", "they"),
)
_UNSAFE: Final = re.compile(r"[^\w\s,;'’.&%-]")
_PLAINLY: Final = {
    Skill.LOCO: "walks about", Skill.SITDOWN: "sits on the {}", Skill.LIEDOWN: "lies on the {}",
    Skill.TOUCH: "reaches for the {}", Skill.STANDUP: "stands up", Skill.GETUP: "gets up",
}  # fmt: skip


def summarise(clauses: Sequence[str], keyframes: Sequence[Keyframe], emotion: str, names: Collection[str] = ()) -> str:
    """One or two sentences in the present about "the character", at most 400 letters, that can be told.

    `clauses` are without subjects ("slumped onto the couch"); those that cannot be told of one person alone are left
    out, and where none is left the keyframes are told plainly.
    """
    told = [
        told for clause in clauses if (told := in_present(clause, names)) and tells_of_one(f"The character {told}.")
    ]
    if not told:
        told = [_PLAINLY[keyframe.skill].format(keyframe.piece[0]) for keyframe in keyframes]
    told = list(dict.fromkeys(told))[: 2 * _A_SENTENCE]
    how = f"{emotion} " if emotion != "neutral" and not re.search(rf"\b{emotion[:4]}", " ".join(told)) else ""
    first, second = told[:_A_SENTENCE], told[_A_SENTENCE:]
    whole = f"The {how}character {_listed(first)}." + (f" Then the character {_listed(second)}." if second else "")
    while len(whole) > 400:
        told.pop()
        first, second = told[:_A_SENTENCE], told[_A_SENTENCE:]
        whole = f"The {how}character {_listed(first)}." + (f" Then the character {_listed(second)}." if second else "")
    return whole


def in_present(clause: str, names: Collection[str] = ()) -> str:
    """A clause without its subject in the present of "the character": "sat by her bed" is "sits by their bed".

    Empty where it does not begin with a verb we know.
    """
    text = " ".join(_UNSAFE.sub(" ", clause).split()).strip(" .,;-'’&")
    for name in names:
        text = re.sub(rf"\b{re.escape(name)}(?P<own>['’]s)?\b", lambda m: "their" if m["own"] else "them", text)
    text = re.sub(r"\b(can|could) not\b", "cannot", text)
    for pattern, instead in _OURS:
        text = re.sub(pattern, instead, text, flags=re.IGNORECASE)
    verb = re.match(r"\w+|", text)
    if verb is None or not is_verb(verb[0]):
        return ""
    return f"{_NOW.get(verb[0].lower()) or third_person(verb_of(verb[0]))}{_cut(text)[verb.end() :]}"


def _listed(clauses: Sequence[str]) -> str:
    if len(clauses) < 2:
        return "".join(clauses)
    comma = "," if len(clauses) > 2 or re.search(", | and ", clauses[0]) else ""
    return f"{', '.join(clauses[:-1])}{comma} and {clauses[-1]}"


def _cut(text: str) -> str:
    """At most so many letters, cut at a comma or else at a word."""
    if len(text) <= _MAX_CLAUSE_LENGTH:
        return text
    short = text[:_MAX_CLAUSE_LENGTH].rsplit(" ", 1)[0]
    comma = short.rfind(",")
    short = short[:comma] if comma > _MAX_CLAUSE_LENGTH // 3 else short
    return re.sub(r"(?:\s+(?:and|or|the|a|an|of|to|in|on|at|with|for|from|into|their|that|who|which|by))+$", "", short)


RULES: Final = "rules"
Span = tuple[float | None, float | None]


@dataclass(frozen=True)
class Draft:
    """A short script that was extracted."""

    script: ShortScript
    repairs: tuple[str, ...] = ()
    """What was changed so that a body can act it out, and why."""
    like: str = ""
    """Id of a script of the library that is nearly the same; empty where there is none."""


@dataclass
class Maker:
    """Makes short scripts of one text or film, with ids unlike each other, the library's and all that are reserved."""

    name: str
    library: ScriptLibrary
    source: Source = "text"
    licence: str = UNKNOWN
    _taken: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.reserve(script.id for script in self.library.scripts)

    def reserve(self, ids: Iterable[str]) -> None:
        """Use none of these ids."""
        self._taken.update(ids)

    @property
    def encoder(self) -> SentenceEncoder:
        """What turns texts into vectors here."""
        return self.library.encoder

    def by_rules(
        self,
        clauses: Sequence[str],
        keyframes: Sequence[Keyframe],
        emotion: str,
        room: str,
        span: Span,
        names: Sequence[str],
    ) -> Draft:
        """The script of some clauses, with a summary in their words."""
        return self.make(summarise(clauses, keyframes, emotion, names), keyframes, emotion, room, span, RULES)

    def make(self, summary: str, keyframes: Sequence[Keyframe], emotion: str, room: str, span: Span, by: str) -> Draft:
        """A script that a body can act out. ValidationError where a field does not fit."""
        kept, repairs = repair(keyframes, self._vocabulary)
        if len(kept) > MAX_PIECES:
            repairs = (*repairs, f"{len(kept)} keyframes; the first {MAX_PIECES} are kept")
        start, end = span
        script = ShortScript.model_validate(
            {
                "id": slug_of(summary, self.name, self._taken),
                "summary": summary,
                "emotion": emotion,
                "room": room,
                "keyframes": kept[:MAX_PIECES],
                "source": self.source,
                "licence": self.licence,
                "origin": {"name": self.name[:200], "start": start, "end": end, "by": by[:200]},
            }
        )
        self._taken.add(script.id)
        twin = self._likeness.twin(script)
        return Draft(script, repairs, twin.script_id if twin is not None else "")

    @cached_property
    def _vocabulary(self) -> Vocabulary:
        return Vocabulary.built_in(self.encoder)

    @cached_property
    def _likeness(self) -> Likeness:
        return Likeness(self.library)
