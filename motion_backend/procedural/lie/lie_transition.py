"""Lying down on a bed and getting up from it, as people do: over the side of the edge, on elbow and hands."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import Bearing
from motion_backend.procedural.held_poses import FOOT_SPLAY, SHIN_REACH, UP, Seat, bend, both_sides, upright
from motion_backend.procedural.lie.lie_keys import LieKeys, LiePose, OverEdge, PushingHands, Rolled, SittingUp
from motion_backend.procedural.lie.lie_pose import Bed, lying
from motion_backend.procedural.lie.lie_styles import Lying
from motion_backend.procedural.pose import Pose, interpolate
from motion_backend.procedural.sit.sit_keys import Move
from motion_backend.procedural.sit.sit_legs import at_front
from motion_backend.procedural.sit.sit_transition import hands_take, place_feet
from motion_backend.procedural.touch.hand_contacts import palm_on
from motion_backend.procedural.walk.footsteps import home_ankle
from motion_backend.rotations import Array
from motion_backend.skeleton import HAND_REST, Skeleton

LIFTED = 0.10
"""How high a leg is lifted over the other one or over the edge (metres)."""
ASIDE, HIGHER = 0.10, 0.03
"""How far it goes aside to come off the other one, and towards the head (metres)."""
CROSSED = 0.07
"""Ankles nearer to each other from side to side are crossed (metres)."""
ON_EDGE, WELL_ON = 0.12, 0.301
"""Who sits on the edge of a bed sits so far inside it at least, and at most (metres)."""
SOFT = 0.01
"""How much lower the pelvis is that sits on what it would lie on (metres)."""
PAST_HAND = 0.12
"""A hand is so far from the end of a bed at least (metres)."""
DOWN = 1.57
"""Legs that hang straight down (radians)."""
CLEAR = 0.01
"""A sole is so far above the floor that it is not put down on yet, at least (metres)."""
FACING_UP = 0.5
"""Who lies with so much of the front up lies on the back (cosine)."""
BESIDE = {"left": "right", "right": "left"}


def edge_seat(bed: Bed, standing_point: tuple[float, float], outward: float, edge: float, scale: float) -> Seat:
    """Where one sits on the edge of a bed before lying down, facing `outward` (yaw)."""
    out = np.array([np.sin(outward), 0.0, np.cos(outward)])
    stand = np.array([standing_point[0], 0.0, standing_point[1]])
    from_bed = float((stand - bed.pelvis) @ out)
    inside = float(np.clip(from_bed - SHIN_REACH * scale, edge - WELL_ON, edge - ON_EDGE))
    along = stand - bed.pelvis - from_bed * out
    along[1] = 0.0
    pelvis = bed.pelvis + inside * out + along
    pelvis[1] = bed.pelvis[1] - SOFT
    return at_front(Seat(pelvis, outward, np.inf, edge - inside), scale)


@dataclass(frozen=True)
class Edge:
    """The edge of a bed that is sat on, for one body."""

    seat: Seat
    bed: Bed
    skeleton: Skeleton

    @cached_property
    def way(self) -> float:
        """1 where the head end is to the left of who sits there, -1 to the right."""
        return 1.0 if np.sin(self.bed.head_yaw - self.seat.yaw) > 0 else -1.0

    @property
    def below(self) -> int:
        """The arm on the side of the head end: it is below in lying on the side."""
        return 0 if self.way > 0 else 1

    @cached_property
    def side(self) -> str:
        """The side that one lies on who looks over the edge."""
        return ("left", "right")[self.below]

    def tilted(self, angle: float) -> Array:
        """What turns who is upright on the edge to the head end: upright at a right angle, lying at 0. (4,)."""
        return rotations.rotvec_to_quat(np.array([0.0, 0.0, -self.way * (np.pi / 2 - angle)]))

    def turned(self, angle: float) -> Array:
        """The same in the world. (4,)."""
        yaw = rotations.yaw_to_quat(self.seat.yaw)
        return rotations.compose(rotations.compose(yaw, self.tilted(angle)), rotations.inverse(yaw))

    def on_mattress(self, headwards: float, out: float) -> Array:
        """Where a hand lies, from where the pelvis sits (metres at 1.70 m). (3,)."""
        scale, bed = self.skeleton.scale, self.bed
        up = np.array([np.sin(bed.head_yaw), 0.0, np.cos(bed.head_yaw)])
        outward = np.array([np.sin(self.seat.yaw), 0.0, np.cos(self.seat.yaw)])
        place = self.seat.pelvis + scale * (headwards * up + out * outward)
        place[1] = bed.surface + HAND_REST
        return np.asarray(place)

    def hands(self, row: PushingHands) -> tuple[Array, Array]:
        """Wrists (2, 3) and palms (2, 4) of both hands where they push."""
        up = np.array([np.sin(self.bed.head_yaw), 0.0, np.cos(self.bed.head_yaw)])
        out = np.array([np.sin(self.seat.yaw), 0.0, np.cos(self.seat.yaw)])
        moved, scale = self.seat.pelvis - self.bed.pelvis, self.skeleton.scale
        room = (self.bed.back - float(moved @ up) - PAST_HAND) / scale
        headwards = float(np.clip(room, row.below_min_headwards_m, row.below_max_headwards_m))
        most = (self.bed.edge - float(moved @ out)) / scale - row.inside_edge_m
        below = self.on_mattress(headwards, min(row.below_out_m, most))
        above = self.on_mattress(row.above_headwards_m, min(row.above_out_m, most))
        yaws = [self.bed.head_yaw - self.way * angle for angle in (row.below_fingers_rad, row.above_fingers_rad)]
        names = (self.side, BESIDE[self.side])
        palms = [palm_on(UP, yaw, name) for yaw, name in zip(yaws, names, strict=True)]
        return self.in_order(np.stack([below, above])), self.in_order(np.stack(palms))

    def in_order(self, hands: Array) -> Array:
        """What is given for the hand below and the one above, for left and right. (2, ...)."""
        return hands if self.below == 0 else hands[::-1]


def on_the_edge(start: Pose, seat: Seat, bearing: Bearing, skeleton: Skeleton, keys: LieKeys, move: Move) -> Pose:
    """From a way of sitting to sitting upright on the edge, feet side by side and hands free."""
    seated = _sitting(keys.up.end, start, seat, skeleton)
    seconds = hands_take(start, seated, move, skeleton) / bearing.tempo
    moved = interpolate([0.0, seconds], [start, replace(seated, ankles=start.ankles, feet=start.feet)], FPS)
    return place_feet(moved, start, seated, move, skeleton)


def lie_down(landed: Pose, seat: Seat, bed: Bed, style: Lying, skeleton: Skeleton, keys: LieKeys) -> Pose:
    """From the edge: onto a hand and the elbow as the legs come up, the side, and over into the way of lying."""
    edge, rows, settle = Edge(seat, bed, skeleton), keys.down.pose, keys.down.settle
    hands = edge.hands(keys.down.hands)
    over = [_over_edge(row, landed, edge, hands) for row in rows]
    rolled = _rolled(keys.down.side, landed, edge, hands, keys.pose)
    end = lying(landed, bed, style, skeleton, keys.pose)
    poses = [_bound_for(over[0], landed), *over, rolled]
    waits = [*(row.wait_s for row in rows), keys.down.side.wait_s]
    # Hands are turned to what they lie on only as they get there.
    if style.side == BESIDE[edge.side]:
        poses.append(_unpressed(lying(landed, bed, gathered(replace(style, side="back")), skeleton, keys.pose), end))
        waits.append(settle.back_wait_s)
    if style.side != edge.side:
        poses.append(_unpressed(lying(landed, bed, gathered(style), skeleton, keys.pose), end))
        waits.append(settle.bent_wait_s)
    lifted = freed(end, bed)
    waits += [settle.lifted_wait_s] * len(lifted)
    waits.append(settle.end_after_lifted_wait_s if lifted else settle.end_wait_s)
    poses = [*poses, *(replace(pose, reach=rolled.reach) for pose in lifted), replace(end, reach=rolled.reach)]
    return _through(poses, waits, style.bearing)


def turn_over(start: Pose, bed: Bed, style: Lying, skeleton: Skeleton, keys: LieKeys) -> Pose:
    """From one way of lying into another: knees up, over the back where the side changes, and into it."""
    settle = keys.down.settle
    end = lying(start, bed, style, skeleton, keys.pose)
    lifted, leaving = freed(end, bed), freed(start, bed)
    poses, waits = [start, *leaving], [keys.up.leave.lifted_wait_s] * len(leaving)
    over = "back" if side_of(start, bed) != style.side else style.side
    for side in dict.fromkeys((over, style.side)):
        poses.append(_unpressed(lying(start, bed, gathered(replace(style, side=side)), skeleton, keys.pose), end))
        waits.append(settle.back_wait_s if side == "back" else settle.bent_wait_s)
    poses += [*lifted, end]
    waits += [settle.lifted_wait_s] * len(lifted)
    waits.append(settle.end_after_lifted_wait_s if lifted else settle.end_wait_s)
    return _through(poses, waits, style.bearing)


def side_of(pose: Pose, bed: Bed) -> str:
    """The side that somebody lies on: back, left or right."""
    front = rotations.rotate(pose.hips, np.array([0.0, 0.0, 1.0]))
    if front[1] > FACING_UP:
        return "back"
    left = np.array([np.cos(bed.head_yaw), 0.0, -np.sin(bed.head_yaw)])
    return "left" if front @ left < 0 else "right"


def rise_to_edge(start: Pose, seat: Seat, bed: Bed, bearing: Bearing, skeleton: Skeleton, keys: LieKeys) -> Pose:
    """From lying to sitting on the edge: knees up, onto the side, legs over the edge as elbow and hands push."""
    edge, rows, leave = Edge(seat, bed, skeleton), keys.up.pose, keys.up.leave
    hands = edge.hands(keys.up.hands)
    sat = _sitting(keys.up.end, start, seat, skeleton)
    over = [_over_edge(row, sat, edge, hands) for row in rows]
    rolled = _rolled(keys.up.side, start, edge, hands, keys.pose)
    poses, waits = [start, *freed(start, bed)], [leave.lifted_wait_s] * len(freed(start, bed))
    front = rotations.rotate(start.hips, np.array([0.0, 0.0, 1.0]))
    looks_out = front @ np.array([np.sin(seat.yaw), 0.0, np.cos(seat.yaw)]) > FACING_UP
    if not looks_out:
        flat = Lying(bearing=bearing, legs="bent", arms=("belly", "belly"))
        poses.append(_unpressed(lying(start, bed, flat, skeleton, keys.pose), start))
        waits.append(leave.bent_wait_s)
    poses = [replace(pose, reach=hands[0]) for pose in poses]
    waits += [keys.up.side.wait_s, *(row.wait_s for row in rows), keys.up.end.wait_s]
    return _through([*poses, rolled, *over, _bound_for(over[-1], sat)], waits, bearing)


def _through(poses: list[Pose], waits: list[float], bearing: Bearing) -> Pose:
    """From pose to pose, with the time each takes from the one before at tempo 1 (seconds)."""
    times = np.concatenate([[0.0], np.cumsum(waits)]) * (1 / bearing.tempo)
    return interpolate(times.tolist(), poses, FPS)


def gathered(style: Lying) -> Lying:
    """The way of lying that a body comes down in: knees bent, on the back with arms that go to where they will lie."""
    arms = style.arms if style.side == "back" and not style.propped else ("chest", "belly")
    return Lying(bearing=style.bearing, side=style.side, legs="bent", arms=arms)


def _unpressed(pose: Pose, end: Pose) -> Pose:
    """The pose with hands that lie on nothing yet, turned as at the end."""
    return replace(pose, palms=end.palms, pressing=np.zeros(2), reach=end.reach)


def freed(pose: Pose, bed: Bed) -> list[Pose]:
    """What comes between bent knees and legs that cross or hang over the edge: the leg is lifted over first."""
    local = rotations.rotate(rotations.inverse(pose.hips), pose.ankles - pose.pelvis)
    ankles, knees = pose.ankles.copy(), pose.knees.copy()
    if pose.planted.any():
        index = int(np.argmax(pose.planted))
        ankles[index, 1] = bed.surface + LIFTED
        return [replace(pose, ankles=ankles, knees=knees, planted=np.zeros(2))]
    if local[0, 0] - local[1, 0] > CROSSED:
        return []
    index = int(np.argmax(local[:, 2]))
    local[index] += [ASIDE if index == 0 else -ASIDE, HIGHER, LIFTED]
    ankles[index] = pose.pelvis + rotations.rotate(pose.hips, local[index])
    return [replace(pose, ankles=ankles)]


def _sitting(row: SittingUp, start: Pose, seat: Seat, skeleton: Skeleton) -> Pose:
    """Upright on the edge with both feet down."""
    out = np.array([np.sin(seat.yaw), np.cos(seat.yaw)])
    feet_at = seat.pelvis[[0, 2]] + seat.feet_ahead(skeleton.scale) * out
    return replace(
        start,
        pelvis=seat.pelvis,
        hips=upright(seat.yaw, row.hip_pitch_rad),
        spine=bend(row.spine_pitch_rad),
        head=bend(row.head_pitch_rad),
        ankles=np.stack([home_ankle(feet_at, seat.yaw, index, row.foot_out_m, skeleton) for index in (0, 1)]),
        feet=np.stack([rotations.yaw_to_quat(seat.yaw + side * FOOT_SPLAY) for side in (1, -1)]),
        toes=np.zeros(2),
        knees=np.stack([np.array([out[0], row.knee_up_ratio, out[1]])] * 2),
        arms=both_sides(row.wrist_ratio),
        elbows=both_sides(row.elbow_direction),
        reaching=np.zeros(2),
        pressing=np.zeros(2),
        planted=np.ones(2),
    )


def _over_edge(row: OverEdge, sat: Pose, edge: Edge, hands: tuple[Array, Array]) -> Pose:
    """A key pose between sitting on the edge, as in `sat`, and lying on the side."""
    way, seat, bed = edge.way, edge.seat, edge.bed
    pelvis = bed.pelvis + row.pelvis_share * (seat.pelvis - bed.pelvis) + row.pelvis_up_m * UP
    hips = rotations.compose(upright(seat.yaw, row.roll_rad), edge.tilted(row.tilt_rad))
    pose = replace(
        sat,
        pelvis=pelvis,
        hips=hips,
        spine=bend(row.spine_pitch_rad, side=row.spine_side_rad * way),
        head=bend(row.head_pitch_rad, side=row.head_side_rad * way, turn=row.head_turn_rad * way),
    )
    return _pushed(row, _hanging(row, pose, edge), edge, hands)


def _hanging(row: OverEdge, sat: Pose, edge: Edge) -> Pose:
    """Each leg swung up over the edge, from where it stands in `sat`, or standing there still."""
    ankles, feet, knees, planted = sat.ankles.copy(), sat.feet.copy(), sat.knees.copy(), np.ones(2)
    middle, pitch = sat.ankles.mean(axis=0), rotations.rotvec_to_quat(np.array([row.foot_pitch_rad, 0.0, 0.0]))
    for index in (0, 1):
        rad, up = (pair[0 if index == edge.below else 1] for pair in (row.legs_rad, row.feet_up_m))
        if up == 0.0 and rad == DOWN:
            continue
        swing = edge.turned(rad)
        hangs = middle + row.feet_apart_share * (sat.ankles[index] - middle) - edge.seat.pelvis
        hangs[1] += row.foot_drawn_m * edge.skeleton.scale
        ankles[index] = sat.pelvis + rotations.rotate(swing, hangs)
        lowest = edge.skeleton.ankle_height + max(CLEAR, up * edge.skeleton.scale)
        ankles[index, 1] = max(ankles[index, 1], lowest)
        feet[index] = rotations.compose(rotations.compose(swing, sat.feet[index]), pitch)
        knees[index] = rotations.rotate(swing, sat.knees[index])
        planted[index] = 0.0
    return replace(sat, ankles=ankles, feet=feet, toes=sat.toes * planted, knees=knees, planted=planted)


def _pushed(row: OverEdge, pose: Pose, edge: Edge, hands: tuple[Array, Array]) -> Pose:
    """Hands on the mattress as far as a row has them there."""
    below, above = (
        (row.below_wrist_ratio, row.below_elbow_direction),
        (row.above_wrist_ratio, row.above_elbow_direction),
    )
    shares = np.array([row.below_share, row.above_share])
    ways = (below, above) if edge.below == 0 else (above, below)
    shares = shares if edge.below == 0 else shares[::-1]
    arms, elbows = (np.stack([both_sides(ways[index][what])[index] for index in (0, 1)]) for what in (0, 1))
    reach, palms = hands
    return replace(pose, arms=arms, elbows=elbows, reach=reach, palms=palms, reaching=shares, pressing=shares)


def _bound_for(leaning: Pose, pose: Pose) -> Pose:
    """The same pose with hands that are free bound for where they push, so that they go there by the shortest way."""
    free = pose.reaching[:, None] <= 0
    reach, palms = np.where(free, leaning.reach, pose.reach), np.where(free, leaning.palms, pose.palms)
    return replace(pose, reach=reach, palms=palms)


def _rolled(row: Rolled, pose: Pose, edge: Edge, hands: tuple[Array, Array], keys: LiePose) -> Pose:
    """On the side of the edge with knees bent."""
    arms = (row.below_arm, row.above_arm) if edge.side == "left" else (row.above_arm, row.below_arm)
    side = Lying(side=edge.side, legs="gathered", arms=arms)
    lain = lying(pose, edge.bed, side, edge.skeleton, keys)
    moved = row.pelvis_share * (edge.seat.pelvis - edge.bed.pelvis) * [1.0, 0.0, 1.0]
    head = lain.head + bend(row.head_pitch_rad)
    reach, palms = hands
    return replace(
        lain,
        pelvis=lain.pelvis + moved,
        ankles=lain.ankles + moved,
        head=head,
        reach=reach,
        palms=palms,
        pressing=np.zeros(2),
    )
