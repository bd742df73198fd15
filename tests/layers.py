"""The layers of the tests: which a test belongs to, and that one of the fast layer starts no process and no server.

A test without a marker is fast and runs in this process alone. `service` marks what starts a process: a live service, a
command, PostgreSQL, a browser, Node, a build. `sweep` marks what looks at all of something, where a test of the other
layers looks at a sample, and what asks for much to see that it ends in time: `make test-all` alone runs it.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

SERVICE, SWEEP = "service", "sweep"
MARKED_BY = {SERVICE: (f"mark.{SERVICE}", "DATABASES"), SWEEP: (f"mark.{SWEEP}", "sampled(")}
"""What a file says that has tests of a layer."""
LIVE = {"service", "postgres_server", "postgres_url"}
"""Fixtures that start something."""
STARTS = {"subprocess.Popen", "os.fork", "os.forkpty", "os.exec", "os.posix_spawn", "os.spawn", "os.system"}
"""Events that Python's audit names for a process that is started."""
ASKED_BY_LIBRARIES = {"fc-list", "uname", "ldconfig", "/sbin/ldconfig", "gcc", "cc", "lscpu"}
"""What matplotlib, numba and others ask the system when they are first loaded."""

_running: pytest.Item | None = None


def run(item: pytest.Item | None) -> None:
    """This test runs from now on."""
    global _running
    _running = item


def check_layer(what: str) -> None:
    """Fail the test that runs, if it may not start anything."""
    if _running is not None and _running.get_closest_marker(SERVICE) is None:
        pytest.fail(f"a test that starts {what} is marked with @pytest.mark.{SERVICE}: make test starts nothing")


def refuse(event: str, arguments: tuple[object, ...]) -> None:
    """A hook for `sys.addaudithook`."""
    if event in STARTS and _running is not None:
        program = os.fsdecode(arguments[0]) if arguments and isinstance(arguments[0], str | bytes) else "a process"
        if program not in ASKED_BY_LIBRARIES:
            check_layer(program)


def sampled(rows: Iterable[Any], every: int) -> list[Any]:
    """Rows for `parametrize`: every so many for the fast layer, the others for the sweep."""
    return [
        row
        if number % every == 0
        else pytest.param(*(row if isinstance(row, tuple) else (row,)), marks=pytest.mark.sweep)
        for number, row in enumerate(rows)
    ]


def is_left_out(path: Path, chosen: str) -> bool:
    """Whether nothing in a file can be of what is chosen by marker: it need not be loaded, nor what it imports."""
    if not path.match("test_*.py") or "(" in chosen:
        return False
    text = path.read_text(encoding="utf-8")
    wanted = [mark for mark in MARKED_BY if mark in chosen and f"not {mark}" not in chosen]
    if wanted:
        return not any(words in text for mark in wanted for words in MARKED_BY[mark])
    return f"not {SERVICE}" in chosen and f"\npytestmark = pytest.mark.{SERVICE}\n" in text


def unmarked(items: Iterable[pytest.Item]) -> list[str]:
    """Tests that ask for something live and are not of the layer of what is live."""
    return [
        item.nodeid
        for item in items
        if LIVE & set(getattr(item, "fixturenames", ())) and item.get_closest_marker(SERVICE) is None
    ]
