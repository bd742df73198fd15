"""Stories and motions over HTTP: what may be asked for, and the one resource that both become."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    GetJsonSchemaHandler,
    StringConstraints,
    computed_field,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticKnownError

from motion_backend.backends import UnknownBackendError, offered_backends, require_backend
from motion_backend.body.cast import cast
from motion_backend.motion import Does, Emotion, Skill
from motion_backend.skeleton import MAX_HEIGHT, MIN_HEIGHT
from planner_service.composition.request import MAX_SHORT_SCRIPTS, Method
from planner_service.grounding.script_revision import EditedKeyframe
from planner_service.pipeline import MAX_SEED
from planner_service.scripts.acted_beats import IN_ITS_PLACE
from planner_service.scripts.script import MAX_NAME_LENGTH, Beat, Keyframe
from planner_service.themes.beats import MAX_THEME_LENGTH
from scene_graphs.home import MAX_ROOMS
from scene_graphs.json_fields import Json

State = Literal["queued", "running", "succeeded", "failed", "cancelled"]
Stage = Literal["plan", "furnish", "narrate", "act", "move", "judge", "film"]
Kind = Literal["story", "motion"]
RoomType = Literal["bedroom", "living_room", "dining_room", "study"]
Seed = Annotated[int, Field(ge=0, le=MAX_SEED, description="The same seed gives the same story.")]
LayoutId = Annotated[str, StringConstraints(min_length=1, max_length=200)]
METHOD = (
    "Every beat served by itself, whole short scripts woven (SIMS 3.2), or all written at once (SIMS 10's baseline)."
)
MAX_KEYFRAMES = 60
"""Keyframes of one motion."""
MAX_TAKEN = 200
"""Keyframes of a take: stories may be longer than motions."""


def _known(name: str) -> str:
    """The name of a backend; refused as any word is that is not one of several."""
    try:
        require_backend(name)
    except UnknownBackendError as error:
        *others, last = map(repr, offered_backends())
        expected = f"{', '.join(others)} or {last}" if others else last
        raise PydanticKnownError("literal_error", {"expected": expected}) from error
    return name


class _NamesThereAre:
    """Those that can be asked for when the schema is, as its enum."""

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return handler(schema) | {"enum": list(offered_backends())}


BackendName = Annotated[str, AfterValidator(_known), _NamesThereAre()]


class Ask(BaseModel):
    """A body that is sent: a field we do not know is a mistake, not an extension."""

    model_config = ConfigDict(extra="forbid", strict=True)


LookWord = Annotated[str, Field(max_length=40)]


def _look_word(name: str, what: str) -> Any:
    """A field of how a character looks: empty, or one of the cast's words, which the request itself checks."""
    return Field(
        "",
        description=f"{what} Empty: read in the theme, else chosen.",
        json_schema_extra={"enum": ["", *cast().known(name)]},
    )


class CharacterAsk(Ask):
    """Who acts."""

    name: str = Field("Sam", min_length=1, max_length=MAX_NAME_LENGTH, description="Printable letters.")
    pronouns: Literal["he", "she", "they"] = "they"
    height: float = Field(
        1.70, ge=MIN_HEIGHT, le=MAX_HEIGHT, description="Metres; left at 1.7, a child is as tall as children are."
    )
    member: LookWord = _look_word("member", "Who of the cast plays; the other words say what differs.")
    age: LookWord = _look_word("age", "An age group.")
    build: LookWord = _look_word("build", "How much flesh there is.")
    skin: LookWord = _look_word("skin", "Its tone.")
    hair: LookWord = _look_word("hair", "How it is worn.")
    hair_color: LookWord = _look_word("hair_color", "Its colour.")
    outfit: LookWord = _look_word("outfit", "The clothes.")


