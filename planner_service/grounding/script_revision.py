"""A script that somebody changed, in the home that it had or in another: words and objects checked, the rest mended.

What is wrong is told all at once, each fault at its keyframe and field, with what would be right.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from pydantic import Field

from motion_backend.emotion_words import emotion_of
from motion_backend.motion import RISINGS, Does, Skill
from motion_backend.procedural.caption_coverage import understands
from planner_service.composition.caption_senses import is_shown
from planner_service.composition.deed_lexicon import deed_of
from planner_service.composition.furniture_words import pieces_told
from planner_service.grounding.furnish import Furnished, furnished_again
from planner_service.grounding.keyframes_to_actions import NEEDS
from planner_service.scripts.acted_beats import beats_in, connects
from planner_service.scripts.caption_actions import look_of
from planner_service.scripts.caption_fallbacks import hashed_words
from planner_service.scripts.captions import captions
from planner_service.scripts.script import EMOTIONS, Beat, Keyframe, LongScript, PlannedKeyframe
from planner_service.scripts.script_repair import repair
from planner_service.scripts.script_words import affords
from planner_service.themes.beats import read_beat
from planner_service.themes.opening_words import opening_of
from scene_graphs.errors import FieldPath, UserError
from scene_graphs.furniture import canonical, categories_of, display_name, is_known
from scene_graphs.graph.furniture_graph import offers
from scene_graphs.home import Home
from scene_graphs.layout import Placed

FLOOR: Final = "floor"
MAX_NAMED: Final = 8
"""Pieces of furniture that are named to who asked for another."""
MAX_ID_LENGTH: Final = 200
DOES: Final = {"sit": "sit on", "lie": "lie on", "touch": "touch"}


class EditedKeyframe(Keyframe):
    """A keyframe as somebody wants it: one of the story, changed or not, or a new one."""

    index: int | None = Field(
        None, ge=0, strict=True, description="The story's keyframe that it is, changed or not; left out: a new one."
    )
    object_id: str | None = Field(
        None,
        max_length=MAX_ID_LENGTH,
        description="The object of the home; left out: where it was, or one that `furniture` names.",
    )


def _held(one: EditedKeyframe, old: PlannedKeyframe | None) -> str:
    """What is in the hands as somebody wants it: where they do not say, as it was while the same is done."""
    stays = old is not None and (old.skill, old.caption) == (one.skill, one.caption)
    return one.held if "held" in one.model_fields_set or old is None or not stays else old.held


def _does(one: EditedKeyframe, old: PlannedKeyframe | None) -> Literal[Does, ""]:
    """What becomes of the piece, as somebody wants it: where they do not say, as it was while the same is done."""
    stays = old is not None and (old.skill, old.caption) == (one.skill, one.caption)
    return one.does if "does" in one.model_fields_set or old is None or not stays else old.does


@dataclass(frozen=True)
class Fault:
    """What is wrong with one field of a keyframe, and what would be right."""

    keyframe: int
    field: str
    said: str


class RevisionError(UserError):
    """A script cannot be changed so; `faults` has all that is wrong."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        first = faults[0]
        super().__init__(first.said, at=FieldPath(("keyframes", first.keyframe, first.field)))
        self.faults = tuple(faults)


def revised(stage: Furnished, wanted: Sequence[EditedKeyframe]) -> Furnished:
    """The story's script as it is wanted, in the story's own home, every keyframe at its object. RevisionError."""
    reader = _Reader(stage.script, stage.home, stage)
    return furnished_again(stage, _mended(stage.script, reader.read(wanted)))


def rewritten(script: LongScript, wanted: Sequence[EditedKeyframe], home: Home) -> LongScript:
    """The script as it is wanted, to be furnished in another home; objects are those of that home. RevisionError."""
    return _mended(script, _Reader(script, home, None).read(wanted))


def _mended(script: LongScript, planned: Sequence[PlannedKeyframe]) -> LongScript:
    """With walks and risings that are missing, and without what cannot happen; `repairs` says so."""
    keyframes, repairs = repair(planned)
    if not keyframes:
        raise RevisionError([Fault(0, "skill", f"nothing is left that a body can do: {'; '.join(repairs)}")])
    keyframes = tuple(_without_its_beat(one, script.keyframes, keyframes) for one in keyframes)
    beats = tuple(_judged_anew(beat, index, script.keyframes, keyframes) for index, beat in enumerate(script.beats))
    return script.model_copy(update={"beats": beats, "keyframes": keyframes, "repairs": repairs})


