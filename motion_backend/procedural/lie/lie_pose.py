"""Lying: on the back or a side, on a bed, a sofa or the floor.

Where hands rest on a lying body: on the skin or the mattress, palms against it, with elbows on the free side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, TypeVar

import numpy as np

from motion_backend import rotations
from motion_backend.motion import Emotion
from motion_backend.procedural.held_poses import UP, bend
from motion_backend.procedural.lie.lie_keys import LiePose, RestingHand, SideLegs
from motion_backend.procedural.lie.lie_legs import SideBed, foot_down, on_a_side, on_the_back, shortened
from motion_backend.procedural.lie.lie_own import OwnWay
from motion_backend.procedural.lie.lie_propped import head_in_hand, on_both_elbows
from motion_backend.procedural.lie.lie_styles import Lying, lie_style, wanted_edge
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.pose_solver import chest_frame
from motion_backend.rotations import Array
from motion_backend.skeleton import LYING_REST, Skeleton
from scene_graphs.affordances.affordances import Spot

Row = TypeVar("Row", RestingHand, SideLegs)

SHOULDER: Final = np.array([0.18, 0.135, 0.0])
ARM: Final = 0.54
HEAD: Final = np.array([0.0, 0.35, 0.01])
"""Left shoulder, arm's length and middle of an unbent head in the chest's frame (metres)."""
NECK, SKULL, MIDDLE = (0.0, 0.20, 0.0), (0.0, 0.09, 0.0), (0.0, 0.06, 0.01)
"""From chest to neck, neck to head joint, and on to the middle of the head."""

LOWER: Final = (0.0, -0.065, 0.0)
"""The right hand lies so much lower where both lie on the trunk (metres at 1.70 m)."""
TALLER: Final = 0.06
"""How much higher a pelvis rests for every 1.70 m by which a body is larger (metres)."""
ROLL: Final = 1.31
"""How far a pelvis is turned over to lie on a side (radians)."""
SKULL_RADIUS: Final = 0.085
"""Half a head: its middle above what it lies on (metres at 1.70 m)."""
ON_ARM, ON_HANDS = 0.05, 0.05
"""How high a head lies on an arm rather than on a pillow, or on hands upon it (metres at 1.70 m)."""
NARROW: Final = 0.25
"""With so much room from the middle to either side one lies straight along (metres)."""
HELD: Final = 0.4
"""An elbow whose hand is at the head is elsewhere by so large a share only."""
OVER_TRUNK: Final = 0.15
"""A wrist nearer than this to the middle of the body is over the trunk (metres at 1.70 m)."""
STRETCHED: Final = 0.91
"""From the pelvis to the soles of stretched legs (metres at 1.70 m)."""
KNEES_UP: Final = 0.5
"""Knees drawn up on a side need so much room before the body (metres at 1.70 m)."""
OVER_EDGE: Final = 0.30
"""How far from the edge the pelvis of who puts a foot down lies at most (metres)."""
TO_HEAD: Final = 0.30
"""From the shoulders to what a pillow lifts (metres): with its height the slope of the trunk."""
MIN_BED: Final = 0.15
"""A foot is put down beside what is higher than this (metres)."""
NODS: Final = np.linspace(-0.2, 0.9, 56)
"""Forward bends of the head on the back that are tried (radians)."""
OFF_SHOULDER: Final = np.linspace(0.0, 0.6, 61)
"""Bends of the trunk off the shoulder that it lies on that are tried (radians)."""
TILTS: Final = np.linspace(-0.7, 0.5, 61)
"""Side bends of the head on the left side that are tried (radians)."""


def hands_at_rest(pose: Pose, rests: tuple[RestingHand, RestingHand], skeleton: Skeleton) -> Pose:
    """A lying pose with its left and right hand at rest."""
    chest, place = (values[0] for values in chest_frame(pose.repeat(1), skeleton))
    raised = rotations.rotate(rotations.inverse(chest), head_middle(pose, skeleton) - place) / skeleton.scale - HEAD
    arms, elbows, palms = np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 4))
    for index, rest in enumerate(rests):
        mirror = np.array([1.0 if index == 0 else -1.0, 1.0, 1.0])
        wrist = np.array(rest.wrist_m) * mirror + (raised if rest.with_head else 0.0)
        arms[index] = (wrist - SHOULDER * mirror) / ARM
        elbows[index] = np.array(rest.elbow_direction) * mirror
        x = rotations.normalize(np.array(rest.fingers_direction) * mirror) * mirror[0]
        back = np.array(rest.back_direction) * mirror
        y = rotations.normalize(back - (back @ x) * x)
        palms[index] = rotations.compose(chest, rotations.basis_to_quat(x, y, rotations.cross(x, y)))
    return replace(pose, arms=arms, elbows=elbows, palms=palms, pressing=np.ones(2), reaching=np.zeros(2))


def head_middle(pose: Pose, skeleton: Skeleton) -> Array:
    """Where the middle of the head is in the world; `pose.head` may hold many tries. (..., 3)."""
    chest, place = (values[0] for values in chest_frame(pose.repeat(1), skeleton))
    half = rotations.rotvec_to_quat(pose.head / 2)
    on_neck = np.array(SKULL) + rotations.rotate(half, np.array(MIDDLE))
    local = np.array(NECK) + rotations.rotate(half, on_neck)
    return np.asarray(place + rotations.rotate(chest, local * skeleton.scale))


@dataclass(frozen=True)
class Bed:
    """A place to lie, as the body needs it."""

    pelvis: Array
    """(3,) where the pelvis joint rests when lying on the back."""
    head_yaw: float
    """Direction from pelvis to head."""
    outward: float
    """Direction from the pelvis to the side one comes from."""
    edge: float
    """Distance to that side (metres)."""
    back: float = np.inf
    """Distance from the pelvis to the end at the head."""
    pillow: float = 0.0
    """How much higher than the mattress the thing under the head is (metres)."""
    end: tuple[float, float] = (np.inf, 0.0)
    """Distance to what ends the place at the feet, and its height above the mattress (metres)."""
    beside: tuple[float, float] = (np.inf, np.inf)
    """Distance to what is in the way beside the body's left and right (metres)."""

    lift: float = 0.0
    """How much higher than of others the pelvis of a large body rests (metres)."""

    @staticmethod
    def of(spot: Spot, scale: float = 1.0) -> Bed:
        """The bed of a lie spot, for a body of that size."""
        lift = TALLER * max(scale - 1, 0.0)
        pelvis = np.asarray(spot.point) + (LYING_REST + lift) * np.asarray(spot.normal)
        return Bed(pelvis, spot.facing, spot.approach, spot.edge, spot.back, lift=lift)

    @property
    def surface(self) -> float:
        """Height of the mattress (metres)."""
        return float(self.pelvis[1]) - LYING_REST - self.lift

    @property
    def edge_side(self) -> str:
        """The side of the body that is towards the edge one comes from, lying on the back."""
        return "left" if np.sin(self.head_yaw - self.outward) > 0 else "right"

    def hips(self, side: str) -> Array:
        """Pelvis rotation lying on the back, or on the left or right side. (4,)."""
        up_the_bed = np.array([np.sin(self.head_yaw), 0.0, np.cos(self.head_yaw)])
        supine = rotations.basis_to_quat(np.cross(up_the_bed, UP), up_the_bed, UP)
        roll = {"back": 0.0, "left": ROLL, "right": -ROLL}[side]
        return rotations.compose(supine, rotations.rotvec_to_quat(np.array([0.0, roll, 0.0])))


