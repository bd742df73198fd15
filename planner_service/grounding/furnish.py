"""From a long script to a furnished home: graphs, merging, retrieval, and every script's furniture found (SIMS 3.2)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from motion_backend.motion import Skill
from planner_service.composition.furniture_words import pieces_told
from planner_service.grounding.keyframes_to_actions import NEEDS, Place
from planner_service.grounding.object_assignment import Placing, StandIn, place_in, usable_offers
from planner_service.grounding.opening_places import has_opening
from planner_service.grounding.room_assignment import housed
from planner_service.grounding.seat_access import draw_up, pull_to_dict, seat, seat_with_pulls
from planner_service.grounding.seat_tables import rests, tables_of
from planner_service.scripts.acted_beats import AT_THE, IN_PLACE_OF
from planner_service.scripts.script import LongScript, PlannedKeyframe
from planner_service.themes.opening_words import opening_of
from scene_graphs.affordances.usable_furniture import Pull
from scene_graphs.errors import UserError
from scene_graphs.furniture import ROOM_TYPES, Furniture, canonical, canonical_room, categories_of, display_name
from scene_graphs.graph.edit_distance import MAX_NODES, exact_distance
from scene_graphs.graph.furniture_graph import FurnitureGraph, graph_from_layout, graph_from_uses, put_beside
from scene_graphs.graph.merge import merge
from scene_graphs.home import MAX_ROOMS, Home, home_from_layouts
from scene_graphs.layout import Layout
from scene_graphs.layout_library import built_in_layouts
from scene_graphs.retrieval.layout_index import LayoutIndex, retrieve_rooms
from scene_graphs.retrieval.match_explanation import Explanation, explain


class FurnishError(UserError):
    """No home can be found for a script; the text names what is missing."""


@dataclass(frozen=True)
class RoomMatch:
    """One room of the home and how well it fits what is played in it."""

    room_type: str
    """What the room is called, wherever it is named: `called`."""
    layout_id: str
    distance: int
    exact: bool
    substitutions: tuple[tuple[str, str, str], ...]
    """(asked, given, level) where the room has something else than asked: same class, group or, at last, affordance."""
    missing: tuple[str, ...]
    pulls: tuple[Pull, ...] = ()
    """Chairs that stand pulled out from the start, since nobody could sit on them where they stood."""
    drawn_up: tuple[Pull, ...] = ()
    """Chairs that stand nearer to their table from the start, for what is done at it."""


@dataclass(frozen=True)
class Furnished:
    """A home for a script: each keyframe with its room and object."""

    script: LongScript
    home: Home
    matches: tuple[RoomMatch, ...]
    places: tuple[Place, ...]
    graphs: Mapping[str, FurnitureGraph]
    """Room type to the merged graph of the furniture that is used there."""

    @property
    def names(self) -> dict[int, tuple[str, str]]:
        """Keyframe index to the words a story uses for its furniture and room; the floor has no word."""
        named = {}
        for index, place in enumerate(self.places):
            room = self.room_of(place).replace("_", " ")
            piece = "floor"
            if place.object_id is not None:
                piece = display_name(self.home.object(place.object_id).category)
            piece = self._opening(index) or piece
            named[index] = (piece, room)
        return named

    def room_of(self, place: Place) -> str:
        """The type of room that a keyframe's body is in."""
        return self.matches[place.room].room_type

    def _opening(self, index: int) -> str:
        """The window or door that a hand goes to there, or that who walks goes to where one does; else ""."""
        keyframe = self.script.keyframes[index]
        if keyframe.skill is Skill.LOCO and not keyframe.on_floor and index + 1 < len(self.script.keyframes):
            keyframe = self.script.keyframes[index + 1]
        if keyframe.skill is not Skill.TOUCH:
            return ""
        kind = opening_of(keyframe.skill, self.script.said_of(keyframe))
        return kind if kind is not None and has_opening(self.home, kind) else ""

    def instead(self, index: int) -> str:
        """What the hands of a keyframe are at in place of the piece that the theme names: "at the wardrobe in place of
        the washing machine"; "" where they are at that, or the theme names none."""
        keyframe, place = self.script.keyframes[index], self.places[index]
        if keyframe.skill is not Skill.TOUCH or place.object_id is None or self._opening(index):
            return ""
        category = canonical(self.home.object(place.object_id).category)
        if category in categories_of(keyframe.piece[0]):
            return ""
        named = pieces_told(self.script.said_of(keyframe))
        told = next((word for word, piece in named if piece == keyframe.piece[0]), "")
        return f"{AT_THE} {display_name(category)}{IN_PLACE_OF}{told}" if told else ""

    def explain(self) -> list[str]:
        """One line a room: which, what stands for what, what is missing, what was moved."""
        lines = []
        used = [{display_name(one.piece[0]) for at, (one, place) in enumerate(self._placed())
                 if place.room == number and not self._opening(at)} for number in range(len(self.matches))]  # fmt: skip
        for number, match in enumerate(self.matches):
            line = f"{match.room_type.replace('_', ' ')}: {match.layout_id}"
            asked = {keyframe.room for keyframe, place in self._placed() if place.room == number and keyframe.room}
            if others := sorted(asked - {match.room_type}):
                line += f", where the script asks for a {' and a '.join(others).replace('_', ' ')}"
            line += "" if match.exact else " (another may fit better)"
            given = [f"{asked} → {got} ({level})" for asked, got, level in match.substitutions if asked in used[number]]
            given += [f"{asked} → {got} (one of its kind)" for asked, got in self._kinds(number)]
            pulls = [f"{self._name(number, pull)} pulled out by {pull.distance:.2f} m" for pull in match.pulls]
            pulls += [f"{self._name(number, move)} drawn up to its table" for move in match.drawn_up]
            lines.append("; ".join([line, *given, *[f"missing {name}" for name in match.missing], *pulls]))
        return lines

    def _kinds(self, room: int) -> list[tuple[str, str]]:
        """The words for furniture that are another's than those of the piece that stands there: "sofa" for a chaise
        longue, each once."""
        found = []
        for keyframe, place in self._placed():
            if place.room != room or place.object_id is None:
                continue
            asked, category = keyframe.piece[0], canonical(self.home.object(place.object_id).category)
            if category in categories_of(asked) and category != canonical(asked):
                given = display_name(category)
                if not set(display_name(asked).split()) & set(given.split()):
                    found.append((display_name(asked), given))
        return list(dict.fromkeys(found))

    def _placed(self) -> Iterator[tuple[PlannedKeyframe, Place]]:
        return zip(self.script.keyframes, self.places, strict=True)

    def _name(self, room: int, pull: Pull) -> str:
        return f"{display_name(self.home.object(f'{room}/{pull.object_id}').category)} {pull.object_id}"

    def rooms_to_dicts(self) -> list[dict[str, Any]]:
        """Plain values for JSON."""
        return [
            {
                "layout_id": match.layout_id,
                "room_type": match.room_type,
                "distance": match.distance,
                "exact": match.exact,
                "substitutions": [
                    {"asked": asked, "given": given, "level": level} for asked, given, level in match.substitutions
                ],
                "missing": list(match.missing),
                "pulled_out": [pull_to_dict(pull) for pull in match.pulls],
                "drawn_up": [pull_to_dict(move) for move in match.drawn_up],
            }
            for match in self.matches
        ]


