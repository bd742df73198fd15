"""Which object every keyframe happens at: each short script mapped onto its room, and stand-ins for what it lacks.

A stand-in is another object of the same room that a body can do the same at (a shelf touched in place of a cabinet),
or the floor, which affords sitting and lying. It is a last resort for rooms the story did not choose, and it is always
said.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from motion_backend.motion import Skill, moment
from motion_backend.scene import scene_of
from planner_service.grounding.keyframes_to_actions import NEEDS, Place, can_stand
from planner_service.scripts.script import LongScript, PlannedKeyframe
from scene_graphs.affordances.affordances import spots
from scene_graphs.furniture import (
    Furniture,
    canonical,
    categories_of,
    class_of,
    display_name,
    group_of,
    is_known,
    is_minor,
)
from scene_graphs.graph.furniture_graph import FurnitureGraph, needs_of, offers
from scene_graphs.graph.script_objects import Grounding, Offers, ground_script
from scene_graphs.home import Home

ScriptGraphs = Mapping[str, Sequence[tuple[int | None, FurnitureGraph]]]
"""Room type to the graph of every short script that plays there, by the script's number."""
FLOOR = "floor"


class MissingError(ValueError):
    """A keyframe's furniture is not in the home, nor anything that could stand for it."""


@dataclass(frozen=True)
class StandIn:
    """An object that serves in place of another kind of furniture."""

    room: int
    asked: str
    given: str


@dataclass
class Placing:
    """The objects of a home being given to the keyframes of a script."""

    home: Home
    uses: ScriptGraphs
    numbers: Mapping[str, int]
    """Room type to room of the home."""
    usable: Offers
    """What objects can really be used for, where that is known."""
    stand_ins: dict[tuple[str, Furniture], str] = field(default_factory=dict)
    """By room type and piece: the id of the object that serves for it, or `FLOOR`."""

    def __post_init__(self) -> None:
        self.grounded: dict[tuple[str, int | None], Grounding] = {
            (room, number): ground_script(graph, self.home, self.numbers[room], self.usable)
            for room, graphs in self.uses.items()
            for number, graph in graphs
        }

    def places(self, script: LongScript, rooms: Sequence[str]) -> tuple[Place, ...]:
        """A place for every keyframe; `rooms` is the room type of each. Raises MissingError naming what is missing."""
        return tuple(self._place(i, k, room) for i, (k, room) in enumerate(zip(script.keyframes, rooms, strict=True)))

    def said(self) -> tuple[StandIn, ...]:
        """The stand-ins that were needed."""
        return tuple(
            StandIn(self.numbers[room], display_name(node.category), self._named(chosen))
            for (room, node), chosen in self.stand_ins.items()
        )

    def _place(self, index: int, keyframe: PlannedKeyframe, room: str) -> Place:
        if keyframe.on_floor:
            return Place(self.numbers[room])
        if keyframe.object_id is not None:
            return place_in(keyframe.object_id)
        word, instance = keyframe.piece
        node = Furniture(canonical(word), instance)
        object_id = self._object(keyframe, room, node)
        if object_id is None and keyframe.skill is Skill.TOUCH:
            lacks = f"the {room.replace('_', ' ')} has no {display_name(word)} to touch"
            raise MissingError(
                f"{moment(index)}: {lacks}, nor anything that could stand for it; choose another room or story"
            )
        if object_id is None and keyframe.skill in NEEDS:
            self.stand_ins[room, node] = FLOOR
        return Place(self.numbers[room]) if object_id is None else place_in(object_id)

    def _object(self, keyframe: PlannedKeyframe, room: str, node: Furniture) -> str | None:
        # A connecting keyframe speaks of what the script before or after it uses: those come after its own.
        scripts = [self.grounded[room, keyframe.short_script], *(g for (r, _), g in self.grounded.items() if r == room)]
        met = (grounding.objects[node] for grounding in scripts if node in grounding.objects)
        need = NEEDS.get(keyframe.skill)
        fit = (chosen for chosen in met if need is None or need in self._offers(chosen))
        fit = (chosen for chosen in fit if keyframe.skill is not Skill.TOUCH or not self._is_another(chosen, node))
        return next(fit, None) or self._stand_in(room, node)

    def _is_another(self, object_id: str, node: Furniture) -> bool:
        """Whether an object is a small thing of another kind: a bin is no picture, though both decorate."""
        category = self.home.object(object_id).category
        return is_minor(category) and canonical(category) not in categories_of(node.category)

    def _named(self, served: str) -> str:
        return served if served == FLOOR else display_name(self.home.object(served).category)

    def _offers(self, object_id: str) -> frozenset[str]:
        return self.usable.get(object_id, offers(self.home.object(object_id)))

    def _stand_in(self, room: str, node: Furniture) -> str | None:
        """The object that serves all a piece is needed for: no small decor if it can be helped, no twice-used one."""
        if (served := self.stand_ins.get((room, node))) is not None:
            return None if served == FLOOR else served
        needed = frozenset[str]().union(*(needs_of(graph, node) for _, graph in self.uses[room] if node in graph))
        prefix = f"{self.numbers[room]}/"
        fitting = [
            placed
            for placed in self.home.objects
            if placed.id.startswith(prefix) and is_known(placed.category) and needed <= self._offers(placed.id)
        ]
        if not needed or not fitting:
            return None
        taken = {chosen for (r, _), g in self.grounded.items() if r == room for chosen in g.objects.values()}
        # A hand does it where it does something else, at a table or in storage, sooner than at a seat.
        used = {node.category for _, graph in self.uses[room] for node in graph}
        order = {"surface": 0, "storage": 1}
        best = min(
            fitting,
            key=lambda p: (
                is_minor(p.category),
                order.get(group_of(p.category), 2),
                canonical(p.category) not in used,
                p.id in taken,
                p.id,
            ),
        )
        self.stand_ins[room, node] = best.id
        return best.id


def place_in(object_id: str) -> Place:
    """An object of a home with the room that it stands in."""
    return Place(int(object_id.partition("/")[0]), object_id)


def usable_offers(home: Home, checked: bool = False) -> dict[str, frozenset[str]]:
    """What each object of a home can be used for by a body that walks there: object id to sit, lie, touch.

    Of a room that was `checked` as it was made only what decorates it is looked at: a picture may hang over a bed.
    Rooms that are joined may close a way round that was there in each.
    """
    return {
        placed.id: frozenset(need for need in offers(placed) if is_usable(home, placed.id, need))
        for placed in home.objects
        if not checked or class_of(placed.category) == "decor"
    }


def is_usable(home: Home, object_id: str, need: str) -> bool:
    """Whether a body that walks in a home gets at one of its objects to sit, lie or touch."""
    scene, uses = scene_of(home), spots(home.object(object_id), need)
    return any(can_stand(scene.walkable, scene.first_free, spot) for spot in uses)
