"""The beat classifier: the same in NumPy as where it was learned, with clear errors for weights that are none of it."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from layers import sampled

from motion_backend.language import minilm
from motion_backend.language.minilm import MiniLM, WeightsError
from motion_backend.motion import Skill
from planner_service.composition.beat_classifier import SHIPPED, BeatClassifier, Vocabulary, shipped
from planner_service.evaluation.labels import LabelledTheme, training_themes
from scene_graphs.errors import UserError

FOLDER = minilm.weights_folder()
pytestmark = pytest.mark.skipif(FOLDER is None, reason="the sentence encoder is not installed: make test installs it")
BEAT = {"text": "sits down to read", "actable": True, "shown_by": [{"skill": ["sitdown"], "caption": ["reading"]}]}


@pytest.fixture(scope="module")
def encoder() -> MiniLM:
    assert FOLDER is not None
    return MiniLM(FOLDER)


@pytest.mark.parametrize(
    ("told", "before", "skill", "caption"),
    [
        ("pulls the curtain shut", "", Skill.TOUCH, ""),
        ("sits with her nose in a paperback", "", Skill.SITDOWN, "reading"),
        ("hammers away at the keyboard", "", Skill.SITDOWN, "typing"),
        ("tiptoes past the nursery", "", Skill.LOCO, "tiptoes"),
        ("collapses into bed, fast asleep", "", Skill.LIEDOWN, ""),
        ("rummages in the wardrobe", "", Skill.TOUCH, ""),
    ],
)
def test_everyday_words_are_shown_by_what_one_expects(
    told: str, before: str, skill: Skill, caption: str, encoder: MiniLM
) -> None:
    (found,) = shipped(encoder).likely([told], [before])
    assert found.best[0] is skill
    assert caption in found.best[1]
    assert found.shown > 0.5


def test_what_nobody_can_show_is_not_shown(encoder: MiniLM) -> None:
    told = ["the rain fell all night", "her flight was cancelled", "it had been a hard year"]
    assert max(one.shown for one in shipped(encoder).likely(told, [""] * 3)) < 0.5


def test_clauses_are_read_alike_alone_and_among_others(encoder: MiniLM) -> None:
    told = ["opens the fridge", "sits down on the sofa with a long sigh", "sleeps"]
    before = ["", "comes home. opens the fridge", "sits down on the sofa with a long sigh"]
    together = shipped(encoder).likely(told, before)
    for one, text, about in zip(together, told, before, strict=True):
        (alone,) = shipped(encoder).likely([text], [about])
        assert alone.captions == pytest.approx(one.captions, abs=1e-4)
    assert shipped(encoder).likely([], []) == []


def test_it_knows_beats_that_it_has_not_learned(encoder: MiniLM) -> None:
    from planner_service.evaluation.beat_recognition import recognised

    found = recognised(shipped(encoder), training_themes()[1][::24])
    assert found.beats > 40
    assert found.first > 0.7
    assert found.shown > 0.8
    assert found.placed > 0.6


def test_changes_are_added_to_the_encoders_own_weights(encoder: MiniLM) -> None:
    name = "encoder.layer.0.output.dense.weight"
    same = encoder.adapted({name: np.zeros((384, 1536), dtype=np.float32)})
    texts = ["a chair", "somebody sits down on a chair by the window"]
    assert np.array_equal(same.encode(texts), encoder.encode(texts))
    assert np.allclose(np.linalg.norm(encoder.encode(texts), axis=1), 1.0, atol=1e-6)
    noise = np.random.default_rng(0).normal(size=(384, 1536)).astype(np.float32)
    other = encoder.adapted({name: noise})
    assert not np.allclose(other.encode(texts), encoder.encode(texts), atol=1e-2)
    with pytest.raises(WeightsError, match="no weights of that name and size"):
        encoder.adapted({name: np.zeros((2, 2), dtype=np.float32)})


def test_weights_that_are_none_of_it_are_refused(encoder: MiniLM, tmp_path: Path) -> None:
    from safetensors.numpy import save_file

    torn, empty = tmp_path / "torn.safetensors", tmp_path / "empty.safetensors"
    torn.write_bytes(b"\x10\x00")
    save_file({"head.weight": np.zeros(1, dtype=np.float32)}, empty)
    for path in (torn, empty, tmp_path / "none"):
        with pytest.raises(WeightsError, match="holds no beat classifier"):
            BeatClassifier(encoder, path)


def test_other_captions_than_those_learned_are_refused(encoder: MiniLM) -> None:
    known = shipped(encoder).vocabulary
    assert Vocabulary.read(known.written()) == known
    with pytest.raises(WeightsError, match="train it again"):
        Vocabulary.read(replace(known, captions=known.captions[1:]).written())


def test_a_label_becomes_a_row_in_its_own_words_and_in_ours() -> None:
    from planner_service.composition.beat_trainer import rows_of, vocabulary

    undone = {"text": "does not sleep", "actable": False, "undone": True}
    label = {
        "id": "x",
        "theme": "Ann opens the fridge. Then Ann sits down to read, and does not sleep.",
        "split": "tune",
    }
    touch = {"skill": ["touch"], "furniture": ["refrigerator"]}
    fridge = {"text": "opens the fridge", "actable": True, "shown_by": [touch, {"mood": ["happy"]}]}
    theme = LabelledTheme.model_validate({**label, "beats": [fridge, BEAT, undone]}, strict=False)
    known = vocabulary()
    rows = rows_of([theme], known, ours=False)
    assert [(row.clause, row.before) for row in rows] == [
        ("opens the fridge", ""),
        ("sits down to read", "opens the fridge"),
    ]
    opened, read = rows
    assert {known.captions[place][0] for place in np.flatnonzero(opened.captions)} == {Skill.TOUCH}
    assert opened.pieces is not None
    assert known.pieces[int(np.argmax(opened.pieces))] == "refrigerator"
    assert [known.moods[place].value for place in np.flatnonzero(opened.moods)] == ["happy"]
    assert [known.captions[place][1] for place in np.flatnonzero(read.captions)] == ["reading, book held in both hands"]
    assert read.pieces is None
    assert read.shown == 1.0
    assert len(rows_of([theme], known)) >= len(rows)


@pytest.mark.parametrize("whole", sampled([False, True], 2))
def test_what_was_learned_in_torch_is_told_in_numpy(whole: bool, encoder: MiniLM, tmp_path: Path) -> None:
    import torch

    from planner_service.composition.beat_trainer import (
        BeatTraining,
        batch_of,
        learn,
        rows_of,
        save,
        vocabulary,
    )

    assert FOLDER is not None
    known, themes = vocabulary(), training_themes()[0]
    rows = rows_of(themes[:3] if whole else themes[:1], known, ours=False)
    training = BeatTraining(epochs=30 if whole else 1, warm_up=1, batch=8, dropout=0.0)
    net = learn(rows, known, FOLDER, training)
    save(net, known, tmp_path / "one")
    classifier = BeatClassifier(encoder, tmp_path / "one")
    found = classifier.likely([row.clause for row in rows], [row.before for row in rows])
    tokens = minilm.WordPiece((FOLDER / "vocab.txt").read_text(encoding="utf-8").split("\n"))
    with torch.no_grad():
        wanted = torch.sigmoid(net(*batch_of(rows, tokens, lambda: False))).numpy()
    told = np.array([[*one.captions.values(), *one.moods.values(), one.shown, *one.pieces.values()] for one in found])
    assert np.abs(told - wanted).max() < 0.02
    if whole:
        first = [
            row.captions[known.captions.index(one.best)]
            for row, one in zip(rows, found, strict=True)
            if row.captions.any()
        ]
        assert np.mean(first) > 0.95, "a handful of beats is known by heart"
        save(learn(rows, known, FOLDER, replace(training, epochs=1)), known, tmp_path / "two")
        save(learn(rows, known, FOLDER, replace(training, epochs=1)), known, tmp_path / "three")
        assert (tmp_path / "two").read_bytes() == (tmp_path / "three").read_bytes()


def test_learning_goes_on_from_weights_and_refuses_others(encoder: MiniLM, tmp_path: Path) -> None:
    import torch
    from safetensors.numpy import save_file

    from planner_service.composition.beat_trainer import BeatTraining, learn, rows_of, save, vocabulary

    assert FOLDER is not None
    known = vocabulary()
    rows = rows_of(training_themes()[0][:1], known, ours=False)
    shipped_weights = Path(str(files("planner_service").joinpath("data", SHIPPED)))
    hardly = BeatTraining(epochs=1, warm_up=1, rate=1e-9, dropout=0.0)
    save(learn(rows, known, FOLDER, hardly, start=shipped_weights), known, tmp_path / "on")
    told, before = ["opens the fridge"], ["comes home"]
    (on,), (was,) = BeatClassifier(encoder, tmp_path / "on").likely(told, before), shipped(encoder).likely(told, before)
    assert on.captions == pytest.approx(was.captions, abs=5e-3), "who goes on without a step knows what was known"
    save_file({"head.weight": np.zeros((2, 2), np.float32)}, tmp_path / "other")
    for other in (tmp_path / "other", tmp_path / "none"):
        with pytest.raises(UserError, match="no beat classifier to go on from"):
            learn(rows, known, FOLDER, hardly, start=other)
    assert torch.is_grad_enabled()
