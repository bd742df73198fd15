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
_SAME_FEELING, _OTHER_FEELING, _NO_FEELING = 0.12, -0.08, -0.02
_THEME_ROOM, _OWN_ROOM = 0.03, 0.08
_FURNITURE: Final = 0.08
_DEED, _REELING = 0.06, -0.3
_DRINK: Final = re.compile(r"\b(?:drink|drank|drunk|wine|beer|whisk|bottle|bar\b|alcohol|party)", re.IGNORECASE)
_DEEDS: Final = {
    Skill.SITDOWN: r"sits?|sat|sitting|seated|rests?|resting",
    Skill.LIEDOWN: r"lies|lie|lying|lay|sleeps?|asleep|naps?|naptime|rests?|resting",
}


@dataclass(frozen=True)
class Wish:
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


def suitability(wishes: Sequence[Wish], scores: Scores, traits: Traits, limits: Limits) -> Scores:
    """Nearness in meaning, raised or lowered by feeling, rooms and furniture. (wishes, scripts).

    What is not near enough or not allowed is at -10.
    """
    raised = np.stack([raises(wish, traits, limits) for wish in wishes])
    nearest = np.array([[wish.nearest] for wish in wishes])
    total: Scores = np.where(scores >= nearest, scores + raised, NEVER)
    if limits.rooms:
        total[:, ~traits.in_rooms(limits.rooms)] = NEVER
    return total


def raises(wish: Wish, traits: Traits, limits: Limits) -> Scores:
    """By how much feeling, rooms and furniture raise or lower each script for an event. (scripts,)."""
    favoured = np.where(traits.in_rooms(limits.favoured), _THEME_ROOM, 0.0)
    return _feeling(wish, traits) + _room(wish, traits) + _things(wish, traits) + favoured


def _feeling(wish: Wish, traits: Traits) -> Scores:
    if wish.emotion is None:
        return np.zeros(len(traits))
    other = np.where(
        traits.of_emotion("neutral"), _NO_FEELING, _OTHER_FEELING if wish.emotion != "neutral" else _NO_FEELING
    )
    return np.where(traits.of_emotion(wish.emotion), _SAME_FEELING, other) * wish.certainty


def _room(wish: Wish, traits: Traits) -> Scores:
    return np.where(traits.in_rooms((wish.room,) if wish.room else ()), _OWN_ROOM, 0.0)


def _things(wish: Wish, traits: Traits) -> Scores:
    """Whether a script uses a piece of furniture that the event names, and sits or lies where the event does.

    A drunk is only met where the event is about drinking: reeling about is too much of a surprise elsewhere.
    """
    total = np.where(traits.using(furniture_in(wish.text)), _FURNITURE, 0.0)
    total += np.where(traits.doing(deeds_in(wish.text)), _DEED, 0.0)
    if wish.emotion != "drunk" and not _DRINK.search(wish.text):
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
