"""One pass over a script that keeps track of the body, notes what it cannot do, and mends that (SIMS 3.4)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, Generic, TypeVar

from motion_backend.motion import Posture, Skill
from planner_service.scripts.emotions import emotion_of
from planner_service.scripts.keyframe import EMOTIONS, Keyframe
from scene_graphs import furniture

K = TypeVar("K", bound=Keyframe)
Place = tuple[str | None, str, int]
"""Room, furniture and instance; two words for one kind of furniture are one place."""

NEEDS: Final = {Skill.SITDOWN: "sit", Skill.LIEDOWN: "lie", Skill.TOUCH: "touch"}
"""What an object must afford for a skill."""
RISES: Final = {Posture.SEATED: (Skill.STANDUP, "stand up"), Posture.LYING: (Skill.GETUP, "get up")}
WALKS: Final = {
    "neutral": "smoothly forward walk",
    "happy": "excited walk",
    "angry": "angrily walking",
    "hurried": "rush anxiously forward",
    "tired": "head bowed and body bent while walking",
    "sad": "walk with depression",
    "stressed": "walking slowly, hands behind back",
    "drunk": "walking drunkenly",
    "relaxed": "smoothly forward walk",
}
"""The caption of a connecting walk, by emotion."""
STAND_INS: Final = {
    "sit": ("chair", "armchair", "sofa", "bed", "coffee table"),
    "lie": ("bed", "sofa"),
    "touch": ("table", "cabinet", "shelf", "wardrobe", "nightstand", "tv stand", "floor lamp", "chair", "sofa", "bed"),
}
"""Furniture that affords it, the usual first."""
_NO_WAY_TO_GO: Final = re.compile(r"\b(spin|danc|pacing|sidestep|tap )", re.IGNORECASE)


@dataclass(frozen=True)
class Problem:
    """One thing that keeps a script from being acted out, and what repairing does about it."""

    keyframe: int
    """Index in the script that was read."""
    field: str
    """skill, emotion or furniture."""
    fault: str
    remedy: str

    def __str__(self) -> str:
        return f"keyframe {self.keyframe}: {self.fault}; {self.remedy}"


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


class Mending(Generic[K]):
    """The script as it can be acted out (`kept`), what was wrong (`problems`) and how the body is left (`posture`)."""

    def __init__(self, keyframes: Sequence[K]) -> None:
        self.kept: list[K] = []
        self.problems: list[Problem] = []
        self.posture = Posture.STANDING
        self._resting: K | None = None
        self._at: Place | None = None
        for index, keyframe in enumerate(self._words(keyframes)):
            self._take(index, keyframe)
        self.problems.sort(key=lambda problem: problem.keyframe)

    def _note(self, index: int, field: str, fault: str, remedy: str) -> None:
        self.problems.append(Problem(index, field, fault, remedy))

    # First the words: furniture that is known and fits, emotions that are known.

    def _words(self, keyframes: Sequence[K]) -> list[K]:
        """Each keyframe with furniture that affords its skill; a walk goes where the keyframe after it went."""
        mended = [self._emotion(index, keyframe) for index, keyframe in enumerate(keyframes)]
        for index, keyframe in enumerate(keyframes):
            if keyframe.skill in NEEDS:
                mended[index] = self._fitting(index, mended)
        for index, keyframe in enumerate(keyframes):
            if keyframe.skill is Skill.LOCO and not is_floor(keyframe.piece[0]):
                replaced = self._replaced_after(index, keyframes, mended)
                if replaced is not None:
                    mended[index] = mended[index].model_copy(update={"furniture": replaced})
                elif not furniture.is_known(keyframe.piece[0]):
                    self._note(index, "furniture", _unknown(keyframe), "walks about instead")
                    mended[index] = mended[index].model_copy(update={"furniture": "floor"})
        return mended

    def _replaced_after(self, index: int, keyframes: Sequence[K], mended: Sequence[K]) -> str | None:
        """The furniture that took the place of a walk's target in the keyframe it leads to."""
        if index + 1 == len(keyframes) or place_of(keyframes[index + 1]) != place_of(keyframes[index]):
            return None
        after = mended[index + 1].furniture
        return after if after != keyframes[index + 1].furniture else None

    def _emotion(self, index: int, keyframe: K) -> K:
        if emotion_of(keyframe.emotion) is not None:
            return keyframe
        fault = f'the emotion "{keyframe.emotion}" is none of {", ".join(EMOTIONS)} and no word for one'
        self._note(index, "emotion", fault, "acted as neutral")
        return keyframe.model_copy(update={"emotion": "neutral"})

    def _fitting(self, index: int, keyframes: Sequence[K]) -> K:
        keyframe, need = keyframes[index], NEEDS[keyframes[index].skill]
        word = keyframe.piece[0]
        known = is_floor(word) or furniture.is_known(word)
        if known and affords(word, need):
            return keyframe
        instead = self._stand_in(index, keyframes, need) if known else STAND_INS[need][0]
        fault = f"nobody can {need} {'the' if need == 'touch' else 'on the'} {word}" if known else _unknown(keyframe)
        self._note(index, "furniture", fault, f"uses the {instead} instead")
        return keyframe.model_copy(update={"furniture": instead})

    def _stand_in(self, index: int, keyframes: Sequence[K], need: str) -> str:
        """The nearest furniture that affords it: of the same class, of the same group, else used nearby, else usual."""
        word = keyframes[index].piece[0]
        for kinship in (furniture.class_of, furniture.group_of):
            for candidate in STAND_INS[need]:
                if not is_floor(word) and kinship(candidate) == kinship(word):
                    return candidate
        for other in sorted(range(len(keyframes)), key=lambda other: (abs(other - index), other)):
            used = keyframes[other]
            if not is_floor(used.piece[0]) and furniture.is_known(used.piece[0]) and affords(used.piece[0], need):
                return used.furniture
        return STAND_INS[need][0]

    # Then the order: what the body can do from where it is.

    def _take(self, index: int, keyframe: K) -> None:
        if self.kept and _alike(self.kept[-1], keyframe):
            self._note(index, "skill", f"{_told(keyframe)} is there twice", "kept once")
        elif keyframe.skill in (Skill.STANDUP, Skill.GETUP):
            self._rise(index, keyframe)
        elif keyframe.skill is Skill.LOCO:
            self._be_standing(index, keyframe)
            self._at = None if is_floor(keyframe.piece[0]) else place_of(keyframe)
            self.kept.append(keyframe)
        else:
            self._use(index, keyframe)

    def _rise(self, index: int, keyframe: K) -> None:
        """Rising starts from rest, from the object rested on; the paper's tables write "floor" there."""
        if self._resting is None:
            self._note(index, "skill", f"{_told(keyframe)} while already standing", "left out")
            return
        if self.posture is Posture.LYING and keyframe.skill is Skill.STANDUP:
            self._note(index, "skill", "standup from lying", "getup instead")
            keyframe = keyframe.model_copy(update={"skill": Skill.GETUP, "caption": "get up"})
        if place_of(keyframe) != place_of(self._resting):
            fault = f"{keyframe.skill} from the {keyframe.furniture} while resting on the {self._resting.furniture}"
            self._note(index, "furniture", fault, f"rises from the {self._resting.furniture}")
            update = {"furniture": self._resting.furniture, "room": getattr(self._resting, "room", None)}
            keyframe = keyframe.model_copy(update=_fields(keyframe, update))
        self._stand(keyframe)

    def _stand(self, keyframe: K) -> None:
        self.kept.append(keyframe)
        self._at = None if is_floor(keyframe.piece[0]) else place_of(keyframe)
        self.posture, self._resting = Posture.STANDING, None

    def _be_standing(self, index: int, keyframe: K) -> None:
        """Put in the rising that is missing before a keyframe that needs the body on its feet."""
        if self._resting is None:
            return
        skill, caption = RISES[self.posture]
        furniture_word = self._resting.furniture
        self._note(index, "skill", f"{_told(keyframe)} while {self.posture} on the {furniture_word}", f"{skill} put in")
        update = {"skill": skill, "caption": caption, "emotion": "neutral, calm", "short_script": None}
        self._stand(self._resting.model_copy(update=_fields(keyframe, update)))

    def _use(self, index: int, keyframe: K) -> None:
        """Sit, lie or touch: on one's feet and beside the object, or from sitting to lying on the same one."""
        place = place_of(keyframe)
        lies_back = keyframe.skill is Skill.LIEDOWN and self.posture is Posture.SEATED
        if not (lies_back and self._resting is not None and place_of(self._resting) == place):
            self._be_standing(index, keyframe)
            if self._at != place and not is_floor(keyframe.piece[0]):
                self._note(index, "skill", f"{_told(keyframe)} without a walk to it", "loco put in")
                self.kept.append(self._walk(keyframe))
                self._at = place
        self.kept.append(keyframe)
        if keyframe.skill is not Skill.TOUCH:
            self.posture = Posture.SEATED if keyframe.skill is Skill.SITDOWN else Posture.LYING
            self._resting = keyframe

    def _walk(self, keyframe: K) -> K:
        """A connecting walk to a keyframe's object, in the manner of the walk just before, else of the mood."""
        before = next((k for k in reversed(self.kept) if _same_script(k, keyframe)), None)
        if before is not None and before.skill is Skill.LOCO and not _NO_WAY_TO_GO.search(before.caption):
            caption, emotion = before.caption, before.emotion
        else:
            moods = [emotion_of(k.emotion) for k in (keyframe, *reversed(self.kept)) if _same_script(k, keyframe)]
            emotion = next((mood for mood in moods if mood not in (None, "neutral")), None) or "neutral"
            caption = WALKS[emotion]
        update = {"skill": Skill.LOCO, "caption": caption, "emotion": emotion, "short_script": None}
        return keyframe.model_copy(update=_fields(keyframe, update))


def _fields(keyframe: Keyframe, update: dict[str, Any]) -> dict[str, Any]:
    """The part of an update that this kind of keyframe has."""
    return {name: value for name, value in update.items() if name in type(keyframe).model_fields}


def _same_script(one: Keyframe, other: Keyframe) -> bool:
    return getattr(one, "event", None) == getattr(other, "event", None)


def _alike(one: Keyframe, other: Keyframe) -> bool:
    return place_of(one) == place_of(other) and (one.skill, one.emotion, one.caption) == (
        other.skill,
        other.emotion,
        other.caption,
    )


def _told(keyframe: Keyframe) -> str:
    return f"{keyframe.skill} ({keyframe.furniture})"


def _unknown(keyframe: Keyframe) -> str:
    return f'the furniture word "{keyframe.furniture}" is not known'
