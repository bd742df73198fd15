"""A story made stage by stage, every result stored before the next begins (DESIGN: plan, furnish, … judge, film).

Each stage reads what it needs from the store, so any of them can be run alone, again, or by another worker.
"""

from __future__ import annotations

import io
import json
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from typing import Any, Final

import structlog
from sqlalchemy import Connection
from sqlalchemy.exc import InterfaceError, OperationalError

from motion_backend.backend_protocol import BodyState
from motion_backend.body.cast import Role, worked_to_dict
from motion_backend.body.scene_collision import Obstacles
from motion_backend.director import Director, segments_of
from motion_backend.formats.glb_film import film_glb
from motion_backend.formats.npz import npz_bytes, read_npz
from motion_backend.metrics import story_metrics
from motion_backend.motion import Action, Motion
from motion_backend.scene import scene_of
from planner_service.grounding.furnish import Furnished
from planner_service.jobs import serialization
from planner_service.jobs.serialization import summary_of_home, summary_of_script
from planner_service.jobs.take_reuse import kept_actions, reused_segments
from planner_service.llm.budget import Spent
from planner_service.llm.client import spent_on
from planner_service.narration.told import Told
from planner_service.output.story_export import report_to_dict
from planner_service.pipeline import Pipeline, Planned, Story, StoryRequest, actor, judge, role_of
from planner_service.scripts.script import LongScript
from planner_service.store.story_store import Made, Stories, count_spent, put_made
from planner_service.store.take_store import origin_of, take_number
from scene_graphs.home import Home
from scene_graphs.json_fields import Json

STAGES: Final = ("plan", "furnish", "narrate", "act", "move", "judge", "film")
SCRIPT, HOME, TOLD, ACTIONS, FIRST_SEGMENT = range(5)
"""Positions of what the stages make; the report and the film follow the last segment."""
_DONE: Final = {"plan": 0.05, "furnish": 0.10, "narrate": 0.12, "act": 0.20, "move": 0.85, "judge": 0.92, "film": 1.0}
"""Share of the whole that is done after a stage."""
AT_ONCE: Final = 4
"""Stories that a worker has in the making where a language model is waited for."""
ASKED_EVERY: Final = 2.0
"""Seconds between two looks whether somebody still wants an action that takes long."""
_OPEN: Final = AT_ONCE
"""Stories whose home and actions a worker keeps at hand."""
log = structlog.get_logger("sims.worker")


@dataclass
class Homes:
    """Homes of stories at hand: what is worked out about one is worked out once, though several stories play in it."""

    known: OrderedDict[Home, Home] = field(default_factory=OrderedDict)

    def shared(self, stage: Furnished) -> Furnished:
        """The same script in the home that is at hand, where an equal one is."""
        home = self.known.setdefault(stage.home, stage.home)
        self.known.move_to_end(home)
        while len(self.known) > _OPEN:
            self.known.popitem(last=False)
        return replace(stage, home=home)


