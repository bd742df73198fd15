"""The command line: `sims story`, `sims extract`, `sims serve`, `sims scripts …`, `sims layouts …`."""

from __future__ import annotations

import io
import sys
from pathlib import Path
from typing import Annotated

import typer

from planner_service.cli import (
    cast_command,
    clips,
    evaluate,
    extract_command,
    layouts,
    play,
    record_command,
    scripts,
    service,
    story,
    tasks,
    train,
    train_embedding,
    train_physics,
)
from planner_service.user_errors import explain
from scene_graphs.errors import UserError

app = typer.Typer(no_args_is_help=True, add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
app.command("story")(story.story)
app.command("play")(play.play)
app.command("cast")(cast_command.cast_command)
app.command("extract")(extract_command.extract)
app.command("record")(record_command.record)
app.command("task")(tasks.task)
app.command("routine")(tasks.routine)
app.command("serve")(service.serve)
app.command("worker")(service.worker)
app.add_typer(service.jobs, name="jobs")
app.add_typer(scripts.app, name="scripts")
app.add_typer(layouts.app, name="layouts")
app.add_typer(service.app, name="models")
app.add_typer(evaluate.app, name="evaluate")
app.add_typer(clips.app, name="clips")
train.app.command("embedding")(train_embedding.embedding)
train.app.command("physics")(train_physics.physics)
app.add_typer(train.app, name="train")


@app.callback()
def sims(
    data_dir: Annotated[
        Path | None, typer.Option(help="Folder of your own scripts and caches (SIMS_DATA_DIR).", envvar="SIMS_DATA_DIR")
    ] = None,
) -> None:
    """A story theme becomes a long script, a furnished home, a told story and a body acting it out."""
    if data_dir is not None:
        import os

        os.environ["SIMS_DATA_DIR"] = str(data_dir)


def main() -> None:
    """Run the command line; what a user did wrong ends as one line on standard error and exit code 2."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        # A path need not be UTF-8, nor a terminal show every letter: neither may cost a finished story.
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        app(standalone_mode=True)
    except UserError as error:
        print(f"sims: {explain(error)}", file=sys.stderr)  # noqa: T201
        sys.exit(2)
