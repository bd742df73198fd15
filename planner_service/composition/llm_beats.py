"""A theme planned by a language model in one structured answer: person, beats, and how each is served.

Every beat is judged alone. What is obviously meant is mended, and what is not falls to the rules; only an answer of
which nothing can be used is asked for again, once, and then given up.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import zip_longest
from typing import Annotated, Any, Final, get_args

from pydantic import BaseModel, BeforeValidator, ValidationError

import prompts
from motion_backend.emotion_words import emotion_of
from motion_backend.motion import RISINGS, Emotion, Skill
from planner_service.composition.beat_schema import SERVES, BeatsAnswer, answer_type
from planner_service.llm.protocol import LanguageModel
from planner_service.llm.structured_output import ask
from planner_service.scripts.caption_fallbacks import hashed_words
from planner_service.scripts.captions import captions_offered, furniture_offered
from planner_service.scripts.script import (
    MAX_NAME_LENGTH,
    Beat,
    BeatKind,
    Keyframe,
    Person,
    Pronouns,
    ShortScript,
    legible,
)
from planner_service.scripts.script_library import ScriptLibrary
from planner_service.scripts.script_repair import read_keyframe
from planner_service.scripts.script_words import Fitting
from planner_service.themes.beats import ReadBeat, ThemeError, beats_of, read_beats
from planner_service.themes.lexicon import grammar, lemma_of
from planner_service.themes.sentence_parser import clauses_of_text
from scene_graphs.furniture import affordances, categories_of

MAX_OFFERED: Final = 12
"""Scripts shown to the model."""
MAX_PROMPT: Final = 11_400
"""Letters of a prompt, the theme's own beyond `_USUAL_THEME` aside: with an answer of twelve beats 4,000 tokens."""
MAX_KEYFRAMES: Final = 4
"""Keyframes a beat on average, connecting walks aside."""
MAX_BEATS: Final = 24
_MIN_SHARED: Final = 0.3
"""Share of a beat's words that are the theme's: a model that gives back its prompt plans nothing."""
_USUAL_THEME: Final = 400
_MAX_SUMMARY: Final = 110
"""Letters of a summary that are shown."""
_NOT_SHOWN: Final[dict[BeatKind, str]] = {
    "undone": "it is not done",
    "speech": "it is said, not done",
    "other": "it is not this person's deed",
}
"""Kinds of beats that no body acts, and why."""
_KINDS: Final = {"action": "deed", "emotion": "feeling", "mood": "feeling", "negated": "undone", "not done": "undone",
                 "thought": "memory", "flashback": "memory", "dialogue": "speech", "event": "other"}  # fmt: skip
"""Other words for kinds, as models write them."""
_DOUBTED: Final = frozenset(("try", "rather", "if", "would"))
"""Words besides those of wishes and refusals in whose sentence something may be left undone."""
_PIECE: Final = re.compile(r"(?<=[.!?;])\s+|,\s+|\s+(?:and|then|but|before|after|while|because)\s+", re.IGNORECASE)
_SENTENCE: Final = re.compile(r"(?<=[.!?;])\s+")
_COMMON_WORDS: Final = """and are but for from had has have her him his into its not out she that the their them then
they this was were what when who with very"""
_COMMON: Final = frozenset(_COMMON_WORDS.split())


@dataclass(frozen=True)
class PlannedBeat:
    """A beat of the theme, and what is acted for it."""

    beat: Beat
    keyframes: tuple[Keyframe, ...] | None
    """None: the rules serve it. Empty: nothing shows it, and the beat says why."""
    script: str | None = None
    """Id of the short script that its keyframes are of."""
    note: str = ""
    """What was mended, or why it falls to the rules."""


@dataclass(frozen=True)
class PlannedTheme:
    """A theme as a language model planned it."""

    person: Person
    beats: tuple[PlannedBeat, ...]
    notes: tuple[str, ...] = ()
    """What was left out of the answer as a whole."""


