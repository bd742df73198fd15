"""What `sims story` prints is as true in a file as on a terminal."""

from __future__ import annotations

from io import StringIO

import pytest
from rich.console import Console

from planner_service.cli.story import _slanted
from planner_service.narration.told import Span, Told

TOLD = Told("Waiting", "Sam sat down. Guests were coming. He slept.", (), (Span(14, 33, ()),))


@pytest.mark.parametrize("terminal", [True, False])
def test_what_is_not_seen_is_told_apart_wherever_it_is_printed(terminal: bool) -> None:
    shown = StringIO()
    console = Console(file=shown, force_terminal=terminal, color_system="standard" if terminal else None, width=200)
    console.print(_slanted(TOLD, console), highlight=False)
    printed = shown.getvalue()
    assert ("*Guests were coming.*" in printed) is not terminal
    assert ("\x1b[" in printed) is terminal, "slanted by the terminal's own means"
    assert "like *this* are" in printed or terminal
    assert "Slanted" not in printed


def test_a_text_that_is_seen_whole_is_printed_as_it_is() -> None:
    console = Console(file=StringIO(), force_terminal=False)
    assert _slanted(Told("Waiting", "Sam sat down.", (), ()), console).plain == "Sam sat down."
