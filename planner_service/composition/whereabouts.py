"""Where the things of a story are: where hands were laid on them last, and where they were taken from."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Final

from planner_service.composition.deed_lexicon import Deed, thing_of
from planner_service.composition.furniture_words import pieces_in
from planner_service.themes.clause import Clause
from planner_service.themes.lexicon import lemma_of
from planner_service.themes.protagonist import head_of
from planner_service.themes.theme_words import theme_words
from planner_service.themes.things import things
from scene_graphs.furniture import class_of

Spot = tuple[str | None, str]
"""Room, where it is known, and furniture word."""
_MEANT: Final = frozenset(("it", "them", "one"))
"""Words for what was named before."""
_SUPPORTS: Final = frozenset(("table", "closet", "shelf", "side", "media"))
"""Classes of furniture that only bear or keep a thing: what is done there may be done at another of them."""
_IN_HAND: Final = frozenset(["hold", "clutch", "close", "shut", "fold", "unfold", "refold"])
"""What is so is done in the hands, where the thing is in them."""
_HELD: Final = re.compile(
    r"(?:holding|clutching|hugging|cradling|gripping|grasping|carrying|wearing|still holding"
    r"|[\w\s]+ in (?:his|her|their) hands?$"
    r"|lean(?:ing|s)? (?:heavily )?on (?:a|the|his|her|their) (?:\w+ )?(?:cane|stick|crutch\w*|walker|frame))\b",
    re.IGNORECASE,
)
_WORN: Final = re.compile(
    r"\b(?:in|into|from|out of|inside) (?:(?:his|her|their|my|the|a|each|one) )?(?:\w+ ){0,2}pockets?\b", re.IGNORECASE
)


def is_held(clause: Clause) -> bool:
    """Whether a clause only tells what is in the hands meanwhile: "…, holding the picture"; nobody walks to it."""
    return bool(_HELD.match(clause.text))


def is_worn(clause: Clause) -> bool:
    """Whether hands do it in somebody's own clothes: "found them in his pocket"."""
    return bool(_WORN.search(clause.text))


@dataclass
class Whereabouts:
    """What is known of the places of things, as a story goes on."""

    _spots: dict[str, list[Spot]] = field(default_factory=dict)
    """By noun, every place where it was, in order."""
    _held: set[str] = field(default_factory=set)
    _named: str = ""
    """What was named last."""
    _opened: Spot | None = None
    """Where something has just been opened."""

    def laid(self, clause: Clause, spot: Spot) -> None:
        """Hands do a clause's deed at a place."""
        noun = self._thing(clause)
        opens = clause.verb in theme_words()["opening_verbs"]
        self._opened = spot if opens else self._opened if self._comes_out(clause) else None
        if not noun:
            return
        self._named = noun
        spots = self._spots.setdefault(noun, [])
        spots += [] if spots[-1:] == [spot] else [spot]
        (self._held.add if clause.verb in theme_words()["taking_verbs"] else self._held.discard)(noun)

    def brought(self, clause: Clause, spot: Spot) -> None:
        """A thing is carried somewhere."""
        if noun := self._thing(clause):
            self._named = noun
            self._spots.setdefault(noun, []).append(spot)
            self._held.discard(noun)

    def told(self, clause: Clause) -> None:
        """Where a thing is told to be, and that it is spoken of: "the letter lies on the table"."""
        noun = lemma_of(head_of(clause.subject))
        if noun in things():
            self._named = noun
            self._spots.setdefault(noun, []).extend((None, piece) for piece in pieces_in(clause.text)[:1])

    def in_hand(self, clause: Clause) -> bool:
        """Whether a clause's deed is done in the hands, to what is in them: who took the album "closes the album"."""
        return clause.verb in _IN_HAND and self._thing(clause) in self._held

    def of(self, clause: Clause, deed: Deed) -> Spot | None:
        """Where the thing is that hands do a deed to: where it was last, where it came from for "puts it back"; None
        where that is unknown, or the deed has a place of its own."""
        if deed.named:
            return None
        if self._comes_out(clause):
            return self._opened
        noun = self._thing(clause)
        spots = self._spots.get(noun)
        elsewhere = deed.pieces and class_of(deed.pieces[0]) not in _SUPPORTS
        if elsewhere and clause.verb not in theme_words()["staying_verbs"]:
            return None
        if not spots:
            return None
        if "back" in clause.lemmas or clause.verb in ("return", "replace"):
            return spots[0]
        return None if noun in self._held or clause.verb in theme_words()["putting_verbs"] else spots[-1]

    def _thing(self, clause: Clause) -> str:
        """What a clause's deed is done to."""
        meant = self._named if _MEANT & set(clause.lemmas[1:4]) else ""
        return meant or thing_of(clause)

    def _comes_out(self, clause: Clause) -> bool:
        """Whether a thing is taken out of what was opened just before."""
        out = clause.verb in theme_words()["taking_verbs"] and clause.lemmas[1:2] == ("out",)
        found = clause.verb in theme_words()["finding_verbs"] and not ({*clause.lemmas} & _MEANT)
        return self._opened is not None and (out or found)
