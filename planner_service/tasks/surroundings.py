"""What furniture there is for a task."""

from __future__ import annotations

from collections.abc import Iterable

from planner_service.grounding.object_assignment import usable_offers
from planner_service.grounding.seat_access import pullable_seats
from scene_graphs import furniture
from scene_graphs.home import Home


class Surroundings:
    """The furniture of a home; without one, anything we know may be there."""

    def __init__(self, home: Home | None = None) -> None:
        self.home = home
        self._offers: dict[str, frozenset[str]] = {}
        if home is not None:
            usable = usable_offers(home)
            seats = pullable_seats(home, usable)
            for placed in home.objects:
                offered = usable[placed.id] | ({"sit"} if placed.id in seats else set())
                self._offers[placed.category] = self._offers.get(placed.category, frozenset()) | offered

    def find(self, word: str, need: str = "touch", exactly: bool = False) -> str:
        """The furniture that a word means and where a body can sit, lie or touch, as a keyframe calls it; "" if none.

        Of the very kind if there is one, else, if that will do, of its class (a loveseat for a sofa); a plant is no
        mirror, though.
        """
        if not furniture.is_known(word):
            return ""
        if self.home is None:
            return furniture.display_name(word) if need in furniture.affordances(word) else ""
        having = sorted(category for category, offered in self._offers.items() if need in offered)
        exact = [category for category in having if category in furniture.categories_of(word)]
        if not exact and not exactly and furniture.class_of(word) != "decor":
            exact = [category for category in having if furniture.class_of(category) == furniture.class_of(word)]
        return furniture.display_name(exact[0]) if exact else ""

    def first(self, words: Iterable[str], need: str = "touch") -> str:
        """The first of these that there is, of that very kind; "" if none."""
        return next(filter(None, (self.find(word, need, exactly=True) for word in words)), "")

    def missing(self, word: str, need: str = "touch") -> str:
        """Why `find` found nothing."""
        if not furniture.is_known(word):
            return f"“{word}” is no furniture we know"
        if need not in furniture.affordances(word):
            return f"nobody can {need} {'the' if need == 'touch' else 'on the'} {word}"
        return f"there is no {word} here that a body can {'touch' if need == 'touch' else need + ' on'}"

    @property
    def names(self) -> tuple[str, ...]:
        """Everything that can be sat or lain on or touched, as a person would call it."""
        known = furniture.catalogue().class_of if self.home is None else self._offers
        return tuple(
            sorted({furniture.display_name(word) for word in known if self.find(word) or self.find(word, "sit")})
        )
