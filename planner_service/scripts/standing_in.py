"""The known caption that is acted for one whose words the body does not know; what is told stays as it is."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from motion_backend.language.text import HashingEncoder
from motion_backend.motion import Skill
from motion_backend.procedural.understanding import understands
from planner_service.scripts.captions import Vocabulary, captions
from planner_service.scripts.emotions import emotion_of
from planner_service.scripts.usual import usual

Words = Callable[[], Vocabulary]
"""The known captions; asked for only where a caption is not among them, since sentences have to be encoded then."""


@cache
def hashed_words() -> Vocabulary:
    """The captions that ship with the service, compared by their letters."""
    return Vocabulary.built_in(HashingEncoder())


def performed_as(skill: Skill, caption: str, emotion: str, words: Words) -> str:
    """The caption itself where the body knows it or words of it; else the nearest in meaning, or the usual one."""
    if caption in captions()[skill.value] or understands(skill, caption):
        return caption
    known = words()
    nearest, score = known.nearest(skill, caption)
    return nearest if score >= known.least else usual(skill, emotion_of(emotion) or "neutral", caption)
