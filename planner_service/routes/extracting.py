"""Short scripts out of a film, subtitles or a text: what is quickly read is answered at once, the rest is queued."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from anyio import to_thread
from fastapi import APIRouter, Request, Response
from fastapi.exceptions import RequestValidationError
from pydantic import ValidationError
from starlette.concurrency import run_in_threadpool

from planner_service.accepting import accept_extraction, keep_extraction, repeated
from planner_service.errors import TooLarge, Unavailable, Unprocessable, WrongMedia
from planner_service.extraction.by_model import pieces_of
from planner_service.extraction.containers import FilmError, checked_container
from planner_service.extraction.extracting import Words, is_film, words_in
from planner_service.extraction.film import open_film
from planner_service.extraction.making import Maker
from planner_service.extraction.of_film import mute
from planner_service.extraction.of_text import scenes_read
from planner_service.extraction.plain import ExtractionError
from planner_service.extraction.results import Means, Source
from planner_service.extraction.subtitles import MAX_SUBTITLE_BYTES, SubtitleError, read_subtitles
from planner_service.limiting import MAX_BYTES
from planner_service.parts import Parts, PartsDep
from planner_service.reporting import extraction_shown
from planner_service.routes.bodies import parsed
from planner_service.routes.long_scripts import waiting_for_model
from planner_service.routes.multipart import FORM, SILENCE, Form, FormReader, Sent
from planner_service.routes.stories import Key
from planner_service.schemas.extractions import ExtractAsk, ExtractFields, ExtractionShown
from planner_service.schemas.stories import Json
from planner_service.shelves import RESERVED
from planner_service.store.extractions import ExtractionRequest
from planner_service.store.stories import Record
from planner_service.uploads import Coming

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
            raise ExtractionError("it begins as a film does; send a film as `video` of a form")
        words = words_in(source, means)
    if _is_long(words, by_rules=parts.model is None):
        return accept_extraction(parts, caller, wanted, coming, key)
    with waiting_for_model(parts):
        made = scenes_read(words.scenes, words.notes, _maker(words, source, means), means)
    return keep_extraction(parts, caller, wanted, made, key)


def _is_long(words: Words, *, by_rules: bool) -> bool:
    """Whether reading it would keep the caller waiting."""
    if sum(len(scene.told) + len(scene.spoken) for scene in words.scenes) > LETTERS_AT_ONCE:
        return True
    return len(list(pieces_of(words.scenes))) > (AT_ONCE if by_rules else ASKED_AT_ONCE)


def _maker(words: Words, source: Source, means: Means) -> Maker:
    return Maker(source.name, means.library, words.kind, source.licence)


@contextmanager
def _blaming(pointer: str) -> Iterator[None]:
    """Unprocessable there for a file or text that cannot be read."""
    try:
        yield
    except (FilmError, SubtitleError, ExtractionError) as error:
        detail = str(error)
        for named in ("film: ", "subtitles: "):
            detail = detail.removeprefix(named)
        raise Unprocessable(pointer, detail) from error