def furnish(
    script: LongScript,
    index: LayoutIndex,
    rooms: Sequence[str] = (),
    given: Home | Sequence[Layout] = (),
    seed: int = 0,
) -> Furnished:
    """Find a room for every room type of the script, join them to a home and ground every keyframe in it.

    `given` are rooms of the user's own, used instead of retrieved ones and joined, or a whole home, used as it is.
    Raises FurnishError naming what no room has.
    """
    layouts = [room.layout for room in given.rooms] if isinstance(given, Home) else given
    known = [room for room in map(canonical_room, rooms) if room in ROOM_TYPES]
    script = housed(script, index.layouts, known or ROOM_TYPES)
    wanted = _room_types(script, rooms)
    uses = {room: _script_graphs(script, room, wanted) for room in wanted}
    merged = {room: merge([graph for _, graph in graphs]).graph for room, graphs in uses.items()}
    for room, graph in merged.items():
        if len(graph) > MAX_NODES:
            used = f"{len(graph)} pieces of furniture in the {room.replace('_', ' ')}"
            raise FurnishError(f"the story uses {used}, at most {MAX_NODES} can be", "tell of fewer events", at="theme")
    chosen = _given(merged, layouts) if layouts else _retrieved(merged, index, seed)
    unique = list(dict.fromkeys([layout for layout, _ in chosen.values()] + list(layouts)))
    if isinstance(given, Home):
        unique, home = list(layouts), given
    else:
        home = home_from_layouts(unique, seed)
    number = {room: unique.index(layout) for room, (layout, _) in chosen.items()}
    # Our own rooms were checked when they were made; in a user's room a chair may stand where nobody gets to.
    checked = {layout.id: layout for layout in built_in_layouts()}
    are_ours = not layouts and all(checked.get(layout.id) is layout for layout in unique)
    where = [_room_of(keyframe, wanted) for keyframe in script.keyframes]
    placing = Placing(home, uses, number, usable_offers(home, checked=are_ours and len(home.rooms) == 1))
    seating = seat(placing, script, where) if are_ours else seat_with_pulls(placing, script, where)
    if seating.missing:
        raise FurnishError(seating.missing)
    home, drawn = draw_up(seating.placing.home, script.keyframes, seating.places)
    matches = tuple(
        replace(match, pulls=seating.pulls.get(room, ()), drawn_up=drawn.get(room, ()))
        for room, match in enumerate(_matches(unique, chosen, seating.said))
    )
    return Furnished(script, home, matches, seating.places, merged)


