"""Scenes of a text to short scripts by a language model: asked in bounded pieces, checked, mended, labelled.

Scenes that are too long for one question, cut into portions where sentences end.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Final

from pydantic import BaseModel, ValidationError

import prompts
from motion_backend.emotion_words import emotion_of
from motion_backend.motion import Skill
from planner_service.composition.llm_planner import DirectKeyframe
from planner_service.extraction.script_writer import Draft, Maker, Span
from planner_service.extraction.text_scenes import Line, TextScene
from planner_service.llm.protocol import LanguageModel
from planner_service.llm.structured_output import ask, problems_of
from planner_service.narration.narrative_voice import tells_of_one
from planner_service.scripts.captions import captions_offered, furniture_offered
from planner_service.scripts.script import EMOTIONS, MAX_PIECES
from planner_service.scripts.script_repair import check, read_keyframe
from scene_graphs.furniture import ROOM_TYPES, canonical_room

MAX_PIECE_LENGTH: Final = 6000
"""Letters of a text that one question shows."""
_MAX_PLACE_LENGTH: Final = 200
_ROUND_A_LINE: Final = 3
"""Quotation marks, and the blank before the next line."""
_SENTENCE_END: Final = re.compile(r"[.!?…]+[\"”’»)\]]*\s|[。！？]+[」』”]*")


def shown(scene: TextScene) -> str:
    """A scene as a model sees it: where, what is told, and what is said in quotation marks, in its order."""
    words = " ".join(f'"{line.text}"' if line.spoken else line.text for line in scene.lines)
    return f"{_where(scene)}{words}"


def portions_of(scenes: Sequence[TextScene]) -> tuple[tuple[TextScene, ...], tuple[str, ...]]:
    """The scenes, those that one question cannot hold as several, and a note for each of these; no word is lost."""
    cut: list[TextScene] = []
    notes: list[str] = []
    for scene in scenes:
        if len(shown(scene)) <= MAX_PIECE_LENGTH:
            cut.append(scene)
            continue
        first = len(cut) + 1
        cut += [replace(scene, lines=lines) for lines in _packed(scene)]
        notes.append(f"scenes {first} to {len(cut)}: are one of {len(shown(scene)):,} letters, cut where sentences end")
    return tuple(cut), tuple(notes)


def _where(scene: TextScene) -> str:
    return f"{scene.place[:_MAX_PLACE_LENGTH]}: " if scene.place else ""


def _packed(scene: TextScene) -> Iterator[tuple[Line, ...]]:
    """Its lines, as many together as one question holds."""
    most = MAX_PIECE_LENGTH - len(_where(scene))
    packed: list[Line] = []
    letters = 0
    for line in scene.lines:
        for text in fitting(line.text, most - _ROUND_A_LINE):
            size = len(text) + _ROUND_A_LINE
            if packed and letters + size > most:
                yield tuple(packed)
                packed, letters = [], 0
            packed.append(line._replace(text=text))
            letters += size
    if packed:
        yield tuple(packed)


def fitting(text: str, most: int) -> Iterator[str]:
    """The text in parts of at most so many letters: whole sentences, else whole words, else letters."""
    while len(text) > most:
        head = text[:most]
        end = max((match.end() for match in _SENTENCE_END.finditer(head)), default=0) or head.rfind(" ") + 1 or most
        yield text[:end].rstrip()
        text = text[end:].lstrip()
    yield text


_MAX_SCENES: Final = 8
"""Scenes of one question."""
_MAX_SCRIPTS: Final = 12
"""Short scripts of one answer."""
Numbered = Mapping[int, TextScene]


class FoundScript(BaseModel):
    """One short script as a model writes it."""

    scene: int
    summary: str
    emotion: str
    room: str
    keyframes: list[DirectKeyframe]


class FoundScripts(BaseModel):
    """The answer to `prompts/extract_scripts.md`."""

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
    elif "character" not in summary.lower() or not tells_of_one(summary):
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
