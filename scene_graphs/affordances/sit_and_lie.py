"""Seats and places to lie, found on the seats and mattresses of a piece."""

from __future__ import annotations

from collections.abc import Iterator
from math import atan2, inf

from scene_graphs.affordances.spot import FORWARD, REACH_AHEAD, Spot, ahead, dot, extent, to_world
from scene_graphs.furniture_shapes import Part, form_of
from scene_graphs.layout import Placed, Point2, Point3, wrap

EDGE = 0.33
"""How far behind a seat's front edge the pelvis comes to rest, depth permitting."""
TORSO = 0.16
"""Least distance of a seated pelvis to the backrest plane."""
BESIDE_BED = 0.12
"""Distance of the standing pelvis from the edge of what it will lie on: near enough to sit down on it first."""
ALONG_BED = (0.0, -0.3, 0.3, -0.6)
"""How much nearer to the head than one lies one may sit down first, where something stands beside a bed, in metres."""
SEAT_END = 0.2
"""Least distance of the one who sits there to the end of the bed."""
SIT_HEIGHTS = (0.28, 0.68)
LIE_HEIGHTS = (0.18, 0.80)
TO_HEAD, TO_FOOT, MIN_SOFA_LENGTH = 0.85, 0.95, 1.55
MIN_MATTRESS_LENGTH = 1.2
"""Of one that somebody lies on with the legs drawn up, or the feet beyond its end."""
ABREAST = 0.8
"""Length of a mattress against its width from which on its head is where its pillows are: short beds may be wider."""
ASIDE = 0.55
"""Distance of who lies to the edge of the bed, width permitting: curled up, the head is a quarter of a metre nearer."""
_LOW_TABLES = frozenset({"coffee_table", "pedestal_table", "table"})
_UP = (0.0, 1.0, 0.0)
_AROUND = [FORWARD, (1.0, 0.0), (-1.0, 0.0), (0.0, -1.0)]
Room = tuple[Point3, Point3]
"""Opposite corners of a box in a piece's frame."""


def sitting(placed: Placed, solid: list[Part]) -> Iterator[Spot]:
    """Spots to sit on: the fronts of seats, the long sides and foot of beds, the edges of low tables."""
    low_table = form_of(placed.category) in _LOW_TABLES
    roles = ("seat", "mattress", "top") if low_table else ("seat", "mattress")
    for seat in (part for part in solid if part.role in roles):
        if not SIT_HEIGHTS[0] <= placed.position[1] + seat.top <= SIT_HEIGHTS[1]:
            continue
        for u in _directions(seat, solid):
            yield from _seats_along(placed, solid, seat, u)


def _seats_along(placed: Placed, solid: list[Part], seat: Part, u: Point2) -> Iterator[Spot]:
    """Spots side by side along the edge of a seat that lies in direction u."""
    across, depth = extent(seat, (u[1], -u[0])), extent(seat, u)
    if across < 0.28 or depth < 0.24:
        return
    backrest = _backrest(seat, solid, u)
    edge = min(EDGE, max(depth - TORSO, 0.1)) if backrest < inf else min(EDGE, depth / 2 + 0.04)
    for lateral in _laterals(across, seat.role):
        local = _on_top(seat, u, depth / 2 - edge, lateral)
        if _cuts(solid, seat, _legs_room(local, u, edge)) or _cuts(solid, seat, _torso_room(local, u, seat.top)):
            continue
        yaw = wrap(placed.yaw + atan2(*u))
        standing = to_world(placed, ahead(local, u, REACH_AHEAD))
        stand = (standing[0], standing[2])
        yield Spot("sit", placed.id, to_world(placed, local), _UP, yaw, stand, yaw, edge, backrest - edge)


def lying(placed: Placed, solid: list[Part]) -> Iterator[Spot]:
    """Spots to lie on: beds from both sides, head at the headboard; sofas from the front, head at either arm."""
    for bed in (part for part in solid if part.role in ("mattress", "seat")):
        if not LIE_HEIGHTS[0] <= placed.position[1] + bed.top <= LIE_HEIGHTS[1]:
            continue
        if _is_long(bed):
            ways = [(u, (0.0, -1.0)) for u in ((1.0, 0.0), (-1.0, 0.0))]
        elif bed.size[0] >= MIN_SOFA_LENGTH and bed.size[2] >= 0.5:
            ways = [(FORWARD, head) for head in ((-1.0, 0.0), (1.0, 0.0))]
        else:
            continue
        for shift in ALONG_BED:
            for u, head in ways:
                yield from _lying_along(placed, solid, bed, (u, head), shift)


def _is_long(bed: Part) -> bool:
    """Whether one lies on it with the head at its back, not at one of its arms."""
    width, length = bed.size[0], bed.size[2]
    if bed.role == "mattress" and length >= max(MIN_MATTRESS_LENGTH, ABREAST * width):
        return width >= 0.5
    return length >= MIN_SOFA_LENGTH and width >= 0.5


