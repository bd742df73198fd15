"""Scripts are changed as they were when somebody last looked at it, and what cannot be is refused with what could."""

from __future__ import annotations

from functools import cache
from typing import Any, Final

from recorded import agrees

from motion_backend.language.sentence_encoder import HashingEncoder
from planner_service.composition.compose import compose
from planner_service.composition.request import Request
from planner_service.grounding.furnish import Furnished, furnish
from planner_service.grounding.keyframes_to_actions import act
from planner_service.grounding.script_revision import EditedKeyframe, RevisionError, revised, rewritten
from planner_service.jobs.serialization import action_to_dict
from planner_service.scripts.built_in_scripts import built_in
from planner_service.scripts.script import LongScript
from planner_service.scripts.script_library import Features, ScriptLibrary
from scene_graphs.home import home_from_layouts
from scene_graphs.layout_library import built_in_index

THEME: Final = "She comes home sad, sits down on the sofa, cries, and lies down on the bed in the bedroom."
OTHER: Final = ("living-room-0011", "bedroom-0002")
"""Rooms of another home."""
SITS: Final = {"skill": "sitdown", "emotion": "sad", "caption": "crossing arms"}
EDITS: Final[dict[str, list[dict[str, Any]]]] = {
    "a new one at a chair": [{**SITS, "furniture": "chair"}],
    "a new one where another is used": [{**SITS, "furniture": "sofa"}, {**SITS, "furniture": "sofa 2"}],
    "on the floor": [{**SITS, "furniture": "floor"}],
    "at an object": [{**SITS, "furniture": "sofa", "object_id": "0/multi_seat_sofa_1"}],
    "at no object": [{**SITS, "furniture": "sofa", "object_id": "7/lamp"}],
    "what nobody can do there": [{**SITS, "furniture": "bookshelf"}, {**SITS, "furniture": "unicorn"}],
    "the floor is not touched": [
        {"skill": "touch", "emotion": "neutral", "caption": "touch low height", "furniture": "floor"}
    ],
    "words that nobody knows": [
        {"skill": "loco", "emotion": "mauve", "caption": "zigzagging wildly", "furniture": "floor"}
    ],
    "in another mood": [{**SITS, "emotion": "very happy", "caption": "hands on thighs", "furniture": "armchair"}],
    "no such keyframe": [{**SITS, "furniture": "sofa", "index": 99}],
    "rising alone": [{"skill": "standup", "emotion": "neutral", "caption": "stand up", "furniture": "floor"}],
    "lying where one cannot": [
        {"skill": "liedown", "emotion": "tired", "caption": "hands on belly", "furniture": "table"}
    ],
}


@cache
def stage() -> Furnished:
    library = ScriptLibrary(built_in()[::7], Features(HashingEncoder()))
    return furnish(compose(THEME, library, Request(seed=2)), built_in_index(), seed=2)


def story() -> list[EditedKeyframe]:
    """Its keyframes as they are."""
    return [
        EditedKeyframe(index=index, skill=one.skill, emotion=one.emotion, caption=one.caption, furniture=one.furniture)
        for index, one in enumerate(stage().script.keyframes)
    ]


def test_revisions_are_as_recorded() -> None:
    home = home_from_layouts([built_in_index().layout(name) for name in OTHER], 0)
    found: dict[str, Any] = {"the story": lines(stage().script), "as it was": changed(story())}
    for name, rows in EDITS.items():
        some = [EditedKeyframe.model_validate(row) for row in rows]
        found[name] = {"behind": changed([*story()[:3], *some]), "elsewhere": elsewhere(some, home)}
    found["turned round"] = changed(story()[::-1])
    acted = act(stage().script.keyframes, stage().places, stage().home, 2)
    found["acted"] = [short(action_to_dict(one)) for one in acted]
    agrees("revisions", found)


def changed(wanted: list[EditedKeyframe]) -> list[str]:
    """A line a keyframe with its object, or a line a fault."""
    try:
        found = revised(stage(), wanted)
    except RevisionError as error:
        return faults(error)
    where = [place.object_id if place else None for place in found.places]
    return [f"{line} at {place}" for line, place in zip(lines(found.script), where, strict=True)] + list(
        found.script.repairs
    )


def elsewhere(wanted: list[EditedKeyframe], home: Any) -> list[str]:
    try:
        return lines(rewritten(stage().script, wanted, home))
    except RevisionError as error:
        return faults(error)


def faults(error: RevisionError) -> list[str]:
    return [f"{one.keyframe}.{one.field}: {one.said}" for one in error.faults]


def lines(script: LongScript) -> list[str]:
    return [
        f"{one.skill} {one.caption} | {one.furniture} | {one.emotion} | {one.room} | beats {one.beat} {list(one.also)}"
        for one in script.keyframes
    ]


def short(value: Any) -> Any:
    """Numbers rounded, all the way down."""
    if isinstance(value, dict):
        return {key: short(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [short(one) for one in value]
    return round(value, 3) if isinstance(value, float) else value
