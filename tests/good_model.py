"""A language model that reads what it is asked and answers well, for tests of what is made of its answers."""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

THEME = "Sam reads a book on the sofa, hears bad news on the phone and lies down on the bed in tears."
EVENTS = ("reads a book on the sofa", "hears bad news on the phone", "lies down on the bed in tears")
TITLE = "A Letter of Glass"
TEXT = (
    "Sam read the whole morning, and the light moved slowly over the wall. Then the telephone rang. After that there "
    "was nothing left to do but to lie down and to weep until the evening came."
)


def answer_to(prompt: str) -> dict[str, Any]:
    """The beats written down for a theme, three events, the last script offered for each, a text of its own; by what
    the prompt asks for."""
    if "say, beat by beat" in prompt:
        return beats_of(theme_in(prompt))
    if "You plan a short film" in prompt:
        moods = ("relaxed", "stressed", "sad")
        return {"events": [{"text": text, "emotion": mood} for text, mood in zip(EVENTS, moods, strict=True)]}
    if "You arrange short scripts" in prompt:
        return {"choices": [{"event": event, "script": script} for event, script in chosen_in(prompt).items()]}
    if "You tell a short story" in prompt:
        return {"title": TITLE, "text": f"{TEXT} {told_in(prompt)}"}
    if "This is a trial" in prompt:
        return {"furniture": "kitchen chair", "legs": 4}
    raise AssertionError(f"nobody taught it to answer {prompt!r:.200}")


@cache
def planned_themes() -> dict[str, dict[str, Any]]:
    """Themes with what a good model answers when it plans their beats, by name; written by hand."""
    files = sorted((Path(__file__).parent / "data" / "good_model").glob("*.json"))
    return {file.stem: json.loads(file.read_text(encoding="utf-8")) for file in files}


def beats_of(theme: str) -> dict[str, Any]:
    """The plan of a theme, whatever stands after it. AssertionError for one that nobody planned."""
    for row in planned_themes().values():
        if theme.startswith(row["theme"]):
            plan: dict[str, Any] = row["plan_beats"]
            return plan
    raise AssertionError(f"nobody planned {theme!r}")


def theme_in(prompt: str) -> str:
    """The theme that a prompt gives."""
    found = re.search(r'<data name="theme">\n(.*?)\n</data>', prompt, re.DOTALL)
    assert found is not None
    return found[1]


def told_in(prompt: str) -> str:
    """A sentence for every piece of furniture in the keyframes that a prompt for a story lists, in their order."""
    name, keyframes = (
        re.search(rf'<data name="{key}">\n(.*?)\n</data>', prompt, re.DOTALL) for key in ("name", "keyframes")
    )
    assert name is not None
    assert keyframes is not None
    pieces = dict.fromkeys(line.rpartition(", ")[2] for line in keyframes[1].splitlines())
    return " ".join(f"{name[1]} was at the {piece}." for piece in pieces)


def chosen_in(prompt: str) -> dict[int, str]:
    """For every event the last script that is offered for it and not taken yet."""
    chosen: dict[int, str] = {}
    for block in re.split(r"^event (?=\d+:)", prompt, flags=re.MULTILINE)[1:]:
        offered = re.findall(r"^  ([a-z0-9-]+) \[", block, flags=re.MULTILINE)
        chosen[int(block.split(":")[0])] = [script for script in offered if script not in chosen.values()][-1]
    return chosen


def seen_in(prompt: str) -> dict[str, Any]:
    """What a good model says of the two scenes of a film, one before and one after the seventh second."""
    number = 1 if "watch scene 1 of" in prompt or '{"scene": 1,' in prompt else 2
    start = 7.0 * (number - 1)
    if "You watch scene" in prompt:
        moment = {"time": start + 1, "who": "Ann", "what": "sits down on the sofa", "emotion": "tired"}
        return {
            "room": "living room", "place": "a flat", "summary": "The character sits down.", "characters": [],
            "objects": ["sofa"], "contacts": [], "moments": [moment],
        }  # fmt: skip
    seat = ("sofa", "armchair")[number - 1]
    step = {"skill": "sitdown", "emotion": "tired", "caption": "sitting still", "furniture": seat}
    words = {"summary": f"The character sits down on the {seat}.", "emotion": "tired", "room": "living_room"}
    return {"scripts": [{"scene": number, "start": start, "end": start + 3, "keyframes": [step], **words}]}
