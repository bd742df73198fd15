"""A vision model watches a film and says what it saw; every scene can be watched by itself (SIMS 3.2).

A scene's outline to short scripts: a model writes them in known words, and they are checked and mended.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Final

from pydantic import BaseModel

import prompts
from motion_backend.motion import Skill
from planner_service.extraction.llm_text import FoundScript, draft_of, faults_of
from planner_service.extraction.scene_outline import LEEWAY, SceneAnswer, SceneOutline, inside, outline_of, problems_in
from planner_service.extraction.script_writer import Draft, Maker
from planner_service.extraction.shot_detection import Progress, Scene
from planner_service.extraction.subtitles import Cue
from planner_service.extraction.video import Film, Frame, frames_at
from planner_service.extraction.video_container import FilmError
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

    scripts: list[FilmedScript]


def scripts_of(model: LanguageModel, outline: SceneOutline) -> tuple[FilmedScript, ...]:
    """The short scripts that the model makes of a scene, in its own words. Raises ModelError.

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
    return tuple(ask(model, prompt, FilmedScripts, lambda found: list(_problems(found, outline))).scripts)


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
AT_ONCE: Final = 4
"""Scenes that a model is asked about at the same time."""
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


def watch(model: LanguageModel, film: Film, scene: Scene, frames: Sequence[Frame]) -> SceneOutline:
    """What the model sees in a scene of which it is shown these frames, checked. ModelError."""
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


class Audience:
    """A model before a film: some scenes are asked about at once, and their answers fetched one after the other.

    Frames are read by whoever asks, since a film is read by one thread. A model of one's own has the budget of a story
    for each scene.
    """

    def __init__(self, model: LanguageModel, film: Film, scenes: Sequence[Scene], album: Album | None = None) -> None:
        self.model, self.film, self.scenes, self.album = model, film, scenes, album
        self._threads = ThreadPoolExecutor(AT_ONCE, thread_name_prefix="watching")
        self._asked: dict[int, Future[tuple[SceneOutline, tuple[FilmedScript, ...]]]] = {}

    def answer(self, index: int) -> tuple[SceneOutline, tuple[FilmedScript, ...]]:
        """What the model saw in a scene, and the scripts that it made of it; meanwhile the next are asked about.

        ModelError, FilmError.
        """
        for ahead in range(index, min(index + AT_ONCE, len(self.scenes))):
            if ahead not in self._asked:
                self._asked[ahead] = self._ask(self.scenes[ahead])
        return self._asked.pop(index).result()

    def close(self) -> None:
        """Nobody waits for what was not fetched."""
        self._threads.shutdown(wait=False, cancel_futures=True)

    def _ask(self, scene: Scene) -> Future[tuple[SceneOutline, tuple[FilmedScript, ...]]]:
        frames_of = self.album.frames if self.album is not None else frames_at
        try:
            frames = tuple(frames_of(self.film, scene.times))
        except FilmError as error:  # told when it is this scene's turn
            failed: Future[tuple[SceneOutline, tuple[FilmedScript, ...]]] = Future()
            failed.set_exception(error)
            return failed
        own = for_story(self.model, scene.number) or self.model

        def work() -> tuple[SceneOutline, tuple[FilmedScript, ...]]:
            outline = watch(own, self.film, scene, frames)
            return outline, scripts_of(own, outline)

        return self._threads.submit(work)


def watch_film(
    audience: Audience, maker: Maker, strict: bool = False, progress: Progress | None = None
) -> Iterator[Watched]:
    """Every scene in order, as it is done. FilmError; with `strict` ModelError."""
    failures = 0
    try:
        for index in range(len(audience.scenes)):
            watched = watch_next(audience, index, maker, strict, failures)
            failures = watched.failures
            yield watched
            if progress is not None:
                progress("watching", (index + 1) / len(audience.scenes))
    finally:
        audience.close()


def watch_next(audience: Audience, index: int, maker: Maker, strict: bool, failures: int) -> Watched:
    """One scene of a film, after so many in a row that the model did not answer.

    A scene that it does not answer gives a note and no script, and after some such scenes no answer counts any more.
    """
    scene = audience.scenes[index]
    failure = "not asked any more: as it failed before"
    if failures < _MAX_FAILURES:
        try:
            outline, scripts = audience.answer(index)
        except ModelError as error:
            if strict:
                raise
            failure = str(error)
        else:
            drafts = tuple(_draft(script, outline, maker, audience.model.name) for script in scripts)
            return Watched(scene, outline, drafts, (*outline.notes, *_unshown(scene)))
    notes = (f"scene {scene.number}: the model gave no answer ({failure})",)
    return Watched(scene, None, (), notes, failures + 1)


def _draft(script: FilmedScript, outline: SceneOutline, maker: Maker, model: str) -> Draft:
    return draft_of(script, (inside(script.start, outline), inside(script.end, outline)), maker, model)


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
