"""Windows and doors in the words of a theme, which are no furniture: who looks out, opens one, comes in."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final, Literal

from motion_backend.motion import Skill

Kind = Literal["window", "door"]
"""Its name is the object id of what is touched there as well."""
_LOOKS: Final = re.compile(
    r"\bwindows?\b|\b(?:look|gaz|star|peer|watch|glanc)\w*\b.*\b(?:outside|street|garden|rain|snow|sunset|sunrise|sky"
    r"|stars|moon)\b",
    re.IGNORECASE,
)
_HANDLES: Final = re.compile(
    r"(?<!\bthe )(?<!\ban )(?<!\bher )(?<!\bhis )(?<!\btheir )"  # but not "by the open window"
    r"\b(?:open|clos|shut|draw|drew|pull|part|fling|flung|throw|threw|crack|latch|unlatch|wip|clean|wash)\w*\s"
    r"(?:(?!by|at|near|beside|under|from|to|on|in\b)\w+\s){0,3}(?:windows?|curtains?|blinds?|shutters?)\b",
    re.IGNORECASE,
)
_OF_A_HOUSE: Final = (
    r"(?:(?:the|a|an|his|her|their|my|its|front|back|outer|heavy|street|kitchen|bedroom|bathroom"
    r"|garden|balcony|garage|cellar|study|room) )*"
)
_OPENS: Final = re.compile(
    r"\b(?:open|clos|shut|slam|bang|lock|unlock|bolt|unbolt|latch|unlatch|answer|push|pull|kick|yank|throw|threw|fling|flung|swing|swung"
    rf"|get|knock|check|tr(?:y|ies|ied))\w*\s(?:\w+ly\s)?(?:(?:at|on|against|behind) )?{_OF_A_HOUSE}"
    r"(?:doors?|doorbell|bell|doorknob|door handle)\b(?! of)"
    r"|\banswer\w* (?:the|a) knock\b"
    r"|\bknock(?:s|ed|ing)?(?: (?:again|once|twice|thrice|softly|loudly|gently|timidly|harder))*(?=$|[,;])"
    r"|\blet(?:s|ting)? (?:(?:the|a|his|her|their|my) )?"
    r"(?:cat|dog|guests?|friends?|him|her|them|visitors?) (?:in|out)\b",
    re.IGNORECASE,
)
_TO_THE_DOOR: Final = re.compile(
    rf"\b(?:to|at|by|near|behind|towards?|for) {_OF_A_HOUSE}(?:door|doorway|entrance)(?!\w| of)"
    r"|\b(?:see|check|look) who\b",
    re.IGNORECASE,
)
_GOES_OUT: Final = re.compile(
    rf"\b(?:out|through) (?:of |by )?{_OF_A_HOUSE}(?:door|doorway)(?!\w| of)"
    r"|(?:^|; )(?:\w+ly )?(?:leav(?:e|es|ing)|left)(?=$|[,.;]| (?:again|alone|early|\w+ly|without|for"
    r"|(?:the|his|her|their) (?:house|home|flat|apartment))\b)"
    r"|\b(?:go|went|run|ran|walk|storm|rush|hurr|dash|slip|sneak|stomp|head)\w* out(?=$|[,.;]| (?:again|quickly|without"
    r"|into the (?:rain|night|street|cold|snow|garden)|of the (?:house|flat|apartment|home))\b)",
    re.IGNORECASE,
)
_LEAVES_THE_ROOM: Final = re.compile(
    r"\b(?:out of|leav(?:e|es|ing)|left) (?:the|his|her|their|my) (?:room|bedroom|kitchen|bathroom|study|office)"
    r"(?=$|[,.;!])",
    re.IGNORECASE,
)
_TO_THE_WINDOW: Final = re.compile(
    r"\b(?:to|towards?|over to) (?:the|a|an|his|her|their|my|its) (?:\w+ )?windows?(?!\w| (?:sill|seat))", re.IGNORECASE
)
_COMES_IN: Final = re.compile(
    r"\b(?:com|came|get|got|arriv|return|walk|step|storm|burst|stumbl|stagger|rush|hurr|bound|trudg|stomp|sneak|slip)\w*"
    r"\b(?:(?!\b(?:and|then|to)\b)[^,;.])*?\b(?:home|indoors|through the (?:front )?door|from (?:work|school)"
    r"|(?:in|inside)(?=$|[,.;]| (?:late|early|from|through|after|with|and|at|again|\w+ly|tired|drunk|soaked|wet)\b)"
    r"|from (?:the|a|his|her|their) (?:\w+ )?(?:shift|office|shop|funeral|party|school|hospital|walk|run|trip|date))\b"
    r"|^(?:\w+ )?(?:(?:gets|got) home|(?:gets|got|is|was) back(?=$|[,.;]| (?:home|from|late|early|at|again)))\b"
    r"|\benters? (?:the )?(?:house|home|flat|apartment|room)\b",
    re.IGNORECASE,
)
_NOT_IN: Final = re.compile(
    r"\b(?:in|inside) (?:the|a|an|his|her|their|my|bed|circles?|front|silence|despair|pain)\b", re.IGNORECASE
)
"""Where one is, or how, and not that one comes in."""


_HANDLES_IT: Final = re.compile(
    r"\b((?:open|clos|shut|slam|bang|lock|unlock|bolt|latch|crack|push|pull|fling|throw)\w*) (it)\b", re.IGNORECASE
)
_BEGINS_SO: Final = re.compile(r"(?:open|clos|shut|unwrap|unfold|unseal)\w* (?:it|them)\b", re.IGNORECASE)
_MAY_BE_OPENED: Final = re.compile(
    r"\b(?:(window|curtain|blind|shutter)s?|(door)s?|letters?|envelopes?|parcels?|packages?|presents?|gifts?|box(?:es)?"
    r"|drawers?|books?|diary|album|fridge|refrigerator|freezer|cupboards?|wardrobe|closet|cabinet|chest|bags?|suitcase|case"
    r"|jars?|bottles?|cans?|tins?|lid|oven|microwave|laptop|umbrella|safe|locker)\b",
    re.IGNORECASE,
)


def spelt_out(said: str, before: Sequence[str]) -> str:
    """Words with the window or door that "it" means in them, of what was said before, the last last: who stands at the
    window "opens | the window"."""
    if not _HANDLES_IT.search(said):
        return said
    for text in reversed([*before, said]):
        named = [*_MAY_BE_OPENED.finditer(text)]
        if named:
            meant = next(filter(None, named[-1].groups()), "").lower()
            return _HANDLES_IT.sub(rf"\1 the {meant}", said) if meant else said
    return said


def opening_of(skill: Skill, said: str) -> Kind | None:
    """Which opening the words of a keyframe, its caption or the theme's, ask for: to stand at it, or to touch it."""
    if skill is Skill.TOUCH:
        return "window" if _HANDLES.search(said) else "door" if _OPENS.search(said) else None
    if skill is Skill.LOCO:
        return "window" if _LOOKS.search(said) else "door" if _TO_THE_DOOR.search(said) or goes_out(said) else None
    return None


def meant_by_it(said: str, before: Sequence[str]) -> str:
    """What "it" is in words that begin with opening or closing it: the last named before that can be opened, a diary or
    a door; "" where that is unknown."""
    if not _BEGINS_SO.match(said):
        return ""
    named = (match[0] for text in reversed(before) for match in reversed([*_MAY_BE_OPENED.finditer(text)]))
    return next(named, "").lower()


def goes_to_window(said: str) -> bool:
    """Whether a walk leads to a window, by the theme's words: "carries it to the window"."""
    return bool(_TO_THE_WINDOW.search(said))


def goes_out(said: str) -> bool:
    """Whether somebody leaves the home, by the theme's words: "runs out of the door"."""
    return bool(_GOES_OUT.search(said))


def leaves_the_room(said: str) -> bool:
    """Whether somebody leaves a room, by the theme's words: who does nothing after that goes out by its door."""
    return bool(_LEAVES_THE_ROOM.search(said))


def comes_in(said: str) -> bool:
    """Whether somebody comes in from outside, by the theme's words."""
    return bool(_COMES_IN.search(_NOT_IN.sub("", said)))
