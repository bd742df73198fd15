"""Scenes of words to short scripts: each by the language model where there is one and it answers, else by rules."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from planner_service.extraction.by_model import ask_for_scripts, pieces_of
from planner_service.extraction.making import RULES, Draft, Maker
from planner_service.extraction.plain import ENGLISH, ExtractionError, language_of
from planner_service.extraction.reading import SceneRead, read_scene
from planner_service.extraction.results import Extraction, Means, SceneReport, readers, report_of
from planner_service.extraction.text import TextScene
from planner_service.llm.protocol import ModelError
from planner_service.llm.served import for_story

_MOST_FAILURES: Final = 3
"""Unanswered questions after which a model is not asked again."""


def scenes_read(scenes: Sequence[TextScene], notes: Sequence[str], maker: Maker, means: Means) -> Extraction:
    """Each scene by the model where there is one and it answers, else by rules."""
    maker.reserve(means.taken)
    reports: list[SceneReport] = []
    drafts: list[Draft] = []
    told = list(notes)
    for scene, (read, by) in zip(scenes, _read_scenes(scenes, maker, means, told), strict=True):
        drafts += read.drafts
        reports.append(report_of(len(reports) + 1, (scene.start, scene.end), read, by))
        if means.progress is not None:
            means.progress("reading", len(reports) / len(scenes))
    return Extraction(tuple(drafts), tuple(reports), tuple(told), readers(reports))


def _read_scenes(
    scenes: Sequence[TextScene], maker: Maker, means: Means, notes: list[str]
) -> Iterator[tuple[SceneRead, str]]:
    model, room, wrong = means.model, "", 0
    for piece in pieces_of(scenes):
        if model is not None:
            try:
                found = ask_for_scripts(for_story(model, min(piece)) or model, piece, maker)
            except ModelError as error:
                if means.strict:
                    raise
                wrong += 1
                notes.append(f"scenes {min(piece)} to {max(piece)}: read by rules, since the model failed: {error}")
                if wrong == _MOST_FAILURES:
                    model = None
                    notes.append("the model is not asked any more; the rest is read by rules")
            else:
                for number in piece:
                    reason = "" if found[number] else "the model found nothing in it that a body can act"
                    room = found[number][-1].script.room if found[number] else room
                    yield SceneRead(found[number], (), reason, room), f"llm:{model.name}"
                continue
        for scene in piece.values():
            read = read_by_rules(scene, maker, room)
            room = read.room
            yield read, RULES


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
            f"{name}: looks like {language}, and without a language model only English is read; "
            "give an English text, or set SIMS_LLM_MODEL"
        )
