"""Eq. 3 to 5 by hand, training that resumes where it was, and weights that say what they go with."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch
from sample_motions import tumbling

from motion_backend.datasets.motion_text_dataset import MotionText, MotionTextDataset, states_of
from motion_backend.datasets.normalization import Floats
from motion_backend.embedding.caption_retrieval import retrieve
from motion_backend.embedding.text_motion_autoencoder import (
    AutoencoderConfig,
    TextMotionAutoencoder,
    alignment_loss,
    autoencoder_loss,
    contrast_loss,
    text_loss,
)
from motion_backend.embedding.text_motion_embedding import EmbeddingError, TextMotionEmbedding
from motion_backend.embedding.train import CHECKPOINT, Report, TrainConfig, TrainingError, train
from motion_backend.language.sentence_encoder import HashingEncoder
from motion_backend.physics.observations import STATE_SIZE

CAPTIONS = ("a slow tumble", "left arm waving", "spin about", "bend and twist")
ENCODER = HashingEncoder(48)
SMALL = AutoencoderConfig(
    size=16, text_size=48, text_hidden=24, patch=30, width=24, heads=2, hidden=32, encoder_layers=1
)
QUICK = TrainConfig(steps=20, batch=8, rate=5e-3, save_every=10)
MOTIONS = [tumbling(45, seed) for seed in range(len(CAPTIONS))]
DATASET = MotionTextDataset(
    tuple(
        MotionText(f"r/0/loco/{caption}", states_of(motion), (caption,), caption)
        for caption, motion in zip(CAPTIONS, MOTIONS, strict=True)
    )
)
FEATURES = dict(zip(DATASET.wordings, ENCODER.encode(DATASET.wordings), strict=True))


def trained(
    folder: Path, features: dict[str, Floats] = FEATURES, config: TrainConfig = QUICK, **more: Report
) -> TextMotionEmbedding:
    model, scale = train(DATASET, features, folder, config, SMALL, **more)
    return TextMotionEmbedding(model, scale, ENCODER, frozenset({"r"}))


@pytest.fixture(scope="module")
def embedding(tmp_path_factory: pytest.TempPathFactory) -> TextMotionEmbedding:
    return trained(tmp_path_factory.mktemp("run"))


def unit(count: int, size: int, seed: int) -> torch.Tensor:
    rows = torch.randn(count, size, generator=torch.Generator().manual_seed(seed))
    return rows / rows.norm(dim=-1, keepdim=True)


def test_losses_are_those_worked_out_by_hand() -> None:
    z, z_text = unit(5, 8, 0).numpy(), unit(5, 8, 1).numpy()
    cosines = [z[i] @ z_text[i] for i in range(5)]
    assert alignment_loss(torch.tensor(z), torch.tensor(z_text)).item() == pytest.approx(1 - np.mean(cosines), abs=1e-6)
    made, wanted = unit(3, 4, 2), unit(3, 4, 3)
    assert text_loss(made, wanted).item() == pytest.approx(float(np.mean(((made - wanted).numpy() ** 2).sum(1))))
    likes = np.exp(z @ z_text.T / 0.1)
    expected = -np.mean([np.log(likes[i, 4 - i] / likes[i].sum()) for i in range(5)])
    assert contrast_loss(torch.tensor(z), torch.tensor(z_text), torch.arange(4, -1, -1)).item() == pytest.approx(
        expected, rel=1e-4
    )


def test_the_loss_is_the_sum_of_its_three_terms_and_reaches_every_network() -> None:
    model = TextMotionAutoencoder(SMALL)
    states, features = torch.randn(4, 300, STATE_SIZE), unit(4, 48, 0)
    total, terms, z = autoencoder_loss(model, states, features)
    assert total.item() == pytest.approx(terms.sum().item())
    torch.testing.assert_close(z.norm(dim=-1), torch.ones(4))
    total.backward()
    assert all(value.grad is not None and value.grad.abs().sum() > 0 for value in model.parameters())


def test_the_embedding_is_on_the_unit_sphere_of_words_and_motion(embedding: TextMotionEmbedding) -> None:
    for rows in (embedding.motions(MOTIONS), embedding.texts(["anything at all", ""])):
        np.testing.assert_allclose(np.linalg.norm(rows, axis=1), 1.0, rtol=1e-5)
    assert embedding.motions([]).shape == (0, 16)


def test_motion_finds_the_words_it_was_learned_with(embedding: TextMotionEmbedding) -> None:
    found = retrieve(embedding.motions(MOTIONS), CAPTIONS, embedding.texts(CAPTIONS), CAPTIONS)
    assert (found.first, found.groups) == (1.0, 4)
    likeness = embedding.likeness(MOTIONS[2], CAPTIONS)
    assert likeness.argmax() == 2
    assert np.abs(likeness).max() <= 1 + 1e-5


def test_a_run_that_was_cut_off_goes_on_as_if_it_had_not_been(tmp_path: Path, embedding: TextMotionEmbedding) -> None:
    class CutOffError(Exception):
        pass

    def cut(step: int, _terms: dict[str, float]) -> None:
        if step == 10:
            raise CutOffError

    with pytest.raises(CutOffError):
        trained(tmp_path, report=cut)
    np.testing.assert_array_equal(trained(tmp_path).motions(MOTIONS), embedding.motions(MOTIONS))
    with pytest.raises(TrainingError, match="other settings"):
        trained(tmp_path, config=TrainConfig(steps=20, batch=9))
    (tmp_path / CHECKPOINT).write_bytes(b"not this")
    with pytest.raises(TrainingError, match="damaged"):
        trained(tmp_path)


def test_a_loss_that_is_no_number_stops_training_and_keeps_the_batch(tmp_path: Path) -> None:
    broken = FEATURES | {CAPTIONS[0]: np.full(48, np.nan, dtype=np.float32)}
    with pytest.raises(TrainingError, match="the loss is nan"):
        trained(tmp_path, broken)
    with np.load(next(tmp_path.glob("batch*.npz"))) as kept:
        assert CAPTIONS[0] in kept["wordings"]


def test_weights_come_back_as_they_were_kept(tmp_path: Path, embedding: TextMotionEmbedding) -> None:
    file = tmp_path / "weights.safetensors"
    embedding.save(file)
    again = TextMotionEmbedding.load(file, ENCODER)
    assert again.learned_from == {"r"}
    np.testing.assert_allclose(again.motions(MOTIONS), embedding.motions(MOTIONS), atol=0.02)
    with pytest.raises(EmbeddingError, match="hashing-48, and hashing is at hand"):
        TextMotionEmbedding.load(file, HashingEncoder())
    file.write_bytes(file.read_bytes()[:-100])
    with pytest.raises(EmbeddingError, match="no weights of this version"):
        TextMotionEmbedding.load(file, ENCODER)
    with pytest.raises(EmbeddingError, match="missing"):
        TextMotionEmbedding.load(tmp_path / "none", ENCODER)
    with pytest.raises(ValueError, match="no frame"):
        embedding.motions([tumbling(2).part(0, 0)])


def test_retrieval_counts_what_is_nearer_than_the_right_group() -> None:
    axes = np.eye(4, dtype=np.float32)
    clips = np.array([[1, 0, 0, 0], [0.6, 0.8, 0, 0], [0, 0, 0.1, 1]], dtype=np.float32)
    found = retrieve(clips, ["a", "a", "c"], axes, ["a", "b", "c", "a"])
    assert (found.groups, found.clips, found.among_three) == (3, 3, 1.0)
    assert found.first == pytest.approx(1 / 3)
    assert found.taken_for == (("a", "b", 1), ("c", "a", 1))
    assert found.finds == pytest.approx(2 / 3), "the fourth caption's nearest clip is of another group; b has no clip"
    with pytest.raises(ValueError, match="'d'"):
        retrieve(clips[:1], ["d"], axes, ["a", "b", "c", "a"])