@dataclass
class OpenStory:
    """A story in the making, read from the store as its stages come to need it."""

    store: Stories
    id: str
    house: Pipeline
    homes: Homes = field(default_factory=Homes)

    @cached_property
    def pipeline(self) -> Pipeline:
        """What it is made from, with a budget of its own."""
        return self.house.for_story(self.request.seed)

    @cached_property
    def request(self) -> StoryRequest:
        """What was asked for."""
        return self.store.request(self.id)

    @cached_property
    def stage(self) -> Furnished:
        """The script in its home, as furnishing left it."""
        return self.homes.shared(serialization.furnished_from_dict(self._json(HOME)))

    @cached_property
    def actions(self) -> tuple[Action, ...]:
        """What there is to do."""
        return tuple(serialization.action_from_dict(row) for row in self._json(ACTIONS)["actions"])

    @cached_property
    def origin(self) -> OpenStory | None:
        """The story that this one is a take of, or None; nothing of it may be left."""
        found = origin_of(self.store.engine, self.id)
        return None if found is None else OpenStory(self.store, found, self.house, self.homes)

    def segments(self, count: int) -> list[Made]:
        """The first so many segments, as far as they are there without a gap."""
        found = self.store.made(self.id, range(FIRST_SEGMENT, FIRST_SEGMENT + count))
        return [
            one for index, one in enumerate(found) if one.kind == "segment" and one.position == FIRST_SEGMENT + index
        ]

    @cached_property
    def obstacles(self) -> Obstacles:
        """Furniture and walls, for measuring."""
        return scene_of(self.stage.home).obstacles

    @cached_property
    def acted(self) -> Story:
        """The story acted out and measured, once all segments are there."""
        motions = read_segments(self.store, self.id, range(len(self.actions)))
        return judge(self.planned, self.actions, motions, lambda _stage, _share: None)

    @property
    def planned(self) -> Planned:
        """Script, home and told story; a motion without a story has an empty one."""
        if self.request.keyframes:
            return Planned(self.request, self.stage.script, self.stage, Told("", "", ()))
        told = self._json(TOLD)
        script = self.stage.script.model_copy(update={"repairs": tuple(told["repairs"])})
        spent = Spent(**told["spent"]) if told["spent"] else None
        return Planned(self.request, script, self.stage, Told.from_dict(told), spent)

    @property
    def role(self) -> Role:
        """Who is seen, and what the face shows."""
        return role_of(actor(self.request, self.stage.script), self.actions, self.stage.script, self.stage.home)

    def script(self) -> LongScript:
        """The long script, as planning left it."""
        return LongScript.model_validate(self._json(SCRIPT))

    def _json(self, position: int) -> Json:
        value: Json = json.loads(self.store.data(self.id, position))
        return value


def read_segments(store: Stories, story_id: str, indices: Sequence[int]) -> list[Motion]:
    """The motions of these segments, in order. StoryGone."""
    return [read_npz(io.BytesIO(data)) for data in store.parts(story_id, [FIRST_SEGMENT + i for i in indices])]


