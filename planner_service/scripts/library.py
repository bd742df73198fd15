"""The short scripts we have: ours and the user's, kept as JSON lines, found by meaning (SIMS 3.2)."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from importlib import resources
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from motion_backend.language.text import CachedEncoder, SentenceEncoder, load_encoder
from planner_service.scripts.checking import check
from planner_service.scripts.keyframe import EMOTIONS, ShortScript
from scene_graphs.furniture import ROOM_TYPES, canonical_room

Scores = NDArray[np.float64]
BUILT_IN: Final = "short_scripts.jsonl"
CAPTION_WEIGHT: Final = 0.7
_TELLING: Final = 0.03
"""Share of the summaries that may have a word which still tells them apart."""
_SENTENCE: Final = re.compile(r"(?<=[.!?])\s+")


class LibraryError(ValueError):
    """A short script cannot be read, kept or found; the text names file, line and field."""


@dataclass(frozen=True)
class Found:
    """A short script and how near it is to what was asked, -1 to 1."""

    script: ShortScript
    score: float


class ScriptLibrary:
    """Short scripts with unique ids, and the sentence features by which they are found.

    An encoder is loaded on the first search when none is given; with a `cache` folder what it made of the library is
    kept there.
    """

    def __init__(
        self,
        scripts: Iterable[ShortScript],
        encoder: SentenceEncoder | None = None,
        cache: Path | None = None,
        file: Path | None = None,
    ) -> None:
        self.scripts = tuple(scripts)
        self.file = file
        self._cache = cache
        if encoder is not None:
            self.encoder = encoder
        twice = _first_repeated(script.id for script in self.scripts)
        if twice is not None:
            raise LibraryError(f"id: two short scripts are called {twice!r}")

    @classmethod
    def read(
        cls, file: Path | None = None, encoder: SentenceEncoder | None = None, cache: Path | None = None
    ) -> ScriptLibrary:
        """Our scripts and those of the user's `file`, which need not exist yet; LibraryError names file:line:field."""
        scripts = list(built_in())
        if file is not None:
            lines: dict[str, str] = {script.id: BUILT_IN for script in scripts}
            for number, script in _read(_bytes_of(file), file.name):
                if script.id in lines:
                    raise LibraryError(f"{file.name}:{number}:id: {script.id!r} is taken by {lines[script.id]}")
                lines[script.id] = f"{file.name}:{number}"
                scripts.append(script)
        return cls(scripts, encoder, cache, file)

    @cached_property
    def encoder(self) -> SentenceEncoder:
        """What turns texts into vectors here."""
        return load_encoder(cache=self._cache)

    def __len__(self) -> int:
        return len(self.scripts)

    def get(self, script_id: str) -> ShortScript:
        """The script of that id, or LibraryError."""
        for script in self.scripts:
            if script.id == script_id:
                return script
        raise LibraryError(f"id: there is no short script {script_id!r} among the {len(self)} of the library")

    def add(self, *scripts: ShortScript) -> ScriptLibrary:
        """A library with these scripts more, all of them in the user's file before this returns, or none.

        LibraryError when an id is taken, when a furniture word or emotion is not known, or when there is no file.
        """
        if self.file is None:
            raise LibraryError("file: this library has no file of the user's to write to")
        taken = {script.id for script in self.scripts}
        for script in scripts:
            if script.id in taken:
                where = f"{self.file.name}:id"
                raise LibraryError(f"{where}: there is a short script {script.id!r} already; choose another id")
            taken.add(script.id)
            for problem in check(script):
                if problem.field != "skill":  # missing walks and risings are put in when a story is composed
                    where = f"{self.file.name}:{script.id}:keyframes.{problem.keyframe}.{problem.field}"
                    raise LibraryError(f"{where}: {problem.fault}")
        try:
            _append(self.file, "\n".join(script.model_dump_json(exclude_none=True) for script in scripts))
        except OSError as error:
            why = f"{error.strerror}; choose another folder by SIMS_DATA_DIR or --data-dir"
            raise LibraryError(f"{self.file} cannot be written: {why}") from error
        return ScriptLibrary((*self.scripts, *scripts), self.encoder, self._cache, self.file)

    def search(self, query: str, k: int = 5, emotion: str | None = None, room: str | None = None) -> tuple[Found, ...]:
        """The k scripts nearest to the query in meaning, nearest first, of one emotion and room if these are given."""
        if emotion is not None and emotion not in EMOTIONS:
            raise LibraryError(f"emotion: {emotion!r} is none of {', '.join(EMOTIONS)}")
        if room is not None and canonical_room(room) not in ROOM_TYPES:
            raise LibraryError(f"room: {room!r} is none of {', '.join(ROOM_TYPES)}")
        if k < 1 or not query.strip():
            raise LibraryError("query: ask for at least one script, with at least one word")
        scores = self.scores(self.encoder.encode([query]))[0]
        fitting = [
            index
            for index, script in enumerate(self.scripts)
            if (emotion is None or script.emotion == emotion) and (room is None or script.room == canonical_room(room))
        ]
        fitting.sort(key=lambda index: (-scores[index], self.scripts[index].id))
        return tuple(Found(self.scripts[index], float(scores[index])) for index in fitting[:k])

    def scores(self, vectors: NDArray[np.float32]) -> Scores:
        """How near each script is to each vector of `encoder`: by its summary, a sentence or caption. (N, scripts).

        Rounded to 1e-4, so that another machine ranks alike.
        """
        texts, weights, owners = self._features
        near = vectors @ texts.T * weights  # (N, texts)
        best: Scores = np.maximum.reduceat(near, owners, axis=1).astype(np.float64)
        return best.round(4)

    def naming(self, text: str) -> NDArray[np.bool_]:
        """Which scripts' summaries have a word of the text that few summaries have ("lottery"). (scripts,)."""
        found = np.zeros(len(self), dtype=np.bool_)
        for word in _words(text):
            owners = self._words.get(word, [])
            if 0 < len(owners) <= max(3, _TELLING * len(self)):
                found[owners] = True
        return found

    @cached_property
    def _words(self) -> dict[str, list[int]]:
        """The scripts whose summary has a word."""
        places: dict[str, list[int]] = {}
        for index, script in enumerate(self.scripts):
            for word in _words(script.summary):
                places.setdefault(word, []).append(index)
        return places

    def vectors_of(self, texts: tuple[str, ...]) -> NDArray[np.float32]:
        """Vectors of texts that are asked for again and again, remembered as the library's own are."""
        if texts not in self._known:
            self._known[texts] = self._remembering.encode(texts)
        return self._known[texts]

    @cached_property
    def _known(self) -> dict[tuple[str, ...], NDArray[np.float32]]:
        return {}

    @cached_property
    def _remembering(self) -> SentenceEncoder:
        return CachedEncoder(self.encoder, self._cache) if self._cache else self.encoder

    @cached_property
    def _features(self) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.intp]]:
        """A vector and weight for each text, script after script, and where each script begins."""
        texts: list[str] = []
        weights: list[float] = []
        owners: list[int] = []
        for script in self.scripts:
            owners.append(len(texts))
            for text, weight in texts_of(script).items():
                texts.append(text)
                weights.append(weight)
        distinct = {text: index for index, text in enumerate(dict.fromkeys(texts))}
        rows = self._remembering.encode(list(distinct))
        places = [distinct[text] for text in texts]
        return rows[places], np.array(weights, dtype=np.float32), np.array(owners, dtype=np.intp)


