"""Keyframes to actions: surfaces to sit, lie and touch, standing points, hands and ways to walk (SIMS 3.4, LINGO C).

Every contact gets the reachable spot nearest to where the body comes from; a walk ends where the next contact begins.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import cos, sin
from typing import Final, Literal, NamedTuple

import numpy as np

from motion_backend.motion import RISINGS, Action, Does, Emotion, Handle, Posture, Reaction, Skill, moment
from motion_backend.procedural.lie.lie_pose import place_to_lie
from motion_backend.procedural.lie.lie_styles import lie_style
from motion_backend.procedural.sit.sit_skill import seat_for
from motion_backend.procedural.touch.hand_captions import handling_of
from motion_backend.procedural.touch.hand_contacts import suits, to_knock_on
from motion_backend.procedural.walk.walk_styles import walk_style
from motion_backend.scene import scene_of
from motion_backend.state_machine import ENDS, alongside
from planner_service.grounding.dwell_time import lingering
from planner_service.grounding.handle_places import OpenFronts
from planner_service.grounding.opening_places import LACKS, OpeningPlace, entry, opening_place
from planner_service.grounding.running_places import LONG_ENOUGH, runs, way_to_run
from planner_service.grounding.seat_tables import done_at_tables
from planner_service.grounding.touch_stance import LEG_ROOM, ElbowRoom
from planner_service.grounding.walk_direction import in_front
from planner_service.scripts.caption_actions import Hands, done_in, look_of
from planner_service.scripts.caption_fallbacks import Words, hashed_words, performed_as
from planner_service.scripts.script import Keyframe, PlannedKeyframe
from planner_service.scripts.script_repair import free_hand, hand_of
from planner_service.themes.opening_words import Kind, comes_in, goes_out, goes_to_window, leaves_the_room, opening_of
from scene_graphs.affordances.affordances import Spot, floor_spot, spots
from scene_graphs.errors import UserError
from scene_graphs.furniture import display_name, has_front
from scene_graphs.home import Home
from scene_graphs.layout import Placed
from scene_graphs.navigation.path_planner import Walkable

Point = tuple[float, float]
FREE_FLOOR: Final = 0.35
"""Clearance all along a body on the floor at which one stops looking for a better place (metres)."""
FLOOR_TRIES: Final = 120
"""Places on the floor that are looked at: half of them anywhere in the room, the others beside the best of those."""
BESIDE_BEST, TURNED_ASIDE = 0.15, 0.3
"""Deviations of those from it: metres to each side, radians."""
FRONT: Final = 0.1
"""How far one who stands before a front may be turned from it (radians)."""
A_STEP: Final = 0.9
"""A place to stand so near to where the body stands is not walked round a thing for (metres)."""


def stays(caption: str) -> float:
    """For how many seconds a caption of loco leaves the body where it is ("stand still", "clapping hands"); 0 goes."""
    return walk_style(Emotion.NEUTRAL, caption).stays


def held(skill: Skill, caption: str) -> float:
    """For how many seconds what is done at a piece goes on, or lying on it."""
    return max(HOLDS[skill], lie_style(Emotion.NEUTRAL, caption).stays if skill is Skill.LIEDOWN else 0.0)


NEEDS = {Skill.SITDOWN: "sit", Skill.LIEDOWN: "lie", Skill.TOUCH: "touch"}
HOLDS = {Skill.SITDOWN: 2.5, Skill.LIEDOWN: 3.0, Skill.TOUCH: 1.4}
"""Seconds a reached pose is held."""
RESTS_BEFORE = 1.0
"""Seconds of rest before what a story begins with happens."""
LAST_HOLD = 1.5
"""Seconds more for the last keyframe."""
STANDS_ON_FLOOR = 0.3
"""What begins lower stands there and does not hang (metres)."""
LOOKS_OUT = 2.5
"""Seconds somebody stands at a window."""
PACING = 1.5
"""A wandering walk goes at least this far, where the room allows it (metres)."""
GOES_ON = 1.5
"""What it is worth that a walk goes on as the one before it went, or the next one as it goes (metres)."""
WALLED = 0.08
"""How far a point of furniture may lie in the wall of its room (metres)."""
STEP = 0.40
"""From free floor to a standing point is at most one step: what a room's check allows, and half a cell (metres)."""
KNEELING = (-0.7, 0.0, 0.4)
"""How far before the standing point feet, body and hands are of who gets down on the knees (metres)."""


