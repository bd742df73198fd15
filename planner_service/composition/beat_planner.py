"""Retrieve, edit, write: every beat of a theme is served by a short script, a part of one, or keyframes written for it.

A short script only enriches where it agrees in act, mood, room and furniture; so nothing is acted that nobody asked
for (SIMS 3.2).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from motion_backend.motion import Emotion, Skill
from planner_service.composition.deed_lexicon import Deed
from planner_service.composition.deed_reader import DeedReader, classifier_of, shown_by
from planner_service.composition.earlier_deeds import with_its_noun
from planner_service.composition.gainsaid import is_gainsaid
from planner_service.composition.heard_events import with_reactions
from planner_service.composition.held_things import as_hands_hold, is_handled, with_things
from planner_service.composition.keyframe_writer import EXPRESSED, KeyframeWriter, Part
from planner_service.composition.llm_beats import PlannedBeat, PlannedTheme, plan_beats
from planner_service.composition.request import RULES, Record, Request
from planner_service.composition.rest_place import BY_A_WALL
from planner_service.composition.unacted_beats import UNSHOWN
from planner_service.composition.unshown import unseen
from planner_service.composition.whereabouts import is_held
from planner_service.composition.worked_fixtures import with_worked
from planner_service.llm.protocol import LanguageModel, ModelError
from planner_service.scripts.acted_beats import connects
from planner_service.scripts.script import Beat, Keyframe, LongScript, PlannedKeyframe, Retrieved, ShortScript
from planner_service.scripts.script_library import ScriptLibrary
from planner_service.scripts.script_repair import repair
from planner_service.scripts.script_search import rank
from planner_service.themes.beats import EXPRESSIONS, LANGUAGE, ReadBeat, ThemeError, beats_of, clean, read_beat
from planner_service.themes.details import details_of
from planner_service.themes.lexicon import lemma_of
from planner_service.themes.protagonist import names_somebody
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things, things_called
from planner_service.themes.verb_finder import tokens_of
from scene_graphs import furniture
from scene_graphs.furniture import canonical_room

FACES: Final = ("smile", "grin", "beam", "smirk", "frown", "scowl")
"""What is seen in a face, whatever else is done: nobody laughs or sobs in that alone."""
_OFFERED: Final = 6
"""Short scripts that are looked at for a beat."""
_LIKELY: Final = 3
"""Pieces of furniture where a deed is done most."""
_HEAP: Final = 3
"""So many words without a verb, or as many times those that are played, are no theme."""
_MIN_SCORE: Final = 0.3
"""How well a short script must answer a beat for a part of it to be taken."""


def serve_beats(
    theme: str, library: ScriptLibrary, request: Request, model: LanguageModel | None, record: Record
) -> LongScript:
    """The long script of a theme, beat by beat. ThemeError when nothing of it can be acted."""
    planned = _by_model(theme, library, request, model, record)
    read = tuple(read_beat(one.beat) for one in planned.beats) if planned else beats_of(theme)
    reader = _reader(read, library, request)
    read = read if planned else tuple(map(reader.heard, read))
    parts = {} if request.method == "direct" else PartFinder(library, reader, request.rooms).all_of(read)
    if planned is None or any(one.keyframes is None for one in planned.beats):
        record.planners.append(RULES)
    for spares in (True, False):  # of what is asked for something is seen, even if it only stands for it
        writer = KeyframeWriter(request.seed, request.furniture, reader, parts.get, spares)
        _write(writer, read, planned, library)
        if writer.keyframes:
            break
    if not writer.keyframes:
        writer.appear(read)
    if not writer.keyframes:
        told = "; ".join(
            f"“{one.text[:60]}”: {writer.why.get(index, UNSHOWN)}" for index, one in list(enumerate(read))[:4]
        )
        raise ThemeError(f"nothing in it can be acted by a body at home. {told}. {LANGUAGE}")
    acted, repairs = repair(writer.keyframes)
    acted = with_worked(read, with_things(read, acted))
    acted, reacted = with_reactions(read, acted if planned else as_hands_hold(acted))
    beats = _with_reasons(read, writer, acted, reacted)
    if not planned and _tells_of_nobody(read, beats):
        raise ThemeError(f"it tells of nobody, and of hardly anything that a body does at home. {LANGUAGE}")
    return LongScript(
        theme=theme,
        beats=beats,
        short_scripts=tuple(Retrieved(script=part.script, beat=beat, score=part.score) for beat, part in writer.parts),
        keyframes=acted,
        repairs=(*record.notes, *repairs),
        person=planned.person if planned else None,
        method=request.method,
        planner=record.planner,
        encoder="" if request.method == "direct" else library.encoder.name,
        seed=request.seed,
    )


def _tells_of_nobody(read: Sequence[ReadBeat], beats: Sequence[Beat]) -> bool:
    """Whether words name nobody and no verb, and hardly one of them is played: "Red, green, yellow, music"."""
    if any(one.clause.verb or names_somebody(one.clause) for one in read):
        return False
    return len(beats) >= _HEAP and _HEAP * sum(beat.seen for beat in beats) <= len(beats)


def _write(
    writer: KeyframeWriter, read: Sequence[ReadBeat], planned: PlannedTheme | None, library: ScriptLibrary
) -> None:
    """Keyframes for all beats: the model's, where it planned them."""
    writer.avoid(read)
    for index in range(len(read)):
        served = planned.beats[index] if planned else None
        if served is not None and served.keyframes is not None:
            writer.take(index, served.keyframes, served.beat.why, _named_part(served, library))
        else:
            writer.write(index, read)