def place_to_lie(found: Sequence[Spot], caption: str) -> Spot:
    """The first spot with the edge on the side that a caption wants; near to it where a foot goes down there."""
    wanted = wanted_edge(caption)
    spot = next((spot for spot in found if Bed.of(spot).edge_side == wanted), found[0])
    if not lie_style(Emotion.NEUTRAL, caption).legs.endswith("_down"):
        return spot
    over = max(spot.edge - OVER_EDGE, 0.0)
    x, y, z = spot.point
    point = (x + over * float(np.sin(spot.approach)), y, z + over * float(np.cos(spot.approach)))
    return replace(spot, point=point, edge=spot.edge - over)


def lacking(style: Lying, bed: Bed, skeleton: Skeleton, keys: LiePose) -> list[str]:
    """What of a way of lying there is no place for, and what is done instead."""
    words, stretched = [], style.legs not in ("bent", "left_down", "right_down")
    if style.legs.endswith("_down") and (style.legs != f"{bed.edge_side}_down" or bed.surface <= MIN_BED):
        words.append("no edge on that side: the foot stays where the body lies")
    if style.legs == "tucked" and bed.beside[("left", "right").index(style.side)] < KNEES_UP * skeleton.scale:
        words.append("no room before the body: knees drawn up less")
    if style.side != "back" or style.propped:
        return words
    for index, side in enumerate(("left", "right")):
        wanted = _row(keys.back_hand, style.arms[index], "sides")
        if _fitting(wanted, bed.beside[index] / skeleton.scale, keys.back_hand) != wanted:
            words.append(f"no room beside the {side} arm: drawn in")
    if stretched and bed.end[0] < STRETCHED * skeleton.scale:
        words.append("too short to lie stretched: knees bent or feet over the end")
    return words


