"""Short scripts out of a film, subtitles or a text: what is quickly read is answered at once, the rest is queued.

An extraction can be followed, what it gave fetched, and it can be stopped and forgotten.
"""

from __future__ import annotations

import hashlib
import io
from collections.abc import AsyncIterator, Iterator
from contextlib import contextmanager
from typing import Annotated, Final

from anyio import to_thread
from fastapi import APIRouter, Depends, Path, Query, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.sse import EventSourceResponse, ServerSentEvent
from pydantic import ValidationError
from starlette.concurrency import run_in_threadpool

from planner_service.api.dependencies import PartsDep, parsed
from planner_service.api.errors import Conflict, NotFound, TooLarge, Unavailable, Unprocessable, WrongMedia
from planner_service.api.extractions.schemas import ExtractAsk, ExtractFields, ExtractionPage, ExtractionShown
from planner_service.api.extractions.views import extraction_events, extraction_shown, extraction_summary, state_now
from planner_service.api.idempotent_submission import accept_extraction, keep_extraction, repeated
from planner_service.api.multipart import FORM, SILENCE, Form, FormReader, Sent
from planner_service.api.rate_limit import MAX_BYTES
from planner_service.api.scripts.endpoints import waiting_for_model
from planner_service.api.stories.endpoints import Key, StoriesDep, check_cursor
from planner_service.api.stories.event_stream import LastEvent, Watch, followed
from planner_service.components import Parts
from planner_service.extraction.extract import Words, is_film, words_in
from planner_service.extraction.extraction_result import Means, Source
from planner_service.extraction.from_film import mute
from planner_service.extraction.from_text import scenes_read
from planner_service.extraction.llm_text import pieces_of
from planner_service.extraction.script_writer import Maker
from planner_service.extraction.subtitles import MAX_SUBTITLE_BYTES, SubtitleError, read_subtitles
from planner_service.extraction.text_files import ExtractionError
from planner_service.extraction.video import open_film
from planner_service.extraction.video_container import FilmError, checked_container
from planner_service.jobs.uploads import Coming
from planner_service.library.library import RESERVED
from planner_service.store.extraction_store import ExtractionRequest
from planner_service.store.story_store import EXTRACTION, Record, StoryGone
from scene_graphs.json_fields import Json

extract_router = APIRouter(prefix="/v1/short-scripts", tags=["extractions"])
EXTRACT: Final = "/v1/short-scripts/extract"
AT_ONCE: Final = 24
"""Pieces of a text or of subtitles that the rules read while the caller waits: some seconds."""
LETTERS_AT_ONCE: Final = 20_000
"""Letters of them all, whoever reads: a paragraph is one piece however long it is, and a model may fail to read it."""
ASKED_AT_ONCE: Final = 4
"""The same for a language model: a question each."""
_YES_NO: Final = {"true": True, "false": False}
_FILES: Final = ("video", "subtitles")
_FIELDS: Final = ("name", "licence", "add")


@extract_router.post(
    "/extract",
    response_model=ExtractionShown,
    responses={
        202: {"model": ExtractionShown, "description": "It is queued; follow it at `links.events`."},
        408: {"description": f"A form of which nothing came for {SILENCE:g} seconds."},
    },
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {
                "application/json": {"schema": {"$ref": "#/components/schemas/ExtractAsk"}},
                FORM: {
                    "schema": {
                        "type": "object",
                        "properties": {
                            "video": {"type": "string", "format": "binary", "description": "A film."},
                            "subtitles": {"type": "string", "format": "binary", "description": "SRT, WebVTT or ASS."},
                            "name": {"type": "string", "maxLength": 200},
                            "licence": {"type": "string", "maxLength": 200},
                            "add": {"type": "string", "enum": list(_YES_NO)},
                        },
                    }
                },
            },
        }
    },
)
async def extract(request: Request, response: Response, parts: PartsDep, key: Key = None) -> Json:
    """Take short scripts out of a film, subtitles, both, or a text: by the language model if one is set, else by rules.

    A text that is quickly read is answered 200 with its scripts. A film and a long text are queued and answered 202.
    """
    media = request.headers.get("content-type", "").split(";")[0].strip().lower()
    if media == FORM:
        record = await _of_form(request, parts, key)
    elif media == "application/json" or media.endswith("+json"):
        body = await _bounded(request)
        record = await run_in_threadpool(_of_text, request, body, parts, key)
    else:
        told = f"Content-Type is {media or 'missing'!r:.80}"
        raise WrongMedia(f"{told}; send a text as application/json, a film or subtitles as {FORM}")
    response.status_code = 200 if record.status is None else 202
    response.headers["Location"] = f"/v1/extractions/{record.id}"
    return extraction_shown(record)


