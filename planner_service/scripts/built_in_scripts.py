"""The short scripts shipped with the package, and the texts that a script is found by."""

from __future__ import annotations

import re
from functools import cache
from importlib import resources
from typing import Final

from planner_service.scripts.script import ShortScript

BUILT_IN: Final = "short_scripts.jsonl"
_SENTENCE: Final = re.compile(r"(?<=[.!?])\s+")


@cache
def built_in() -> tuple[ShortScript, ...]:
    """The short scripts shipped with the package."""
    lines = resources.files("planner_service").joinpath("data", BUILT_IN).read_text(encoding="utf-8").splitlines()
    return tuple(ShortScript.model_validate_json(line) for line in lines if line)


def texts_of(script: ShortScript) -> list[str]:
    """What a script is found by, each once: its summary, the sentences of it, and its cues."""
    return list(dict.fromkeys((script.summary, *_SENTENCE.split(script.summary), *script.cues)))
