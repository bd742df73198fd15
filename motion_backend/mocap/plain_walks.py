"""Which clips of a collection are plain walking: what people do who just go somewhere."""

from __future__ import annotations

import re
from typing import Final

from motion_backend.mocap.dataset_file import Dataset, Entry
from motion_backend.motion import Skill

PLAIN: Final = re.compile(r"neutral|slow|brisk|normal|^$")
ODD: Final = re.compile(
    r"\b(?:run|jog|crawl|sneak|stealth|zombie|hop|jump|balanc|stagger|exaggerat|strid)", re.IGNORECASE
)
"""Walks that are not plain, by their style or caption; a caption may say what the style does not."""
RECORDED: Final = "real mocap"
"""Kind of clips that a camera or a suit recorded."""
NOT_RECORDED: Final = frozenset({"hand-keyed", "model-generated", "matched", "procedural"})
"""Kinds of clips that nobody ever did; of others it is not known."""


def is_plain_walk(entry: Entry) -> bool:
    """Whether a clip is of walking and neither its style nor its captions say anything else of it."""
    plain = bool(PLAIN.search(entry.style.lower())) and not ODD.search(" ".join((entry.style, *entry.captions)))
    return entry.skill == Skill.LOCO and plain


def recorded_walks(dataset: Dataset, split: str | None = None) -> list[Entry]:
    """Plain walks as people did them: nothing keyed or made, nothing changed; of the people of one split or of all."""
    return [
        entry
        for entry in dataset.entries
        if is_plain_walk(entry)
        and entry.kind not in NOT_RECORDED
        and not entry.changed
        and split in (None, entry.split)
    ]
