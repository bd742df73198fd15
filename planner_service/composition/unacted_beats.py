"""Why beats are not acted, in words."""

from __future__ import annotations

from typing import Final

from planner_service.themes.beats import ReadBeat
from planner_service.themes.lexicon import grammar
from planner_service.themes.protagonist import is_person

NOT_ACTED: Final = {
    "undone": "it is not done",
    "memory": "it is remembered, not done now",
    "other": "somebody or something else does it",
    "speech": "it is said; the body does not speak",
}
"""Why beats of these kinds are not acted."""
ONE_PLAYS: Final = "one person is played"
_NOT_THERE: Final = frozenset(("nobody", "no", "none", "somebody", "someone", "everybody", "everyone"))
SPOKEN_OF: Final = "it is only spoken of"
NO_DEED: Final = "it is no deed"
UNSHOWN: Final = "none of the captions shows it"
BESIDE: Final = "the body does something else meanwhile, on its feet"
"""Why what would be done sitting is not, beside that: "irons a shirt while listening to the radio"."""
HELD: Final = "what is held or worn stays as it is"
"""Why what is only held, or is in somebody's own clothes, is not acted."""


def not_acted(read: ReadBeat) -> str:
    """Why a beat of a kind that is not acted is not."""
    if read.clause.aside and read.beat.kind != "memory":
        return SPOKEN_OF
    who = read.beat.who
    nobody = not who or (who.lower() in ("it", "there") and read.clause.verb == "be")
    first, *rest = who.split(" ")
    if read.beat.kind == "other" and is_person(who) and first.lower() not in _NOT_THERE:
        named = " ".join([first.lower() if first.lower() in grammar().marks else first, *rest[:2]])
        named = named if len(rest) <= 2 and grammar().prepositions.isdisjoint(rest) else "somebody else"
        return f"{named} does it: {ONE_PLAYS}"
    return NO_DEED if read.beat.kind == "other" and nobody else NOT_ACTED[read.beat.kind]
