"""A film, subtitles or a text to short scripts, told apart by what the file holds (SIMS 3.2)."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final

from planner_service.extraction.by_model import ask_for_scripts, pieces_of
from planner_service.extraction.containers import checked_container, container_of
from planner_service.extraction.making import Draft, Maker, Span
from planner_service.extraction.plain import ENGLISH, MOST_BYTES, ExtractionError, language_of, read_text
from planner_service.extraction.reading import SceneRead, read_scene
from planner_service.extraction.subtitles import LARGEST, Subtitles, form_of, read_subtitles
from planner_service.extraction.text import TextScene, scenes_of_cues, scenes_of_text
from planner_service.llm.protocol import LanguageModel, ModelError
from planner_service.llm.served import for_story
from planner_service.scripts.library import ScriptLibrary
from planner_service.scripts.picking import UNKNOWN

if TYPE_CHECKING:
    from planner_service.extraction.watching import Watched

RULES: Final = "rules"
_HEAD: Final = 4096
_MOST_FAILURES: Final = 3
"""Unanswered questions after which a model is not asked again."""
_NAMING_OTHERS: Final = (
    b"#extm3u",
    b"ffconcat",
    b"[playlist]",
    b"[reference]",
    b"<?xml",
    b"<svg",
    b"<mpd",
    b"<asx",
    b"v=0\n",
    b"v=0\r",
)
"""How files begin that are letters and stand for films elsewhere."""
Progress = Callable[[str, float], None]
"""Told the stage and the share of it that is done, 0 to 1."""


@dataclass(frozen=True)
class Source:
    """What is extracted from."""

    name: str
    """Its title, for people: never a path."""
    file: Path | BinaryIO
    subtitles: Path | BinaryIO | None = None
    """Of a film, beside it."""
    licence: str = UNKNOWN


@dataclass(frozen=True)
class SceneReport:
    """What came of one scene."""

    number: int
    start: float | None
    """Seconds, of a film or subtitles."""
    end: float | None
    room: str
    scripts: tuple[str, ...]
    """Ids."""
    unused: tuple[str, ...]
    """What was told and is not shown, each with the reason."""
    reason: str
    """Why there is no script; empty where there is one."""
    by: str


@dataclass(frozen=True)
class Extraction:
    """What came of a source; none of it is kept yet."""

    scripts: tuple[Draft, ...]
    scenes: tuple[SceneReport, ...]
    notes: tuple[str, ...]
    by: str
    """"rules", "llm:<model>", or both."""


@dataclass(frozen=True)
class Means:
    """With what is extracted."""

    library: ScriptLibrary
    model: LanguageModel | None = None
    strict: bool = False
    """Whether an unusable model is an error; otherwise the rules do it."""
    taken: Collection[str] = ()
    """Ids that may not be used, besides the library's."""
    progress: Progress | None = None


def extract(source: Source, means: Means) -> Extraction:
    """The short scripts in a source. ExtractionError, SubtitleError or FilmError says why it cannot be read.

    Raises ModelError where the model fails and the means are strict.
    """
    head = _read(source.file, source.name, _HEAD)
    if container_of(head) is not None:
        return _of_film(source, means)
    if head.lstrip(b"\xef\xbb\xbf \t\r\n").lower().startswith(_NAMING_OTHERS):
        checked_container(head)
    data = _read(source.file, source.name, LARGEST + 1)
    if form_of(head.decode("utf-8", "ignore").replace("\0", "")) is not None:
        return _of_subtitles(source, data, means)
    text, notes = read_text(data[: MOST_BYTES + 1], source.name)
    if form_of(text) is not None:
        return _of_subtitles(source, data, means)
    if means.model is None:
        _only_english(text, source.name)
    return _of_scenes(scenes_of_text(text), notes, Maker(source.name, means.library, "text", source.licence), means)


def _of_subtitles(source: Source, data: bytes, means: Means) -> Extraction:
    read = read_subtitles(data)
    scenes = scenes_of_cues(read.cues)
    if means.model is None:
        _only_english(" ".join(cue.text for cue in read.cues[:2000]), source.name)
    maker = Maker(source.name, means.library, "video", source.licence)
    return _of_scenes(scenes, tuple(f"{source.name}: {note}" for note in read.notes), maker, means)