class UnreachableError(UserError):
    """A keyframe has nothing it can be done at: no object, or none with a spot that can be walked to."""


@dataclass(frozen=True)
class Place:
    """Where a keyframe happens: room of the home, and object in it (None for the floor)."""

    room: int
    object_id: str | None = None


@dataclass(frozen=True)
class Kept:
    """What a keyframe came to when it was grounded before, in the same home and with the same seed."""

    action: Action
    leads_elsewhere: bool = False
    """Whether something else follows it now: a walk then goes where that begins."""


def act(
    keyframes: Sequence[Keyframe],
    places: Sequence[Place],
    home: Home,
    seed: int,
    words: Words = hashed_words,
    scale: float = 1.0,
    kept: Sequence[Kept | None] = (),
    said: Sequence[str] = (),
) -> tuple[Action, ...]:
    """Ground every keyframe in the home. Raises UnreachableError naming the keyframe that cannot be done.

    An action's caption is what is performed: where the body knows no word of the keyframe's, the nearest of `words`.
    `scale` is the size of the body against one of 1.70 m. `kept` has, for each keyframe that was grounded before, what
    came of it, else None: that stays as it was. `said` are the theme's words of what each shows, where there are any.
    """
    scene = scene_of(home)
    stage = _Stage(home, scene.walkable, np.random.default_rng([seed, 7]), words, scale)
    known = kept or [None] * len(keyframes)
    drafts: list[Action] = []
    entered = entry(home, scene.walkable, places[0].room) if said and comes_in(said[0]) else None
    stage.entered = entered
    door = stage.fronts.entered(entered.standing) if entered is not None else None
    busy = done_at_tables(keyframes)
    for index, (keyframe, place, old) in enumerate(zip(keyframes, places, known, strict=True)):
        words_of_it = f"{keyframe.caption}; {said[index] if said else ''}"
        left = keyframe.skill is Skill.LOCO and index == len(keyframes) - 1 and leaves_the_room(words_of_it)
        stage.openings.append("door" if left else opening_of(keyframe.skill, words_of_it))
        stage.to_window |= {index} if goes_to_window(words_of_it) else set()
        stage.out |= {index} if left or goes_out(words_of_it) else set()
        stage.seated_for.append(busy[index] or keyframe.caption)
        before = keyframes[index - 1] if index else None
        if old is not None and keyframe.skill in (*NEEDS, Skill.LOCO):
            drafts.append(stage.keep(index, old))
        else:  # who rises does so from what it rests on now
            drafts.append(stage.contact(index, keyframe, place, free_hand(before)))
    aimed = [old is not None and not old.leads_elsewhere for old in known]
    begins = entered.standing if entered is not None else scene.beginning(seed)[0]
    walked = stage.walks(drafts, places, begins, aimed)
    walked[:1] = [stage.comes_in(one, entered, door) for one in walked[:1]]
    hands = Hands()
    acted = [hands.follow(one, done_in(keyframes[one.keyframe].caption)) for one in walked]
    named = [replace(one, holds=keyframes[one.keyframe].held or one.holds) for one in acted]
    named = [_reacting(one, keyframes[one.keyframe]) for one in named]
    return tuple(lingering(one, said[one.keyframe] if said else "") for one in named)


def _reacting(action: Action, keyframe: Keyframe) -> Action:
    """An action with what happens before it or after it: who only rests there at first does not for long."""
    rows = keyframe.reacts if isinstance(keyframe, PlannedKeyframe) else ()
    hold = RESTS_BEFORE if rows and action.already else action.hold
    return replace(action, hold=hold, reacts=tuple(Reaction(row.how, row.at, row.after) for row in rows))


