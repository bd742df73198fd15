"""The planner's words, as in the paper's tables: keyframe, short script, long script (SIMS 3.2, 9, 10)."""

from __future__ import annotations

import re
import unicodedata
from typing import Annotated, Final, Literal

from pydantic import AliasChoices, BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo, field_validator
from pydantic_core import PydanticKnownError

from motion_backend.emotion_words import emotion_of
from motion_backend.motion import Does, Emotion, Reacts, Skill, skills_named
from planner_service.themes.opening_words import spelt_out

EMOTIONS: Final[tuple[Emotion, ...]] = tuple(Emotion)
"""Neutral and the eight emotions or styles of SIMS 4.1."""

Room = Literal["bedroom", "living_room", "dining_room", "study"]
Source = Literal["authored", "video", "text", "imitation"]
MAX_PIECES = 24
"""Pieces of furniture in one short script: one a keyframe."""
MAX_VERSIONS = 1_000_000
MAX_THING_LENGTH: Final = 40
Word = Annotated[str, Field(min_length=1, max_length=60)]
Instance = Annotated[int, Field(ge=1, le=99, strict=True)]
Place = Annotated[int, Field(ge=0, lt=MAX_PIECES, strict=True)]
_INSTANCE = re.compile(r"^(?P<name>.*?)[\s_#]+(?P<number>[1-9]\d?)$")


def legible(text: object) -> object:
    """A text in one line, without what a terminal or page would obey instead of showing; other values unchanged."""
    if not isinstance(text, str):
        return text
    if text.isascii() and text.isprintable():
        return " ".join(text.split())
    shown = "".join(" " if unicodedata.category(one) in ("Cc", "Zl", "Zp") else one for one in text)
    return " ".join("".join(one for one in shown if unicodedata.category(one) not in ("Cf", "Cs", "Co")).split())


Line = Annotated[str, BeforeValidator(legible)]


def skill_of(said: object) -> Skill:
    """The skill of its name or of what people call it. PydanticKnownError, a ValueError, names all of them."""
    try:
        return said if isinstance(said, Skill) else Skill(str(said))
    except ValueError:
        raise PydanticKnownError("enum", {"expected": skills_named()}) from None


SkillWord = Annotated[Skill, BeforeValidator(skill_of)]
"""A skill as somebody writes it: "sitdown", or "sit down" or "sit" as stories print it."""


