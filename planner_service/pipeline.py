"""One theme through the whole house: plan, furnish, narrate, act, move, judge."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Final, get_args

from motion_backend.backends import DEFAULT_BACKEND, require_backend
from motion_backend.body.cast import InHand, Look, Role, Worked, acted_captions, named_things
from motion_backend.director import Director, shares
from motion_backend.metrics import story_metrics
from motion_backend.metrics.story_figures import story_figures
from motion_backend.motion import Action, Character, Motion, Skill, join
from motion_backend.physics.physics_record import physics_of
from motion_backend.scene import scene_of
from motion_backend.skeleton import MAX_HEIGHT, MIN_HEIGHT, REFERENCE_HEIGHT
from planner_service.cast_choice import cast_for, check_character, named_as
from planner_service.composition.compose import compose, script_of
from planner_service.composition.request import MAX_SHORT_SCRIPTS, METHODS, Request
from planner_service.grounding.furnish import Furnished, furnish
from planner_service.grounding.keyframes_to_actions import Kept, act
from planner_service.grounding.resting_places import resting_places
from planner_service.grounding.room_assignment import usual_furniture
from planner_service.grounding.worked_pieces import worked_pieces
from planner_service.library.library import Shelves
from planner_service.llm.budget import Spent
from planner_service.llm.client import for_story, spent_on
from planner_service.llm.protocol import LanguageModel, ModelError
from planner_service.narration.llm_narrator import narrate_with_model
from planner_service.narration.narrator import narrate
from planner_service.narration.told import Told
from planner_service.scripts.acted_beats import ActedBeats, Shot, acted_beats, lost_in_moving, shot_of
from planner_service.scripts.captions import Vocabulary
from planner_service.scripts.script import MAX_NAME_LENGTH, Keyframe, LongScript, Pronouns
from planner_service.themes.protagonist import cast_by
from scene_graphs.errors import UserError
from scene_graphs.furniture import ROOM_TYPES, canonical_room
from scene_graphs.home import MAX_ROOMS, Home, home_from_dict, home_to_dict
from scene_graphs.json_fields import Json
from scene_graphs.layout import Layout, layout_from_dict, layout_to_dict

Progress = Callable[[str, float], None]
"""Called with a stage's name and the share of it that is done, 0 to 1."""
STAGES = ("plan", "furnish", "narrate", "act", "move", "judge")
PRONOUNS = get_args(Pronouns)
_ASLEEP: Final = re.compile(
    r"\b(?:asleep|sleeps?|sleeping|naps?|napping|dozes?|dozing|slumbers?"
    r"|(?:closes?|shuts?) (?:his|her|their|my) eyes)\b",
    re.IGNORECASE,
)
"""Words of what is acted, seated or lying, with closed eyes."""
MAX_SEED = 2**53 - 1
"""The largest whole number that every JSON reader keeps exactly."""


class RequestError(UserError):
    """What is asked of a story cannot be had; the text names the field and what would be right."""


@dataclass(frozen=True)
class StoryRequest:
    """What a user may ask for; empty means: choose for me.

    RequestError names the first field that is out of bounds, UnknownBackendError the backends there are.
    """

    theme: str
    rooms: tuple[str, ...] = ()
    """Room types, one to four."""
    layouts: tuple[Layout, ...] = ()
    """Rooms of the user's own, used in place of retrieved ones."""
    home: Home | None = None
    """A whole home of the user's own, used as it is."""
    keyframes: tuple[Keyframe, ...] = ()
    """A script of the user's own: nothing is planned, and the story is not told."""
    short_scripts: int | None = None
    method: str = "auto"
    backend: str = DEFAULT_BACKEND
    seed: int = 0
    character: Character = field(default_factory=Character)
    """Who acts; with the name and pronouns of the theme's person where both are left at their defaults. How they look
    is filled up by `actor`."""

    def __post_init__(self) -> None:
        for room in self.rooms:
            _one_of("rooms", canonical_room(room), ROOM_TYPES, room)
        require_backend(self.backend)
        _one_of("method", self.method, METHODS)
        if max(len(set(self.rooms)), len(self.layouts)) > MAX_ROOMS:
            field, count = ("rooms", len(self.rooms)) if len(self.rooms) > MAX_ROOMS else ("layout", len(self.layouts))
            raise RequestError(
                f"a home has one to {MAX_ROOMS} rooms, {count} were asked for", "leave some out", at=field
            )
        ids = [layout.id for layout in self.layouts]
        for number, layout_id in enumerate(ids):
            if layout_id in ids[:number]:
                raise RequestError(f"two rooms are called {layout_id!r}", "give every room its own id", at="layout")
        if self.short_scripts is not None and not 1 <= self.short_scripts <= MAX_SHORT_SCRIPTS:
            raise RequestError(
                f"must be a number from 1 to {MAX_SHORT_SCRIPTS}, got {self.short_scripts}", at="short_scripts"
            )
        if self.short_scripts is not None and self.method != "matching":
            raise RequestError(
                f"{self.method} weaves no whole short scripts",
                "leave it out, or ask for method matching",
                at="short_scripts",
            )
        if self.home is not None and self.layouts:
            raise RequestError("give a whole home or layouts to join to one, not both", at="home")
        if not 0 <= self.seed <= MAX_SEED:
            raise RequestError(f"must be a whole number from 0 to {MAX_SEED}, got {self.seed}", at="seed")
        _check_character(self.character)
        object.__setattr__(self, "character", named_as(self.theme, self.character))

    @property
    def acted_by(self) -> Character:
        """The character with all that can be seen of it, as far as rules read it."""
        return cast_for(self.theme, self.character, self.seed)


