"""The commands of `sims`, each imported when it is asked for: what one does not use, one does not wait for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

import typer
from typer.core import TyperGroup

if TYPE_CHECKING:
    from typer._click import Command, Context, HelpFormatter

PLAIN: Final[dict[str, Any]] = {"add_completion": False, "rich_markup_mode": None, "pretty_exceptions_enable": False}
"""How all help is written."""
COMMANDS: Final = {
    "story": ("story:story", "Make a story of a theme: script, home, text, motion, film"),
    "play": ("play:play", "Act out a script of your own"),
    "cast": ("cast_command:cast_command", "List who plays in stories, and what there is to wear"),
    "captions": ("captions_command:captions_command", "List what the body can do, in words"),
    "extract": ("extract_command:extract", "Take short scripts out of a film, subtitles or a text"),
    "record": ("record_command:record", "Record what a language model answers, to be replayed"),
    "task": ("tasks:task", "Break an instruction into steps, and act it out"),
    "routine": ("tasks:routine", "Plan what to do in a room, without end"),
    "serve": ("service:serve", "Serve the HTTP API and the page, with their workers"),
    "mcp": ("mcp:mcp", "Offer the service to an agent as tools (MCP)"),
    "worker": ("service:worker", "Make stories for a service that runs elsewhere"),
    "jobs": ("service:jobs", "Stories in the making, and taking them up again"),
    "scripts": ("scripts:app", "Search, check and extend the library of short scripts"),
    "layouts": ("layouts:app", "List, draw, check, import and generate furnished rooms"),
    "models": ("service:app", "The language model that plans and tells, if one is set"),
    "evaluate": ("evaluate:app", "Measure the planner, and the body in many rooms"),
    "clips": ("clips:app", "Recorded and keyed motion, retargeted to our body"),
    "train": ("train:app", "Train the networks that move a body"),
}
"""By name: the module here and what in it is the command, or the group of commands; and what it does, in a line."""


class LateCommands(TyperGroup):
    """All commands of `sims`."""

    def __init__(self, **given: Any) -> None:
        super().__init__(**given)
        self.commands = _Commands()  # type: ignore[assignment]  # nobody adds one

    def format_commands(self, ctx: Context, formatter: HelpFormatter) -> None:
        """Say what there is without importing it."""
        del ctx
        with formatter.section("Commands"):
            formatter.write_dl([(name, does) for name, (_, does) in COMMANDS.items()])


class _Commands(Mapping[str, "Command"]):
    def __getitem__(self, name: str) -> Command:
        return _imported(name, *COMMANDS[name][0].split(":"))

    def __iter__(self) -> Iterator[str]:
        return iter(COMMANDS)

    def __len__(self) -> int:
        return len(COMMANDS)


@cache
def _imported(name: str, module: str, what: str) -> Command:
    found = getattr(import_module(f"planner_service.cli.{module}"), what)
    alone = typer.Typer(**PLAIN)
    alone.callback()(lambda: None)
    if isinstance(found, typer.Typer):
        alone.add_typer(found, name=name)
    else:
        alone.command(name)(found)
    group = typer.main.get_command(alone)
    assert isinstance(group, TyperGroup)
    return group.commands[name]
