"""The paper's way to a long script: a short script from the library for every event of the theme (SIMS 3.2)."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from planner_service.composition import llm_planner
from planner_service.composition.request import MAX_SHORT_SCRIPTS, RULES, Record, Request
from planner_service.composition.unacted_beats import NOT_ACTED
from planner_service.llm.protocol import LanguageModel, ModelError
from planner_service.scripts.script import EMOTIONS, Beat, LongScript, PlannedKeyframe, Retrieved
from planner_service.scripts.script_library import ScriptLibrary
from planner_service.scripts.script_repair import repair
from planner_service.scripts.script_search import ABOUT, Found, Scores, rank
from planner_service.themes.beats import LANGUAGE, ThemeError, rooms_in
from scene_graphs.furniture import ROOM_TYPES, canonical_room

MIN_SHORT_SCRIPTS: Final = 2
"""Short scripts when the number is not asked for."""
NEAR_TIE: Final = 0.05
"""Scripts this close together may change places: the seed chooses."""
_FEELING, _ROOM = 0.1, 0.05
"""What it counts that a script feels as the event does, and plays in a room that event or theme names."""
_OFFERED: Final = 6
"""Candidates an event that a language model chooses from."""

Choice = tuple[int, int]
"""Places of an event and of the script that plays it."""


@dataclass(frozen=True)
class Reading:
    """The events of a theme and what the library has for them."""

    events: tuple[Beat, ...]
    scores: Scores
    """How well each script answers the event, (events, scripts)."""
    suits: Scores
    """The same with feeling and room weighed in, those that are about the event first; -1 for what is in no room
    that was asked for."""

    @property
    def covered(self) -> tuple[int, ...]:
        """Events that some script is about."""
        return tuple(index for index, row in enumerate(self.suits) if row.max(initial=-1.0) >= 1)


def match(
    theme: str,
    by_rules: Sequence[Beat],
    library: ScriptLibrary,
    request: Request,
    model: LanguageModel | None,
    record: Record,
) -> LongScript:
    """The long script of a theme from short scripts alone: no keyframe is written but to connect them.

    A model finds the events and arranges what was retrieved for them; without one `by_rules` are the events.
    Raises ThemeError when no event of the theme is understood.
    """
    reading = _read(theme, _events(theme, by_rules, model, record), library, request)
    if model is not None and RULES not in record.planners and not reading.covered:
        record.failed("events found", ModelError(f"no short script is about any event that {model.name} found"))
        record.planners.append(RULES)
        reading = _read(theme, by_rules, library, request)
    if not reading.covered:
        raise ThemeError(_not_understood(reading, library, request))
    few = min(MAX_SHORT_SCRIPTS, max(MIN_SHORT_SCRIPTS, len(reading.covered)))
    rows = _rows(reading, request.short_scripts or few)
    chosen = _arranged(theme, reading, rows, library, model, record) or _assigned(reading, rows, request.seed)
    return _long_script(theme, reading, chosen, library, request, record)


def _events(theme: str, by_rules: Sequence[Beat], model: LanguageModel | None, record: Record) -> Sequence[Beat]:
    """What happens in the theme: as the model reads it, else as the rules do."""
    if model is not None:
        try:
            planned = llm_planner.plan_events(model, theme, MAX_SHORT_SCRIPTS)
        except ModelError as error:
            record.failed("events found", error)
        else:
            record.planners.append(f"llm:{model.name}")
            return planned
    record.planners.append(RULES)
    return by_rules


def _read(theme: str, beats: Sequence[Beat], library: ScriptLibrary, request: Request) -> Reading:
    """Every event held against every script."""
    events = tuple(beats)
    scores = rank([event.text for event in events], library)
    felt = np.array([[EMOTIONS.index(event.emotion)] for event in events]) == library.emotions
    named = np.array([_in_rooms(rooms_in(event.text) or rooms_in(theme), library) for event in events])
    about = scores >= ABOUT.get(library.encoder.name, ABOUT[""])
    suits = scores + about + _FEELING * felt + _ROOM * named
    suits[[event.kind not in ("deed", "feeling") for event in events]] = -1
    if request.rooms:
        suits[:, ~_in_rooms(map(canonical_room, request.rooms), library)] = -1
    return Reading(events, scores, suits)


def _rows(reading: Reading, count: int) -> list[int]:
    """The event of each short script, in order: the best answered ones, and all again where scripts are left."""
    best = sorted(reading.covered, key=lambda event: -reading.suits[event].max())
    return sorted(itertools.islice(itertools.cycle(best), count))


def _in_rooms(rooms: Iterable[str], library: ScriptLibrary) -> NDArray[np.bool_]:
    """Scripts that play in one of these rooms. (scripts,)."""
    return np.isin(library.rooms, [ROOM_TYPES.index(room) for room in rooms])


def _assigned(reading: Reading, rows: Sequence[int], seed: int) -> list[Choice]:
    """The script for each row's event by the rules: the best sum, no script twice, among near ties the seed's."""
    suits = reading.suits[rows]
    luck = np.random.default_rng(seed).uniform(0, NEAR_TIE, suits.shape)
    drawn = linear_sum_assignment((suits + luck).round(6), maximize=True)
    pairs = [(int(row), int(script)) for row, script in zip(*drawn, strict=True)]
    chosen = [(rows[row], script) for row, script in pairs if suits[row, script] >= 0]
    return sorted(chosen, key=lambda one: (one[0], -reading.suits[one]))  # of one event's, the nearest comes first


def _arranged(
    theme: str,
    reading: Reading,
    rows: Sequence[int],
    library: ScriptLibrary,
    model: LanguageModel | None,
    record: Record,
) -> list[Choice]:
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
    best = np.argsort(-reading.suits[event], kind="stable")[:_OFFERED]
    allowed = [int(index) for index in best if reading.suits[event, index] >= 0]
    return [Found(library.scripts[index], float(reading.scores[event, index])) for index in allowed]


def _long_script(
    theme: str,
    reading: Reading,
    chosen: Sequence[Choice],
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
    return LongScript(
        theme=theme,
        beats=_beats(reading, chosen),
        short_scripts=tuple(
            Retrieved(script=library.scripts[index], beat=event, score=float(reading.scores[event, index]))
            for event, index in chosen
        ),
        keyframes=acted,
        repairs=(*record.notes, *repairs),
        method="matching",
        planner=record.planner,
        encoder=library.encoder.name,
        seed=request.seed,
    )


def _beats(reading: Reading, chosen: Sequence[Choice]) -> tuple[Beat, ...]:
    """The beats, those that no chosen script is about with the reason."""
    told = {event for event, script in chosen if reading.suits[event, script] >= 1}
    return tuple(
        beat if index in told else beat.model_copy(update={"why": _why(reading, index)})
        for index, beat in enumerate(reading.events)
    )


def _why(reading: Reading, event: int) -> str:
    left = "no short script was taken for it" if event in reading.covered else "no short script is about it"
    return NOT_ACTED.get(reading.events[event].kind, left)


def _not_understood(reading: Reading, library: ScriptLibrary, request: Request) -> str:
    texts = ", ".join(f"“{event.text[:60]}”" for event in reading.events[:5])
    where = f" in the {' or '.join(request.rooms)}" if request.rooms else ""
    return f"none of the {len(library)} short scripts{where} is about {texts}. {LANGUAGE}"