def _check_character(character: Character) -> None:
    name = character.name.strip()
    if not name or len(name) > MAX_NAME_LENGTH or not name.isprintable():
        raise RequestError(
            f"must be 1 to {MAX_NAME_LENGTH} printable letters, got {name[:MAX_NAME_LENGTH]!r}", at="name"
        )
    _one_of("pronouns", character.pronouns.strip().lower().split("/")[0], PRONOUNS, character.pronouns)
    if not MIN_HEIGHT <= character.height <= MAX_HEIGHT:
        raise RequestError(f"must be {MIN_HEIGHT} to {MAX_HEIGHT} metres, got {character.height:g}", at="height")
    check_character(character)


def _one_of(field: str, value: str, known: Sequence[str], shown: str | None = None) -> None:
    if value not in known:
        raise RequestError(f"{shown or value!r:.60} is none of {', '.join(known)}", at=field)


def request_to_dict(request: StoryRequest) -> Json:
    """All that was asked for, own rooms whole: what a library holds later changes nothing."""
    return {
        "theme": request.theme,
        "rooms": list(request.rooms),
        "layouts": [layout_to_dict(layout) for layout in request.layouts],
        "home": home_to_dict(request.home) if request.home else None,
        "keyframes": [keyframe.model_dump(mode="json") for keyframe in request.keyframes],
        "short_scripts": request.short_scripts,
        "method": request.method,
        "backend": request.backend,
        "seed": request.seed,
        "character": vars(request.character),
    }


def request_from_dict(row: Json) -> StoryRequest:
    """The inverse of `request_to_dict`."""
    return StoryRequest(
        theme=row["theme"],
        rooms=tuple(row["rooms"]),
        layouts=tuple(layout_from_dict(layout) for layout in row["layouts"]),
        home=home_from_dict(row["home"]) if row["home"] else None,
        keyframes=tuple(Keyframe.model_validate(keyframe) for keyframe in row["keyframes"]),
        short_scripts=row["short_scripts"],
        method=row["method"],
        backend=row["backend"],
        seed=row["seed"],
        character=Character(**row["character"]),
    )


@dataclass(frozen=True)
class Planned:
    """A story told and grounded, not yet moved."""

    request: StoryRequest
    script: LongScript
    stage: Furnished
    told: Told
    spent: Spent | None = None
    """On the language model; None without one."""

    @property
    def home(self) -> Home:
        """The furnished home."""
        return self.stage.home

    @property
    def character(self) -> Character:
        """Who acts."""
        return actor(self.request, self.script)


@dataclass(frozen=True)
class Story:
    """A story that was acted out."""

    planned: Planned
    actions: tuple[Action, ...]
    motion: Motion
    segments: tuple[tuple[int, int], ...]
    """First frame and stop frame of every action."""
    figures: tuple[story_metrics.KeyframeFigures, ...]
    report: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def beats(self) -> ActedBeats:
        """What became of the theme's beats, now that the body has moved."""
        return acted_beats(self.planned.script.beats, self._shots)

    @cached_property
    def _shots(self) -> tuple[Shot, ...]:
        return tuple(map(self._shot, self.figures))

    def _shot(self, figure: story_metrics.KeyframeFigures) -> Shot:
        done = [note.words for note in self.motion.notes if note.keyframe == figure.keyframe]
        return replace(
            shot_of(self.planned.script.keyframes[figure.keyframe]),
            reached=figure.reached,
            reason=figure.reason,
            seconds=figure.seconds,
            otherwise=(*done, *filter(None, (self.planned.stage.instead(figure.keyframe),))),
            does=self.role.worked[figure.keyframe].does if figure.keyframe in self.role.worked else "",
        )

    @property
    def told(self) -> Told:
        """The story as it is told, with all among its thoughts that the body was not seen doing."""
        return self.planned.told.with_unseen(lost_in_moving(self.planned.script.beats, self._shots))

    @cached_property
    def role(self) -> Role:
        """Who is seen, what the face shows, and what the hands hold, open and switch."""
        return role_of(self.planned.character, self.actions, self.planned.script, self.planned.home)


