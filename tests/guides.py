"""Guides whose blocks are run: what a block shows, held against what was printed."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator

BLOCK = re.compile(r"^```(\w+) ?([\w.]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def as_pattern(shown: list[str]) -> str:
    """A line of … stands for any lines, … within a line for anything on it."""
    return "".join(
        "(?:.*\n)*?" if line.strip() == "…" else ".*".join(map(re.escape, line.rstrip().split("…"))) + "\n"
        for line in shown
    )


def said_as(shown: list[str], printed: str) -> None:
    bare = "".join(f"{line.rstrip()}\n" for line in printed.splitlines())
    assert re.fullmatch(as_pattern(shown), bare), "shown:\n" + "\n".join(shown) + f"\nprinted:\n{bare}"


def typed(block: str) -> Iterator[tuple[list[str], list[str]]]:
    """The words of each command of a block, and the lines shown for it."""
    for one in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
        command, *shown = one.splitlines()
        yield shlex.split(command), shown
