"""Theme → events → short scripts → one long script that a body can act out (SIMS 3.2; direct generation: SIMS 10)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final, Literal

import numpy as np

from motion_backend.motion import Emotion
from planner_service.composition import llm_planner
from planner_service.composition.direct_generation import direct_by_rules
from planner_service.composition.event_retrieval import Reading, read
from planner_service.composition.sequence_search import cast
from planner_service.llm.protocol import LanguageModel, ModelError
from planner_service.scripts.script import Beat, Keyframe, LongScript, PlannedKeyframe, Retrieved
from planner_service.scripts.script_library import ScriptLibrary
from planner_service.scripts.script_repair import repair
from planner_service.scripts.script_search import Found
from planner_service.scripts.suitability import Limits, Scores
from planner_service.themes.beats import (
    LANGUAGE,
    Clause,
    ThemeError,
    clause_of,
    clauses_of,
    grouped,
    moods_of,
    rooms_in,
)
from scene_graphs.furniture import ROOM_TYPES, canonical_room

Method = Literal["matching", "direct"]
MAX_SHORT_SCRIPTS: Final = 12
"""Short scripts in a long one."""
MIN_SHORT_SCRIPTS: Final = 2
"""Short scripts when the number is not asked for."""
_OFFERED: Final = 6
"""Candidates an event that a language model chooses from."""
_RULES: Final = "rules"
_ENGLISH: Final = re.compile(r"[a-z]", re.IGNORECASE)


@dataclass(frozen=True)
class Request:
    """What may be asked of a long script besides its theme."""

    short_scripts: int | None = None
    """How many, 1 to 12; None: one an event, and at least two."""
    rooms: tuple[str, ...] = ()
    """Room types to stay in; empty for all."""
    seed: int = 0
    method: Method = "matching"

    def __post_init__(self) -> None:
        if self.method not in ("matching", "direct"):
            raise ValueError(f"method: {self.method!r} is neither 'matching' nor 'direct'")
        if self.short_scripts is not None and not 1 <= self.short_scripts <= MAX_SHORT_SCRIPTS:
            raise ValueError(f"short_scripts: {self.short_scripts} is not a number from 1 to {MAX_SHORT_SCRIPTS}")
        for room in self.rooms:
            if canonical_room(room) not in ROOM_TYPES:
                raise ValueError(f"rooms: {room!r} is none of {', '.join(ROOM_TYPES)}")


@dataclass
class _Record:
    """Who planned which part, and what went wrong on the way."""

    planners: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    insist: bool = False

    @property
    def planner(self) -> str:
        return ", ".join(dict.fromkeys(self.planners))

    def failed(self, doing: str, error: ModelError) -> None:
        if self.insist:
            raise error
        self.notes.append(f"{doing} by rules: {error}")


def compose(
    theme: str,
    library: ScriptLibrary,
    request: Request | None = None,
    model: LanguageModel | None = None,
    insist: bool = False,
) -> LongScript:
    """The long script of a theme, checked and repaired; `planner` names who planned it.

    A model finds the events and arranges what was retrieved for them ("matching": it never writes keyframes), or
    writes the keyframes itself ("direct"). Where it gives no usable answer the rules take over and `repairs`
    says why; with `insist` its ModelError is raised instead.
    Raises ThemeError when no event of the theme is understood.
    """
    request = request or Request()
    by_rules = clauses_of(theme)
    record = _Record(insist=insist)
    if request.method == "direct":
        return _direct(theme, by_rules, model, request, record)
    clauses = grouped(_events(theme, by_rules, model, record), request.short_scripts or MAX_SHORT_SCRIPTS)
    if not any(_ENGLISH.search(clause.text) for clause in clauses):
        raise ThemeError(f"no word of {theme[:60]!r} is in Latin letters. {LANGUAGE}")
    limits = Limits(tuple(map(canonical_room, request.rooms)), rooms_in(theme))
    reading = read(theme, clauses, library, limits)
    if not reading.covered:
        raise ThemeError(_not_understood(reading, library, request))
    rows = _rows(reading, request.short_scripts or min(MAX_SHORT_SCRIPTS, max(MIN_SHORT_SCRIPTS, len(reading.covered))))
    chosen = _arranged(theme, reading, rows, library, model, record) or _matched(reading, rows, library, request.seed)
    return _long_script(theme, reading, chosen, library, request, record)


def _events(theme: str, by_rules: Sequence[Clause], model: LanguageModel | None, record: _Record) -> Sequence[Clause]:
    """What happens in the theme: as the model reads it, else as the rules do."""
    if model is not None:
        try:
            planned = llm_planner.plan_events(model, theme, MAX_SHORT_SCRIPTS)
        except ModelError as error:
            record.failed("events found", error)
        else:
            record.planners.append(f"llm:{model.name}")
            return [clause_of(event.text, event.emotion) for event in planned]
    record.planners.append(_RULES)
    return by_rules


def _rows(reading: Reading, count: int) -> list[int]:
    """The event of each short script, in order: each covered event once, then those with most to choose from."""
    rows = list(reading.covered)
    if len(rows) >= count:
        return rows
    ranked = np.sort(_largest(reading.suits, count), axis=1)  # the best last
    while len(rows) < count:
        spare = {event: _spare(ranked[event], rows.count(event)) for event in reading.covered}
        spare = {event: score for event, score in spare.items() if score > 0}
        if not spare:
            break
        rows.append(min(spare, key=lambda event: (rows.count(event), -spare[event], event)))
    return sorted(rows)


def _largest(suits: Scores, count: int) -> Scores:
    """The largest `count` of each row, in any order."""
    return np.partition(suits, -count, axis=1)[:, -count:] if count < suits.shape[1] else suits


def _spare(ranked: Scores, taken: int) -> float:
    """How well the best script suits that is left after so many were taken; negative when none is."""
    return float(ranked[-1 - taken]) if taken < len(ranked) else -1.0


def _matched(reading: Reading, rows: Sequence[int], library: ScriptLibrary, seed: int) -> list[tuple[int, int]]:
    """Event and script for each row that found one, by the rules."""
    moods = [reading.events[event].emotion for event in rows]
    scripts = cast(reading.suits[list(rows)], rows, moods, library, seed)
    chosen = [(event, script) for event, script in zip(rows, scripts, strict=True) if script is not None]
    return sorted(chosen, key=lambda one: (one[0], -reading.suits[one]))  # of one event's, the nearest comes first


def _arranged(
    theme: str,
    reading: Reading,
    rows: Sequence[int],
    library: ScriptLibrary,
    model: LanguageModel | None,
    record: _Record,
) -> list[tuple[int, int]]:
    """Event and script as the model arranges what was retrieved; empty where there is no model or usable answer."""
    if model is not None:
        offers = {event: _offers(reading, event, library) for event in sorted(set(rows))}
        count = min(len(rows), len({found.script.id for offer in offers.values() for found in offer}))
        try:
            choices = llm_planner.arrange(model, theme, reading.events, offers, count)
        except ModelError as error:
            record.failed("short scripts arranged", error)
        else:
            record.planners.append(f"llm:{model.name}")
            places = {script.id: index for index, script in enumerate(library.scripts)}
            return [(event, places[found.script.id]) for event, found in choices]
    record.planners.append(_RULES)
    return []


def _offers(reading: Reading, event: int, library: ScriptLibrary) -> list[Found]:
    """The scripts that suit an event best."""
    suits = reading.suits[event]
    best = sorted(np.flatnonzero(suits > 0), key=lambda index: (-suits[index], library.scripts[index].id))
    return [Found(library.scripts[index], float(reading.scores[event, index])) for index in best[:_OFFERED]]


def _long_script(
    theme: str,
    reading: Reading,
    chosen: Sequence[tuple[int, int]],
    library: ScriptLibrary,
    request: Request,
    record: _Record,
) -> LongScript:
    """The keyframes of the chosen scripts one after the other, connected and repaired."""
    keyframes: list[PlannedKeyframe] = []
    for number, (event, index) in enumerate(chosen):
        script = library.scripts[index]
        keyframes += [
            PlannedKeyframe.model_validate(
                {**keyframe.model_dump(), "short_script": number, "beat": event, "room": script.room}
            )
            for keyframe in script.keyframes
        ]
    acted, repairs = repair(keyframes)
    told = reading.told(chosen)
    return LongScript(
        theme=theme,
        beats=_beats(reading, told),
        short_scripts=tuple(
            Retrieved(script=library.scripts[index], beat=event, score=float(reading.scores[event, index]))
            for event, index in chosen
        ),
        keyframes=acted,
        repairs=(*record.notes, *repairs),
        planner=record.planner,
        encoder=library.encoder.name,
        seed=request.seed,
    )


def _beats(reading: Reading, told: frozenset[int]) -> tuple[Beat, ...]:
    """The beats, those that no chosen script is about with the reason."""
    return tuple(
        beat if index in told else beat.model_copy(update={"why": "no short script is about it"})
        for index, beat in enumerate(reading.events)
    )


def _direct(
    theme: str, by_rules: Sequence[Clause], model: LanguageModel | None, request: Request, record: _Record
) -> LongScript:
    """Keyframes without the library: a model's, whose captions the body reads word by word, else those of the rules."""
    moods = moods_of(by_rules, [None] * len(by_rules))
    events = tuple(Beat(text=clause.text, emotion=Emotion(mood)) for clause, mood in zip(by_rules, moods, strict=True))
    keyframes, planner = direct_by_rules(events), _RULES
    if model is not None:
        try:
            written = llm_planner.direct(model, theme)
        except ModelError as error:
            record.failed("keyframes written", error)
        else:
            keyframes = tuple(PlannedKeyframe.model_validate(keyframe.model_dump()) for keyframe in written)
            planner = f"llm:{model.name}"
    acted, repairs = repair(keyframes)
    return LongScript(
        theme=theme,
        beats=events,
        short_scripts=(),
        keyframes=acted,
        repairs=(*record.notes, *repairs),
        method="direct",
        planner=planner,
        seed=request.seed,
    )


def script_of(keyframes: Sequence[Keyframe], theme: str, seed: int = 0) -> LongScript:
    """The long script of keyframes that somebody else wrote: checked and repaired, nothing retrieved."""
    acted, repairs = repair([PlannedKeyframe.model_validate(keyframe.model_dump()) for keyframe in keyframes])
    return LongScript(
        theme=theme, beats=(), short_scripts=(), keyframes=acted, repairs=tuple(repairs), method="direct",
        planner="given", seed=seed,
    )  # fmt: skip


def _not_understood(reading: Reading, library: ScriptLibrary, request: Request) -> str:
    texts = ", ".join(f"“{event.text[:60]}”" for event in reading.events[:5])
    where = f" in the {' or '.join(request.rooms)}" if request.rooms else ""
    return f"none of the {len(library)} short scripts{where} is about {texts}. {LANGUAGE}"
