"""How well short scripts suit an event: nearness in meaning, raised or lowered by feeling, room and furniture."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from motion_backend.motion import Skill
from planner_service.scripts.traits import Scores, Traits
from scene_graphs import furniture

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
