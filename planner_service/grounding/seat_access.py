"""Chairs that are moved for who sits on them, which is said: pulled out where a table blocks them in a user's room, and
drawn up to the table for what is done at it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Final

from planner_service.grounding.keyframes_to_actions import Place
from planner_service.grounding.object_assignment import FLOOR, MissingError, Placing, StandIn, is_usable, usable_offers
from planner_service.grounding.seat_tables import done_at_tables
from planner_service.scripts.script import Keyframe, LongScript
from scene_graphs.affordances.chairs_at_tables import drawn_up
from scene_graphs.affordances.usable_furniture import Pull, can_be_pulled, pulled, pulled_out
from scene_graphs.graph.furniture_graph import offers
from scene_graphs.graph.script_objects import Offers
from scene_graphs.home import Home

Pulls = Mapping[int, tuple[Pull, ...]]
"""Chairs pulled out, by room of the home."""
NO_PULLS: Final[Pulls] = MappingProxyType({})


def pullable_seats(home: Home, usable: Offers) -> dict[str, Pull]:
    """How each seat that no body gets at would be pulled out, by home-wide id; those that cannot be are left out."""
    found = {}
    for index, room in enumerate(home.rooms):
        for placed in room.layout.objects:
            name = f"{index}/{placed.id}"
            blocked = "sit" in offers(placed) and "sit" not in usable.get(name, frozenset())
            if blocked and can_be_pulled(placed) and (pull := pulled_out(room.layout, placed.id)) is not None:
                found[name] = pull
    return found


def pull_out(home: Home, seats: Iterable[str]) -> tuple[Home, Pulls]:
    """The home with these seats pulled out one after another, and the pulls by room; the next minds the last.

    A seat that another's pull has freed stays where it is, and so does one that can no longer be pulled.
    """
    rooms, pulls = list(home.rooms), dict[int, tuple[Pull, ...]]()
    for name in seats:
        number, _, object_id = name.partition("/")
        index = int(number)
        pull = pulled_out(rooms[index].layout, object_id)
        if pull is not None:
            rooms[index] = replace(rooms[index], layout=pulled(rooms[index].layout, pull))
            pulls[index] = (*pulls.get(index, ()), pull)
    return replace(home, rooms=tuple(rooms)), pulls


def draw_up(home: Home, keyframes: Sequence[Keyframe], places: Sequence[Place]) -> tuple[Home, Pulls]:
    """The home with every chair at its table on which something is done that needs one, and the moves by room."""
    busy = zip(done_at_tables(keyframes), places, strict=True)
    rooms, moves = list(home.rooms), dict[int, tuple[Pull, ...]]()
    for name in dict.fromkeys(place.object_id for caption, place in busy if caption and place.object_id):
        number, _, object_id = name.partition("/")
        index = int(number)
        move = drawn_up(rooms[index].layout, object_id)
        if move is None:
            continue
        room = replace(rooms[index], layout=pulled(rooms[index].layout, move))
        moved = replace(home, rooms=(*rooms[:index], room, *rooms[index + 1 :]))
        if len(rooms) == 1 or is_usable(moved, name, "sit"):  # the door to another room may be elsewhere
            rooms[index], moves[index] = room, (*moves.get(index, ()), move)
    return (replace(home, rooms=tuple(rooms)) if moves else home), moves


@dataclass(frozen=True)
class Seating:
    """An attempt to give every keyframe its object."""

    placing: Placing
    places: tuple[Place, ...]
    missing: str
    """What nothing could stand for; empty if everything has its object."""
    pulls: Pulls

    @property
    def said(self) -> tuple[StandIn, ...]:
        """The stand-ins it took."""
        return self.placing.said()

    @property
    def lacks(self) -> tuple[bool, int, int]:
        """How much is wanting: whether something is missing, how often the floor serves, and all stand-ins."""
        return bool(self.missing), sum(stand_in.given == FLOOR for stand_in in self.said), len(self.said)


def seat(placing: Placing, script: LongScript, where: Sequence[str], pulls: Pulls = NO_PULLS) -> Seating:
    """An object for every keyframe as the furniture stands; `where` is the room type of each."""
    try:
        return Seating(placing, placing.places(script, where), "", pulls)
    except MissingError as error:
        return Seating(placing, (), str(error), pulls)


def seat_with_pulls(placing: Placing, script: LongScript, where: Sequence[str]) -> Seating:
    """The same, and where that leaves something wanting, with chairs that nobody gets at pulled out, if that helps."""
    first = seat(placing, script, where)
    pulls = pullable_seats(placing.home, placing.usable) if any(first.lacks) else {}
    if not pulls:
        return first
    offered = {name: placing.usable[name] | {"sit"} for name in pulls}
    hoped = seat(_again(placing, placing.home, {**placing.usable, **offered}), script, where)
    chosen = dict.fromkeys(place.object_id for place in hoped.places if place.object_id in pulls)
    home, done = pull_out(placing.home, [name for name in chosen if name])
    final = seat(_again(placing, home, usable_offers(home)), script, where, done)
    return final if final.lacks < first.lacks else first


def _again(placing: Placing, home: Home, usable: Offers) -> Placing:
    return replace(placing, home=home, usable=usable, stand_ins={})


def pull_to_dict(pull: Pull) -> dict[str, Any]:
    """Plain values for JSON, in the room's own frame."""
    return {
        "object_id": pull.object_id,
        "from": {"position": list(pull.start), "yaw": pull.start_yaw},
        "to": {"position": list(pull.end), "yaw": pull.end_yaw},
        "distance": round(pull.distance, 3),
    }


def pull_from_dict(row: dict[str, Any]) -> Pull:
    """The inverse of `pull_to_dict`."""
    start, end = row["from"], row["to"]
    return Pull(row["object_id"], tuple(start["position"]), start["yaw"], tuple(end["position"]), end["yaw"])
