"""`sims models check`: one small question to the configured language model, and what of it works."""

from __future__ import annotations

import time

import typer
from pydantic import BaseModel, Field
from rich.console import Console

import prompts
from planner_service.llm.asking import ask
from planner_service.llm.choosing import KINDS, Late, load_model
from planner_service.llm.protocol import LanguageModel
from planner_service.llm.served import ServedModel
from planner_service.settings import read_settings

app = typer.Typer(no_args_is_help=True, help="The language model that plans and tells, where one is set.")


class Trial(BaseModel):
    """The answer to `prompts/try_model.md`."""

    furniture: str = Field(min_length=1, max_length=80)
    legs: int = Field(ge=0, le=100)


@app.callback()
def models() -> None:
    """The language model that plans and tells, where one is set."""


@app.command()
def check() -> None:
    """Ask the model of SIMS_LLM_MODEL one small question and say what works."""
    settings = read_settings()
    # Nothing remembered or recorded: it is the model that is tried.
    named = settings.llm_model or ""
    tried = named.partition("=")[2] if named.startswith("record:") else settings.llm_model
    model = load_model(settings.model_copy(update={"llm_cache_mb": 0, "llm_model": tried}))
    console = Console(markup=False, highlight=False)
    if model is None:
        console.print(f"no language model: rules plan and tell. SIMS_LLM_MODEL takes {KINDS}")
        return
    begun = time.perf_counter()
    answer = ask(model, prompts.render("try_model", furniture="a wooden kitchen chair"), Trial)
    console.print(
        f"{model.name} answered in {time.perf_counter() - begun:.1f} s: {answer.furniture}, {answer.legs} legs"
    )
    for line in findings(model):
        console.print(line)
    console.print(f"where it fails: {FAILURES[settings.llm_on_failure]} (SIMS_LLM_ON_FAILURE)")


FAILURES = {"rules": "the rules take over, and the story says so", "error": "the story fails, and says why"}


def findings(model: LanguageModel) -> list[str]:
    """What was seen while a model answered: how it is held to a form, and what it took."""
    if not isinstance(model, ServedModel):
        return []
    spending, found = model.spending, []
    if isinstance(model.source, Late):
        vendor = model.source.vendor
        held = (
            "by a JSON schema, which the server took"
            if vendor.native
            else "by the prompt alone; the server takes no schema"
        )
        found = [f"address: {vendor.address.url}", f"answers are held to their form {held}"]
    cost = f", {spending.dollars:.5f} dollars" if spending.limits.price else ""
    return [*found, f"spent: {spending.tokens} tokens{cost}, of {spending.limits.story_tokens} a story"]
