"""The command line: `sims story`, `sims extract`, `sims serve`, `sims scripts …`, `sims layouts …`."""

from __future__ import annotations

import io
import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from planner_service.cli.late_commands import PLAIN, LateCommands
from scene_graphs.errors import UserError

app = typer.Typer(cls=LateCommands, no_args_is_help=True, **PLAIN)


@app.callback()
def sims(
    data_dir: Annotated[
        Path | None, typer.Option(help="Folder of your own scripts and caches (SIMS_DATA_DIR).", envvar="SIMS_DATA_DIR")
    ] = None,
) -> None:
    """A story theme becomes a long script, a furnished home, a told story and a body acting it out."""
    if data_dir is not None:
        os.environ["SIMS_DATA_DIR"] = str(data_dir)


def main() -> None:
    """Run the command line; what a user did wrong ends as one line on standard error and exit code 2."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        # A path need not be UTF-8, nor a terminal show every letter: neither may cost a finished story.
        sys.stdout.reconfigure(errors="backslashreplace")
    # What is multiplied here is small: threads would wait for each other, and the last digits change with their number.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        app(standalone_mode=True)
    except UserError as error:
        from planner_service.user_errors import explain

        print(f"sims: {explain(error)}", file=sys.stderr)  # noqa: T201
        sys.exit(2)
