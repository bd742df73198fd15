"""The labelled queries and themes of `data/evaluation`, as its README.md describes them."""

from __future__ import annotations

import gzip
import json
from importlib import resources
from pathlib import Path
from typing import Annotated, Final, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from motion_backend.motion import Emotion, Skill
from planner_service.scripts.script import Keyframe
from planner_service.scripts.script_words import is_floor
from scene_graphs.errors import UserError
from scene_graphs.furniture import categories_of

Split = Literal["tune", "held_out"]
SPLITS: Final[tuple[Split, ...]] = ("tune", "held_out")
Kind = Literal["idiom", "synonym", "negation", "several", "furniture", "plain"]
_Id = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$")]
_Text = Annotated[str, Field(min_length=1)]


class _Label(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Query(_Label):
    """What somebody might type, and the short scripts that play it."""

    id: _Id
    query: _Text
    kind: Kind
    split: Split
    right: tuple[_Id, ...] = Field(min_length=1)
    """Ids of all that a fair person would accept, in no order."""


class Alternative(_Label):
    """One way a keyframe can show a beat: all that is given must hold of it."""

    skill: tuple[Skill, ...] = ()
    caption: tuple[_Text, ...] = ()
    """The caption has one of these in it."""
    furniture: tuple[_Text, ...] = ()
    """It is at one of these, or at another word for the same."""
    mood: tuple[Emotion, ...] = ()
    text: str = ""
    """What the labeller notes; it is not compared."""

    @model_validator(mode="after")
    def _says_something(self) -> Alternative:
        if not (self.names_a_deed or self.mood):
            raise ValueError("an alternative without a condition would be shown by every keyframe")
        return self

    @property
    def names_a_deed(self) -> bool:
        """Whether it asks for more than a mood."""
        return bool(self.skill or self.caption or self.furniture)

    def shown_by(self, keyframe: Keyframe) -> bool:
        """Whether the keyframe shows it."""
        caption, word = keyframe.caption.lower(), keyframe.piece[0]
        return (
            (not self.skill or keyframe.skill in self.skill)
            and (not self.caption or any(part.lower() in caption for part in self.caption))
            and (not self.furniture or any(_same_piece(word, other) for other in self.furniture))
            and (not self.mood or keyframe.mood in self.mood)
        )


class LabelledBeat(_Label):
    """One thing that a theme says, in the order of time."""

    text: _Text
    """In the theme's words."""
    actable: bool
    """Whether the captions and furniture there are can show it: decided before anything was run."""
    shown_by: tuple[Alternative, ...] = ()
    """Any of these shows it."""
    undone: bool = False
    """Whether the theme says that it is not done."""
    memory: bool = False
    """Whether it happened before the story and is only thought of."""

    @model_validator(mode="after")
    def _can_be_judged(self) -> LabelledBeat:
        if self.actable and (self.undone or not self.shown_by):
            raise ValueError(f"{self.text!r}: what is actable is done, and there is a keyframe that shows it")
        return self


class Person(_Label):
    """Whom the theme is about."""

    pronouns: Literal["he", "she", "they"] | None = None
    name: str | None = None


class LabelledTheme(_Label):
    """A theme, what happens in it, and what must not be seen; or one that is to be refused."""

    id: _Id
    theme: _Text
    split: Split
    """Which of the two files it is in."""
    person: Person = Person()
    beats: tuple[LabelledBeat, ...] = ()
    forbidden: tuple[Alternative, ...] = ()
    """What no keyframe may show: what the theme says is not done, or what would gainsay it."""
    refuse: bool = False
    """Whether there is nothing in it to be played."""

    @model_validator(mode="after")
    def _is_one_of_two(self) -> LabelledTheme:
        if self.refuse == bool(self.beats):
            raise ValueError(f"{self.id}: a theme has beats, or is to be refused")
        return self


def labelled_queries() -> tuple[Query, ...]:
    """The queries that are shipped."""
    return tuple(Query.model_validate_json(line) for line in _lines("retrieval.jsonl"))


def labelled_themes() -> tuple[LabelledTheme, ...]:
    """The themes that are shipped, each half from its own file."""
    return tuple(
        LabelledTheme.model_validate({**json.loads(line), "split": split}, strict=False)
        for split in SPLITS
        for line in _lines(f"beats_{split}.jsonl")
    )


def training_themes() -> tuple[tuple[LabelledTheme, ...], tuple[LabelledTheme, ...]]:
    """The labelled themes that the beat classifier learned from, and every fifth one, which was kept back."""
    with resources.files("planner_service").joinpath("data", "evaluation", "beats_learned.jsonl.gz").open("rb") as file:
        lines = gzip.decompress(file.read()).decode("utf-8").splitlines()
    themes = tuple(LabelledTheme.model_validate({**json.loads(line), "split": "tune"}, strict=False) for line in lines)
    return tuple(one for place, one in enumerate(themes) if (place + 1) % 5), themes[4::5]


def read_labels(path: Path) -> tuple[LabelledTheme, ...]:
    """Labelled themes of a file, held out, one JSON object a line; UserError where it is no text, and names the line
    that is none."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f"{path} cannot be read as text: {error}", at="labels") from error
    found = []
    for number, line in enumerate(lines, 1):
        if line.strip():
            try:
                found.append(LabelledTheme.model_validate({**json.loads(line), "split": "held_out"}, strict=False))
            except (ValueError, TypeError) as error:
                raise UserError(f"{path}: line {number} is no labelled theme: {error}", at="labels") from error
    return tuple(found)


def _lines(name: str) -> list[str]:
    folder = resources.files("planner_service").joinpath("data", "evaluation")
    return [line for line in folder.joinpath(name).read_text(encoding="utf-8").splitlines() if line]


def _same_piece(word: str, other: str) -> bool:
    if is_floor(word) or is_floor(other):
        return is_floor(word) and is_floor(other)
    return not categories_of(word).isdisjoint(categories_of(other))