def furnished_again(stage: Furnished, script: LongScript) -> Furnished:
    """The same home for a script that has changed: its keyframes name their objects, or play on a room's floor."""
    rooms = {keyframe.room: place.room for keyframe, place in zip(stage.script.keyframes, stage.places, strict=True)}
    met = list(dict.fromkeys(keyframe.room for keyframe in script.keyframes if keyframe.room))
    graphs: dict[str, FurnitureGraph] = {
        room: merge([graph for _, graph in _script_graphs(script, room, met)]).graph for room in met
    }
    places = tuple(
        Place(rooms.get(keyframe.room, 0)) if keyframe.object_id is None else place_in(keyframe.object_id)
        for keyframe in script.keyframes
    )
    return replace(stage, script=script, places=places, graphs=graphs)


def _room_types(script: LongScript, rooms: Sequence[str]) -> list[str]:
    """Room types in the order the story comes to them."""
    asked = [canonical_room(room) for room in rooms]
    unknown = [room for room, name in zip(rooms, asked, strict=True) if name not in ROOM_TYPES]
    if unknown:
        raise FurnishError(f"{unknown[0]!r} is none of {', '.join(ROOM_TYPES)}", at="rooms")
    if len(asked) > MAX_ROOMS:
        raise FurnishError(f"a home has at most {MAX_ROOMS} rooms, {len(asked)} were asked for", at="rooms")
    met = dict.fromkeys(keyframe.room for keyframe in script.keyframes if keyframe.room)
    return list(met) + [room for room in asked if room not in met] or [asked[0] if asked else "living_room"]


def _room_of(keyframe: PlannedKeyframe, wanted: Sequence[str]) -> str:
    return keyframe.room if keyframe.room is not None and keyframe.room in wanted else wanted[0]


def _script_graphs(script: LongScript, room: str, wanted: Sequence[str]) -> list[tuple[int | None, FurnitureGraph]]:
    """One graph for every short script that plays in a room, from its keyframes as they were planned."""
    needs, tables = _needs(script.keyframes), tables_of(script.keyframes)
    here = [place for place, keyframe in enumerate(script.keyframes) if _room_of(keyframe, wanted) == room]
    graphs = []
    for number in dict.fromkeys(script.keyframes[place].short_script for place in here):
        mine = [place for place in here if script.keyframes[place].short_script == number]
        used = [place for place in mine if not script.keyframes[place].on_floor]
        pieces = [script.keyframes[place].piece for place in used]
        graph = graph_from_uses(pieces, [needs[place] for place in used])
        for place, piece in zip(used, pieces, strict=True):
            if (table := tables[place]) is not None:
                put_beside(graph, Furniture(canonical(piece[0]), piece[1]), Furniture(canonical(table)))
        graphs.append((number, graph))
    return graphs


