"""A form with files in it, read as it comes: files go to the disk piece by piece, everything is bounded."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import anyio
from python_multipart import MultipartParser
from python_multipart.exceptions import FormParserError
from python_multipart.multipart import parse_options_header
from starlette.concurrency import run_in_threadpool
from starlette.requests import ClientDisconnect, Request

from planner_service.api.errors import Fault, Malformed, Problem, TooLarge, TooSlow, Unprocessable
from planner_service.extraction.subtitles import MAX_SUBTITLE_BYTES
from planner_service.jobs.uploads import Coming, OverlongError, Receiving

if TYPE_CHECKING:
    from python_multipart.multipart import MultipartCallbacks

    from planner_service.settings import Settings

FORM: Final = "multipart/form-data"
MAX_FIELD_LENGTH: Final = 2000
"""Bytes of a part that is no file."""
HEAD: Final = 4096
"""Bytes of a file that tell what it is."""
SILENCE: Final = 20.0
"""Seconds without a byte after which a form is given up: what it holds is wanted by others."""
_HELD: Final = 1 << 20
"""Bytes that are held before they are written."""
_AS_IT_IS: Final = (b"", b"7bit", b"8bit", b"binary")


@dataclass(frozen=True)
class Sent:
    """A file of a form, whole and on the disk."""

    receiving: Receiving
    content: str
    """Its content id."""
    title: str
    """What the sender calls it, made harmless: for people, never a path; empty where they did not say."""


@dataclass(frozen=True)
class Form:
    """A form that was read to its end."""

    files: Mapping[str, Sent]
    fields: Mapping[str, str]


@dataclass
class _Part:
    """The part that is being read."""

    headers: dict[bytes, bytes] = field(default_factory=dict)
    key: bytes = b""
    name: str = ""
    title: str = ""
    named: bool = False
    """Whether it came with a file name, though an empty one."""
    text: bytearray = field(default_factory=bytearray)
    receiving: Receiving | None = None
    head: bytes = b""


@dataclass
class FormReader:
    """Takes a form apart: files and fields by their names, each at most once, of at most so many bytes."""

    coming: Coming
    files: Mapping[str, int]
    """Most bytes, by name."""
    fields: tuple[str, ...]
    look: Callable[[str, bytes], None] = lambda _name, _head: None
    """Shown the first bytes of every file, while the rest is still coming; raises a Problem for what is refused."""
    _part: _Part = field(default_factory=_Part)
    _sent: dict[str, Sent] = field(default_factory=dict)
    _texts: dict[str, str] = field(default_factory=dict)
    _seen: set[str] = field(default_factory=set)
    _held: list[tuple[_Part, bytes | None]] = field(default_factory=list)
    """What is to be written; None where a file is whole."""
    _size: int = 0
    _complete: bool = False

    async def read(self, request: Request) -> Form:
        """The form. Malformed if it is not whole, Unprocessable for parts that are not wanted, TooLarge, TooSlow."""
        options = parse_options_header(request.headers.get("content-type", ""))[1]
        boundary = options.get(b"boundary", b"")
        if not boundary:
            raise _malformed("the header names no boundary; let your HTTP library write it", "header:Content-Type")
        try:
            parser = MultipartParser(boundary, self._callbacks())
            async for chunk in _coming_in(request):
                parser.write(chunk)
                if self._size > _HELD:
                    await run_in_threadpool(self._write)
        except FormParserError as error:
            raise _malformed(f"not a form of type {FORM}: {str(error)[:200]}") from error
        except ClientDisconnect as error:
            raise _malformed("the form broke off before its end; send it again") from error
        if not self._complete:
            raise _malformed("the form has no end: its last boundary is missing; send it whole")
        await run_in_threadpool(self._write)
        return Form(self._sent, self._texts)

    def _callbacks(self) -> MultipartCallbacks:
        return {
            "on_part_begin": self._begin,
            "on_header_field": self._header_field,
            "on_header_value": self._header_value,
            "on_header_end": self._header_end,
            "on_headers_finished": self._headers_finished,
            "on_part_data": self._data,
            "on_part_end": self._end,
            "on_end": self._finish,
        }

    def _begin(self) -> None:
        self._part = _Part()

    def _header_field(self, data: bytes, start: int, end: int) -> None:
        self._part.key += data[start:end].lower()

    def _header_value(self, data: bytes, start: int, end: int) -> None:
        key = self._part.key
        self._part.headers[key] = self._part.headers.get(key, b"") + data[start:end]

    def _header_end(self) -> None:
        self._part.key = b""

    def _headers_finished(self) -> None:
        part = self._part
        options = parse_options_header(part.headers.get(b"content-disposition", b""))[1]
        part.name = options.get(b"name", b"").decode("utf-8", "replace")
        part.named = b"filename" in options
        part.title = title_of(options.get(b"filename", b"").decode("utf-8", "replace"))
        wanted = ", ".join((*self.files, *self.fields))
        if part.name not in self.files and part.name not in self.fields:
            raise Unprocessable(f"/{part.name}", f"there is no part of this name; send {wanted}")
        if part.name in self._seen:
            raise Unprocessable(f"/{part.name}", "it was sent twice; send one")
        self._seen.add(part.name)
        if part.headers.get(b"content-transfer-encoding", b"").strip().lower() not in _AS_IT_IS:
            raise Unprocessable(f"/{part.name}", "it is sent encoded; send its bytes as they are")
        if part.name in self.files:
            part.receiving = self.coming.receive(self.files[part.name])

    def _data(self, data: bytes, start: int, end: int) -> None:
        part, piece = self._part, data[start:end]
        if part.receiving is None:
            part.text += piece
            if len(part.text) > MAX_FIELD_LENGTH:
                raise _too_large(part.name, f"it has more than {MAX_FIELD_LENGTH} bytes; send fewer")
            return
        if len(part.head) < HEAD:
            part.head += piece
            if len(part.head) >= HEAD:
                self.look(part.name, part.head)
        self._held.append((part, piece))
        self._size += len(piece)

    def _end(self) -> None:
        part = self._part
        if part.receiving is None:
            self._texts[part.name] = part.text.decode("utf-8", "replace")
            return
        if len(part.head) < HEAD and (part.head or part.title or not part.named):
            self.look(part.name, part.head)
        self._held.append((part, None))
        self._size = _HELD + 1

    def _finish(self) -> None:
        self._complete = True

    def _write(self) -> None:
        held, self._held, self._size = self._held, [], 0
        for part, piece in held:
            assert part.receiving is not None
            if piece is None:
                # A browser's form in which no file was chosen has one without a name and bytes.
                if part.receiving.size or part.title or not part.named:
                    self._sent[part.name] = Sent(part.receiving, part.receiving.finish(), part.title)
                continue
            try:
                part.receiving.write(piece)
            except OverlongError as error:
                raise _too_large(part.name, f"{error}; send a smaller copy, or a part of it") from error


async def _coming_in(request: Request) -> AsyncIterator[bytes]:
    """The body as it comes. TooSlow where nothing comes for `SILENCE`; time that is spent on a piece does not count."""
    stream = request.stream()
    while True:
        try:
            with anyio.fail_after(SILENCE):
                chunk = await anext(stream, None)
        except TimeoutError as error:
            raise TooSlow(f"nothing was sent for {SILENCE:g} seconds; send the form again, without a pause") from error
        if chunk is None:
            return
        yield chunk


def title_of(name: str) -> str:
    """A title from the name of a file: its last part without its ending, one line of printable letters."""
    last = name.replace("\\", "/").rsplit("/", 1)[-1]
    stem = last.rsplit(".", 1)[0] if "." in last[1:] else last
    return " ".join("".join(letter if letter.isprintable() else " " for letter in stem).split())[:200]


def most_sent(settings: Settings) -> int:
    """Bytes of a form: a film, its subtitles, and what is around them."""
    return (settings.upload_mb << 20) + MAX_SUBTITLE_BYTES + (1 << 20)


def _malformed(detail: str, pointer: str = "") -> Problem:
    return Malformed(detail, (Fault(pointer=pointer, detail=detail),))


def _too_large(name: str, detail: str) -> Problem:
    return TooLarge(f"/{name}: {detail}", (Fault(pointer=f"/{name}", detail=detail),))