@dataclass
class Maker:
    """One worker's desk: where results go, what stories are made from, and the stories that lie open."""

    store: Stories
    pipeline: Pipeline
    worker: str
    open: OrderedDict[str, OpenStory] = field(default_factory=OrderedDict)
    homes: Homes = field(default_factory=Homes)
    directors: dict[str, Director] = field(default_factory=dict)
    turn: threading.RLock = field(default_factory=threading.RLock)
    """Held by whoever computes: stories take turns, and only those that wait for a language model let others go on."""
    _opening: threading.Lock = field(default_factory=threading.Lock)

    def plan(self, story_id: str) -> None:
        """Theme to long script."""
        self.store.begin(story_id, "plan")
        story = self._opened(story_id)
        self._record(story, "plan", SCRIPT, "script", lambda: self._script(story))

    def furnish(self, story_id: str) -> None:
        """A home for the script, and every keyframe's place in it."""
        story = self._opened(story_id)
        self._record(story, "furnish", HOME, "home", lambda: self._home(story))

    def narrate(self, story_id: str) -> None:
        """The told story."""
        story = self._opened(story_id)
        self._record(story, "narrate", TOLD, "told", lambda: self._told(story))

    def act(self, story_id: str) -> int:
        """Keyframes to actions; how many there are."""
        story = self._opened(story_id)
        taken: list[Made] = []

        def make() -> tuple[bytes, Json]:
            data, summary, reused = self._actions(story)
            taken.extend(reused)
            return data, summary

        self._record(story, "act", ACTIONS, "actions", make, lambda connection: put_made(connection, story_id, taken))
        if taken:
            log.info("segments taken over", derived_from=story.origin and story.origin.id, reused=len(taken))
        return len(story.actions)

    def move(self, story_id: str, index: int) -> None:
        """The motion of one action, from the state the one before left."""
        with self.turn:
            self._move(self._opened(story_id), index)

    def _move(self, story: OpenStory, index: int) -> None:
        story_id, started = story.id, time.perf_counter()
        director = self._director(story.request.backend)
        home, action = story.stage.home, story.actions[index]
        following = story.actions[index + 1] if index + 1 < len(story.actions) else None
        position = FIRST_SEGMENT + index
        first = 0
        if self.store.has(story_id, position):  # taken over from another story
            return
        if index == 0:
            state = director.begin(home, actor(story.request, story.stage.script), story.request.seed, action)
        else:
            state = BodyState.from_dict(self.store.segment(story_id, position - 1)[1])
            first = self._end_of(story_id, position - 1)
        backend: Any = director.backend
        if hasattr(backend, "between"):
            done = _moved(index, len(story.actions))
            backend.between = _now_and_then(lambda: self.store.go_on(story_id, done))
        motion, after = director.act(home, action, state, following)
        figures = story_metrics.judge(motion, action, story.obstacles)
        summary = {
            "index": index,
            "keyframe": action.keyframe,
            "start": first,
            "end": first + len(motion),
            "reached": figures.reached,
            "reason": figures.reason,
            "otherwise": [
                *(note.words for note in motion.notes),
                *filter(None, (story.stage.instead(action.keyframe),)),
            ],
            "segments": [asdict(segment) for segment in segments_of(motion)],
        }
        made = Made(
            kind="segment",
            position=position,
            data=npz_bytes(motion),
            summary=summary,
            following="judge" if index + 1 == len(story.actions) else None,
            progress=_moved(index + 1, len(story.actions)),
            seconds=time.perf_counter() - started,
            state=after.to_dict(),
        )
        self.store.record(story_id, made, self.worker)

    def judge(self, story_id: str) -> None:
        """Figures for every keyframe and the whole."""
        story = self._opened(story_id)
        position = FIRST_SEGMENT + len(story.actions)
        self._record(story, "judge", position, "report", lambda: self._report(story))

    def film(self, story_id: str) -> None:
        """The home and the animated body in one file."""
        story = self._opened(story_id)
        position = FIRST_SEGMENT + len(story.actions) + 1

        def make() -> tuple[bytes, Json]:
            return film_glb(story.stage.home, story.acted.motion, story.role), {}

        self._record(story, "film", position, "film", make)
        self.open.pop(story_id, None)

    def _script(self, story: OpenStory) -> tuple[bytes, Json]:
        script = story.pipeline.script(story.request)
        return script_made(story.request, script)

    def _home(self, story: OpenStory) -> tuple[bytes, Json]:
        stage = story.pipeline.furnish(story.request, story.script())
        return home_made(stage)

    def _told(self, story: OpenStory) -> tuple[bytes, Json]:
        stage, told = story.pipeline.tell(story.request, story.stage)
        spent = spent_on(story.pipeline.model)
        row = told.to_dict() | {"repairs": list(stage.script.repairs)}
        row["spent"] = asdict(spent) if spent else None
        return _to_bytes(row), row

    def _actions(self, story: OpenStory) -> tuple[bytes, Json, list[Made]]:
        """What there is to do, and the segments that a take has in common with the story it derives from."""
        stage, origin = story.stage, story.origin
        actions = story.pipeline.act(story.request, stage, kept_actions(story, origin))
        rows = [serialization.action_to_dict(action) for action in actions]
        summary = {"count": len(actions), "objects": [a.object_id for a in actions]}
        summary["captions"] = [action.caption for action in actions]
        role = role_of(story.request.acted_by, actions, stage.script, stage.home)
        director = self._director(story.request.backend) if origin else None
        taken = reused_segments(story, origin, rows, director) if director else []
        own = [_own(one, index, len(actions)) for index, one in enumerate(taken)]
        summary |= {"asleep": sorted(role.asleep), "reused": len(own)}
        summary["things"] = [asdict(thing) | {"keyframe": index} for index, thing in role.things.items()]
        summary["rests"] = [asdict(rest) | {"keyframe": index} for index, rest in role.rests.items()]
        summary["worked"] = [worked_to_dict(one) | {"keyframe": index} for index, one in role.worked.items()]
        if origin:
            summary["take"] = take_number(story.store.engine, story.id)
        return _to_bytes({"actions": rows}), summary, own

    def _report(self, story: OpenStory) -> tuple[bytes, Json]:
        row = {"report": report_to_dict(story.acted)}
        return _to_bytes(row), row

    def _record(
        self,
        story: OpenStory,
        stage: str,
        position: int,
        kind: str,
        make: Callable[[], tuple[bytes, Json]],
        also: Callable[[Connection], None] = lambda _connection: None,
    ) -> None:
        if self.store.has(story.id, position):  # made before a crash, or known before the story began
            return
        started, before = time.perf_counter(), spent_on(story.pipeline.model) or Spent()
        with self._turn_of(stage):
            data, summary = make()
        spent = (spent_on(story.pipeline.model) or Spent()) - before
        made = staged(story.request, stage, position, kind, data, summary, time.perf_counter() - started)

        def with_it(connection: Connection) -> None:
            count_spent(connection, self.worker, spent)
            also(connection)

        self.store.record(story.id, made, self.worker, with_it)

    def _turn_of(self, stage: str) -> AbstractContextManager[object]:
        """What a stage holds while it is made."""
        asks = stage in ("plan", "narrate") and self.pipeline.model is not None
        return nullcontext() if asks else self.turn

    def _opened(self, story_id: str) -> OpenStory:
        with self._opening:
            if story_id not in self.open:
                self.open[story_id] = OpenStory(self.store, story_id, self.pipeline, self.homes)
            self.open.move_to_end(story_id)
            while len(self.open) > _OPEN:
                self.open.popitem(last=False)
            return self.open[story_id]

    def _director(self, name: str) -> Director:
        if name not in self.directors:
            self.directors[name] = Director.of(name)
        return self.directors[name]

    def _end_of(self, story_id: str, position: int) -> int:
        found = self.store.get(story_id, position - 1).artifacts
        return int(found[0].summary["end"])


