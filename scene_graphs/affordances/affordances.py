"""Where a body can sit, lie and touch: candidates from an object's shape, each with a standing point (SIMS 4.1)."""

from __future__ import annotations

from math import cos, inf, sin

from scene_graphs.affordances.sit_and_lie import TO_FOOT, TO_HEAD, lying, sitting
from scene_graphs.affordances.spot import Spot, spot_from_dict, spot_to_dict
from scene_graphs.affordances.touch import touching
from scene_graphs.furniture_shapes import parts_of
from scene_graphs.layout import Placed, Point2, wrap

__all__ = ["Spot", "floor_spot", "spot_from_dict", "spot_to_dict", "spots"]


def spots(placed: Placed, affordance: str) -> tuple[Spot, ...]:
    """Candidate spots of an object for "sit", "lie" or "touch", best first; empty where its shape offers none.

    They are found on its seats, mattresses and tops, those of its form or those measured from its mesh: one spot is a
    place on a surface with the height, the distance to its edge and to the backrest behind it, where to stand before
    and how to approach. Spots look at the object alone: whether a standing point is free in a room is for the
    caller to find.
    """
    makers = {"sit": sitting, "lie": lying, "touch": touching}
    if affordance not in makers:
        raise ValueError(f"affordance must be one of {', '.join(makers)}, got {affordance!r}")
    solid = [part for part in parts_of(placed) if not part.is_soft]
    return tuple(makers[affordance](placed, solid))


def floor_spot(affordance: str, point_xz: Point2, facing: float) -> Spot:
    """The floor as a place to sit (looking to `facing`) or lie (head towards `facing`), object id "floor"."""
    if affordance not in ("sit", "lie"):
        raise ValueError(f"the floor affords sit and lie, not {affordance!r}")
    # One lies down on the floor from the knees, left of the place, looking to where the head will be.
    ahead, left = (0.30, 0.0) if affordance == "sit" else (-0.07, 0.30)
    standing = (
        point_xz[0] + ahead * sin(facing) - left * cos(facing),
        point_xz[1] + ahead * cos(facing) + left * sin(facing),
    )
    room = (inf, 0.0) if affordance == "sit" else (TO_HEAD, TO_FOOT)
    point = (point_xz[0], 0.0, point_xz[1])
    return Spot(affordance, "floor", point, (0.0, 1.0, 0.0), facing, standing, wrap(facing), max(ahead, left), *room)
