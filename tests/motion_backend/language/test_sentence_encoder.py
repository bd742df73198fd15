"""The hashing encoder, the cache of vectors, and the choice of an encoder."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from examples import tries
from hypothesis import given
from hypothesis import strategies as st

from motion_backend.language.sentence_encoder import CachedEncoder, HashingEncoder, Vectors, load_encoder


class Counting:
    """A hashing encoder that remembers what it was asked."""

    name = "counting/1"

    def __init__(self) -> None:
        self.asked: list[str] = []

    def encode(self, texts: Sequence[str]) -> Vectors:
        """As hashing does."""
        self.asked += texts
        return HashingEncoder().encode(texts)


@tries(50)
@given(st.lists(st.text(), max_size=5))
def test_hashed_rows_have_unit_length_and_do_not_depend_on_their_neighbours(texts: list[str]) -> None:
    rows = HashingEncoder().encode(texts)
    assert rows.shape == (len(texts), 1024)
    assert rows.dtype == np.float32
    np.testing.assert_allclose(np.linalg.norm(rows, axis=1), 1, atol=1e-5)
    for row, text in zip(rows, texts, strict=True):
        np.testing.assert_array_equal(HashingEncoder().encode([text])[0], row)


@pytest.mark.service
def test_hashing_is_the_same_in_another_process() -> None:
    encoded = "HashingEncoder().encode(['a red sofa'])[0]"
    code = f"from motion_backend.language.sentence_encoder import *; print({encoded}.tobytes().hex())"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()
    assert told == HashingEncoder().encode(["a red sofa"])[0].tobytes().hex()


def test_shared_and_inflected_words_are_nearer_than_others() -> None:
    rows = HashingEncoder().encode(
        ["drinks a bottle of wine", "the wine bottle is empty", "a drinker", "reads the news"]
    )
    near = rows[0] @ rows[1:].T
    assert near[0] > near[1] > near[2]


def test_what_was_encoded_once_is_read_from_the_cache(tmp_path: Path) -> None:
    first, again = Counting(), Counting()
    texts = ["one", "two", "one"]
    rows = CachedEncoder(first, tmp_path).encode(texts)
    cached = CachedEncoder(again, tmp_path)
    np.testing.assert_array_equal(cached.encode(["two", "one"]), rows[[1, 0]])
    cached.encode(["three", "one"])
    assert (first.asked, again.asked) == (["one", "two"], ["three"])
    assert CachedEncoder(Counting(), tmp_path).encode([]).shape == (0, 1024)
    assert [path.suffix for path in tmp_path.iterdir()] == [".npz"]


@pytest.mark.parametrize("damage", [b"", b"PK\x03\x04 not a zip", b"\x00" * 100])
def test_a_damaged_cache_is_made_again(tmp_path: Path, damage: bytes) -> None:
    cached = CachedEncoder(Counting(), tmp_path)
    cached.path.write_bytes(damage)
    np.testing.assert_array_equal(cached.encode(["one"]), HashingEncoder().encode(["one"]))
    np.testing.assert_array_equal(CachedEncoder(Counting(), tmp_path).encode(["one"]), cached.encode(["one"]))


def test_a_cache_that_cannot_be_written_costs_nothing_but_time(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    assert CachedEncoder(Counting(), blocked / "cache").encode(["one"]).shape == (1, 1024)


def test_the_hashing_encoder_can_be_asked_for_and_says_its_name() -> None:
    assert load_encoder("hashing").name == "hashing"
    with pytest.raises(ValueError, match="'minilm' and 'hashing'"):
        load_encoder("clip")  # type: ignore[arg-type]  # no such encoder


@pytest.mark.service
def test_sentences_are_encoded_without_torch() -> None:
    """It takes a second and 200 MB to import."""
    code = (
        "import sys; from motion_backend.language.sentence_encoder import load_encoder; "
        "load_encoder().encode(['sits']); sys.exit('torch' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
