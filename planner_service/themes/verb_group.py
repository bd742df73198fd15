"""The verbs of a clause from the first auxiliary to the deed: "has not wanted to start reading" is reading, denied."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from planner_service.themes.lexicon import grammar, is_noun, lemma_of, participle, verb_of
from planner_service.themes.theme_words import theme_words
from planner_service.themes.verb_finder import Token, verb_place

_LETTING: Final = frozenset(("let", "make", "force", "allow", "bring"))
_SEEING: Final = frozenset(("find", "catch", "feel", "watch", "see", "discover", "hear", "notice"))
"""Who does so of themselves does what they find themselves doing: "finds herself sitting on the floor"."""
_ONESELF: Final = frozenset(("himself", "herself", "themselves", "themself", "myself", "yourself"))
"""Who lets or makes themselves do a thing does it."""
NEARLY: Final = frozenset(("nearly", "almost"))
"""Adverbs before what is not done after all."""
_GOING_ON: Final = frozenset(("carry", "go", "press", "keep"))
"""Verbs that with "on" say that the deed after them goes on."""
_MAX_WORDS: Final = 6
"""Words within which the deed of an aspect stands: "spends the whole long evening reading"."""


@dataclass
class VerbGroup:
    """What the verbs before a deed say of it."""

    place: int = 0
    """Where the verb of the deed stands."""
    denied: bool = False
    """Whether it is not done, or only wished for."""
    unable: bool = False
    """Whether it cannot be done."""
    perfect: bool = False
    """Whether it had been done before."""


def verb_group(words: Sequence[Token]) -> VerbGroup:
    """The verbs that a clause without its subject begins with."""
    group = VerbGroup()
    while group.place < len(words) and (step := _step(words, group)):
        group.place += step
    group.place = min(group.place, len(words) - 1)
    return group


def _step(words: Sequence[Token], group: VerbGroup) -> int:
    """How many words to go on by, noting what they say; 0 where the deed itself stands."""
    at = group.place
    low, base = words[at].low, verb_of(words[at].low)
    ahead = words[at + 1].low if at + 1 < len(words) else ""
    if low in grammar().denials or low == "cannot":
        group.unable |= low == "cannot" or (at > 0 and words[at - 1].low in ("can", "could"))
        group.denied = True
        return 2 if low in grammar().with_gerund and ahead == "of" else 1
    if low in NEARLY and at == 0 and verb_of(ahead) and not ahead.endswith("ing"):
        group.denied = True
        return 1
    if low == "no" and ahead == "longer":
        group.denied = True
        return 2
    if low in ("should", "might") and verb_place(words[at + 1 : at + 3]) is not None:
        group.denied = True
        return 1
    if low in grammar().do and [token.low for token in words[at + 1 :]] == ["not"]:  # "her husband does not"
        group.denied = True
        return 0
    if low in grammar().auxiliaries and (low in grammar().modals or _verb_follows(words, at) or _hinders(words, at)):
        group.perfect |= low == "had"
        return 1
    after = words[at + 2].low if at + 2 < len(words) else ""
    if (
        base in _LETTING and ahead in _ONESELF and (after == "to" or verb_of(after) == after)
    ):  # "lets himself sit", "forces herself to eat"
        return 3 if [token.low for token in words[at + 2 : at + 3]] == ["to"] else 2
    if base in _SEEING and ahead in _ONESELF and verb_of(after) and (after.endswith("ing") or verb_of(after) == after):
        return 2
    if base in _SEEING and (step := _own_limb(words[at + 1 :])):  # "sees her own hand put the cup down"
        return step
    if low == "used" and ahead == "to":  # "used to play", and does so no more
        group.perfect = True
        return 2
    if low == "had" and ahead == "been":
        group.perfect = True
        return 1
    return _denying_step(words, group, low, base, ahead) or _passing_step(words, at, low, base)


def _own_limb(words: Sequence[Token]) -> int:
    """How many words lead to what a part of somebody's own body does, 0 where none does anything."""
    low = [token.low for token in words[:4]] + [""] * 4
    at = 2 if low[1] == "own" else 1
    does = verb_of(low[at + 1])
    owned = low[0] in ("his", "her", "their", "my", "your") and lemma_of(low[at]) in theme_words()["body"]
    return at + 2 if owned and does and (low[at + 1] == does or low[at + 1].endswith("ing")) else 0


