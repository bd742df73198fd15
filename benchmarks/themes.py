"""The seven themes of SIMS 8.2 and Tables 10, 11 and 13, as printed there; and the demo's."""

from __future__ import annotations

import json
import re
from pathlib import Path

import planner_service

FILE = Path(planner_service.__file__).parent / "data" / "evaluation" / "seven_themes.json"
THEMES: dict[str, str] = json.loads(FILE.read_text(encoding="utf-8"))
SEED = 7
"""Of the stories of these."""
LONG = (
    "He wakes up, reads at the desk, sits on the sofa, argues on the phone, drinks, dances, tidies the shelf, "
    "eats at the table, gets angry, calms down and falls asleep in bed."
)
"""A theme whose story lasts for more than a minute."""
MAKEFILE = Path(__file__).resolve().parents[1] / "Makefile"


def demo() -> tuple[str, int]:
    """The theme and the seed of `make demo`, as the Makefile has them."""
    told = dict(re.findall(r"^(THEME|THEME_SEED) \?= (.+)$", MAKEFILE.read_text(encoding="utf-8"), re.MULTILINE))
    return told["THEME"], int(told["THEME_SEED"])
