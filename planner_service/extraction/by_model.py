"""Scenes of a text to short scripts by a language model: asked in bounded pieces, checked, mended, labelled."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Final

from pydantic import BaseModel, ConfigDict, ValidationError

import prompts
from motion_backend.motion import Skill
from planner_service.extraction.making import Draft, Maker, Span
from planner_service.extraction.portions import MAX_PIECE_LENGTH, shown
from planner_service.extraction.text import TextScene
from planner_service.llm.answers import problems_of
from planner_service.llm.asking import ask
from planner_service.llm.protocol import LanguageModel
from planner_service.scripts.checking import check, read_keyframe
from planner_service.scripts.emotions import emotion_of
from planner_service.scripts.keyframe import EMOTIONS, MAX_PIECES
from planner_service.scripts.offering import captions_offered, furniture_offered
from planner_service.scripts.planning import DirectKeyframe
from planner_service.scripts.voice import Voice, retell
from scene_graphs.furniture import ROOM_TYPES, canonical_room

_MAX_SCENES: Final = 8
"""Scenes of one question."""
_MAX_SCRIPTS: Final = 12
"""Short scripts of one answer."""
Numbered = Mapping[int, TextScene]


class FoundScript(BaseModel):
    """One short script as a model writes it."""

    model_config = ConfigDict(extra="ignore")

    scene: int
    summary: str
    emotion: str
    room: str
    keyframes: list[DirectKeyframe]


class FoundScripts(BaseModel):
    """The answer to `prompts/extract_scripts.md`."""

    model_config = ConfigDict(extra="ignore")

    scripts: list[FoundScript]


def pieces_of(scenes: Sequence[TextScene]) -> Iterator[Numbered]:
    """Scenes by number, as many as one question holds. A longer scene is a piece of its own."""
    piece: dict[int, TextScene] = {}
    letters = 0
    for number, scene in enumerate(scenes, start=1):
        size = len(shown(scene))
        if piece and (letters + size > MAX_PIECE_LENGTH or len(piece) == _MAX_SCENES):
            yield piece
            piece, letters = {}, 0
        piece[number] = scene
        letters += size
    if piece:
        yield piece


def ask_for_scripts(model: LanguageModel, scenes: Numbered, maker: Maker) -> dict[int, tuple[Draft, ...]]:
    """What the model finds in each scene, mended so that a body can act it out. Raises ModelError."""
    prompt = prompts.render(
        "extract_scripts",
        name=maker.name,
        scenes="\n\n".join(f"[{number}] {shown(scene)[:MAX_PIECE_LENGTH]}" for number, scene in scenes.items()),
        skills=", ".join(Skill),
        emotions=", ".join(EMOTIONS),
        rooms=", ".join(ROOM_TYPES),
        furniture=furniture_offered(),
        captions=captions_offered(),
        most=str(_MAX_SCRIPTS),
        most_keyframes=str(MAX_PIECES // 2),
    )
    answer = ask(model, prompt, FoundScripts, lambda found: _problems(found, scenes))
    made: dict[int, list[Draft]] = {number: [] for number in scenes}
    for found in answer.scripts:
        scene = scenes[found.scene]
        made[found.scene].append(draft_of(found, (scene.start, scene.end), maker, model.name))
    return {number: tuple(drafts) for number, drafts in made.items()}


def draft_of(found: FoundScript, span: Span, maker: Maker, model: str) -> Draft:
    """A script in which `faults_of` finds nothing, mended so that a body can act it out."""
    return maker.make(
        " ".join(found.summary.split()),
        [read_keyframe(keyframe.model_dump()) for keyframe in found.keyframes],
        emotion_of(found.emotion) or "neutral",
        canonical_room(found.room),
        span,
        f"llm:{model}",
    )


def unread(scenes: Numbered) -> Iterator[str]:
    """What a question leaves out of scenes that nobody cut into portions."""
    for number, scene in scenes.items():
        if (letters := len(shown(scene))) > MAX_PIECE_LENGTH:
            yield f"scene {number}: only its first {MAX_PIECE_LENGTH} of {letters} letters were read"


def _problems(answer: FoundScripts, scenes: Numbered) -> list[str]:
    found = []
    if len(answer.scripts) > _MAX_SCRIPTS:
        found.append(f"scripts: {len(answer.scripts)} of them, at most {_MAX_SCRIPTS}")
    for index, script in enumerate(answer.scripts[:_MAX_SCRIPTS]):
        found += [f"scripts.{index}.{problem}" for problem in faults_of(script, scenes)]
    return found


def faults_of(script: FoundScript, scenes: Collection[int]) -> Iterator[str]:
    """What is wrong with a script that mending does not put right: skills that are missing in between it does."""
    summary = " ".join(script.summary.split())
    if script.scene not in scenes:
        yield f"scene: there is no scene {script.scene}; there are {', '.join(map(str, scenes))}"
    if not 1 <= len(summary) <= 400:
        yield f"summary: {len(summary)} letters, it must have 1 to 400"
    elif "character" not in summary.lower() or retell(summary, Voice("Sam", "they")) is None:
        yield 'summary: tell it in the present tense of "the character" alone, in English'
    if emotion_of(script.emotion) is None:
        yield f"emotion: {script.emotion!r:.60} is none of {', '.join(EMOTIONS)}"
    if canonical_room(script.room) not in ROOM_TYPES:
        yield f"room: {script.room!r:.60} is none of {', '.join(ROOM_TYPES)}"
    if not 1 <= len(script.keyframes) <= MAX_PIECES:
        yield f"keyframes: {len(script.keyframes)} of them, wanted 1 to {MAX_PIECES}"
        return
    try:
        keyframes = [read_keyframe(keyframe.model_dump()) for keyframe in script.keyframes]
    except ValidationError as error:
        yield f"keyframes: {problems_of(error)[0]}"
        return
    for problem in check(keyframes):
        if problem.field in ("furniture", "emotion"):
            yield f"keyframes.{problem.keyframe}.{problem.field}: {problem.fault}"
