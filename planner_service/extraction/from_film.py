"""A film to short scripts: watched by a model, else its words read by rules."""

from __future__ import annotations

from planner_service.extraction.extraction_result import (
    Before,
    Extraction,
    Means,
    PieceRead,
    Source,
    joined,
    readers,
    report_of,
    told_once,
)
from planner_service.extraction.from_text import read_by_rules, refuse_other_languages, scenes_read
from planner_service.extraction.script_writer import RULES, Maker
from planner_service.extraction.shot_detection import scenes_of
from planner_service.extraction.speech_to_text import hear
from planner_service.extraction.subtitles import MAX_SUBTITLE_BYTES, Subtitles, embedded_cues, read_subtitles
from planner_service.extraction.text_files import ExtractionError, first_bytes
from planner_service.extraction.text_rules import SceneRead
from planner_service.extraction.text_scenes import scenes_of_cues
from planner_service.extraction.video import Film, open_film
from planner_service.extraction.video_frames import Album
from planner_service.extraction.vision_model import Audience, Watched, watch_film, watch_next


def extract_film(source: Source, means: Means) -> Extraction:
    """A film by a model that sees; without one its subtitles, or what is heard, by rules.

    ExtractionError where there is neither; FilmError, SubtitleError, SpeechError; ModelError where means are strict.
    """
    film = open_film(source.file, source.name)
    subtitles = words_of(film, source, means)
    cues = subtitles.cues if subtitles is not None else ()
    notes = notes_of(subtitles, source, means)
    maker = Maker(source.name, means.library, "video", source.licence)
    if means.model is None:
        return scenes_read(scenes_of_cues(cues), notes, maker, means)
    maker.reserve(means.taken)
    read: list[PieceRead] = []
    with Album() as album:
        scenes = scenes_of(film, cues, means.progress, album)
        audience = Audience(means.model, film, scenes, album)
        for watched in watch_film(audience, maker, means.strict, means.progress):
            read.append(_told(watched, maker, read[-1].after if read else Before(), f"llm:{means.model.name}"))
    whole = told_once(joined(read), maker.encoder).read
    return Extraction(whole.drafts, whole.scenes, (*notes, *whole.notes, *film.notes), readers(whole.scenes))


def words_of(film: Film, source: Source, means: Means) -> Subtitles | None:
    """What is said in a film: its subtitles beside it, else those in it, else what is heard; None where nothing is.

    ExtractionError where the film has no words and nobody could watch it, or where the rules cannot read them.
    FilmError, SubtitleError, SpeechError.
    """
    if source.subtitles is not None:
        subtitles: Subtitles | None = read_subtitles(first_bytes(source.subtitles, "subtitles", MAX_SUBTITLE_BYTES + 1))
    else:
        subtitles = embedded_cues(film)
    if subtitles is None and means.transcriber is not None and film.sound:
        subtitles = hear(means.transcriber, film, means.progress)
    if means.model is None:
        if subtitles is None or not subtitles.cues:
            raise mute(source.name)
        refuse_other_languages(" ".join(cue.text for cue in subtitles.cues[:2000]), source.name)
    return subtitles


def mute(name: str) -> ExtractionError:
    """What to say of a film that nobody can watch and in which nothing is said."""
    return ExtractionError(
        f"{name}: is a film without subtitles, and no language model is set that could watch it",
        "give its subtitles (SRT, WebVTT or ASS), or set SIMS_LLM_MODEL to a model that sees",
    )


def notes_of(subtitles: Subtitles | None, source: Source, means: Means) -> tuple[str, ...]:
    """What is to be known of the way its words were read."""
    notes = subtitles.notes if subtitles is not None else ()
    unseen = () if means.model is not None else ("only its words were read; nobody watched the pictures",)
    return tuple(f"{source.name}: {note}" for note in (*notes, *unseen))


def read_film_scene(audience: Audience, index: int, maker: Maker, means: Means, before: Before) -> PieceRead:
    """One scene of a film, as `extract_film` reads it among the others. FilmError, ModelError."""
    watched = watch_next(audience, index, maker, means.strict, before.failures)
    return _told(watched, maker, before, f"llm:{audience.model.name}")


def _told(watched: Watched, maker: Maker, before: Before, by: str) -> PieceRead:
    read, by = _seen(watched, maker, before.room, by)
    report = report_of(before.scenes + 1, (watched.scene.start, watched.scene.end), read, by)
    return PieceRead(read.drafts, (report,), watched.notes, Before(before.scenes + 1, report.room, watched.failures))


def _seen(watched: Watched, maker: Maker, room: str, by: str) -> tuple[SceneRead, str]:
    """What came of a scene of a film, and who read it: where the model failed, the rules read what is said in it."""
    if watched.outline is not None:
        reason = "" if watched.drafts else "the model saw nothing in it that a body can act"
        return SceneRead(watched.drafts, (), reason, watched.outline.room or room), by
    read = [read_by_rules(scene, maker, room) for scene in scenes_of_cues(watched.scene.cues)]
    drafts = tuple(draft for one in read for draft in one.drafts)
    unused = tuple(clause for one in read for clause in one.unused)
    reason = "" if drafts else "the model failed, and its subtitles tell of nothing that a body can act"
    return SceneRead(drafts, unused, reason, read[-1].room if read else room), RULES
