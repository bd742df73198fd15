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
from motion_backend.procedural.caption_coverage import understands
from planner_service.scripts.captions import Vocabulary, agree, captions, sides

WALKS: Final = {
    "neutral": "smoothly forward walk",
    "happy": "excited walk",
    "angry": "angrily walking",
    "hurried": "rush anxiously forward",
    "tired": "head bowed and body bent while walking",
    "sad": "walk with depression",
    "stressed": "walking slowly, hands behind back",
    "drunk": "walking drunkenly",
    "relaxed": "smoothly forward walk",
}
"""The caption of a connecting walk, by emotion."""
_POSES: Final = {
    Skill.SITDOWN: {
        "happy": "hands support on seat, legs straight",
        "angry": "crossing arms",
        "hurried": "sit upright with hands on thighs",
        "tired": "lying back in chair, arms relaxed at sides",
        "sad": "sitting with head bowed, hands resting on thighs",
        "stressed": "supporting head with hands, head bowed",
        "drunk": "lying back in chair, arms relaxed at sides",
        "relaxed": "hands behind head, lean back, cross-legged",
    },
    Skill.LIEDOWN: {
        "happy": "lying with hands under head, legs crossed",
        "sad": "Lying down with right leg bent and hands covering face",
        "stressed": "lying flat with hands over belly and knees bent",
        "relaxed": "hands on belly",
    },
}
_PLAIN: Final = {
    Skill.SITDOWN: "sit upright with hands on thighs",
    Skill.LIEDOWN: "lying down, legs straight",
}
_HEIGHTS: Final = (("high", r"\bhigh|\babove\b|\bup to\b"), ("low", r"\blow\b|\blower\b|\bbend|\bunder\b"))
_TOUCHES: Final = {"high": "An act of reaching high", "low": "touch low height", "medium": "touch medium height"}
_SLOW: Final = r"slow|weari|heav|reluctan"
_FAST: Final = r"abrupt|quick|sudden|leap|jump|spring"


def usual(skill: Skill, mood: Emotion, caption: str = "") -> str:
    """The caption of a skill in one of nine emotions; a touch keeps height and hand of `caption`, a rising its pace."""
    text = caption.lower()
    match skill:
        case Skill.LOCO:
            return WALKS[mood]
        case Skill.SITDOWN | Skill.LIEDOWN:
            pose = _POSES[skill].get(mood, _PLAIN[skill])
            return pose if agree(caption, pose) else _PLAIN[skill]
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