async def _bounded(request: Request) -> bytes:
    """The body of a text. TooLarge."""
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > MAX_BYTES:
            raise TooLarge(f"a body with a text has at most {MAX_BYTES} bytes; send a part of it")
    return bytes(body)


def _of_text(request: Request, body: bytes, parts: Parts, key: str | None) -> Record:
    ask = parsed(ExtractAsk, request, body)
    data = ask.text.encode("utf-8", "replace")
    name, content = ask.name or "text", hashlib.sha256(data).hexdigest()
    wanted = ExtractionRequest(name, ask.licence, ask.add, film=False, file=content)
    with parts.uploads.begin() as coming:
        receiving = coming.receive(MAX_BYTES)
        receiving.write(data)
        receiving.finish()
        source = Source(name, io.BytesIO(data), None, ask.licence)
        return _of_words(request, parts, key, wanted, source, coming, "/text")


async def _of_form(request: Request, parts: Parts, key: str | None) -> Record:
    if not parts.uploading.acquire(blocking=False):
        raise Unavailable("other films are coming in; send it again", retry_after=10)
    try:
        most = {"video": parts.settings.upload_mb << 20, "subtitles": MAX_SUBTITLE_BYTES}
        with await run_in_threadpool(_place, parts) as coming:
            form = await FormReader(coming, most, _FIELDS, _look).read(request)
            return await to_thread.run_sync(_of_files, request, parts, key, form, coming, limiter=parts.importing)
    finally:
        parts.uploading.release()


def _place(parts: Parts) -> Coming:
    """A place for what is coming in; what earlier ones left behind is thrown away."""
    parts.uploads.sweep({story_id for story_id, _, _ in parts.jobs.unfinished()})
    return parts.uploads.begin()


def _look(name: str, head: bytes) -> None:
    if name == "video":
        with _blaming("/video"):
            checked_container(head)


def _of_files(request: Request, parts: Parts, key: str | None, form: Form, coming: Coming) -> Record:
    fields = _fields_of(form)
    video, subtitles = (form.files.get(name) for name in _FILES)
    main = video or subtitles
    if main is None:
        raise Unprocessable("/video", "is missing: send a film as video, its subtitles, or both; a text goes as JSON")
    name = fields.name or main.title or ("film" if video else "subtitles")
    beside = subtitles.content if video and subtitles else None
    wanted = ExtractionRequest(name, fields.licence, fields.add, video is not None, main.content, beside)
    if video is None:
        source = Source(name, main.receiving.path, None, fields.licence)
        return _of_words(request, parts, key, wanted, source, coming, "/subtitles")
    _check_film(parts, video, subtitles, name)
    return accept_extraction(parts, request.state.caller, wanted, coming, key)


def _fields_of(form: Form) -> ExtractFields:
    row: Json = dict(form.fields)
    if "add" in row:
        row["add"] = _YES_NO.get(row["add"].strip().lower(), row["add"])
    try:
        return ExtractFields.model_validate(row)
    except ValidationError as error:
        faults = [{**fault, "loc": ("body", *fault["loc"])} for fault in error.errors(include_url=False)]
        raise RequestValidationError(faults, body=row) from error


def _check_film(parts: Parts, video: Sent, subtitles: Sent | None, name: str) -> None:
    """Unprocessable for a film that cannot be read, or that nobody could make anything of."""
    with _blaming("/video"):
        film = open_film(video.receiving.path, name)
    if subtitles is not None:
        with _blaming("/subtitles"):
            read_subtitles(subtitles.receiving.path.read_bytes())
    elif parts.model is None and not film.texts and not (parts.transcriber is not None and film.sound):
        with _blaming("/video"):
            raise mute(name)


def _of_words(
    request: Request,
    parts: Parts,
    key: str | None,
    wanted: ExtractionRequest,
    source: Source,
    coming: Coming,
    pointer: str,
) -> Record:
    """A text or subtitles: read at once, or queued where that takes long."""
    caller = request.state.caller
    known = repeated(parts, caller, "extraction", wanted.to_json(), key)
    if known is not None:
        return known
    strict = parts.settings.llm_on_failure == "error"
    means = Means(parts.shelves.scripts(), parts.model, parts.transcriber, strict, RESERVED)
    with _blaming(pointer):
        if is_film(source):
            raise ExtractionError("it begins as a film does", "send a film as `video` of a form")
        words = words_in(source, means)
    if _is_long(words, by_rules=parts.model is None):
        return accept_extraction(parts, caller, wanted, coming, key)
    with waiting_for_model(parts):
        maker = Maker(source.name, means.library, words.kind, source.licence)
        made = scenes_read(words.scenes, words.notes, maker, means)
    return keep_extraction(parts, caller, wanted, made, key)


