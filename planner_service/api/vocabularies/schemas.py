"""The words of scripts over HTTP: captions, emotions, furniture, skills and backends, each with what it means."""

from __future__ import annotations

from pydantic import BaseModel, Field

from motion_backend.motion import Emotion, Skill
from planner_service.scripts.script import Keyframe


class CaptionShown(BaseModel):
    """How a skill can be done."""

    caption: str
    skill: Skill
    shows: list[str] = Field(description="Deeds of a theme that are seen in it: what it is a gesture of.")
    others: list[str] = Field(description="Other words for it, which are read as it.")


class CaptionList(BaseModel):
    """Captions that the body performs each in its own way."""

    items: list[CaptionShown]


class CaptionExample(BaseModel):
    """What acts one caption out, as it can be posted to /v1/motions; the caption is the last keyframe's."""

    layout_id: str
    keyframes: list[Keyframe]


class EmotionShown(BaseModel):
    """One of the nine."""

    emotion: Emotion
    words: list[str] = Field(description="Words that mean it, where a keyframe's emotion is written freely.")


class EmotionList(BaseModel):
    """All nine, neutral first."""

    items: list[EmotionShown]


class FurnitureShown(BaseModel):
    """A piece of furniture that a keyframe can name."""

    word: str = Field(description="As `furniture` of a keyframe.")
    category: str
    of_class: str = Field(description="Inside of which one stands in for another.")
    group: str
    affords: list[str] = Field(description="What a body can do with it: sit, lie, touch.")


class FurnitureList(BaseModel):
    """All furniture there is a word for."""

    items: list[FurnitureShown]


class SkillShown(BaseModel):
    """What a body can do in one keyframe (SIMS 3.4)."""

    skill: Skill
    needs: str | None = Field(description="What furniture must afford for it: sit, lie, touch; null: nothing.")
    usual: str = Field(description="The caption where nothing else is said.")
    captions: int = Field(description="How many there are for it.")


class SkillList(BaseModel):
    """All six."""

    items: list[SkillShown]


class BackendShown(BaseModel):
    """What moves bodies."""

    backend: str
    about: str = Field(description="What kind of motion it makes.")
    default: bool = Field(description="Whether it moves where nothing else is asked for.")


class BackendList(BaseModel):
    """Those that can be asked for here."""

    items: list[BackendShown]
