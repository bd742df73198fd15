"""The seven themes of SIMS 8.2 and Tables 10, 11 and 13, as printed there; and the demo's."""

from __future__ import annotations

import re
from pathlib import Path

THEMES = {
    "weekend": "A person relaxes at home during the weekend, drinks cokes, and reads books.",
    "interview": "A person is happy at first, but he is told in the phone that he fails the job interview and becomes "
    "very depressed.",
    "afternoon": "A person enjoys a relaxed afternoon at home.",
    "picnic": "A person is dressing up and feels excited about the picnic tomorrow.",
    "lottery": "A character is sitting on the chair and becomes excited when he finds that he won a lottery, so he run "
    "excitedly around the room. And he relaxes on the sofa.",
    "jewellery": "A character is searching for the jewellery under the bed. He finds it and he becomes excited, run "
    "around the house. He decided to drink a bottle of wine the celebrate and becomes drunken and rests on the sofa..",
    "photograph": "The character ponders over an old photograph and reflects on memories in the living room. He then "
    "remembers his dead wife and becomes sad. He then decides to drink a bottle of wine and becomes drunken and rests "
    "on the sofa.",
}
SEED = 7
"""Of the stories of these."""
MAKEFILE = Path(__file__).resolve().parents[1] / "Makefile"


def demo() -> tuple[str, int]:
    """The theme and the seed of `make demo`, as the Makefile has them."""
    told = dict(re.findall(r"^(THEME|THEME_SEED) \?= (.+)$", MAKEFILE.read_text(encoding="utf-8"), re.MULTILINE))
    return told["THEME"], int(told["THEME_SEED"])
