"""How long a pose is held where the theme says that it lasts: "waits", "stares at it for a long while"."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Final

from motion_backend.motion import Action, Skill

LONGER: Final = 3.0
"""Seconds more for what lasts."""
_WAITS: Final = re.compile(r"\bwait(?:s|ed|ing)?\b(?! (?:on|no|a moment))", re.IGNORECASE)
_LASTS: Final = re.compile(
    r"\bfor (?:a |an )?(?:very |quite )?(?:long (?:while|time|moment)|while|hour)\b"
    r"|\bfor (?:hours|ages|minutes|(?:two|three|four|five|ten|twenty|thirty) (?:minutes|hours)|the rest of)\b"
    r"|\ball (?:day|night|evening|morning|afternoon)\b|\buntil\b|\bmotionless\b|\bwithout moving\b|\bforever\b",
    re.IGNORECASE,
)
_STILL: Final = re.compile(r"\b(?:motionless|without moving|still|frozen|patiently)\b", re.IGNORECASE)
FEELS: Final = 4.5
"""Seconds for which who cries or is out of breath does so, at least."""
_FEELS: Final = re.compile(r"^(?:crying|panting)\b")
STANDS, WAITS = "stand still", "stand still, waiting"
"""Who waits on their feet shifts from leg to leg, looks about and at the watch."""


def lingering(action: Action, said: str) -> Action:
    """The action, held longer where the theme's words for it say that it lasts, and done as who waits where they say
    so; a walk or a touch is not."""
    if action.skill is Skill.SITDOWN and _FEELS.search(action.caption):
        action = replace(action, hold=max(action.hold, FEELS))
    if not (_WAITS.search(said) or _LASTS.search(said)):
        return action
    if _WAITS.search(said) and action.caption == STANDS and not _STILL.search(said):
        action = replace(action, caption=WAITS)
    if action.skill in (Skill.SITDOWN, Skill.LIEDOWN) or (action.skill is Skill.LOCO and action.goal is None):
        return replace(action, hold=action.hold + LONGER)
    return replace(action, stands=action.stands + LONGER) if action.stands else action
