"""Whether a caption says anything that the word tables of this body know."""

from __future__ import annotations

import re
from typing import Final

from motion_backend.motion import Emotion, Skill
from motion_backend.procedural.lie.lie_styles import lie_style
from motion_backend.procedural.sit.sit_styles import sit_style
from motion_backend.procedural.touch.hand_captions import handling_of, with_both_hands
from motion_backend.procedural.walk.walk_styles import walk_style
from scene_graphs import furniture

_PLAIN: Final = {
    Skill.LOCO: r"\b(?:walk|step|mov|com|go)(?:s|es|e|ing)?\b",
    Skill.SITDOWN: r"\bs[ia]t(?:s|ting)?\b|\bseated\b",
    Skill.STANDUP: r"\b(?:stand|get|ris)(?:s|es|e|ing)?\b",
    Skill.GETUP: r"\b(?:stand|get|ris)(?:s|es|e|ing)?\b",
    Skill.LIEDOWN: r"\b(?:lie|lying|lay)s?\b",
    Skill.TOUCH: r"\b(?:touch|reach|low|medium|high)(?:es|ing)?\b|\b(?:left|right) hand\b",
}
"""What says no more than the skill does: the body does it as it usually does."""
_SMALL: Final = re.compile(
    r"\b(?:a|an|the|to|on|onto|in|into|at|of|for|with|and|up|down|out|over|around|through|towards?|"
    r"his|her|their|it|room|coffee|dining|office|side|double|single|there|here)\b|[^a-z]+"
)


def understands(skill: Skill, caption: str) -> bool:
    """Whether the body's tables have a word of the caption, or it only names the skill and furniture."""
    text = caption.lower()
    match skill:
        case Skill.LOCO:
            known = walk_style(Emotion.NEUTRAL, text) != walk_style(Emotion.NEUTRAL, "")
        case Skill.SITDOWN:
            known = sit_style(Emotion.NEUTRAL, text) != sit_style(Emotion.NEUTRAL, "")
        case Skill.LIEDOWN:
            known = lie_style(Emotion.NEUTRAL, text) != lie_style(Emotion.NEUTRAL, "")
        case Skill.TOUCH:
            return bool(handling_of(text) or with_both_hands(text) or re.search(_PLAIN[skill], text))
        case _:
            return re.search(_PLAIN[skill], text) is not None
    left = _SMALL.sub(" ", re.sub(_PLAIN[skill], " ", text)).split()
    return known or all(furniture.is_known(word) for word in left)