def script_made(request: StoryRequest, script: LongScript) -> tuple[bytes, Json]:
    """A script as it is stored, and what is shown of it."""
    shown = summary_of_script(script) | {"character": vars(actor(request, script))}
    return _to_bytes(script.model_dump(mode="json")), shown


def home_made(stage: Furnished) -> tuple[bytes, Json]:
    """The same of a script in its home."""
    return _to_bytes(serialization.furnished_to_dict(stage)), summary_of_home(stage)


def staged(
    request: StoryRequest, stage: str, position: int, kind: str, data: bytes, summary: Json, seconds: float = 0.0
) -> Made:
    """What a stage made, with what comes after it."""
    following = STAGES[STAGES.index(stage) + 1] if stage != STAGES[-1] else None
    if following == "narrate" and request.keyframes:
        following = "act"
    return Made(kind, position, data, summary, following, _DONE[stage], seconds, title=summary.get("title"))


def known_before(request: StoryRequest, script: LongScript, stage: Furnished | None) -> list[Made]:
    """Script and, where it stays, home of a story for which both are known before it begins."""
    made = [staged(request, "plan", SCRIPT, "script", *script_made(request, script))]
    return made if stage is None else [*made, staged(request, "furnish", HOME, "home", *home_made(stage))]


def _own(one: Made, index: int, count: int) -> Made:
    """A segment of another story as one of this, which has so many."""
    following = "judge" if index + 1 == count else None
    summary = one.summary | {"reused": True}
    return replace(one, summary=summary, following=following, progress=_moved(index + 1, count), seconds=0.0)


def _moved(count: int, of: int) -> float:
    """Share of the whole that is done when so many segments are made."""
    return round(_DONE["act"] + count / of * (_DONE["move"] - _DONE["act"]), 4)


def _now_and_then(ask: Callable[[], None]) -> Callable[[], None]:
    """Asks the first time that it is called, and then not before some seconds have passed."""
    asked = -ASKED_EVERY

    def between() -> None:
        nonlocal asked
        if time.monotonic() - asked >= ASKED_EVERY:
            asked = time.monotonic()
            # Whether it is wanted can be asked again; what is made will be stored when the database is back.
            with suppress(OperationalError, InterfaceError):
                ask()

    return between


def _to_bytes(value: Json) -> bytes:
    return json.dumps(value, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()
