"""What can be done in a furnished home, as candidates for the motion planner (LINGO B.1.3 and Table A1)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final, NamedTuple

from motion_backend.motion import Posture
from motion_backend.planners.markov_planner import Candidate, mirrored
from scene_graphs.furniture import categories_of, class_of, display_name
from scene_graphs.graph.furniture_graph import offers
from scene_graphs.home import Home

STANDING, SEATED, LYING = Posture.STANDING, Posture.SEATED, Posture.LYING


class Thing(NamedTuple):
    """A thing people take in hand."""

    name: str
    use: str
    """What is done with it, in words."""
    kind: str
    """That as a motion type of Table A1."""
    posture: Posture
    both: bool
    """Whether it takes both hands."""
    kept: tuple[str, ...]
    """Furniture where it may lie, the likeliest first."""


TABLETOPS: Final = (
    "coffee_table",
    "dining_table",
    "desk",
    "side_table",
    "round_end_table",
    "console_table",
    "nightstand",
)
THINGS: Final = (
    Thing("cup", "drink from the cup", "drink", SEATED, False, TABLETOPS),
    Thing("book", "read the book", "read", SEATED, True, ("bookshelf", "shelf", "nightstand", *TABLETOPS)),
    Thing(
        "phone", "talk on the phone", "talk on", STANDING, False, ("nightstand", "tv_stand", "side_table", *TABLETOPS)
    ),
)
OPERATED: Final = {
    "turn on": ("lamp", "tv", "stove", "tv_stand"),
    "open": ("wardrobe", "cabinet", "refrigerator", "dresser", "kitchen_cabinet"),
}
"""Motion types and the furniture on which a hand does them; only turning on is one of Table A1's."""
SEATS: Final = 2
"""Seats of a plan: more add places, not motion types."""
Offers = Mapping[str, frozenset[str]]


def candidates_from_home(home: Home, usable: Offers | None = None) -> tuple[Candidate, ...]:
    """Walks to furniture, rests on it, things that lie about and what is done with them, each with either hand.

    `usable` says what objects, by home-wide id, can really be used for; else what their kind is for. A piece of
    furniture stands for all of its kind.
    """
    known: dict[str, frozenset[str]] = {}
    for placed in home.objects:
        offered = offers(placed) if usable is None else usable.get(placed.id, frozenset())
        known[placed.category] = known.get(placed.category, frozenset()) | offered
    done = [*_rests(known), *_handling(known), *_operating(known)]
    places = dict.fromkeys(candidate.place for candidate in done if candidate.place)
    walks = [
        Candidate(f"walk to the {place}", "walk forward", "locomotion", 4.0, place=place, goes=True) for place in places
    ]
    still = [Candidate("stand still", "stand still", "interaction", 3.0)]
    return (*walks, *still, *done)


def _rests(known: Offers) -> Iterator[Candidate]:
    seats = [c for c in sorted(known) if "sit" in known[c] and "lie" not in known[c] and class_of(c) != "table"]
    couches = [category for category in sorted(known) if {"sit", "lie"} <= known[category]]
    for place in map(display_name, (seats + couches)[:SEATS]):
        yield Candidate(f"sit down on the {place}", "sit down", "locomotion", 4.0, STANDING, SEATED, place)
        yield Candidate(f"stand up from the {place}", "stand up", "locomotion", 3.0, SEATED, STANDING, place)
        yield Candidate(f"sit still on the {place}", "maintain sit", "interaction", 5.0, SEATED, SEATED, place)
    for place in map(display_name, couches[:1]):
        yield Candidate(f"lie down on the {place}", "lie down", "locomotion", 6.0, STANDING, LYING, place)
        yield Candidate(f"get up from the {place}", "get up", "locomotion", 5.0, LYING, STANDING, place)
        yield Candidate(f"lie still on the {place}", "maintain lie", "interaction", 6.0, LYING, LYING, place)


def _handling(known: Offers) -> Iterator[Candidate]:
    may_sit = any("sit" in offered for offered in known.values())
    for thing in THINGS:
        place = next((display_name(kept) for kept in thing.kept if "touch" in known.get(kept, ())), "")
        if not place or (thing.posture is SEATED and not may_sit):
            continue
        taken = f"pick up the {thing.name} with the right hand"
        laid = f"put down the {thing.name} with the right hand"
        yield from _either(Candidate(taken, "pick up", "grasp", 3.0, place=place, hand="right", takes=thing.name))
        yield from _either(Candidate(laid, "put down", "grasp", 3.0, place=place, hand="right", lays=thing.name))
        used = Candidate(
            f"{thing.use} with {'both hands' if thing.both else 'the right hand'}", thing.kind, "interaction", 5.0,
            thing.posture, thing.posture, hand="both" if thing.both else "right", uses=thing.name,
        )  # fmt: skip
        yield from _either(used)


def _operating(known: Offers) -> Iterator[Candidate]:
    for kind, words in OPERATED.items():
        found = (c for word in words for c in sorted(categories_of(word)) if "touch" in known.get(c, ()))
        if place := display_name(next(found, "")):
            done = f"{kind} the {place} with the right hand"
            yield from _either(Candidate(done, kind, "interaction", 3.0, place=place, hand="right"))


def _either(candidate: Candidate) -> Iterator[Candidate]:
    """A candidate and its mirror image, if that is another."""
    yield candidate
    if (other := mirrored(candidate)) != candidate:
        yield other
