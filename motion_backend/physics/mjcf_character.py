"""The simulated body in MuJoCo's format: the product's own skeleton and axes, Y up, as 17 rigid bodies.

Trunk, neck, shoulders, hips and ankles are ball joints, whose quaternions are our local rotations; knees, elbows and
toes are hinges. spine1 to spine3 are one joint, and so are neck and head, collar and shoulder; wrists are rigid. Three
position actuators on a ball joint, one an axis, servo its exponential map.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from motion_backend.body.capsules import BODIES, Capsule
from motion_backend.body.segment_masses import SEGMENTS
from motion_backend.rotations import Array
from motion_backend.skeleton import ANKLE_HEIGHT, HAND_REST, INDEX, REFERENCE_HEIGHT, Skeleton, build_skeleton

MASS: Final = 70.0
"""Kilograms at 1.70 m. Others weigh as their height squared: people of one build do (body mass index)."""
SIDES: Final = (("left", 1.0), ("right", -1.0))


@dataclass(frozen=True)
class Drive:
    """How strongly a joint is driven: stiffness (Nm/rad), most torque (Nm), and what it turns about."""

    stiffness: float
    torque: float
    axis: str = ""
    """Of a hinge, "x" or "y"; empty: a ball."""
    low: float = 0.0
    high: float = 0.0
    """The range of a hinge (degrees, on the left)."""


DRIVES: Final = {
    "trunk": Drive(1000, 300),
    "neck": Drive(100, 60),
    "shoulder": Drive(400, 120),
    "elbow": Drive(300, 80, "y", -158, 8),
    "hip": Drive(500, 300),
    "knee": Drive(500, 250, "x", -5, 155),
    "ankle": Drive(400, 150),
    "toe": Drive(20, 20, "x", -75, 45),
}
"""By joint, at 1.70 m. Half and double the torques change hardly anything: torque is not what is lacking."""
DAMPING: Final = 0.1
"""Seconds: a servo's damping over its stiffness. It is part of the servo, so that a joint's torque is what is limited:
damping of the joint itself would take more than the limit at the speed at which an arm is raised."""
ARMATURE: Final = 0.24
"""kg m² about every joint axis, at 1.70 m: what a robot's gears and rotors add. No human has it; with a twelfth of it
feet slide three times as fast, because the light shank is thrown about by every change of contact."""
SOLE: Final = ((0.0, -0.044, 0.041), (0.045, 0.022, 0.088))
"""Centre and half sizes of the box a foot stands on, from heel to ball, in the ankle's frame (metres at 1.70 m)."""
TOES: Final = ((-0.03, -0.011, 0.045), (0.03, -0.011, 0.045), 0.02)
"""Ends and radius of the bar of toes before the ball, in the toe joint's frame (metres at 1.70 m)."""
FLESH: Final = 'priority="1" friction="1 .05 .05" solimp=".2 .9 .025"'
GIVES: Final = 0.06
"""How all of a body but its feet gives (seconds): by a centimetre or two under its weight, as flesh and clothes on a
floor do. A rigid one strikes and lets go: getting down to a floor and up from it shook twice as much."""
KNEECAP, HEEL_OF_HAND = (0.06, 0.03), (HAND_REST, 0.025)
"""The balls that a body kneels and leans on, about the joint of a knee and a wrist: radius (metres, a knee's at 1.70 m)
and how it gives (seconds), less than flesh does. They are as high as plans have knees and wrists over what they bear
on. Without them a planned knee was 2.5 cm in the air, so that who knelt stood on the toes, and hands, straight where
plans bend wrists, were 5 to 9 cm in the floor."""
SITS_ON: Final = ((0.06, -0.055, 0.0), 0.06)
"""Centre of the left one of two balls that a body sits on, in the pelvis' frame, and their radius (metres at 1.70 m).
They are 2.5 cm lower than plans have the pelvis over a seat, as much as a seat gives. With the pelvis' own capsule,
which a plan has 1 cm over the seat, who sat was 4 cm too low, and feet whose thighs lie on an edge were raised."""
TOE_SHARE: Final = 0.0025
"""Of the mass; the foot's own segment has toes and all."""
SOLE_POINTS: Final = np.array([[x, -ANKLE_HEIGHT, z] for z in (-0.033, 0.115) for x in (-0.025, 0.025)])
"""Two points of the heel and two of the ball, in the ankle's frame (metres at 1.70 m). (4, 3)."""


@dataclass(frozen=True)
class SimulatedJoint:
    """A joint and where its numbers are: in qpos, in qvel, and in the controls."""

    name: str
    axis: str
    """Of a hinge; empty: a ball."""
    qpos: int
    qvel: int
    control: int


def _chain() -> tuple[tuple[str, str], ...]:
    """Joints in the order in which MuJoCo counts them, depth first, with their kind."""
    arms = [(f"{side}_{kind}", kind) for side, _ in SIDES for kind in ("shoulder", "elbow")]
    legs = [(f"{side}_{kind}", kind) for side, _ in SIDES for kind in ("hip", "knee", "ankle", "toe")]
    return (("trunk", "trunk"), ("neck", "neck"), *arms, *legs)