@dataclass
class Pipeline:
    """What stories are made from: scripts, rooms, a language model if there is one. Heavy parts load on first use."""

    shelves: Shelves = field(default_factory=Shelves)
    model: LanguageModel | None = None
    insist: bool = False
    """Whether a story fails where its model does; else the rules take over."""

    def for_story(self, seed: int) -> Pipeline:
        """The same pipeline for one story, with a budget of its own for the model."""
        return replace(self, model=for_story(self.model, seed))

    def plan(self, request: StoryRequest, progress: Progress = lambda _stage, _share: None) -> Planned:
        """Theme to narrated story in a furnished home, without motion."""
        pipeline = self.for_story(request.seed)
        progress("plan", 0.0)
        script = pipeline.script(request)
        progress("furnish", 0.0)
        stage = pipeline.furnish(request, script)
        progress("narrate", 0.0)
        stage, told = pipeline.tell(request, stage)
        return Planned(request, stage.script, stage, told, spent_on(pipeline.model))

    def script(self, request: StoryRequest) -> LongScript:
        """The long script of a theme; what the user wrote as keyframes is only checked and repaired."""
        if request.keyframes:
            return given_script(request)
        asked = Request(request.short_scripts, _rooms(request), request.seed, request.method, self._furniture(request))  # type: ignore[arg-type]
        return compose(request.theme, self.shelves.scripts(), asked, self.model, self.insist)

    def _furniture(self, request: StoryRequest) -> dict[str, frozenset[str]]:
        """Categories of furniture that there will be, by room type: of the user's home, else of rooms as they are."""
        rooms = _rooms(request) or ROOM_TYPES
        if own := [room.layout for room in request.home.rooms] if request.home else request.layouts:
            there = frozenset(placed.category for layout in own for placed in layout.objects)
            return dict.fromkeys(map(canonical_room, rooms), there)
        return {room: usual_furniture(self.shelves.layouts().layouts, room) for room in map(canonical_room, rooms)}

    def furnish(self, request: StoryRequest, script: LongScript) -> Furnished:
        """The home of a script, and every keyframe's place in it."""
        given = request.home or request.layouts
        return furnish(script, self.shelves.layouts(), _rooms(request), given, request.seed)

    def tell(self, request: StoryRequest, stage: Furnished) -> tuple[Furnished, Told]:
        """The story as the model tells it, else as the rules do, with a note why among the script's repairs."""
        character = actor(request, stage.script)
        if self.model is not None:
            try:
                return stage, narrate_with_model(stage.script, character, self.model, stage.names)
            except ModelError as error:
                if self.insist:
                    raise
                repairs = (*stage.script.repairs, f"told by rules: {error}")
                stage = replace(stage, script=stage.script.model_copy(update={"repairs": repairs}))
        return stage, narrate(stage.script, character, request.seed, stage.names)

    def act(self, request: StoryRequest, stage: Furnished, kept: Sequence[Kept | None] = ()) -> tuple[Action, ...]:
        """The keyframes of a script, grounded in its home; what is `kept` of each of them stays as it was."""
        scale = actor(request, stage.script).height / REFERENCE_HEIGHT
        said = [stage.script.said_of(keyframe) for keyframe in stage.script.keyframes]
        return act(stage.script.keyframes, stage.places, stage.home, request.seed, self.words, scale, kept, said)

    def words(self) -> Vocabulary:
        """The captions that the body knows, compared by their meaning."""
        return Vocabulary.built_in(self.shelves.scripts().encoder)

    def make(self, request: StoryRequest, progress: Progress = lambda _stage, _share: None) -> Story:
        """Theme to acted story."""
        require_backend(request.backend)
        return self.play(self.plan(request, progress), progress)

    def play(
        self,
        planned: Planned,
        progress: Progress = lambda _stage, _share: None,
        kept: Sequence[Kept | None] = (),
    ) -> Story:
        """A planned story acted out; `kept` of its keyframes stay grounded as they were."""
        director = Director.of(planned.request.backend)
        progress("act", 0.0)
        actions = self.act(planned.request, planned.stage, kept)
        motions = move(director, planned, actions, progress)
        return judge(planned, actions, motions, progress)


