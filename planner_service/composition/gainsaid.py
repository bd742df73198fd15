"""What a picture gainsays: words of a way or a place that a keyframe does not have, however near it comes else."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from motion_backend.motion import Skill
from planner_service.composition.caption_senses import only_in
from planner_service.composition.furniture_words import pieces_in
from planner_service.scripts.script import Keyframe
from planner_service.scripts.script_words import affords
from planner_service.themes.clause import Clause
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things_called

_THE: Final = r"(?:the|an?|his|her|their|my|its|every|each) "
_HIDDEN: Final = re.compile(rf"\b(under|underneath|beneath|below|behind) ({_THE}(?:\w+ ?){{1,3}})")
"""Where a body or a hand is that a keyframe has on a piece, or before it."""
_INSIDE: Final = re.compile(rf"\b(?:into|inside|in) ({_THE}(?:\w+ ?){{1,2}})")
_ON_IT: Final = re.compile(rf"\b(?:on|onto|on top of|upon) ({_THE}(?:\w+ ?){{1,2}})")

_CROUCHED: Final = "crouching low"
"""Of the caption of who makes themselves small by a thing."""


_HAS_OBJECT: Final = frozenset(("it", "them", "the", "a", "an", "his", "her", "their", "my", "some", "all", "every"))
"""Words that tell that it is a thing which gets there: "hides it in the wardrobe"."""


def is_gainsaid(clause: Clause, keyframes: Sequence[Keyframe]) -> bool:
    """Whether none of some keyframes can be what a clause tells: by its verb, or by where the body or the hand is."""
    return all(_is_another_deed(clause, one) or _is_another_place(clause, one) for one in keyframes)


def _is_another_deed(clause: Clause, keyframe: Keyframe) -> bool:
    """Whether a deed is told that is seen in the hands or limbs, and a caption that is not of it."""
    parts = only_in(clause)
    return parts is not None and not any(part in keyframe.caption.lower() for part in parts)


def _is_another_place(clause: Clause, keyframe: Keyframe) -> bool:
    """Whether it is told to be under, behind or in a piece, or standing on it."""
    seated = keyframe.skill is Skill.SITDOWN
    lain = keyframe.skill is Skill.LIEDOWN
    hidden = [(piece, how) for how, place in _HIDDEN.findall(clause.text) for piece in pieces_in(place)]
    covered = lain and any(word in things_called("bedding") for word in clause.lemmas)  # "under the bed covers"
    covered = covered or (_CROUCHED in keyframe.caption and all(how != "behind" for _, how in hidden))
    low = "low" in keyframe.caption.lower()
    if keyframe.skill is Skill.TOUCH and low and clause.verb not in theme_words()["entering_verbs"]:
        hidden = []  # hands reach under the sofa beside it
    if any(not (seated and how == "behind" and not affords(piece, "sit")) for piece, how in hidden) and not covered:
        return True  # but one sits behind a desk
    enters = clause.verb in theme_words()["entering_verbs"] and _HAS_OBJECT.isdisjoint(clause.lemmas[1:2])
    if enters and (hidden or _INSIDE.search(clause.text)):
        inside = [piece for place in _INSIDE.findall(clause.text) for piece in pieces_in(place)]
        if any(not affords(piece, "lie") and not affords(piece, "sit") for piece in inside):
            return True
    seats = [piece for place in _ON_IT.findall(clause.text) for piece in pieces_in(place) if affords(piece, "sit")]
    lain = lain and all(affords(piece, "lie") for piece in seats)
    return clause.verb in theme_words()["mounting_verbs"] and bool(seats) and not lain