def texts_of(script: ShortScript) -> dict[str, float]:
    """What a script is found by, with weights: its summary, the sentences of it, and its captions.

    Captions are shared by many scripts, so that at full weight they drown the summaries: hit@1 on 54 phrases of ours
    fell from 50 to 45.
    """
    captions = dict.fromkeys((keyframe.caption for keyframe in script.keyframes), CAPTION_WEIGHT)
    return captions | dict.fromkeys((script.summary, *_SENTENCE.split(script.summary)), 1.0)


def _words(text: str) -> set[str]:
    """Words of four letters and more, plural or not."""
    return {word.removesuffix("s") for word in re.findall(r"[^\W\d_]{4,}", text.lower())}


def built_in() -> tuple[ShortScript, ...]:
    """The short scripts shipped with the package."""
    data = resources.files("planner_service").joinpath("data", BUILT_IN).read_bytes()
    return tuple(script for _, script in _read(data, BUILT_IN))


def _bytes_of(file: Path) -> bytes:
    """What is in the user's file, which need not exist yet."""
    try:
        return file.read_bytes()
    except (FileNotFoundError, NotADirectoryError):
        return b""
    except OSError as error:
        raise LibraryError(f"{file} cannot be read: {error.strerror}") from error


def _read(data: bytes, name: str) -> Iterable[tuple[int, ShortScript]]:
    """Line number and script of every line that is not empty."""
    try:
        lines = data.decode("utf-8-sig").split("\n")
    except UnicodeDecodeError as error:
        number = data.count(b"\n", 0, error.start) + 1
        raise LibraryError(f"{name}:{number}: not UTF-8 text") from error
    for number, line in enumerate(lines, 1):
        if line.strip():
            try:
                yield number, ShortScript.model_validate_json(line)
            except ValidationError as error:
                raise LibraryError(f"{name}:{number}:{_first_fault(error)}") from error


def _first_fault(error: ValidationError) -> str:
    fault = error.errors(include_url=False)[0]
    return f"{'.'.join(map(str, fault['loc'])) or 'line'}: {fault['msg']}"


def _append(file: Path, line: str) -> None:
    """Add a line by writing the whole file aside and renaming it, so that it is never seen half written."""
    file.parent.mkdir(parents=True, exist_ok=True)
    before = file.read_bytes() if file.exists() else b""
    if before and not before.endswith(b"\n"):
        before += b"\n"
    handle, aside = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name}.")
    try:
        with os.fdopen(handle, "wb") as target:
            target.write(before + line.encode() + b"\n")
            target.flush()
            os.fsync(target.fileno())
        Path(aside).replace(file)
    except BaseException:
        Path(aside).unlink(missing_ok=True)
        raise


def _first_repeated(ids: Iterable[str]) -> str | None:
    seen: set[str] = set()
    for one in ids:
        if one in seen:
            return one
        seen.add(one)
    return None
