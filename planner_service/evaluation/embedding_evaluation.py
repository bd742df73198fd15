"""Whether words find their motion: retrieval over clips that the embedding has not learned from, ours and people's."""

from __future__ import annotations

from collections.abc import Sequence

from motion_backend.embedding.caption_retrieval import Retrieval, retrieve
from motion_backend.embedding.text_motion_embedding import TextMotionEmbedding
from motion_backend.mocap.dataset_file import Entry
from motion_backend.motion import Skill
from planner_service.evaluation.caption_classifier import group_of
from planner_service.scripts.captions import captions


def acted_retrieval(embedding: TextMotionEmbedding, entries: Sequence[Entry]) -> Retrieval:
    """Clips of `act_clips` among the groups of all captions that the body knows: those of `sims evaluate body`."""
    groups = {caption: group_of(Skill(skill), caption) for skill, some in captions().items() for caption in some}
    motions = embedding.motions([entry.motion for entry in entries])
    own = [group_of(Skill(entry.skill), entry.captions[0]) for entry in entries]
    return retrieve(motions, own, embedding.texts(list(groups)), list(groups.values()))


def recorded_retrieval(embedding: TextMotionEmbedding, entries: Sequence[Entry]) -> Retrieval:
    """Recorded clips among their own captions: what two clips say alike is one group."""
    own = [entry.captions[0] for entry in entries]
    asked = sorted(set(own))
    return retrieve(embedding.motions([entry.motion for entry in entries]), own, embedding.texts(asked), asked)
