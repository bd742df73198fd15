"""Theme → beats → one long script that a body can act out, by the method that is asked for (SIMS 3.2, 10)."""

from __future__ import annotations

from collections.abc import Sequence

from planner_service.composition import llm_planner
from planner_service.composition.beat_planner import serve_beats
from planner_service.composition.direct_generation import direct_by_rules
from planner_service.composition.request import RULES, Record, Request
from planner_service.composition.script_retrieval import match
from planner_service.llm.protocol import LanguageModel, ModelError
from planner_service.scripts.script import Beat, Keyframe, LongScript, PlannedKeyframe
from planner_service.scripts.script_library import ScriptLibrary
from planner_service.scripts.script_repair import repair
from planner_service.themes.beats import beats_of


def compose(
    theme: str,
    library: ScriptLibrary,
    request: Request | None = None,
    model: LanguageModel | None = None,
    insist: bool = False,
) -> LongScript:
    """The long script of a theme, checked and repaired; `planner` names who planned it.

    A model finds the events and arranges what was retrieved for them ("matching": it never writes keyframes), or
    writes the keyframes itself ("direct"). Where it gives no usable answer the rules take over and `repairs`
    says why; with `insist` its ModelError is raised instead.
    Raises ThemeError when no event of the theme is understood.
    """
    request = request or Request()
    record = Record(insist=insist)
    if request.method == "auto":
        return serve_beats(theme, library, request, model, record)
    by_rules = [read.beat for read in beats_of(theme)]
    if request.method == "direct":
        return _direct(theme, by_rules, model, request, record)
    return match(theme, by_rules, library, request, model, record)


def _direct(
    theme: str, by_rules: Sequence[Beat], model: LanguageModel | None, request: Request, record: Record
) -> LongScript:
    """Keyframes without the library: a model's, whose captions the body reads word by word, else those of the rules."""
    keyframes, planner = direct_by_rules(by_rules), RULES
    if model is not None:
        try:
            written = llm_planner.direct(model, theme)
        except ModelError as error:
            record.failed("keyframes written", error)
        else:
            keyframes = tuple(PlannedKeyframe.model_validate(keyframe.model_dump()) for keyframe in written)
            planner = f"llm:{model.name}"
    acted, repairs = repair(keyframes)
    return LongScript(
        theme=theme,
        beats=tuple(by_rules),
        short_scripts=(),
        keyframes=acted,
        repairs=(*record.notes, *repairs),
        method="direct",
        planner=planner,
        seed=request.seed,
    )


def script_of(keyframes: Sequence[Keyframe], theme: str, seed: int = 0) -> LongScript:
    """The long script of keyframes that somebody else wrote: checked and repaired, nothing retrieved."""
    acted, repairs = repair([PlannedKeyframe.model_validate(keyframe.model_dump()) for keyframe in keyframes])
    return LongScript(
        theme=theme, beats=(), short_scripts=(), keyframes=acted, repairs=tuple(repairs), method="direct",
        planner="given", seed=seed,
    )  # fmt: skip