def plan_beats(
    model: LanguageModel, theme: str, library: ScriptLibrary, furniture: Sequence[str] | None = None
) -> PlannedTheme:
    """The beats of a theme, each with the keyframes that show it. ModelError after two answers without a usable beat.

    `furniture` names what a given home has; left out, everything there is may be used.
    """
    there = furniture_offered().split(", ") if furniture is None else list(furniture)
    prompt, offered = _prompt(theme, library, there)
    reader = _Reader(theme, library)

    def problems(answer: BeatsAnswer) -> list[str]:
        beats, notes = reader.beats(answer)
        if any(one.keyframes for one in beats):
            return []
        return list(dict.fromkeys(["beats: none of them can be used", *notes, *filter(None, (b.note for b in beats))]))

    answer = ask(model, prompt, answer_type(offered, there), problems, repairs=1)
    beats, notes = reader.beats(answer)
    return PlannedTheme(_person(answer.person, theme), tuple(_bounded(_completed(beats, theme))), tuple(notes))


def _prompt(theme: str, library: ScriptLibrary, furniture: Sequence[str]) -> tuple[prompts.Filled, list[ShortScript]]:
    """The prompt, with as many of the nearest scripts as there is room for, and these scripts."""

    def filled(rows: Sequence[str]) -> prompts.Filled:
        return prompts.render(
            "plan_beats", theme=theme, scripts="\n".join(rows) or "(none)", furniture=", ".join(furniture),
            captions=captions_offered(), most=str(MAX_KEYFRAMES),
        )  # fmt: skip

    room = MAX_PROMPT - len(filled(())) + max(0, len(theme) - _USUAL_THEME)
    offered, rows = [], []
    for script in _offers(theme, library):
        row = _row(script)
        room -= len(row) + 1
        if room < 0:
            break
        offered.append(script)
        rows.append(row)
    return filled(rows), offered


def _offers(theme: str, library: ScriptLibrary) -> list[ShortScript]:
    """The scripts nearest to the theme's parts, those that come first for some part before all others."""
    parts = [part.strip(" .!?,;") for part in _PIECE.split(theme)]
    queries = [part for part in parts if len(part.split()) > 1][:MAX_BEATS] or [theme]
    found = [[one.script for one in library.search(query, 4)] for query in dict.fromkeys(queries)]
    ranked = [script for rank in zip_longest(*found) for script in rank if script is not None]
    return list({script.id: script for script in ranked}.values())[:MAX_OFFERED]


def _row(script: ShortScript) -> str:
    """A script in two lines: "id [room, emotion] summary", then its numbered keyframes; how one walks is left out."""
    keyframes = "; ".join(
        f"{number} {keyframe.skill} {keyframe.furniture}"
        + (f" ({keyframe.caption})" if keyframe.skill in (Skill.SITDOWN, Skill.LIEDOWN, Skill.TOUCH) else "")
        for number, keyframe in enumerate(script.keyframes)
    )
    summary = script.summary.replace("the character", "X").replace("The character", "X")
    shown = summary if len(summary) <= _MAX_SUMMARY else summary[: _MAX_SUMMARY - 1] + "…"
    return f"{script.id} [{script.room}, {script.emotion}] {shown}\n  {keyframes}"


def _plain(value: object) -> object:
    """A word of choice as it was meant: in small letters, without blanks around it."""
    return value.strip().lower() if isinstance(value, str) else value


def _number(value: object) -> object:
    return value if isinstance(value, int) and not isinstance(value, bool) else 0


Loose = Annotated[str, BeforeValidator(lambda value: _plain(value) if isinstance(value, str) else "")]


