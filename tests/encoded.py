"""Sentences are encoded once in a run of the tests: whoever needs a data folder of its own gets a copy of the vectors.

`SIMS_TEST_CACHE` names a folder that several runs share; they leave it where it is.
"""

from __future__ import annotations

import fcntl
import os
import shutil
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

NAME = "SIMS_TEST_CACHE"
OURS = NAME not in os.environ
"""Whether this process has made the folder, for itself and those that it starts."""
LIBRARY = 100
"""No test of the encoder itself asks for so many sentences."""
FOLDER = Path(os.environ.setdefault(NAME, f"{tempfile.gettempdir()}/sims-test-cache-{os.getpid()}"))


def encoded() -> Path:
    """A cache folder with all sentences of our library in it; of several who ask at once, one encodes them."""
    from planner_service.library.library import Shelves
    from planner_service.pipeline import Pipeline, StoryRequest

    FOLDER.mkdir(parents=True, exist_ok=True)
    with (FOLDER / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not any(FOLDER.glob("sentences-*.npz")):
            Pipeline(Shelves(cache=FOLDER)).plan(StoryRequest("A person sits on the sofa."))
    return FOLDER


def lend(data: Path) -> None:
    """Give a data folder what is encoded already."""
    encoded()
    for files in ("sentences-*.npz", "verified-*"):
        _copy(files, data / "cache")


def _copy(files: str, cache: Path) -> None:
    """What the folder of this run has by such names, unless it is there."""
    cache.mkdir(parents=True, exist_ok=True)
    for file in FOLDER.glob(files):
        if not (cache / file.name).exists():
            shutil.copy2(file, cache / file.name)


def hash_libraries_once() -> None:
    """The sentences of a whole library are hashed once a process, however many tests open it without MiniLM."""
    from motion_backend.language.sentence_encoder import HashingEncoder, Vectors

    plain: Callable[[HashingEncoder, Sequence[str]], Vectors] = HashingEncoder.encode
    known: dict[tuple[int, str], Vectors] = {}

    def encode(self: HashingEncoder, texts: Sequence[str]) -> Vectors:
        if len(texts) < LIBRARY:
            return plain(self, texts)
        key = self.dimension, "\n".join(texts)
        if key not in known:
            known[key] = plain(self, texts)
        return known[key].copy()

    HashingEncoder.encode = encode  # type: ignore[method-assign]


def check_weights_once() -> None:
    """The files of the installed encoder are hashed once in a run, however many tests open a library of their own."""
    from motion_backend.language import minilm

    plain = minilm.verify

    def verify(folder: Path, cache: Path | None = None) -> None:
        if folder == minilm.weights_folder():
            plain(folder, FOLDER)
            if cache is not None:
                _copy("verified-*", cache)
        plain(folder, cache)

    minilm.verify = verify


def forget() -> None:
    """Remove the folder, if this process has made it."""
    if OURS:
        shutil.rmtree(FOLDER, ignore_errors=True)
