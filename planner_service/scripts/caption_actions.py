"""What a caption says is done and held, besides how the body looks: LINGO's grasp and interaction steps (appendix C).

Such a caption is "what; how": "pick up the cup with the left hand; pick up with the left hand", or "turn on the TV,
watch TV; hands behind head, legs straight". The part behind the last semicolon is a caption like any other, and all
that the body is told.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final

from motion_backend.motion import Action, Skill

MAX_CAPTION_LENGTH: Final = 200
GRASPING: Final = 0.6
"""Seconds that a hand stays longer on what it takes or lays down."""
DOING: Final = 2.5
"""Seconds that a pose is held longer for each thing done in it."""
MAX_HOLD_SECONDS: Final = 12.0
"""LINGO's longest motion (B.2.3), in seconds."""
_TAKEN: Final = re.compile(r"^(?:pick up|take|grab|get|fetch|grasp|hold|lift|bring|carry) (?P<thing>.+)$")
_LAID: Final = re.compile(r"^(?:put(?: down| back| away)?|place|set(?: down)?|lay|drop|return) (?P<thing>.+)$")
_WITH: Final = re.compile(r"^(?:the |an? |my |your |his |her |their )|\s+(?:with|in|from|on|onto|into|to|at|off)\b.*$")


def caption_of(done: Sequence[str], how: str) -> str:
    """The caption of things done in a pose."""
    return f"{', '.join(done)}; {how}"


def done_in(caption: str) -> tuple[str, ...]:
    """What is done, thing after thing; empty for a caption that only says how the body looks."""
    return tuple(part.strip() for part in caption.rpartition(";")[0].split(",") if part.strip())


def look_of(caption: str) -> str:
    """How the body looks, without what is done; the whole caption where that is all it says."""
    return caption.rpartition(";")[2].strip() or caption


@dataclass
class Hands:
    """What is held as the actions of a script follow one another."""

    things: list[str] = field(default_factory=list)

    def follow(self, action: Action, done: Sequence[str]) -> Action:
        """The action with what is held and done in it, and held for longer where that takes time."""
        grasps = [text for text in done if self._grasp(text)]
        rest = [text for text in done if text not in grasps]
        hold = action.hold
        if action.skill in (Skill.TOUCH, Skill.SITDOWN, Skill.LIEDOWN):
            hold = min(hold + GRASPING * len(grasps) + DOING * len(rest), max(hold, MAX_HOLD_SECONDS))
        return replace(action, holds=", ".join(self.things) or None, interaction=", ".join(rest) or None, hold=hold)

    def _grasp(self, text: str) -> bool:
        """Take or lay down what a text speaks of; whether it does."""
        if (match := _TAKEN.match(text)) is not None:
            thing = _WITH.sub("", match["thing"]).strip()
            self.things = [*(held for held in self.things if held != thing), thing]
        elif (match := _LAID.match(text)) is not None:
            thing = _WITH.sub("", match["thing"]).strip()
            self.things = [held for held in self.things if held != thing]
        return match is not None
