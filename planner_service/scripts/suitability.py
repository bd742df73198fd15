"""How well short scripts suit an event: nearness in meaning, raised or lowered by feeling, room and furniture.

What of every short script counts besides its meaning are arrays (`Traits`) that are made once a library.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from motion_backend.motion import Skill
from planner_service.scripts.script import EMOTIONS, ShortScript
from scene_graphs import furniture
from scene_graphs.furniture import ROOM_TYPES

Mask = NDArray[np.bool_]
Codes = NDArray[np.intp]
Scores = NDArray[np.float64]

_NOBODY: Final = np.zeros(0, dtype=np.intp)


class Before(IntEnum):
    """What must have been, for a script to begin as it does."""

    ANYTHING = 0
    ASLEEP = 1
    """It begins with waking."""
    AWAY = 2
    """It begins with coming home."""


class After(IntEnum):
    """How a script leaves the character."""

    ABOUT = 0
    ASLEEP = 1
    AWAY = 2
    """Out of the house."""


_WAKES: Final = re.compile(
    r"\b(?:wakes?|waking|woken|alarm (?:clock )?(?:rings|goes)|gets? out of bed|jolts? upright)\b"
)
_ARRIVES: Final = re.compile(r"\b(?:(?:comes?|gets?|arrives?|returns?|back|coming) (?:back )?home|comes? in from)\b")
_LEAVES: Final = re.compile(
    r"\b(?:leaves? (?:the house|home|for)|sets? off|out of the (?:door|house)|heads? out|goes out)\b"
)
_SLEEPS: Final = re.compile(r"\b(?:asleep|sleeps?|dozes? off|drifts? off|naps?|nods? off|passes out)\b")
_SLEEPLESS: Final = re.compile(r"\b(?:cannot|can't|unable|no|not|without|hardly|sleepless|awake)\b")


class Traits:
    """Arrays over N scripts, in their order."""

    def __init__(self, scripts: Sequence[ShortScript]) -> None:
        self.emotions: Codes = _codes(EMOTIONS.index(script.emotion) for script in scripts)
        self.rooms: Codes = _codes(ROOM_TYPES.index(script.room) for script in scripts)
        self.runs: Codes = _numbered(_run(script) for script in scripts)
        """The same number for scripts with the same keyframes."""
        self.before: Codes = _codes(before_of(script) for script in scripts)
        self.after: Codes = _codes(after_of(script) for script in scripts)
        self._count = len(scripts)
        self._using = _owners(scripts, lambda script: {name for k in script.keyframes for name in _kinds(k.piece[0])})
        self._doing = _owners(scripts, lambda script: {keyframe.skill for keyframe in script.keyframes})

    def __len__(self) -> int:
        return self._count

    def of_emotion(self, emotion: str) -> Mask:
        """Scripts of an emotion. (N,)."""
        return np.asarray(self.emotions == EMOTIONS.index(emotion))

    def in_rooms(self, rooms: Iterable[str]) -> Mask:
        """Scripts that play in one of these room types. (N,)."""
        return np.isin(self.rooms, [ROOM_TYPES.index(room) for room in rooms])

    def using(self, categories: Iterable[str]) -> Mask:
        """Scripts that use furniture of any of these categories. (N,)."""
        return self._any(self._using, categories)

    def doing(self, skills: Iterable[Skill]) -> Mask:
        """Scripts with a keyframe of any of these skills. (N,)."""
        return self._any(self._doing, skills)

    def _any(self, owners: dict[Any, Codes], names: Iterable[Any]) -> Mask:
        mask = np.zeros(self._count, dtype=np.bool_)
        for name in names:
            mask[owners.get(name, _NOBODY)] = True
        return mask


def before_of(script: ShortScript) -> Before:
    """What a script's first sentence takes for granted."""
    first = re.split(r"(?<=[.!?])\s", script.summary.lower(), maxsplit=1)[0]
    if _WAKES.search(first):
        return Before.ASLEEP
    return Before.AWAY if _ARRIVES.search(first) else Before.ANYTHING


def after_of(script: ShortScript) -> After:
    """How a script ends: on a bed in sleep, out of the house, or neither."""
    last = re.split(r"(?<=[.!?])\s", script.summary.lower())[-1]
    if script.keyframes[-1].skill is Skill.LIEDOWN and _SLEEPS.search(last) and not _SLEEPLESS.search(last):
        return After.ASLEEP
    return After.AWAY if _LEAVES.search(last) else After.ABOUT


def _run(script: ShortScript) -> tuple[object, ...]:
    return tuple((keyframe.skill, keyframe.caption, keyframe.furniture) for keyframe in script.keyframes)


@cache
def _kinds(word: str) -> frozenset[str]:
    return frozenset(furniture.categories_of(word))


def _codes(values: Iterable[int]) -> Codes:
    return np.array(list(values), dtype=np.intp)


def _numbered(values: Iterable[object]) -> Codes:
    numbers: dict[object, int] = {}
    return _codes(numbers.setdefault(value, len(numbers)) for value in values)


