"""Whether a caption says anything that the word tables of this body know."""

from __future__ import annotations

import re
from typing import Final

from motion_backend.motion import Emotion, Skill
from motion_backend.procedural.lie.lie_styles import lie_style
from motion_backend.procedural.sit.sit_styles import sit_style
from motion_backend.procedural.touch.hand_captions import handling_of, with_both_hands
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.props.prop_table import held_in
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


_BODY: Final = re.compile(
    r"^(?:hands?|arms?|legs?|knees?|feet|foot|head|elbows?|fingers?|palms?|left|right|both|still|body)$"
)
"""Words that say of what the others are said; without them those mean something else, or the same."""


def understands(skill: Skill, caption: str) -> bool:
    """Whether the body's tables have a word of the caption, or it only names the skill and furniture."""
    text = caption.lower()
    if skill is Skill.TOUCH:
        return bool(handling_of(text) or with_both_hands(text) or re.search(_PLAIN[skill], text))
    if skill not in _STYLES:
        return re.search(_PLAIN[skill], text) is not None
    left = _SMALL.sub(" ", re.sub(_PLAIN[skill], " ", text)).split()
    return _seen(skill, text) != _seen(skill, "") or all(furniture.is_known(word) for word in left)


def unread(skill: Skill, caption: str) -> tuple[str, ...]:
    """The words of a caption that change nothing of what is seen, neither the body nor what is in its hands; of those
    that say more than skill, furniture and limbs."""
    text = caption.lower()
    words = [word for word in _SMALL.sub(" ", re.sub(_PLAIN[skill], " ", text)).split() if not _BODY.match(word)]
    whole = _seen(skill, text), held_in(skill, text)
    return tuple(
        word for word in dict.fromkeys(words)
        if not furniture.is_known(word)
        and (_seen(skill, less := re.sub(rf"\b{word}\b", "", text)), held_in(skill, less)) == whole
    )  # fmt: skip


_STYLES: Final = {Skill.LOCO: walk_style, Skill.SITDOWN: sit_style, Skill.LIEDOWN: lie_style}


def _seen(skill: Skill, text: str) -> object:
    """What the tables make of words: two that are seen alike are equal."""
    if skill in _STYLES:
        return _STYLES[skill](Emotion.NEUTRAL, text)
    return (handling_of(text), with_both_hands(text)) if skill is Skill.TOUCH else None