class _ScriptPart(BaseModel):
    """What scripts are made of: it never changes, and has its own fields alone."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Keyframe(_ScriptPart):
    """One moment of a script: a skill in an emotion, told by a caption, at a piece of furniture or the floor."""

    model_config = ConfigDict(populate_by_name=True)

    skill: SkillWord
    emotion: Line = Field("neutral", validation_alias=AliasChoices("emotion", "emotion/style"), max_length=80)
    """In free words, as it was written: "tired, sad"."""
    caption: Line = Field(min_length=1, max_length=200)
    furniture: Line = Field("floor", validation_alias=AliasChoices("furniture", "furnitures"), max_length=60)
    """A furniture word, with an instance number when a script uses two of a kind ("wardrobe 2"), or "floor"."""
    held: Line = Field("", max_length=MAX_THING_LENGTH, exclude_if=lambda thing: not thing)
    """What is in the hands, or is reached for, by its name: "letter"; empty where only the caption says."""
    does: Literal[Does, ""] = Field("", exclude_if=lambda done: not done)
    """What becomes of the piece under the hand: it is opened, shut, opened for as long as the hand is there ("into"),
    switched on or off; empty where nothing of it moves."""

    @property
    def mood(self) -> Emotion:
        """What its emotion means: all that planner, narration and body go by. Words nobody knows are neutral."""
        return emotion_of(self.emotion) or Emotion.NEUTRAL

    @property
    def piece(self) -> tuple[str, int]:
        """The furniture word and its instance number, 1 unless it says otherwise."""
        match = _INSTANCE.match(self.furniture)
        return (match["name"], int(match["number"])) if match else (self.furniture, 1)

    @property
    def on_floor(self) -> bool:
        """Whether it needs no furniture."""
        return self.furniture.lower() == "floor"


class ScriptGraph(_ScriptPart):
    """The furniture a script uses and which pieces belong together; nodes as in `Keyframe.furniture`."""

    nodes: tuple[tuple[Word, Instance], ...] = Field((), max_length=MAX_PIECES)
    edges: tuple[tuple[Place, Place], ...] = Field((), max_length=MAX_PIECES * (MAX_PIECES - 1) // 2)

    @field_validator("edges")
    @classmethod
    def _between_nodes(cls, edges: tuple[tuple[int, int], ...], info: ValidationInfo) -> tuple[tuple[int, int], ...]:
        nodes = info.data.get("nodes", ())
        if any(max(edge) >= len(nodes) for edge in edges):
            raise ValueError(f"an edge joins two places in nodes, which has {len(nodes)}")
        return edges


class Origin(_ScriptPart):
    """Where a short script was found, or what it was made in the manner of."""

    name: Line = Field(min_length=1, max_length=200)
    """What the film, text or model is called; a name, never a path."""
    start: float | None = Field(None, ge=0, allow_inf_nan=False)
    """Where in a film it begins (seconds)."""
    end: float | None = Field(None, ge=0, allow_inf_nan=False)
    by: Line = Field("", max_length=200)
    """Who wrote it down: "rules" or "llm:<model>"."""
    like: tuple[str, ...] = Field((), max_length=20)
    """Ids of the scripts it imitates."""

    @field_validator("end")
    @classmethod
    def _after_start(cls, end: float | None, info: ValidationInfo) -> float | None:
        start = info.data.get("start")
        if end is not None and start is not None and end < start:
            raise ValueError("a span ends where it begins, or later")
        return end


class ShortScript(_ScriptPart):
    """A few keyframes with one summary: what the library keeps and a story is woven from."""

    id: str = Field(pattern=r"^[a-z0-9][a-z0-9-]{0,79}$")
    summary: Line = Field(min_length=1, max_length=400)
    emotion: Emotion
    room: Room
    keyframes: tuple[Keyframe, ...] = Field(min_length=1, max_length=MAX_PIECES)
    cues: tuple[Annotated[Line, Field(min_length=1, max_length=200)], ...] = Field((), max_length=12)
    """Other words for what happens, by which it is found too; they are never told."""
    graph: ScriptGraph | None = None
    """Given, or derived from the keyframes: an edge between two pieces used one after the other."""
    source: Source = "authored"
    licence: Line = Field("MIT", min_length=1, max_length=200)
    origin: Origin | None = None
    """Where it was found; None for what somebody wrote."""
    version: int = Field(1, ge=1, le=MAX_VERSIONS, strict=True)
    """Raised when a script is kept again under its id."""


class Reacted(_ScriptPart):
    """Something that happens, before or after a keyframe, and how the body takes it."""

    beats: tuple[int, ...]
    """The theme's beats that tell of it."""
    how: Reacts
    at: Line = ""
    """Where it is: "door", "window" or a piece of furniture; empty: the nearest door."""
    after: bool = False


class PlannedKeyframe(Keyframe):
    """A keyframe of a long script, with where it came from."""

    short_script: int | None = None
    """Index into the long script's short scripts; None where it was written, or connects two others."""
    beat: int | None = None
    """Index of the theme's beat it serves; a walk or rising that leads to a deed serves the deed's beat."""
    also: tuple[int, ...] = ()
    """Further beats that it shows: who sits on the sofa and reads does both in one keyframe."""
    room: Room | None = None
    object_id: str | None = Field(None, max_length=200)
    """The object of the home that somebody chose for it; None: one is found."""
    already: bool = False
    """Whether the body sits or lies there when the story begins; so only of the first keyframe."""
    reacts: tuple[Reacted, ...] = Field((), exclude_if=lambda rows: not rows)
    """What happens besides, and is reacted to."""


class Retrieved(_ScriptPart):
    """A short script that was chosen, for which beat of the theme, and how near its summary was."""

    script: ShortScript
    beat: int
    score: float


