"""Scenes of words to short scripts: each by the language model where there is one and it answers, else by rules."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from planner_service.extraction.extraction_result import (
    Before,
    Extraction,
    Means,
    PieceRead,
    SceneReport,
    joined,
    readers,
    report_of,
    told_once,
)
from planner_service.extraction.llm_text import Numbered, ask_for_scripts, pieces_of, unread
from planner_service.extraction.script_writer import RULES, Draft, Maker
from planner_service.extraction.text_files import ExtractionError
from planner_service.extraction.text_rules import SceneRead, read_scene
from planner_service.extraction.text_scenes import TextScene
from planner_service.llm.client import for_story
from planner_service.llm.protocol import ModelError
from planner_service.themes.language import ENGLISH, language_of

_MAX_FAILURES: Final = 3
"""Unanswered questions after which a model is not asked again."""


def scenes_read(scenes: Sequence[TextScene], notes: Sequence[str], maker: Maker, means: Means) -> Extraction:
    """Each scene by the model where there is one and it answers, else by rules."""
    maker.reserve(means.taken)
    read: list[PieceRead] = []
    for piece in pieces_of(scenes):
        read.append(read_piece(piece, maker, means, read[-1].after if read else Before()))
        if means.progress is not None:
            means.progress("reading", read[-1].after.scenes / len(scenes))
    whole = told_once(joined(read), maker.encoder).read
    return Extraction(whole.drafts, whole.scenes, (*notes, *whole.notes), readers(whole.scenes))


def read_piece(piece: Numbered, maker: Maker, means: Means, before: Before) -> PieceRead:
    """A few scenes by the model where there is one and it answers, else by rules; the last word of `before` counts.

    Raises ModelError where the model fails and the means are strict.
    """
    room, failures, notes = before.room, before.failures, list[str]()
    found: dict[int, tuple[Draft, ...]] | None = None
    if means.model is not None and failures < _MAX_FAILURES:
        try:
            found = ask_for_scripts(for_story(means.model, min(piece)) or means.model, piece, maker)
            notes += unread(piece)
        except ModelError as error:
            if means.strict:
                raise
            failures += 1
            notes.append(f"scenes {min(piece)} to {max(piece)}: read by rules, since the model failed: {error}")
            if failures == _MAX_FAILURES:
                notes.append("the model is not asked any more; the rest is read by rules")
    reports: list[SceneReport] = []
    drafts: list[Draft] = []
    for number, scene in piece.items():
        if found is None or means.model is None:
            read, by = read_by_rules(scene, maker, room), RULES
        else:
            reason = "" if found[number] else "the model found nothing in it that a body can act"
            told = found[number][-1].script.room if found[number] else room
            read, by = SceneRead(found[number], (), reason, told), f"llm:{means.model.name}"
        room = read.room
        drafts += read.drafts
        reports.append(report_of(number, (scene.start, scene.end), read, by))
    return PieceRead(tuple(drafts), tuple(reports), tuple(notes), Before(max(piece), room, failures))


def read_by_rules(scene: TextScene, maker: Maker, room: str) -> SceneRead:
    """What came of a scene; `room` is where the one before it played."""
    language = language_of(f"{scene.told} {scene.spoken}")
    if language != ENGLISH:
        return SceneRead((), (), f"it is in {language}, and rules read English", room)
    return read_scene(scene, maker, room)


def refuse_other_languages(text: str, name: str) -> None:
    """ExtractionError where the rules, which know English, would make nothing of it."""
    language = language_of(text)
    if language != ENGLISH:
        raise ExtractionError(
            f"{name}: looks like {language}, and without a language model only English is read",
            "give an English text, or set SIMS_LLM_MODEL",
        )