class _Row(BaseModel):
    """One beat as a model wrote it."""

    text: Annotated[str, BeforeValidator(legible)]
    kind: Loose = ""
    who: Annotated[str, BeforeValidator(lambda value: legible(value) if isinstance(value, str) else "")] = ""
    emotion: Loose = ""
    serve: Loose = ""
    script: Loose = ""
    first: Annotated[int, BeforeValidator(_number)] = 0
    last: Annotated[int, BeforeValidator(_number)] = 0
    keyframes: Annotated[list[Any], BeforeValidator(lambda value: value if isinstance(value, list) else [])] = []


@dataclass(frozen=True)
class _Reader:
    """Reads the beats of one theme's answer."""

    theme: str
    library: ScriptLibrary

    def beats(self, answer: BeatsAnswer) -> tuple[list[PlannedBeat], list[str]]:
        """The beats that are of the theme, and what was left out."""
        read: list[PlannedBeat] = []
        notes: list[str] = []
        for number, row in enumerate(answer.beats[:MAX_BEATS]):
            try:
                beat = _Row.model_validate(row)
            except ValidationError:
                notes.append(f"beats.{number}: it has no text, left out")
                continue
            if not 0 < len(beat.text) <= 300 or not _is_of(beat.text, self.theme, _MIN_SHARED):
                notes.append(f"beats.{number}: {beat.text[:60]!r} is not in the theme, left out")
                continue
            times = sum(one.beat.text == beat.text for one in read)
            if times >= max(1, self.theme.count(beat.text)):
                notes.append(f"beats.{number}: {beat.text[:60]!r} is there already, left out")
                continue
            read.append(self._beat(beat))
        if len(answer.beats) > MAX_BEATS:
            notes.append(f"beats: {len(answer.beats)} of them, {MAX_BEATS} were read")
        return read, notes

    def _beat(self, row: _Row) -> PlannedBeat:
        kind, doubt = self._kind(row)
        beat = Beat(text=row.text, emotion=emotion_of(row.emotion) or Emotion.NEUTRAL, kind=kind, who=row.who[:60])
        if doubt:
            return PlannedBeat(beat, None, note=f"“{row.text[:60]}” by rules: {doubt}")
        if kind in _NOT_SHOWN:
            dropped = f"“{row.text[:60]}”: its keyframes are left out, {_NOT_SHOWN[kind]}"
            served = row.keyframes or row.serve not in ("none", "")
            return PlannedBeat(_unshown(beat, _NOT_SHOWN[kind]), (), note=dropped if served else "")
        return self._served(row, beat)

    def _kind(self, row: _Row) -> tuple[BeatKind, str]:
        """The beat's kind, and why it cannot be believed, if that is so."""
        word = _KINDS.get(row.kind, row.kind)
        kind: BeatKind = word if word in get_args(BeatKind) else "deed"  # type: ignore[assignment]
        told = max(self._told, key=lambda one: len(_stems(one.text) & _stems(row.text)), default=None)
        denied = (told is not None and told.clause.denied) or any(one.denied for one in clauses_of_text(row.text)[:1])
        if kind in ("deed", "feeling") and denied:
            return "undone", ""
        if kind == "undone" and not (denied or (told is not None and self._is_doubtful(told))):
            return "deed", "the theme does not leave it undone"
        return kind, "" if word == kind else f"{row.kind!r} is no kind of beat"

    @cached_property
    def _told(self) -> tuple[ReadBeat, ...]:
        """The beats of the theme as the rules read it."""
        return read_beats(clauses_of_text(self.theme))

    def _is_doubtful(self, told: ReadBeat) -> bool:
        """Whether a beat's sentence tells of something that is not done, or only wished for, tried or remembered."""
        near = [one for one in self._told if one.clause.sentence == told.clause.sentence]
        words = {lemma for one in near for lemma in map(lemma_of, one.text.split())}
        known = grammar()
        doubted = not words.isdisjoint(known.wishes | known.refusals | _DOUBTED)
        return doubted or any(one.beat.kind != "deed" for one in near)

    def _served(self, row: _Row, beat: Beat) -> PlannedBeat:
        script = self.library.find(re.sub(r"[\s_]+", "-", row.script)) if row.script else None
        serve = row.serve
        if serve not in SERVES or (serve in ("take", "trim") and not row.script):
            serve = "write" if row.keyframes else "take" if script else serve
        if serve == "none":
            return PlannedBeat(_unshown(beat, "no furniture or motion there is shows it"), ())
        if serve in ("take", "trim") and script is not None:
            return _believed(_cut_out(row, beat, script) if serve == "trim" else _taken(beat, script))
        if row.keyframes:
            return _believed(_written(row, beat))
        fault = f"there is no script {row.script[:60]!r}" if row.script else "it has no keyframes"
        return PlannedBeat(beat, None, note=f"“{row.text[:60]}” by rules: {fault}")


