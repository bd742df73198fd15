"""Short scripts that one source gives more than once: the first is kept and stands for the others."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace

from motion_backend.language.text import SentenceEncoder
from planner_service.extraction.making import Draft
from planner_service.extraction.pieces import PieceRead
from planner_service.scripts.keyframe import ShortScript
from planner_service.scripts.likeness import MIN_DUPLICATE_COSINE, doings_of


@dataclass(frozen=True)
class ToldOnce:
    """What came of a source, each script once."""

    read: PieceRead
    """Where a script was told again, its scene names the first one. A note says how many there were."""
    repeats: Mapping[str, str]
    """Ids of those that are left out, to the one that stands for each."""
    notes: tuple[str, ...]
    """What `read` notes of it, alone."""


def told_once(whole: PieceRead, encoder: SentenceEncoder) -> ToldOnce:
    """Of the scripts with the same keyframes and feelings and nearly the same summary only the first."""
    repeats = _repeats([draft.script for draft in whole.drafts], encoder)
    count = len(repeats)
    notes = (f"{count} script{'s' * (count != 1)} said the same again",) if repeats else ()
    drafts: tuple[Draft, ...] = tuple(draft for draft in whole.drafts if draft.script.id not in repeats)
    scenes = tuple(replace(scene, scripts=stood_for(scene.scripts, repeats)) for scene in whole.scenes)
    return ToldOnce(PieceRead(drafts, scenes, (*whole.notes, *notes), whole.after), repeats, notes)


def stood_for(ids: Sequence[str], repeats: Mapping[str, str]) -> tuple[str, ...]:
    """Ids of scripts, each repeat by the one that stands for it, each once."""
    return tuple(dict.fromkeys(repeats.get(one, one) for one in ids))


def _repeats(scripts: Sequence[ShortScript], encoder: SentenceEncoder) -> dict[str, str]:
    alike: dict[Hashable, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for script in scripts:
        feelings = (script.emotion, *(keyframe.emotion for keyframe in script.keyframes))
        alike[doings_of(script), feelings][script.summary].append(script.id)
    found: dict[str, str] = {}
    for ids_of in alike.values():
        summaries = list(ids_of)
        near = [[True]]
        if len(summaries) > 1:
            vectors = encoder.encode(summaries)
            near = ((vectors @ vectors.T).round(4) >= MIN_DUPLICATE_COSINE).tolist()
        kept: list[int] = []
        for index, summary in enumerate(summaries):
            first = next((one for one in kept if near[index][one]), index)
            if first == index:
                kept.append(index)
            stands = ids_of[summaries[first]][0]
            found |= {one: stands for one in ids_of[summary] if one != stands}
    return found
