"""The seven themes of SIMS 8.2 and Tables 10, 11 and 13, as the paper prints them, slips of the pen included."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Final

import planner_service

FILE: Final = Path(planner_service.__file__).parent / "data" / "evaluation" / "seven_themes.json"
SEVEN: Final[dict[str, str]] = json.loads(FILE.read_text(encoding="utf-8"))
"""By a name of ours."""