def lying(start: Pose, bed: Bed, style: Lying, skeleton: Skeleton, keys: LiePose) -> Pose:
    """Settled on a bed, sofa or the floor."""
    pose = replace(start, planted=np.zeros(2), reaching=np.zeros(2))
    lie = _on_the_back if style.side == "back" else _on_a_side
    return lie(pose, bed, style, skeleton, keys)


def _on_the_back(pose: Pose, bed: Bed, style: Lying, skeleton: Skeleton, keys: LiePose) -> Pose:
    lift = float(np.arctan2(bed.pillow, TO_HEAD))
    spine = bend(keys.back.spine_lift_share * lift, side=style.own.curve, turn=style.own.twist)
    hips = _askew(bed.hips("back"), bed, style.own)
    pose = replace(pose, pelvis=bed.pelvis, hips=hips, spine=spine, head=bend(0.0))
    pose = on_the_back(pose, style.legs, skeleton, keys.leg, style.own)
    if style.legs.endswith("_down") and style.legs == f"{bed.edge_side}_down" and bed.surface > MIN_BED:
        index = ("left", "right").index(bed.edge_side)
        pose = foot_down(pose, index, (bed.edge, bed.outward), skeleton, keys.foot_down)
    else:
        pose = shortened(pose, bed.end, skeleton, keys.over_end, keys.before_end)
    if style.propped:
        pose = replace(pose, head=bend(0.0, turn=style.own.head_turn, side=style.own.head_tilt))
        return on_both_elbows(pose, bed.surface, skeleton, keys.propped)
    heights = head_middle(replace(pose, head=np.stack([bend(float(nod)) for nod in NODS])), skeleton)[:, 1]
    left, right = (_hand(style, bed, index, skeleton.scale, keys.back_hand) for index in (0, 1))
    under_head = any(hand.with_head and hand.wrist_m[2] < 0 for hand in (left, right))
    under = bed.pillow + (ON_HANDS * skeleton.scale if under_head else 0.0)
    resting = bed.surface + under + SKULL_RADIUS * skeleton.scale
    nod = float(NODS[int(np.argmin(np.abs(heights - resting)))]) + style.nod
    # A head that hands go with stays between them.
    kept = left.with_head or right.with_head
    turned = 0.0 if kept or style.nod else style.own.head_turn
    turn = style.turn * (1.0 if turned >= 0 else -1.0) + turned
    pose = replace(pose, head=bend(nod, turn=turn, side=0.0 if kept else style.own.head_tilt))
    return hands_at_rest(pose, (_moved(left, style.own, 0), _moved(right, style.own, 1)), skeleton)


def _askew(hips: Array, bed: Bed, own: OwnWay) -> Array:
    """Hips a little across the bed, where that has room to the sides."""
    room = np.clip((min(bed.edge, *bed.beside) - NARROW) / NARROW, 0.0, 1.0)
    return rotations.compose(rotations.yaw_to_quat(float(own.askew * room)), hips)


def _moved(rest: RestingHand, own: OwnWay, index: int) -> RestingHand:
    """The hand where it lies this time, over the same surface."""
    out, up, ahead = rest.wrist_m
    # At a head there is no more room, and a trunk falls off to its sides.
    size = 0.0 if rest.with_head else 0.4 if out < OVER_TRUNK and ahead > 0 else 1.0
    across, along = size * float(own.hand_across[index]), size * float(own.hand_along[index])
    aside, towards_head, forwards = rest.elbow_direction
    elbow = (aside, towards_head + (HELD if rest.with_head else 1.0) * float(own.elbow_up[index]), forwards)
    return replace(rest, wrist_m=(out + across, up + along, ahead), elbow_direction=elbow)


