"""Whether a body can act a script out, and the smallest changes after which it can: Valid and Executable.

One pass over a script keeps track of the body, notes what it cannot do, and mends that (SIMS 3.4).
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final, Generic, TypeVar

from motion_backend.motion import RISINGS, Emotion, Posture, Skill
from planner_service.scripts.caption_fallbacks import usual
from planner_service.scripts.captions import Vocabulary, sides
from planner_service.scripts.script import Keyframe, LongScript, ShortScript
from planner_service.scripts.script_words import (
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

K = TypeVar("K", bound=Keyframe)
RISES: Final = {Posture.SEATED: (Skill.STANDUP, "stand up"), Posture.LYING: (Skill.GETUP, "get up")}
_LEFT_OUT: Final = "left out"
NO_WAY_TO_GO: Final = re.compile(r"\b(spin|danc|pacing|sidestep|tap |still|wav|to the front)", re.IGNORECASE)


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
        self.places: list[int] = []
        """Of every keyframe that was read, where it stands in `kept`; left out: the one before, or -1."""
        self.posture = Posture.STANDING
        self._resting: K | None = None
        self._at: Place | None = None
        self._fitting = Fitting[K](self._note, vocabulary, furniture)
        for index, keyframe in enumerate(self._fitting.fit(keyframes)):
            self._take(index, keyframe)
            self.places.append(len(self.kept) - 1)
        self.problems.sort(key=lambda problem: problem.keyframe)

    def _note(self, index: int, field: str, fault: str, remedy: str) -> None:
        self.problems.append(Problem(index, field, fault, remedy))

    def _take(self, index: int, keyframe: K) -> None:
        if self.kept and _alike(self.kept[-1], keyframe):
            self._note(index, "skill", f"{_told(keyframe)} is there twice", "kept once")
        elif keyframe.skill is Skill.TOUCH and not self._can_touch(keyframe.piece[0]):
            self._note(index, "furniture", f"the home has nothing to touch, no {keyframe.furniture}", _LEFT_OUT)
        elif getattr(keyframe, "already", False):
            self._begin(index, keyframe)
        elif keyframe.skill in RISINGS:
            self._rise(index, keyframe)
        elif keyframe.skill is Skill.LOCO:
            self._be_standing(index, keyframe)
            self._at = None if is_floor(keyframe.piece[0]) else place_of(keyframe)
            self.kept.append(keyframe)
        else:
            self._use(index, keyframe)

    def _begin(self, index: int, keyframe: K) -> None:
        """Who rests when the story begins has not come there in it."""
        if self.kept or keyframe.skill not in (Skill.SITDOWN, Skill.LIEDOWN):
            self._note(index, "already", f"{_told(keyframe)} is not how the story begins", "done there")
            self._take(index, keyframe.model_copy(update={"already": False}))
        else:
            self._rest(keyframe)

    def _rise(self, index: int, keyframe: K) -> None:
        """Rising starts from rest, from the object rested on; the paper's tables write "floor" there."""
        if self._resting is None:
            self._note(index, "skill", f"{_told(keyframe)} while already standing", _LEFT_OUT)
            return
        if self.posture is Posture.LYING and keyframe.skill is Skill.STANDUP:
            self._note(index, "skill", "stand up from lying", "get up instead")
            keyframe = keyframe.model_copy(update={"skill": Skill.GETUP, "caption": "get up"})
        if place_of(keyframe) != place_of(self._resting):
            fault = (
                f"{keyframe.skill.words} from the {keyframe.furniture} while resting on the {self._resting.furniture}"
            )
            self._note(index, "furniture", fault, f"rises from the {self._resting.furniture}")
            update: dict[str, Any] = {"furniture": self._resting.furniture}
            update |= {name: getattr(self._resting, name, None) for name in ("room", "object_id")}
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
        self._note(
            index, "skill", f"{_told(keyframe)} while {self.posture} on the {furniture_word}", f"{skill.words} put in"
        )
        update: dict[str, Any] = {"skill": skill, "caption": caption, "emotion": keyframe.emotion, "also": ()}
        update |= {"short_script": None, "already": False}
        update |= {"beat": getattr(keyframe, "beat", None)}  # rising leads to what comes next
        self._stand(self._resting.model_copy(update=fields(keyframe, update)))

    def _use(self, index: int, keyframe: K) -> None:
        """Sit, lie or touch: on one's feet and beside the object, or without leaving the one that is rested on."""
        place = place_of(keyframe)
        stays = keyframe.skill is not Skill.TOUCH and self.posture is not Posture.STANDING
        if not (stays and self._resting is not None and place_of(self._resting) == place):
            self._be_standing(index, keyframe)
            if self._at != place and not is_floor(keyframe.piece[0]):
                self._note(index, "skill", f"{_told(keyframe)} without a walk to it", "walk put in")
                self.kept.append(self._walk(keyframe))
                self._at = place
        if keyframe.skill is Skill.TOUCH:
            self.kept.append(self._with_a_free_hand(index, keyframe))
        else:
            self._rest(keyframe)

    def _rest(self, keyframe: K) -> None:
        self.kept.append(keyframe)
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
        if before is not None and before.skill is Skill.LOCO and not NO_WAY_TO_GO.search(before.caption):
            caption, emotion = before.caption, before.emotion
        else:
            moods = [k.mood for k in (keyframe, *reversed(self.kept)) if _same_script(k, keyframe)]
            mood = next((mood for mood in moods if mood is not Emotion.NEUTRAL), Emotion.NEUTRAL)
            caption, emotion = usual(Skill.LOCO, mood), mood.value
        update = {"skill": Skill.LOCO, "caption": caption, "emotion": emotion, "short_script": None, "also": ()}
        return keyframe.model_copy(update=fields(keyframe, update))


def _same_script(one: Keyframe, other: Keyframe) -> bool:
    return getattr(one, "beat", None) == getattr(other, "beat", None)


def _alike(one: Keyframe, other: Keyframe) -> bool:
    """Whether two keyframes that follow each other are one; who stood still may stand at a window for the next beat."""
    beats = [getattr(keyframe, "beat", None) for keyframe in (one, other)]
    if one.skill is Skill.LOCO and beats[0] != beats[1]:
        return False
    same = all(getattr(one, name) == getattr(other, name) for name in ("skill", "emotion", "caption", "held"))
    return same and place_of(one) == place_of(other)


def _told(keyframe: Keyframe) -> str:
    return f"{keyframe.skill.words} ({keyframe.furniture})"


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
    """Keyframes that pass `check` with the same arguments, and what was changed and why, one sentence a change, with
    the numbers of the keyframes as they are then.

    Unknown or unfit furniture is replaced, and with a `vocabulary` unknown captions by the nearest known ones; walks
    and risings that are missing are put in; a touch leaves the hand alone that holds a phone; what cannot happen
    (rising while standing, the same keyframe twice) is left out. What passes is returned unchanged.
    """
    mending = Mending(keyframes, vocabulary, furniture)
    return tuple(mending.kept), tuple(_renumbered(problem, mending.places) for problem in mending.problems)


def _renumbered(problem: Problem, places: Sequence[int]) -> str:
    """What was repaired, at the keyframe that is now there."""
    number = places[problem.keyframe]
    told = str(replace(problem, keyframe=max(number, 0)))
    return f"{'before' if number < 0 else 'after'} {told}" if problem.remedy == _LEFT_OUT else told


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