def _of_film(source: Source, means: Means) -> Extraction:
    """A film by a model that sees; without one its subtitles by rules."""
    from planner_service.extraction.embedded import embedded_cues
    from planner_service.extraction.film import open_film
    from planner_service.extraction.grouping import scenes_of
    from planner_service.extraction.watching import watch_film

    film = open_film(source.file, source.name)
    if source.subtitles is not None:
        subtitles: Subtitles | None = read_subtitles(_read(source.subtitles, "subtitles", LARGEST + 1))
    else:
        subtitles = embedded_cues(film)
    cues = subtitles.cues if subtitles is not None else ()
    notes = [f"{source.name}: {note}" for note in (subtitles.notes if subtitles is not None else ())]
    maker = Maker(source.name, means.library, "video", source.licence)
    if means.model is None:
        if not cues:
            raise ExtractionError(
                f"{source.name}: is a film without subtitles, and no language model is set that could watch it; "
                "give its subtitles (SRT, WebVTT or ASS), or set SIMS_LLM_MODEL to one that sees"
            )
        _only_english(" ".join(cue.text for cue in cues[:2000]), source.name)
        notes.append(f"{source.name}: only the subtitles were read; nobody watched the pictures")
        return _of_scenes(scenes_of_cues(cues), notes, maker, means)
    maker.reserve(means.taken)
    scenes = scenes_of(film, cues, means.progress)
    reports: list[SceneReport] = []
    drafts: list[Draft] = []
    for watched in watch_film(means.model, film, scenes, maker, means.strict, means.progress):
        read, by = _seen(watched, maker, reports[-1].room if reports else "", f"llm:{means.model.name}")
        notes += watched.notes
        drafts += read.drafts
        reports.append(_report(len(reports) + 1, (watched.scene.start, watched.scene.end), read, by))
    return Extraction(tuple(drafts), tuple(reports), (*notes, *film.notes), _by(reports))


def _seen(watched: Watched, maker: Maker, room: str, by: str) -> tuple[SceneRead, str]:
    """What came of a scene of a film, and who read it: where the model failed, the rules read what is said in it."""
    if watched.outline is not None:
        reason = "" if watched.drafts else "the model saw nothing in it that a body can act"
        return SceneRead(watched.drafts, (), reason, watched.outline.room or room), by
    read = [_by_rules(scene, maker, room) for scene in scenes_of_cues(watched.scene.cues)]
    drafts = tuple(draft for one in read for draft in one.drafts)
    unused = tuple(clause for one in read for clause in one.unused)
    reason = "" if drafts else "the model failed, and its subtitles tell of nothing that a body can act"
    return SceneRead(drafts, unused, reason, read[-1].room if read else room), RULES


def _of_scenes(scenes: Sequence[TextScene], notes: Sequence[str], maker: Maker, means: Means) -> Extraction:
    """Each scene by the model where there is one and it answers, else by rules."""
    maker.reserve(means.taken)
    reports: list[SceneReport] = []
    drafts: list[Draft] = []
    told = list(notes)
    for scene, (read, by) in zip(scenes, _read_scenes(scenes, maker, means, told), strict=True):
        drafts += read.drafts
        reports.append(_report(len(reports) + 1, (scene.start, scene.end), read, by))
        if means.progress is not None:
            means.progress("reading", len(reports) / len(scenes))
    return Extraction(tuple(drafts), tuple(reports), tuple(told), _by(reports))


def _report(number: int, span: Span, read: SceneRead, by: str) -> SceneReport:
    ids = tuple(draft.script.id for draft in read.drafts)
    return SceneReport(number, *span, read.room, ids, read.unused, read.reason, by)


def _by(reports: Sequence[SceneReport]) -> str:
    """Everybody who read a scene, in order."""
    return ", ".join(dict.fromkeys(report.by for report in reports)) or RULES


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
            read = _by_rules(scene, maker, room)
            room = read.room
            yield read, RULES


def _by_rules(scene: TextScene, maker: Maker, room: str) -> SceneRead:
    language = language_of(f"{scene.told} {scene.spoken}")
    if language != ENGLISH:
        return SceneRead((), (), f"it is in {language}, and rules read English", room)
    return read_scene(scene, maker, room)


def _only_english(text: str, name: str) -> None:
    language = language_of(text)
    if language != ENGLISH:
        raise ExtractionError(
            f"{name}: looks like {language}, and without a language model only English is read; "
            "give an English text, or set SIMS_LLM_MODEL"
        )


def _read(file: Path | BinaryIO, name: str, most: int) -> bytes:
    """The first bytes of a file. ExtractionError for what cannot be read."""
    if not isinstance(file, Path):
        file.seek(0)
        return file.read(most)
    if file.is_dir():
        raise ExtractionError(f"{name}: is a folder; give a text, subtitles or a film")
    try:
        with file.open("rb") as stream:
            return stream.read(most)
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or error
        raise ExtractionError(f"{name}: cannot be read: {why}; give a text, subtitles or a film") from error
