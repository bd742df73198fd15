"""Words find the motion of our body in rooms that the embedding has never seen."""

from __future__ import annotations

import pytest

from motion_backend.embedding.text_motion_embedding import TextMotionEmbedding
from motion_backend.language import minilm
from motion_backend.motion import Skill
from planner_service.evaluation.body_evaluation import plan_trials
from planner_service.evaluation.captioned_clips import act_clips
from planner_service.evaluation.embedding_evaluation import acted_retrieval
from planner_service.evaluation.trials import Trial
from planner_service.scripts.captions import captions, synonyms
from scene_graphs.layout_library import built_in_index

needs_weights = pytest.mark.skipif(
    minilm.weights_folder() is None,
    reason="the MiniLM weights or torch are not installed",
)
MIN_FIRST = 0.90


def test_a_trial_becomes_a_clip_with_its_caption_first_and_its_synonyms_behind() -> None:
    room = next(layout.id for layout in built_in_index().layouts)
    trials = [Trial(Skill.LOCO, "walk on tiptoes", room, 0)]
    (entry,) = act_clips(trials, 1).entries
    assert entry.captions == ("walk on tiptoes", *synonyms()["loco"]["walk on tiptoes"])
    assert (entry.style, entry.subject, entry.skill) == ("walk on tiptoes", room, "loco")
    assert len(entry.motion) > 30


@needs_weights
@pytest.mark.sweep
def test_nine_in_ten_motions_find_their_own_caption_first_among_all() -> None:
    embedding = TextMotionEmbedding.load()
    known = {Skill(skill): some for skill, some in captions().items()}
    entries = act_clips(plan_trials(known, 1, 1, without=embedding.learned_from), 1).entries
    assert not {entry.subject for entry in entries} & embedding.learned_from
    found = acted_retrieval(embedding, entries)
    assert found.groups > 110
    assert found.first >= MIN_FIRST, found.taken_for