def _owners(scripts: Sequence[ShortScript], names_of: Callable[[ShortScript], set[Any]]) -> dict[Any, Codes]:
    """For each name, the scripts that have it."""
    owners: dict[Any, list[int]] = {}
    for index, script in enumerate(scripts):
        for name in names_of(script):
            owners.setdefault(name, []).append(index)
    return {name: _codes(found) for name, found in owners.items()}


NEVER: Final = -10.0
"""What may not be chosen."""
_SAME_FEELING, _OTHER_FEELING, _NO_FEELING, _OPPOSITE_FEELING = 0.12, -0.08, -0.02, -0.2
_OPPOSITES: Final = {"happy": ("sad", "angry"), "sad": ("happy",), "angry": ("happy",)}
"""A defeat is no victory, however near in meaning they are."""
_THEME_ROOM, _OWN_ROOM = 0.03, 0.08
_FURNITURE: Final = 0.08
_DEED, _REELING = 0.06, -0.3
_DRINK: Final = re.compile(r"\b(?:drink|drank|drunk|wine|beer|whisk|bottle|bar\b|alcohol|party)", re.IGNORECASE)
_DEEDS: Final = {
    Skill.SITDOWN: r"sits?|sat|sitting|seated|rests?|resting",
    Skill.LIEDOWN: r"lies|lie|lying|lay|sleeps?|asleep|naps?|naptime|rests?|resting",
}


@dataclass(frozen=True)
class Demand:
    """What an event asks of a short script."""

    text: str
    emotion: str | None
    """None when nothing is known of it."""
    certainty: float
    """How much the emotion counts, 0 to 1."""
    nearest: float
    """Scores below this are no match."""
    room: str | None = None
    """The room the event itself names."""


@dataclass(frozen=True)
class Limits:
    """What may be chosen from."""

    rooms: tuple[str, ...] = ()
    """Room types allowed; empty for all."""
    favoured: tuple[str, ...] = ()
    """Room types the theme names."""


def suitability(demands: Sequence[Demand], scores: Scores, traits: Traits, limits: Limits) -> Scores:
    """Nearness in meaning, raised or lowered by feeling, rooms and furniture. (demands, scripts).

    What is not near enough or not allowed is at -10.
    """
    raised = np.stack([raises(demand, traits, limits) for demand in demands])
    nearest = np.array([[demand.nearest] for demand in demands])
    total: Scores = np.where(scores >= nearest, scores + raised, NEVER)
    if limits.rooms:
        total[:, ~traits.in_rooms(limits.rooms)] = NEVER
    return total


def raises(demand: Demand, traits: Traits, limits: Limits) -> Scores:
    """By how much feeling, rooms and furniture raise or lower each script for an event. (scripts,)."""
    favoured = np.where(traits.in_rooms(limits.favoured), _THEME_ROOM, 0.0)
    return _feeling(demand, traits) + _room(demand, traits) + _things(demand, traits) + favoured


def _feeling(demand: Demand, traits: Traits) -> Scores:
    if demand.emotion is None:
        return np.zeros(len(traits))
    other = np.where(
        traits.of_emotion("neutral"), _NO_FEELING, _OTHER_FEELING if demand.emotion != "neutral" else _NO_FEELING
    )
    for opposite in _OPPOSITES.get(demand.emotion, ()):
        other = np.where(traits.of_emotion(opposite), _OPPOSITE_FEELING, other)
    return np.where(traits.of_emotion(demand.emotion), _SAME_FEELING, other) * demand.certainty


def _room(demand: Demand, traits: Traits) -> Scores:
    return np.where(traits.in_rooms((demand.room,) if demand.room else ()), _OWN_ROOM, 0.0)


def _things(demand: Demand, traits: Traits) -> Scores:
    """Whether a script uses a piece of furniture that the event names, and sits or lies where the event does.

    A drunk is only met where the event is about drinking: reeling about is too much of a surprise elsewhere.
    """
    total = np.where(traits.using(furniture_in(demand.text)), _FURNITURE, 0.0)
    total += np.where(traits.doing(deeds_in(demand.text)), _DEED, 0.0)
    if demand.emotion != "drunk" and not _DRINK.search(demand.text):
        total += np.where(traits.of_emotion("drunk"), _REELING, 0.0)
    return total


@cache
def deeds_in(text: str) -> frozenset[Skill]:
    """Sitting and lying that a text tells of."""
    return frozenset(skill for skill, words in _DEEDS.items() if re.search(rf"\b(?:{words})\b", text, re.IGNORECASE))


@cache
def furniture_in(text: str) -> frozenset[str]:
    """Categories of the furniture a text names ("rests on the sofa")."""
    words = re.findall(r"[a-z]+", text.lower())
    phrases = [*words, *(f"{one} {two}" for one, two in itertools.pairwise(words))]
    named = [phrase for phrase in phrases if furniture.is_known(phrase) and furniture.group_of(phrase) != "decor"]
    return frozenset[str]().union(*(furniture.categories_of(phrase) for phrase in named))
