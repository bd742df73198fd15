"""Lying: on the back or a side, on a bed, a sofa or the floor.

Where hands rest on a lying body: on the skin or the mattress, palms against it, with elbows on the free side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.held_poses import UP, bend, shoulders
from motion_backend.procedural.lie.lie_legs import foot_down, on_a_side, on_the_back, shortened
from motion_backend.procedural.lie.lie_styles import Lying, lie_style, wanted_edge
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.pose_solver import chest_frame
from motion_backend.rotations import Array
from motion_backend.skeleton import LYING_REST, Skeleton
from scene_graphs.affordances.affordances import Spot

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Rest:
    """A left hand at rest, in the chest's frame (left, towards the head, forwards); metres of a body of 1.70 m."""

    wrist: Vector
    elbow: Vector
    """Where the elbow points."""
    fingers: Vector
    back: Vector
    """Where the back of the hand looks: away from what the palm lies on."""
    with_head: bool = False
    """Whether it goes with the head when that is raised."""


SHOULDER: Final = np.array([0.18, 0.135, 0.0])
ARM: Final = 0.54
HEAD: Final = np.array([0.0, 0.35, 0.01])
"""Left shoulder, arm's length and middle of an unbent head in the chest's frame (metres)."""
UPPER_ARM, FOREARM = 0.292, 0.248
NECK, SKULL, MIDDLE = (0.0, 0.20, 0.0), (0.0, 0.09, 0.0), (0.0, 0.06, 0.01)
"""From chest to neck, neck to head joint, and on to the middle of the head."""

BACK: Final[dict[str, Rest]] = {
    "sides": Rest((0.265, -0.365, -0.05), (1.0, 0.0, -0.3), (-0.05, -1.0, 0.0), (0.0, 0.0, 1.0)),
    "close": Rest((0.150, -0.225, 0.132), (0.5, 0.0, -0.85), (-0.80, -0.60, -0.05), (0.0, 0.0, 1.0)),
    "loose": Rest((0.40, -0.29, -0.045), (0.9, -0.5, -0.25), (0.35, -1.0, 0.05), (0.75, 0.0, 0.65)),
    "belly": Rest((0.105, -0.110, 0.155), (1.0, -0.35, -0.45), (-1.0, -0.12, -0.05), (0.0, 0.0, 1.0)),
    "chest": Rest((0.120, 0.010, 0.160), (1.0, -0.75, -0.30), (-1.0, 0.25, -0.05), (0.0, 0.0, 1.0)),
    "behind_head": Rest((0.125, 0.335, -0.085), (1.0, 0.35, 0.30), (-0.85, 0.45, -0.15), (0.0, -0.2, -1.0), True),
    "face": Rest((0.085, 0.275, 0.150), (0.6, -1.0, 0.45), (-0.40, 1.0, 0.0), (0.15, 0.0, 1.0), True),
    "held_above": Rest((0.115, 0.220, 0.390), (0.7, -1.0, 0.0), (-0.1, 0.8, 0.6), (0.95, 0.1, 0.2)),
    "goalpost": Rest((0.400, 0.330, -0.040), (0.8, -0.9, -0.2), (0.05, 1.0, 0.0), (0.0, 0.0, -1.0)),
    "wide": Rest((0.685, 0.130, -0.045), (0.1, -1.0, -0.25), (1.0, 0.05, 0.0), (0.0, 0.0, -1.0)),
}
"""Hands of who lies on the back."""
LOWER: Final = (0.0, -0.065, 0.0)
"""The right hand lies so much lower where both lie on the trunk."""
BELOW: Final[dict[str, Rest]] = {
    "pillow": Rest((0.120, 0.270, 0.125), (-0.35, -0.6, 1.0), (0.05, 0.75, -0.65), (1.0, 0.0, 0.1), True),
    "belly": Rest((0.020, -0.245, 0.190), (0.5, -0.8, 0.1), (-0.85, -0.45, -0.1), (0.0, -0.1, 1.0)),
    "tucked": Rest((0.080, 0.190, 0.265), (0.3, -1.0, 0.6), (-0.15, 0.9, -0.25), (1.0, 0.2, 0.1)),
}
ABOVE: Final[dict[str, Rest]] = {
    "belly": Rest((0.100, -0.155, 0.165), (1.0, -0.30, -0.55), (-1.0, -0.15, -0.15), (0.1, 0.0, 1.0)),
    "before": Rest((-0.085, 0.010, 0.345), (0.9, -0.5, 0.4), (-0.35, 0.55, 0.55), (1.0, 0.0, 0.1)),
    "along": Rest((0.315, -0.345, 0.060), (0.8, 0.2, -0.6), (-0.10, -1.0, 0.20), (1.0, -0.05, 0.1)),
    "tucked": Rest((0.060, 0.110, 0.250), (1.0, -0.8, 0.5), (-0.55, 0.75, -0.2), (0.6, 0.2, 0.8)),
}
"""Hands of who lies on the right side, so that the left arm is above; for the arm below, as if lying on the left."""


