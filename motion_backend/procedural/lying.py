"""Lying: on the back or a side, on a bed, a sofa or the floor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.procedural.lie_styles import Lying, lie_style, wanted_edge
from motion_backend.procedural.lying_hands import ABOVE, BACK, BELOW, LOWER, Rest, hands_at_rest, head_middle, propped
from motion_backend.procedural.lying_legs import foot_down, on_a_side, on_the_back, shortened
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.stances import UP, bend, shoulders
from motion_backend.skeleton import LYING_REST, Skeleton
from scene_graphs.surfaces import Spot

Array = NDArray[np.float64]
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
