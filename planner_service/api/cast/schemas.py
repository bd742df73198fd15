"""The cast over HTTP: who can play, and the words for how they look."""

from __future__ import annotations

from pydantic import BaseModel, Field


class MemberShown(BaseModel):
    """One of the cast."""

    name: str
    pronouns: str
    age: str
    build: str
    skin: str
    hair: str
    hair_color: str
    outfit: str = Field(description="Worn where nothing else asks for other clothes.")


class CastShown(BaseModel):
    """Who can play, and what each word of a character's look may be."""

    members: list[MemberShown]
    words: dict[str, list[str]] = Field(description="By field of `character`.")
