"""The captions that the body and the narrator know, other words for them, and the known one nearest to any other.

Furniture and captions as prompts tell language models what they may choose from.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import resources
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from motion_backend.language.sentence_encoder import SentenceEncoder, Vectors
from motion_backend.motion import Skill
from scene_graphs.furniture import catalogue, display_name

NEAR: Final = {"hashing": 0.4}
"""By encoder, where it is not `USUALLY_NEAR`: hashed words score lower."""
USUALLY_NEAR: Final = 0.5
"""Below this score nothing known means the same: the usual caption of skill and mood is better."""
PHONE: Final = re.compile(r"phone.*\b(left|right)\b|\b(left|right)\b.*phone", re.IGNORECASE)
_SIDES: Final = re.compile(r"\b(?:(left|right)|(?:both|two) (?:hands|arms|palms|elbows|fists|legs|knees|feet))\b")
_WORD: Final = re.compile(r"[^\W_]+")


def captions() -> dict[str, list[str]]:
    """The captions that the body and the narrator know, by skill."""
    known: dict[str, list[str]] = _read("captions.json")
    return known


def synonyms() -> dict[str, dict[str, list[str]]]:
    """Five other ways to say every known caption, by skill and caption; same meaning, same hands and sides."""
    others: dict[str, dict[str, list[str]]] = _read("caption_synonyms.json")
    return others


def sides(caption: str) -> frozenset[str]:
    """The sides that a caption names: "left", "right", "both"."""
    return frozenset(match[1] or "both" for match in _SIDES.finditer(caption.lower()))


def agree(one: str, other: str) -> bool:
    """Whether two captions may mean one thing as far as left and right go: the same sides, or one names none."""
    return not sides(one) or not sides(other) or sides(one) == sides(other)


class Vocabulary:
    """Known captions and what is near to them in meaning; sentences are encoded when they are first needed."""

    def __init__(
        self,
        known: Mapping[str, Sequence[str]],
        other_words: Mapping[str, Mapping[str, Sequence[str]]],
        encoder: SentenceEncoder,
    ) -> None:
        self._known = {Skill(skill): tuple(some) for skill, some in known.items()}
        self._encoder = encoder
        self._says: dict[Skill, list[tuple[str, str]]] = {
            skill: [
                (text, caption) for caption in some for text in (caption, *other_words.get(skill, {}).get(caption, ()))
            ]
            for skill, some in self._known.items()
        }
        self._vectors: dict[Skill, Vectors] = {}
        self.least = NEAR.get(encoder.name, USUALLY_NEAR)
        """The score from which on the nearest caption may stand for another."""

    @classmethod
    def built_in(cls, encoder: SentenceEncoder) -> Self:
        """The captions that ship with the service."""
        return cls(captions(), synonyms(), encoder)

    def known(self, skill: Skill, caption: str) -> bool:
        """Whether it is one of the captions for this skill, letter for letter."""
        return caption in self._known.get(skill, ())

    def nearest(self, skill: Skill, caption: str) -> tuple[str, float]:
        """The known caption of a skill that is nearest in meaning, and how near (cosine, 1 for its own words).

        Left never becomes right, nor one hand both. Of equally near ones the first of the list. Raises ValueError for
        a skill without captions or without one whose sides agree.
        """
        says = self._says.get(skill, [])
        allowed = self._allowed(skill, caption)
        if not allowed:
            raise ValueError(f"caption: no caption of {skill} has the sides of {caption!r}; add one to the vocabulary")
        plain = _plain(caption)
        for place in allowed:
            if _plain(says[place][0]) == plain:
                return says[place][1], 1.0
        scores = self._scores(skill, caption, allowed)
        best = int(np.argmax(scores))
        return says[allowed[best]][1], float(scores[best])

    def near(self, skill: Skill, caption: str) -> list[str]:
        """The known captions of a skill that may stand for another, the nearest in meaning first; none where its sides
        are those of no caption."""
        allowed = self._allowed(skill, caption)
        scores = self._scores(skill, caption, allowed) if allowed else np.zeros(0)
        order = [int(place) for place in np.argsort(-scores, kind="stable") if scores[place] >= self.least]
        return list(dict.fromkeys(self._says[skill][allowed[place]][1] for place in order))

    def _allowed(self, skill: Skill, caption: str) -> list[int]:
        """Places of what is said of a skill whose sides agree with a caption's."""
        return [place for place, (_, known) in enumerate(self._says.get(skill, [])) if agree(caption, known)]

    def _scores(self, skill: Skill, caption: str, places: Sequence[int]) -> NDArray[np.float64]:
        """How near a caption is to what is said there (cosine). (places,)."""
        if skill not in self._vectors:
            self._vectors[skill] = self._encoder.encode([text for text, _ in self._says[skill]])
        asked = self._encoder.encode([caption])[0].astype(np.float64)
        scores: NDArray[np.float64] = np.round(self._vectors[skill][places].astype(np.float64) @ asked, 4)
        return scores


def _plain(text: str) -> tuple[str, ...]:
    return tuple(_WORD.findall(text.lower()))


@cache
def _text(name: str) -> str:
    return resources.files("planner_service").joinpath("data", name).read_text(encoding="utf-8")


def _read(name: str) -> Any:
    return json.loads(_text(name))


def furniture_offered() -> str:
    """Every furniture word there is, between commas."""
    return ", ".join(sorted({display_name(word) for word in catalogue().class_of}))


def captions_offered(most: int | None = None) -> str:
    """A line a skill with its captions between semicolons, the first so many of them."""
    return "\n".join(f"  {skill}: {'; '.join(known[:most])}" for skill, known in captions().items())
