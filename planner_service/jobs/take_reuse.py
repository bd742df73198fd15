"""What a take keeps of the story that it derives from: how its keyframes were grounded, and segments of its motion.

A segment is made from its action, from what the next one asks for, and from how the body was left. Where all of these
are what they were, so is the segment: it is taken over, not made again.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from difflib import SequenceMatcher
from typing import Protocol

from motion_backend.backend_protocol import BodyState
from motion_backend.director import Director
from motion_backend.motion import RISINGS, Action, Skill
from planner_service.grounding.furnish import Furnished
from planner_service.grounding.keyframes_to_actions import Kept
from planner_service.jobs.serialization import action_to_dict
from planner_service.pipeline import StoryRequest, actor
from planner_service.store.story_store import Made, StoryGone
from scene_graphs.json_fields import Json


class Staged(Protocol):
    """A story that was asked for, in its home; StoryGone where it is not that far."""

    @property
    def request(self) -> StoryRequest:
        """What was asked for."""
        ...

    @property
    def stage(self) -> Furnished:
        """The script in its home."""
        ...


class Grounded(Staged, Protocol):
    """One whose actions are known."""

    @property
    def actions(self) -> Sequence[Action]:
        """One a keyframe."""
        ...


class Moved(Grounded, Protocol):
    """One whose motion is being made."""

    def segments(self, count: int) -> list[Made]:
        """The first so many segments of its motion, as far as they are there."""
        ...


def kept_actions(take: Staged, origin: Grounded | None) -> list[Kept | None]:
    """For each keyframe of a take what it was grounded as before; empty where nothing of that still holds."""
    try:
        if origin is None or _setting(origin) != _setting(take):
            return []
        actions = origin.actions
    except StoryGone:  # deleted, or not as far yet
        return []
    before, now = _said(origin.stage), _said(take.stage)
    found: list[Kept | None] = [None] * len(now)
    for block in SequenceMatcher(None, before, now, autojunk=False).get_matching_blocks():
        for step in range(block.size):
            last = step + 1 == block.size
            ends = block.a + block.size == len(before) and block.b + block.size == len(now)
            found[block.b + step] = Kept(actions[block.a + step], leads_elsewhere=last and not ends)
    skills = [keyframe.skill for keyframe in take.stage.script.keyframes]
    return [None if one and _depends(index, one, found, skills) else one for index, one in enumerate(found)]


def _setting(story: Staged) -> tuple[object, ...]:
    """What grounding goes by besides the keyframes."""
    return story.request.seed, actor(story.request, story.stage.script).height, story.stage.home


def _said(stage: Furnished) -> list[tuple[object, ...]]:
    """What of each keyframe grounding goes by."""
    return [
        (keyframe.skill, keyframe.mood, keyframe.caption, keyframe.furniture, keyframe.already, place)
        for keyframe, place in zip(stage.script.keyframes, stage.places, strict=True)
    ]


def _depends(index: int, one: Kept, found: Sequence[Kept | None], skills: Sequence[Skill]) -> bool:
    """Whether what comes before it has a say in it and is another now: which hand is free, what one rests on."""
    before = found[index - 1] if index else None
    came_first = index == 0 and one.action.keyframe == 0
    after_the_same = before is not None and before.action.keyframe + 1 == one.action.keyframe
    if one.action.skill is Skill.LOCO or came_first or after_the_same:
        return one.action.skill in RISINGS
    return one.action.skill in (*RISINGS, Skill.TOUCH) or skills[index - 1] is not Skill.LOCO


def reused_segments(take: Staged, origin: Moved | None, rows: Sequence[Json], director: Director) -> list[Made]:
    """The segments that a take has in common with the story it derives from, first to last, as they were made there.

    `rows` are the take's actions. All before the first action that differs, but the last of them: its ending looked
    ahead to what follows.
    """
    try:
        if origin is None or not _begins_alike(take, origin, director):
            return []
        before = [action_to_dict(action) for action in origin.actions]
        count = _alike(json.loads(json.dumps(rows)), json.loads(json.dumps(before)))
        return origin.segments(count)
    except StoryGone:
        return []


def _begins_alike(take: Staged, origin: Staged, director: Director) -> bool:
    """Whether the same backend moves a body that stands in the same home as the other one did."""
    if take.request.backend != origin.request.backend or take.stage.home != origin.stage.home:
        return False
    return _beginning(take, director).to_dict() == _beginning(origin, director).to_dict()


def _beginning(story: Staged, director: Director) -> BodyState:
    return director.begin(story.stage.home, actor(story.request, story.stage.script), story.request.seed)


def _alike(now: Sequence[Json], before: Sequence[Json]) -> int:
    """How many segments are the same: each needs its own action and the next one, or none, as they were."""
    if now == before:
        return len(now)
    differs = next((index for index, (one, other) in enumerate(zip(now, before, strict=False)) if one != other), None)
    return max((min(len(now), len(before)) if differs is None else differs) - 1, 0)
