"""Keyframes for the beats of a theme, written from the captions and furniture there are (SIMS 3.2).

The writer keeps track of the body: what is done sitting goes on where one sits already, and two beats that one posture
shows are one keyframe. A part of a library's short script is taken in place of what would be written where it does the
same deed, in the same mood.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from motion_backend.motion import RISINGS, Emotion, Skill
from planner_service.composition.body_track import BodyTrack
from planner_service.composition.caption_senses import only_in, shows
from planner_service.composition.deed_lexicon import Deed, row_of
from planner_service.composition.deed_places import DeedPlaces, further, is_at
from planner_service.composition.deed_reader import TOUCHES, DeedReader, rises_again
from planner_service.composition.deed_table import DeedRow, captions_of_gestures, deed_table
from planner_service.composition.earlier_deeds import done_before, with_its_noun
from planner_service.composition.furniture_words import names_things, pieces_in, room_of, where
from planner_service.composition.gainsaid import is_gainsaid
from planner_service.composition.mood_captions import captions_of, fitting, walk_of
from planner_service.composition.phone_call import hangs_up, is_talk, on_phone
from planner_service.composition.rest_place import (
    GETS_THERE,
    dozing,
    eats,
    goes_on,
    is_beside,
    is_done_standing,
    is_on,
    is_there,
    lies,
    on_feet,
    on_place_ahead,
    on_seat_ahead,
    only_stands_for,
    rises_later,
    sits,
    sits_up,
    sleeps,
)
from planner_service.composition.stand_in import SEATS, is_too_much
from planner_service.composition.unacted_beats import BESIDE, HELD, NOT_ACTED, UNSHOWN, not_acted
from planner_service.composition.whereabouts import is_held, is_worn
from planner_service.scripts.caption_fallbacks import usual
from planner_service.scripts.captions import captions
from planner_service.scripts.script import Keyframe, PlannedKeyframe, ShortScript
from planner_service.scripts.script_words import NEEDS, affords
from planner_service.themes.beats import EXPRESSIONS, ReadBeat
from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import lemma_of
from planner_service.themes.opening_words import Kind, opening_of
from planner_service.themes.protagonist import head_of, names_somebody
from planner_service.themes.theme_words import theme_words
from scene_graphs import furniture

EXPRESSED: Final = (Emotion.HAPPY, Emotion.ANGRY, Emotion.SAD)
"""Moods whose laughing, shouting and sighing a body's bearing shows; it does not sweat or yawn."""
_AGAIN_VERBS: Final = ("start", "begin", "try")
_AGAIN: Final = frozenset(("again", "over", "afresh", "anew", "more"))
_REFUSED: Final = {"sit": Skill.SITDOWN, "lie": Skill.LIEDOWN}
_ON_KNEES: Final = {"praying, palms together": "praying while kneeling, palms together"}
"""What who kneels goes on to do there."""
_STANDS: Final = ("stand", "stands", "stood")
_DESK: Final = re.compile(r"writing|typing")
"""Captions that want a table under the hands."""
_TO_BED: Final = re.compile(r"\bto bed\b")
"""Who goes there, however they do, lies down."""
_GOES_ON: Final = re.compile(r"(?:goes|went|go|carries|carried|carry|keeps|kept|keep) (?:on|going)(?:,| with\b|$)")
_LOW_DOWN: Final = re.compile(
    r"\b(?:under\w*|beneath|below|behind|floor\w*|ground|rug|carpet|tiles|low\w*|bottom|kne\w+|crawl\w*|crouch\w*|prone)\b"
)
"""Words of what hands get down on the floor for."""


@dataclass(frozen=True)
class Part:
    """A stretch of a short script that shows a deed."""

    script: ShortScript
    score: float
    keyframes: tuple[PlannedKeyframe, ...]
    """The deed's, with the walk that leads to it."""


