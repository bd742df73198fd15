"""What of a room's furniture a body can really use, piece by piece, and what keeps it from the rest."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

from scene_graphs.checking import OUT_OF_REACH, RoomCheck
from scene_graphs.furniture import affordances, group_of
from scene_graphs.layouts import Layout, Placed
from scene_graphs.pulling import pulled_out
from scene_graphs.surfaces import Spot, spots

Verdict = Literal["as placed", "pulled out", "no surface", "no room", "no way"]
"""Used where it stands, or after a pull; else it has no surface, nobody can stand before it, or nobody gets there."""


@dataclass(frozen=True)
class Use:
    """One piece and one thing that is done with such pieces."""

    object_id: str
    category: str
    affordance: str
    verdict: Verdict
    hindrance: str = ""
    """no room: what stands where the body would, most often: "wall" or a group of furniture."""


def uses(layout: Layout) -> Iterator[Use]:
    """Every piece that stands on the floor and is to be sat or lain on, in the layout's order."""
    check = RoomCheck(layout)
    for placed in layout.objects:
        if placed.parent is None and placed.position[1] < OUT_OF_REACH:
            for affordance in ("sit", "lie"):
                if affordance in affordances(placed.category):
                    yield _use(check, placed, affordance)


def count_uses(layouts: Iterable[Layout]) -> dict[tuple[str, str], Counter[str]]:
    """For every category and affordance, how many pieces got each verdict; "no room" with what is in the way."""
    counts: dict[tuple[str, str], Counter[str]] = {}
    for layout in layouts:
        for use in uses(layout):
            said = f"{use.verdict}: {use.hindrance}" if use.hindrance else use.verdict
            counts.setdefault((use.category, use.affordance), Counter())[said] += 1
    return counts


def _use(check: RoomCheck, placed: Placed, affordance: str) -> Use:
    found = spots(placed, affordance)
    verdict: Verdict
    hindrance = ""
    if not found:
        verdict = "no surface"
    elif any(map(check.is_usable, found)):
        verdict = "as placed"
    elif affordance == "sit" and pulled_out(check.layout, placed.id) is not None:
        verdict = "pulled out"
    else:
        hindrances = Counter(_hindrance(check, spot) for spot in found)
        hindrance = "" if "" in hindrances else hindrances.most_common(1)[0][0]
        verdict = "no room" if hindrance else "no way"
    return Use(placed.id, placed.category, affordance, verdict, hindrance)


def _hindrance(check: RoomCheck, spot: Spot) -> str:
    """What stands where a body would stand: "wall", the group of a piece, or nothing."""
    owner = check.in_the_way(spot)
    return owner if owner in ("", "wall") else group_of(check.layout.object(owner).category)
