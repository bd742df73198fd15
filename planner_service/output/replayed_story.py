"""A story.json read again, to be played as it stands or with moments that somebody changed in it.

What was not changed stays as it was: who acts, the home, the objects, the title, the told words, how each moment was
grounded. What was is read and mended as a take of the service is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from difflib import SequenceMatcher
from functools import cached_property
from typing import Any, Final

from pydantic import ValidationError

from motion_backend.motion import Action, Character, moment
from planner_service.grounding.furnish import Furnished
from planner_service.grounding.keyframes_to_actions import Kept
from planner_service.grounding.script_revision import EditedKeyframe, RevisionError, revised, rewritten
from planner_service.jobs.serialization import action_from_dict, furnished_from_dict
from planner_service.jobs.take_reuse import kept_actions
from planner_service.narration.told import Told
from planner_service.pipeline import Pipeline, Planned, RequestError, StoryRequest
from planner_service.scripts.script import Keyframe, PlannedKeyframe
from scene_graphs.errors import UserError
from scene_graphs.home import home_from_layouts
from scene_graphs.json_fields import Json
from scene_graphs.layout import Layout

ACTED: Final = "acted"
"""Where a story.json has its keyframes as they were acted, and where: what it is compared with when it is played."""


def acted_to_dict(stage: Furnished) -> Json:
    """The keyframes of a story that was acted, and the place of each: [room of the home, object or null]."""
    return {
        "keyframes": [keyframe.model_dump(mode="json") for keyframe in stage.script.keyframes],
        "places": [[place.room, place.object_id] for place in stage.places],
    }


@dataclass(frozen=True)
class ReplayedStory:
    """A story as it was made, and its keyframes as its file has them now."""

    request: StoryRequest
    """Of the story that was made: theme, seed, backend, and the character as it was seen."""
    stage: Furnished
    told: Told
    actions: tuple[Action, ...]
    keyframes: tuple[PlannedKeyframe, ...]
    """As they are wanted."""

    @classmethod
    def read(cls, row: Json, keyframes: Sequence[PlannedKeyframe]) -> ReplayedStory:
        """Of a whole story.json, whose keyframes were read already. RequestError if it is none any more."""
        try:
            request = StoryRequest(
                theme=row["theme"],
                seed=row["seed"],
                backend=row["backend"],
                character=Character(**row["character"]),
            )
            stage = _stage(row)
            told = Told.from_dict(row)
            actions = tuple(map(action_from_dict, row["actions"]))
            ends = [(span.start, span.end) for span in (*told.spans, *told.thoughts)]
            if any(not 0 <= start <= end <= len(told.text) for start, end in ends):
                raise ValueError("spans reach beyond its text")
            if not len(actions) == len(stage.places) == len(stage.script.keyframes):
                raise ValueError("acted and actions have not as many rows")
        except UserError:
            raise
        except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
            why = f"{error.errors()[0]['loc']}" if isinstance(error, ValidationError) else f"{error}"
            raise RequestError(
                f"is no story.json any more: {type(error).__name__}: {why:.200}",
                "change only its title and what stands under script.keyframes",
                at="script",
            ) from error
        return cls(request, stage, told, actions, tuple(keyframes))

    @cached_property
    def unchanged(self) -> bool:
        """Whether its keyframes are those that were acted."""
        return [_said(one) for one in self.keyframes] == [_said(one) for one in self.stage.script.keyframes]

    def planned(self, pipeline: Pipeline, request: StoryRequest, layouts: Sequence[Layout] = ()) -> Planned:
        """The story as it is wanted, in its own home or in one of these rooms, told in its own words as far as they
        still hold. RequestError names the moments that cannot be acted, with what would be right."""
        stage = self._staged(pipeline, request, layouts)
        who = (request.character.name, request.character.pronouns)
        if self.unchanged and who == (self.request.character.name, self.request.character.pronouns):
            return Planned(request, stage.script, stage, self.told)
        if stage.script.planner != "rules":
            repairs = (*stage.script.repairs, "told by rules: the words are those of other keyframes or a person")
            stage = replace(stage, script=stage.script.model_copy(update={"repairs": repairs}))
        stage, told = pipeline.tell(request, stage)
        return Planned(request, stage.script, stage, replace(told, title=self.told.title or told.title))

    def kept(self, planned: Planned) -> list[Kept | None]:
        """For each keyframe what of its grounding stays as it was."""
        return kept_actions(planned, self)

    def _staged(self, pipeline: Pipeline, request: StoryRequest, layouts: Sequence[Layout]) -> Furnished:
        wanted = self._edited()
        try:
            if layouts:
                script = rewritten(self.stage.script, wanted, home_from_layouts(layouts, request.seed))
                return pipeline.furnish(replace(request, layouts=tuple(layouts)), script)
            return self.stage if self.unchanged else revised(self.stage, wanted)
        except RevisionError as error:
            told = [f"{moment(fault.keyframe)}, {fault.field}: {fault.said}" for fault in error.faults]
            raise RequestError(" · ".join(told), at="script") from error

    def _edited(self) -> list[EditedKeyframe]:
        """The keyframes as a take asks for them: which of the story each is, changed or not."""
        now, before = [_said(one) for one in self.keyframes], [_said(one) for one in self.stage.script.keyframes]
        index: dict[int, int] = {}
        for _, start, stop, first, last in SequenceMatcher(None, before, now, autojunk=False).get_opcodes():
            index |= dict(zip(range(first, last), range(start, stop), strict=False))
        return [
            EditedKeyframe(
                **one.model_dump(include=set(Keyframe.model_fields))
                | {"index": index.get(number), "held": one.held, "does": one.does}
            )
            for number, one in enumerate(self.keyframes)
        ]


def is_story(row: Any) -> bool:
    """Whether a JSON value is a story.json that can be played as it was."""
    return isinstance(row, dict) and ACTED in row


def _stage(row: Json) -> Furnished:
    """The script in its home, as it was acted."""
    script = row["script"] | {"keyframes": row[ACTED]["keyframes"]}
    rooms = [
        room
        | {"substitutions": [(one["asked"], one["given"], one["level"]) for one in room["substitutions"]]}
        | {"pulls": room["pulled_out"]}
        for room in row["rooms"]
    ]
    for room in rooms:
        del room["pulled_out"]
    stage = furnished_from_dict(
        {"script": script, "home": row["home"], "matches": rooms, "places": row[ACTED]["places"], "graphs": {}}
    )
    for place in stage.places:
        if place.room >= len(stage.matches) or place.room < 0:
            raise ValueError(f"the home has no room {place.room}")
        if place.object_id is not None:
            stage.home.object(place.object_id)
    return stage


def _said(keyframe: Keyframe) -> tuple[str, ...]:
    return keyframe.skill, keyframe.emotion, keyframe.caption, keyframe.furniture, keyframe.held, keyframe.does
