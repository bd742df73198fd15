"""The labelled queries and themes of `data/evaluation`, as its README.md describes them."""

from __future__ import annotations

import re
from importlib import resources
from typing import Annotated, Final, Literal

from pydantic import BaseModel, ConfigDict, Field

from motion_backend.motion import Emotion
from planner_service.scripts.script import LongScript, ShortScript

Split = Literal["tune", "held_out"]
SPLITS: Final[tuple[Split, ...]] = ("tune", "held_out")
Kind = Literal["idiom", "synonym", "negation", "several", "furniture", "plain"]
_Id = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$")]
_Stem = Annotated[str, Field(min_length=1)]


class _Label(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Query(_Label):
    """What somebody might type, and the short scripts that play it."""

    id: _Id
    query: _Stem
    kind: Kind
    split: Split
    right: tuple[_Id, ...] = Field(min_length=1)
    """Ids of all that a fair person would accept, in no order."""


class LabelledEvent(_Label):
    """One event that must be found in a theme, felt and played."""

    words: tuple[_Stem, ...] = Field(min_length=1)
    """Each begins a word of the event's text."""
    emotions: tuple[Emotion, ...] = Field(min_length=1)
    """Any of these is right."""
    plays: tuple[_Stem, ...] = Field(min_length=1)
    """One of these begins a word of the summary or a caption of the script that plays it, or is its id."""

    def told_in(self, text: str) -> bool:
        """Whether an event of this text is this one."""
        return all(_begins(stem, text) for stem in self.words)

    def played_by(self, script: ShortScript) -> bool:
        """Whether the short script plays it."""
        texts = (script.summary, *(keyframe.caption for keyframe in script.keyframes))
        return script.id in self.plays or any(_begins(stem, text) for stem in self.plays for text in texts)

    def emotion_in(self, script: LongScript) -> str | None:
        """The emotion the long script gives it, None where it has no such event."""
        return next((beat.emotion for beat in script.beats if self.told_in(beat.text)), None)


class LabelledTheme(_Label):
    """A theme, and what happens in it in the order of time."""

    id: _Id
    text: _Stem
    split: Split
    events: tuple[LabelledEvent, ...] = Field(min_length=1, max_length=6)


def labelled_queries() -> tuple[Query, ...]:
    """The queries that are shipped."""
    return tuple(Query.model_validate_json(line) for line in _lines("retrieval.jsonl"))


def labelled_themes() -> tuple[LabelledTheme, ...]:
    """The themes that are shipped."""
    return tuple(LabelledTheme.model_validate_json(line) for line in _lines("themes.jsonl"))


def _lines(name: str) -> list[str]:
    folder = resources.files("planner_service").joinpath("data", "evaluation")
    return [line for line in folder.joinpath(name).read_text(encoding="utf-8").splitlines() if line]


def _begins(stem: str, text: str) -> bool:
    return re.search(rf"\b{re.escape(stem)}", text, re.IGNORECASE) is not None
