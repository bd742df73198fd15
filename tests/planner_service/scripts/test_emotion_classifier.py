"""How a sentence feels: what a mood reader learns from, and when it is sure."""

from __future__ import annotations

import numpy as np

from motion_backend.language.sentence_encoder import HashingEncoder
from planner_service.scripts.emotion_classifier import MoodReader, clear_moods, lessons, moments
from planner_service.scripts.script import EMOTIONS, ShortScript


def test_a_mood_reader_reads_what_it_was_taught_and_is_unsure_of_what_is_like_nothing() -> None:
    texts = ["tears and grief", "grief and sorrow", "joy and laughter", "laughter and delight"]
    encoder = HashingEncoder()
    reader = MoodReader(np.repeat(encoder.encode(texts), 8, axis=0), ["sad"] * 16 + ["happy"] * 16)
    felt = reader.read(encoder.encode(["sorrow and grief", "delight and joy", "zebra"]))
    assert felt.shape == (3, len(EMOTIONS))
    assert clear_moods(felt)[:2] == ["sad", "happy"]
    assert abs(felt[2, EMOTIONS.index("sad")] - felt[2, EMOTIONS.index("happy")]) < 0.2


def test_scripts_teach_by_summary_and_cues_and_moments_of_all_emotions_are_taught_besides() -> None:
    step = {"skill": "sitdown", "caption": "hands on thighs", "furniture": "chair"}
    row = {"id": "one", "summary": "Tears.", "emotion": "sad", "room": "study", "keyframes": [step], "cues": ["weeps"]}
    one = ShortScript.model_validate(row)
    texts, emotions = lessons([one])
    assert (texts[:2], emotions[:2]) == ([one.summary, "weeps"], ["sad", "sad"])
    assert set(emotions[2:]) == set(moments()) == set(EMOTIONS)
    assert len(set(texts)) == len(texts) == len(emotions)


def test_a_kind_of_emotion_shows_where_no_single_one_is_far_ahead() -> None:
    row = np.zeros((1, len(EMOTIONS)))
    row[0, [EMOTIONS.index("sad"), EMOTIONS.index("angry"), EMOTIONS.index("happy")]] = 0.4, 0.35, 0.3
    assert clear_moods(row) == ["sad"]
    row[0, EMOTIONS.index("angry")] = 0.1
    assert clear_moods(row) == [None]