def hands_at_rest(pose: Pose, rests: tuple[Rest, Rest], skeleton: Skeleton) -> Pose:
    """A lying pose with its left and right hand at rest."""
    chest, place = (values[0] for values in chest_frame(pose.repeat(1), skeleton))
    raised = rotations.rotate(rotations.inverse(chest), head_middle(pose, skeleton) - place) / skeleton.scale - HEAD
    arms, elbows, palms = np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 4))
    for index, rest in enumerate(rests):
        mirror = np.array([1.0 if index == 0 else -1.0, 1.0, 1.0])
        wrist = np.array(rest.wrist) * mirror + (raised if rest.with_head else 0.0)
        arms[index] = (wrist - SHOULDER * mirror) / ARM
        elbows[index] = np.array(rest.elbow) * mirror
        x = rotations.normalize(np.array(rest.fingers) * mirror) * mirror[0]
        back = np.array(rest.back) * mirror
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


def propped(pose: Pose, height: float, skeleton: Skeleton) -> Pose:
    """On the elbows: they stand on the mattress (`height` in the world) under the shoulders, the forearms lie ahead."""
    chest, place = (values[0] for values in chest_frame(pose.repeat(1), skeleton))
    back = rotations.inverse(chest)
    ahead = rotations.normalize(rotations.rotate(pose.hips, np.array([0.0, -1.0, 0.0])) * [1.0, 0.0, 1.0])
    aside = rotations.rotate(pose.hips, np.array([1.0, 0.0, 0.0]))
    arms, elbows, palms = np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 4))
    for index, side in enumerate((1.0, -1.0)):
        mirror = np.array([side, 1.0, 1.0])
        shoulder = place + rotations.rotate(chest, SHOULDER * mirror * skeleton.scale)
        drop = min(shoulder[1] - height - 0.04, 0.99 * UPPER_ARM * skeleton.scale)
        apart = np.sqrt((UPPER_ARM * skeleton.scale) ** 2 - drop**2)
        elbow = shoulder + apart * (0.8 * side * aside + 0.6 * ahead)
        elbow[1] = shoulder[1] - drop
        along = rotations.normalize(ahead - 0.25 * side * aside)
        wrist = elbow + FOREARM * skeleton.scale * along
        wrist[1] = height + 0.045
        arms[index] = rotations.rotate(back, wrist - shoulder) / (ARM * skeleton.scale)
        elbows[index] = rotations.rotate(back, elbow - 0.5 * (wrist + shoulder))
        x = rotations.normalize(along * [1.0, 0.0, 1.0]) * side
        up = np.array([0.0, 1.0, 0.0])
        palms[index] = rotations.basis_to_quat(x, up, rotations.cross(x, up))
    return replace(pose, arms=arms, elbows=elbows, palms=palms, pressing=np.ones(2), reaching=np.zeros(2))


ROLL = 1.31
"""How far a pelvis is turned over to lie on a side (radians)."""
SKULL_RADIUS = 0.085
"""Half a head: its middle above what it lies on (metres at 1.70 m)."""
PROPPED = 0.35
"""How far the pelvis of who lies on the elbows tips back from lying flat (radians)."""
ON_ARM, ON_HANDS = 0.05, 0.05
"""How high a head lies on an arm rather than on a pillow, or on hands upon it."""
OVER_EDGE = 0.30
"""How far from the edge the pelvis of who puts a foot down lies at most (metres)."""
NEEDS = {"wide": 0.85, "goalpost": 0.53, "loose": 0.50, "behind_head": 0.46, "sides": 0.34}
"""How much room beside the middle of the body arms need (metres at 1.70 m)."""
NARROW = {"wide": "goalpost", "goalpost": "behind_head", "loose": "close", "sides": "close"}
"""Where they rest with less."""


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

    @staticmethod
    def of(spot: Spot) -> Bed:
        """The bed of a lie spot."""
        pelvis = np.asarray(spot.point) + LYING_REST * np.asarray(spot.normal)
        return Bed(pelvis, spot.facing, spot.approach, spot.edge, spot.back)

    @property
    def surface(self) -> float:
        """Height of the mattress (metres)."""
        return float(self.pelvis[1]) - LYING_REST

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
    if not lie_style("neutral", caption).legs.endswith("_down"):
        return spot
    over = max(spot.edge - OVER_EDGE, 0.0)
    x, y, z = spot.point
    point = (x + over * float(np.sin(spot.approach)), y, z + over * float(np.cos(spot.approach)))
    return replace(spot, point=point, edge=spot.edge - over)


