"""What is done again, or gone back to: a deed that a story has had already, where it was done."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

from motion_backend.motion import Skill
from planner_service.composition.deed_lexicon import Deed, object_of
from planner_service.composition.deed_table import deed_table
from planner_service.composition.furniture_words import pieces_in
from planner_service.scripts.script import PlannedKeyframe
from planner_service.themes.beats import ReadBeat
from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import lemma_of
from planner_service.themes.opening_words import meant_by_it
from planner_service.themes.things import things, things_called

_REMEMBERED: Final = 6
"""Beats back to which "it" reaches."""
_RINGS: Final = re.compile(r"\b(?:phone|telephone|mobile|rings?|rang|ringing)\b")
_CALLS: Final = ("call", "phone")
_ANSWERS: Final = re.compile(
    r"(?:finally |then )?(?:(?:picks?|picked) (?:(?:it|the phone|the receiver) )?up|answers?|answered|takes? it|took it"
    r"|(?:gets?|got) (?:to )?it)(?: (?:after all|at last|again|finally|anyway|in time|it|(?:on|at) the \w+ ring))?"
)
"""Of a phone that was told of."""
_COOKED: Final = frozenset(
    (*things_called("food"), *things_called("drink"), "pot", "pan", "bowl", "saucepan", "ingredient")
)
_LETTERS: Final = frozenset(("letter", "note", "card", "postcard", "telegram", "bill", "list", "invitation"))
_READ: Final = _LETTERS | {"book", "novel", "newspaper", "magazine", "diary", "text", "message", "email", "comic"}
_READS_IT: Final = re.compile(r"(?:re)?reads? it\b")
_PHOTOGRAPHS: Final = frozenset(("photograph", "photo", "snapshot", "postcard", "polaroid", "drawing"))
_PICTURE: Final = re.compile(r"^\w+ (?:the|that) picture\b")
_RETURNS: Final = ("go", "return", "get", "come", "sit", "walk", "settle", "sink", "crawl", "climb", "head")
_MAT: Final = re.compile(r"\b(?:mat|rug|carpet|floor)\b")
_RESTS: Final = (Skill.SITDOWN, Skill.LIEDOWN)


def with_its_noun(index: int, beats: Sequence[ReadBeat]) -> tuple[ReadBeat, Sequence[ReadBeat]]:
    """A beat, and all of them, with what "it" is in its clause: who sits down at a desk and "opens it" opens the diary
    that was named before."""
    read, before = beats[index], beats[max(index - _REMEMBERED, 0) : index]
    clause = read.clause
    if read.beat.kind in ("deed", "speech") and _ANSWERS.fullmatch(read.text) and _has_rung(before):
        clause = replace(clause, verb="answer", lemmas=("answer", "the", "phone"))
        read = replace(read, beat=read.beat.model_copy(update={"kind": "deed"}))
    elif clause.lemmas == ("stir",) and any(not _COOKED.isdisjoint(one.clause.lemmas) for one in before):
        clause = replace(clause, verb="stir", lemmas=("stir", "the", "pot"))
    elif letter := _letter_meant(read, before):
        clause = replace(clause, lemmas=(clause.verb, "the", letter, *clause.lemmas[2:]))
    elif photograph := _photograph_meant(read, before):
        lemmas = (photograph if word == "picture" else word for word in clause.lemmas)
        clause = replace(clause, text=clause.text.replace("picture", photograph), lemmas=tuple(lemmas))
    elif meant := meant_by_it(read.text, [one.text for one in before]):
        verb, _, rest = (*clause.text.split(" ", 2), "", "")[:3]
        told = " ".join(filter(None, (verb, "the", meant, rest)))
        clause = replace(clause, text=told, lemmas=(*clause.lemmas[:1], "the", lemma_of(meant), *clause.lemmas[2:]))
    read = replace(read, clause=clause)
    return read, [*beats[:index], read, *beats[index + 1 :]]


def _has_rung(before: Sequence[ReadBeat]) -> bool:
    """Whether a phone was told of, or somebody else called, and nothing since: not "calls his dog, finds a ball"."""
    for one in reversed(before):
        if _RINGS.search(one.text) or (one.beat.who and one.clause.verb in _CALLS):
            return True
        if not things().keys().isdisjoint(one.clause.lemmas[1:]):
            return False
    return False


def _letter_meant(read: ReadBeat, before: Sequence[ReadBeat]) -> str:
    """What is read that was told of: "opens the letter, | reads it"; "" of other words, and where a book was."""
    told = (word for one in reversed(before) for word in one.clause.lemmas if word in _READ)
    found = next(told, "") if _READS_IT.match(read.text) else ""
    return found if found in _LETTERS else ""


def _photograph_meant(read: ReadBeat, before: Sequence[ReadBeat]) -> str:
    """What "the picture" is where a photograph was told of: none of those on the wall; "" of other words."""
    told = (word for one in reversed(before) for word in one.clause.lemmas if word in _PHOTOGRAPHS)
    return next(told, "") if _PICTURE.search(read.text) else ""


def done_before(
    index: int, beats: Sequence[ReadBeat], keyframes: Sequence[PlannedKeyframe], deeds: Mapping[int, Deed]
) -> Deed | None:
    """The deed of a beat's that somebody does again, or goes back to, of those before it; None of any other."""
    clause = beats[index].clause
    if "back" in clause.lemmas[:3] and clause.verb in _RETURNS:
        return _returned_to(clause, keyframes, deeds)
    told = clause.lemmas[: clause.lemmas.index("again")] if "again" in clause.lemmas else ()
    if not told or object_of(replace(clause, lemmas=told)) not in ("", "it"):
        return None  # "knocks again", but not "eats a plum again"
    same = next((at for at in range(index - 1, -1, -1) if beats[at].clause.verb == clause.verb), None)
    deed = deeds.get(same) if same is not None else None
    spot = next((one.furniture for one in reversed(keyframes) if one.beat == same), "")
    if deed is None or not spot or deed.skill not in (Skill.TOUCH, *_RESTS):
        return None
    return replace(deed, pieces=(spot,), named=True)


def _returned_to(clause: Clause, keyframes: Sequence[PlannedKeyframe], deeds: Mapping[int, Deed]) -> Deed | None:
    """What was done last at the seat, bed or floor that somebody goes back to: "goes back to his desk", "sits back
    down"; None where that was nowhere."""
    meant = pieces_in(clause.text)
    seats = {*meant, *(seat for piece in meant for seat in deed_table().seats_at.get(piece, ()))}
    floor = bool(_MAT.search(clause.text))
    for one in reversed(keyframes):
        there = one.furniture in seats or (floor and one.on_floor) or (clause.verb == "sit" and not seats)
        deed = deeds.get(one.beat) if one.beat is not None else None
        if one.skill in _RESTS and there and deed is not None and deed.skill is one.skill:
            return replace(deed, pieces=(one.furniture,), named=True)
    return None
