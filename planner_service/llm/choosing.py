"""The language model that settings name: none, or a scripted one for demonstrations and tests over real HTTP."""

from __future__ import annotations

import json
from pathlib import Path

from planner_service.llm.protocol import LanguageModel
from planner_service.llm.scripted import ScriptedModel
from planner_service.settings import SettingsError


def load_model(name: str) -> LanguageModel | None:
    """The model of `SIMS_LLM_MODEL`; None for an empty name, which means: rules plan and tell.

    "scripted:FILE" answers from a JSON object that maps words of a prompt to the answer (an object, or text).
    SettingsError says what cannot be used.
    """
    if not name:
        return None
    kind, _, rest = name.partition(":")
    if kind != "scripted" or not rest:
        raise SettingsError(f"SIMS_LLM_MODEL: {name!r:.80} is not known; leave it empty for rules, or scripted:FILE")
    try:
        answers = json.loads(Path(rest).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise SettingsError(f"SIMS_LLM_MODEL: {rest} cannot be read: {error}") from error
    if not isinstance(answers, dict) or not all(isinstance(answer, dict | str) for answer in answers.values()):
        raise SettingsError(f"SIMS_LLM_MODEL: {rest} must be a JSON object of prompt words to answers")
    return ScriptedModel(answers)
