"""One theme through the whole house: plan, furnish, narrate, act, move, judge (DESIGN section 4)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from motion_backend import metrics
from motion_backend.motion import Action, BodyState, Character, Motion, MotionBackend, join
from motion_backend.obstacles import Obstacles
from planner_service.furnish import Furnished, furnish
from planner_service.llm.protocol import LanguageModel
from planner_service.scripts.acting import act
from planner_service.scripts.composing import Request, compose
from planner_service.scripts.keyframe import LongScript
from planner_service.scripts.library import ScriptLibrary
from planner_service.scripts.narrating import Told, narrate, narrate_with_model
from scene_graphs.homes import Home
from scene_graphs.layouts import Layout, read_layouts
from scene_graphs.library import built_in_layouts
from scene_graphs.retrieval import LayoutIndex

Progress = Callable[[str, float], None]
"""Called with a stage's name and the share of it that is done, 0 to 1."""
STAGES = ("plan", "furnish", "narrate", "act", "move", "judge")


@dataclass(frozen=True)
class StoryRequest:
    """What a user may ask for; empty means: choose for me."""

    theme: str
    rooms: tuple[str, ...] = ()
    """Room types, one to four."""
    layouts: tuple[Layout, ...] = ()
    """Rooms of the user's own, used in place of retrieved ones."""
    short_scripts: int | None = None
    method: str = "matching"
    backend: str = "procedural"
    seed: int = 0
    character: Character = Character()


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
        return (*built_in_layouts(), *extra)

    @cached_property
    def index(self) -> LayoutIndex:
        """The rooms, ready to be searched."""
        return LayoutIndex(self.layouts)

    def plan(self, request: StoryRequest, progress: Progress = lambda stage, share: None) -> Planned:
        """Theme to narrated story in a furnished home, without motion."""
        progress("plan", 0.0)
        asked = Request(request.short_scripts, request.rooms, request.seed, request.method)  # type: ignore[arg-type]
        script = compose(request.theme, self.library, asked, self.model)
        progress("furnish", 0.0)
        stage = furnish(script, self.index, request.rooms, request.layouts, request.seed)
        progress("narrate", 0.0)
        if self.model is None:
            told = narrate(stage.script, request.character, request.seed, stage.names)
        else:
            told = narrate_with_model(stage.script, request.character, self.model, stage.names)
        return Planned(request, stage.script, stage, told)

    def make(self, request: StoryRequest, progress: Progress = lambda stage, share: None) -> Story:
        """Theme to acted story."""
        planned = self.plan(request, progress)
        progress("act", 0.0)
        actions = act(planned.script.keyframes, planned.stage.places, planned.home, request.seed)
        motions = move(planned.home, actions, request, progress)
        return judge(planned, actions, motions, progress)


def load_backend(name: str) -> MotionBackend:
    """The motion backend of that name. ValueError names those there are."""
    from motion_backend.procedural.backend import ProceduralBackend

    known: dict[str, Callable[[], MotionBackend]] = {"procedural": ProceduralBackend}
    if name not in known:
        raise ValueError(f"backend: {name!r} is none of {', '.join(known)}")
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
