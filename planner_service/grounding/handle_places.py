"""Where a hand takes hold of what it opens or shuts, and where one stands so that a door swings past and an arm follows
it: of all fronts, sides, hands and ways to stand the one that strains the arm least.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Final, Literal

import numpy as np

from motion_backend.body.scene_collision import Obstacles
from motion_backend.motion import Action, Does, Handle
from motion_backend.rotations import Array
from planner_service.grounding.opening_places import opening_piece
from scene_graphs.affordances.affordances import Spot
from scene_graphs.furniture import class_of
from scene_graphs.home import Home
from scene_graphs.layout import Placed, Point2, Point3, wrap
from scene_graphs.meshes.moving_parts import Mechanism, mechanisms
from scene_graphs.navigation.path_planner import Walkable

ASIDE: Final = (0.0, 0.1, -0.1, 0.2, -0.2, 0.3, -0.3, 0.4, -0.4, 0.5, -0.5)
BEFORE: Final = (0.38, 0.44, 0.5, 0.56, 0.64, 0.72)
"""How far aside of a handle one may stand, and how far before it (metres)."""
TURNED: Final = (0.3, 0.6, 0.9)
"""How much of the way one is turned from straight before the front to the middle of the handle's way."""
SHARES: Final = (1.0, 0.85, 0.7, 0.55, 0.42)
"""How far a front may be opened, of as far as it goes."""
ALONG: Final = np.linspace(0.0, 1.0, 7)
"""Where on its way a handle is looked at."""
BODY: Final = 0.2
"""From the middle of a body to what swings past it, at least (metres)."""
SHOULDER, HIGH = 0.19, 1.38
"""A shoulder from the middle of the body, and how high it is (metres at 1.70 m)."""
FAR, NEAR = 0.54, 0.28
"""From a shoulder to a wrist that one leans for, and seen from above to one that is too near (metres at 1.70 m)."""
LEANS: Final = np.linspace(0.0, 0.24, 7)
"""How far shoulders get ahead as one leans (metres)."""
BENT: Final = 0.4
"""How far below a shoulder is what one bends down to rather than reaches (metres)."""
OFF: Final = 0.06
"""A wrist from the handle, towards the body (metres)."""
BEHIND: Final = -0.25
"""How far behind the line of the shoulders a hand may be: the cosine from straight ahead."""
HEIGHTS: Final = {"high": 1.3, "medium": 0.62}
"""From which height on a handle is high, or of medium height (metres)."""
UNOPENED, ELSEWHERE, MOVED = 2.5, 0.4, 0.15
"""What it strains not to open all of it; to go to a handle that is a metre from where the hand would have gone, and to
stand a metre from where one would have stood."""
MOST: Final = 1.8
"""What strains more than this is not done by hand."""


@dataclass(frozen=True)
class HandlePlace:
    """A handle, the hand that takes it, and where its body stands."""

    handle: Handle
    hand: Literal["left", "right"]
    normal: Point3
    """Out of the front, in the world."""
    standing: Point2
    facing: float

    def spot(self, object_id: str) -> Spot:
        """Where the hand stays: what it has opened is open, what it has shut is shut."""
        x, y, z = self.handle.at(0.0 if self.handle.does == "close" else 1.0).tolist()
        height = next((name for name, least in HEIGHTS.items() if y >= least), "low")
        return Spot("touch", object_id, (x, y, z), self.normal, self.facing, self.standing, self.facing, height=height)

    def inside(self, piece: Placed, spot: Spot) -> Spot:
        """A place in the middle of what is open, as high as the spot of the piece that would be touched else."""
        front = [one for one in mechanisms(piece) if one.kind == "front"][self.handle.front]
        middle = ((front.low[0] + front.high[0]) / 2, 0.0, front.high[2])
        x, _, z = piece.to_world(np.array(middle) + (np.array(front.moving[-1].way) * [0.4, 0.0, 0.4])).tolist()
        y = float(np.clip(spot.point[1], piece.position[1] + front.low[1] + 0.1, piece.position[1] + front.high[1]))
        standing, facing = self.standing, self.facing
        return replace(spot, point=(x, y, z), normal=self.normal, standing=standing, facing=facing, approach=facing)


