"""The words of a script: emotions, furniture and captions that are known and fit, and what is put in their place."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import Any, Final, Generic, TypeVar

from motion_backend.emotion_words import emotion_of
from motion_backend.motion import Skill, moment
from planner_service.scripts.caption_fallbacks import usual
from planner_service.scripts.captions import PHONE, Vocabulary, sides
from planner_service.scripts.script import EMOTIONS, Keyframe
from scene_graphs import furniture

K = TypeVar("K", bound=Keyframe)
Place = tuple[str | None, str, int]
"""Room, furniture and instance; two words for one kind of furniture are one place."""

NEEDS: Final = {Skill.SITDOWN: "sit", Skill.LIEDOWN: "lie", Skill.TOUCH: "touch"}
"""What an object must afford for a skill."""
STAND_INS: Final = {
    "sit": ("chair", "armchair", "sofa", "bed", "coffee table"),
    "lie": ("bed", "sofa"),
    "touch": ("table", "cabinet", "shelf", "wardrobe", "nightstand", "tv stand", "floor lamp", "chair", "sofa", "bed"),
}
"""Furniture that affords it, the usual first."""


@dataclass(frozen=True)
class Problem:
    """One thing that keeps a script from being acted out, and what repairing does about it."""

    keyframe: int
    """Index in the script that was read."""
    field: str
    """skill, emotion, caption or furniture."""
    fault: str
    remedy: str

    def __str__(self) -> str:
        return f"{moment(self.keyframe)}: {self.fault}; {self.remedy}"


Note = Callable[[int, str, str, str], None]
"""Takes the four fields of a `Problem`."""


def is_floor(word: str) -> bool:
    """Whether a furniture word means no furniture."""
    return word.strip().lower() in ("floor", "ground")


def affords(word: str, need: str) -> bool:
    """Whether to "sit", "lie" or "touch" works there; the floor affords sitting and lying."""
    return need in ("sit", "lie") if is_floor(word) else need in furniture.affordances(word)


def place_of(keyframe: Keyframe) -> Place:
    """Where a keyframe happens, so that two keyframes can be compared."""
    word, instance = keyframe.piece
    return getattr(keyframe, "room", None), "floor" if is_floor(word) else furniture.canonical(word), instance


def phone_hand(keyframe: Keyframe) -> str | None:
    """The hand that holds the phone in a walk, "left" or "right", where its caption says so."""
    found = PHONE.search(keyframe.caption) if keyframe.skill is Skill.LOCO else None
    return (found[1] or found[2]).lower() if found else None


class Fitting(Generic[K]):
    """The words of keyframes as they should be; whatever is wrong is told to `note`.

    `vocabulary` and `home`, the categories of furniture there are, are asked for only where they are given.
    """

    def __init__(self, note: Note, vocabulary: Vocabulary | None = None, home: Collection[str] | None = None) -> None:
        self._note = note
        self._vocabulary = vocabulary
        self._home = None if home is None else tuple(sorted({furniture.canonical(word) for word in home}))

    def fit(self, keyframes: Sequence[K]) -> list[K]:
        """Each keyframe with furniture that affords its skill; a walk goes where the keyframe after it went."""
        fitted = [self._captioned(index, self._emotion(index, keyframe)) for index, keyframe in enumerate(keyframes)]
        for index, keyframe in enumerate(keyframes):
            if keyframe.skill in NEEDS:
                fitted[index] = self._furnished(index, fitted)
        for index, keyframe in enumerate(keyframes):
            if keyframe.skill is Skill.LOCO and not is_floor(keyframe.piece[0]):
                fitted[index] = self._leading(index, keyframes, fitted)
        return fitted

    def has(self, word: str) -> bool:
        """Whether the home has such furniture: the same, or of the same kind; the floor is everywhere."""
        if self._home is None or is_floor(word):
            return True
        kinds = furniture.categories_of(word)
        return any(not kinds.isdisjoint(furniture.categories_of(category)) for category in self._home)

    def caption(self, index: int, keyframe: K, caption: str, fault: str) -> K:
        """The keyframe with another caption, or the usual one where that is not known either."""
        if self._vocabulary is not None and not self._vocabulary.known(keyframe.skill, caption):
            caption = usual(keyframe.skill, keyframe.mood, caption)
        self._note(index, "caption", fault, f'"{caption}" instead')
        return keyframe.model_copy(update={"caption": caption})

    def _emotion(self, index: int, keyframe: K) -> K:
        if emotion_of(keyframe.emotion) is not None:
            return keyframe
        fault = f'the emotion "{keyframe.emotion}" is none of {", ".join(EMOTIONS)} and no word for one'
        self._note(index, "emotion", fault, "acted as neutral")
        return keyframe.model_copy(update={"emotion": "neutral"})

    def _captioned(self, index: int, keyframe: K) -> K:
        """With the nearest known caption, or the usual one of skill and mood where none is near."""
        words, skill, caption = self._vocabulary, keyframe.skill, keyframe.caption
        if words is None or words.known(skill, caption):
            return keyframe
        instead, score = words.nearest(skill, caption)
        remedy = f'"{instead}" is nearest ({score:.2f})'
        common = usual(skill, keyframe.mood, caption)
        if score < words.least and words.known(skill, common):
            instead, remedy = common, f'nothing known is near it ({score:.2f}): "{common}" as usual'
        one_and_both = " names one side and both, and" if "both" in sides(caption) and len(sides(caption)) > 1 else ""
        self._note(index, "caption", f'"{caption}"{one_and_both} is no caption known for {skill.words}', remedy)
        return keyframe.model_copy(update={"caption": instead})

    def _furnished(self, index: int, keyframes: Sequence[K]) -> K:
        keyframe, need = keyframes[index], NEEDS[keyframes[index].skill]
        word = keyframe.piece[0]
        known = is_floor(word) or furniture.is_known(word)
        if known and affords(word, need) and self.has(word):
            return keyframe
        if not known:
            fault = unknown(keyframe)
        elif affords(word, need):
            fault = f"the home has no {word}"
        else:
            fault = f"nobody can {need} {'the' if need == 'touch' else 'on the'} {word}"
        usually = (*STAND_INS[need], *(self._home or ()))
        at_home = [one for one in usually if furniture.is_known(one) and affords(one, need) and self.has(one)]
        if not at_home and need == "touch":
            return keyframe
        instead = self._stand_in(index, keyframes, need, at_home) if known and at_home else [*at_home, "floor"][0]
        self._note(index, "furniture", fault, f"uses the {instead} instead")
        return keyframe.model_copy(update={"furniture": instead})

    def _stand_in(self, index: int, keyframes: Sequence[K], need: str, at_home: Sequence[str]) -> str:
        """The nearest furniture that affords it: of the same class, of the same group, else used nearby, else usual."""
        word = keyframes[index].piece[0]
        for kinship in (furniture.class_of, furniture.group_of):
            for candidate in at_home:
                if not is_floor(word) and kinship(candidate) == kinship(word):
                    return candidate
        for other in sorted(range(len(keyframes)), key=lambda other: (abs(other - index), other)):
            used = keyframes[other].piece[0]
            if not is_floor(used) and furniture.is_known(used) and affords(used, need) and self.has(used):
                return keyframes[other].furniture
        return at_home[0]

    def _leading(self, index: int, keyframes: Sequence[K], fitted: Sequence[K]) -> K:
        """A walk to what the keyframe after it uses now, or about the room where there is no such thing."""
        walk, word = fitted[index], keyframes[index].piece[0]
        replaced = _replaced_after(index, keyframes, fitted)
        if replaced is not None:
            return walk.model_copy(update={"furniture": replaced})
        if furniture.is_known(word) and self.has(word):
            return walk
        fault = f"the home has no {word}" if furniture.is_known(word) else unknown(walk)
        self._note(index, "furniture", fault, "walks about instead")
        return walk.model_copy(update={"furniture": "floor"})


def _replaced_after(index: int, keyframes: Sequence[Keyframe], fitted: Sequence[Keyframe]) -> str | None:
    """The furniture that took the place of a walk's target in the keyframe it leads to."""
    if index + 1 == len(keyframes) or place_of(keyframes[index + 1]) != place_of(keyframes[index]):
        return None
    after = fitted[index + 1].furniture
    return after if after != keyframes[index + 1].furniture else None


def fields(keyframe: Keyframe, update: dict[str, Any]) -> dict[str, Any]:
    """The part of an update that this kind of keyframe has."""
    return {name: value for name, value in update.items() if name in type(keyframe).model_fields}


def unknown(keyframe: Keyframe) -> str:
    """The fault of a furniture word that nobody knows."""
    return f'the furniture word "{keyframe.furniture}" is not known'


def other_hand(caption: str, hand: str) -> str:
    """The caption with the other hand than "left" or "right"."""
    return re.sub(rf"\b{hand}\b", "left" if hand == "right" else "right", caption, flags=re.IGNORECASE)