def _is_long(words: Words, *, by_rules: bool) -> bool:
    """Whether reading it would keep the caller waiting."""
    if sum(len(scene.told) + len(scene.spoken) for scene in words.scenes) > LETTERS_AT_ONCE:
        return True
    return len(list(pieces_of(words.scenes))) > (AT_ONCE if by_rules else ASKED_AT_ONCE)


@contextmanager
def _blaming(pointer: str) -> Iterator[None]:
    """Unprocessable there for a file or text that cannot be read."""
    try:
        yield
    except (FilmError, SubtitleError, ExtractionError) as error:
        named = str(error.at) in ("film", "subtitles")  # the pointer says so
        raise Unprocessable(pointer, error.said if named else str(error)) from error


extractions_router = APIRouter(prefix="/v1/extractions", tags=["extractions"])
ExtractionId = Annotated[str, Path(max_length=64, description="The id of an extraction.")]


def record_of(extraction_id: ExtractionId, stories: StoriesDep) -> Record:
    """The extraction that a path names."""
    absent = "there is no such extraction; GET /v1/extractions lists them"
    try:
        record = stories.get(extraction_id)
    except StoryGone as error:
        raise NotFound(absent) from error
    if record.kind != EXTRACTION:
        raise NotFound(absent)
    return record


RecordDep = Annotated[Record, Depends(record_of)]


@extractions_router.get("", response_model=ExtractionPage)
def list_extractions(
    stories: StoriesDep,
    limit: Annotated[int, Query(ge=1, le=100)] = 20,
    cursor: Annotated[str | None, Query(max_length=64, description="`next` of the page before.")] = None,
) -> Json:
    """Extractions, newest first."""
    check_cursor(cursor)
    found = stories.page(limit + 1, cursor, (EXTRACTION,))
    shown = found[:limit]
    return {"items": list(map(extraction_summary, shown)), "next": shown[-1].id if len(found) > limit else None}


@extractions_router.get("/{extraction_id}", response_model=ExtractionShown)
def show(record: RecordDep) -> Json:
    """An extraction, as far as it is made."""
    return extraction_shown(record)


@extractions_router.post(
    "/{extraction_id}/cancel", status_code=202, response_model=ExtractionShown, responses={409: {}}
)
def cancel(record: RecordDep, parts: PartsDep, stories: StoriesDep) -> Json:
    """Stop an extraction: the scene that is being read is the last. Scripts that were made can still be fetched."""
    if state_now(record) in ("queued", "running"):
        parts.jobs.cancel(record.id)
        record = stories.get(record.id)
    if state_now(record) != "cancelled":
        raise Conflict(f"this extraction has {state_now(record)}; there is nothing to cancel")
    parts.uploads.forget(record.id)
    return extraction_shown(record)


@extractions_router.delete("/{extraction_id}", status_code=204)
def forget(record: RecordDep, parts: PartsDep, stories: StoriesDep) -> None:
    """Delete an extraction; scripts that it put into the library stay. One in the making is stopped."""
    running = state_now(record) in ("queued", "running")
    if running:
        parts.jobs.cancel(record.id)
    stories.delete(record.id)
    parts.uploads.forget(record.id)
    if not running and record.status is not None:
        parts.jobs.forget(record.id)


def watching(record: RecordDep, parts: PartsDep, last_event_id: LastEvent = None) -> Watch:
    """Who follows; one who has the last event of an extraction that ended gets 204."""
    return Watch(parts, record, last_event_id or 0, extraction_events, state_now).opened()


@extractions_router.get(
    "/{extraction_id}/events",
    response_class=EventSourceResponse,
    responses={204: {"description": "The extraction has ended, and Last-Event-ID is its last event."}},
)
async def events(watch: Annotated[Watch, Depends(watching)]) -> AsyncIterator[ServerSentEvent]:
    """`stage`, `progress` and `scenes` as they happen; at the end `done`, `failed` or `cancelled`, once."""
    async for event in followed(watch):
        yield event