class _Stage:
    """The home while actions are being grounded: where the body stands and what it rests on."""

    def __init__(
        self, home: Home, walkable: Walkable, rng: np.random.Generator, words: Words, scale: float = 1.0
    ) -> None:
        self.home, self.walkable, self.rng, self.words, self.scale = home, walkable, rng, words, scale
        self.at: Point | None = None
        self.walks_on = False
        """Whether it has walked on from there."""
        self.resting: Spot | None = None
        self.on: Spot | None = None
        """What it sits or lies on still."""
        self.openings: list[Kind | None] = []
        """The window or door that each keyframe so far asks for."""
        self.to_window: set[int] = set()
        """Keyframes whose words lead to a window."""
        self.out: set[int] = set()
        """Keyframes in which somebody leaves the home."""
        self.entered: OpeningPlace | None = None
        """The door by which somebody comes in."""
        self.seated_for: list[str] = []
        """The caption that a seat is chosen for: what needs a table, of all that is done on it."""
        self.elsewhere: set[int] = set()
        """Keyframes that are not done at the piece they were planned for."""

    def contact(self, index: int, keyframe: Keyframe, place: Place, free: str = "right") -> Action:
        """The action of a keyframe; walks get their goal later, when what follows them is known."""
        mood = keyframe.mood
        performed = performed_as(keyframe.skill, look_of(keyframe.caption), mood, self.words)
        keyframe = keyframe.model_copy(update={"caption": performed})
        action = Action(keyframe.skill, keyframe.caption, mood, keyframe.furniture, place.object_id, keyframe=index)
        if keyframe.skill in NEEDS:
            hand, spot = hand_of(keyframe.caption, default=free), self._spot(index, keyframe, mood, place)
            opening = self._opening(index, place) if keyframe.skill is Skill.TOUCH else None
            if opening is not None:
                knocked = handling_of(keyframe.caption) == "knock"
                spot = opening.spot(height_of(keyframe.caption), self.scale, knocked)
            if keyframe.skill is Skill.TOUCH:
                hand, spot = self._elbows.freely(spot, hand, keyframe.caption)
                action = self._touched(index, replace(action, spot=spot, hand=hand), keyframe, place)
                spot, hand = action.spot or spot, action.hand
                self.elsewhere |= {index} if spot.object_id != place.object_id else set()
            else:
                self.resting = spot
            self.on = None if keyframe.skill is Skill.TOUCH else spot
            self.at, self.walks_on = spot.standing, False
            hold, already = held(keyframe.skill, keyframe.caption), getattr(keyframe, "already", False)
            return replace(action, object_id=spot.object_id, spot=spot, hand=hand, hold=hold, already=already)
        self.on = None
        self.walks_on |= keyframe.skill is Skill.LOCO
        if keyframe.skill in RISINGS and self.resting is not None:
            return replace(action, object_id=self.resting.object_id, spot=self.resting)
        return action

    def _touched(self, index: int, action: Action, keyframe: Keyframe, place: Place) -> Action:
        """A hand at what it opens or shuts, if it does; at a door also where it is got to from aside alone."""
        does: Literal[Does, ""] = getattr(keyframe, "does", "")
        kind = self._asked(index)
        assert action.spot is not None
        if kind is None or action.spot.object_id == kind:
            return self.fronts.touched(action, does, keyframe.piece[0])
        far = opening_place(self.home, self.walkable, kind, place.room, self.at)
        if far is not None and kind == "door" and does:
            there = self.fronts.touched(replace(action, spot=far.spot("medium", self.scale)), does, "door")
            if there.handle is not None:
                return there
        return replace(action, lacks=LACKS[kind])

    def _asked(self, index: int) -> Kind | None:
        return self.openings[index] if index < len(self.openings) else None

    def _opening(self, index: int, place: Place) -> OpeningPlace | None:
        """Where to stand to touch a window or door, if the keyframe asks for one and somebody gets there."""
        kind = self._asked(index)
        return kind and opening_place(self.home, self.walkable, kind, place.room, self.at, reach=True)

    def keep(self, index: int, old: Kept) -> Action:
        """An action as it was, the body left where that leaves it; how long it is held is reckoned anew."""
        action = old.action
        self.on = action.spot if action.skill in (Skill.SITDOWN, Skill.LIEDOWN) else None
        self.resting = self.on or self.resting
        self.at = action.spot.standing if action.spot is not None else self.at
        self.fronts.kept(action)
        self.walks_on = action.skill is Skill.LOCO or (self.walks_on and action.spot is None)
        hold = stays(action.caption) if action.skill is Skill.LOCO else 0.0
        return replace(action, keyframe=index, hold=HOLDS.get(action.skill, hold or Action.hold))

    def comes_in(self, action: Action, entered: OpeningPlace | None, door: Handle | None) -> Action:
        """The first action of who comes in by a door: they walk in by it, or stand before it already."""
        if entered is None or action.already:
            return action
        outside = entered.outside(self.walkable) if action.goal is not None else None
        return replace(action, begins=(*(outside or entered.standing), entered.inward), handle=door)

    def _spot(self, index: int, keyframe: Keyframe, mood: Emotion, place: Place) -> Spot:
        need = NEEDS[keyframe.skill]
        if self.on is not None and self.on.affordance == need and self._is_on(place):
            return self.on  # who rests there rests otherwise
        if place.object_id is None:
            if keyframe.skill is Skill.TOUCH:
                raise UnreachableError(f"{moment(index)}: nothing to touch, {keyframe.furniture!r} is not in the home")
            return self._on_floor(need, place.room)
        placed = self.home.object(place.object_id)
        found = self._reachable(placed, need)
        if not found:
            piece = f"{display_name(placed.category)} ({place.object_id})"
            raise UnreachableError(
                f"{moment(index)}: no spot to {need} on the {piece} can be walked to",
                "clear the way to it, or choose another room",
            )
        if need == "touch":
            chosen = getattr(keyframe, "object_id", None) is not None
            return self._to_touch(found if chosen else self._high_enough(found, keyframe, place), keyframe.caption)
        # Who sits or lies there lies down, or sits up, without leaving the piece.
        found = [s for s in found if alongside(self.on, s)] or found
        if need == "sit":
            caption = self.seated_for[index] if index < len(self.seated_for) else keyframe.caption
            return seat_for(found, mood, caption, self._elbows.solid, self.scale)
        return place_to_lie(found, keyframe.caption)

    def _high_enough(self, found: list[Spot], keyframe: Keyframe, place: Place) -> list[Spot]:
        """Spots of another piece of the room where one is to reach high and this one is low: nobody stretches down to
        a mattress. The nearest piece that is high, else of medium height, else this one all the same."""
        if height_of(keyframe.caption) != "high" or any(spot.height == "high" for spot in found):
            return found
        there = [one for one in self.home.objects if int(one.id.partition("/")[0]) == place.room]
        there = [one for one in there if one.position[1] < STANDS_ON_FLOOR]  # pictures are no shelves
        others = [spots for one in there if (spots := self._reachable(one, "touch"))]
        for height in ("high", "medium"):
            if height == "medium" and any(spot.height == "medium" for spot in found):
                return found
            level = [[spot for spot in spots if spot.height == height] for spots in others]
            if nearest := min(filter(None, level), key=lambda spots: self._away(spots[0]), default=None):
                return nearest
        return found

    def _away(self, spot: Spot) -> float:
        """How far the body is from where one stands for a spot (metres)."""
        return 0.0 if self.at is None else _between(spot.standing, self.at)

    def _is_on(self, place: Place) -> bool:
        """Whether what the body rests on still is that place."""
        if self.on is None or place.object_id is not None:
            return self.on is not None and self.on.object_id == place.object_id
        x, _, z = self.on.point
        return self.on.object_id == "floor" and self.home.room_at((x, z)) == place.room

    def _to_touch(self, found: list[Spot], caption: str) -> Spot:
        """One of the spots of a piece of the wanted height, with room for arms, on which nothing lies."""
        wanted = height_of(caption)
        found = [s for s in found if self._elbows.within_arms_way(s)] or found
        if handling_of(caption) == "knock":
            found = to_knock_on(found, self._elbows.solid, self.scale)
        level = [[s for s in found if s.height == height] for height in (wanted, "medium", "low")]
        suited = ([s for s in some if suits(s, caption, self._elbows.solid)] for some in level)
        found = next(filter(None, suited), level[0] or level[1] or found)
        # Fronts before tops of what is taller than the chest: an arm does not go over an edge by itself.
        found = [s for s in found if s.normal[1] < 0.5 or s.point[1] < 1.2] or found
        found = [s for s in found if self._is_before_front(s)] or found
        if wanted == "high":
            found = self._elbows.roomiest(found)
            found.sort(key=lambda s: -s.point[1])
            found = [s for s in found if s.point[1] > found[0].point[1] - 0.1]
        found = [s for s in found if self._is_here(s)] or found
        least = min(self._cluttered(s) for s in found)
        found = [s for s in found if self._cluttered(s) == least]
        # The body may come back to a piece: it need not touch the very same place again.
        found = self._elbows.roomiest(found)
        return found[int(self.rng.integers(min(len(found), 3)))]

    def _is_before_front(self, spot: Spot) -> bool:
        """Whether one stands where the doors, drawers or shelves of a piece are."""
        placed = self.home.object(spot.object_id)
        return has_front(placed.category) and cos(spot.facing - placed.yaw) < -cos(FRONT)

    def _is_here(self, spot: Spot) -> bool:
        """Whether the body is there, or a step aside: nobody walks round a thing to touch it again."""
        if self.at is None or self.walks_on:
            return False
        return _between(spot.standing, self.at) < A_STEP

    @cached_property
    def fronts(self) -> OpenFronts:
        """What stands open."""
        return OpenFronts(self.home, self.walkable, scene_of(self.home).obstacles.solid(), self.scale)

    @cached_property
    def _elbows(self) -> ElbowRoom:
        return ElbowRoom(self.walkable, scene_of(self.home).obstacles.solid())

    def _reachable(self, placed: Placed, need: str) -> list[Spot]:
        """Spots whose standing point can be walked to, best first: as they come, the nearer side first when lying."""
        start = self.at or self.walkable.random_point(np.random.default_rng(0), 0)
        found = [s for s in spots(placed, need) if can_stand(self.walkable, start, s)]
        # A seat with a laptop on it is taken.
        found.sort(key=self._cluttered)
        if need == "lie":
            found.sort(
                key=lambda s: (
                    self._cluttered(s),
                    _scoots(s),
                    round(_between(s.standing, start), 1),
                )
            )
        return found

    def _cluttered(self, spot: Spot) -> int:
        """How many things lie or stand where a body or its hand would."""
        reach = {"sit": 0.35, "lie": 0.8, "touch": 0.2}[spot.affordance]
        things = (placed.position for placed in self.home.objects if placed.parent == spot.object_id)
        return sum(np.hypot(x - spot.point[0], z - spot.point[2]) < reach for x, _, z in things)

    def _on_floor(self, need: str, room: int) -> Spot:
        """The freest place of a room to sit or lie on the floor, and the freest direction there."""
        best: tuple[float, Spot] | None = None
        length = 0.9 if need == "lie" else 0.5
        for attempt in range(FLOOR_TRIES):
            if best is None or attempt < FLOOR_TRIES // 2:
                point, turned = self.walkable.random_point(self.rng, room), 0.0
            else:  # in a crowded room beside the best so far, but not through a wall or a doorway
                x, _, z = best[1].point
                aside_x, aside_z = self.rng.normal(0.0, BESIDE_BEST, 2).tolist()
                point, turned = (x + aside_x, z + aside_z), float(self.rng.normal(best[1].facing, TURNED_ASIDE))
                if self.home.room_at(point) != room or not self.walkable.sees((x, z), point):
                    continue
            for yaw in turned + np.arange(8) * np.pi / 4:
                ahead = np.array([np.sin(yaw), np.cos(yaw)])
                ends = [np.asarray(point) + share * length * ahead for share in (-1.0, -0.5, 0.5, 1.0)]
                spot = floor_spot(need, point, float(yaw))
                if need == "lie":
                    ends += [np.asarray(spot.standing) + share * ahead for share in KNEELING]
                room_left = min(self.walkable.clearance((float(e[0]), float(e[1]))) for e in ends)
                if best is None or room_left > best[0]:
                    best = (room_left, spot)
            if best is not None and best[0] > FREE_FLOOR:
                break
        if best is None or best[0] <= 0.0:
            raise UnreachableError(f"room {room} has no free floor to {need} on", "choose another room")
        return best[1]

    def walks(
        self, drafts: list[Action], places: Sequence[Place], begins: Point, aimed: Sequence[bool]
    ) -> list[Action]:
        """Give every walk its goal: where the next contact with the same thing begins, beside a thing, or anywhere.

        `begins` is where the body stands before the first of them; those that are `aimed` have their goal.
        """
        done: list[tuple[Action, Point | None]] = []
        at: Point | None = begins
        for index, action in enumerate(drafts):
            if action.skill is Skill.LOCO and not aimed[index]:
                following = drafts[index + 1] if index + 1 < len(drafts) else None
                came = done[-1][1] if done and done[-1][0].skill is Skill.LOCO else None
                leg = _Leg(came, at, None if following is None else self._leads_to(following, places[index + 1]))
                if following is not None and runs(action) and self._leads_on(action, following, places[index + 1]):
                    after = drafts[index + 2] if index + 2 < len(drafts) else None
                    way = self._walk(following, after, places[index + 1], leg)
                    action = replace(action, goal=way.goal, facing=way.facing)
                else:
                    action = self._aimed(action, following, places[index], leg, done)
            if index == len(drafts) - 1 and action.keyframe not in self.out:  # who has left stands nowhere
                action = _last(action)
            done.append((action, at))
            at = action.goal or (action.spot.standing if action.spot else at)
        return [action for action, _ in done]

    def _aimed(
        self,
        action: Action,
        following: Action | None,
        place: Place,
        leg: _Leg,
        done: Sequence[tuple[Action, Point | None]],
    ) -> Action:
        """A walk with its goal; who stands still or waves has none."""
        wanders, at = place.object_id is None, leg.at
        if action.keyframe == 0 and self.entered is not None and "door" in self.openings[1:3]:
            return replace(action, goal=self.entered.standing, facing=None)  # to shut it
        kind = self.openings[action.keyframe] if wanders else None
        if kind is not None and (kind == "door" or stays(action.caption) or action.keyframe in self.to_window):
            return self._before(kind, action, place, at)
        if wanders and action.goal is not None and (following is None or following.object_id != "floor"):
            return action  # where it wandered before is as good as anywhere
        ahead = in_front(action.caption, self.walkable, at, done) if wanders else None
        if ahead is not None:
            return replace(action, goal=ahead, facing=None)
        if wanders and (seconds := stays(action.caption)):
            return replace(action, hold=seconds)
        walk = replace(self._walk(action, following, place, leg), stands=stays(action.caption))
        return self._run(walk, place.room, at) if at is not None and runs(action) else walk

    def _leads_on(self, action: Action, following: Action, place: Place) -> bool:
        """Whether who runs nowhere in particular runs to where the walk after it would lead."""
        if action.object_id is not None or self.openings[action.keyframe] is not None:
            return False
        return following.skill is Skill.LOCO and place.object_id is not None and not stays(following.caption)

    def _run(self, action: Action, room: int, at: Point) -> Action:
        """A run with room for it: where it leads to no place in particular, to where it is longest, in another room too
        if need be; to one that is near by a place that is farther."""
        to = None if action.facing is None else action.goal
        ways = [way_to_run(self.walkable, at, room, self.rng, to)]
        if to is None and (ways[0] is None or ways[0].straight < LONG_ENOUGH):
            ways += [way_to_run(self.walkable, at, one, self.rng) for one in range(len(self.home.rooms)) if one != room]
        way = max(filter(None, ways), key=lambda one: one.straight, default=None)
        return action if way is None else replace(action, goal=way.goal, by=way.by)

    def _before(self, kind: Kind, action: Action, place: Place, at: Point | None) -> Action:
        """Who is to stand at a window or to get to a door goes there, and who stays looks out."""
        found = opening_place(self.home, self.walkable, kind, place.room, at)
        if found is None:
            return replace(action, lacks=LACKS[kind])
        outside = found.outside(self.walkable) if kind == "door" and action.keyframe in self.out else None
        if outside is not None:
            action = self.fronts.passed(action, found.spot("medium", self.scale))
            return replace(action, goal=outside, facing=found.facing)
        stands = max(seconds, LOOKS_OUT) if (seconds := stays(action.caption)) else 0.0
        return replace(action, goal=found.standing, facing=found.facing, stands=stands)

    def _walk(self, action: Action, following: Action | None, place: Place, leg: _Leg) -> Action:
        same = following is not None and following.skill in NEEDS and following.object_id == action.object_id
        # What is done elsewhere than planned, at a window say, is reached by the walk to what was planned for it.
        same = same or (following is not None and following.keyframe in self.elsewhere)
        if following is not None and following.spot is not None and (same or following.object_id == "floor"):
            spot = following.spot
            return replace(action, goal=spot.standing, facing=spot.approach)
        if place.object_id is not None:
            placed = self.home.object(place.object_id)
            beside, sides = self._reachable(placed, "touch"), self._reachable(placed, "lie")
            near = leg.onward or leg.at
            if sides and near is not None:  # of a bed, its side
                side = min((one.standing for one in sides), key=lambda one: _between(one, near))
                beside.sort(key=lambda one: _between(one.standing, side))
            if beside:
                return replace(action, goal=beside[0].standing, facing=beside[0].facing)
        return replace(action, goal=self._anywhere(place.room, leg), facing=None)

    def _leads_to(self, following: Action, place: Place) -> Point | None:
        """Where the body goes next, as far as that is known."""
        if following.spot is not None:
            return following.spot.standing
        if following.skill is not Skill.LOCO or place.object_id is None:
            return following.goal
        x, _, z = self.home.object(place.object_id).position
        return (x, z)

    def _anywhere(self, room: int, leg: _Leg) -> Point:
        """A place to wander to: some way off, with room around it, not through the whole house, and neither one that a
        walking body would have to turn back for nor one that it would have to turn back at to get where it goes next.

        A body that cannot get into the room from where it is is told of a place there all the same: the motion says so.
        """
        found = [self.walkable.random_point(self.rng, room) for _ in range(12)]
        start, came, onward = leg.at, leg.came, leg.onward
        if start is None or not any(self.walkable.reachable(start, point) for point in found):
            start = self.walkable.random_point(self.rng, room)
        points = [point for point in found if self.walkable.reachable(start, point)]
        if not points:
            raise UnreachableError(f"nothing in room {room} can be walked to from {start}")

        def worth(point: Point) -> float:
            length, left = (float(np.hypot(*np.subtract(point, end))) for end in (start, onward or start))
            return (
                min(length, 2.2 * PACING)
                - 4.0 * max(PACING - min(length, left), 0.0)
                - 0.4 * max(length - 3 * PACING, 0.0)
                + min(self.walkable.clearance(point), 0.8)
                + (0.0 if came is None else GOES_ON * _straight_on(came, start, point))
                + (0.0 if onward is None else GOES_ON * _straight_on(start, point, onward))
            )

        return max(points, key=worth)


