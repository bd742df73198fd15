"""One pass over a script that keeps track of the body, notes what it cannot do, and mends that (SIMS 3.4)."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from typing import Final, Generic, TypeVar

from motion_backend.motion import Posture, Skill
from planner_service.scripts.captions import Vocabulary, sides
from planner_service.scripts.emotions import emotion_of
from planner_service.scripts.fitting import (
    Fitting,
    Place,
    Problem,
    affords,
    fields,
    is_floor,
    other_hand,
    phone_hand,
    place_of,
)
from planner_service.scripts.keyframe import Keyframe
from planner_service.scripts.usual import WALKS

K = TypeVar("K", bound=Keyframe)
RISES: Final = {Posture.SEATED: (Skill.STANDUP, "stand up"), Posture.LYING: (Skill.GETUP, "get up")}
_NO_WAY_TO_GO: Final = re.compile(r"\b(spin|danc|pacing|sidestep|tap |still|wav|to the front)", re.IGNORECASE)


class Mending(Generic[K]):
    """The script as it can be acted out (`kept`), what was wrong (`problems`) and how the body is left (`posture`)."""

    def __init__(
        self,
        keyframes: Sequence[K],
        vocabulary: Vocabulary | None = None,
        furniture: Collection[str] | None = None,
    ) -> None:
        self.kept: list[K] = []
        self.problems: list[Problem] = []
        self.posture = Posture.STANDING
        self._resting: K | None = None
        self._at: Place | None = None
        self._fitting = Fitting[K](self._note, vocabulary, furniture)
        for index, keyframe in enumerate(self._fitting.fit(keyframes)):
            self._take(index, keyframe)
        self.problems.sort(key=lambda problem: problem.keyframe)

    def _note(self, index: int, field: str, fault: str, remedy: str) -> None:
        self.problems.append(Problem(index, field, fault, remedy))

    def _take(self, index: int, keyframe: K) -> None:
        if self.kept and _alike(self.kept[-1], keyframe):
            self._note(index, "skill", f"{_told(keyframe)} is there twice", "kept once")
        elif keyframe.skill is Skill.TOUCH and not self._can_touch(keyframe.piece[0]):
            self._note(index, "furniture", f"the home has nothing to touch, no {keyframe.furniture}", "left out")
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
            keyframe = keyframe.model_copy(update=fields(keyframe, update))
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
        self._stand(self._resting.model_copy(update=fields(keyframe, update)))

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
        self.kept.append(self._with_a_free_hand(index, keyframe))
        if keyframe.skill is not Skill.TOUCH:
            self.posture = Posture.SEATED if keyframe.skill is Skill.SITDOWN else Posture.LYING
            self._resting = keyframe

    def _can_touch(self, word: str) -> bool:
        return affords(word, "touch") and self._fitting.has(word)

    def _with_a_free_hand(self, index: int, keyframe: K) -> K:
        """A touch straight after a walk with the phone in that hand uses the other one."""
        holding = phone_hand(self.kept[-1]) if self.kept and keyframe.skill is Skill.TOUCH else None
        if holding is None or sides(keyframe.caption) != {holding}:
            return keyframe
        fault = f'"{keyframe.caption}" while the {holding} hand holds the phone'
        return self._fitting.caption(index, keyframe, other_hand(keyframe.caption, holding), fault)

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
        return keyframe.model_copy(update=fields(keyframe, update))


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