def _without_its_beat(
    one: PlannedKeyframe, before: Sequence[PlannedKeyframe], now: Sequence[PlannedKeyframe]
) -> PlannedKeyframe:
    """A keyframe that only led to what was taken out, told by itself: who still gets up, but dances no more."""
    taken_out = one.beat is not None and connects(one) and _doing(one.beat, before) and not _doing(one.beat, now)
    return one.model_copy(update={"beat": None}) if taken_out else one


def _judged_anew(beat: Beat, index: int, before: Sequence[PlannedKeyframe], now: Sequence[PlannedKeyframe]) -> Beat:
    """A beat whose keyframes were changed: something else stands for it, unless the table of deeds has that they show
    it."""
    old, new = _doing(index, before), _doing(index, now)
    if beat.kind != "deed" or not new or [_what(one) for one in old] == [_what(one) for one in new]:
        return beat
    clause = read_beat(beat).clause
    deed = deed_of(clause)
    able = [one for one in new if deed is not None and (deed.row.captions or one.skill is deed.skill)]
    elsewhere = opening_of(Skill.TOUCH, beat.text) is not None and _pieces(old) != _pieces(new)
    away = elsewhere or (_is_at(beat.text, old) and not _is_at(beat.text, new))
    shown = deed is not None and bool(able) and is_shown(clause, deed, able) and not away
    besides = tuple(text for text in beat.unshown if text != beat.text)
    return beat.model_copy(update={"unshown": besides if shown else (beat.text, *besides), "replaced": not shown})


def _doing(index: int, keyframes: Sequence[PlannedKeyframe]) -> list[PlannedKeyframe]:
    """The keyframes that show a beat, without those that only lead to others."""
    return [one for one in keyframes if index in beats_in(one.beat, one.also) and not connects(one)]


def _pieces(keyframes: Sequence[PlannedKeyframe]) -> list[str]:
    return [one.furniture for one in keyframes]


def _is_at(text: str, keyframes: Sequence[PlannedKeyframe]) -> bool:
    """Whether one of some keyframes is at a piece of furniture that a text names."""
    named = {category for _, piece in pieces_told(text) for category in categories_of(piece)}
    return any(named & categories_of(one.piece[0]) for one in keyframes)


def _what(keyframe: PlannedKeyframe) -> tuple[str, str, str]:
    return keyframe.skill, keyframe.caption, keyframe.furniture


