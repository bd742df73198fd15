"""Which beats of a theme its keyframes show: as they were planned, and once the body has done them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

from motion_backend.motion import RISINGS, Does, Emotion, Skill
from planner_service.scripts.script import REACTED, WISHED, Beat, Keyframe, LongScript, PlannedKeyframe
from planner_service.scripts.script_words import is_floor
from planner_service.scripts.still_things import still_in
from scene_graphs.json_fields import Json

UNDONE: Final = "left undone, as the theme asks"
IN_ITS_PLACE: Final = "the body is seen doing something else in its place"
"""Why what is only stood for is not acted."""
AT_THE: Final = "at the"
IN_PLACE_OF: Final = " in place of the "
"""Words of a note on hands that are at another piece than the theme names, before and after that."""
ACTED: Final = "acted: the body is seen doing it"
STANDS: Final = f"something stands for it: {IN_ITS_PLACE}"
NOT_SHOWN: Final = "not shown: words that the body does not show"
LEFT_UNDONE: Final = "left undone: the theme says it is not done"
"""What is meant by the words of `ActedBeats.lines`."""
FELT: Final = 1.5
"""Seconds that a mood must be on the screen to be seen."""
RESTS: Final = re.compile(
    r"(?:(?:takes?|took|has|have|had) )?an? (?:\w+ )?(?:nap|sleep|doze|snooze|siesta|lie-down|rest)\b"
    r"|(?:\w+ly )?(?:sits?|sat|lies|lie|lay|settles?|sinks?|flops?|drops?|slumps?|curls?|perch(?:es)?|collapses?|rests?"
    r"|stays?|sleeps?|slept|naps?|dozes?|nods? off|f(?:a|e)lls? asleep|goes to (?:sleep|bed)"
    r"|takes? (?:a|his|her|their|the) (?:seat|place))\b"
    r"(?!.*\b(?:and|with|to|hands?|arms?|elbows?|chin|head|\w{2,}ing)\b)",
    re.IGNORECASE,
)
"""A beat that says no more than that somebody sits, lies or sleeps somewhere: arms and legs are not its matter."""
OF_LIMBS: Final = re.compile(r"\b(?:hands?|arms?|knees?|foot|feet)\b")
"""Words of a note (`Motion.notes`) on nothing but arms and legs."""
_OF_HANDS: Final = re.compile(r"\b(?:hands?|arms?)\b")
_OPEN_ARMS: Final = "open arms"
"""Of a note on how somebody walks."""
_TELLS_LEGS: Final = re.compile(
    r"\b(?:legs?|knees?|foot|feet|stretch\w*|kneel\w*|knelt|sit-ups?|push-ups?|exercis\w*|yoga)\b"
)
"""Words of a beat whose matter legs are."""


def connects(keyframe: Keyframe) -> bool:
    """Whether it only leads to what is done next: a walk to a piece of furniture, or a rising."""
    return leads(keyframe.skill, keyframe.furniture)


def leads(skill: Skill, furniture: str) -> bool:
    """The same of a keyframe's words."""
    return skill in RISINGS or (skill is Skill.LOCO and not is_floor(furniture))


@dataclass(frozen=True)
class Shot:
    """What of a keyframe says whether its beats are acted."""

    beats: tuple[int, ...]
    """Indices of the beats it serves."""
    mood: Emotion
    connects: bool
    """Whether it only leads to what is done next."""
    reached: bool | None = None
    """None while it has not been moved."""
    reason: str = ""
    """Why it was not reached."""
    seconds: float = 0.0
    """How long it is on the screen."""
    otherwise: tuple[str, ...] = ()
    """What the body did otherwise than its caption says, since the place does not allow it: words of `Motion.notes`."""
    does: Literal[Does, ""] = ""
    """What is seen to become of the piece under the hand."""


@dataclass(frozen=True)
class Outcome:
    """What became of one beat: it is acted, or something stands for it, or neither; never two of them."""

    beat: Beat
    why: str
    """Why it is not acted; empty where it is."""
    stood_for: bool = False
    """Whether the film shows only something that stands for it."""
    seen: frozenset[Does] = frozenset()
    """What is seen to become of pieces under the hands meanwhile."""

    @property
    def acted(self) -> bool:
        """Whether the body is seen doing it."""
        return not self.why

    @property
    def unshown(self) -> tuple[str, ...]:
        """What of its words is not seen where it is acted: what the planner says, and what becomes of things."""
        return (*self.beat.unshown, *(still_in(self.beat.text, self.seen) if self.acted else ()))

    def to_dict(self) -> Json:
        """Plain values for JSON."""
        told = {"acted": self.acted, "stood_for": self.stood_for, "why": self.why, "unshown": list(self.unshown)}
        return {**self.beat.model_dump(mode="json"), **told}


