"""`sims record THEMES`: a real model plans and tells themes once, so that its answers can be played back in tests."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from planner_service.cli.console import ModelOption
from planner_service.library.library import open_shelves
from planner_service.llm.factory import RULES, load_model
from planner_service.output.story_export import check_writable
from planner_service.pipeline import Pipeline, RequestError, StoryRequest
from planner_service.settings import SettingsError, read_settings
from planner_service.themes.beats import ThemeError, clean

MAX_THEMES = 1000


def record(
    themes: Annotated[Path, typer.Argument(help="A UTF-8 text file with one theme a line.")],
    out: Annotated[Path, typer.Option(help="The recording; what is in it already is not asked again.")],
    model: ModelOption = None,
) -> None:
    """Have a language model plan and tell themes, and write its answers down to be replayed without it."""
    settings = read_settings(llm_model=model)
    if settings.llm_model in RULES:
        raise SettingsError("there is no model to record", "name one with --model", at="SIMS_LLM_MODEL")
    check_writable(out.parent)
    lines = read_lines(themes)
    recording = settings.model_copy(update={"llm_model": f"record:{out}={settings.llm_model}"})
    pipeline = Pipeline(open_shelves(settings), load_model(recording))
    console = Console(markup=False, highlight=False, soft_wrap=True)
    failed = 0
    for number, line in enumerate(lines, 1):
        try:
            planned = pipeline.plan(StoryRequest(theme=clean(line)))
        except ThemeError as error:
            failed += 1
            console.print(f"{number} of {len(lines)}: refused: {error}")
            continue
        console.print(f"{number} of {len(lines)}: {planned.told.title}: {planned.spent}")
    console.print(f"{len(lines) - failed} of {len(lines)} themes recorded; SIMS_LLM_MODEL=replay:{out} plays them back")


def read_lines(file: Path) -> list[str]:
    """The themes in a file, one a line; empty lines and those that begin with # are none. RequestError."""
    try:
        rows = file.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise RequestError(
            f"{file} cannot be read: {error}", "give UTF-8 text, one theme a line", at="THEMES"
        ) from error
    lines = [row.strip() for row in rows if row.strip() and not row.lstrip().startswith("#")]
    if not 0 < len(lines) <= MAX_THEMES:
        raise RequestError(f"{file} has {len(lines)} themes", f"give 1 to {MAX_THEMES}, one a line", at="THEMES")
    return lines
