"""The cast: who can play in stories, to be asked for as `character.member`, and the other words for a look."""

from __future__ import annotations

from fastapi import APIRouter

from motion_backend.body.cast import GIVEN, cast
from planner_service.api.cast.schemas import CastShown, MemberShown

cast_router = APIRouter(prefix="/v1/cast", tags=["cast"])


@cast_router.get("", response_model=CastShown)
async def show_cast() -> CastShown:
    """Who can play, and what each word of a character's look may be."""
    known = cast()
    members = [MemberShown(**{name: getattr(one, name) for name in MemberShown.model_fields}) for one in known.member]
    return CastShown(members=members, words={name: list(known.known(name)) for name in GIVEN})
