"""Where a scene is read from: a file, a folder of files that belong together, or bytes that somebody sent; bounded.

What the reader of a scene file cannot see in it, and how much it may read.
"""

from __future__ import annotations

import gzip
import io
import json
import struct
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, Final

from scene_graphs.errors import FieldPath
from scene_graphs.json_fields import LayoutError

MAX_BYTES: Final = 256 << 20
"""Bytes of one file, unpacked. A 3D-FRONT house has some megabytes, a ScanNet mesh some tens."""
MAX_TEXT_BYTES: Final = 96 << 20
"""Bytes of a text, or of a line of many: as letters it may take four times the memory."""
MAX_STREAM_BYTES: Final = 4 << 30
"""Bytes of a file on disk that is read line by line."""
MAX_VALUES: Final = 4_000_000
"""Of one JSON text: each takes up to some hundred bytes of memory."""
MAX_ROWS: Final = 200_000
_GZIP, _ZIP, _ZIPPED_FILE = b"\x1f\x8b", b"PK\x03\x04", b"PK\x01\x02"
_MAX_ZIPPED: Final = 10_000
_DAMAGED: Final = (
    OSError,
    EOFError,
    ValueError,
    IndexError,
    RuntimeError,
    zlib.error,
    struct.error,
    zipfile.BadZipFile,
)
"""What unpacking raises for files that are damaged, or made to do damage."""


@dataclass(frozen=True)
class Source:
    """One scene file (or folder), not read yet. Nothing is ever read but it and, by fixed names, what lies beside."""

    name: str
    """For errors: the file's own name, never a path."""
    path: Path | None = None
    data: bytes | None = None
    most_bytes: int = MAX_BYTES

    @classmethod
    def of_path(cls, path: str | Path, most_bytes: int = MAX_BYTES) -> Source:
        """A file or folder on disk. LayoutError if there is none, or a pipe or device, which may never end."""
        place = Path(path)
        name = place.name or place.resolve().name
        try:
            if place.is_file() or place.is_dir():
                return cls(name, place, None, most_bytes)
            reason = "it is a pipe or a device" if place.exists() else "there is no such file or folder"
        except OSError as error:
            reason = error.strerror or "it cannot be opened"
        raise LayoutError(f"{name:.100} cannot be read: {reason}", "give a scene file, or a folder of files")

    @classmethod
    def of_bytes(cls, name: str, data: bytes, most_bytes: int = MAX_BYTES) -> Source:
        """What somebody sent. There is nothing beside it."""
        return cls(name, None, data, most_bytes)

    @property
    def is_folder(self) -> bool:
        """Whether it is a folder, whose files are found by `find`."""
        return self.path is not None and self.path.is_dir()

    def find(self, pattern: str) -> Source | None:
        """The first file of that name pattern (no folders in it) in the folder or beside the file; None if none is."""
        if self.path is None:
            return None
        folder = self.path if self.is_folder else self.path.parent
        found = sorted(place for place in folder.glob(pattern) if _is_file(place))
        return Source(found[0].name, found[0], None, self.most_bytes) if found else None

    def beside(self, *names: str) -> Source | None:
        """The first of these files that lies in the folder or beside the file; None if none does, or for bytes.

        A name may hold folders ("3D-FUTURE-model/<jid>/raw_model.obj") but nothing that leads out of the folder.
        """
        if self.path is None:
            return None
        folder = self.path if self.is_folder else self.path.parent
        for name in names:
            parts = Path(name).parts
            if Path(name).is_absolute() or ".." in parts or "\0" in name or len(name) > 400:
                continue
            place = folder.joinpath(*parts)
            if _is_file(place):
                return Source(place.name, place, None, self.most_bytes)
        return None

    @property
    def at(self) -> FieldPath:
        """The whole of it, as the place of what is wrong."""
        return FieldPath((self.name,))

    def read(self) -> bytes:
        """The bytes, unpacked if they are gzip or a zip of one file.

        LayoutError if they cannot be read, are cut off, or are more than `most_bytes` when unpacked.
        """
        return self._read(self.most_bytes)

    def text(self) -> str:
        """The bytes as UTF-8. LayoutError if they are not, or are more than `MAX_TEXT_BYTES`."""
        return _decoded(self._read(min(self.most_bytes, MAX_TEXT_BYTES)), self.at)

    def json(self) -> Any:
        """The one JSON value in it. LayoutError as `parse_json` has it."""
        return parse_json(self.text(), self.at)

    def rows(self) -> Iterator[tuple[FieldPath, Any]]:
        """JSON values with the place of each: those of a list, of lines (JSONL), or the one there is.

        Lines are read one by one, so that a file of many may be longer than what is held in memory. LayoutError for the
        first that is no JSON, and where there are more than `MAX_ROWS`.
        """
        rows = self._line_rows() if self._is_lines() else self._value_rows()
        for number, row in enumerate(rows):
            if number >= MAX_ROWS:
                raise LayoutError(f"{self.name} has more than {MAX_ROWS} rows", "split it")
            yield row

    def _line_rows(self) -> Iterator[tuple[FieldPath, Any]]:
        for number, line in enumerate(self._lines(), start=1):
            if line.strip():
                where = FieldPath((f"{self.name} line {number}",))
                yield where, parse_json(_decoded(line, where), where)

    def _value_rows(self) -> Iterator[tuple[FieldPath, Any]]:
        value = self.json()
        if isinstance(value, list):
            yield from ((FieldPath((f"{self.name} [{index}]",)), row) for index, row in enumerate(value))
        else:
            yield self.at, value

    def _is_lines(self) -> bool:
        """Whether every line is a JSON object of its own: the first one is, and there is a second."""
        lines = (line for line in self._lines() if line.strip())
        first = next(lines, b"")
        if not first.lstrip(b"\xef\xbb\xbf \t").startswith(b"{"):
            return False
        try:
            parse_json(_decoded(first, self.at), self.at)
        except LayoutError:
            return False
        return next(lines, None) is not None

    def _lines(self) -> Iterator[bytes]:
        most = self.most_bytes if self.path is None else MAX_STREAM_BYTES
        read = 0
        with self._opened() as stream:
            while line := stream.readline(MAX_TEXT_BYTES + 1):
                read += len(line)
                if read > most:
                    raise LayoutError(self._too_large(most))
                if len(line) > MAX_TEXT_BYTES:
                    raise LayoutError(self._too_large(MAX_TEXT_BYTES))
                yield line

    def _read(self, most: int) -> bytes:
        with self._opened() as stream:
            data = stream.read(most + 1)
        if len(data) > most:
            raise LayoutError(self._too_large(most))
        if data.startswith((_GZIP, _ZIP)):
            raise LayoutError(f"{self.name} is packed twice", "unpack it once")
        return data

    @contextmanager
    def _opened(self) -> Iterator[IO[bytes]]:
        """The unpacked bytes as they come; whatever is wrong with the file is a LayoutError."""
        if self.is_folder:
            raise LayoutError(f"{self.name} is a folder", "name the file in it")
        try:
            with self._raw() as packed:
                start = packed.read(4)
                packed.seek(0)
                if start.startswith(_GZIP):
                    with gzip.GzipFile(fileobj=packed) as stream:
                        yield stream  # type: ignore[misc]
                elif start == _ZIP:
                    with self._only_file(packed) as stream:
                        yield stream
                else:
                    yield packed
        except LayoutError:
            raise
        except _DAMAGED as error:
            reason = getattr(error, "strerror", None) or error
            raise LayoutError(f"{self.name} cannot be read, it is missing, cut off or damaged: {reason}") from error

    def _raw(self) -> IO[bytes]:
        return io.BytesIO(self.data or b"") if self.path is None else self.path.open("rb")

    @contextmanager
    def _only_file(self, packed: IO[bytes]) -> Iterator[IO[bytes]]:
        """The one file of a zip. What a zip says about itself is counted before it is believed."""
        data = packed.read(self.most_bytes + 1)
        if len(data) > self.most_bytes:
            raise LayoutError(self._too_large(self.most_bytes))
        if data.count(_ZIPPED_FILE) > _MAX_ZIPPED:
            raise LayoutError(f"{self.name} is a zip of many files", "send one scene file")
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            files = [info for info in archive.infolist() if not info.is_dir()]
            if len(files) != 1:
                raise LayoutError(f"{self.name} is a zip of {len(files)} files", "send one scene file")
            if files[0].compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                raise LayoutError(f"{self.name} is a zip of an unusual kind", "pack it plainly, or as gzip")
            with archive.open(files[0]) as stream:
                yield stream

    def _too_large(self, most: int) -> str:
        return f"{self.name} is larger than {most >> 20} MiB; split it, or leave out its textures"


