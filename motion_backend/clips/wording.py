"""Words for clips: which skill a file's name tells, which emotion its style, and five ways to say what is done."""

from __future__ import annotations

import re
from typing import NamedTuple

from motion_backend.procedural.moods import feeling

WAYS = 5
"""Captions a clip gets (SIMS 4.1)."""
_SKILLS = (
    ("getup", r"lie.?stand|get.?up|floor.?stand|\brises? from the (floor|ground)"),
    ("liedown", r"lie.?down|lying down|lie.?idle|lie.?pose|sleep|death"),
    ("standup", r"stand.?up|sitting.?exit|chair.?stand"),
    ("sitdown", r"sit"),
    ("touch", r"pick.?up|interact|touch|reach|push(?!.?up)|fixing|use.?item|consume|wash|point|grab"),
    ("squat", r"squat"),
    ("loco", r"walk|run|jog|sprint|crawl|sneak|crouch.?fwd|strafe|zombie|stealth|hop\b|march|step"),
    ("idle", r"idle|wave|stand|greet|talk|listen|pose|bow|nod|angry|tired|confused|dizzy|shiver|reject|victory"),
)


class Verb(NamedTuple):
    """Something a body does, in four forms."""

    plain: str
    third: str
    doing: str
    noun: str


_VERBS = (
    (r"\bcrawl", Verb("crawl", "crawls", "crawling", "crawl")),
    (r"\b(jog)", Verb("jog", "jogs", "jogging", "jog")),
    (r"\b(run|sprint)", Verb("run", "runs", "running", "run")),
    (r"\b(sneak|stealth)", Verb("sneak", "sneaks", "sneaking", "sneaky walk")),
    (r"\b(hop)", Verb("hop", "hops", "hopping", "hop")),
    (r"zombie|stagger", Verb("stagger", "staggers", "staggering", "staggering walk")),
    (r"squat", Verb("squat", "squats", "squatting", "squat")),
    (r"\bwave", Verb("wave hello", "waves hello", "waving hello", "wave hello")),
)
_DEEDS = {
    "loco": Verb("walk", "walks", "walking", "walk"),
    "sitdown": Verb("sit down", "sits down", "sitting down", "sit"),
    "standup": Verb("stand up", "stands up", "standing up", "rise"),
    "liedown": Verb("lie down", "lies down", "lying down", "rest"),
    "getup": Verb("get up", "gets up", "getting up", "getting up"),
    "touch": Verb("reach out", "reaches out", "reaching out", "reach"),
    "squat": Verb("squat", "squats", "squatting", "squat"),
    "idle": Verb("stand", "stands", "standing", "pause"),
}
_MANNERS = (
    (r"zombie", "like a zombie", "zombie-like"),
    (r"sneak|stealth", "quietly", "quiet"),
    (r"slow", "slowly", "slow"),
    (r"brisk|hurr|fast", "in a hurry", "hurried"),
    (r"exaggerat|large", "with large steps", "large-stepped"),
    (r"turn", "with turns", "winding"),
    (r"tired|sleep", "tiredly", "tired"),
    (r"angry", "angrily", "angry"),
    (r"sad", "sadly", "sad"),
    (r"dizzy|drunk", "unsteadily", "unsteady"),
    (r"shiver|cold", "shivering", "shivering"),
    (r"formal", "formally", "formal"),
    (r"backward", "backwards", "backward"),
    (r"friend", "in a friendly way", "friendly"),
    (r"balance", "keeping the balance", "careful"),
)


def skill_of(text: str) -> str:
    """The skill that a clip's name or caption tells of; "other" where it tells of none."""
    plain = text.lower().replace("_", " ")
    return next((skill for skill, pattern in _SKILLS if re.search(pattern, plain)), "other")


def emotion_of(style: str, text: str) -> str:
    """The one of nine emotions that a style stands for."""
    return feeling(style, text)


def ways_to_say(skill: str, style: str, caption: str) -> tuple[str, ...]:
    """Five different captions of one clip: its own first, if it has one, then some made from skill and style."""
    own = re.sub(r"^a person does: ", "", caption.strip())
    told = f"{style} {own}".lower()
    deed = next((verb for pattern, verb in _VERBS if re.search(pattern, told)), _DEEDS.get(skill))
    if deed is None:
        words = own or style or "move"
        made = [f"a person: {words}", f"someone: {words}", f"a body: {words}", f"the motion {words}", words]
    else:
        how, kind = next(((how, kind) for pattern, how, kind in _MANNERS if re.search(pattern, told)), ("", "plain"))
        after = f" {how}" if how and how not in deed.plain else ""
        article = "an" if kind[0] in "aeiou" else "a"
        made = [
            f"{deed.doing}{after}",
            f"{deed.plain}{after}",
            f"someone {deed.third}{after}",
            f"a person is {deed.doing}{after}",
            f"{article} {kind} {deed.noun}",
        ]
    found = [own, *made] if own else made
    return tuple(dict.fromkeys(found))[:WAYS]