class _Reader:
    """The wanted keyframes being read one by one, with all faults that are found."""

    def __init__(self, script: LongScript, home: Home, stage: Furnished | None) -> None:
        self.home, self.faults = home, list[Fault]()
        places = stage.places if stage else [None] * len(script.keyframes)
        self.before = [
            keyframe.model_copy(update={"object_id": place.object_id if place else None})
            for keyframe, place in zip(script.keyframes, places, strict=True)
        ]
        self.rooms = dict(enumerate(match.room_type for match in stage.matches)) if stage else {}
        self.rooms |= {
            place.room: one.room for one, place in zip(self.before, places, strict=True) if place and one.room
        }
        self.named = defaultdict[tuple[str, int], set[str | None]](set)
        for one in self.before:
            self.named[canonical(one.piece[0]), one.piece[1]].add(one.object_id)

    def read(self, wanted: Sequence[EditedKeyframe]) -> list[PlannedKeyframe]:
        """All of them. RevisionError tells every fault."""
        found = [self._read(number, one) for number, one in enumerate(wanted)]
        if self.faults:
            raise RevisionError(self.faults)
        return _roomed(found)

    def _read(self, number: int, one: EditedKeyframe) -> PlannedKeyframe:
        old = self.before[one.index] if one.index is not None and one.index < len(self.before) else None
        if one.index is not None and old is None:
            self._note(number, "index", f"the story has no keyframe {one.index}; its last is {len(self.before) - 1}")
        if old is None or (old.skill, old.caption) != (one.skill, one.caption):
            self._caption(number, one)
        if emotion_of(one.emotion) is None and (old is None or old.emotion != one.emotion):
            known = ", ".join(EMOTIONS)
            self._note(
                number,
                "emotion",
                f"“{one.emotion}” is no emotion that is known; these are, and words for them: {known}",
            )
        chosen = self._object(number, one, old)
        same = old is not None and chosen == old.object_id
        if old is not None and same and (old.skill, old.emotion, old.caption) == (one.skill, one.emotion, one.caption):
            return old.model_copy(update={"held": _held(one, old), "does": _does(one, old)})
        return PlannedKeyframe(
            skill=one.skill,
            emotion=one.emotion,
            caption=one.caption,
            furniture=old.furniture if old is not None and same else self._word(one, chosen),
            beat=old.beat if old else None,
            also=old.also if old else (),
            room=self._room(chosen, old),
            object_id=chosen,
            already=old.already if old else False,
            held=_held(one, old),
            does=_does(one, old),
            reacts=old.reacts if old else (),
        )

    def _note(self, number: int, field: str, said: str) -> None:
        self.faults.append(Fault(number, field, said))

    def _caption(self, number: int, one: EditedKeyframe) -> None:
        """A caption must be one that the body knows, or has a word of."""
        if one.caption in captions()[one.skill.value] or understands(one.skill, look_of(one.caption)):
            return
        try:
            nearest = f"; the nearest that is known is “{hashed_words().nearest(one.skill, one.caption)[0]}”"
        except ValueError:
            nearest = ""
        where = f"`sims captions` or GET /v1/captions?skill={one.skill} lists all"
        self._note(number, "caption", f"the body knows no “{one.caption}” for {one.skill}{nearest}; {where}")

    def _object(self, number: int, one: EditedKeyframe, old: PlannedKeyframe | None) -> str | None:
        """The object that is meant; None on the floor."""
        need = NEEDS.get(one.skill)
        if one.object_id is not None:
            return self._named_object(number, one.object_id, need)
        if one.on_floor or one.skill in RISINGS:
            if need == "touch":
                self._note(number, "furniture", f"nobody touches the floor; {self._there_is(need)}")
            return None if old is None or one.on_floor else old.object_id
        if old is not None and old.furniture == one.furniture and (need is None or old.skill == one.skill):
            return old.object_id
        if not is_known(one.piece[0]):
            self._note(number, "furniture", f"“{one.furniture}” is no furniture that is known; {self._there_is(need)}")
            return None
        return self._object_for(number, one, need)

    def _named_object(self, number: int, object_id: str, need: str | None) -> str | None:
        """The object of that id, if the body can do there what it is to do."""
        there = {placed.id: placed for placed in self.home.objects}
        if object_id not in there:
            self._note(number, "object_id", f"the home has no object “{object_id}”; {self._there_is(need)}")
            return None
        if need is not None and not _serves(there[object_id], need):
            name = display_name(there[object_id].category)
            self._note(number, "object_id", f"nobody can {DOES[need]} the {name} {object_id}; {self._there_is(need)}")
        return object_id

    def _object_for(self, number: int, one: EditedKeyframe, need: str | None) -> str | None:
        """An object of the home that a word names: one that the story uses already, else the first."""
        meant = categories_of(one.piece[0])
        fitting = [one for one in self._serving(need) if canonical(one.category) in meant]
        if not fitting:
            self._note(number, "furniture", f"the home has no {one.piece[0]}; {self._there_is(need)}")
            return None
        used = {keyframe.object_id for keyframe in self.before}
        return min(fitting, key=lambda placed: (placed.id not in used, placed.id)).id

    def _serving(self, need: str | None) -> Iterable[Placed]:
        return (placed for placed in self.home.objects if need is None or _serves(placed, need))

    def _there_is(self, need: str | None) -> str:
        """What of the home would be right, in words."""
        found = [f"{display_name(placed.category)} ({placed.id})" for placed in self._serving(need)]
        named = ", ".join(found[:MAX_NAMED]) + (" …" if len(found) > MAX_NAMED else "")
        what = f"to {DOES[need]}" if need else "to go to"
        floor = "" if need == "touch" else f"{FLOOR}, "
        return f"{what} there is: {floor}{named}" if found else f"there is nothing {what}"

    def _word(self, one: EditedKeyframe, chosen: str | None) -> str:
        """What a keyframe calls its object: no other object of the story has that word and number."""
        if chosen is None:
            return FLOOR
        word = one.piece[0]
        category = self.home.object(chosen).category
        if one.on_floor or canonical(category) not in categories_of(word):
            word = display_name(category)
        number = 1
        while self.named.get((canonical(word), number), {chosen}) != {chosen}:
            number += 1
        self.named[canonical(word), number].add(chosen)
        return word if number == 1 else f"{word} {number}"

    def _room(self, chosen: str | None, old: PlannedKeyframe | None) -> str | None:
        if chosen is not None and self.rooms:
            return self.rooms.get(int(chosen.partition("/")[0]))
        return old.room if old else None


def _serves(placed: Placed, need: str) -> bool:
    return need in offers(placed) and affords(placed.category, need)


def _roomed(keyframes: Sequence[PlannedKeyframe]) -> list[PlannedKeyframe]:
    """What is new on the floor is done in the room where the body is, or where it will be first."""
    room = next((keyframe.room for keyframe in keyframes if keyframe.room), None)
    found = []
    for keyframe in keyframes:
        room = keyframe.room or room
        found.append(keyframe.model_copy(update={"room": room}))
    return found
