"""`sims serve`, `sims worker`, `sims jobs …`: the service and what makes its stories.

`sims models check`: one small question to the configured language model, and what of it works.
"""

from __future__ import annotations

import sys
import time
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer
from pydantic import BaseModel, Field
from rich.console import Console

import prompts
from planner_service.cli.console import plain_table
from planner_service.llm.client import ServedModel
from planner_service.llm.factory import KINDS, Late, load_model
from planner_service.llm.ollama_server import ollama_models
from planner_service.llm.protocol import LanguageModel
from planner_service.llm.structured_output import ask
from planner_service.settings import read_settings

jobs = typer.Typer(no_args_is_help=True, help="Stories that wait or are in the making, and taking them up again.")


def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen at (SIMS_HOST; 127.0.0.1).")] = None,
    port: Annotated[int | None, typer.Option(help="Port; 0 takes a free one (SIMS_PORT; 8000).")] = None,
    workers: Annotated[int | None, typer.Option(help="Worker processes (SIMS_WORKERS; 1).")] = None,
    data_dir: Annotated[Path | None, typer.Option(help="Folder of the database (SIMS_DATA_DIR).")] = None,
    database_url: Annotated[str | None, typer.Option(help="PostgreSQL instead of a file (SIMS_DATABASE_URL).")] = None,
) -> None:
    """Serve the HTTP API and the page, with worker processes that make the stories."""
    from planner_service.api.telemetry import configure_logging
    from planner_service.server import serve as run

    settings = read_settings(host=host, port=port, workers=workers, data_dir=data_dir, database_url=database_url)
    configure_logging(settings.log_level, sys.stderr)
    run(settings)


def worker(
    worker_id: Annotated[str | None, typer.Option(help="This worker's own name (SIMS_WORKER_ID; worker-0).")] = None,
    data_dir: Annotated[Path | None, typer.Option(help="Folder of the database (SIMS_DATA_DIR).")] = None,
    database_url: Annotated[str | None, typer.Option(help="PostgreSQL instead of a file (SIMS_DATABASE_URL).")] = None,
    supervised: Annotated[bool, typer.Option("--supervised", hidden=True)] = False,
) -> None:
    """Make stories, one at a time, for a service that runs elsewhere on the same database."""
    from planner_service.api.telemetry import configure_logging
    from planner_service.jobs.worker import run_worker

    settings = read_settings(worker_id=worker_id, data_dir=data_dir, database_url=database_url)
    configure_logging(settings.log_level, sys.stderr)
    run_worker(settings, supervised)


@jobs.command("list")
def list_jobs() -> None:
    """Show the stories that have not ended, and which worker has them."""
    from planner_service.components import open_parts

    parts = open_parts(read_settings())
    table = plain_table("story", "state", "worker")
    found = parts.jobs.unfinished()
    for story_id, state, worker_id in found:
        table.add_row(story_id, state, worker_id or "")
    console = Console(markup=False)
    console.print(table)
    console.print(f"{len(found)} stories not ended", highlight=False)
    parts.close()


@jobs.command()
def resume(
    worker: Annotated[str, typer.Option(help="The id of a worker that is dead and will not start again.")],
) -> None:
    """Hand the stories of a dead worker to the living. If it still lives, its story would be made twice at once."""
    from planner_service.components import open_parts

    parts = open_parts(read_settings())
    found = parts.jobs.unfinished(worker)
    for story_id, _, _ in found:
        parts.jobs.resume(story_id)
    Console(markup=False).print(f"{len(found)} stories of {worker} handed on", highlight=False)
    parts.close()


app = typer.Typer(no_args_is_help=True, help="The language model that plans and tells, where one is set.")


class Trial(BaseModel):
    """The answer to `prompts/try_model.md`."""

    furniture: str = Field(min_length=1, max_length=80)
    legs: int = Field(ge=0, le=100)


@app.callback()
def models() -> None:
    """The language model that plans and tells, where one is set."""


EXTRAS = {
    "llm": ("pydantic_ai", "models over HTTP"),
    "llamacpp": ("llama_cpp", "weights of your own, in a GGUF file"),
    "video": ("av", "films"),
    "usd": ("pxr", "film.usd"),
    "mcp": ("mcp", "agents"),
    "asr": ("faster_whisper", "the speech of films, on this machine"),
}
"""Extras of the package: what each installs, and for what."""


@app.command("list")
def list_models() -> None:
    """Say which language model is set, what an Ollama server on this machine has, and which extras are installed."""
    settings = read_settings()
    console = Console(markup=False, highlight=False, soft_wrap=True)
    model = load_model(settings)
    price = f", {settings.llm_price} dollars a million tokens read/written" if settings.llm_price else ""
    chosen = f"{model.name}{price}" if model is not None else "none, rules plan and tell"
    console.print(f"chosen (SIMS_LLM_MODEL, --model): {chosen}")
    found = ollama_models(settings.ollama_url)
    if found is None:
        console.print(f"no Ollama server answers at {settings.ollama_url} (SIMS_OLLAMA_URL)")
    else:
        console.print(f"Ollama server at {settings.ollama_url}: {len(found)} models")
        for name in found:
            console.print(f"  ollama:{name}")
    for extra, (library, purpose) in EXTRAS.items():
        there = "installed" if find_spec(library) is not None else f'pip install "sims-stories[{extra}]"'
        console.print(f"{extra} ({purpose}): {there}")
    console.print(f"--model and SIMS_LLM_MODEL take {KINDS}, or rules")


@app.command()
def check() -> None:
    """Ask the model of SIMS_LLM_MODEL one small question and say what works.

    Models need the extra llm: pip install "sims-stories[llm]"; one in a file of yours the extra llamacpp.
    """
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