def _needs(keyframes: Sequence[PlannedKeyframe]) -> list[frozenset[str]]:
    """What each keyframe needs of its furniture; all that is done on one seat or bed, each of its keyframes."""
    needs = [frozenset((NEEDS[one.skill],) if one.skill in NEEDS else ()) for one in keyframes]
    for run in rests(keyframes):
        for place in run:
            needs[place] = frozenset[str]().union(*(needs[other] for other in run))
    return needs


Chosen = dict[str, tuple[Layout, RoomMatch]]


def _retrieved(merged: dict[str, FurnitureGraph], index: LayoutIndex, seed: int) -> Chosen:
    """One of the nearest rooms of the library for every room type."""
    chosen: Chosen = {}
    for room, match in retrieve_rooms(index, merged, seed=seed).items():
        told = explain(merged[room], index.graph(match.layout_id), match, index.costs)
        chosen[room] = (index.layout(match.layout_id), _room_match(room, match.layout_id, told))
    return chosen


def _given(merged: dict[str, FurnitureGraph], layouts: Sequence[Layout]) -> Chosen:
    """The user's room that fits each room type best: its own type first, then the smaller distance."""
    chosen: Chosen = {}
    for room, graph in merged.items():
        ranked = sorted(
            ((room not in (layout.room_type, *layout.tags), _explained(room, graph, layout).distance, number)
             for number, layout in enumerate(layouts))
        )  # fmt: skip
        best = layouts[ranked[0][2]]
        chosen[room] = (best, _explained(room, graph, best))
    return chosen


def _explained(room: str, graph: FurnitureGraph, layout: Layout) -> RoomMatch:
    own = graph_from_layout(layout)
    return _room_match(room, layout.id, explain(graph, own, exact_distance(graph, own)))


def _room_match(room: str, layout_id: str, told: Explanation) -> RoomMatch:
    substitutions = tuple(
        (display_name(pair.asked.category), display_name(pair.given.category), pair.level)
        for pair in told.substitutions
    )
    missing = tuple(display_name(gap.asked.category) for gap in told.missing)
    return RoomMatch(room, layout_id, told.distance, told.exact, substitutions, missing)


def _matches(unique: Sequence[Layout], chosen: Chosen, stand_ins: Sequence[StandIn]) -> tuple[RoomMatch, ...]:
    """One match a room of the home, in the home's order; a room nothing is played in matches trivially."""
    matches = []
    for number, layout in enumerate(unique):
        played = [match for given, match in chosen.values() if given is layout]
        first = played[0] if played else RoomMatch(layout.room_type, layout.id, 0, True, (), ())
        # A room of the user's may stand for several types: what is missed or replaced in any of them is said.
        served = {s.asked: s.given for s in stand_ins if s.room == number}
        given = (s for match in played for s in match.substitutions if s[0] not in served)
        substitutions = tuple(dict.fromkeys(given))
        substitutions += tuple((asked, given, "affordance") for asked, given in served.items())
        missing = tuple(dict.fromkeys(n for match in played for n in match.missing if n not in served))
        name = called(layout, [match.room_type for match in played])
        matches.append(replace(first, room_type=name, substitutions=substitutions, missing=missing))
    return tuple(matches)


def called(layout: Layout, asked: Sequence[str]) -> str:
    """What a room is called in which a script plays what it asks for in rooms of some types: by one of them where the
    room is or serves that, else by its own type. A room with a bed is a bedroom, whatever desk stands in it."""
    if layout.room_type in asked or layout.room_type == "bedroom":
        return layout.room_type
    return next((room for room in asked if room in layout.tags), layout.room_type)