class _Leg(NamedTuple):
    """Three places of who walks; None where that is not known."""

    came: Point | None
    """Where the walk before this one began."""
    at: Point | None
    onward: Point | None
    """Where the body goes after this walk."""


def _between(one: Point, other: Point) -> float:
    return float(np.hypot(one[0] - other[0], one[1] - other[1]))


def _straight_on(start: Point, middle: Point, end: Point) -> float:
    """How straight the way over a place is: 1 straight on, -1 back again."""
    before, after = np.subtract(middle, start), np.subtract(end, middle)
    return float(before @ after / max(np.linalg.norm(before) * np.linalg.norm(after), 1e-6))


def can_stand(walkable: Walkable, start: Point, spot: Spot) -> bool:
    """Whether a spot's standing point is nearly free, can be walked to, and no wall is between the two."""
    if walkable.nearest_free(spot.standing, within=STEP) is None or not walkable.reachable(start, spot.standing):
        return False
    # A body sits down from between things; where it stands to touch, its legs need room.
    if spot.affordance == "touch" and walkable.clearance(spot.standing) < LEG_ROOM:
        return False
    # Furniture may stand a little into its own wall; the next room's wall is farther from it than that.
    goal, here = np.array(spot.point)[[0, 2]], np.array(spot.standing)
    way = goal - here
    length = float(np.hypot(*way))
    return walkable.sees(spot.standing, tuple(here + way * max(1.0 - WALLED / max(length, WALLED), 0.0)))


def _scoots(spot: Spot) -> float:
    """How far along a bed one moves between sitting down on its edge and lying (metres)."""
    (x, _, z), (stand_x, stand_z) = spot.point, spot.standing
    return round(abs((stand_x - x) * sin(spot.facing) + (stand_z - z) * cos(spot.facing)), 1)


def _last(action: Action) -> Action:
    """The last of a story: one stays in it, or where one stands after it."""
    if ENDS[action.skill] is Posture.STANDING and (action.skill is not Skill.LOCO or action.goal is not None):
        return replace(action, stands=max(action.stands, LAST_HOLD))
    return replace(action, hold=action.hold + LAST_HOLD)


def height_of(caption: str) -> str:
    """The height a touch caption asks for: low, medium or high."""
    text = caption.lower()
    if "high" in text or "above" in text or "up to" in text:
        return "high"
    if "low" in text or "prone" in text or "bend" in text or "under" in text:
        return "low"
    return "medium"
