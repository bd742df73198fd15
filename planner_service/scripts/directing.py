"""A long script straight from the events, by rules and without the library: the baseline of SIMS 10."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from motion_backend.motion import Skill
from planner_service.scripts.keyframe import Event, PlannedKeyframe
from planner_service.scripts.mending import NEEDS, WALKS, affords
from scene_graphs import furniture

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
    Skill.TOUCH: "touch medium height",
}
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


def direct_by_rules(events: Sequence[Event]) -> tuple[PlannedKeyframe, ...]:
    """Each event walked in its mood and, where its words tell of one, done at one piece of furniture.

    Not yet repaired: rising is left to `checking.repair`.
    """
    keyframes: list[PlannedKeyframe] = []
    for index, event in enumerate(events):
        walk = WALKS.get(event.emotion, WALKS["neutral"])
        skill = next((deed for deed, words in _DEEDS if re.search(rf"\b(?:{words})", event.text, re.IGNORECASE)), None)
        word = _furniture(event.text, skill) if skill is not None else "floor"
        keyframes.append(_keyframe(Skill.LOCO, event.emotion, walk, word, index))
        if skill is not None:
            caption = _POSES.get(skill, {}).get(event.emotion, _PLAIN[skill])
            keyframes.append(_keyframe(skill, event.emotion, caption, word, index))
    return tuple(keyframes)


def _furniture(text: str, skill: Skill) -> str:
    """The furniture the text names, if the skill works there, else the usual one."""
    named = [word for word in re.findall(r"[a-z]+", text.lower()) if furniture.is_known(word)]
    return next((word for word in named if affords(word, NEEDS[skill])), _USUAL[skill])


def _keyframe(skill: Skill, emotion: str, caption: str, word: str, event: int) -> PlannedKeyframe:
    return PlannedKeyframe.model_validate(
        {"skill": skill, "emotion": emotion, "caption": caption, "furniture": word, "event": event}
    )
