"""Which short script plays which event: nearness in meaning, feeling, room and furniture, no script twice."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from scipy.optimize import linear_sum_assignment

from motion_backend.motion import Skill
from planner_service.scripts.keyframe import ShortScript
from planner_service.scripts.library import Scores
from scene_graphs import furniture

NEAR_TIE: Final = 0.08
"""Scripts this close together are as good as each other: the seed chooses."""
_SAME_FEELING, _OTHER_FEELING, _NO_FEELING = 0.12, -0.08, -0.02
_THEME_ROOM, _OWN_ROOM, _NEXT_ROOM = 0.03, 0.08, 0.05
_FURNITURE: Final = 0.08
_DEED, _REELING = 0.06, -0.3
_DRINK: Final = re.compile(r"\b(?:drink|drank|drunk|wine|beer|whisk|bottle|bar\b|alcohol|party)", re.IGNORECASE)
_NEVER: Final = -10.0
_DEEDS: Final = {
    Skill.SITDOWN: r"sits?|sat|sitting|seated|rests?|resting",
    Skill.LIEDOWN: r"lies|lie|lying|lay|sleeps?|asleep|naps?|naptime|rests?|resting",
}


@dataclass(frozen=True)
class Wish:
    """What an event asks of a short script."""

    text: str
    emotion: str
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


@dataclass(frozen=True)
class Cast:
    """What of a short script counts besides its meaning."""

    emotion: str
    room: str
    furniture: frozenset[str]
    """Categories it uses."""
    skills: frozenset[Skill]

    @classmethod
    def of(cls, script: ShortScript) -> Cast:
        """What counts of this script."""
        words = {keyframe.piece[0] for keyframe in script.keyframes}
        used = frozenset[str]().union(*map(furniture.categories_of, words))
        return cls(script.emotion, script.room, used, frozenset(keyframe.skill for keyframe in script.keyframes))


def suitability(wishes: Sequence[Wish], scores: Scores, scripts: Sequence[ShortScript], limits: Limits) -> Scores:
    """Nearness in meaning, raised or lowered by feeling, rooms and furniture. (wishes, scripts).

    What is not near enough or not allowed is at -10.
    """
    casts = [Cast.of(script) for script in scripts]
    feelings = np.array([[_feeling(wish, one) for one in casts] for wish in wishes])
    rooms = np.array([[_room(wish, one, limits) for one in casts] for wish in wishes])
    things = np.array([[_things(wish, one) for one in casts] for wish in wishes])
    allowed = np.array([not limits.rooms or script.room in limits.rooms for script in scripts])
    nearest = np.array([[wish.nearest] for wish in wishes])
    total = scores + feelings + rooms + things
    return np.where((scores >= nearest) & allowed, total, _NEVER)


def cast(suits: Scores, scripts: Sequence[ShortScript], seed: int) -> list[int | None]:
    """The script for each row, None where nothing suits: the best sum over all rows, near ties broken by the seed.

    No script, and no two scripts with the same keyframes, are taken twice; scripts in the room of the scripts around
    them are preferred.
    """
    noise = np.stack(
        [np.random.default_rng([seed, row]).uniform(0, NEAR_TIE, suits.shape[1]) for row in range(len(suits))]
    )
    first = _assign(suits + noise, scripts)
    bonus = np.zeros_like(suits)
    rooms = np.array([script.room for script in scripts])
    for row in range(len(suits)):
        around = {
            scripts[chosen].room
            for chosen in (*first[max(0, row - 1) : row], *first[row + 1 : row + 2])
            if chosen is not None
        }
        for room in around:
            bonus[row, rooms == room] = _NEXT_ROOM
    return _assign(suits + noise + bonus, scripts)


def _assign(suits: Scores, scripts: Sequence[ShortScript]) -> list[int | None]:
    """The assignment with the largest sum; scripts with the same keyframes stand as one column."""
    columns: dict[tuple[object, ...], list[int]] = {}
    for index, script in enumerate(scripts):
        columns.setdefault(_run(script), []).append(index)
    members = list(columns.values())
    best = np.stack([suits[:, group].max(axis=1) for group in members], axis=1)  # (rows, distinct scripts)
    nobody = np.full((len(suits), len(suits)), _NEVER / 2)
    rows, chosen = linear_sum_assignment(np.hstack([best, nobody]), maximize=True)
    found: list[int | None] = [None] * len(suits)
    for row, column in zip(rows, chosen, strict=True):
        if column < len(members):
            found[row] = max(members[column], key=lambda index: float(suits[row, index]))
    return found


def _run(script: ShortScript) -> tuple[object, ...]:
    return tuple((keyframe.skill, keyframe.caption, keyframe.furniture) for keyframe in script.keyframes)


def _feeling(wish: Wish, script: Cast) -> float:
    if script.emotion == wish.emotion:
        return _SAME_FEELING * wish.certainty
    return (_NO_FEELING if "neutral" in (script.emotion, wish.emotion) else _OTHER_FEELING) * wish.certainty


def _room(wish: Wish, script: Cast, limits: Limits) -> float:
    own = _OWN_ROOM if wish.room == script.room else 0.0
    return own + (_THEME_ROOM if script.room in limits.favoured else 0.0)


def _things(wish: Wish, script: Cast) -> float:
    """Whether the script uses a piece of furniture that the event names, and sits or lies where the event does.

    A drunk is only met where the event is about drinking: reeling about is too much of a surprise elsewhere.
    """
    same = furniture_in(wish.text) & script.furniture
    done = deeds_in(wish.text) & script.skills
    surprise = script.emotion == "drunk" and wish.emotion != "drunk" and not _drinking(wish.text)
    return (_FURNITURE if same else 0.0) + (_DEED if done else 0.0) + (_REELING if surprise else 0.0)


@cache
def _drinking(text: str) -> bool:
    return _DRINK.search(text) is not None


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
