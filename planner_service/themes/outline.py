"""An outline as lines: what arrows, bullets, slashes, numbers, labels and clock times part has a line of its own."""

from __future__ import annotations

import re
from typing import Final

from planner_service.themes.lexicon import verb_of

_ARROW: Final = re.compile(r"\s*(?:-+>|=+>|[→⇒➔➜➤▶▸►])\s*")
_MARK: Final = re.compile(r"^\s*(?:[-*•·▪◦✓✔☐]|\[[ xX]?\])\s+(?=\S)", re.MULTILINE)
_LETTER: Final = re.compile(r"(?:(?<=^)|(?<=\s))\(?[a-h]\)\s+")
_NUMBER: Final = re.compile(r"(?:(?<=^)|(?<=\s))\(?(\d{1,2})[.)]\s+(?=[A-Za-z])")
_FEWEST_LETTERS: Final = 2
_SLASH: Final = re.compile(r"(?P<mark>[.,;:!?…—–-]?)[ \t]+/{1,2}(?:[ \t]+|(?=\n|$))")
"""The end of a line of verse, or between notes."""
_NUMBERED: Final = re.compile(
    r"(?:(?<=^)|(?<=\n)|(?<=[.!?;,] ))(?:beat|shot|frame|panel|scene|act|part|sub-?step|step|state|phase|stage|level"
    r"|event|action|task|slide|image|day)[ #]*(?:\d{1,2}|[A-H]|[IVX]{1,4}|one|two|three|four|five|six)(?:[ \t]*[:.)]"
    r"|[ \t]+[-–—])[ \t]+(?=\S)",
    re.IGNORECASE,
)
"""What the parts of an outline are counted by: "Beat 1: …", "ACT II - …"."""
_CLOCK: Final = re.compile(
    r"^[ \t]*\d{1,2}(?:[:.h]\d{2}(?::\d{2})?(?:[ \t]?[ap]\.?m\b\.?)?|[ \t]?[ap]\.?m\b\.?)[ \t]*"
    r"[-–—:,]?[ \t]+(?=[A-Za-z])",
    re.MULTILINE | re.IGNORECASE,
)
"""A line of a diary or a cue sheet: "8:15 brushes teeth", "7 am - wake up"."""
_POLITE: Final = re.compile(
    r"(?:(?<=^)|(?<=\n)|(?<=[.!?;] ))(?:(?:please|kindly)|(?:can|could|would|will) you(?: please)?"
    r"|(?:i want|i need|i(?: would|'d|’d) like) you to|your (?:task|job|goal) is to|(?:the )?instructions?:"
    r"|(?:you|(?:the )?(?:agent|robot|avatar|character|player|user|actor|human)) "
    r"(?:should|must|ha(?:s|ve) to|needs? to))"
    r"[,:]?[ \t]+(?:first |then )?(?P<verb>[a-z]+)\b",
    re.IGNORECASE,
)
_COUNTED: Final = re.compile(
    r"(?:(?<=^)|(?<=\n)|(?<=[.!?;] ))(?:second|third|fourth|fifth|last)(?:ly)?,[ \t]+(?=\w)", re.IGNORECASE
)
_TOLD: Final = frozenset(
    ("tell", "show", "give", "help", "write", "make", "explain", "recommend", "translate", "say", "create", "describe",
     "film", "animate", "generate", "do", "let", "be", "have", "see", "ignore", "forget", "stop", "use")
)  # fmt: skip
"""What is asked of whoever makes the film, and done by nobody in it."""


def lines_of(theme: str) -> str:
    """The theme with a line for each part of an outline, without what marks and counts the parts; prose stays as it
    is."""
    text = _ARROW.sub("\n", theme)
    if len(_LETTER.findall(text)) >= _FEWEST_LETTERS:
        text = _LETTER.sub("\n", text)
    if _NUMBER.findall(text)[:2] == ["1", "2"]:
        text = re.sub(r"[ \t]*[,;:](?=\s*(?:\n|$))", "", _NUMBER.sub("\n", text))
    notes = not any(one["mark"] for one in _SLASH.finditer(text)) or _NUMBERED.search(text)
    end = "\n" if notes else " "
    text = _NUMBERED.sub("\n", _SLASH.sub(lambda one: one["mark"] + end, text))
    text = _POLITE.sub(_asked, _CLOCK.sub("", _MARK.sub("", _COUNTED.sub("Then ", text))))
    text = "\n".join(filter(None, (line.strip() for line in text.split("\n"))))
    return text.replace(":\n", ": ")  # what it is called


def _asked(one: re.Match[str]) -> str:
    """What somebody is politely asked to do, as they are told to do it: "could you | walk to the table"."""
    verb = one["verb"].lower()
    return one["verb"] if verb_of(verb) == verb and verb not in _TOLD else one[0]
