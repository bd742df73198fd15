"""Getting down on both knees with the trunk prone, one hand on the floor: how low things are touched lying forwards."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.body_state import Scene
from motion_backend.procedural.held_poses import UP, bend, shoulders, upright
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.touch.hand_captions import Laid
from motion_backend.procedural.touch.hand_contacts import palm_on
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.rotations import Array
from motion_backend.skeleton import HAND_REST, Skeleton
from scene_graphs.affordances.affordances import Spot
from scene_graphs.layout import Point2
from scene_graphs.navigation.path_planner import Walkable

BEHIND: Final = 0.48
"""How far behind where they stood the ankles of a kneeling body are (metres at 1.70 m)."""
KNEES_APART: Final = 0.10
"""From the middle to either ankle of a kneeling body (metres at 1.70 m)."""
ANKLE: Final = 0.14
"""Their height on curled toes."""
HAND: Final = 0.20
"""A hand before its wrist, and a little (metres at 1.70 m)."""
TURNS: Final = (0.0, 0.35, -0.35, 0.7, -0.7, 1.05, -1.05)
"""How far from straight before a thing one kneels (radians)."""
AWAY: Final = (0.56, 0.62, 0.50, 0.44)
"""How far from what is touched one stands before kneeling (metres at 1.70 m)."""
LEGS: Final = [
    [x, y, z] for x in (-0.10, 0.10) for y, z in ((0.14, -0.48), (0.10, -0.55), (0.07, -0.25), (0.07, -0.05))
]
"""Feet, shins and knees of a kneeling body: left, up and ahead of where it stood (metres at 1.70 m)."""
ARMS: Final = [[x, 0.42, z] for x in (-0.36, -0.2, 0.2, 0.36) for z in (-0.2, 0.08)]
"""Its hips, shoulders and elbows."""
FOOT, ELBOW = 0.05, 0.06
"""The room that feet need, and that elbows should have (metres)."""
STAND, WALLED = 0.12, 0.08
"""The room to stand, and how far a thing may stand in its wall (metres)."""
OUT_TOP, OUT_FRONT = 0.2, 1.7
ON_TOES, CURLED = 1.30, 1.10
"""How far the feet of a kneeling body stand upright, and how far their toes bend (radians)."""


def _feet_behind(start: Pose, skeleton: Skeleton) -> Array:
    """Where the ankles of a body that stands in a pose are when it kneels there. (2, 3)."""
    ahead = _ahead(start)
    aside = np.array([ahead[2], 0.0, -ahead[0]])
    sides = np.array([[KNEES_APART], [-KNEES_APART]]) * aside
    places = start.ankles.mean(axis=0) + skeleton.scale * (sides - BEHIND * ahead)
    places[:, 1] = ANKLE * skeleton.scale
    return np.asarray(places)


def place_to_kneel(spot: Spot, start: Point2, scene: Scene, scale: float) -> Spot | None:
    """Where to stand, and to face, so that there is room to kneel down to what is touched; None where there is none.

    Straight before it if that will do, else from aside, nearer or farther; `start` is where the body comes from.
    """
    depth = scene.obstacles.solid().depth
    best: tuple[float, Spot] | None = None
    for turn in TURNS:
        for away in AWAY:
            facing = float(rotations.wrap(np.asarray(spot.facing + turn)))
            ahead = np.array([np.sin(facing), 0.0, np.cos(facing)])
            place = np.asarray(spot.point) - away * scale * ahead
            at = (float(place[0]), float(place[2]))
            aside = np.array([ahead[2], 0.0, -ahead[0]])
            legs, arms = (
                np.array([[place[0], 0.0, place[2]]]) + scale * np.array(body) @ np.stack([aside, UP, ahead])
                for body in (LEGS, ARMS)
            )
            if float(depth(legs).max()) > -FOOT:
                continue
            tight = max(float(depth(arms).max()) + ELBOW, 0.0) + 0.05 * abs(turn) + 0.1 * abs(away - AWAY[0])
            better = best is None or tight < best[0]
            if better and _can_stand(at, spot, start, scene.walkable):
                best = (tight, replace(spot, standing=at, facing=facing, approach=facing))
    return None if best is None else best[1]


def _can_stand(at: Point2, spot: Spot, start: Point2, walkable: Walkable) -> bool:
    """Whether one can walk there and stand, and no wall is between the place and the thing."""
    if walkable.clearance(at) < STAND or not walkable.reachable(start, at):
        return False
    way = np.array([spot.point[0] - at[0], spot.point[2] - at[1]])
    end = np.asarray(at) + way * max(1.0 - WALLED / float(np.linalg.norm(way)), 0.0)
    return walkable.sees(at, (float(end[0]), float(end[1])))


def down_on_knees(start: Pose, skeleton: Skeleton) -> list[Pose]:
    """From standing to both knees, as keys: one foot lifted back, that knee down, then the other."""
    behind = _feet_behind(start, skeleton)
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
        hips=upright(yaw, 0.55 * leans),
        spine=np.stack([bend(0.5 * float(lean)) for lean in leans]),
    )
    places = shoulders(tries, skeleton)
    gap = np.linalg.norm(places[:, index] - goal, axis=1)
    arm = 0.54 * skeleton.scale
    miss = np.maximum(gap - 0.93 * arm, 0.0) + np.maximum(0.7 * arm - gap, 0.0)
    best = int(np.argmin(miss + 0.02 * np.abs(leans - np.radians(80))))
    pose = replace(tries.at(best), head=bend(-0.45))
    bearing = 1 - index
    room = float((goal - places[best, bearing]) @ ahead) - HAND * skeleton.scale
    palm = places[best, bearing] + min(0.12 * skeleton.scale, room) * ahead
    palm[1] = HAND_REST
    reach, reaching, palms, elbows = pose.reach.copy(), np.zeros(2), pose.palms.copy(), pose.elbows.copy()
    reach[bearing], reaching[bearing] = palm, 1.0
    elbows[bearing] = np.array([0.35 * (1 - 2 * bearing), -1.0, 0.0])
    palms[bearing] = palm_on(UP, yaw, ("left", "right")[bearing])
    return replace(pose, reach=reach, reaching=reaching, palms=palms, elbows=elbows, pressing=reaching.copy())


def elbows_out(pose: Pose, laid: Laid) -> Pose:
    """A prone pose with the elbow of a hand on the thing out to its side, and below a hand on a front."""
    elbows = pose.elbows.copy()
    for index, *_ in laid.hands:
        side = 1.0 if index == 0 else -1.0
        elbows[index] = np.array([side, 0.0, OUT_TOP] if laid.normal[1] > 0.7 else [side, 0.0, OUT_FRONT])
    return replace(pose, elbows=elbows)


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
