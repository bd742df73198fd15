"""What two further labellers, handed the beats of labelled themes, would have played: how far fair people agree.

A planner cannot be asked for more than one labeller gets by another's labels.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from importlib import resources
from typing import Final

from planner_service.evaluation.beat_judgement import Judgement
from planner_service.evaluation.labels import LabelledTheme
from planner_service.scripts.script import Beat, Keyframe, LongScript, PlannedKeyframe

FILE: Final = "beats_second_labellers.jsonl"
Plays = tuple[Keyframe | None, ...]
"""One a beat: what the labeller would play first for it, None for what no caption shows."""


def second_labellers() -> dict[str, dict[str, Plays]]:
    """By labeller and id of the theme, what they would play for its beats."""
    found: dict[str, dict[str, Plays]] = {}
    path = resources.files("planner_service").joinpath("data", "evaluation", FILE)
    for line in path.read_text(encoding="utf-8").splitlines():
        row = json.loads(line)
        found.setdefault(row["reader"], {})[row["id"]] = tuple(
            Keyframe(skill=play[0], caption=play[1], furniture=play[2], emotion=play[3]) if play else None
            for play in row["plays"]
        )
    return found


def played(label: LabelledTheme, plays: Plays) -> LongScript:
    """A labeller's plays as a plan of that theme; ValueError where it has other beats."""
    beats = [
        Beat(text=beat.text, why="" if play else "the labeller knows no caption that shows it")
        for beat, play in zip(label.beats, plays, strict=True)
    ]
    keyframes = [
        PlannedKeyframe(**play.model_dump(), beat=index) for index, play in enumerate(plays) if play is not None
    ]
    return LongScript(theme=label.theme, beats=tuple(beats), short_scripts=(), keyframes=tuple(keyframes))


def judged_labellers(labels: Sequence[LabelledTheme]) -> Mapping[str, tuple[Judgement, ...]]:
    """Each labeller's plans of the labelled themes that they have read, judged as the planner's are."""
    return {
        reader: tuple(Judgement(label, played(label, known[label.id])) for label in labels if label.id in known)
        for reader, known in second_labellers().items()
    }
