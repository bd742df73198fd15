"""Getting down on both knees with the trunk prone, one hand on the floor: how low things are touched lying forwards."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.procedural.footsteps import yaw_of
from motion_backend.procedural.palms import palm_on
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.stances import UP, bend, shoulders, upright
from motion_backend.skeleton import HAND_REST, Skeleton

Array = NDArray[np.float64]
BEHIND: Final = 0.48
"""How far behind where they stood the ankles of a kneeling body are (metres at 1.70 m)."""
ANKLE: Final = 0.14
"""Their height on curled toes."""
HAND: Final = 0.20
"""A hand before its wrist, and a little (metres at 1.70 m)."""
ON_TOES, CURLED = 1.30, 1.10
"""How far the feet of a kneeling body stand upright, and how far their toes bend (radians)."""


def feet_behind(start: Pose, skeleton: Skeleton) -> Array:
    """Where the ankles of a body that stands in a pose would be if it knelt there. (2, 3)."""
    ahead = _ahead(start)
    places = start.ankles - BEHIND * skeleton.scale * ahead
    places[:, 1] = ANKLE * skeleton.scale
    return np.asarray(places)


def down_on_knees(start: Pose, skeleton: Skeleton) -> list[Pose]:
    """From standing to both knees, as keys: one foot lifted back, that knee down, then the other."""
    behind = feet_behind(start, skeleton)
    first = _crouched(start, 0.20, 0.72, 0.35, skeleton)
    half = _crouched(_foot_back(start, 1, behind), 0.16, 0.475, 0.30, skeleton)
    both = _crouched(_foot_back(_foot_back(start, 1, behind), 0, behind), 0.18, 0.45, 0.45, skeleton)
    return [_in_the_air(first, 1, behind), half, _in_the_air(half, 0, behind), both]


def prone(knees: Pose, goal: Array, index: int, skeleton: Skeleton) -> Pose:
    """From both knees: sat back and bent forwards until a hand (0 left, 1 right) reaches the goal, the other bears."""
    yaw = float(yaw_of(knees.hips))
    leans = np.radians(np.arange(50, 100, 5))
    tries = knees.repeat(len(leans))
    ahead = _ahead(knees)
    middle = knees.ankles.mean(axis=0) + 0.18 * skeleton.scale * ahead
    pelvis = np.array([middle[0], 0.40 * skeleton.scale, middle[2]])
    tries = replace(
        tries,
        pelvis=np.tile(pelvis, (len(leans), 1)),
        hips=np.stack([upright(yaw, 0.55 * float(lean)) for lean in leans]),
        spine=np.stack([bend(0.5 * float(lean)) for lean in leans]),
    )
    places = shoulders(tries, skeleton)
    gap = np.linalg.norm(places[:, index] - goal, axis=1)
    arm = 0.54 * skeleton.scale
    miss = np.maximum(gap - 0.93 * arm, 0.0) + np.maximum(0.5 * arm - gap, 0.0)
    best = int(np.argmin(miss + 0.02 * np.abs(leans - np.radians(80))))
    pose = replace(tries.at(best), head=bend(-0.45))
    bearing = 1 - index
    room = float((goal - places[best, bearing]) @ ahead) - HAND * skeleton.scale
    palm = places[best, bearing] + min(0.12 * skeleton.scale, room) * ahead
    palm[1] = HAND_REST
    reach, reaching, palms = pose.reach.copy(), np.zeros(2), pose.palms.copy()
    reach[bearing], reaching[bearing] = palm, 1.0
    palms[bearing] = palm_on(UP, yaw, ("left", "right")[bearing])
    return replace(pose, reach=reach, reaching=reaching, palms=palms, pressing=reaching.copy())


def _ahead(pose: Pose) -> Array:
    yaw = float(yaw_of(pose.hips))
    return np.array([np.sin(yaw), 0.0, np.cos(yaw)])


def _crouched(pose: Pose, back: float, height: float, lean: float, skeleton: Skeleton) -> Pose:
    """The pelvis so far behind the standing feet and so high (metres at 1.70 m), the trunk bent forwards."""
    yaw = float(yaw_of(pose.hips))
    pelvis = pose.pelvis - back * skeleton.scale * _ahead(pose)
    pelvis[1] = height * skeleton.scale
    return replace(pose, pelvis=pelvis, hips=upright(yaw, 0.4 * lean), spine=bend(0.6 * lean), head=bend(0.15))


def _foot_back(pose: Pose, index: int, behind: Array) -> Pose:
    """One foot on its curled toes behind."""
    ankles, feet, toes, knees = pose.ankles.copy(), pose.feet.copy(), pose.toes.copy(), pose.knees.copy()
    ankles[index] = behind[index]
    feet[index] = rotations.compose(pose.feet[index], rotations.rotvec_to_quat(np.array([ON_TOES, 0.0, 0.0])))
    toes[index] = CURLED
    knees[index] = _ahead(pose) - 0.6 * UP
    return replace(pose, ankles=ankles, feet=feet, toes=toes, knees=knees)


def _in_the_air(pose: Pose, index: int, behind: Array) -> Pose:
    """A foot half-way back, off the floor."""
    lifted = _foot_back(pose, index, behind)
    ankles, planted = pose.ankles.copy(), pose.planted.copy()
    ankles[index] = 0.5 * (pose.ankles[index] + behind[index]) + 0.10 * UP
    planted[index] = 0.0
    feet = lifted.feet.copy()
    feet[index] = rotations.slerp(pose.feet[index], lifted.feet[index], 0.5)
    return replace(lifted, ankles=ankles, feet=feet, toes=0.5 * (pose.toes + lifted.toes), planted=planted)