def parse_json(text: str, where: FieldPath) -> Any:
    """The value of a JSON text. LayoutError if it is none, is nested too deeply or holds more than `MAX_VALUES`."""
    if sum(text.count(sign) for sign in ",[{") > MAX_VALUES:
        raise LayoutError(f"holds more than {MAX_VALUES} values", "split it", at=where)
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise LayoutError(f"is not JSON: {error}", at=where) from error


def _decoded(data: bytes, where: FieldPath) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise LayoutError(f"is not UTF-8 text ({error.reason} at byte {error.start})", at=where) from error


def _is_file(place: Path) -> bool:
    try:
        return place.is_file()
    except OSError:  # a name longer than any, or a folder that nobody may look into
        return False


MAX_ROOMS: Final = 1_000
"""Rooms of one file, those that turn out to be none among them."""


@dataclass(frozen=True)
class Options:
    """What a reader cannot see in the file."""

    assets: Source | None = None
    """Sizes of models by their ids: ProcTHOR's asset boxes, 3D-FUTURE's model_info.json."""
    scan: str | None = None
    """The one scan or house to read of a file that holds many."""
    room_type: str | None = None
    """The room type of a file that does not say."""
    up: str = "y"
    """glb, obj: the axis that points up, y or z."""
    front: str = "+z"
    """glb, obj: where the front of every piece points in its own frame: +z, -z, +x or -x (after `up`)."""
    unit: float = 1.0
    """glb, obj: metres a unit."""
    most_rooms: int = MAX_ROOMS
    """A file of more is refused."""
