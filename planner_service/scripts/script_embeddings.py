"""Sentence features that are shipped: those of our own short scripts and captions, so that no start waits for them.

`python -m planner_service.scripts.script_embeddings` makes them again, once scripts or captions have changed.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.resources import as_file, files
from pathlib import Path
from typing import Final

import numpy as np

from motion_backend.language.sentence_encoder import SentenceEncoder, Vectors, load_encoder
from planner_service.scripts.built_in_scripts import built_in, texts_of
from planner_service.scripts.captions import captions, synonyms

_DATA: Final = files("planner_service") / "data"
_FILE: Final = "sentences.npz"


class ByHeart:
    """An encoder that need not compute what is shipped for it; anything else goes to the encoder inside."""

    def __init__(self, encoder: SentenceEncoder) -> None:
        self.encoder = encoder

    @property
    def name(self) -> str:
        """The name of the encoder inside: the vectors are the same, but for rounding to half precision."""
        return self.encoder.name

    def encode(self, texts: Sequence[str]) -> Vectors:
        """One unit row a text. (N, D) float32."""
        known = shipped(self.name)
        keys = [key_of(text) for text in texts]
        new = [place for place, key in enumerate(keys) if key not in known]
        if len(new) == len(texts):
            return self.encoder.encode(texts)
        made = dict(zip(new, self.encoder.encode([texts[place] for place in new]) if new else (), strict=True))
        return np.stack([made[place] if place in made else known[key] for place, key in enumerate(keys)])


def load_by_heart(cache: Path | None = None) -> SentenceEncoder:
    """The encoder there is, as `load_encoder` finds it, knowing our own sentences by heart."""
    return ByHeart(load_encoder(cache=cache))


def key_of(text: str) -> bytes:
    """What a text is found by."""
    return hashlib.sha256(text.encode()).digest()[:12]


@cache
def shipped(encoder: str) -> Mapping[bytes, Vectors]:
    """The rows that are shipped for an encoder of that name, by `key_of`; none for others."""
    with as_file(_DATA / _FILE) as path:
        if not path.exists():
            return {}
        with np.load(path, allow_pickle=False) as stored:
            if str(stored["encoder"]) != encoder:
                return {}
            rows = stored["vectors"].astype(np.float32)
            rows /= np.linalg.norm(rows, axis=1, keepdims=True)
            return {key.tobytes(): row for key, row in zip(stored["keys"], rows, strict=True)}


def ours() -> list[str]:
    """Every text that is shipped, in order: what scripts are found by, captions and their other words."""
    words = [other for of_skill in synonyms().values() for others in of_skill.values() for other in others]
    known = [caption for of_skill in captions().values() for caption in of_skill]
    found_by = [text for script in built_in() for text in texts_of(script)]
    return list(dict.fromkeys([*found_by, *known, *words]))


def learn() -> None:
    """Make the shipped file again. RuntimeError without the weights."""
    encoder = load_encoder()
    if encoder.name == "hashing":
        raise RuntimeError("the weights of the sentence encoder are not installed")
    texts = ours()
    np.savez_compressed(
        Path(str(_DATA / _FILE)),
        encoder=np.array(encoder.name),
        keys=np.array([np.frombuffer(key_of(text), np.uint8) for text in texts]),
        vectors=encoder.encode(texts).astype(np.float16),
    )


if __name__ == "__main__":
    learn()