@dataclass(frozen=True)
class ActedBeats:
    """What became of all beats of a theme."""

    outcomes: tuple[Outcome, ...]
    """One a beat, in order."""
    spare_share: float
    """Share of the screen time that serves no beat, 0 to 1; 0 while nothing has been moved."""
    other_share: float = 0.0
    """Share of the screen time that shows no acted beat: what stands for others is part of it."""

    @property
    def asked(self) -> int:
        """How many beats the theme asks for."""
        return sum(one.beat.asked for one in self.outcomes)

    @property
    def acted(self) -> int:
        """How many of those are acted."""
        return sum(one.acted and one.beat.asked for one in self.outcomes)

    @property
    def stood_for(self) -> int:
        """For how many others of those something stands."""
        return sum(one.stood_for and one.beat.asked for one in self.outcomes)

    @property
    def missing(self) -> tuple[Outcome, ...]:
        """Those that are asked for, and neither acted nor stood for."""
        return tuple(one for one in self.outcomes if one.beat.asked and not (one.acted or one.stood_for))

    @property
    def undone(self) -> tuple[Outcome, ...]:
        """Those that are left undone, as asked."""
        return tuple(one for one in self.outcomes if one.beat.kind == "undone" and one.why != WISHED)

    @property
    def told(self) -> tuple[Outcome, ...]:
        """Those that are no deeds, or are only spoken of or wished for: nobody is asked to do them."""
        return tuple(one for one in self.outcomes if not one.beat.asked and one not in self.undone)

    @property
    def reacted(self) -> tuple[Outcome, ...]:
        """Those that happen, and that the body is seen to react to: nobody does them."""
        return tuple(one for one in self.told if one.why.startswith(REACTED))

    def lines(self) -> list[str]:
        """In words: how many are acted, the missing ones and why, what is left undone, and what these words mean where
        something is not acted; none without beats."""
        if not self.outcomes:
            return []
        other = f"{self.other_share:.0%}"
        share = "; nothing else is played" if other == "0%" else f"; {other} of the screen time plays something else"
        share = "" if other == "0%" and self.stood_for else share
        plain = all(one.acted and not one.beat.unshown for one in self.outcomes)
        more = f", something stands for {self.stood_for} more" if self.stood_for else ""
        return [
            f"{self.acted} of {self.asked} beats of your theme are acted{more}{share}",
            *(f"not acted: {one.beat.text} ({one.why})" for one in self.missing),
            *(
                f"not acted as such, something stands for it: {one.beat.text}{one.why.removeprefix(IN_ITS_PLACE)}"
                for one in self.outcomes
                if one.stood_for
            ),
            *(
                f"not shown of “{one.beat.text}”: {'; '.join(one.unshown)}"
                for one in self.outcomes
                if one.acted and one.unshown
            ),
            *(f"reacted to: {one.beat.text} ({one.why.removeprefix(REACTED + ': ')})" for one in self.reacted),
            *(
                f"told, not acted: {one.beat.text} ({one.why})"
                for one in self.told
                if one.why and not one.stood_for and one not in self.reacted
            ),
            *(f"left undone, as asked: {one.beat.text}" for one in self.undone),
            *([] if plain else self._meanings()),
        ]

    def _meanings(self) -> list[str]:
        """What the words that come up mean, a line each."""
        unshown = self.missing or any(one.acted and one.unshown for one in self.outcomes)
        told = {ACTED: self.acted, STANDS: self.stood_for, NOT_SHOWN: unshown, LEFT_UNDONE: self.undone}
        return [meaning for meaning, there in told.items() if there]

    def to_dict(self) -> Json:
        """Plain values for JSON."""
        return {
            "beats": [one.to_dict() for one in self.outcomes],
            "beats_asked": self.asked,
            "beats_acted": self.acted,
            "beats_stood_for": self.stood_for,
            "screen_time_without_beat": round(self.spare_share, 4) if self.outcomes else None,
            "screen_time_not_acted": round(self.other_share, 4) if self.outcomes else None,
        }


def acted_beats(beats: Sequence[Beat], shots: Sequence[Shot]) -> ActedBeats:
    """What became of the beats by the keyframes that there are, moved or still to be moved."""
    whole = sum(shot.seconds for shot in shots)
    outcomes = tuple(_outcome(beat, index, shots) for index, beat in enumerate(beats))
    acted = {index for index, one in enumerate(outcomes) if one.acted}
    spare = sum(shot.seconds for shot in shots if not shot.beats)
    other = sum(shot.seconds for shot in shots if acted.isdisjoint(shot.beats))
    return ActedBeats(outcomes, spare / whole if whole else 0.0, other / whole if whole else 0.0)


