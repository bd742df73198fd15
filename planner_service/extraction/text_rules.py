"""A scene of a text to short scripts, by rules: what somebody in it does, as a body shows it, and a summary of that."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, groupby
from typing import Final

from motion_backend.motion import Emotion
from planner_service.composition.deed_lexicon import deed_of
from planner_service.composition.furniture_words import room_of
from planner_service.composition.keyframe_writer import KeyframeWriter
from planner_service.extraction.llm_text import fitting
from planner_service.extraction.script_writer import Draft, Maker
from planner_service.extraction.text_scenes import Line, TextScene
from planner_service.scripts.emotions import feelings
from planner_service.scripts.script import EMOTIONS, Keyframe, PlannedKeyframe
from planner_service.scripts.script_repair import repair
from planner_service.themes.beats import MAX_THEME_LENGTH, ReadBeat, read_beats, rooms_in
from planner_service.themes.clause import Clause
from planner_service.themes.protagonist import head_of, hero_of, is_person, pronouns_of
from planner_service.themes.sentence_parser import clauses_of_text
from planner_service.themes.verb_finder import is_plural

_MAX_DEEDS: Final = 6
"""Deeds of one short script; a scene with more is told in several."""
_PRONOUNS: Final = ("he", "she")
_NOTHING: Final = "nobody in it does what a body can act"


@dataclass(frozen=True)
class SceneRead:
    """What came of one scene."""

    drafts: tuple[Draft, ...]
    unused: tuple[str, ...] = ()
    """Clauses that no keyframe shows, each with the reason."""
    reason: str = ""
    """Why nothing came of it."""
    room: str = ""


def read_scene(scene: TextScene, maker: Maker, room: str = "") -> SceneRead:
    """The short scripts of a scene; `room` is where the scene before it played, for one that names none."""
    if scene.outside:
        return SceneRead((), (), f"it plays outside the home ({scene.place})", room)
    lines, clauses = _clauses_in(scene)
    beats, hero = read_beats(clauses), hero_of(clauses)
    room = _room_of(scene, beats, room)
    writer = KeyframeWriter()
    placed = _placed(beats, room, _mood_of(scene, beats))
    for index in range(len(beats)):
        writer.write(index, placed)
    unused = tuple(
        f"{beats[at].text}: {_why(beats[at], hero, why)}" for at, why in writer.why.items() if _tells(beats[at])
    )
    deeds = [read.clause for at, read in enumerate(beats) if at not in writer.why and read.beat.kind == "deed"]
    if not any(map(deed_of, deeds)):  # somebody only feels
        return SceneRead((), unused, _NOTHING if beats else "there is only speech in it", room)
    drafts: list[Draft] = []
    stretches = _cut(writer)
    firsts = [0, *(stretch[0].beat or 0 for stretch in stretches[1:]), len(beats)]
    for stretch, first, end in zip(stretches, firsts, firsts[1:], strict=False):
        acted = _in_moods(repair(stretch)[0])  # walks and risings between deeds are no news
        told = [(beats[at], lines[at]) for at in range(first, end) if at not in writer.why]
        if acted:
            drafts.append(_draft(told, acted, room, hero, maker))
    return SceneRead(tuple(drafts), unused, "" if drafts else _NOTHING, room)


def _placed(beats: Sequence[ReadBeat], room: str, mood: Emotion) -> list[ReadBeat]:
    """Beats in the room they play in, and in the scene's mood where nobody is told to feel any."""
    felt = [read.in_mood(mood) for read in beats] if mood is not Emotion.NEUTRAL else beats
    return [replace(read, room=read.room or room) for read in felt]


def _draft(
    told: Sequence[tuple[ReadBeat, Line]], acted: Sequence[PlannedKeyframe], room: str, hero: str, maker: Maker
) -> Draft:
    """The short script of what some beats tell."""
    keyframes = [Keyframe(**keyframe.model_dump(include=set(Keyframe.model_fields))) for keyframe in acted]
    moods = Counter(keyframe.mood for keyframe in acted if keyframe.mood is not Emotion.NEUTRAL)
    emotion = next((mood for mood, _ in moods.most_common(1)), Emotion.NEUTRAL)
    starts = [line.start for _, line in told if line.start is not None]
    ends = [line.end for _, line in told if line.end is not None]
    span = (min(starts, default=None), max(ends, default=None))
    clauses = [one.text for one in (read.clause for read, _ in told) if one.verb and _is_own(one)]
    return maker.by_rules(clauses, keyframes, emotion, room, span, (hero,) if hero else ())


