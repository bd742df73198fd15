"""A film to short scripts: watched by a model, else its words read by rules."""

from __future__ import annotations

from planner_service.extraction.album import Album
from planner_service.extraction.embedded import embedded_cues
from planner_service.extraction.film import open_film
from planner_service.extraction.grouping import scenes_of
from planner_service.extraction.making import RULES, Draft, Maker
from planner_service.extraction.of_text import read_by_rules, refuse_other_languages, scenes_read
from planner_service.extraction.plain import ExtractionError, first_bytes
from planner_service.extraction.reading import SceneRead
from planner_service.extraction.results import Extraction, Means, SceneReport, Source, readers, report_of
from planner_service.extraction.speech import hear
from planner_service.extraction.subtitles import LARGEST, Subtitles, read_subtitles
from planner_service.extraction.text import scenes_of_cues
from planner_service.extraction.watching import Watched, watch_film


def extract_film(source: Source, means: Means) -> Extraction:
    """A film by a model that sees; without one its subtitles, or what is heard, by rules.

    ExtractionError where there is neither; FilmError, SubtitleError, SpeechError; ModelError where means are strict.
    """
    film = open_film(source.file, source.name)
    if source.subtitles is not None:
        subtitles: Subtitles | None = read_subtitles(first_bytes(source.subtitles, "subtitles", LARGEST + 1))
    else:
        subtitles = embedded_cues(film)
    if subtitles is None and means.transcriber is not None and film.sound:
        subtitles = hear(means.transcriber, film, means.progress)
    cues = subtitles.cues if subtitles is not None else ()
    notes = [f"{source.name}: {note}" for note in (subtitles.notes if subtitles is not None else ())]
    maker = Maker(source.name, means.library, "video", source.licence)
    if means.model is None:
        if not cues:
            raise ExtractionError(
                f"{source.name}: is a film without subtitles, and no language model is set that could watch it; "
                "give its subtitles (SRT, WebVTT or ASS), or set SIMS_LLM_MODEL to a model that sees"
            )
        refuse_other_languages(" ".join(cue.text for cue in cues[:2000]), source.name)
        notes.append(f"{source.name}: only its words were read; nobody watched the pictures")
        return scenes_read(scenes_of_cues(cues), notes, maker, means)
    maker.reserve(means.taken)
    reports: list[SceneReport] = []
    drafts: list[Draft] = []
    with Album() as album:
        scenes = scenes_of(film, cues, means.progress, album)
        for watched in watch_film(means.model, film, scenes, maker, means.strict, means.progress, album):
            read, by = _seen(watched, maker, reports[-1].room if reports else "", f"llm:{means.model.name}")
            notes += watched.notes
            drafts += read.drafts
            reports.append(report_of(len(reports) + 1, (watched.scene.start, watched.scene.end), read, by))
    return Extraction(tuple(drafts), tuple(reports), (*notes, *film.notes), readers(reports))


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
