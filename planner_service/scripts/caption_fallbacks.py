"""The known caption that is acted for one whose words the body does not know; what is told stays as it is.

Where nothing known is near, it is what a body usually does with that skill in that mood.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from typing import Final

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Emotion, Skill
from motion_backend.procedural.caption_coverage import understands, unread
from planner_service.scripts.captions import Vocabulary, agree, captions, sides
from scene_graphs.data_tables import read_table, table


@table
class UsualCaptions:
    """data/usual_captions.toml: captions by emotion; "neutral" for any that has none of its own."""

    loco: dict[Emotion, str]
    """Those of connecting walks."""
    sitdown: dict[Emotion, str]
    liedown: dict[Emotion, str]


@cache
def usual_captions() -> UsualCaptions:
    """The captions that a mood has where nothing else is asked for."""
    known: UsualCaptions = read_table("planner_service", "usual_captions.toml", UsualCaptions)
    return known


_HEIGHTS: Final = (("high", r"\bhigh|\babove\b|\bup to\b"), ("low", r"\blow\b|\blower\b|\bbend|\bunder\b"))
_TOUCHES: Final = {"high": "An act of reaching high", "low": "touch low height", "medium": "touch medium height"}
_SLOW: Final = r"slow|weari|heav|reluctan"
_FAST: Final = r"abrupt|quick|sudden|leap|jump|spring"


def usual(skill: Skill, mood: Emotion, caption: str = "") -> str:
    """The caption of a skill in one of nine emotions; a touch keeps height and hand of `caption`, a rising its pace."""
    text = caption.lower()
    match skill:
        case Skill.LOCO:
            return usual_captions().loco[mood]
        case Skill.SITDOWN | Skill.LIEDOWN:
            poses = usual_captions().sitdown if skill is Skill.SITDOWN else usual_captions().liedown
            pose = poses.get(mood, poses[Emotion.NEUTRAL])
            return pose if agree(caption, pose) else poses[Emotion.NEUTRAL]
        case Skill.TOUCH:
            height = next((name for name, words in _HEIGHTS if re.search(words, text)), "medium")
            hand = {"left", "right"} & sides(caption)
            return _TOUCHES[height] + (f" with the {hand.pop()} hand" if len(hand) == 1 else "")
        case _:
            rising = "stand up" if skill is Skill.STANDUP else "get up"
            if re.search(_SLOW, text):
                return f"{rising} slowly"
            fast = "abruptly" if skill is Skill.STANDUP else "quickly"
            return f"{rising} {fast}" if re.search(_FAST, text) else rising


Words = Callable[[], Vocabulary]
"""The known captions; asked for only where a caption is not among them, since sentences have to be encoded then."""


@cache
def hashed_words() -> Vocabulary:
    """The captions that ship with the service, compared by their letters."""
    return Vocabulary.built_in(HashingEncoder())


def performed_as(skill: Skill, caption: str, mood: Emotion, words: Words) -> str:
    """The caption itself where the body knows it or words of it; else the nearest in meaning, or the usual one."""
    if caption in captions()[skill.value] or understands(skill, caption):
        return caption
    known = words()
    nearest, score = known.nearest(skill, caption)
    return nearest if score >= known.least else usual(skill, mood, caption)


def not_seen(skill: Skill, caption: str) -> tuple[str, ...]:
    """The words of a caption of one's own that nothing of the body shows, where it does the others: those that change
    nothing and are in no caption that it knows."""
    if caption in captions()[skill.value] or not understands(skill, caption):
        return ()
    known = {word for row in captions()[skill.value] for word in re.findall(r"[a-z]+", row.lower())}
    return tuple(word for word in unread(skill, caption) if word not in known)
