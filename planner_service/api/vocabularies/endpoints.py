"""The words of scripts: what a keyframe's fields may be, for whoever writes or changes one."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Query

from motion_backend.backends import about, offered_backends
from motion_backend.emotion_words import naming_words
from motion_backend.motion import Emotion, Skill
from planner_service.api.dependencies import PartsDep
from planner_service.api.errors import Unprocessable
from planner_service.api.vocabularies.schemas import (
    BackendList,
    BackendShown,
    CaptionExample,
    CaptionList,
    CaptionShown,
    EmotionList,
    EmotionShown,
    FurnitureList,
    FurnitureShown,
    SkillList,
    SkillShown,
)
from planner_service.composition.caption_meanings import find_captions
from planner_service.scripts.caption_fallbacks import usual
from planner_service.scripts.captions import captions
from planner_service.scripts.script import EMOTIONS, SkillWord
from planner_service.scripts.script_words import NEEDS
from scene_graphs.furniture import AFFORDANCES, affordances, catalogue, class_of, display_name, group_of

vocabularies_router = APIRouter(prefix="/v1", tags=["vocabularies"])
Skilled = Annotated[SkillWord | None, Query(description="Only those for this skill.")]
Words = Annotated[str, Query(max_length=200, description="Only those that have all these words, or mean them.")]
Affording = Annotated[Literal["sit", "lie", "touch"] | None, Query(description="Only what a body can do this with.")]


@vocabularies_router.get("/captions", response_model=CaptionList)
async def list_captions(skill: Skilled = None, q: Words = "") -> CaptionList:
    """How each skill can be done, in words that the body knows letter for letter."""
    return CaptionList(
        items=[
            CaptionShown(caption=one.caption, skill=one.skill, shows=list(one.shows), others=list(one.others))
            for one in find_captions(q, skill)
        ]
    )


@vocabularies_router.get("/captions/example", response_model=CaptionExample)
def show_caption(skill: SkillWord, caption: Annotated[str, Query(max_length=200)]) -> CaptionExample:
    """A caption to be seen: a room of the library that has what it needs, and the keyframes that lead up to it."""
    if caption not in captions()[skill]:
        raise Unprocessable("?caption", f"{caption!r} is no caption of {skill}; GET /v1/captions lists them")
    # Only who looks at one pays for the body's modules.
    from planner_service.evaluation.trials import keyframes_of
    from planner_service.output.caption_sheets import trial_of

    trial = trial_of(Skill(skill), caption, None, 0)
    return CaptionExample(layout_id=trial.room, keyframes=list(keyframes_of(trial)))


@vocabularies_router.get("/emotions", response_model=EmotionList)
async def list_emotions() -> EmotionList:
    """The nine emotions, and words that mean them."""
    named = {one: [word for word in naming_words().get(one, ()) if "*" not in word] for one in EMOTIONS}
    return EmotionList(items=[EmotionShown(emotion=one, words=words) for one, words in named.items()])


@vocabularies_router.get("/furniture", response_model=FurnitureList)
async def list_furniture(affords: Affording = None) -> FurnitureList:
    """Every piece of furniture there is a word for."""
    return FurnitureList(
        items=[
            FurnitureShown(
                word=display_name(name),
                category=name,
                of_class=class_of(name),
                group=group_of(name),
                affords=[one for one in AFFORDANCES if one in affordances(name)],
            )
            for name in sorted(catalogue().class_of)
            if affords is None or affords in affordances(name)
        ]
    )


@vocabularies_router.get("/skills", response_model=SkillList)
async def list_skills() -> SkillList:
    """What a body can do in one keyframe."""
    known = captions()
    return SkillList(
        items=[
            SkillShown(
                skill=one, needs=NEEDS.get(one), usual=usual(one, Emotion.NEUTRAL), captions=len(known[one.value])
            )
            for one in Skill
        ]
    )


@vocabularies_router.get("/backends", response_model=BackendList)
async def list_backends(parts: PartsDep) -> BackendList:
    """What can move a body here."""
    chosen = parts.settings.backend
    return BackendList(
        items=[BackendShown(backend=one, about=about(one), default=one == chosen) for one in offered_backends()]
    )