@dataclass
class KeyframeWriter:
    """Writes the keyframes of one long script, beat by beat."""

    seed: int = 0
    home: Mapping[str, Collection[str]] | None = None
    """Categories of furniture that there will be, by room type; None: any."""
    reader: DeedReader = field(default_factory=DeedReader)
    part_of: Callable[[int], Part | None] = lambda _index: None
    """The part of a short script that may be taken for a beat, by the beat's place."""
    spares: bool = True
    """Whether what only stands for a beat is left out where it would be worse than nothing."""
    body: BodyTrack = field(default_factory=BodyTrack)
    why: dict[int, str] = field(default_factory=dict)
    """Beats that are not acted, with the reason."""
    deeds: dict[int, Deed] = field(default_factory=dict)
    """What is done for beats that are acted as deeds."""
    linked: set[int] = field(default_factory=set)
    """Beats of hands that are done where the thing was last."""
    moody: set[int] = field(default_factory=set)
    """Beats that a mood alone shows, in whatever is done in it."""
    parts: list[tuple[int, Part]] = field(default_factory=list)
    """Beats that are served by a part of a script."""
    _avoided: set[Skill] = field(default_factory=set)
    _about: str = ""
    """The words that named furniture last."""
    _tried: Deed | None = None
    """What was tried or begun last."""
    _clause: Clause | None = None
    """Of which deed it is written."""
    _rises: bool = False
    """Whether getting up is done next."""
    _opening: Kind | None = None
    """The window or door that was walked to, or stood at, last."""
    _ahead: str | None = None
    """The room that is spoken of next."""

    @property
    def keyframes(self) -> list[PlannedKeyframe]:
        """All that are written."""
        return self.body.keyframes

    @property
    def places(self) -> DeedPlaces:
        """Where deeds may be done."""
        return DeedPlaces(self.home, self.reader)

    def write(self, index: int, beats: Sequence[ReadBeat]) -> None:
        """Keyframes for the beat at a place; it is shown by one, by another beat's in its mood, or is in `why`."""
        read, beats = with_its_noun(index, beats)
        beat = read.beat
        deed = self._deed(index, beats) if beat.kind == "deed" else None
        self._about = read.text if names_things(read.clause) else self._about
        nexts = beats[index + 1 :]
        deed = on_phone(deed, read, self.body.calling, nexts) if deed is not None else None
        self._ahead = next(filter(None, (one.room or room_of(one.clause) for one in nexts)), None)
        if beat.kind in NOT_ACTED:
            self.why[index] = not_acted(read)
            self.body.whereabouts.told(read.clause)
        elif deed is not None and deed.row.why:
            self.why[index] = deed.row.why
        elif self.body.sleeps and (not read.clause.verb or (" " not in read.text and read.text.endswith("ed"))):
            self._feel(index, beats)  # "falls asleep, exhausted"
        elif deed is not None and self.body.sleeps and deed.skill is Skill.LIEDOWN and not deed.named:
            self.body.show(index)  # "falls asleep, and dreams"
            self.deeds[index] = deed
        elif deed is not None and self.body.calling and hangs_up(read) and not deed.named:
            self.body.hang_up(index, beat.emotion)
        elif deed is not None and (row := self._within(read)) is not None:
            self.body.show(index)
            self.deeds.update({index: replace(deed, row=row)} if row.stands else {})
        elif deed is not None and self._is_felt_at_rest(read, deed):
            self._feel(index, beats)
        elif deed is not None:
            if self.body.resting is None:
                deed = on_seat_ahead(deed, read, nexts, self.reader, self.places)
            deed = on_place_ahead(deed, read, nexts, self.reader)
            self.deeds[index] = deed
            self._tried = deed if lemma_of(read.text.split()[0]) in _AGAIN_VERBS else self._tried
            self._try(index, read, deed, rises_later(nexts, self.reader))
        elif beat.kind == "feeling" or (read.felt is not None and read.sure):
            self._feel(index, beats)
        else:
            self.why[index] = UNSHOWN

    def _is_felt_at_rest(self, read: ReadBeat, deed: Deed) -> bool:
        """Whether a beat says how somebody is who rests, and would have to get up to show it: "surprised"."""
        ways = deed.row.lying if lies(self.body.resting) else deed.row.seated
        felt = read.felt is not None and read.clause.verb in theme_words()["state_verbs"]
        return bool(self.body.resting) and felt and deed.is_gesture and deed.skill is Skill.LOCO and not ways

    def _deed(self, index: int, beats: Sequence[ReadBeat]) -> Deed | None:
        """What a beat does; who starts again does what was tried last, else done at rest last, else done first, and who
        "knocks again" does it where they did."""
        clause = beats[index].clause
        if (before := done_before(index, beats, self.keyframes, self.deeds)) is not None:
            return before
        again = clause.verb in _AGAIN_VERBS and not _AGAIN.isdisjoint(clause.lemmas)
        if again and not self.deeds:
            return None
        if again or (_GOES_ON.match(clause.text) and self.deeds):
            done = list(self.deeds.values())
            return self._tried or next((deed for deed in reversed(done[again:-1] or done) if deed.row.rests), done[0])
        return self.reader.deed(clause, self._about)

    def _within(self, read: ReadBeat) -> DeedRow | None:
        """The row of what is part of what is seen already: nobody goes anywhere to hang up, or close a book."""
        row = row_of(read.clause, self._about)
        last = "".join(one.caption for one in self.keyframes[-1:])
        return row if row is not None and any(part in last for part in row.within) else None

    def take(self, index: int, keyframes: Sequence[Keyframe], why: str, part: Part | None) -> None:
        """Keyframes that somebody else planned for a beat, of a short script where they are of one."""
        if not keyframes:
            self.why[index] = why or UNSHOWN
            return
        number = None
        if part is not None:
            self.parts.append((index, part))
            number = len(self.parts) - 1
        for keyframe in keyframes:
            row = {**keyframe.model_dump(), "beat": index, "short_script": number}
            self.keyframes.append(PlannedKeyframe.model_validate(row))
        last = self.keyframes[-1]
        self.body.resting = last if last.skill in (Skill.SITDOWN, Skill.LIEDOWN) else None
        self.body.plain = False

    def appear(self, beats: Sequence[ReadBeat]) -> None:
        """Somebody of whom nothing else can be acted is seen at what a verbless beat names, else in their mood."""
        if not any(names_somebody(one.clause) for one in beats):
            return
        for index, one in enumerate(beats):
            for piece in () if one.clause.verb else where(one.clause.text):
                rests = affords(piece, "lie") or not affords(piece, "touch")
                skill, mood = Skill.SITDOWN if rests else Skill.TOUCH, one.beat.emotion
                if affords(piece, NEEDS[skill]) and skill not in self._avoided and self.places.has(piece):
                    caption = self._one_of(captions_of(skill, mood), mood, index, skill)
                    self.body.put(index, skill, mood, caption, piece, one.room)
                    return
        mood = beats[-1].beat.emotion
        self.body.put(
            None, Skill.LOCO, mood, "stand still" if mood is Emotion.NEUTRAL else walk_of(mood), "floor", None
        )

    def avoid(self, beats: Sequence[ReadBeat]) -> None:
        """Neither sit nor lie for other deeds where the theme says that this is not done."""
        for one in beats:
            deed = self.reader.deed(one.clause) if one.beat.kind == "undone" else None
            known = _REFUSED.get(one.clause.verb) if one.beat.kind == "undone" else None
            skill = deed.skill if deed is not None and not deed.row.captions else known
            self._avoided |= {skill} & {Skill.SITDOWN, Skill.LIEDOWN} if skill is not None else set()

    def _try(self, index: int, read: ReadBeat, deed: Deed, rises_later: bool) -> None:
        """Do it, or leave it out where what would be done only stands for it and is too much for that."""
        before, parts = self.body.copy(), len(self.parts)
        self._do(index, read, deed, rises_later)
        if self.spares and is_too_much(read, deed, before, self.body, self.reader):
            self.body, self.why[index] = before, UNSHOWN
            self.linked.discard(index)
            self.deeds.pop(index, None)
            del self.parts[parts:]

    def _do(self, index: int, read: ReadBeat, deed: Deed, rises_later: bool = False) -> None:
        self._rises = rises_later
        deed = on_feet(read, deed, self.body.resting, self._clause, self._avoided)
        mood = read.beat.emotion
        self._clause = read.clause
        if deed.row.mood and mood is Emotion.NEUTRAL:
            mood = Emotion(deed.row.mood)
        if self._needs_nothing(index, read, deed):
            return
        if not self.keyframes and sits_up(read, deed) and "bed" in deed.pieces:
            self._begin(index, replace(deed, skill=Skill.GETUP), mood)
        resting = self.body.resting
        match deed.skill:
            case Skill.LOCO if resting is not None and read.text in _STANDS:
                self._rise(index, deed, mood)
            case Skill.STANDUP if self.keyframes and resting is None and is_beside(read):
                self.body.show(index)  # "eats, standing up"
            case Skill.STANDUP | Skill.GETUP if not self.keyframes:
                self._begin(index, deed, mood)
                if not rises_later and self.body.resting is not None:
                    self._rise(index, deed, mood)
            case Skill.STANDUP | Skill.GETUP:
                self._rise(index, deed, mood)
            case Skill.LOCO if resting is not None and goes_on(read, deed):
                self.body.show(index)
            case Skill.LOCO if deed.row.seated and sits(resting) and not is_done_standing(read):
                self._rest(index, read, replace(deed, pieces=(), named=False), mood, Skill.SITDOWN, deed.row.seated)
            case Skill.LOCO if deed.row.lying and lies(resting) and (not deed.named or is_on(resting, deed)):
                self._rest(index, read, deed, mood, Skill.LIEDOWN, deed.row.lying)
            case Skill.LOCO if resting is not None and lies(resting) and not deed.named and eats(deed):
                deed = replace(deed, pieces=(resting.furniture,), named=True)  # sitting up
                self._rest(index, read, deed, mood, Skill.SITDOWN, deed.row.seated)
            case Skill.LOCO if deed.row.seated and lies(resting) and not deed.named:
                self.body.show(index)  # "lies there and stares at the wall"
            case Skill.LOCO:
                self._walk(index, read, deed, mood)
            case Skill.TOUCH:
                for piece in (deed, *further(read.clause, deed)):
                    if self._add(index, read, piece, mood, Skill.TOUCH, deed.row.captions or TOUCHES):
                        self.body.resting = None
                        if deed.row.then:
                            self.body.put(index, Skill.LOCO, mood, deed.row.then, "floor", self.keyframes[-1].room)
            case Skill.LIEDOWN if not deed.named and (seated := dozing(self.body.resting, read, self.reader)):
                self._rest(index, read, replace(deed, pieces=()), mood, Skill.SITDOWN, seated)
            case Skill.SITDOWN if self.body.resting is not None and lies(self.body.resting) and sits_up(read, deed):
                deed = replace(deed, pieces=(self.body.resting.furniture,))
                self._rest(index, read, deed, mood, Skill.SITDOWN, deed.row.captions)
            case Skill.SITDOWN if lies(self.body.resting) and deed.row.lying and not deed.named:
                self._rest(index, read, deed, mood, Skill.LIEDOWN, deed.row.lying)
            case _:
                shown = deed.row.captions if deed.skill is deed.row.skill else deed.row.seated
                self._rest(index, read, deed, mood, deed.skill, shown)

    def _needs_nothing(self, index: int, read: ReadBeat, deed: Deed) -> bool:
        """Whether no keyframe is written for a beat, since what the body does already shows it, or must not be left
        for it."""
        resting = self.body.resting
        if resting is not None:
            stands_in = only_stands_for(resting, read, deed, self.reader)
            if stands_in and shows(resting.skill, resting.caption, read.clause):
                self.body.show(index)
            elif stands_in:
                self.why[index] = UNSHOWN  # nobody gets up for what would show no more
            return stands_in or (deed.skill is Skill.TOUCH and self._is_on_body(index, read))
        if deed.is_gesture and deed.skill is Skill.LOCO and lies(resting) and not deed.row.lying and is_beside(read):
            self.why[index] = UNSHOWN  # "lies on the bed tossing a ball": nobody gets up for it
            return True
        rests = bool(self.keyframes) and deed.skill in (Skill.SITDOWN, Skill.LIEDOWN)
        if rests and lemma_of(head_of(read.clause.subject)) in theme_words()["body"]:
            self.body.show(index)  # "leans against the wall, arms crossed"
            return True
        if rests and not deed.named and is_beside(read) and self._tells_same(index):
            self.why[index] = BESIDE
            self.deeds.pop(index, None)
            return True
        return deed.skill is Skill.TOUCH and self._is_on_body(index, read)

    def _tells_same(self, index: int) -> bool:
        """Whether the last keyframe is of the beat just before: something is done, on one's feet."""
        return index > 0 and index - 1 in (self.keyframes[-1].beat, *self.keyframes[-1].also)

    def _is_on_body(self, index: int, read: ReadBeat) -> bool:
        """Whether what hands would do it to is held or worn already: nobody walks to it, and it is not seen."""
        holds = is_held(read.clause) or self.body.whereabouts.in_hand(read.clause)
        worn = is_worn(read.clause) and not pieces_in(read.clause.text)
        if not (holds or worn):
            return False
        self.why[index] = HELD
        self.deeds.pop(index, None)
        return True

    def _rest(
        self, index: int, read: ReadBeat, deed: Deed, mood: Emotion, skill: Skill, captions: Sequence[str]
    ) -> None:
        """Sit or lie: where one rests already if that does, with the caption of what is done there."""
        resting = self.body.resting
        desk = bool(captions) and all(_DESK.search(one) for one in captions) and not deed.named
        bed = resting is not None and furniture.group_of(resting.furniture) == "bed"
        here = resting is not None and is_there(resting, deed, skill) and not (desk and bed)  # nobody writes on a bed
        shown = captions or captions_of(skill, mood)
        if here:  # where one sits already there need be no table
            shown = [one for one in shown if "table" not in one] or shown
        if resting is not None and here and resting.skill is skill:
            generic = deed.row.rests or deed.row.captions
            stands_in = (deed.row.stands or is_beside(read)) and not any(
                shows(skill, one, read.clause) for one in shown
            )
            told = self.body.plain and mood.value != resting.emotion and resting.mood in EXPRESSED
            if (self.body.plain and not told) or not generic or stands_in or resting.caption in captions:
                if self.body.plain and generic:
                    self.keyframes[-1] = self.body.resting = resting.model_copy(
                        update={"caption": self._one_of(shown, mood, index, skill), "emotion": mood.value}
                    )
                    self.body.plain = False
                self.body.show(index)
                self._sleep(read)
                return
        if resting is not None and here:
            deed = Deed(deed.row, skill, (resting.furniture,), True)
        begins = not self.keyframes and skill is Skill.LIEDOWN and not GETS_THERE.search(read.text)
        if self._add(index, read, deed, mood, skill, shown):
            stays = read.clause.verb in ("stay", "remain")
            if begins and (self._rises or stays):  # who "cannot sleep. He gets up" lies there when the story begins
                self.keyframes[:] = [self.keyframes[-1].model_copy(update={"already": True})]
            self.body.resting, self.body.plain = self.keyframes[-1], not (deed.row.rests or captions)
            self._sleep(read)
            tables = [
                table for table, seats in deed_table().seats_at.items() if seats[0] == self.body.resting.furniture
            ]
            if tables and skill is Skill.SITDOWN:  # what is written there lies there
                self.body.whereabouts.brought(read.clause, (self.body.resting.room, tables[0]))

    def _sleep(self, read: ReadBeat) -> None:
        """Note that the body is asleep now, or still."""
        if sleeps(read.clause):
            self.body.asleep = len(self.keyframes)

    def _begin(self, index: int, deed: Deed, mood: Emotion) -> None:
        """Lie or sit: who gets up has done so before."""
        skill, usually = (Skill.LIEDOWN, "bed") if deed.skill is Skill.GETUP else (Skill.SITDOWN, "chair")
        need, already = NEEDS[skill], not self.keyframes
        order = (*deed.pieces, usually) if deed.named or need == "lie" else (usually, *deed.pieces)
        piece = next((one for one in (*order, "bed") if affords(one, need) and self.places.has(one)), "")
        if not piece:
            self.why[index] = "there is nothing to get up from"
            return
        self.body.put(index, skill, mood, self._one_of(captions_of(skill, mood), mood, index, skill), piece, None)
        self.keyframes[-1] = self.body.resting = self.keyframes[-1].model_copy(update={"already": already})

    def _rise(self, index: int, deed: Deed, mood: Emotion) -> None:
        """Get up."""
        last = self.keyframes[-1]
        if self.body.resting is None and rises_again(last) and not deed.named:
            self.body.show(index)
            return
        if self.body.resting is None and last.skill in RISINGS:
            ways = self.reader.likeliest(self._clause, last.skill, captions()[last.skill.value]) if self._clause else ()
            if ways and last.caption not in ways:  # who "wakes up and gets up slowly"
                self.keyframes[-1] = last.model_copy(update={"caption": ways[0]})
            self.body.show(index)
            return
        rose = any(one.skill in RISINGS or rises_again(one) for one in self.keyframes)
        out = self._clause is not None and self._clause.verb in ("crawl", "climb", "scramble")  # from under a sink
        if self.body.resting is None and not deed.named and (rose or out):
            self.why[index] = "the body is on its feet already"
            return
        if self.body.resting is None:
            self._begin(index, deed, mood)
        if self.body.resting is None:
            return
        resting = self.body.resting
        skill = Skill.GETUP if resting.skill is Skill.LIEDOWN else Skill.STANDUP
        pace = {"hurried": "quickly", "angry": "quickly", "tired": "slowly", "sad": "slowly", "drunk": "slowly"}.get(
            mood.value, ""
        )
        ways = self.reader.likeliest(self._clause, skill, captions()[skill.value]) if self._clause else ()
        caption = usual(skill, mood, pace)
        caption = caption if not ways or caption in ways else ways[0]
        self.body.put(index, skill, mood, caption, resting.furniture, resting.room)
        self.body.resting = None

    def _walk(self, index: int, read: ReadBeat, deed: Deed, mood: Emotion) -> None:
        captions = deed.row.captions or captions_of(Skill.LOCO, mood)
        caption = self._one_of(captions, mood, index, Skill.LOCO)
        last = self.keyframes[-1] if self.keyframes else None
        piece = next((one for one in deed.pieces if self.places.has(one)), "floor")
        on_knees = _ON_KNEES.get(caption, caption)
        if last is not None and last.caption.startswith("kneeling") and on_knees in _ON_KNEES.values():
            self.keyframes[-1] = last.model_copy(update={"caption": on_knees})
            self.deeds[index] = replace(deed, row=replace(deed.row, captions=(on_knees,)))
            self.body.show(index)
            return
        stood, self._opening = self._opening, opening_of(Skill.LOCO, read.text)
        done = (Skill.LOCO, caption, piece, deed.row.holds)
        same = last is not None and (last.skill, last.caption, last.furniture, last.held) == done
        same = same and (last is None or mood in (last.mood, Emotion.NEUTRAL))  # "reads it, smiles and answers"
        if same and (stood is self._opening or self._opening is None):  # who stood still looks out of the window then
            others = [one for one in captions if one != caption]
            if not others:
                self.body.show(index)
                return
            caption = others[0]
        lies_at = self.body.whereabouts.of(read.clause, deed) if deed.is_gesture and piece == "floor" else None
        if lies_at is not None and self.places.has(lies_at[1]):  # "the letter lies on the table. She opens it"
            piece = lies_at[1]
        if deed.is_gesture and not deed.row.walks:  # gone to, then done there
            elsewhere = bool(self.keyframes) and read.room not in (None, self.body.room)
            touched = last is not None and (last.skill, last.furniture) == (Skill.TOUCH, piece)
            if elsewhere if piece == "floor" else not (touched or self.body.is_there(piece, read.room)):
                self.body.put(index, Skill.LOCO, mood, usual(Skill.LOCO, mood), piece, read.room)
            piece = "floor"
        self.body.put(index, Skill.LOCO, mood, caption, piece, read.room, deed.row.holds)
        self.body.resting = None
        if deed.named and piece != "floor":
            self.body.whereabouts.brought(read.clause, (read.room, piece))
        if piece == "bed" and _TO_BED.search(read.text):
            self._rest(index, read, Deed(deed.row, Skill.LIEDOWN, (piece,), True), mood, Skill.LIEDOWN, ())

    def _feel(self, index: int, beats: Sequence[ReadBeat]) -> None:
        """A mood alone: shown by what is done in it next, or was just done; else by a walk."""
        self.moody.add(index)
        mood = beats[index].beat.emotion
        for later in range(index + 1, len(beats)):
            if beats[later].beat.emotion is not mood or beats[later].clause.sentence > beats[index].clause.sentence + 1:
                break
            if beats[later].beat.kind == "deed" and self.reader.deed(beats[later].clause) is not None:
                return
        last = self.keyframes[-1] if self.keyframes else None
        if last is not None and last.mood is mood:
            self.body.show(index)
        elif self.body.sleeps or (
            last is not None and self.body.calling is last
        ):  # nobody wakes for a mood, nor hangs up
            self.body.go_on(index, mood)
        elif last is not None and self.body.resting is not None and self.body.plain:
            caption = self._one_of(captions_of(last.skill, mood), mood, index, last.skill)
            self.keyframes[-1] = self.body.resting = last.model_copy(update={"caption": caption, "emotion": mood.value})
            self.body.show(index)
        elif beats[index].clause.verb in EXPRESSIONS and mood not in EXPRESSED:
            self.why[index] = UNSHOWN
        elif last is not None and self.body.resting is not None:  # nobody gets up for a mood
            caption = self._one_of(captions_of(last.skill, mood), mood, index, last.skill)
            self.body.put(index, last.skill, mood, caption, last.furniture, last.room)
            self.body.resting = self.keyframes[-1]
        else:  # a face shows who smiles or sighs
            face = beats[index].clause.verb in EXPRESSIONS and mood is not Emotion.ANGRY
            caption = "stand still" if face else walk_of(mood)
            self.body.put(index, Skill.LOCO, mood, caption, "floor", beats[index].room)
            self.body.resting = None

    def _add(
        self, index: int, read: ReadBeat, deed: Deed, mood: Emotion, skill: Skill, captions: Sequence[str]
    ) -> bool:
        """A keyframe at furniture: of a script where one does the same, else written; False where there is none."""
        part = self.part_of(index) if mood is read.beat.emotion else None
        if part is not None and is_gainsaid(read.clause, part.keyframes[-1:]):
            part = None
        at = next((one.furniture for one in self.keyframes[:-3:-1] if not one.on_floor), "floor")
        by_pronoun = deed.named and not pieces_in(read.clause.text) and (
            bool({"it", "them"} & {*read.clause.lemmas}) or deed.pieces[:1] == ("picture",)
        )  # fmt: skip
        meant = replace(deed, named=deed.named and not by_pronoun)  # "it" is the parcel, not the table it was set on
        linked = self.body.whereabouts.of(read.clause, meant) if skill is Skill.TOUCH else None
        if linked is not None and affords(linked[1], "touch") and self.places.has(linked[1]):
            part, deed = None, replace(deed, pieces=(linked[1],), named=True)  # where the thing is
            read = replace(read, room=linked[0] or read.room)
            self.linked.add(index)
        if part is not None and at in deed.pieces and at != part.keyframes[-1].furniture:
            part = None  # nobody goes elsewhere for what is done where one is
        if part is not None and self.body.resting is not None and skill is Skill.TOUCH:
            part = None if furniture.class_of(part.keyframes[-1].furniture) in SEATS else part  # nor to another seat
        if part is not None and deed.named and not is_at(part.keyframes[-1], deed):
            part = None  # the same is done at another place already
        same = part is not None and part.keyframes[-1].skill is skill
        if (
            part is not None
            and same
            and all(self.places.has(one.piece[0], read.room or part.script.room) for one in part.keyframes)
        ):
            # Where one is, if such a room has it too: that is decided when the home is found.
            self._take_part(index, part, read.room or (None if self.body.room else part.script.room))
            self._lay(read, skill)
            return True
        room, piece = self.places.of(read, deed, skill, self.body, self._ahead)
        if not piece:
            self.why[index] = f"the home has nothing to {NEEDS[skill]} {'at' if skill is Skill.TOUCH else 'on'} for it"
            return False
        caption = self._one_of(captions, mood, index, skill)
        last = self.keyframes[-1] if self.keyframes else None
        done = (skill, caption, piece, deed.row.holds)
        if last is not None and (last.skill, last.caption, last.furniture, last.held) == done:
            others = [one for one in captions if one != caption]
            if not others:
                self.body.show(index)
                return True
            caption = others[0]
        self.body.is_there(piece, room)
        for here in self.keyframes[-1:]:  # where one is nobody walks to
            same = here.furniture == piece and (piece != "floor" or self.body.resting is not None)
            room = here.room if same and None in (room, here.room) else room
        self.body.put(index, skill, mood, caption, piece, room, deed.row.holds)
        self._lay(read, skill)
        return True

    def _lay(self, read: ReadBeat, skill: Skill) -> None:
        """Note where hands have just done something."""
        if skill is Skill.TOUCH:
            self.body.whereabouts.laid(read.clause, (self.keyframes[-1].room, self.keyframes[-1].furniture))

    def _take_part(self, index: int, part: Part, room: str | None) -> None:
        """The keyframes of a part of a script, without a walk to where one is."""
        self.parts.append((index, part))
        *leading, done = part.keyframes
        resting = self.body.resting
        goes_on = resting is not None and resting.furniture == done.furniture and done.skill is not Skill.TOUCH
        if goes_on or self.body.stays(done, room):  # who drinks in bed lies back there
            leading, room = [], self.keyframes[-1].room
        elif leading and self.body.is_there(leading[0].furniture, room):
            leading = []
        for keyframe in (*leading, done):
            update = {"beat": index, "short_script": len(self.parts) - 1, "room": room}
            self.keyframes.append(keyframe.model_copy(update=update))

    def _one_of(self, captions: Sequence[str], mood: Emotion, index: int, skill: Skill) -> str:
        """One caption by the seed, of those that are likeliest to show it and that the library uses in the mood."""
        if self._clause is not None:
            captions = _seen(self._clause, skill, captions)
            captions = self.reader.likeliest(self._clause, skill, captions)
        told = [one for one in captions if self._clause is not None and shows(skill, one, self._clause)]
        options = fitting(told or captions, skill, mood)
        return options[int(np.random.default_rng([self.seed, index]).integers(len(options)))]


def _seen(clause: Clause, skill: Skill, some: Sequence[str]) -> Sequence[str]:
    """Those of some captions that a deed may be seen in: the only ones that show it, of the skill's where they have
    none and are no gestures, and nobody gets down on the floor for what is not told to be low."""
    if some and (all(map(is_talk, some)) or captions_of_gestures().issuperset((skill, one) for one in some)):
        return some
    parts = only_in(clause) or ()
    only = [[one for one in those if any(part in one.lower() for part in parts)]
            for those in (some, captions()[skill.value])]  # fmt: skip
    if any(only):
        return only[0] or only[1]
    standing = [one for one in some if "prone" not in one or _LOW_DOWN.search(clause.text)]
    return standing or (TOUCHES if skill is Skill.TOUCH else some)