def handle_place(
    piece: Placed,
    does: Does,
    near: Spot,
    walkable: Walkable,
    depth: Callable[[Array], Array],
    ajar: Handle | None = None,
    scale: float = 1.0,
) -> HandlePlace | None:
    """How a piece is opened or shut by who would be at a spot of it; None where no arm does it, or nothing of it opens.

    `depth` says how deep points (N, 3) are in other furniture and walls; `ajar` is what is open of the piece already.
    """
    fronts = [one for one in mechanisms(piece) if one.kind == "front"]
    chosen = range(len(fronts)) if ajar is None else [ajar.front]
    best: tuple[float, HandlePlace] | None = None
    for number in chosen:
        if fronts[number].grip is None:
            continue
        for share in SHARES if ajar is None else (ajar.share,):
            handle = _handle(piece, fronts[number], does, number, share)
            less, strain = UNOPENED * (1.0 - share), ELSEWHERE * _elsewhere(handle, near)
            if (best is not None and less + strain >= best[0]) or _is_blocked(piece, fronts[number], share, depth):
                continue
            for place, more in _places(handle, piece, fronts[number], near, walkable, scale):
                if strain + more < MOST and (best is None or less + strain + more < best[0]):
                    best = less + strain + more, place
    return best[1] if best is not None else None


def _elsewhere(handle: Handle, near: Spot) -> float:
    """How far a handle is from where the hand would have gone (metres)."""
    away = np.subtract(handle.shut, near.point)
    return float(np.hypot(np.hypot(away[0], away[2]), away[1]))


def _handle(piece: Placed, front: Mechanism, does: Does, number: int, share: float) -> Handle:
    leaf = front.moving[-1]
    assert front.grip is not None
    (hinge_x, _, hinge_z), (x, y, z) = piece.to_world(leaf.pivot).tolist(), piece.to_world(front.grip).tolist()
    way = piece.to_world(np.array(leaf.way)) - piece.to_world(np.zeros(3))
    wx, wy, wz = (share * way).tolist()
    return Handle(does, (x, y, z), (hinge_x, hinge_z), float(leaf.turn * share), (wx, wy, wz), number, share)


