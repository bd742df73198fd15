"""What only stands for a beat, and is worse than nothing: who would have to sit or lie down, get up or go for it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from motion_backend.motion import RISINGS, Skill
from planner_service.composition.body_track import BodyTrack
from planner_service.composition.deed_lexicon import Deed
from planner_service.composition.deed_reader import DeedReader
from planner_service.composition.gainsaid import is_gainsaid
from planner_service.composition.rest_place import is_sure, lies
from planner_service.scripts.acted_beats import connects
from planner_service.scripts.script import PlannedKeyframe
from planner_service.scripts.script_words import affords
from planner_service.themes.beats import EXPRESSIONS, ReadBeat
from scene_graphs.furniture import class_of

SEATED_FOR_IT: Final = 0.7
"""Nobody sits down, or gets up, for what is less likely to show a beat that it only stands for;"""
GONE_FOR_IT: Final = 0.3
"""and nobody lies down or goes anywhere for what is less likely than this."""
SEATS: Final = ("seat", "sofa")
"""Classes of furniture that nobody gets up for from one of them."""
_FACE: Final = re.compile(
    r"\b(?:breath|heav|let|giv|utter)\w* (?:out )?an? (?:\w+ )?(?:sigh|smile|grin|laugh|giggle|groan|moan|gasp)\b",
    re.IGNORECASE,
)
"""What is done with face and voice alone."""
_FALLS: Final = frozenset(
    ("fall", "flop", "lie", "collapse", "drop", "land", "crash", "sink", "sleep", "roll", "throw")
)
_POSTURES: Final = (Skill.SITDOWN, Skill.LIEDOWN)


def is_too_much(read: ReadBeat, deed: Deed, before: BodyTrack, after: BodyTrack, reader: DeedReader) -> bool:
    """Whether what a body does for a beat only stands for it, and is more than it would do where it is."""
    new = after.keyframes[len(before.keyframes) :]
    done = [one for one in new if deed.skill is Skill.LOCO or not connects(one)] or new
    seated = before.resting is None and bool(done) and done[-1].skill in _POSTURES
    if seated and deed.named and deed.skill is done[-1].skill is Skill.LIEDOWN and read.clause.verb in _FALLS:
        return False  # "falls face down on the bed": on it all the same
    there = deed.is_gesture and deed.named and deed.skill is done[-1].skill if done else False  # "laughs on the sofa"
    faces = read.clause.verb in EXPRESSIONS or _FACE.search(read.text) is not None
    if seated and not there and (is_gainsaid(read.clause, new) or faces):
        return True  # "climbs on a chair" is no sitting on it; nobody sits down for a sigh
    resting = before.resting
    rises = resting is not None and bool(done) and _is_left(resting, done[-1], new)
    if resting is not None and rises and _is_stayed_for(resting, read, deed, done[-1], new):
        return True
    if not done or deed.row.rests or deed.skill in RISINGS or reader.is_shown(read.clause, deed, done):
        return False
    if (is_sure(read, deed) and not is_gainsaid(read.clause, done)) or not (seated or rises or len(new) > len(done)):
        return False  # a hand, or steps, where one is
    if is_gainsaid(read.clause, done) and len(new) > len(done):
        return True  # nor for what it cannot be: "shakes a bag of treats"
    least = SEATED_FOR_IT if rises or (seated and done[-1].skill is Skill.SITDOWN) else GONE_FOR_IT
    if max(reader.likelihood(read.clause, one) for one in done) < least:
        return True
    return rises and is_gainsaid(read.clause, done)


def _is_left(resting: PlannedKeyframe, last: PlannedKeyframe, new: Sequence[PlannedKeyframe]) -> bool:
    """Whether who rests gets up for new keyframes, or rests elsewhere."""
    elsewhere = last.skill not in _POSTURES or last.furniture != resting.furniture
    return elsewhere or any(one.skill in RISINGS for one in new)


def _is_stayed_for(
    resting: PlannedKeyframe, read: ReadBeat, deed: Deed, last: PlannedKeyframe, new: Sequence[PlannedKeyframe]
) -> bool:
    """Whether who rests stays, whatever it shows: for a seat, for what is small, for what another posture gainsays."""
    if last.skill is Skill.TOUCH and resting.skill is Skill.SITDOWN:
        same = last.furniture == resting.furniture and not affords(last.furniture, "lie")
        if same or (not deed.named and class_of(last.furniture) in SEATS):
            return True
    small = deed.row.small and (deed.is_gesture or lies(resting))
    return small or (last.skill in _POSTURES and is_gainsaid(read.clause, new))
