"""A long script straight from the events, by rules and without the library: the baseline of SIMS 10."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from motion_backend.motion import Emotion, Skill
from planner_service.scripts.caption_fallbacks import usual
from planner_service.scripts.script import Beat, PlannedKeyframe
from planner_service.scripts.script_words import NEEDS, affords
from scene_graphs import furniture

_DEEDS: Final = (
    (Skill.LIEDOWN, r"sleep|nap|lie|lies|lying|bed|doze|collapse|rest"),
    (Skill.SITDOWN, r"sit|seat|read|watch|eat|write|study|work|think|ponder|reflect|relax|enjoy|wait|cry|weep|depress"),
    (
        Skill.TOUCH,
        r"drink|search|look|find|take|grab|reach|open|dress|clean|cook|phone|call|pick|celebrate|wash|choose",
    ),
)
"""What somebody does at home, by the words of an event; the first that fits."""
_USUAL: Final = {Skill.LIEDOWN: "sofa", Skill.SITDOWN: "armchair", Skill.TOUCH: "table"}


def direct_by_rules(events: Sequence[Beat]) -> tuple[PlannedKeyframe, ...]:
    """Each event walked in its mood and, where its words tell of one, done at one piece of furniture.

    Not yet repaired: rising is left to `script_repair.repair`.
    """
    keyframes: list[PlannedKeyframe] = []
    for index, event in enumerate(events):
        skill = next((deed for deed, words in _DEEDS if re.search(rf"\b(?:{words})", event.text, re.IGNORECASE)), None)
        word = _furniture(event.text, skill) if skill is not None else "floor"
        keyframes.append(_keyframe(Skill.LOCO, event.emotion, word, index))
        if skill is not None:
            keyframes.append(_keyframe(skill, event.emotion, word, index))
    return tuple(keyframes)


def _furniture(text: str, skill: Skill) -> str:
    """The furniture the text names, if the skill works there, else the usual one."""
    named = [word for word in re.findall(r"[a-z]+", text.lower()) if furniture.is_known(word)]
    return next((word for word in named if affords(word, NEEDS[skill])), _USUAL[skill])


def _keyframe(skill: Skill, emotion: Emotion, word: str, event: int) -> PlannedKeyframe:
    caption = usual(skill, emotion)
    return PlannedKeyframe.model_validate(
        {"skill": skill, "emotion": emotion, "caption": caption, "furniture": word, "beat": event}
    )
