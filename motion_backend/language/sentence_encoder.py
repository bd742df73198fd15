"""Sentences to unit vectors: the encoder protocol, the hashing fall-back and a cache of what was encoded before."""

from __future__ import annotations

import hashlib
import itertools
import os
import re
import tempfile
import zipfile
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

Vectors = NDArray[np.float32]
Prefer = Literal["minilm", "hashing"]

_WORD = re.compile(r"[^\W_]+")
_CACHED_AT_MOST = 300_000
"""Rows kept on disk by encoder: about 77 MB at 384 dimensions."""


class SentenceEncoder(Protocol):
    """What turns sentences into vectors whose dot product tells how alike they are."""

    @property
    def name(self) -> str:
        """Names the features: vectors of encoders with different names must not be compared."""
        ...

    def encode(self, texts: Sequence[str]) -> Vectors:
        """One unit row a text. (N, D) float32."""
        ...


class HashingEncoder:
    """Words, word pairs and letter groups hashed into buckets: deterministic, needs no weights, knows no synonyms."""

    def __init__(self, dimension: int = 1024) -> None:
        self.dimension = dimension

    @property
    def name(self) -> str:
        """Always "hashing", with the dimension when it is not the default."""
        return "hashing" if self.dimension == 1024 else f"hashing-{self.dimension}"

    def encode(self, texts: Sequence[str]) -> Vectors:
        """One unit row a text; a text without letters or digits gets the first axis. (N, D) float32."""
        rows = np.zeros((len(texts), self.dimension), dtype=np.float64)
        for row, text in zip(rows, texts, strict=True):
            for feature, weight in _features(text):
                code = zlib.crc32(feature.encode())
                row[(code >> 1) % self.dimension] += weight if code & 1 else -weight
            if not row.any():
                row[0] = 1.0
        unit: Vectors = (rows / np.linalg.norm(rows, axis=1, keepdims=True)).astype(np.float32)
        return unit


_COMMON_WORDS = """a an and are as at be been but by character for from had has have he her him his i in into is it
its of on or person s she so that the their them then they this to was were when who will with"""
_COMMON = frozenset(_COMMON_WORDS.split())


def _features(text: str) -> Iterator[tuple[str, float]]:
    """Hashed features of a text and their weights; function words say little and get little."""
    words = [word.lower() for word in _WORD.findall(text)]
    for word in words:
        common = word in _COMMON
        yield f"w:{word}", 0.1 if common else 1.0
        if not common:
            padded = f"<{word}>"
            for length in (3, 4, 5):
                for start in range(len(padded) - length + 1):
                    yield f"c:{padded[start : start + length]}", 0.3
    telling = [word for word in words if word not in _COMMON]
    for first, second in itertools.pairwise(telling):
        yield f"p:{first} {second}", 0.5


class CachedEncoder:
    """An encoder that keeps every vector it made in `folder`, found again by the text's hash.

    For texts that come back (a library's), not for passing questions. The file is written aside and renamed, so a
    reader never meets half of it; of two writers at once the later wins and the other's rows are made again.
    """

    def __init__(self, encoder: SentenceEncoder, folder: Path) -> None:
        self.encoder = encoder
        self.path = folder / f"sentences-{re.sub(r'[^A-Za-z0-9._-]+', '-', encoder.name)}.npz"
        self._rows: dict[bytes, Vectors] | None = None

    @property
    def name(self) -> str:
        """The name of the encoder inside: the vectors are the same."""
        return self.encoder.name

    def encode(self, texts: Sequence[str]) -> Vectors:
        """As the encoder inside; only texts never seen before are computed. (N, D) float32."""
        if self._rows is None:
            self._rows = _read_rows(self.path)
        keys = [hashlib.sha256(text.encode()).digest() for text in texts]
        new = {key: text for key, text in zip(keys, texts, strict=True) if key not in self._rows}
        if new or not texts:
            made = self.encoder.encode(list(new.values()))
            if not texts:
                return made
            self._rows.update(zip(new, made, strict=True))
            _write_rows(self.path, self._rows)
        return np.stack([self._rows[key] for key in keys])


def _read_rows(path: Path) -> dict[bytes, Vectors]:
    """Rows by hash of their text; none when the file is missing or damaged, since they can be made again."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
            keys, vectors = stored["keys"], stored["vectors"]
            if keys.ndim != 2 or keys.dtype != np.uint8 or vectors.shape[:1] != keys.shape[:1]:
                return {}
            return {key.tobytes(): vector for key, vector in zip(keys, vectors.astype(np.float32), strict=True)}
    except (OSError, ValueError, KeyError, EOFError, zlib.error, zipfile.BadZipFile):
        return {}


def _write_rows(path: Path, rows: dict[bytes, Vectors]) -> None:
    """Write the newest rows; a full disk or a read-only folder costs speed next time and nothing else."""
    kept = dict(itertools.islice(rows.items(), max(0, len(rows) - _CACHED_AT_MOST), None))
    keys = np.frombuffer(b"".join(kept), dtype=np.uint8).reshape(len(kept), -1)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, aside = tempfile.mkstemp(dir=path.parent, suffix=".npz.tmp")
        try:
            with os.fdopen(handle, "wb") as file:
                np.savez(file, keys=keys, vectors=np.stack(list(kept.values())))
            Path(aside).replace(path)
        except BaseException:
            Path(aside).unlink(missing_ok=True)
            raise
    except OSError:
        return


def load_encoder(prefer: Prefer = "minilm", cache: Path | None = None, folder: Path | None = None) -> SentenceEncoder:
    """The encoder asked for; hashing, under its own name, where the weights are not installed.

    `folder` holds the weights when they are not those of the pip package; `cache` remembers that their hash was
    checked. Raises `minilm.WeightsError` when the files are there but are not the expected ones.
    """
    if prefer not in ("minilm", "hashing"):
        raise ValueError(f"prefer: {prefer!r} is no sentence encoder; there are 'minilm' and 'hashing'")
    if prefer == "minilm":
        from motion_backend.language import minilm

        place = folder or minilm.weights_folder()
        if place is not None:
            return minilm.MiniLM(place, cache)
    return HashingEncoder()
