"""Theme → beats → one long script that a body can act out, by the method that is asked for (SIMS 3.2, 10)."""

from __future__ import annotations

from collections.abc import Sequence

from planner_service.composition import llm_planner
from planner_service.composition.beat_planner import serve_beats
from planner_service.composition.request import Record, Request
from planner_service.composition.script_retrieval import match
from planner_service.llm.protocol import LanguageModel, ModelError
from planner_service.scripts.script import Keyframe, LongScript, PlannedKeyframe
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

    A model plans every beat ("auto"), finds the events and arranges what was retrieved for them ("matching": it never
    writes keyframes), or writes the keyframes itself ("direct": the rules, too, write them without the library). Where
    it gives no usable answer the rules take over and `repairs` says why; with `insist` its ModelError is raised.
    Raises ThemeError when no event of the theme is understood.
    """
    request = request or Request()
    record = Record(insist=insist)
    if request.method == "matching":
        return match(theme, [read.beat for read in beats_of(theme)], library, request, model, record)
    if request.method == "direct":
        written = _written(theme, model, request, record)
        return written or serve_beats(theme, library, request, None, record)
    return serve_beats(theme, library, request, model, record)


def _written(theme: str, model: LanguageModel | None, request: Request, record: Record) -> LongScript | None:
    """The keyframes that a model writes without the library, whose captions the body reads word by word; None without a
    model or a usable answer."""
    if model is None:
        return None
    try:
        written = llm_planner.direct(model, theme)
    except ModelError as error:
        record.failed("keyframes written", error)
        return None
    keyframes, repairs = repair([PlannedKeyframe.model_validate(keyframe.model_dump()) for keyframe in written])
    return LongScript(
        theme=theme, beats=tuple(read.beat for read in beats_of(theme)), short_scripts=(), keyframes=keyframes,
        repairs=(*record.notes, *repairs), method="direct", planner=f"llm:{model.name}", seed=request.seed,
    )  # fmt: skip


def script_of(keyframes: Sequence[Keyframe], theme: str, seed: int = 0) -> LongScript:
    """The long script of keyframes that somebody else wrote: checked and repaired, nothing retrieved."""
    acted, repairs = repair([PlannedKeyframe.model_validate(keyframe.model_dump()) for keyframe in keyframes])
    return LongScript(
        theme=theme, beats=(), short_scripts=(), keyframes=acted, repairs=tuple(repairs), method="direct",
        planner="given", seed=seed,
    )  # fmt: skip