class StoryAsk(Ask):
    """A theme, and what else is wanted of its story; what is left out is chosen."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"theme": "A woman comes home tired, reads a book on the sofa and falls asleep.", "seed": 3},
                {
                    "theme": "He fails the interview, comes home, drinks and falls asleep.",
                    "rooms": ["living_room", "bedroom"],
                    "character": {"name": "Tom", "pronouns": "he", "height": 1.82},
                },
            ]
        }
    )

    theme: str = Field(
        min_length=1, max_length=MAX_THEME_LENGTH, description="What happens, in a few English sentences."
    )
    rooms: list[RoomType] = Field([], max_length=MAX_ROOMS, description="Room types to play in; empty: choose.")
    layouts: list[LayoutId] = Field(
        [], max_length=MAX_ROOMS, description="Ids of rooms to play in, joined to a home in place of retrieved ones."
    )
    home: Json | None = Field(None, description="A whole home to play in, as GET /v1/stories/{id}/home gives it.")
    short_scripts: int | None = Field(
        None, ge=1, le=MAX_SHORT_SCRIPTS, description="How many `matching` weaves; null: choose. Only with it."
    )
    method: Method = Field("auto", description=METHOD)
    backend: BackendName | None = Field(None, description="What moves the body; null: as the service is set.")
    seed: Seed = 0
    character: CharacterAsk | None = None


class MotionAsk(Ask):
    """Keyframes to be acted out in one room of the library or in a home of one's own."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "layout_id": "living-room-0016",
                    "keyframes": [
                        {"skill": "loco", "emotion": "tired", "caption": "slow walk", "furniture": "sofa"},
                        {"skill": "sitdown", "emotion": "tired", "caption": "sit slumped", "furniture": "sofa"},
                    ],
                }
            ]
        }
    )

    layout_id: LayoutId | None = Field(None, description="The room; or give `home`.")
    home: Json | None = Field(None, description="A whole home, as GET /v1/stories/{id}/home gives it; or `layout_id`.")
    keyframes: list[Keyframe] = Field(min_length=1, max_length=MAX_KEYFRAMES)
    backend: BackendName | None = None
    seed: Seed = 0
    character: CharacterAsk | None = None


class TakeAsk(Ask):
    """What is to be different in a take of a story; what is left out stays as it is."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "keyframes": [
                        {"index": 0, "skill": "loco", "emotion": "tired", "caption": "slow walk", "furniture": "sofa"},
                        {"skill": "sitdown", "emotion": "sad", "caption": "sit slumped", "furniture": "sofa"},
                    ]
                },
                {"seed": 7, "backend": "procedural"},
            ]
        }
    )

    keyframes: list[EditedKeyframe] | None = Field(
        None, min_length=1, max_length=MAX_TAKEN, description="The whole script as it is to be, in order."
    )
    home: Json | None = Field(None, description="Another home, as GET /v1/stories/{id}/home gives it.")
    layouts: list[LayoutId] = Field(
        [], max_length=MAX_ROOMS, description="Rooms of the library to play in instead, joined to one home, by id."
    )
    seed: Seed | None = Field(None, description="Another staging of the same script; null: as it was.")
    backend: BackendName | None = Field(None, description="What moves the body; null: what did.")
    character: CharacterAsk | None = Field(None, description="Who acts; null: who did.")


class CharacterShown(BaseModel):
    """Who acts."""

    name: str
    pronouns: str
    height: float = Field(description="Metres.")
    member: str = Field("", description="Who of the cast plays.")
    age: str = Field("", description="child, adult or old.")
    build: str = ""
    skin: str = ""
    hair: str = ""
    hair_color: str = ""
    outfit: str = Field("", description="What is worn.")


class Span(BaseModel):
    """A stretch of the told text and the keyframes it tells."""

    start: int = Field(description="First character.")
    end: int = Field(description="Behind the last one.")
    keyframes: list[int]


class Letters(BaseModel):
    """A stretch of the told text."""

    start: int = Field(description="First character.")
    end: int = Field(description="Behind the last one.")


class SegmentShown(BaseModel):
    """Frames of a keyframe that one backend made."""

    backend: str
    fallback: str | None = Field(description="Why another backend than the one asked for made them; null: it did.")


class KeyframeShown(BaseModel):
    """One moment: what is done, how, at what, and in which frames once it was moved."""

    index: int
    beat: int | None = Field(description="The beat it serves; null: it connects two others, or nobody asked for it.")
    also: list[int] = Field([], description="Further beats that it shows.")
    skill: Skill
    emotion: str = Field(description="As it was written.")
    mood: Emotion = Field(description="What that means: how it is told and acted.")
    caption: str
    furniture: str
    held: str = Field("", description="What is named to be in the hands, or reached for; empty: the caption says.")
    does: Literal[Does, ""] = Field("", description="What becomes of the piece under the hand; empty: nothing.")
    object_id: str | None = Field(description='"room_index/object_id" in the home.')
    room: str | None = Field(description="Where the body is; before a home is found, what is asked for.")
    start: int | None = Field(description="First frame.")
    end: int | None = Field(description="Behind the last frame.")
    short_script_id: str | None = Field(description="Where it comes from; null for a connecting keyframe.")
    reached: bool | None
    segments: list[SegmentShown] = Field([], description="Who made its frames, in order; known once they are there.")
    reused: bool = Field(False, description="Whether its frames are those of the story that this one derives from.")
    already: bool = Field(False, description="Whether the body rests there when the story begins.")
    asleep: bool = Field(False, description="Whether the eyes are shut; known once it can be acted.")


class BeatShown(Beat):
    """One thing that the theme says, and what became of it; as planned while nothing has been moved."""

    acted: bool = Field(description="Whether the body is seen doing it; if not, `why` says why not.")

    @computed_field(description="Whether it is not acted, but something else is seen in its place.")  # type: ignore[prop-decorator]
    @property
    def stood_for(self) -> bool:
        """Whether it is not acted, but something else is seen in its place."""
        return not self.acted and self.why.startswith(IN_ITS_PLACE)


class ShortScriptChosen(BaseModel):
    """A short script that was retrieved, for which beat, and how near its summary is."""

    id: str
    summary: str
    score: float
    beat: int


class GraphNode(BaseModel):
    """A piece of furniture that the script uses."""

    category: str
    instance: int
    room: str


class GraphShown(BaseModel):
    """The merged furniture graphs of the short scripts, room after room (SIMS 3.2)."""

    nodes: list[GraphNode] = []
    edges: list[tuple[int, int]] = []


class SubstitutionShown(BaseModel):
    """What the room has instead of what was asked for."""

    asked: str
    given: str
    level: str = Field(description="How near: same, class, group or, at last, affordance.")


class StandingShown(BaseModel):
    """Where a piece of furniture stands, in its room's own frame."""

    position: tuple[float, float, float]
    yaw: float