def _reader(read: Sequence[ReadBeat], library: ScriptLibrary, request: Request) -> DeedReader:
    """The reader of a theme's deeds: by the table alone where that knows nothing of it, not even who is there; the
    classifier has an opinion of nonsense too."""
    by_table = KeyframeWriter(request.seed)
    for index in range(len(read)):
        by_table.write(index, read)
    by_table.appear(read)
    reader = DeedReader(classifier_of(library.encoder) if by_table.keyframes and request.method != "direct" else None)
    reader.hear(read)
    return reader


def _by_model(
    theme: str, library: ScriptLibrary, request: Request, model: LanguageModel | None, record: Record
) -> PlannedTheme | None:
    """The beats as the model plans them; None without a model or a usable answer."""
    if model is None:
        return None
    known = None if request.furniture is None else frozenset[str]().union(*request.furniture.values())
    there = None if known is None else sorted(furniture.display_name(word) for word in known)
    try:
        planned = plan_beats(model, clean(theme), library, there)
    except ModelError as error:
        record.failed("beats planned", error)
        return None
    record.planners.append(f"llm:{model.name}")
    record.notes.extend([*planned.notes, *(one.note for one in planned.beats if one.note)])
    return planned


def _named_part(served: PlannedBeat, library: ScriptLibrary) -> Part | None:
    """The script that a model's beat is served by, and how well it answers the beat; None where it wrote."""
    script = library.find(served.script or "")
    if script is None:
        return None
    return Part(script, float(rank([served.beat.text], library)[0][library.scripts.index(script)]), ())


def _with_reasons(
    read: Sequence[ReadBeat],
    writer: KeyframeWriter,
    keyframes: Sequence[PlannedKeyframe],
    reacted: Mapping[int, str],
) -> tuple[Beat, ...]:
    """The beats as they are planned: those that no keyframe shows with the reason; nobody is asked to do what is
    `reacted` to.

    What a mood alone shows ("grins") is a feeling, and shown wherever something is done in that mood.
    """
    shown = {beat for keyframe in keyframes for beat in (keyframe.beat, *keyframe.also) if beat is not None}
    moods = {keyframe.mood for keyframe in keyframes}
    beats = []
    for index, one in enumerate(read):
        if index in reacted:
            beats.append(one.beat.model_copy(update={"why": reacted[index]}))
            continue
        known = index in shown or (index in writer.moody and one.beat.emotion in moods)
        why = "" if known else writer.why.get(index, UNSHOWN)
        meant = with_its_noun(index, read)
        kind = "feeling" if index in writer.moody else meant[0].beat.kind
        besides = _besides(index, meant, writer, keyframes) if known else ()
        beats.append(one.beat.model_copy(update={"why": why, "kind": kind, "unshown": besides}))
    return tuple(beats)


def _besides(
    index: int,
    beats: tuple[ReadBeat, Sequence[ReadBeat]],
    writer: KeyframeWriter,
    keyframes: Sequence[PlannedKeyframe],
) -> tuple[str, ...]:
    """What an acted beat tells and no keyframe shows: all of it, where its keyframes only stand for it."""
    read, every = beats
    if index in writer.moody:
        seen = read.clause.verb not in EXPRESSIONS or (read.clause.verb in FACES and read.beat.emotion in EXPRESSED)
        known = (read.sure or read.beat.kind == "feeling") and seen and not _does_more(read)
        known = known and not is_gainsaid(read.clause, [one for one in keyframes if one.mood is read.beat.emotion])
        return details_of(read.clause) if known else (read.text,)
    deed = writer.deeds.get(index)
    own = [one for one in keyframes if index in (one.beat, *one.also)]
    if is_held(read.clause) and any(one.held for one in own):
        return unseen(read.clause, own)
    walks = deed is not None and deed.skill is Skill.LOCO
    own = [one for one in own if walks or not connects(one)] or own
    handled = is_handled(read.clause, own)
    if deed is not None and not (handled or writer.reader.is_shown(read.clause, deed, own, index in writer.linked)):
        return (read.text,)
    if read.beat.kind != "deed":
        return ()
    by = BY_A_WALL.search(read.text) if all(one.skill in (Skill.SITDOWN, Skill.LIEDOWN) for one in own) else None
    besides = unseen(read.clause, (*_led_by(own, keyframes), *own))
    if _is_of_a_pet(index, every):
        besides = ("it", *besides)
    # Seats stand where they do.
    return (*besides, by[0]) if by and not any(by[0] in one for one in besides) else besides