def _hand(style: Lying, bed: Bed, index: int, scale: float, rows: tuple[RestingHand, ...]) -> RestingHand:
    """Where a hand rests on the back; with something beside, forearms go up, or hands under the head or on the hips."""
    rest = _fitting(_row(rows, style.arms[index], "sides"), bed.beside[index] / scale, rows)
    if index == 1 and style.arms[0] == rest.name and rest.name in ("belly", "chest"):
        x, y, z = np.array(rest.wrist_m) + LOWER
        return replace(rest, wrist_m=(x, y, z))
    return rest


def _fitting(rest: RestingHand, room: float, rows: tuple[RestingHand, ...]) -> RestingHand:
    """The hand, or one that needs less room where there is no more than that (metres at 1.70 m)."""
    while rest.narrower is not None and room < rest.room_m:
        rest = _row(rows, rest.narrower, rest.name)
    return rest


def _row(rows: tuple[Row, ...], name: str, usual: str) -> Row:
    """The row of that name, or else the usual one."""
    named = {row.name: row for row in rows}
    return named.get(name, named[usual])


def _shoulders(pose: Pose, spines: Array, down: float, skeleton: Skeleton) -> Array:
    """How high the shoulder below is with each of N bends of the spine. (N,) metres."""
    turn, place = chest_frame(replace(pose.repeat(len(spines)), spine=spines), skeleton)
    return np.asarray((place + rotations.rotate(turn, SHOULDER * [down, 1.0, 1.0] * skeleton.scale))[:, 1])


def _on_a_side(pose: Pose, bed: Bed, style: Lying, skeleton: Skeleton, keys: LiePose) -> Pose:
    """Hips and shoulders one above the other, the head on the pillow or the arm, one leg upon the other."""
    row, down = keys.side, 1.0 if style.side == "left" else -1.0
    curl = row.tucked_curl_rad if style.legs == "tucked" else 0.0
    pelvis = bed.pelvis + (row.pelvis_up_m + bed.lift) * UP
    pose = replace(pose, pelvis=pelvis, hips=_askew(bed.hips(style.side), bed, style.own))
    bent = np.stack(
        [bend(curl + abs(style.own.curve), float(off) * down, row.spine_turn_rad * down) for off in OFF_SHOULDER]
    )
    up = row.shoulder_up_m * skeleton.scale
    pose = replace(pose, spine=bent[int(np.argmin(np.abs(_shoulders(pose, bent, down, skeleton) - bed.surface - up)))])
    legs = _row(keys.side_legs, style.legs, "straight")
    before = bed.beside[0 if down > 0 else 1]
    pose = on_a_side(pose, legs, style.side, SideBed(bed.surface, before), skeleton, style.own)
    names = style.arms if style.side == "left" else style.arms[::-1]
    if style.propped:
        above = _fitting(_row(keys.above_hand, names[1], "before"), before / skeleton.scale, keys.above_hand)
        held = hands_at_rest(pose, (above, above), skeleton)
        return head_in_hand(held, 0 if down > 0 else 1, bed.surface, skeleton, keys.head_in_hand)
    below = _fitting(_row(keys.below_hand, names[0], "pillow"), before / skeleton.scale, keys.below_hand)
    above = _fitting(_row(keys.above_hand, names[1], "before"), before / skeleton.scale, keys.above_hand)
    under = max(bed.pillow, ON_ARM * skeleton.scale if below.with_head else 0.0)
    pitch = row.head_curl_share * curl + row.head_pitch_rad
    tries = np.stack([bend(pitch, side=float(tilt)) for tilt in TILTS * down])
    heights = head_middle(replace(pose, head=tries), skeleton)[:, 1]
    resting = bed.surface + under + SKULL_RADIUS * skeleton.scale
    pose = replace(pose, head=tries[int(np.argmin(np.abs(heights - resting)))])
    hands = _moved(below, style.own, 0), _moved(above, style.own, 1)
    return hands_at_rest(pose, hands if style.side == "left" else hands[::-1], skeleton)
