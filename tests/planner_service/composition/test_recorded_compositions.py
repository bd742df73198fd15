"""Themes are planned by every method, and within what is asked for, as they were when somebody last read them."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any, Final

from recorded import agrees

from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.motion import Character
from planner_service.composition.compose import compose
from planner_service.composition.request import METHODS, Request
from planner_service.narration.narrator import narrate
from planner_service.scripts.acted_beats import planned_beats
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import LongScript
from planner_service.scripts.script_library import Features, ScriptLibrary
from planner_service.scripts.script_repair import check
from planner_service.themes.beats import ThemeError

THEMES: Final = (
    "He comes home tired, lies down on the couch, stares at the ceiling and gets up to eat something at the table.",
    "Angry about the bill, Ada paces up and down, sits at her desk and types; then she waters the plants.",
    "Grandfather reads the newspaper in his armchair, falls asleep, and dreams of the sea.",
    "Two friends dance, laugh and sit on the floor until one of them wipes the shelf with his left hand.",
)
REQUESTS: Final[dict[str, Request]] = {
    **{str(method): Request(seed=1, method=method) for method in METHODS},
    "few scripts": Request(short_scripts=2, method="matching", seed=2),
    "in the bedroom": Request(rooms=("bedroom",), seed=3),
    "in two rooms": Request(rooms=("dining room", "study"), method="matching", seed=4),
    "with little furniture": Request(
        furniture={"living_room": frozenset({"multi_seat_sofa", "tv_stand"}), "study": frozenset({"desk"})}, seed=5
    ),
}
SEARCHES: Final = ("somebody cries", "reads a book on the sofa", "phone", "typing at night, angry")


def library() -> ScriptLibrary:
    return ScriptLibrary(built_in()[::6], Features(HashingEncoder()))


def test_compositions_are_as_recorded() -> None:
    shelf = library()
    agrees("compositions", {
        theme: {name: planned(theme, shelf, request) for name, request in REQUESTS.items()} for theme in THEMES
    })  # fmt: skip


def planned(theme: str, shelf: ScriptLibrary, request: Request) -> dict[str, Any]:
    try:
        return told(compose(theme, shelf, request))
    except ThemeError as error:
        return {"refused": str(error)}


def told(script: LongScript) -> dict[str, Any]:
    """A line a keyframe and a beat, and how it is told to whom."""
    beats = planned_beats(script)
    story = narrate(script, Character("Ada", "she"), script.seed)
    return {
        "from": f"{script.planner}: {', '.join(one.script.id for one in script.short_scripts)}",
        "keyframes": [
            f"{one.skill} {one.caption} | {one.furniture} | {one.emotion} | {one.room} | {one.beat} {list(one.also)}"
            for one in script.keyframes
        ],
        "beats": [str(one) for one in asdict(beats).values()] + [str(problem) for problem in check(script.keyframes)],
        "repairs": list(script.repairs),
        "told": [story.title, *story.text.split(". ")],
    }


def test_searches_are_as_recorded() -> None:
    shelf = library()
    found = {query: shelf.search(query) for query in SEARCHES}
    found |= {f"{query}, sad": shelf.search(query, 2, emotion="sad") for query in SEARCHES}
    found |= {f"{query}, at a desk": shelf.search(query, 3, furniture=("desk",)) for query in SEARCHES}
    agrees("searches", {query: {one.script.id: round(one.score, 4) for one in some} for query, some in found.items()})
