"""Sayings that mean something else than their words, which sentence features get wrong: what they mean, and feel."""

from __future__ import annotations

import re
from functools import cache
from typing import Final, NamedTuple

_OWN: Final = "(?:his|her|their|its|the|my|your|one's)"


class Idiom(NamedTuple):
    """A saying, plain words for it, and the emotion it shows."""

    saying: str
    meaning: str
    emotion: str


IDIOMS: Final = (
    Idiom(rf"drown\w* {_OWN} (?:sorrow|grief)\w*", "drinks wine to forget the sadness and gets drunk", "drunk"),
    Idiom(r"(?:hit\w*|turn\w* to|reach\w* for) the bottle", "drinks wine and gets drunk", "drunk"),
    Idiom(r"three sheets to the wind|(?:has|had) (?:a few|one) too many", "is drunk and staggers", "drunk"),
    Idiom(
        r"(?:phone|call|telephone)\w*.*\b(?:fail|reject|not get|did(?:n't| not)|turned down)\w*.*"
        r"\b(?:interview|job)\w*",
        "the phone rings with bad news: the job interview was a failure",
        "sad",
    ),
    Idiom(r"(?:fail|flunk|botch)\w*.*\b(?:interview)\w*", "is told that the job interview was a failure", "sad"),
    Idiom(r"(?:fail|flunk)\w*.*\b(?:exam|test|course)\w*", "has failed the exam", "sad"),
    Idiom(
        r"(?:los[et]\w*|fired from) (?:his|her|their|the) job|(?:gets?|got|was|is) (?:fired|sacked|laid off)",
        "gets bad news from the office and has lost the job",
        "sad",
    ),
    Idiom(
        rf"los[et]\w* {_OWN} (?:wife|husband|mother|father|brother|sister|friend|child|son|daughter|dog|cat|love)",
        "remembers somebody dead and is full of grief",
        "sad",
    ),
    Idiom(r"(?:get|got|land|has|have|had)\w* the job", "gets good news: the job is theirs", "happy"),
    Idiom(
        r"(?:did|do|does)(?:n't| not) (?:get|make|win) (?:the|a|an|any|it)\b|miss\w* out on|pass\w* over for",
        "is told that it was a failure, and is disappointed",
        "sad",
    ),
    Idiom(
        r"heart(?:broken| is broken)|(?:got|gets?|was|been) dumped|br(?:eak|oke)\w* up", "weeps for a lost love", "sad"
    ),
    Idiom(r"down in the dumps|feel\w* (?:blue|low|down)|down in the mouth", "feels sad and lonely", "sad"),
    Idiom(r"over the moon|on cloud nine|walk\w* on air|in seventh heaven", "is overjoyed and dances around", "happy"),
    Idiom(r"paint\w* the town red", "celebrates and dances", "happy"),
    Idiom(r"hit\w* (?:the )?(?:jackpot)", "wins the lottery", "happy"),
    Idiom(r"under the weather|come\w* down with", "is sick with a cold", "tired"),
    Idiom(
        r"(?:hit|hits|hitting) the (?:sack|hay)|turn\w* in for|call\w* it a (?:day|night)", "goes to bed tired", "tired"
    ),
    Idiom(r"burn\w* the midnight oil|pull\w* an all-nighter", "works late at night at the desk, tired", "tired"),
    Idiom(r"dead (?:on (?:his|her|their) feet|tired)|worn out|bone tired", "is exhausted", "tired"),
    Idiom(
        rf"blow\w* off steam|hit\w* the (?:roof|ceiling)|see\w* red|los\w* {_OWN} temper|blow\w* {_OWN} top",
        "is furious and storms about",
        "angry",
    ),
    Idiom(
        rf"at {_OWN} wits'? end|at the end of {_OWN} (?:rope|tether)|on edge|butterflies in {_OWN} stomach",
        "is stressed and paces up and down",
        "stressed",
    ),
    Idiom(rf"climb\w* the walls|bit\w* {_OWN} nails", "waits, stressed and restless", "stressed"),
    Idiom(r"against the clock|in a (?:rush|hurry)|running late|in no time", "is late and hurries", "hurried"),
    Idiom(
        rf"put\w* {_OWN} feet up|let\w* {_OWN} hair down|takes? it easy|kick\w* back|veg\w* out",
        "relaxes and enjoys doing nothing",
        "relaxed",
    ),
    Idiom(rf"turn\w* {_OWN} (?:room|house|place) upside down", "searches everywhere in a hurry", "hurried"),
)


def idiom_in(text: str) -> Idiom | None:
    """The first of `IDIOMS` found in the text."""
    for idiom in IDIOMS:
        if _pattern(idiom.saying).search(text):
            return idiom
    return None


@cache
def _pattern(saying: str) -> re.Pattern[str]:
    return re.compile(rf"\b(?:{saying})", re.IGNORECASE)