def _places(
    handle: Handle, piece: Placed, front: Mechanism, near: Spot, walkable: Walkable, scale: float
) -> Iterator[tuple[HandlePlace, float]]:
    """Ways to stand before a handle, each with what it strains."""
    out, along = (np.array([np.sin(piece.yaw + turn), np.cos(piece.yaw + turn)]) for turn in (0.0, np.pi / 2))
    way = handle.at(ALONG)
    middle, swept = way[len(way) // 2, [0, 2]], _leaf(piece, front, handle.share, heights=1)[:, [0, 2]]
    normal = (float(out[0]), 0.0, float(out[1]))
    for aside, away in product(ASIDE, BEFORE):
        standing = np.array(handle.shut)[[0, 2]] + aside * along + away * scale * out
        place = (float(standing[0]), float(standing[1]))
        if np.linalg.norm(swept - standing, axis=1).min() < BODY or not _stands(place, near, walkable):
            continue
        moved = MOVED * float(np.hypot(*np.subtract(place, near.standing)))
        straight, to = float(np.arctan2(*-out)), float(np.arctan2(*(middle - standing)))
        for hand, turned in product(("right", "left"), TURNED):
            facing = wrap(straight + turned * wrap(to - straight))
            strain = _strain(standing, facing, hand, way, out, scale)
            yield HandlePlace(handle, hand, normal, place, facing), strain + moved  # type: ignore[arg-type]


def _strain(standing: Array, facing: float, hand: str, way: Array, out: Array, scale: float) -> float:
    """What it costs a hand to go a way (N, 3)."""
    left = np.array([np.cos(facing), -np.sin(facing)])
    ahead = np.array([np.sin(facing), np.cos(facing)])
    shoulder = standing + (1.0 if hand == "left" else -1.0) * SHOULDER * scale * left
    gone = way[:, [0, 2]] + OFF * out - shoulder
    far = np.linalg.norm(gone, axis=1)
    below = np.minimum(np.abs(way[:, 1] - HIGH * scale), BENT)
    behind = np.clip(BEHIND - gone @ ahead / np.maximum(far, 1e-6), 0.0, None)
    across = np.clip(-(1.0 if hand == "left" else -1.0) * (gone @ left) - 0.25, 0.0, None)
    under = np.clip(NEAR * scale - far, 0.0, None)
    # A body that leans takes its shoulders ahead.
    leant = np.linalg.norm(gone[:, None] - LEANS[:, None] * ahead, axis=2)
    over = np.clip(np.hypot(leant, below[:, None]) - FAR * scale, 0.0, None)
    effort = (12.0 * over + 1.5 * LEANS).min(axis=1)
    return float(effort.max() + 0.5 * effort[0] + 2.0 * under.max() + behind.max() + across.max())


def _leaf(piece: Placed, front: Mechanism, share: float, heights: int = 3) -> Array:
    """Points of what swings or slides all along its way, in the world. (N, 3)."""
    leaf, (low, high) = front.moving[-1], front.leaf
    low_y, high_y = front.low[1] + 0.08, front.high[1] - 0.08
    levels, found = np.linspace(low_y, high_y, heights), list[tuple[float, float, float]]()
    for part in share * ALONG:
        turn, origin = leaf.turn * part, np.array(leaf.pivot) + part * np.array(leaf.way)
        for reach in np.linspace(0.25 if leaf.turn else 0.0, 1.0, 5):
            x = low + reach * (high - low) if abs(low) < 1e-6 or not leaf.turn else high + reach * (low - high)
            place = origin + x * np.array([np.cos(turn), 0.0, -np.sin(turn)])
            found += [(place[0], y, place[2] + 0.02) for y in levels]
    return np.asarray(piece.to_world(np.array(found)))


def _is_blocked(piece: Placed, front: Mechanism, share: float, depth: Callable[[Array], Array]) -> bool:
    """Whether something stands where it swings or slides."""
    points = piece.to_local(_leaf(piece, front, share))
    clear = points[:, 2] > front.high[2] + 0.03  # else it is still in its piece, or beside one that is flush with it
    return bool(clear.any()) and float(depth(piece.to_world(points[clear])).max()) > 0.0


def _stands(place: Point2, near: Spot, walkable: Walkable) -> bool:
    return walkable.is_free(place) and walkable.reachable(near.standing, place) and walkable.sees(near.standing, place)


@dataclass
class OpenFronts:
    """What of a home stands open while actions are being grounded."""

    home: Home
    walkable: Walkable
    solid: Obstacles
    scale: float
    ajar: dict[str, HandlePlace] = field(default_factory=dict)
    """By piece, as it was opened."""

    def touched(self, action: Action, does: Literal[Does, ""], named: str) -> Action:
        """An action whose hand opens or shuts what it is at, with the handle and where one stands for it; the same
        where nothing of that opens, or no arm does it. What is done in a piece that is open is done from where it was
        opened."""
        assert action.spot is not None
        piece = self._piece(action.spot, named)
        if piece is None:
            return action
        ajar = self.ajar.get(piece.id)
        if ajar is not None and does != "close":
            return replace(action, spot=ajar.inside(piece, action.spot)) if does != "open" else action
        return self._with(action, piece, does, ajar) if does == "open" or does == "close" or does == "into" else action

    def entered(self, place: Point2) -> Handle | None:
        """Somebody comes in by the door at [x, z], which is open behind them: its handle, if a hand can shut it."""
        door = opening_piece(self.home, True, place)
        if door is None:
            return None
        inward = door.yaw + np.pi
        standing = (float(place[0]), float(place[1]))
        at = (door.position[0], 1.0, door.position[2])
        near = Spot("touch", "door", at, (0.0, 0.0, 1.0), inward, standing, inward)
        if (found := handle_place(door, "close", near, self.walkable, self.solid.depth, None, self.scale)) is not None:
            self.ajar[door.id] = found
        return found.handle if found is not None else None

    def passed(self, action: Action, near: Spot) -> Action:
        """Who leaves by a door opens it first."""
        door = self._piece(near, "door")
        if door is None or door.id in self.ajar:
            return action
        opened = self._with(replace(action, spot=near), door, "open", None)
        return opened if opened.handle is not None else action

    def kept(self, action: Action) -> None:
        """An action that was grounded before: what it opens is open."""
        if action.handle is None or action.spot is None:
            return
        piece = self._piece(action.spot, "")
        hand: Literal["left", "right"] = "left" if action.hand == "left" else "right"
        place = HandlePlace(action.handle, hand, action.spot.normal, action.spot.standing, action.spot.facing)
        if piece is not None:
            self._note(piece, place)

    def _with(self, action: Action, piece: Placed, does: Does, ajar: HandlePlace | None) -> Action:
        near = action.spot
        assert near is not None
        others = self.solid.only(np.array([owner != piece.id for owner in self.solid.owners], dtype=bool))
        was = ajar.handle if ajar is not None else None
        place = handle_place(piece, does, near, self.walkable, others.depth, was, self.scale)
        if place is None:
            return action
        self._note(piece, place)
        return replace(action, spot=place.spot(near.object_id), hand=place.hand, handle=place.handle)

    def _note(self, piece: Placed, place: HandlePlace) -> None:
        if place.handle.does == "open":
            self.ajar[piece.id] = place
        elif place.handle.does == "close":
            self.ajar.pop(piece.id, None)

    def _piece(self, spot: Spot, named: str) -> Placed | None:
        """The door, or the piece that a spot is on, if that is what is named."""
        if spot.object_id in ("door", "window"):
            return opening_piece(self.home, True, (spot.point[0], spot.point[2])) if spot.object_id == "door" else None
        own = next((one for one in self.home.objects if one.id == spot.object_id), None)
        if own is None or (named and class_of(own.category) != class_of(named)):
            return None
        return own