def _addresses() -> tuple[SimulatedJoint, ...]:
    found, qpos, qvel, control = [], 7, 6, 0
    for name, kind in _chain():
        axis = DRIVES[kind].axis
        found.append(SimulatedJoint(name, axis, qpos, qvel, control))
        qpos, qvel, control = qpos + (1 if axis else 4), qvel + (1 if axis else 3), control + (1 if axis else 3)
    return tuple(found)


SIMULATED: Final = _addresses()
"""All joints but the free one of the pelvis."""
NQ, NV, NU = 45, 36, 30
"""Numbers of a position, of a velocity, and of controls."""


def mass_of(height: float) -> float:
    """What a body of that height weighs (metres to kg)."""
    return MASS * (height / REFERENCE_HEIGHT) ** 2


@lru_cache(maxsize=8)
def character(height: float) -> tuple[str, str]:
    """XML of the pelvis with all that hangs on it, and of its actuators, for a body of that height (metres)."""
    body = _Body(build_skeleton(height), mass_of(height))
    return body.pelvis(), body.actuators()


def numbers(*values: float | Array) -> str:
    """As MuJoCo reads them."""
    return " ".join(f"{value:.6g}" for value in np.concatenate([np.atleast_1d(value) for value in values]))


@dataclass(frozen=True)
class _Body:
    skeleton: Skeleton
    mass: float

    @property
    def scale(self) -> float:
        return self.skeleton.scale

    @property
    def strength(self) -> float:
        """Torques are weights times lengths."""
        return self.mass / MASS * self.scale

    def offset(self, *joints: str) -> str:
        """Where the last of some joints is from the parent of the first, the turns between them at rest."""
        return numbers(sum((self.skeleton.offsets[INDEX[joint]] for joint in joints), np.zeros(3)))

    def pelvis(self) -> str:
        arms = "".join(self.arm(side) for side, _ in SIDES)
        legs = "".join(self.leg(side) for side, _ in SIDES)
        head = self.body("head", self.offset("spine3", "neck"), self.joint("neck", "neck"), self.skin("head", "head"))
        torso = self.body(
            "torso", self.offset("spine1", "spine2"), self.joint("trunk", "trunk"), self.skin("torso"), head + arms
        )
        place = numbers(0.0, self.skeleton.standing_height, 0.0)
        skin = self.skin("pelvis") + "".join(self.seat(side, way) for side, way in SIDES)
        return self.body("pelvis", place, '<freejoint name="root"/>', skin, torso + legs)

    def arm(self, side: str) -> str:
        radius, gives = HEEL_OF_HAND
        heel = self.ball(f"{side}_hand", radius, gives)
        hand = self.body(f"{side}_hand", self.offset(f"{side}_wrist"), "", heel)
        elbow = self.joint(f"{side}_elbow", "elbow")
        skin = self.skin(f"{side}_lower_arm")
        lower = self.body(f"{side}_lower_arm", self.offset(f"{side}_elbow"), elbow, skin, hand)
        shoulder = self.joint(f"{side}_shoulder", "shoulder")
        place = self.offset("spine3", f"{side}_collar", f"{side}_shoulder")
        return self.body(f"{side}_upper_arm", place, shoulder, self.skin(f"{side}_upper_arm"), lower)

    def leg(self, side: str) -> str:
        toe = self.body(f"{side}_toe", self.offset(f"{side}_foot"), self.joint(f"{side}_toe", "toe"), self.toes(side))
        foot = self.body(
            f"{side}_foot", self.offset(f"{side}_ankle"), self.joint(f"{side}_ankle", "ankle"), self.sole(side), toe
        )
        radius, gives = KNEECAP
        skin = self.skin(f"{side}_shin") + self.ball(f"{side}_knee", radius * self.scale, gives)
        shin = self.body(f"{side}_shin", self.offset(f"{side}_knee"), self.joint(f"{side}_knee", "knee"), skin, foot)
        thigh = self.skin(f"{side}_thigh")
        return self.body(f"{side}_thigh", self.offset(f"{side}_hip"), self.joint(f"{side}_hip", "hip"), thigh, shin)

    def body(self, name: str, place: str, joint: str, skin: str, below: str = "") -> str:
        return f'<body name="{name}" pos="{place}">{joint}{self.inertia(name)}{skin}{below}</body>'

    def joint(self, name: str, kind: str) -> str:
        drive = DRIVES[kind]
        # Inertia is mass times length squared.
        own = f'armature="{ARMATURE * self.strength * self.scale:.6g}"'
        if not drive.axis:
            return f'<joint name="{name}" type="ball" {own}/>'
        low, high = drive.low, drive.high
        if drive.axis == "y" and name.startswith("right"):
            low, high = -high, -low
        axis = numbers(*(float(drive.axis == one) for one in "xyz"))
        return f'<joint name="{name}" type="hinge" axis="{axis}" range="{low} {high}" limited="true" {own}/>'

    def actuators(self) -> str:
        rows = []
        for name, kind in _chain():
            drive = DRIVES[kind]
            most = drive.torque * self.strength
            stiffness = drive.stiffness * self.strength
            servo = f'kp="{stiffness:.6g}" kv="{DAMPING * stiffness:.6g}" forcerange="{-most:.6g} {most:.6g}"'
            axes = [""] if drive.axis else ["1 0 0", "0 1 0", "0 0 1"]
            for axis in axes:
                gear = f'gear="{axis} 0 0 0" ' if axis else ""
                rows.append(f'<position joint="{name}" {gear}{servo}/>')
        return "".join(rows)

    def skin(self, name: str, joint: str | None = None) -> str:
        """A contact body's capsule; of the head, which hangs on the neck, moved up to it."""
        capsule = _CAPSULES[name]
        up = self.skeleton.offsets[INDEX[joint]] if joint else np.zeros(3)
        start, end = (np.array(point) * self.scale + up for point in (capsule.start, capsule.end))
        size = f"{capsule.radius * self.scale:.6g}"
        form = f'type="capsule" fromto="{numbers(start, end)}" size="{size}"'
        return f'<geom name="{name}" class="body" {form} {FLESH} solref="{GIVES} 1"/>'

    def seat(self, side: str, way: float) -> str:
        """What the left (1) or right (-1) half sits on."""
        centre, radius = SITS_ON
        return self.ball(f"{side}_seat", radius * self.scale, GIVES, np.array(centre) * [way, 1.0, 1.0] * self.scale)

    def ball(self, name: str, radius: float, gives: float, at: Array | None = None) -> str:
        """About a joint, or beside it, what a body bears on there."""
        form = f'type="sphere" pos="{numbers(np.zeros(3) if at is None else at)}" size="{radius:.6g}"'
        return f'<geom name="{name}" class="body" {form} {FLESH} solref="{gives} 1"/>'

    def sole(self, side: str) -> str:
        centre, half = (numbers(np.array(one) * self.scale) for one in SOLE)
        return f'<geom name="{side}_foot" class="body" type="box" pos="{centre}" size="{half}"/>'

    def toes(self, side: str) -> str:
        start, end, radius = TOES
        ends = numbers(*(np.array(one) * self.scale for one in (start, end)))
        return f'<geom name="{side}_toe" class="body" type="capsule" fromto="{ends}" size="{radius * self.scale:.6g}"/>'

    def inertia(self, name: str) -> str:
        """Mass and centre of a body's segments, and the moments of a solid bar about its centre."""
        share, centre, length, radius, along = _PIECES[name]
        mass = share * self.mass
        across, about = mass * (3 * radius**2 + length**2) / 12 * self.scale**2, mass * radius**2 / 2 * self.scale**2
        moments = numbers(*(about if axis == along else across for axis in "xyz"))
        return f'<inertial pos="{numbers(centre * self.scale)}" mass="{mass:.6g}" diaginertia="{moments}"/>'


