"""What the code did when somebody last looked at it, kept as text: whatever changes is seen in the diff, and meant.

`SIMS_TEST_RECORD=1 .venv/bin/python -m pytest tests -k recorded` writes it anew.
"""

from __future__ import annotations

import json
import math
import os
import platform
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import pytest

FOLDER: Final = Path(__file__).parent / "data" / "recorded"
ABSOLUTE, RELATIVE = 2e-3, 1e-2
"""By how much a number may differ: libraries of another version round otherwise."""
NUMBERS: Final = re.compile(r"\[[-\d.,\s]+\]")
"""A list of numbers, which is written in a line."""
MACHINE: Final = "x86_64"
"""Where it was recorded: elsewhere last digits differ, and with them now and then which of two ways is taken."""


def agrees(name: str, found: Mapping[str, Any]) -> None:
    """Hold what was found against what was recorded by that name, or record it."""
    path = FOLDER / f"{name}.json"
    if os.environ.get("SIMS_TEST_RECORD"):
        text = json.dumps(found, indent=1, ensure_ascii=False)
        text = NUMBERS.sub(lambda row: " ".join(row[0].split()), text)
        path.write_text(text + "\n", encoding="utf-8")
        return
    if platform.machine() != MACHINE:
        pytest.skip(f"recorded on {MACHINE}, this is {platform.machine()}")
    differ = list(differences(json.loads(path.read_text(encoding="utf-8")), json.loads(json.dumps(found))))
    assert not differ, "\n".join(differ[:20])


def differences(kept: Any, found: Any, where: str = "") -> Iterator[str]:
    """Where two JSON values differ by more than rounding."""
    if isinstance(kept, dict) and isinstance(found, dict):
        for key in [*kept, *(key for key in found if key not in kept)]:
            yield from differences(kept.get(key), found.get(key), f"{where}/{key}")
    elif isinstance(kept, list) and isinstance(found, list) and len(kept) == len(found):
        for index, pair in enumerate(zip(kept, found, strict=True)):
            yield from differences(*pair, f"{where}/{index}")
    elif isinstance(kept, float) and isinstance(found, float):
        if not math.isclose(kept, found, rel_tol=RELATIVE, abs_tol=ABSOLUTE):
            yield f"{where}: {found}, recorded {kept}"
    elif kept != found:
        yield f"{where}: {found!r}, recorded {kept!r}"
