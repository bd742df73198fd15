"""The weights that are shipped know words from motion, in rooms they have never seen."""

from __future__ import annotations

from pathlib import Path

import pytest
from small_home import DIRECTOR, after, contact, small_home, to

import motion_backend
from motion_backend.embedding.text_motion_embedding import SHIPPED, TextMotionEmbedding
from motion_backend.language import minilm
from motion_backend.motion import Motion, Skill

pytestmark = pytest.mark.skipif(
    minilm.weights_folder() is None,
    reason="the MiniLM weights or torch are not installed",
)
MAX_BYTES = 3_000_000


@pytest.fixture(scope="module")
def embedding() -> TextMotionEmbedding:
    return TextMotionEmbedding.load()


def acted(skill: Skill, name: str, caption: str) -> Motion:
    action = contact(small_home(), skill, name, caption)
    return DIRECTOR.act(small_home(), action, after(small_home(), to(action)))[0]


def test_a_motion_looks_like_its_caption_and_not_like_another(embedding: TextMotionEmbedding) -> None:
    told = ("sitting still", "arms crossed, straight legs, feet crossed", "touch medium height", "walk on tiptoes")
    sitting = acted(Skill.SITDOWN, "chair", told[0])
    assert embedding.likeness(sitting, told).argmax() == 0
    others = ("sit quietly without moving", "lie on the back", "reach up high", "run and spin")
    assert embedding.likeness(sitting, others).argmax() == 0, "nor in words that it was not taught"


def test_the_weights_are_small_and_their_card_is_there() -> None:
    file = Path(motion_backend.__file__).parent / SHIPPED
    assert file.stat().st_size <= MAX_BYTES
    card = Path(motion_backend.__file__).parents[1] / "docs" / "model_cards" / "text_motion_embedding.md"
    assert "mocap.cs.cmu.edu" in card.read_text(encoding="utf-8"), "the credit that the recordings ask for"
