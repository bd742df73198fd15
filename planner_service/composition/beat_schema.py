"""The JSON schema of a planned theme: every word of choice is an enum, so that constrained decoding keeps to it.

What is sent is strict, and what comes back is read beat by beat (`llm_beats`): one bad word costs one beat.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final, get_args

from pydantic import BaseModel

from motion_backend.motion import Skill
from planner_service.scripts.captions import captions
from planner_service.scripts.script import EMOTIONS, BeatKind, Pronouns, ShortScript
from planner_service.scripts.script_words import affords
from scene_graphs.json_fields import Json

SERVES: Final = ("take", "trim", "write", "none")
"""How a beat is shown: by a whole script · by a part of one · by keyframes of its own · not at all."""
_RESTS: Final = {
    Skill.SITDOWN: "sit", Skill.STANDUP: "sit", Skill.LIEDOWN: "lie", Skill.GETUP: "lie", Skill.TOUCH: "touch",
}  # fmt: skip
"""What furniture must afford for a skill to begin or end there; a walk goes anywhere."""


class BeatsAnswer(BaseModel):
    """The answer to `prompts/plan_beats.md`, as loosely as it can be read."""

    person: Any = None
    beats: list[Any]


def answer_type(offered: Sequence[ShortScript], furniture: Sequence[str]) -> type[BeatsAnswer]:
    """`BeatsAnswer` with a strict schema of its own: only these scripts, this furniture and captions of each skill."""
    schema = _answer(offered, furniture)

    class PlannedBeats(BeatsAnswer):
        @classmethod
        def model_json_schema(cls, *_: Any, **__: Any) -> Json:
            return schema

    return PlannedBeats


def _answer(offered: Sequence[ShortScript], furniture: Sequence[str]) -> Json:
    longest = max((len(script.keyframes) for script in offered), default=1)
    places = {"type": "integer", "enum": list(range(longest))}
    person = _object(
        name={"type": "string"},
        pronouns=_one_of(get_args(Pronouns)),
        age={"anyOf": [{"type": "integer"}, {"type": "null"}]},
    )
    beat = _object(
        text={"type": "string"},
        kind=_one_of(get_args(BeatKind)),
        who={"type": "string"},
        emotion=_one_of(EMOTIONS),
        serve=_one_of(SERVES),
        script=_one_of(["", *(script.id for script in offered)]),
        first=places,
        last=places,
        keyframes=_list_of({"anyOf": [_keyframe(skill, furniture) for skill in Skill]}),
    )
    return _object(person=person, beats=_list_of(beat))


def _keyframe(skill: Skill, furniture: Sequence[str]) -> Json:
    """A keyframe of one skill, so that no caption stands beside another skill's."""
    need = _RESTS.get(skill)
    there = ["floor", *furniture]
    return _object(
        skill=_one_of([skill.value]),
        emotion=_one_of(EMOTIONS),
        caption=_one_of(captions()[skill.value]),
        furniture=_one_of([word for word in there if need is None or affords(word, need)]),
    )


def _one_of(words: Sequence[str]) -> Json:
    return {"type": "string", "enum": [str(word) for word in words]}


def _list_of(items: Json) -> Json:
    return {"type": "array", "items": items}


def _object(**fields: Json) -> Json:
    return {"type": "object", "properties": fields, "required": list(fields)}
