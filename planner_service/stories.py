"""One theme through the whole house: plan, furnish, narrate, act, move, judge."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from motion_backend import metrics
from motion_backend.motion import Action, BodyState, Character, Motion, MotionBackend, join
from motion_backend.obstacles import Obstacles
from planner_service.furnish import MOST_ROOMS, Furnished, furnish
from planner_service.llm.protocol import LanguageModel, ModelError
from planner_service.scripts.acting import act
from planner_service.scripts.composing import MOST, Request, compose
from planner_service.scripts.keyframe import LongScript
from planner_service.scripts.library import ScriptLibrary
from planner_service.scripts.narrating import Told, narrate, narrate_with_model
from scene_graphs.furniture import ROOM_TYPES, canonical_room
from scene_graphs.homes import Home
from scene_graphs.layouts import Layout, LayoutError, read_layouts
from scene_graphs.library import built_in_layouts
from scene_graphs.retrieval import LayoutIndex

Progress = Callable[[str, float], None]
"""Called with a stage's name and the share of it that is done, 0 to 1."""
STAGES = ("plan", "furnish", "narrate", "act", "move", "judge")
BACKENDS = ("procedural",)
METHODS = ("matching", "direct")
PRONOUNS = ("he", "she", "they")
LONGEST_NAME = 40
LEAST_HEIGHT, MOST_HEIGHT = 1.2, 2.2
"""Metres."""


class RequestError(ValueError):
    """What is asked of a story cannot be had; the text names the field and what would be right."""


@dataclass(frozen=True)
class StoryRequest:
    """What a user may ask for; empty means: choose for me. RequestError names the first field that is out of bounds."""

    theme: str
    rooms: tuple[str, ...] = ()
    """Room types, one to four."""
    layouts: tuple[Layout, ...] = ()
    """Rooms of the user's own, used in place of retrieved ones."""
    short_scripts: int | None = None
    method: str = "matching"
    backend: str = "procedural"
    seed: int = 0
    character: Character = field(default_factory=Character)

    def __post_init__(self) -> None:
        for room in self.rooms:
            _one_of("rooms", canonical_room(room), ROOM_TYPES, room)
        _one_of("backend", self.backend, BACKENDS)
        _one_of("method", self.method, METHODS)
        if max(len(set(self.rooms)), len(self.layouts)) > MOST_ROOMS:
            field, count = ("rooms", len(self.rooms)) if len(self.rooms) > MOST_ROOMS else ("layout", len(self.layouts))
            raise RequestError(f"{field}: a home has one to {MOST_ROOMS} rooms, {count} were asked for; leave some out")
        ids = [layout.id for layout in self.layouts]
        for number, layout_id in enumerate(ids):
            if layout_id in ids[:number]:
                raise RequestError(f"layout: two rooms are called {layout_id!r}; give every room its own id")
        if self.short_scripts is not None and not 1 <= self.short_scripts <= MOST:
            raise RequestError(f"short_scripts: must be a number from 1 to {MOST}, got {self.short_scripts}")
        if self.seed < 0:
            raise RequestError(f"seed: must be a whole number, 0 or more, got {self.seed}")
        _check_character(self.character)


def _check_character(character: Character) -> None:
    name = character.name.strip()
    if not name or len(name) > LONGEST_NAME or not name.isprintable():
        raise RequestError(f"name: must be 1 to {LONGEST_NAME} printable letters, got {name[:LONGEST_NAME]!r}")
    _one_of("pronouns", character.pronouns.strip().lower().split("/")[0], PRONOUNS, character.pronouns)
    if not LEAST_HEIGHT <= character.height <= MOST_HEIGHT:
        raise RequestError(f"height: must be {LEAST_HEIGHT} to {MOST_HEIGHT} metres, got {character.height:g}")


def _one_of(field: str, value: str, known: Sequence[str], shown: str | None = None) -> None:
    if value not in known:
        raise RequestError(f"{field}: {shown or value!r:.60} is none of {', '.join(known)}")


@dataclass(frozen=True)
class Planned:
    """A story told and grounded, not yet moved."""

    request: StoryRequest
    script: LongScript
    stage: Furnished
    told: Told

    @property
    def home(self) -> Home:
        """The furnished home."""
        return self.stage.home


@dataclass(frozen=True)
class Story:
    """A story that was acted out."""

    planned: Planned
    actions: tuple[Action, ...]
    motion: Motion
    segments: tuple[tuple[int, int], ...]
    """First frame and stop frame of every action."""
    figures: tuple[metrics.KeyframeFigures, ...]
    report: dict[str, Any] = field(default_factory=dict)


