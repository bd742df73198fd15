"""A vision model watches a film and says what it saw; every scene can be watched by itself (SIMS 3.2).

A scene's outline to short scripts: a model writes them in known words, and they are checked and mended.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from pydantic import BaseModel, ConfigDict

import prompts
from motion_backend.motion import Skill
from planner_service.extraction.llm_text import FoundScript, draft_of, faults_of
from planner_service.extraction.scene_outline import LEEWAY, SceneAnswer, SceneOutline, inside, outline_of, problems_in
from planner_service.extraction.script_writer import Draft, Maker
from planner_service.extraction.shot_detection import Progress, Scene
from planner_service.extraction.subtitles import Cue
from planner_service.extraction.video import Film, frames_at
from planner_service.extraction.video_frames import Album
from planner_service.llm.client import for_story
from planner_service.llm.protocol import LanguageModel, ModelError
from planner_service.llm.structured_output import ask
from planner_service.scripts.captions import captions_offered, furniture_offered
from planner_service.scripts.script import EMOTIONS, MAX_PIECES
from scene_graphs.furniture import ROOM_TYPES

_MAX_SCRIPTS: Final = 4
"""Of one scene."""


class FilmedScript(FoundScript):
    """A short script as a model writes it, and the seconds of the film that it is taken from."""

    start: float
    end: float


class FilmedScripts(BaseModel):
    """The answer to `prompts/write_scripts.md`."""

    model_config = ConfigDict(extra="ignore")

    scripts: list[FilmedScript]


def scripts_of(model: LanguageModel, outline: SceneOutline, maker: Maker) -> tuple[Draft, ...]:
    """The short scripts that the model makes of a scene, mended so that a body can act them out. Raises ModelError.

    A scene in which nobody does anything is not asked about.
    """
    if not outline.moments and not outline.contacts:
        return ()
    prompt = prompts.render(
        "write_scripts",
        number=str(outline.number),
        most=str(_MAX_SCRIPTS),
        keyframes=str(MAX_PIECES // 2),
        skills=", ".join(Skill),
        emotions=", ".join(EMOTIONS),
        rooms=", ".join(ROOM_TYPES),
        furniture=furniture_offered(),
        captions=captions_offered(),
        outline=outline.model_dump_json(exclude={"notes", "number"}, indent=1),
    )
    answer = ask(model, prompt, FilmedScripts, lambda found: list(_problems(found, outline)))
    return tuple(
        draft_of(script, (inside(script.start, outline), inside(script.end, outline)), maker, model.name)
        for script in answer.scripts
    )


def _problems(answer: FilmedScripts, outline: SceneOutline) -> Iterator[str]:
    if len(answer.scripts) > _MAX_SCRIPTS:
        yield f"scripts: {len(answer.scripts)} of them, at most {_MAX_SCRIPTS}"
    for index, script in enumerate(answer.scripts[:_MAX_SCRIPTS]):
        for fault in faults_of(script, (outline.number,)):
            yield f"scripts.{index}.{fault}"
        if not outline.start - LEEWAY <= script.start < script.end <= outline.end + LEEWAY:
            span = f"{outline.start:g} to {outline.end:g} s"
            yield f"scripts.{index}: {script.start:g} to {script.end:g} is no span of the scene, {span}"


_MAX_SAID_LENGTH: Final = 4000
"""Letters of a scene's subtitles that a model reads."""
_MAX_FAILURES: Final = 3
"""Scenes in a row without an answer, after which a model is not asked again."""


@dataclass(frozen=True)
class Watched:
    """What came of one scene."""

    scene: Scene
    outline: SceneOutline | None
    """None where the model failed."""
    drafts: tuple[Draft, ...]
    notes: tuple[str, ...]
    failures: int = 0
    """Scenes in a row up to this one that the model did not answer."""


def watch(model: LanguageModel, film: Film, scene: Scene, album: Album | None = None) -> SceneOutline:
    """What the model sees in a scene, checked; the frames come from the album, or the film. ModelError, FilmError."""
    frames = tuple(frames_at(film, scene.times) if album is None else album.frames(film, scene.times))
    prompt = prompts.render(
        "watch_scene",
        number=str(scene.number),
        start=f"{scene.start:g}",
        end=f"{scene.end:g}",
        times=", ".join(f"{frame.time:g}" for frame in frames),
        emotions=", ".join(EMOTIONS),
        rooms=", ".join(ROOM_TYPES),
        furniture=furniture_offered(),
        film=film.name,
        subtitles=_said(scene.cues)[:_MAX_SAID_LENGTH] or "(nothing)",
    )
    images = [frame.jpeg for frame in frames]
    answer = ask(model, prompt, SceneAnswer, lambda seen: problems_in(seen, scene), images=images)
    return outline_of(answer, scene)


def watch_film(
    model: LanguageModel,
    film: Film,
    scenes: Sequence[Scene],
    maker: Maker,
    strict: bool = False,
    progress: Progress | None = None,
    album: Album | None = None,
    failures: int = 0,
) -> Iterator[Watched]:
    """Every scene in order, as it is done. A model of one's own has the budget of a story for each scene.

    A scene that the model does not answer gives a note and no script, and after some such scenes it is not asked again;
    with `strict` the ModelError is raised. `failures` is how many scenes before these it did not answer. FilmError.
    """
    wrong, failure = failures, "as it failed before"
    for done, scene in enumerate(scenes, 1):
        outline: SceneOutline | None = None
        drafts: tuple[Draft, ...] = ()
        notes: tuple[str, ...] = ()
        if wrong < _MAX_FAILURES:
            own = for_story(model, scene.number) or model
            try:
                outline = watch(own, film, scene, album)
                drafts = scripts_of(own, outline, maker)
                notes, wrong = (*outline.notes, *_unshown(scene)), 0
            except ModelError as error:
                if strict:
                    raise
                wrong, failure = wrong + 1, str(error)
        if wrong:
            again = "not asked any more: " if wrong >= _MAX_FAILURES and not notes else ""
            notes = (f"scene {scene.number}: the model gave no answer ({again}{failure})",)
        yield Watched(scene, outline, drafts, notes, wrong)
        if progress is not None:
            progress("watching", done / len(scenes))


def _unshown(scene: Scene) -> tuple[str, ...]:
    """A note where more is said in a scene than the model was shown."""
    letters = len(_said(scene.cues))
    if letters <= _MAX_SAID_LENGTH:
        return ()
    return (f"scene {scene.number}: only the first {_MAX_SAID_LENGTH} of {letters} letters of what is said were shown",)


def _said(cues: Sequence[Cue]) -> str:
    """What is said, a line a cue, with times and names."""
    lines = []
    for cue in cues:
        sounds = "".join(f" [{sound}]" for sound in cue.sounds)
        lines.append(f"{cue.start:.1f}–{cue.end:.1f} {cue.speaker + ': ' if cue.speaker else ''}{cue.text}{sounds}")
    return "\n".join(lines)