def _unshown(beat: Beat, why: str) -> Beat:
    return beat.model_copy(update={"why": why})


def _taken(beat: Beat, script: ShortScript) -> PlannedBeat:
    return PlannedBeat(beat, script.keyframes, script.id)


def _believed(one: PlannedBeat) -> PlannedBeat:
    """The beat as it is, unless it rests on other furniture than its words name: then the rules serve it."""
    rests = [keyframe for keyframe in one.keyframes or () if keyframe.skill in (Skill.SITDOWN, Skill.LIEDOWN)]
    named = [word for word in re.findall(r"[a-z]+", one.beat.text.lower()) if word in _seats()]
    if not rests or not named:
        return one
    wanted = frozenset().union(*map(categories_of, named))
    if any(keyframe.on_floor or not wanted.isdisjoint(categories_of(keyframe.piece[0])) for keyframe in rests):
        return one
    why = f"it is played at the {rests[0].furniture}, not at the {named[0]}"
    return PlannedBeat(one.beat, None, note=f"“{one.beat.text[:60]}” by rules: {why}")


@cache
def _seats() -> frozenset[str]:
    """Words of one word for what one sits or lies on."""
    known = furniture_offered().lower().split(", ")
    return frozenset(word for word in known if " " not in word and all(map(_rested_on, categories_of(word))))


def _rested_on(category: str) -> bool:
    return not affordances(category).isdisjoint(("sit", "lie"))


def _cut_out(row: _Row, beat: Beat, script: ShortScript) -> PlannedBeat:
    """The part of a script between two of its keyframes, which may stand the wrong way round or beyond its end."""
    end = len(script.keyframes) - 1
    first, last = sorted(min(max(place, 0), end) for place in (row.first, row.last))
    mended = (first, last) != (row.first, row.last)
    note = f"“{row.text[:60]}”: keyframes {first} to {last} of {script.id} are meant" if mended else ""
    return PlannedBeat(beat, script.keyframes[first : last + 1], script.id, note)


def _written(row: _Row, beat: Beat) -> PlannedBeat:
    """Keyframes in words that the body knows; those that no skill can be read in are left out."""
    keyframes, faults = [], []
    for number, one in enumerate(row.keyframes):
        try:
            keyframes.append(read_keyframe(one))
        except (ValidationError, TypeError, AttributeError):
            faults.append(f"its step {number + 1} cannot be read")

    def note(index: int, _field: str, fault: str, remedy: str) -> None:
        faults.append(f"its step {index + 1}: {fault}; {remedy}")

    fitted = Fitting[Keyframe](note, hashed_words()).fit(keyframes)
    told = f"“{row.text[:60]}”: {'; '.join(faults)}" if faults else ""
    return PlannedBeat(beat, tuple(fitted) or None, note=told)


def _is_of(text: str, theme: str, share: float = 0.0) -> bool:
    """Whether a beat's words are of the theme: it shares the beginning of one that is not everywhere, or so many."""
    words = _stems(text)
    return len(words & _stems(theme)) >= max(1, share * len(words))


def _stems(text: str) -> set[str]:
    words = re.findall(r"[^\W\d_]{3,}", text.lower())
    return {word[:3] for word in words if word not in _COMMON} or {word[:3] for word in words}


