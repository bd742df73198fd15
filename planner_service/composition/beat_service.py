"""Retrieve, edit, write (SIMS 3.2): every beat of a theme is served by a short script, a part of one, or keyframes
written for it.

A short script only enriches where it agrees in act, mood, room and furniture; so nothing is acted that nobody asked for.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from motion_backend.motion import Skill
from planner_service.composition.deed_lexicon import Deed
from planner_service.composition.keyframe_writer import KeyframeWriter, Part, beats_with_reasons
from planner_service.composition.request import RULES, Record, Request
from planner_service.llm.protocol import LanguageModel
from planner_service.scripts.script import LongScript, PlannedKeyframe, Retrieved
from planner_service.scripts.script_library import ScriptLibrary
from planner_service.scripts.script_repair import repair
from planner_service.themes.beats import LANGUAGE, ReadBeat, ThemeError, beats_of
from scene_graphs import furniture

_OFFERED: Final = 8
"""Short scripts that are looked at for a beat."""
_MIN_SCORE: Final = 0.4
"""How near a short script must be in meaning to be one about the beat."""


def serve_beats(
    theme: str, library: ScriptLibrary, request: Request, model: LanguageModel | None, record: Record
) -> LongScript:
    """The long script of a theme, beat by beat. ThemeError when nothing of it can be acted."""
    read = beats_of(theme)
    writer = KeyframeWriter(request.seed, request.furniture, PartFinder(library).find)
    writer.write(read)
    record.planners.append(RULES)
    if not writer.keyframes:
        told = "; ".join(f"“{one.text[:60]}”: {writer.why[index]}" for index, one in list(enumerate(read))[:4])
        raise ThemeError(f"nothing in it can be acted by a body at home. {told}. {LANGUAGE}")
    acted, repairs = repair(writer.keyframes)
    shown = {beat for keyframe in acted for beat in (keyframe.beat, *keyframe.also) if beat is not None}
    moods = {keyframe.mood for keyframe in acted}
    shown |= {
        i
        for i, one in enumerate(read)
        if one.beat.kind == "feeling" and one.beat.emotion in moods and i not in writer.why
    }
    return LongScript(
        theme=theme,
        beats=beats_with_reasons(read, writer.why, shown),
        short_scripts=tuple(Retrieved(script=part.script, beat=beat, score=part.score) for beat, part in writer.parts),
        keyframes=acted,
        repairs=(*record.notes, *repairs),
        method="auto",
        planner=record.planner,
        encoder=library.encoder.name,
        seed=request.seed,
    )


@dataclass
class PartFinder:
    """Finds the part of a short script that does a beat's deed as the beat says."""

    library: ScriptLibrary
    _used: set[str] = field(default_factory=set)

    def find(self, read: ReadBeat, deed: Deed) -> Part | None:
        """The nearest script's walk and deed, where deed, mood, room and furniture agree; None without one."""
        return None


def agrees(keyframe: PlannedKeyframe, deed: Deed) -> bool:
    """Whether a script's keyframe does a deed, where the deed may be done."""
    if keyframe.skill is not deed.skill or keyframe.skill is Skill.LOCO:
        return False
    shown = deed.row.captions if not deed.row.rests else (*deed.row.captions, *deed.row.lying)
    kinds = furniture.categories_of(keyframe.furniture)
    there = any(not kinds.isdisjoint(furniture.categories_of(piece)) for piece in deed.pieces)
    return (keyframe.caption in shown if shown else True) and (there or not deed.pieces)