@dataclass
class Studio:
    """What stories are made from: scripts, rooms, a language model if there is one. Heavy parts load on first use."""

    scripts_file: Path | None = None
    cache: Path | None = None
    layouts_file: Path | None = None
    model: LanguageModel | None = None

    @cached_property
    def library(self) -> ScriptLibrary:
        """Short scripts, ours and the user's."""
        return ScriptLibrary.read(self.scripts_file, cache=self.cache)

    @cached_property
    def layouts(self) -> tuple[Layout, ...]:
        """Rooms, ours and the user's."""
        extra = tuple(read_layouts(self.layouts_file)) if self.layouts_file else ()
        taken = {layout.id for layout in built_in_layouts()}
        for layout in extra:
            if layout.id in taken:
                raise LayoutError(f"{self.layouts_file}: {layout.id!r} is the id of a built-in room; choose another id")
        return (*built_in_layouts(), *extra)

    @cached_property
    def index(self) -> LayoutIndex:
        """The rooms, ready to be searched."""
        return LayoutIndex(self.layouts)

    def plan(self, request: StoryRequest, progress: Progress = lambda _stage, _share: None) -> Planned:
        """Theme to narrated story in a furnished home, without motion."""
        progress("plan", 0.0)
        rooms = request.rooms or types_of(request.layouts)
        asked = Request(request.short_scripts, rooms, request.seed, request.method)  # type: ignore[arg-type]
        script = compose(request.theme, self.library, asked, self.model)
        progress("furnish", 0.0)
        stage = furnish(script, self.index, rooms, request.layouts, request.seed)
        progress("narrate", 0.0)
        told, notes = self._tell(stage, request)
        if notes:
            script = stage.script.model_copy(update={"repairs": (*stage.script.repairs, *notes)})
            stage = replace(stage, script=script)
        return Planned(request, stage.script, stage, told)

    def _tell(self, stage: Furnished, request: StoryRequest) -> tuple[Told, tuple[str, ...]]:
        """The story as the model tells it, else as the rules do, with a note why."""
        notes: tuple[str, ...] = ()
        if self.model is not None:
            try:
                return narrate_with_model(stage.script, request.character, self.model, stage.names), ()
            except ModelError as error:
                notes = (f"told by rules: {error}",)
        return narrate(stage.script, request.character, request.seed, stage.names), notes

    def make(self, request: StoryRequest, progress: Progress = lambda _stage, _share: None) -> Story:
        """Theme to acted story."""
        planned = self.plan(request, progress)
        progress("act", 0.0)
        actions = act(planned.script.keyframes, planned.stage.places, planned.home, request.seed)
        motions = move(planned.home, actions, request, progress)
        return judge(planned, actions, motions, progress)


def types_of(layouts: Sequence[Layout]) -> tuple[str, ...]:
    """The room types that rooms of the user's can be; a story is then looked for that plays there."""
    own = [layout.room_type for layout in layouts] + [tag for layout in layouts for tag in layout.tags]
    return tuple(room for room in dict.fromkeys(own) if room in ROOM_TYPES)[:MOST_ROOMS]


def load_backend(name: str) -> MotionBackend:
    """The motion backend of that name. RequestError names those there are."""
    from motion_backend.procedural.backend import ProceduralBackend

    _one_of("backend", name, BACKENDS)
    known: dict[str, Callable[[], MotionBackend]] = {"procedural": ProceduralBackend}
    return known[name]()


def move(home: Home, actions: Sequence[Action], request: StoryRequest, progress: Progress) -> list[Motion]:
    """One segment an action, each from the state the one before left."""
    backend = load_backend(request.backend)
    state: BodyState = backend.begin(home, request.character, request.seed)
    motions = []
    for index, action in enumerate(actions):
        progress("move", index / len(actions))
        motion, state = backend.advance(home, action, state)
        motions.append(motion)
    return motions


def judge(planned: Planned, actions: Sequence[Action], motions: Sequence[Motion], progress: Progress) -> Story:
    """Figures for every keyframe and the whole, and the motion in one piece."""
    obstacles = Obstacles.of_home(planned.home)
    figures, segments, frame = [], [], 0
    for index, (motion, action) in enumerate(zip(motions, actions, strict=True)):
        progress("judge", index / len(actions))
        figures.append(metrics.judge(motion, action, obstacles))
        segments.append((frame, frame + len(motion)))
        frame += len(motion)
    whole = join(list(motions))
    report = metrics.summarise(figures) | {"seam_jump": round(metrics.seam_jump(whole), 5)}
    return Story(planned, tuple(actions), whole, tuple(segments), tuple(figures), report)