def _is_of_a_pet(index: int, beats: Sequence[ReadBeat]) -> bool:
    """Whether "it" in a beat is an animal that was named last: "the cat jumps down, so she picks | it | up"."""
    if "it" not in beats[index].clause.lemmas[1:]:
        return False
    words = (lemma_of(token.low) for one in reversed(beats[:index]) for token in reversed(tokens_of(one.text)))
    named = next((word for word in words if word in things()), "")
    return named in things_called("pet")


def _led_by(own: Sequence[PlannedKeyframe], keyframes: Sequence[PlannedKeyframe]) -> Sequence[PlannedKeyframe]:
    """The walk to a piece of furniture before which keyframes are done where that ends."""
    at = next((at for at, one in enumerate(keyframes) if one is own[0]), 0) if own else 0
    led = at > 0 and own[0].skill is Skill.LOCO and own[0].on_floor and connects(keyframes[at - 1])
    return keyframes[at - 1 : at] if led else ()


def _does_more(read: ReadBeat) -> bool:
    """Whether a beat of which only the mood is seen tells of something that is done in it: "plays a sad song"."""
    moods = theme_words()["state_verbs"] | {"", *EXPRESSIONS}
    return read.beat.kind == "deed" and read.clause.verb not in moods


@dataclass
class PartFinder:
    """Finds parts of short scripts that do beats' deeds as the beats say."""

    library: ScriptLibrary
    reader: DeedReader = field(default_factory=DeedReader)
    rooms: Sequence[str] = ()
    _used: set[int] = field(default_factory=set)

    def all_of(self, read: Sequence[ReadBeat]) -> dict[int, Part]:
        """For each beat the part of the nearest script in which deed, mood, room and furniture agree, if any does."""
        able = {index: parts for index, one in enumerate(read) if (parts := self._parts(one))}
        if not able:
            return {}
        scores = rank([read[index].text for index in able], self.library)  # of what some script does alone
        found = {}
        for row, (index, parts) in zip(scores, able.items(), strict=True):
            for place in map(int, np.argsort(-row, kind="stable")[:_OFFERED]):
                if place in parts and row[place] >= _MIN_SCORE and place not in self._used:
                    taken = tuple(PlannedKeyframe.model_validate(one.model_dump()) for one in parts[place])
                    found[index] = Part(self.library.scripts[place], float(row[place]), taken)
                    self._used.add(place)
                    break
        return found

    def _parts(self, read: ReadBeat) -> dict[int, Sequence[Keyframe]]:
        """The keyframes that do a beat's deed in its mood, by the places of the scripts that play where it may."""
        deed = self.reader.deed(read.clause) if read.beat.kind == "deed" else None
        if deed is None or deed.skill is Skill.LOCO:  # a walk alone is no part of a script
            return {}
        shown = [(read.beat.emotion, deed.skill, one) for one in shown_by(deed, read.beat.emotion)]
        rooms = (read.room,) if read.room else tuple(map(canonical_room, self.rooms))
        scripts = {place: self.library.scripts[place] for key in shown for place in self.library.captions.get(key, ())}
        return {
            place: part
            for place, script in scripts.items()
            if (not rooms or script.room in rooms) and (part := _part(script, read.beat.emotion, deed))
        }


def _part(script: ShortScript, mood: Emotion, deed: Deed) -> Sequence[Keyframe]:
    """The walk and the keyframe of a script that do a deed in a mood; empty where none does."""
    for place, keyframe in enumerate(script.keyframes):
        if keyframe.mood is mood and agrees(keyframe, deed):
            walk = script.keyframes[place - 1] if place else keyframe
            leads = walk.skill is Skill.LOCO and walk.furniture == keyframe.furniture
            return (walk, keyframe) if leads else (keyframe,)
    return ()


def agrees(keyframe: Keyframe, deed: Deed) -> bool:
    """Whether a script's keyframe does a deed, with a caption that shows it and nothing else, where it may be done."""
    if keyframe.skill is not deed.skill or not (deed.pieces or deed.row.captions):
        return False
    kinds = furniture.categories_of(keyframe.piece[0])
    pieces = [one for one in deed.pieces[: 1 if deed.named else _LIKELY] if one != "floor"]
    there = any(not kinds.isdisjoint(furniture.categories_of(one)) for one in pieces)
    return keyframe.caption in shown_by(deed, keyframe.mood) and (there or not deed.pieces)
