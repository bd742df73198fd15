"""The short scripts shipped with the package, and the texts that a script is found by."""

from __future__ import annotations

import re
from functools import cache
from importlib import resources
from typing import Final

from planner_service.scripts.script import ShortScript

BUILT_IN: Final = "short_scripts.jsonl"
CAPTION_WEIGHT: Final = 0.7
_SENTENCE: Final = re.compile(r"(?<=[.!?])\s+")


@cache
def built_in() -> tuple[ShortScript, ...]:
    """The short scripts shipped with the package."""
    lines = resources.files("planner_service").joinpath("data", BUILT_IN).read_text(encoding="utf-8").splitlines()
    return tuple(ShortScript.model_validate_json(line) for line in lines if line)


def texts_of(script: ShortScript) -> dict[str, float]:
    """What a script is found by, with weights: its summary, the sentences of it, its cues and its captions.

    Captions are shared by many scripts, so that at full weight they drown the summaries: hit@1 on 54 phrases of ours
    fell from 50 to 45.
    """
    captions = dict.fromkeys((keyframe.caption for keyframe in script.keyframes), CAPTION_WEIGHT)
    return captions | dict.fromkeys((script.summary, *_SENTENCE.split(script.summary), *script.cues), 1.0)
