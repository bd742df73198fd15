"""What is shipped of sentence features is what the encoder would make, and none of it is missing or too much."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from motion_backend.language.sentence_encoder import HashingEncoder, Vectors, load_encoder
from planner_service.scripts.script_embeddings import ByHeart, key_of, ours, shipped

MINILM = "all-MiniLM-L6-v2"


class Silent:
    """An encoder of that name that may only be asked for what nobody knows."""

    name = MINILM

    def encode(self, texts: Sequence[str]) -> Vectors:
        assert list(texts) == ["a text of nobody's"]
        return np.ones((1, 384), dtype=np.float32)


def test_every_text_of_ours_is_shipped_and_no_other() -> None:
    assert set(map(key_of, ours())) == set(shipped(MINILM)), "run python -m planner_service.scripts.script_embeddings"


def test_what_is_shipped_is_not_computed() -> None:
    known = ours()[:2]
    rows = ByHeart(Silent()).encode([known[0], "a text of nobody's", known[1]])
    np.testing.assert_array_equal(rows[1], np.ones(384))
    np.testing.assert_allclose(np.linalg.norm(rows[[0, 2]], axis=1), 1, atol=1e-6)


def test_an_encoder_of_another_name_computes_everything() -> None:
    texts = ours()[:3]
    np.testing.assert_array_equal(ByHeart(HashingEncoder()).encode(texts), HashingEncoder().encode(texts))


def test_what_is_shipped_is_what_the_encoder_makes() -> None:
    encoder = load_encoder()
    if encoder.name != MINILM:
        pytest.skip("the MiniLM weights are not installed")
    texts = ours()[::400]
    cosines = (encoder.encode(texts) * ByHeart(Silent()).encode(texts)).sum(axis=1)
    assert cosines.min() > 0.99999
