"""The MiniLM encoder against ids of the reference tokeniser and the model card's similarities."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

import numpy as np
import pytest
from for_each import for_each
from scipy.special import erf

from motion_backend.language import minilm
from motion_backend.language.sentence_encoder import HashingEncoder, load_encoder

FOLDER = minilm.weights_folder()
needs_weights = pytest.mark.skipif(FOLDER is None, reason="the MiniLM weights are not installed")

# Made with tokenizers 0.23.3 from the package's own tokenizer.json.
REFERENCE = {
    "The character searches for jewellery.": [101, 1996, 2839, 17193, 2005, 21545, 1012, 102],
    "Naïve café — “quoted” don't!": [101, 15743, 7668, 1517, 1523, 9339, 1524, 2123, 1005, 1056, 999, 102],
    "漢字 ok": [101, 1904, 100, 7929, 102],
    "x" * 101: [101, 100, 102],
    "": [101, 102],
    "a\u200bb\tc\x00d": [101, 11113, 3729, 102],
    "Ελληνικά ΌΣΟΣ": [101, 1159, 29727, 29727, 24824, 16177, 18199, 29726, 14608, 1169, 29733, 29730, 29733, 102],
    "unaffable 😀": [101, 14477, 20961, 3468, 100, 102],
}


@pytest.fixture(scope="module")
def encoder() -> minilm.MiniLM:
    """The real model."""
    assert FOLDER is not None
    return minilm.MiniLM(FOLDER)


def test_word_pieces_are_the_longest_that_the_vocabulary_has() -> None:
    tokens = minilm.WordPiece(["[UNK]", "[CLS]", "[SEP]", "wine", "##s", "win", "##es", "un", "##known"])
    assert tokens.encode("Wines, unknown zebra") == [1, 3, 4, 0, 7, 8, 0, 2]
    assert tokens.encode("wine " * 50, longest=8) == [1, 3, 3, 3, 3, 3, 3, 2]


@needs_weights
@for_each("text", REFERENCE)
def test_ids_are_those_of_the_reference_tokeniser(encoder: minilm.MiniLM, text: str) -> None:
    assert encoder._tokens.encode(text) == REFERENCE[text]


@needs_weights
def test_similarities_are_those_the_model_is_known_for(encoder: minilm.MiniLM) -> None:
    rows = encoder.encode(["A man is eating food.", "A man is eating a piece of bread.", "A monkey is playing drums."])
    assert rows.shape == (3, 384)
    assert rows[0] @ rows[1] == pytest.approx(0.7553, abs=1e-4)  # Sentence Transformers' documented example
    assert rows[0] @ rows[2] < 0.1


@needs_weights
def test_a_row_does_not_depend_on_what_it_was_encoded_with(encoder: minilm.MiniLM) -> None:
    texts = ["sits", "walks sadly through the living room and then lies down on the sofa", "", "wine " * 400]
    together = encoder.encode(texts)
    alone = np.concatenate([encoder.encode([text]) for text in texts])
    np.testing.assert_allclose(together, alone, atol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(together, axis=1), 1, atol=1e-5)


def test_units_bend_as_the_error_function_says() -> None:
    x = np.concatenate([np.linspace(-9, 9, 3001), [0.0, 1e-6, -1e-6, 50, -50]], dtype=np.float32).reshape(2, -1)
    exact = 0.5 * x.astype(np.float64) * (1 + erf(x / np.sqrt(2)))
    np.testing.assert_allclose(minilm._gelu(x), exact, atol=2e-6, rtol=1e-6)


@needs_weights
def test_the_encoder_is_the_real_one_where_it_is_installed(tmp_path: Path) -> None:
    assert load_encoder(cache=tmp_path).name == "all-MiniLM-L6-v2"
    marks = sorted(tmp_path.iterdir())
    assert len(marks) == len(minilm.FILES)
    load_encoder(cache=tmp_path)
    assert sorted(tmp_path.iterdir()) == marks


def test_weights_that_are_not_ours_are_refused(tmp_path: Path) -> None:
    with pytest.raises(minilm.WeightsError, match=r"model\.safetensors is missing"):
        minilm.verify(tmp_path)
    for name in minilm.FILES:
        (tmp_path / name).write_text("something else")
    with pytest.raises(minilm.WeightsError, match=r"has sha256 .*, wanted 53aa5117"):
        minilm.verify(tmp_path, tmp_path / "cache")
    with pytest.raises(minilm.WeightsError):
        load_encoder(folder=tmp_path)


def test_what_was_checked_is_not_read_again_until_it_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    wanted = hashlib.sha256(b"weights").hexdigest()
    monkeypatch.setattr(minilm, "FILES", {"model": wanted})
    model, cache = tmp_path / "model", tmp_path / "cache"
    model.write_bytes(b"weights")
    minilm.verify(tmp_path, cache)
    before = model.stat()
    model.write_bytes(b"WEIGHTS")
    os.utime(model, ns=(before.st_atime_ns, before.st_mtime_ns))
    minilm.verify(tmp_path, cache)
    with pytest.raises(minilm.WeightsError, match="has sha256"):
        minilm.verify(tmp_path)
    os.utime(model, ns=(before.st_atime_ns, before.st_mtime_ns + 10**9))
    with pytest.raises(minilm.WeightsError, match="has sha256"):
        minilm.verify(tmp_path, cache)


def test_without_the_package_the_fall_back_says_that_it_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(minilm, "PACKAGE", "no_such_package_here")
    assert isinstance(load_encoder(), HashingEncoder)
