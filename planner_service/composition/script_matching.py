"""The paper's way to a long script: a short script from the library for every event of the theme (SIMS 3.2)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

import numpy as np

from planner_service.composition import llm_planner
from planner_service.composition.event_retrieval import Reading, read
from planner_service.composition.request import MAX_SHORT_SCRIPTS, RULES, Record, Request
from planner_service.composition.sequence_search import cast
from planner_service.llm.protocol import LanguageModel, ModelError
from planner_service.scripts.script import Beat, LongScript, PlannedKeyframe, Retrieved
from planner_service.scripts.script_library import ScriptLibrary
from planner_service.scripts.script_repair import repair
from planner_service.scripts.script_search import Found
from planner_service.scripts.suitability import Limits, Scores
from planner_service.themes.beats import LANGUAGE, Clause, ThemeError, clause_of, grouped, rooms_in
from scene_graphs.furniture import canonical_room

MIN_SHORT_SCRIPTS: Final = 2
"""Short scripts when the number is not asked for."""
_OFFERED: Final = 6
"""Candidates an event that a language model chooses from."""
_ENGLISH: Final = re.compile(r"[a-z]", re.IGNORECASE)


def match(
    theme: str,
    by_rules: Sequence[Clause],
    library: ScriptLibrary,
    request: Request,
    model: LanguageModel | None,
    record: Record,
) -> LongScript:
    """The long script of a theme from short scripts alone: no keyframe is written but to connect them.

    A model finds the events and arranges what was retrieved for them; without one `by_rules` are the events.
    Raises ThemeError when no event of the theme is understood.
    """
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


def _events(theme: str, by_rules: Sequence[Clause], model: LanguageModel | None, record: Record) -> Sequence[Clause]:
    """What happens in the theme: as the model reads it, else as the rules do."""
    if model is not None:
        try:
            planned = llm_planner.plan_events(model, theme, MAX_SHORT_SCRIPTS)
        except ModelError as error:
            record.failed("events found", error)
        else:
            record.planners.append(f"llm:{model.name}")
            return [clause_of(event.text, event.emotion) for event in planned]
    record.planners.append(RULES)
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
    record: Record,
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
    record.planners.append(RULES)
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
    record: Record,
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


def _not_understood(reading: Reading, library: ScriptLibrary, request: Request) -> str:
    texts = ", ".join(f"“{event.text[:60]}”" for event in reading.events[:5])
    where = f" in the {' or '.join(request.rooms)}" if request.rooms else ""
    return f"none of the {len(library)} short scripts{where} is about {texts}. {LANGUAGE}"