def _clauses_in(scene: TextScene) -> tuple[list[Line], list[Clause]]:
    """What the scene tells, clause by clause, each with its line."""
    found: list[tuple[Line, Clause]] = []
    for line in scene.lines:
        # The time that finding sentences takes grows with the square of a text's length.
        for text in () if line.spoken else fitting(line.text, MAX_THEME_LENGTH):
            first = found[-1][1].sentence + 1 if found else 0
            found += [(line, replace(one, sentence=first + one.sentence)) for one in clauses_of_text(text)]
    return [line for line, _ in found], _named([clause for _, clause in found])


def _named(clauses: Sequence[Clause]) -> list[Clause]:
    """With "he", "she" and "the man" as whom they stand for: the last that was named and may be called so."""
    people: dict[str, str] = {}
    """Their names and pronouns, the last that was named last."""
    named: list[Clause] = []
    for clause in clauses:
        who, called = clause.doer, pronouns_of(clause.doer)
        is_pronoun = who.lower() in _PRONOUNS
        known = [one for one, pronouns in people.items() if pronouns == called or (is_pronoun and not pronouns)]
        the_only = who.lower().startswith("the ") and called and len(known) == 1
        if known and (is_pronoun or the_only):
            clause = replace(clause, doer=known[-1], subject=clause.subject and known[-1])
        elif is_person(who) and not is_pronoun and not is_plural(head_of(who).lower()):
            people.pop(who, None)
            people[who] = called
        named.append(clause)
    return named


def _tells(read: ReadBeat) -> bool:
    """Whether it is a clause: a heading is none, and a word alone says little."""
    return bool(read.clause.verb) and " " in read.text


def _why(read: ReadBeat, hero: str, why: str) -> str:
    """Why a beat is not shown; somebody else's deed would be, were the script about them."""
    if read.beat.who and is_person(read.beat.who) and hero and deed_of(read.clause) is not None:
        return f"the script follows {'somebody else' if hero.lower() in _PRONOUNS else hero}"
    return why


def _room_of(scene: TextScene, beats: Sequence[ReadBeat], before: str) -> str:
    """The room type a scene plays in: by its slugline, its words, its deeds, the scene before, else living room."""
    named = (*rooms_in(f"in the {scene.place}"), *rooms_in(scene.told))
    votes = Counter(room for read in beats if read.beat.kind == "deed" and (room := room_of(read.clause)))
    return next(iter([*named, *(room for room, _ in votes.most_common(1))]), before or "living_room")


def _mood_of(scene: TextScene, beats: Sequence[ReadBeat]) -> Emotion:
    """The mood of a scene in which nobody is told to feel any: what is said shows it."""
    if any(read.felt for read in beats):
        return Emotion.NEUTRAL
    said = Counter(one.emotion for one in feelings(scene.spoken) if one.sure and one.emotion != "neutral")
    return said.most_common(1)[0][0] if said else Emotion.NEUTRAL


def _cut(writer: KeyframeWriter) -> list[list[PlannedKeyframe]]:
    """Its keyframes in as few stretches as hold so many deeds each, all about as long."""
    groups = [list(group) for _, group in groupby(writer.keyframes, key=lambda keyframe: keyframe.beat)]
    deeds = [1 + sum(len(keyframe.also) for keyframe in group) for group in groups]
    *before, total = accumulate(deeds, initial=0)
    for parts in range(min(-(-total // _MAX_DEEDS), len(groups)), len(groups) + 1):
        share = [done * parts // total for done in before]
        sizes = Counter[int]()
        for part, size in zip(share, deeds, strict=True):
            sizes[part] += size
        if max(sizes.values()) <= _MAX_DEEDS:
            break
    numbered = zip(share, groups, strict=True)
    return [[one for _, group in some for one in group] for _, some in groupby(numbered, key=lambda pair: pair[0])]


def _is_own(clause: Clause) -> bool:
    """Whether it is the person's deed, and not their hands' or tears'."""
    return not clause.subject or is_person(clause.subject)


def _in_moods(keyframes: Sequence[PlannedKeyframe]) -> list[PlannedKeyframe]:
    """With the risings that were put in acted in the mood of what they lead to."""
    moods = [keyframe.mood for keyframe in keyframes[1:]]
    return [
        keyframe.model_copy(update={"emotion": mood.value}) if keyframe.emotion not in EMOTIONS else keyframe
        for keyframe, mood in zip(keyframes, [*moods, Emotion.NEUTRAL], strict=True)
    ]