def actor(request: StoryRequest, script: LongScript) -> Character:
    """Who acts a script, with all that can be seen of them: whom the user described, else whom the model read in the
    theme, else whom the rules did.
    """
    asked, read, person = request.character, cast_by(request.theme, Character()), script.person
    if person is None or asked.member or (asked.name, asked.pronouns) != (read.name, read.pronouns):
        return request.acted_by
    called = replace(asked, name=person.name or read.name, pronouns=person.pronouns or read.pronouns)
    return cast_for(request.theme, called, request.seed, person.age)


def role_of(character: Character, actions: Sequence[Action], script: LongScript, home: Home | None = None) -> Role:
    """Who is seen acting the actions of a script: the look, what face and hands show in each keyframe, and what of a
    home hands open, shut and switch.
    """
    emotions = {action.keyframe: action.emotion for action in actions}
    asleep = frozenset(
        action.keyframe
        for action in actions
        if action.skill in (Skill.LIEDOWN, Skill.SITDOWN) and _ASLEEP.search(_told_of(action, script))
    )
    worked = worked_pieces(actions, script, home) if home is not None else {}
    rests = resting_places(actions, home) if home is not None else {}
    things = _things(actions, worked)
    return Role(Look.of(character), emotions, asleep, acted_captions(actions), things, worked, rests)


def _things(actions: Sequence[Action], worked: Mapping[int, Worked]) -> dict[int, InHand]:
    """What is named to be in the hands; out of what a hand reaches into, and not off its top."""
    inside = {keyframe for keyframe, one in worked.items() if one.does == "into"}
    return {
        keyframe: replace(thing, on_top=thing.on_top and keyframe not in inside)
        for keyframe, thing in named_things(actions).items()
    }


def _told_of(action: Action, script: LongScript) -> str:
    """All words of an action: its keyframe's, and those of the beats it shows."""
    keyframe = script.keyframes[action.keyframe]
    return " ".join([keyframe.caption, action.interaction or "", script.said_of(keyframe)])


def given_script(request: StoryRequest) -> LongScript:
    """The script of a user's own keyframes. RequestError when there is nothing in it that a body can do."""
    script = script_of(request.keyframes, request.theme, request.seed)
    if not script.keyframes:
        raise RequestError(f"nothing is left of them: {'; '.join(script.repairs)}", at="keyframes")
    return script


def _rooms(request: StoryRequest) -> tuple[str, ...]:
    """The room types a story is looked for in."""
    own = [room.layout for room in request.home.rooms] if request.home else request.layouts
    return request.rooms or types_of(own)


def types_of(layouts: Sequence[Layout]) -> tuple[str, ...]:
    """The room types that rooms of the user's can be; a story is then looked for that plays there."""
    own = [layout.room_type for layout in layouts] + [tag for layout in layouts for tag in layout.tags]
    return tuple(room for room in dict.fromkeys(own) if room in ROOM_TYPES)[:MAX_ROOMS]


def move(director: Director, planned: Planned, actions: Sequence[Action], progress: Progress) -> list[Motion]:
    """One segment an action, each from the state the one before left."""
    state = director.begin(planned.home, planned.character, planned.request.seed, next(iter(actions), None))
    motions = []
    progress("move", 0.0)
    for motion, _ in director.play(planned.home, actions, state):
        motions.append(motion)
        progress("move", len(motions) / len(actions))
    return motions


def judge(planned: Planned, actions: Sequence[Action], motions: Sequence[Motion], progress: Progress) -> Story:
    """Figures for every keyframe and the whole, and the motion in one piece."""
    obstacles = scene_of(planned.home).obstacles
    figures, segments, frame = [], [], 0
    for index, (motion, action) in enumerate(zip(motions, actions, strict=True)):
        progress("judge", index / len(actions))
        figures.append(story_metrics.judge(motion, action, obstacles))
        segments.append((frame, frame + len(motion)))
        frame += len(motion)
    whole = join(list(motions))
    report = story_metrics.summarise(figures) | story_figures(whole, actions, segments).to_dict()
    report["made_by"] = shares(whole)
    report["physics"] = physics_of(whole)
    return Story(planned, tuple(actions), whole, tuple(segments), tuple(figures), report)
