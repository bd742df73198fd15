"""The captions that show a mood: of a skill, and of a walk alone."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from functools import cache
from typing import Final

from motion_backend.motion import Emotion, Skill
from planner_service.composition.deed_table import captions_of_gestures, deed_table
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.caption_fallbacks import usual

_MOODY: Final = {
    Emotion.STRESSED: "pacing back and forth",
    Emotion.RELAXED: "strolling with hands in pockets",
    Emotion.TIRED: "shuffling sleepily forward",
}
"""How a mood alone is shown on one's feet, where it is not the mood's usual walk."""
_MIN_SHARE: Final = 0.3
"""Share of a caption's uses in the library that must be of a mood for it to be one of the mood's."""
_FITTING_SHARE: Final = 0.15
"""Share from which a caption that shows a deed fits the mood it is done in."""


def captions_of(skill: Skill, mood: Emotion) -> tuple[str, ...]:
    """Captions that the library uses in a mood mostly, and that show nothing else; else the mood's usual one."""
    return _mostly(skill, mood) or (usual(skill, mood),)


def fitting(captions: Sequence[str], skill: Skill, mood: Emotion) -> list[str]:
    """Those of the captions that the library uses in the mood; all of them where it uses none."""
    used = [caption for caption in captions if _shares().get((skill, caption), {}).get(mood, 0.0) >= _FITTING_SHARE]
    return used or list(captions)


def walk_of(mood: Emotion) -> str:
    """How a mood alone is shown on one's feet."""
    return _MOODY.get(mood) or usual(Skill.LOCO, mood)


@cache
def _shares() -> dict[tuple[Skill, str], dict[Emotion, float]]:
    """How the library's keyframes of each caption are shared among the moods; a gesture shows a deed, in any mood."""
    counts: dict[tuple[Skill, str], Counter[Emotion]] = {}
    for script in built_in():
        for keyframe in script.keyframes:
            if (keyframe.skill, keyframe.caption) in captions_of_gestures():
                continue
            counts.setdefault((keyframe.skill, keyframe.caption), Counter())[keyframe.mood] += 1
    return {key: {mood: n / moods.total() for mood, n in moods.items()} for key, moods in counts.items()}


@cache
def _mostly(skill: Skill, mood: Emotion) -> tuple[str, ...]:
    """Captions of a skill that show a mood, no deed but its usual one and no other mood, in the order of the alphabet;
    hands behind the head are at ease in any."""
    rows = [row for row in deed_table().deed if row.rests or row.skill is Skill.LOCO or row.at == ("floor",)]
    deeds = {caption for row in rows for caption in (*row.captions, *row.lying, *row.seated)}
    shares = _shares()
    deeds |= {usual(skill, other) for other in Emotion if other is not mood} - {usual(skill, mood)}
    return tuple(
        sorted(
            caption
            for (of, caption), moods in shares.items()
            if of is skill
            and (caption not in deeds or (skill is Skill.SITDOWN and caption == usual(skill, mood)))
            and not re.search("phone|to the front|hips|sidestep|hands supporting head", caption)
            and moods.get(mood, 0.0) >= _MIN_SHARE
        )
    )