_CAPSULES: Final = {capsule.name: capsule for capsule in BODIES}
Piece = tuple[float, Array, float, float, str]
"""Share of the mass, centre in the body's frame, and the bar: length, radius (metres at 1.70 m) and its axis."""


def _pieces() -> dict[str, Piece]:
    """Every simulated body's inertia, from the segments whose joints it has taken in."""
    offsets = build_skeleton(REFERENCE_HEIGHT).offsets
    moved = {"spine3": ("torso", offsets[INDEX["spine3"]]), "head": ("head", offsets[INDEX["head"]])}
    names = {capsule.joint: capsule.name for capsule in BODIES}
    shares: dict[str, list[tuple[float, Array]]] = {}
    for segment in SEGMENTS:
        name, up = moved.get(segment.joint) or (names[segment.joint], np.zeros(3))
        shares.setdefault(name, []).append((segment.share, np.array(segment.centre) + up))
    for side, _ in SIDES:
        ball, toes = offsets[INDEX[f"{side}_foot"]], np.mean(TOES[:2], axis=0)
        shares[f"{side}_foot"].append((-TOE_SHARE, ball + toes))
        shares[f"{side}_toe"] = [(TOE_SHARE, toes)]
    total = sum(share for rows in shares.values() for share, _ in rows)
    found: dict[str, Piece] = {}
    for name, rows in shares.items():
        share = sum(part for part, _ in rows)
        centre = sum((part * at for part, at in rows), np.zeros(3)) / share
        found[name] = (share / total, centre, *_bar(name))
    return found


def _bar(name: str) -> tuple[float, float, str]:
    """Length and radius of a body (metres at 1.70 m) and the axis it lies along."""
    if name.endswith("_toe"):
        return TOES[1][0] - TOES[0][0] + TOES[2], TOES[2], "x"
    if name.endswith("_foot"):
        half = SOLE[1]
        return 2 * half[2], (half[0] + half[1]) / 2, "z"
    capsule: Capsule = _CAPSULES[name]
    along = np.abs(np.subtract(capsule.end, capsule.start))
    return float(along.max()) + capsule.radius, capsule.radius, "xyz"[int(along.argmax())]


_PIECES: Final = _pieces()