def lying(start: Pose, bed: Bed, style: Lying, skeleton: Skeleton) -> Pose:
    """Settled on a bed, sofa or the floor."""
    pose = replace(start, planted=np.zeros(2), reaching=np.zeros(2))
    return _on_the_back(pose, bed, style, skeleton) if style.side == "back" else _on_a_side(pose, bed, style, skeleton)


def _on_the_back(pose: Pose, bed: Bed, style: Lying, skeleton: Skeleton) -> Pose:
    lift = float(np.arctan2(bed.pillow, 0.30))
    pose = replace(pose, pelvis=bed.pelvis, hips=bed.hips("back"), spine=bend(0.2 * lift), head=bend(0.0))
    pose = on_the_back(pose, style.legs, skeleton)
    if style.legs.endswith("_down") and style.legs == f"{bed.edge_side}_down" and bed.surface > 0.15:
        pose = foot_down(pose, ("left", "right").index(bed.edge_side), (bed.edge, bed.outward), skeleton)
    else:
        pose = shortened(pose, bed.end, skeleton)
    if style.propped:
        pose = _sat_up(pose, bed, skeleton)
        return propped(replace(pose, head=bend(0.30)), bed.surface, skeleton)
    nods = np.linspace(-0.2, 0.9, 56)
    heights = head_middle(replace(pose, head=np.stack([bend(float(nod)) for nod in nods])), skeleton)[:, 1]
    hands = (_hand(style, bed, 0, skeleton.scale), _hand(style, bed, 1, skeleton.scale))
    under_head = any(hand.with_head and hand.wrist[2] < 0 for hand in hands)
    under = bed.pillow + (ON_HANDS * skeleton.scale if under_head else 0.0)
    resting = bed.surface + under + SKULL_RADIUS * skeleton.scale
    nod = float(nods[int(np.argmin(np.abs(heights - resting)))]) + style.nod
    pose = replace(pose, head=bend(nod, turn=style.turn))
    return hands_at_rest(pose, hands, skeleton)


def _hand(style: Lying, bed: Bed, index: int, scale: float) -> Rest:
    """Where a hand rests; with something beside, forearms go up, or hands under the head or onto the hips."""
    name = style.arms[index]
    name = name if name in BACK else "sides"
    while bed.beside[index] < NEEDS.get(name, 0.0) * scale and name in NARROW:
        name = NARROW[name]
    rest = BACK[name]
    if name == "behind_head" and bed.beside[index] < NEEDS[name] * scale:
        return replace(rest, elbow=(0.9, 0.3, 0.55))
    if index == 1 and style.arms[0] == name and name in ("belly", "chest"):
        x, y, z = np.array(rest.wrist) + LOWER
        return replace(rest, wrist=(x, y, z))
    return rest


def _sat_up(pose: Pose, bed: Bed, skeleton: Skeleton) -> Pose:
    """The trunk raised until an upper arm stands upright under its shoulder; the pelvis tips back under it."""
    pose = replace(pose, hips=rotations.compose(pose.hips, rotations.rotvec_to_quat(np.array([PROPPED, 0.0, 0.0]))))
    bends = np.linspace(0.0, 0.9, 46)
    tries = replace(pose.repeat(len(bends)), spine=np.stack([bend(float(forward)) for forward in bends]))
    heights = shoulders(tries, skeleton)[:, 0, 1]
    best = int(np.argmin(np.abs(heights - bed.surface - 0.30 * skeleton.scale)))
    return replace(pose, spine=tries.spine[best])


def _on_a_side(pose: Pose, bed: Bed, style: Lying, skeleton: Skeleton) -> Pose:
    """Hips and shoulders one above the other, the head on the pillow or the arm, one leg upon the other."""
    down = 1.0 if style.side == "left" else -1.0
    curl = 0.55 if style.legs == "tucked" else 0.0
    # The trunk bends off the shoulder that it lies on.
    pose = replace(
        pose,
        pelvis=bed.pelvis + 0.017 * UP,
        hips=bed.hips(style.side),
        spine=bend(curl, side=0.38 * down, turn=-0.22 * down),
    )
    pose = on_a_side(pose, style.legs, style.side, bed.beside[0 if down > 0 else 1], skeleton)
    names = style.arms if style.side == "left" else style.arms[::-1]
    below, above = BELOW.get(names[0], BELOW["pillow"]), ABOVE.get(names[1], ABOVE["before"])
    under = max(bed.pillow, ON_ARM * skeleton.scale if below.with_head else 0.0)
    tilts = np.linspace(-0.7, 0.5, 61) * down
    tries = np.stack([bend(0.65 * curl + 0.08, side=float(tilt)) for tilt in tilts])
    heights = head_middle(replace(pose, head=tries), skeleton)[:, 1]
    resting = bed.surface + under + SKULL_RADIUS * skeleton.scale
    pose = replace(pose, head=tries[int(np.argmin(np.abs(heights - resting)))])
    return hands_at_rest(pose, (below, above) if style.side == "left" else (above, below), skeleton)