def lost_in_moving(beats: Sequence[Beat], shots: Sequence[Shot]) -> frozenset[int]:
    """Indices of the shots that were to show beats, of which the body, as it moved, was seen doing none."""
    before = acted_beats(beats, [replace(shot, reached=None, otherwise=()) for shot in shots]).outcomes
    after = acted_beats(beats, shots).outcomes
    lost = {
        index for index, (one, other) in enumerate(zip(before, after, strict=True)) if one.acted and not other.acted
    }
    return frozenset(at for at, shot in enumerate(shots) if shot.beats and lost.issuperset(shot.beats))


def _outcome(beat: Beat, index: int, shots: Sequence[Shot]) -> Outcome:
    seen, why = _seen(beat, index, shots), _why(beat, index, shots)
    stood_for = seen.stood_for and not why
    planned = beat.stood_for
    where = next((words for shot in shots if index in shot.beats for words in shot.otherwise
                  if (IN_PLACE_OF in words or not planned) and _concerns(words, beat)), "")  # fmt: skip
    place = f"{IN_ITS_PLACE}, {where}" if where else IN_ITS_PLACE
    done = frozenset(shot.does for shot in shots if index in shot.beats and shot.reached is not False and shot.does)
    return Outcome(seen, place if stood_for else why, stood_for, done)


def planned_beats(script: LongScript) -> ActedBeats:
    """What will become of a script's beats if the body reaches everything."""
    return acted_beats(script.beats, [shot_of(keyframe) for keyframe in script.keyframes])


def shot_of(keyframe: PlannedKeyframe) -> Shot:
    """A keyframe that is still to be moved."""
    return Shot(beats_in(keyframe.beat, keyframe.also), keyframe.mood, connects(keyframe), does=keyframe.does)


def beats_in(beat: int | None, also: Sequence[int]) -> tuple[int, ...]:
    """All beats that a keyframe serves."""
    return (() if beat is None else (beat,)) + tuple(also)


def _seen(beat: Beat, index: int, shots: Sequence[Shot]) -> Beat:
    """A beat with what of it is not seen: all of it, where the body did otherwise in every keyframe that shows it."""
    own = [shot for shot in shots if index in shot.beats and not shot.connects]
    lost = bool(own) and all(any(_concerns(words, beat) for words in shot.otherwise) for shot in own)
    return beat.model_copy(update={"unshown": (beat.text,)}) if lost else beat


def _concerns(words: str, beat: Beat) -> bool:
    """Whether a note is about what a beat says: who is only said to lie on a bed does so wherever the knees are; and a
    piece that something is done in place of must be named; a mood is seen however the arms are."""
    if IN_PLACE_OF in words:
        return re.search(rf"\b{re.escape(words.partition(IN_PLACE_OF)[2])}", beat.text, re.IGNORECASE) is not None
    if _OPEN_ARMS in words:
        return "arms" in beat.text  # who "walks out of the door" does so with arms before them too
    if OF_LIMBS.search(words) and not _OF_HANDS.search(words):
        return _TELLS_LEGS.search(beat.text) is not None  # who "enjoys a quiet afternoon" does with bent legs too
    return not (OF_LIMBS.search(words) and (beat.kind == "feeling" or RESTS.match(beat.text)))


def _about(index: int, shots: Sequence[Shot]) -> list[Shot]:
    """What is done just before a beat that nothing shows by itself, and what is done next, with the way there: a mood
    is seen there or nowhere."""
    before = [max(shot.beats) for shot in shots if shot.beats and max(shot.beats) < index]
    after = [min(shot.beats) for shot in shots if shot.beats and min(shot.beats) > index]
    near = {*([max(before)] if before else []), *([min(after)] if after else [])}
    return [shot for shot in shots if not near.isdisjoint(shot.beats)]


def _is_long_enough(shot: Shot) -> bool:
    """Whether a mood can be seen in it: for so long, once it has been moved."""
    return shot.reached is None or shot.seconds >= FELT


def _why(beat: Beat, index: int, shots: Sequence[Shot]) -> str:
    """Why a beat is not acted; empty where it is."""
    if beat.why or beat.kind == "undone":
        return beat.why or UNDONE
    own = [shot for shot in shots if index in shot.beats]
    if not own and beat.kind == "feeling" and beat.emotion is not Emotion.NEUTRAL:
        own = [shot for shot in _about(index, shots) if shot.mood is beat.emotion and _is_long_enough(shot)]
    if not own:
        return "no keyframe is left that shows it"
    # What only leads there shows a beat just where nothing else does: "walks to the window".
    own = [shot for shot in own if not shot.connects] or own
    lost = [shot for shot in own if shot.reached is False]
    return f"the body did not reach it: {lost[0].reason or 'no reason is known'}" if len(lost) == len(own) else ""