class PullShown(BaseModel):
    """A chair that stands elsewhere from the start than where the room had it."""

    object_id: str = Field(description="As in the room's own layout.")
    from_: StandingShown = Field(alias="from")
    to: StandingShown
    distance: float = Field(description="Metres.")


class RoomShown(BaseModel):
    """A room of the home and how well it fits."""

    layout_id: str
    room_type: str
    distance: int = Field(description="Simplified graph edit distance.")
    exact: bool
    substitutions: list[SubstitutionShown]
    missing: list[str]
    pulled_out: list[PullShown] = Field([], description="Chairs on which nobody could sit where they stood.")
    drawn_up: list[PullShown] = Field([], description="Chairs set nearer to their table, for what is done at it.")


class HomeShown(BaseModel):
    """How the home was found; the home itself is at links.home."""

    rooms: list[RoomShown]


class MotionShown(BaseModel):
    """What of the motion is ready."""

    frames: int
    fps: int = 30
    joints: int = 22
    duration: float = Field(description="Seconds.")
    complete: bool


class Failure(BaseModel):
    """Why a story could not be made."""

    title: str
    detail: str


class Links(BaseModel):
    """Where the rest is."""

    model_config = ConfigDict(populate_by_name=True)

    self_: str = Field(alias="self")
    events: str
    cancel: str
    takes: str = Field(description="POST here derives a story from this one.")
    motion: str
    film: str
    usd: str = Field(description="The same as USD, where usd-core is installed.")
    mp4: str = Field(description="The story filmed, for any player; POST to `self`/film makes it.")
    scene: str
    props: str = Field(description="What is in the hands, for a player that has its own clock.")
    home: str


class StorySummary(BaseModel):
    """A story in a list."""

    id: str
    kind: Kind
    state: State
    stage: Stage | None = Field(description="What is being made, or where it ended.")
    progress: float = Field(ge=0, le=1)
    created: datetime
    theme: str
    title: str | None
    seed: int
    backend: str
    duration: float = Field(description="Seconds of motion that are ready.")
    error: Failure | None
    derived_from: str | None = Field(None, description="The story that this one is a take of; it may be deleted.")
    links: Links


class StoryShown(StorySummary):
    """A story, as far as it is made."""

    method: str
    character: CharacterShown
    planner: str | None = Field(description='"rules", "llm:<model>", or "given" for keyframes of one\'s own.')
    encoder: str | None = Field(description="The sentence encoder that ranked the library.")
    text: str | None
    spans: list[Span] = []
    thoughts: list[Letters] = Field([], description="What of `text` the body is not seen doing.")
    beats: list[BeatShown] = Field(
        [], description="What the theme says, in order; `why` says why one is not acted, and `kind` what it is."
    )
    repairs: list[str] = Field([], description="What checking changed, and why.")
    keyframes: list[KeyframeShown] = []
    reused: int = Field(
        0, description="Keyframes, from the first on, whose motion was taken over from `derived_from` as it was."
    )
    take: int = Field(
        0,
        description="Which take it is: those of a story, and theirs, are counted as asked for; 0 for none, and "
        "until places are found.",
    )
    short_scripts: list[ShortScriptChosen] = []
    graph: GraphShown = Field(default_factory=GraphShown)
    home: HomeShown | None = None
    motion: MotionShown
    report: Json | None = Field(None, description="Figures for every keyframe and the whole; see docs/metrics.md.")


class StoryPage(BaseModel):
    """Stories, newest first."""

    items: list[StorySummary]
    next: str | None = Field(description="The cursor of the next page; null on the last.")
