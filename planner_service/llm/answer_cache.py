"""Answers that were good, kept on disk: the same question of the same story is not paid for twice."""

from __future__ import annotations

import contextlib
import hashlib
import json
import logging
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Final

MAX_FILES: Final = 5000
log = logging.getLogger("sims.llm")


@dataclass(frozen=True)
class Memory:
    """One small file an answer in a folder of bounded size; what was not used for longest goes first.

    The folder may be deleted at any time, and a file that cannot be read or written is only asked for again.
    """

    folder: Path
    most_bytes: int = 64_000_000

    def recall(self, model: str, digest: str, seed: int) -> str | None:
        """The JSON of the answer to that question, or None."""
        path = self._path(model, digest, seed)
        try:
            row = json.loads(path.read_text(encoding="utf-8"))
            os.utime(path)
        except (OSError, ValueError, RecursionError):
            return None
        good = isinstance(row, dict) and (row.get("model"), row.get("digest"), row.get("seed")) == (model, digest, seed)
        answer = row.get("answer") if good else None
        return answer if isinstance(answer, str) else None

    def keep(self, model: str, digest: str, seed: int, answer: str) -> None:
        """Write an answer down, whole or not at all."""
        row = {"model": model, "digest": digest, "seed": seed, "answer": answer}
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            handle, aside = tempfile.mkstemp(suffix=".tmp", dir=self.folder)
            try:
                os.write(handle, json.dumps(row).encode())
                os.close(handle)
                Path(aside).replace(self._path(model, digest, seed))
            except BaseException:
                Path(aside).unlink(missing_ok=True)
                raise
            self._forget_oldest()
        except (OSError, ValueError) as error:
            log.warning("an answer could not be kept: %s", error)

    def _forget_oldest(self) -> None:
        rows = []
        for path in self.folder.iterdir():
            with contextlib.suppress(OSError):  # another process was faster
                found = path.stat()
                rows.append((found.st_mtime, found.st_size, path))
        rows.sort(reverse=True)
        size = 0
        for number, (_, bytes_, path) in enumerate(rows):
            size += bytes_
            if number >= MAX_FILES or size > self.most_bytes:
                path.unlink(missing_ok=True)

    def _path(self, model: str, digest: str, seed: int) -> Path:
        return self.folder / f"{hashlib.sha256(f'{model} {digest} {seed}'.encode()).hexdigest()}.json"