REACTED: Final = "the body reacts to it"
"""Why what happens, and nobody does, is not acted."""
BeatKind = Literal["deed", "feeling", "undone", "memory", "other", "speech"]
"""What a beat is: something done at home now · how somebody feels · what is not done, or only wished for · what
happened before and is only thought of · what somebody else or the world does, or, of nobody, what is only told: "it is
Sunday" · what is said."""


HAPPENS: Final = "it happens, and nobody does it"
"""Why what weather and things do is not acted."""
WISHED: Final = "it is only wished for"
"""Why what somebody wants is not acted."""


class Beat(_ScriptPart):
    """One thing that a theme says happens, or does not, in the order of time."""

    text: Line
    """The theme's words for it, without whom the story is about: "drinks a glass of wine"."""
    emotion: Emotion = Emotion.NEUTRAL
    """The mood it happens in."""
    kind: BeatKind = "deed"
    who: Line = ""
    """Whose deed it is where it is not the story's person's: "the neighbour", "it"."""
    why: Line = ""
    """Why no keyframe shows it; empty where one does."""
    unshown: tuple[Line, ...] = ()
    """What its words tell besides, which no keyframe shows: "for her ladyship"; all of them where something only stands
    for it: a spin for "conducts an orchestra"."""

    replaced: bool = False
    """Whether somebody put other keyframes in the place of those that were to show it: it is told what they do."""

    @property
    def stood_for(self) -> bool:
        """Whether its keyframes show something else in its place."""
        return self.text in self.unshown

    @property
    def seen(self) -> bool:
        """Whether it is planned that the body is seen doing it, or in its mood."""
        return self.kind in ("deed", "feeling") and not (self.why or self.who or self.stood_for)

    @property
    def asked(self) -> bool:
        """Whether the theme asks for it: all but what is left undone or wished for, what nobody does, and what only
        happens, and is reacted to."""
        told = self.kind == "undone" or (self.kind == "other" and not self.who)
        return not (told or self.why == HAPPENS or self.why.startswith(REACTED))


Pronouns = Literal["he", "she", "they"]
MAX_NAME_LENGTH: Final = 40


class Person(_ScriptPart):
    """Whom a theme is about, as a language model read it; what it does not tell is empty."""

    name: Line = Field("", max_length=MAX_NAME_LENGTH)
    pronouns: Pronouns | Literal[""] = ""
    age: int | None = Field(None, ge=0, le=120)
    """Years."""


class LongScript(_ScriptPart):
    """The whole plan: beats of the theme, the short scripts chosen for them, and every keyframe in order."""

    theme: str
    beats: tuple[Beat, ...]
    short_scripts: tuple[Retrieved, ...]
    keyframes: tuple[PlannedKeyframe, ...]
    repairs: tuple[str, ...] = ()
    """What checking changed, and why."""
    person: Person | None = None
    """Whom the model read in the theme; None where rules did."""
    method: Literal["auto", "matching", "direct"] = "auto"
    planner: str = "rules"
    """What planned it: "rules" or "llm:<model>"."""
    encoder: str = ""
    """The sentence encoder that ranked the library."""
    seed: int = 0

    def said_of(self, keyframe: PlannedKeyframe) -> str:
        """The theme's words of all that a keyframe shows, with the door or window that "it" means; not of what somebody
        put it in the place of."""
        shown = {keyframe.beat, *keyframe.also}  # keyframes of one's own may name beats of another story
        texts = [beat.text for beat in self.beats]
        return "; ".join(
            spelt_out(beat.text, texts[:number])
            for number, beat in enumerate(self.beats)
            if number in shown and not beat.replaced
        )

    @property
    def acted(self) -> int:
        """How many of the beats asked for some keyframe shows, and not only something in their place."""
        return sum(beat.asked and not beat.why and not beat.stood_for for beat in self.beats)

    @property
    def asked(self) -> int:
        """How many beats the theme asks for."""
        return sum(beat.asked for beat in self.beats)