def _denying_step(words: Sequence[Token], group: VerbGroup, low: str, base: str, ahead: str) -> int:
    """Verbs that deny the deed after them, or only wish for it."""
    at = group.place
    near = [token.low for token in words[at : at + 3]]
    base = base or ("like" if low == "like" else "")
    if low == "going" and ahead == "to" and len(near) > 2 and _is_deed(near[2]):
        step = 2
    elif low == "able" and ahead == "to":
        group.unable |= group.denied
        return 2
    elif low in ("unable", "about", "afraid", "too", "supposed", "meant") and "to" in near:
        group.unable |= low == "unable"
        step = near.index("to") + 1
    elif base in ("decide", "try", "choose", "prefer", "promise") and ahead == "not":
        step = 3 if len(near) > 2 and near[2] == "to" else 2
    elif ahead in ("to", "from") and base in grammar().refusals | (_wishes(words[:at]) if ahead == "to" else set()):
        step = 2
    elif base == "skip" and {*near[1:]} & theme_words()["skipped"]:  # "skips breakfast", not "skips across the room"
        group.denied = True
        return 0
    elif base in ("stop", "help") and ahead.endswith("ing") and group.denied:  # who cannot stop doing it does it
        group.denied = group.unable = False
        return 1
    elif ahead.endswith("ing") and base in grammar().refusals | {"consider", "imagine", "stop"}:
        step = 1
    else:
        return 0
    group.denied = True
    return step


def _wishes(before: Sequence[Token]) -> frozenset[str]:
    """Verbs that only wish for the deed after them: "would like to sleep", but not "likes to sleep"."""
    would = any(token.low in ("would", "'d") for token in before)
    return grammar().wishes | ({"like", "love"} if would else frozenset())


def _passing_step(words: Sequence[Token], at: int, low: str, base: str) -> int:
    """Verbs that only say how the deed is done, and adverbs."""
    if base in (grammar().aspects | _GOING_ON) and (place := _aspect(words, at)):
        return place - at
    return 1 if low in grammar().adverbs or (low.endswith("ly") and not base) else 0


def _is_deed(word: str) -> bool:
    return verb_of(word) == word and word not in grammar().not_verbs_after_to


def _hinders(words: Sequence[Token], at: int) -> bool:
    """Whether "to be" only tells whether the deed after it can be done: "is not able to sleep"."""
    ahead = [token.low for token in words[at + 1 : at + 4] if token.low not in grammar().adverbs | grammar().denials]
    leads = ahead[:1] in (["able"], ["unable"], ["about"], ["afraid"], ["supposed"], ["meant"])
    return words[at].low in grammar().be and leads and "to" in ahead


def _verb_follows(words: Sequence[Token], at: int) -> bool:
    """Whether an auxiliary is followed by the verb it helps: "is reading", not "is tired" or "has a bath"."""
    known, helper = grammar(), words[at].low
    for token in words[at + 1 : at + 4]:
        low, base = token.low, verb_of(token.low)
        if low in known.denials | known.adverbs | known.auxiliaries or (low.endswith("ly") and not base):
            continue
        if helper in known.be:
            return bool(base) and low.endswith("ing")
        if helper in known.have:
            passed = any(one.low == "been" for one in words[at + 1 : at + 4])
            done = low != base or participle(base) == low  # "has not read"
            return bool(base) and done and (passed or not low.endswith("ing"))
        return bool(base) and (low == base or not is_noun(low))  # "does dishes"
    return False


def _aspect(words: Sequence[Token], at: int) -> int:
    """Where the deed of an aspect stands, 0 where the verb is the deed itself ("goes home", "tries a new recipe")."""
    base = verb_of(words[at].low)
    if base in _GOING_ON and [token.low for token in words[at + 1 : at + 2]] == ["on"]:  # "carries on typing"
        return at + 2 if words[at + 2 :] and words[at + 2].low.endswith("ing") and verb_of(words[at + 2].low) else 0
    for place in range(at + 1, min(at + _MAX_WORDS + 1, len(words))):
        low, before = words[place].low, words[place - 1].low
        if low == "to":
            after = words[place + 1].low if place + 1 < len(words) else ""
            able = place == at + 1 and base not in ("go", "come", "get", "spend", "keep", "finish", "end", "resume")
            return place + 1 if able and verb_of(after) == after else 0
        if low.endswith("ing") and verb_of(low) and base not in ("need", "have", "decide", "help", "use"):
            near = place == at + 1 or (base == "end" and before == "up")
            if near or (base == "spend" and before not in grammar().marks):
                return place
        if base not in ("spend", "end", "keep", "try") or low == "and":
            return 0
    return 0
