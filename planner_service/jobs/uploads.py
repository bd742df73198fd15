"""Files that were sent and wait to be read: named by their content, kept for one job, gone when it has ended."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import time
import uuid
from collections.abc import Collection
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO, Final, Self

KEPT: Final = 24 * 3600.0
"""Seconds after which what belongs to no job that goes on is thrown away, such as half of an upload."""
_CONTENT: Final = re.compile(r"[0-9a-f]{64}")
_JOB: Final = re.compile(r"[0-9a-f-]{36}")
_COMING: Final = "coming-"


class OverlongError(ValueError):
    """A file has more bytes than are kept."""


class Uploads:
    """The folder of uploads: one folder a job, in it files named by the SHA-256 of what they hold."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def begin(self) -> Coming:
        """A place for files that are coming in; OSError where none can be made."""
        folder = self.folder / f"{_COMING}{uuid.uuid4().hex}"
        folder.mkdir(parents=True, mode=0o700)
        return Coming(self, folder)

    def path(self, job_id: str, content: str) -> Path:
        """Where a file of a job is, if it is on this machine."""
        assert _JOB.fullmatch(job_id)
        assert _CONTENT.fullmatch(content)
        return self.folder / job_id / content

    def forget(self, job_id: str) -> None:
        """Throw the files of a job away; nothing happens where there are none."""
        assert _JOB.fullmatch(job_id)
        shutil.rmtree(self.folder / job_id, ignore_errors=True)

    def sweep(self, going_on: Collection[str]) -> None:
        """Throw away what is old and belongs to none of the jobs that go on."""
        for folder in self.folder.iterdir() if self.folder.is_dir() else ():
            if folder.name not in going_on and time.time() - _touched(folder) > KEPT:
                shutil.rmtree(folder, ignore_errors=True)


@dataclass
class Coming:
    """Files that are coming in for one job; use it in `with`: what was not kept by its end is thrown away."""

    uploads: Uploads
    folder: Path
    _open: list[Receiving] = field(default_factory=list)

    def receive(self, most: int) -> Receiving:
        """A new file of at most so many bytes."""
        # Not in `with`: it is filled piece by piece, and closed when it is whole or when all is thrown away.
        file = (self.folder / f"part-{len(self._open)}").open("xb")
        self._open.append(Receiving(Path(file.name), file, most))
        return self._open[-1]

    def keep(self, job_id: str) -> None:
        """Give all whole files to a job."""
        self.folder.rename(self.uploads.folder / job_id)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        try:
            for one in self._open:
                # What is closed here goes away: that a full disk cannot take the last of it does not matter.
                with suppress(OSError):
                    one.file.close()
        finally:
            shutil.rmtree(self.folder, ignore_errors=True)


@dataclass
class Receiving:
    """One file that is coming in."""

    path: Path
    file: BinaryIO
    most: int
    size: int = 0
    _hash: hashlib._Hash = field(default_factory=hashlib.sha256)

    def write(self, data: bytes) -> None:
        """The next bytes. OverlongError, OSError."""
        self.size += len(data)
        if self.size > self.most:
            raise OverlongError(f"it has more than {self.most} bytes")
        self._hash.update(data)
        self.file.write(data)

    def finish(self) -> str:
        """The file is whole, and on the disk: its content id. OSError."""
        self.file.flush()
        os.fsync(self.file.fileno())
        self.file.close()
        content = self._hash.hexdigest()
        self.path = self.path.rename(self.path.with_name(content))
        return content


def _touched(folder: Path) -> float:
    """When something in a folder was last written; now, where it is just being taken away."""
    try:
        return max(one.stat().st_mtime for one in (folder, *folder.iterdir()))
    except OSError:
        return time.time()
