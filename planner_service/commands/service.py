"""`sims serve`, `sims worker`, `sims jobs …`: the service and what makes its stories."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from planner_service.commands.tables import plain_table
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
    from planner_service.serving import serve as run
    from planner_service.telemetry import configure_logging

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
    from planner_service.telemetry import configure_logging
    from planner_service.worker import run_worker

    settings = read_settings(worker_id=worker_id, data_dir=data_dir, database_url=database_url)
    configure_logging(settings.log_level, sys.stderr)
    run_worker(settings, supervised)


@jobs.command("list")
def list_jobs() -> None:
    """Show the stories that have not ended, and which worker has them."""
    from planner_service.parts import open_parts

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
    from planner_service.parts import open_parts

    parts = open_parts(read_settings())
    found = parts.jobs.unfinished(worker)
    for story_id, _, _ in found:
        parts.jobs.resume(story_id)
    Console(markup=False).print(f"{len(found)} stories of {worker} handed on", highlight=False)
    parts.close()
