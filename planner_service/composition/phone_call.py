"""A call on the phone goes on: what is said, laughed and paced during it is done with the phone at the ear."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from motion_backend.motion import Skill
from planner_service.composition.deed_lexicon import Deed
from planner_service.composition.deed_table import DeedRow
from planner_service.scripts.script import Keyframe
from planner_service.themes.beats import ReadBeat

_TALKS: Final = re.compile(r"\bphone\b.*\bear\b|\btalking on the phone\b")
"""Captions of who has a phone at the ear."""
_INTO_IT: Final = re.compile(
    r"\b(?:on|over|down|into) (?:the|his|her|their|my) (?:\w+ )?(?:phone|telephone|receiver)\b"
)
_VOICED: Final = re.compile(
    r"^(?:shouting|laughing|talking|crying|sighing|pacing|listening|stand still|nodding|shaking the head)\b"
)
"""Captions of what may be done on the phone as well."""
_ABOUT: Final = re.compile(r"\b(?:up and down|back and forth|to and fro|around|about|in circles)\b")
_HANGS_UP: Final = re.compile(
    r"\b(?:hang|hung|ring|rang)\w* (?:\w+ )?(?:up|off)\b|\b(?:end|finish|cut)\w* (?:off )?the call\b"
    r"|\b(?:puts?|lays?|laid|sets?) (?:away |down )?(?:the|his|her|their|my) (?:\w+ )?(?:phone|telephone|receiver)\b",
    re.IGNORECASE,
)
_WALKING: Final = "walk while talking on the phone with the right hand"
_SEATED: Final = ("sitting upright, phone at the right ear",)
_LYING: Final = ("talking on the phone while lying, right hand at the ear",)


HANGING_UP: Final = "hanging up, the phone thrust down in the right hand"


def is_talk(caption: str) -> bool:
    """Whether a body has a phone at its ear in a caption."""
    return _TALKS.search(caption) is not None


def hangs_up(read: ReadBeat) -> bool:
    """Whether a call ends."""
    return _HANGS_UP.search(read.text) is not None


def on_phone(deed: Deed, read: ReadBeat, last: Keyframe | None, nexts: Sequence[ReadBeat]) -> Deed:
    """A deed as it is done during a call, by who has the phone at the ear (`last`, None where it is over), or told to
    be: "shouts at his boss on the phone", "paces"; any other is not."""
    calls = last is not None
    into = bool(_INTO_IT.search(read.text)) and any(map(_VOICED.match, deed.row.captions))
    if not (calls or into) or hangs_up(read):
        return deed
    talks = read.clause.verb in ("talk", "speak", "chat", "argue", "quarrel", "cry", "laugh", "listen", "wait")
    voiced = into or talks or any(map(_VOICED.match, deed.row.captions)) or bool(_ABOUT.search(read.text))
    goes_on = any(map(hangs_up, nexts))
    if deed.skill is Skill.LOCO and (voiced or (goes_on and not deed.is_gesture)):
        own = last.caption if last is not None and last.skill is Skill.LOCO else _WALKING
        row = DeedRow(deed.row.says, Skill.LOCO, captions=(own,), seated=_SEATED, lying=_LYING, mood=deed.row.mood)
        return replace(deed, row=row)
    rests = {Skill.SITDOWN: _SEATED, Skill.LIEDOWN: _LYING}.get(deed.skill, ())
    if rests and goes_on and not deed.row.captions:
        return replace(deed, row=replace(deed.row, captions=rests))
    if rests and voiced and last is not None and last.skill is Skill.LOCO and not deed.named:
        return replace(
            deed, skill=Skill.LOCO, pieces=(), row=DeedRow(deed.row.says, Skill.LOCO, captions=(last.caption,))
        )
    if rests and voiced:
        return replace(deed, row=replace(deed.row, captions=rests, seated=_SEATED, lying=_LYING))
    return deed
