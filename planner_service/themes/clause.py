"""A stretch of a sentence with one verb: who does what, whether it is denied, and what joins it to the one before."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Clause:
    """A stretch of a sentence with one verb."""

    text: str
    """Without whom it is about, in the theme's words: "drinks a glass of wine"."""
    subject: str
    """Who or what does it, as it is written; empty where it goes on from the clause before."""
    verb: str
    """The base form of what is done; empty where there is no verb."""
    lemmas: tuple[str, ...]
    """The base forms of its words from the verb on."""
    joint: str = ""
    """What joins it to the clause before: "and", "before", ","; "to" and "ing" for a second deed of one clause."""
    doer: str = ""
    """Who does it: `subject`, or whoever did what is told before in its sentence."""
    denied: bool = False
    """Whether it is not done, or only wished for."""
    unable: bool = False
    """Whether it is not done since it cannot be: "cannot sleep"."""
    perfect: bool = False
    """Whether it had been done before."""
    absolute: bool = False
    """Whether its verb has no tense, though it says who does it: "coffee going cold beside him"."""
    aside: bool = False
    """Whether it is only spoken of: of a noun ("the letter she had hidden"), or supposed ("if he calls")."""
    quotes: tuple[str, ...] = ()
    """What is said in it."""
    plainly: str = ""
    """What is done in plain words, from its verb on, where the clause says it in others: "washes the dishes"."""
    led: int = 0
    """Words of its text before its written verb, where that is not what it means: of "A yawn | escapes"."""
    sentence: int = 0
    """Index of its sentence in the text."""
    place: int = 0
    """Where in its sentence it is written."""