def _completed(beats: Sequence[PlannedBeat], theme: str) -> list[PlannedBeat]:
    """The beats, with those of sentences that the model left out: the rules read and serve these."""
    whole, place = list(beats), 0
    for sentence in _SENTENCE.split(theme):
        of_it = [number for number, one in enumerate(whole) if _is_of(one.beat.text, sentence)]
        if of_it or not _stems(sentence):
            place = max([place, *(number + 1 for number in of_it)])
            continue
        with suppress(ThemeError):
            left = [PlannedBeat(read.beat, None, note=_left_out(read.beat)) for read in beats_of(sentence)]
            whole[place:place] = left
            place += len(left)
    return whole


def _left_out(beat: Beat) -> str:
    return f"“{beat.text[:60]}” by rules: the model left it out"


def _person(row: object, theme: str) -> Person:
    """Whom the theme is about, as far as that can be believed: nobody is named whom the theme does not name."""
    given = row if isinstance(row, dict) else {}
    name, pronouns, age = legible(given.get("name")), _plain(given.get("pronouns")), given.get("age")
    good = isinstance(name, str) and 0 < len(name) <= MAX_NAME_LENGTH and name.isprintable()
    named = good and re.search(rf"\b{re.escape(str(name))}\b", theme) is not None
    said = pronouns.partition("/")[0] if isinstance(pronouns, str) else ""
    old = isinstance(age, int) and not isinstance(age, bool) and 0 <= age <= 120
    return Person(
        name=str(name) if named else "",
        pronouns=said if said in get_args(Pronouns) else "",
        age=age if old else None,
    )


def _bounded(beats: Sequence[PlannedBeat]) -> Iterator[PlannedBeat]:
    """The beats with at most `MAX_KEYFRAMES` keyframes on average, cut where there are most."""
    kept = list(beats)
    shown = [number for number, one in enumerate(kept) if one.keyframes]
    before = {number: len(kept[number].keyframes or ()) for number in shown}
    while shown and sum(_counted(kept[number]) for number in shown) > MAX_KEYFRAMES * len(shown):
        longest = max(shown, key=lambda number: (_counted(kept[number]), number))
        kept[longest] = replace(kept[longest], keyframes=_shorter(kept[longest].keyframes or ()))
    for number in shown:
        left = len(kept[number].keyframes or ())
        if left < before[number]:
            told = (
                f"“{kept[number].beat.text[:60]}”: {before[number] - left} of {before[number]} keyframes are left out"
            )
            kept[number] = replace(kept[number], note="; ".join(filter(None, (kept[number].note, told))))
    yield from kept


def _counted(one: PlannedBeat) -> int:
    keyframes = one.keyframes or ()
    return sum(not _leads(keyframes, index) for index in range(len(keyframes)))


def _leads(keyframes: Sequence[Keyframe], index: int) -> bool:
    """Whether a keyframe is only the walk to where the next one happens."""
    if keyframes[index].skill is not Skill.LOCO or index + 1 == len(keyframes):
        return False
    after = keyframes[index + 1]
    return after.skill is not Skill.LOCO and after.piece == keyframes[index].piece


def _shorter(keyframes: Sequence[Keyframe]) -> tuple[Keyframe, ...]:
    """Without what is missed least: a rising at the end, else the last walk about, else the last keyframe."""
    if keyframes[-1].skill in RISINGS:
        return tuple(keyframes[:-1])
    strolls = [index for index, one in enumerate(keyframes) if one.skill is Skill.LOCO and not _leads(keyframes, index)]
    out = strolls[-1] if strolls else len(keyframes) - 1
    left = [*keyframes[:out], *keyframes[out + 1 :]]
    while left and out == len(left) and left[-1].skill is Skill.LOCO and len(left) > 1:
        left.pop()  # a walk to what is not done any more
        out -= 1
    return tuple(left)