def _lying_along(
    placed: Placed, solid: list[Part], bed: Part, way: tuple[Point2, Point2], shift: float
) -> Iterator[Spot]:
    """The spot reached from the edge in direction u, the head towards `head`, sitting down `shift` nearer to the head
    than one lies; none where the legs would cut or the bed ends."""
    u, head = way
    length, width = extent(bed, head), extent(bed, u)
    spare = length - TO_HEAD - TO_FOOT
    back = TO_HEAD + min(0.25 * max(spare, 0.0), 0.1)  # on a short one the feet have less room, not the head
    edge = min(max(width / 4, ASIDE), width / 2)
    along, sideways = length / 2 - back, width / 2 - edge
    x, z = (bed.center[axis] + head[axis // 2] * along + u[axis // 2] * sideways for axis in (0, 2))
    local = (x, bed.top, z)
    seat = ahead(ahead(local, head, shift), u, edge - EDGE)
    if abs(along + shift) > length / 2 - SEAT_END or _cuts(solid, bed, _legs_room(seat, u, EDGE)):
        return
    standing = to_world(placed, ahead(seat, u, EDGE + BESIDE_BED))
    facing, approach = (wrap(placed.yaw + atan2(*direction)) for direction in (head, u))
    stand, point = (standing[0], standing[2]), to_world(placed, local)
    yield Spot("lie", placed.id, point, _UP, facing, stand, approach, edge, back, length - back)


def _directions(seat: Part, solid: list[Part]) -> list[Point2]:
    """Edges to sit on: the long sides of a bed and its foot; away from the back of a chair or of each wing of a sofa;
    all round a stool."""
    has_arms, backs = any(part.role == "arm" for part in solid), [part for part in solid if part.role == "back"]
    if seat.role == "mattress" or (seat.size[2] > 1.2 and not (has_arms or _is_backed(seat, backs, (1.0, 0.0)))):
        return [(1.0, 0.0), (-1.0, 0.0), FORWARD]
    if has_arms or backs:
        return [u for u in _AROUND if _is_backed(seat, backs, u) and not _is_shut(seat, solid, u)] or [FORWARD]
    return _AROUND


def _is_backed(seat: Part, backs: list[Part], u: Point2) -> bool:
    """Whether there is a back behind one who sits on the seat looking to u."""
    return _backrest(seat, backs, u) < inf


def _is_shut(seat: Part, solid: list[Part], u: Point2) -> bool:
    """Whether something rises right at the edge in direction u."""
    return _backrest(seat, solid, (-u[0], -u[1])) < extent(seat, u) + REACH_AHEAD


def _backrest(seat: Part, solid: list[Part], u: Point2) -> float:
    """Distance from the edge in direction u back to the nearest face that rises above the seat; inf if none does."""
    rim = dot(seat.center, u) + extent(seat, u) / 2
    v = (u[1], -u[0])
    gaps = [
        rim - (dot(part.center, u) + extent(part, u) / 2)
        for part in solid
        if part.top > seat.top + 0.15
        and abs(dot(part.center, v) - dot(seat.center, v)) < (extent(part, v) + extent(seat, v)) / 2 - 0.05
        and dot(part.center, u) < dot(seat.center, u)
    ]
    return min(gaps, default=inf)


def _laterals(across: float, role: str) -> list[float]:
    """Offsets of seats side by side; on a bed away from the pillows, which lie at its -z end."""
    if role == "mattress":
        return [0.0, 0.22 * across, -0.22 * across] if across >= 1.5 else [0.0]
    count = max(1, int(across / 0.6)) if across >= 1.1 else 1
    offsets = [(index - (count - 1) / 2) * across / count for index in range(count)]
    return sorted(offsets, key=lambda offset: (abs(offset), offset))


def _on_top(seat: Part, u: Point2, forward: float, lateral: float) -> Point3:
    x, z = seat.center[0], seat.center[2]
    return (x + u[0] * forward + u[1] * lateral, seat.top, z + u[1] * forward - u[0] * lateral)


def _legs_room(local: Point3, u: Point2, edge: float) -> Room:
    """The box shanks and feet fill in front of a seat, from its edge down to the floor."""
    return _room(local, u, (edge + 0.01, REACH_AHEAD + 0.19), (-9.0, -0.005))


def _torso_room(local: Point3, u: Point2, top: float) -> Room:
    return _room((local[0], top, local[2]), u, (-0.12, 0.2), (0.03, 0.86))


def _room(local: Point3, u: Point2, reaches: tuple[float, float], up: tuple[float, float]) -> Room:
    half = 0.17
    v = (abs(u[1]) * half, abs(u[0]) * half)
    near, far = (tuple(local[axis] + u[axis // 2] * reach for axis in (0, 2)) for reach in reaches)
    low = (min(near[0], far[0]) - v[0], max(0.02, local[1] + up[0]), min(near[1], far[1]) - v[1])
    high = (max(near[0], far[0]) + v[0], local[1] + up[1], max(near[1], far[1]) + v[1])
    return low, high


def _cuts(solid: list[Part], own: Part, room: Room) -> bool:
    """Whether a part other than the surface itself reaches into a box."""
    low, high = room
    return any(
        all(part.low[axis] < high[axis] - 1e-6 and low[axis] < part.high[axis] - 1e-6 for axis in range(3))
        for part in solid
        if part is not own
    )
