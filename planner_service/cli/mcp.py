"""`sims mcp`: the service as tools of an agent, over standard input and output (Model Context Protocol)."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Final

import typer

from scene_graphs.errors import UserError

GRACE: Final = 15.0
"""Seconds that a service of our own has to end."""


class McpError(UserError):
    """The tools cannot be offered; says what is missing."""


def mcp(
    url: Annotated[
        str, typer.Option(help="A service that runs, such as http://127.0.0.1:8000; left out: one of its own.")
    ] = "",
    key: Annotated[str, typer.Option(help="Its key, where it needs one (SIMS_KEY).", envvar="SIMS_KEY")] = "",
    out: Annotated[Path, typer.Option(help="Folder that fetched files go to.")] = Path("out"),
) -> None:
    """Offer the service to an agent as tools; needs the extra mcp: pip install "sims-stories[mcp]".

    An agent can then turn a theme into a script (plan), have it acted (make), wait for it (follow) and get its film or
    another file of it (fetch), over standard input and output. How it is told to run this: docs/commands.md.
    """
    check_extra()
    from planner_service.client import AsyncClient
    from planner_service.mcp_server import serve_tools

    if url and not url.startswith(("http://", "https://")):
        raise McpError(f"{url!r:.80} is no address", "write http://127.0.0.1:8000", at="--url")
    with at_service(url) as address:
        serve_tools(AsyncClient(address, key or None), out).run()


def check_extra() -> None:
    """McpError where the SDK is not installed."""
    if find_spec("mcp") is None:
        raise McpError("agents are spoken to by the MCP SDK, which is not installed", 'pip install "sims-stories[mcp]"')


@contextmanager
def at_service(url: str) -> Iterator[str]:
    """The address of a service: the one that was named, else one of our own, which ends when we do. McpError."""
    if url:
        yield url
        return
    command = [sys.executable, "-m", "planner_service.cli", "serve", "--port", "0"]
    # Its standard output is ours to read: what we write to our own is the protocol.
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True) as service:
        try:
            line = service.stdout.readline() if service.stdout else ""
            ready = re.search(r"ready at (http://\S+)", line)
            if ready is None:
                raise McpError("the service did not start", "what it wrote above says why")
            yield ready[1]
        finally:
            service.terminate()
            try:
                service.wait(GRACE)
            except subprocess.TimeoutExpired:
                service.kill()
