"""Every caption and every mood changes of a body what it changed when somebody last looked at it, and no more."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from importlib.resources import files
from typing import Any

import numpy as np
from recorded import agrees

from motion_backend.backend_protocol import Part
from motion_backend.motion import Action, Emotion, Posture, Skill
from motion_backend.procedural.emotion_style import bearing_of
from motion_backend.procedural.lie.lie_styles import lie_style
from motion_backend.procedural.sit.sit_own import OwnSeat
from motion_backend.procedural.sit.sit_styles import manners, sit_style
from motion_backend.procedural.touch.hand_captions import handled
from motion_backend.procedural.walk.gait_character import NOBODY, GaitCharacter
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.state_machine import parts_of

STYLES = {
    Skill.LOCO: walk_style, Skill.SITDOWN: sit_style, Skill.LIEDOWN: lie_style,
    Skill.TOUCH: lambda _, caption: handled(caption),
}  # fmt: skip


def captions() -> dict[str, list[str]]:
    found: dict[str, list[str]] = json.loads((files("planner_service") / "data" / "captions.json").read_text("utf-8"))
    return found


def test_styles_are_as_recorded() -> None:
    found: dict[str, Any] = {}
    for skill, style in STYLES.items():
        usual = dict(flat(style(Emotion.NEUTRAL, "")))
        moods = {emotion: changes(style(emotion, ""), usual) for emotion in Emotion}
        said = {caption: changes(style(Emotion.NEUTRAL, caption), usual) for caption in captions()[skill]}
        found[skill] = {"usual": usual, "moods": moods, "said": said}
    neutral = dict(flat(bearing_of(Emotion.NEUTRAL)))
    found["bearings"] = {emotion: changes(bearing_of(emotion), neutral) for emotion in Emotion}
    found["manners"] = {emotion: dict(flat(manner)) for emotion, manner in manners().items()}
    agrees("styles", found)


def test_parts_are_as_recorded() -> None:
    """What a body does first that is to do something, by how it rests and whether it is far."""
    found = {}
    for posture in Posture:
        for skill in Skill:
            for goal in ((0.0, 0.0), (3.0, 4.0)):
                action = Action(skill, "as one does", Emotion.NEUTRAL, goal=goal, facing=0.5, hold=2.0)
                parts = parts_of(action, posture, (0.0, 0.01), None)
                found[f"{posture} {skill} {goal}"] = [row(part) for part in parts]
    agrees("parts", found)


def row(part: Part) -> str:
    goal = part.action.goal and [round(float(number), 3) for number in part.action.goal]
    return f"{part.kind} {goal} {part.hold} {[contact.joint for contact in part.contacts]}"


def test_nobodys_way_to_do_something_changes_nothing() -> None:
    for way in (GaitCharacter(), OwnSeat()):
        for name, value in flat(way):
            assert np.all(np.asarray(value) == (1.0 if name.endswith("_ratio") else 0.0)), f"{type(way)}.{name}"
    assert GaitCharacter() == NOBODY


def changes(style: Any, usual: dict[str, Any]) -> dict[str, Any]:
    """What a style has otherwise than is usual."""
    return {name: value for name, value in flat(style) if usual.get(name) != value}


def flat(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """All that is in a style, by its path."""
    if is_dataclass(value):
        for field in fields(value):
            yield from flat(getattr(value, field.name), f"{name}.{field.name}".strip("."))
    elif isinstance(value, np.ndarray | tuple | list):
        row = np.ravel(np.asarray(value)).tolist()
        yield name, [round(one, 4) if isinstance(one, float) else one for one in row]
    else:
        yield name, round(value, 4) if isinstance(value, float) else value
