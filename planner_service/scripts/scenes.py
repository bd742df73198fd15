"""The parts of a long script as a teller sees them: scenes, and how much of an event a sentence tells."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import groupby

from motion_backend.motion import Skill
from planner_service.scripts.keyframe import LongScript, PlannedKeyframe
from planner_service.scripts.tense import stem

_ASLEEP = re.compile(r"\b(?:fell (?:fast )?asleep|went to sleep|(?:took|into) a nap|dozed off|nodded off|passed out)\b")
_PALE_WORDS = """
come comes came goes going went gone make makes made take takes took
all and are but can did for get gets had has her him his its not off out said say says she tell tells the told too was
who again about after becom befor begin chara decid feels felt from gets herse himse into over perso some start that
their then thems this very when with
"""
_PALE = frozenset(_PALE_WORDS.split())
"""Words, or their first five letters, that say nothing about what happens."""
_ON_SEAT = re.compile(
    r"\b(?:(?:on|in|into|onto) (?:an?|the|his|her|their)(?: \w+)? (?:\w*chair|sofa|couch|loveseat|bench|stool)"
    r"|(?:on|in|into|onto|to) (?:(?:an?|the|his|her|their) )?bed)\b"
)
_FINDS = re.compile(r"\b(?:finds?|found) (?!that\b|out\b|no\b|it\b|he\b|she\b|they\b|\w*self\b)")
_DOES = frozenset(("eat", "drink", "write", "type", "read", "play", "listen", "talk"))
"""Deeds that a posture's caption tells."""
_ON_FOOT = frozenset(("run", "dance", "pace", "stroll", "skip", "march", "stomp"))
"""Deeds that a walk's caption tells."""
RESTS = (Skill.SITDOWN, Skill.LIEDOWN)
_RISES = (Skill.STANDUP, Skill.GETUP)


@dataclass(frozen=True)
class Scene:
    """Keyframes that one short script put in, or one event where there are no short scripts."""

    script: int | None
    """Index into the long script's short scripts."""
    event: int | None
    keyframes: tuple[tuple[int, PlannedKeyframe], ...]
    """With their indices in the long script."""

    def sleeps(self, told: str) -> bool:
        """Whether the telling speaks of sleep and the body rests: sleep is then told after the last rest."""
        own = [k.skill for _, k in self.keyframes if k.short_script is not None or self.script is None]
        return bool(_ASLEEP.search(told)) and any(skill in RESTS for skill in own)

    def tells(self, told: str) -> tuple[Skill, ...]:
        """The skills of the scene's keyframes that tell what the telling speaks of too: a rest, what is done at it, or
        a way to walk; none where they tell something else."""
        seats = [keyframe.caption for _, keyframe in self.keyframes if keyframe.skill in RESTS]
        if seats and (_ON_SEAT.search(told) or deeds_in(told) & deeds_in(" ".join(seats))):
            return RESTS
        walks = " ".join(k.caption for _, k in self.keyframes if k.skill == Skill.LOCO and k.on_floor)
        return (Skill.LOCO,) if deeds_in(" ".join(told.split()[:2])) & deeds_in(walks) & _ON_FOOT else ()


def finds(summary: str) -> bool:
    """Whether a summary tells of something found, which the body has to reach for first."""
    return bool(_FINDS.search(summary))


def deeds_in(text: str) -> frozenset[str]:
    """What a text says is done that captions tell as well, in base form."""
    return (_DOES | _ON_FOOT) & {stem(word) for word in re.findall(r"[a-z]+", text.lower())}


def scenes_of(script: LongScript) -> list[Scene]:
    """The scenes in order; connecting keyframes go with what follows them, but rising ends the scene before."""
    keyframes = script.keyframes
    owners: list[tuple[int | None, int | None]] = [(k.short_script, k.event) for k in keyframes]
    bridging = [k.short_script is None and bool(script.short_scripts) for k in keyframes]
    for index in reversed(range(len(keyframes) - 1)):
        if bridging[index]:
            owners[index] = owners[index + 1]
    for index in range(1, len(keyframes)):
        trailing = bridging[index] and (keyframes[index].skill in _RISES or all(bridging[index:]))
        if trailing:
            owners[index] = owners[index - 1]
    runs = groupby(enumerate(keyframes), key=lambda row: owners[row[0]])
    return [Scene(owner[0], owner[1], tuple(run)) for owner, run in runs]


def covered(event: str, summary: str) -> float:
    """Share of an event's content words that the summary has too; 1 when it has no content words."""
    wanted, had = _stems(event), _stems(summary)
    return len(wanted & had) / len(wanted) if wanted else 1.0


def _stems(text: str) -> set[str]:
    words = re.findall(r"[a-z]{3,}", text.lower())
    return {stem(word)[:5] for word in words if word not in _PALE and word[:5] not in _PALE}
