"""What users did wrong, said to them: one line of printable letters, on a terminal, in a log or over HTTP.

What a user can do wrong is a `UserError` (`scene_graphs/errors.py`), whichever package says it; anything else is a
fault of ours.
"""

from __future__ import annotations


def explain(error: BaseException) -> str:
    """One line naming what was wrong and what would be right, safe to show on a terminal."""
    return one_line(str(error))


def printable(text: str, most: int = 100) -> str:
    """At most that many letters on one line, control characters and broken ones written as escapes."""
    read = 4 * most
    """Blanks are joined: a text longer than this is not looked through to its end."""
    line = one_line(text[:read])
    return line if len(line) <= most and len(text) <= read else line[: most - 1] + "…"


def one_line(text: str) -> str:
    """All of a text on one line, what cannot be printed written as escapes."""
    line = " ".join(text.split())
    return "".join(letter if letter.isprintable() else letter.encode("unicode_escape").decode() for letter in line)
