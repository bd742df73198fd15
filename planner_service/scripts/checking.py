"""Whether a body can act a script out, and the smallest changes after which it can: Valid and Executable."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from typing import Any, Final, TypeVar

from motion_backend.motion import Posture, Skill
from planner_service.scripts.captions import Vocabulary
from planner_service.scripts.fitting import Problem, phone_hand
from planner_service.scripts.keyframe import Keyframe, LongScript, ShortScript
from planner_service.scripts.mending import Mending

K = TypeVar("K", bound=Keyframe)

_ALIASES: Final = {
    Skill.LOCO: "walk walking run running go move locomotion pace wander approach",
    Skill.SITDOWN: "sit seat sitting take_a_seat",
    Skill.STANDUP: "stand standing rise",
    Skill.GETUP: "arise get_out_of_bed",
    Skill.LIEDOWN: "lie lay lying laydown recline sleep",
    Skill.TOUCH: "reach reaching grab take pick pick_up press push open reach_for",
}
_SKILLS: Final = {skill.value: skill for skill in Skill} | {
    word.replace("_", ""): skill for skill, words in _ALIASES.items() for word in words.split()
}


def check(
    script: ShortScript | LongScript | Sequence[Keyframe],
    vocabulary: Vocabulary | None = None,
    furniture: Collection[str] | None = None,
) -> tuple[Problem, ...]:
    """Everything that keeps the script from being acted out, in order; empty when it can be.

    With a `vocabulary` captions must be known, without one they are free words for the body to read; `furniture` are
    the categories a home has, any if not given. After a problem the script is read on as if that had been repaired,
    so that one fault is told once.
    """
    keyframes = script.keyframes if isinstance(script, ShortScript | LongScript) else script
    return tuple(Mending(keyframes, vocabulary, furniture).problems)


def repair(
    keyframes: Sequence[K], vocabulary: Vocabulary | None = None, furniture: Collection[str] | None = None
) -> tuple[tuple[K, ...], tuple[str, ...]]:
    """Keyframes that pass `check` with the same arguments, and what was changed and why, one sentence a change.

    Unknown or unfit furniture is replaced, and with a `vocabulary` unknown captions by the nearest known ones; walks
    and risings that are missing are put in; a touch leaves the hand alone that holds a phone; what cannot happen
    (rising while standing, the same keyframe twice) is left out. What passes is returned unchanged.
    """
    mending = Mending(keyframes, vocabulary, furniture)
    return tuple(mending.kept), tuple(map(str, mending.problems))


def last_posture(keyframes: Sequence[Keyframe]) -> Posture:
    """How the body is left when the script ends."""
    return Mending(keyframes).posture


def skill_of(word: str) -> Skill:
    """The skill a word means ("walk" is loco), or ValueError listing the skills."""
    skill = _SKILLS.get(_plain(word))
    if skill is None:
        raise ValueError(f"skill: {word!r} is none of {', '.join(Skill)}, nor a word for one of them")
    return skill


def read_keyframe(row: Mapping[str, Any]) -> Keyframe:
    """A keyframe from loose words ("walk", "emotion/style", "furnitures"), or pydantic's ValidationError."""
    word = row.get("skill")
    return Keyframe.model_validate({**row, "skill": _SKILLS.get(_plain(word), word)} if isinstance(word, str) else row)


def hand_of(caption: str, default: str = "right") -> str:
    """The hand a touch uses, "left" or "right": the one its caption names last, else `default`."""
    named: list[str] = re.findall(r"\b(left|right)\b", caption.lower())
    return named[-1] if named else default


def free_hand(before: Keyframe | None) -> str:
    """The hand a touch may use where its caption names none: "left" after a walk with the phone in the right hand."""
    return "left" if before is not None and phone_hand(before) == "right" else "right"


def _plain(word: str) -> str:
    return re.sub(r"[\s_-]+", "", word.lower())
