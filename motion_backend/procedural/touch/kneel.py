"""Getting down on both knees with the trunk prone, one hand on the floor: how low things are touched lying forwards.

Key poses are rows of data/transitions/kneel_to_touch.toml.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.held_poses import UP, bend, shoulders, upright
from motion_backend.procedural.pose import Pose
from motion_backend.procedural.touch.hand_contacts import palm_on
from motion_backend.procedural.touch.touch_keys import Foot, KneelingBody, KneelPose, KneelTable, Prone
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.rotations import Array
from motion_backend.scene import Scene
from motion_backend.skeleton import ARM_LENGTH, HAND_REST, Skeleton
from scene_graphs.affordances.affordances import Spot
from scene_graphs.layout import Point2
from scene_graphs.navigation.path_planner import Walkable

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
TURN_COST, MOVE_COST = 0.05, 0.1
"""What a radian aside, and a metre nearer or farther, count for in choosing where to kneel (metres of elbow room)."""


def feet_behind(start: Pose, body: KneelingBody, scale: float) -> Array:
    """Where the ankles of a body that stands in a pose are when it kneels there. (2, 3)."""
    ahead = _ahead(start)
    aside = np.array([ahead[2], 0.0, -ahead[0]])
    sides = np.array([[body.apart_m], [-body.apart_m]]) * aside
    places = start.ankles.mean(axis=0) + scale * (sides - body.behind_m * ahead)
    places[:, 1] = body.ankle_up_m * scale
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
            tight = max(float(depth(arms).max()) + ELBOW, 0.0) + TURN_COST * abs(turn) + MOVE_COST * abs(away - AWAY[0])
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


def down_on_knees(start: Pose, skeleton: Skeleton, keys: KneelTable) -> list[Pose]:
    """From standing to both knees, as keys: one foot lifted back, that knee down, then the other."""
    behind = feet_behind(start, keys.body, skeleton.scale)
    return [_kneeling(start, row, keys.body, behind, skeleton) for row in keys.pose]


def _kneeling(start: Pose, row: KneelPose, body: KneelingBody, behind: Array, skeleton: Skeleton) -> Pose:
    """A body that stood in a pose, in one on the way down; `behind` (2, 3) is where its ankles go."""
    feet: tuple[Foot, Foot] = (row.left, row.right)
    pose = start
    for index, foot in enumerate(feet):
        if foot == "back":
            pose = foot_back(pose, index, behind, body)
    pose = _crouched(pose, row, body, skeleton)
    for index, foot in enumerate(feet):
        if foot == "lifted":
            pose = foot_in_the_air(pose, index, behind, body)
    return pose


def prone(knees: Pose, goal: Array, index: int, skeleton: Skeleton, row: Prone) -> Pose:
    """From both knees: sat back and bent forwards until a hand (0 left, 1 right) reaches the goal, the other bears."""
    yaw = float(yaw_of(knees.hips))
    leans = np.radians(np.arange(row.lean_min_deg, row.lean_below_deg, row.lean_step_deg))
    tries = knees.repeat(len(leans))
    ahead = _ahead(knees)
    middle = knees.ankles.mean(axis=0) + row.pelvis_ahead_m * skeleton.scale * ahead
    pelvis = np.array([middle[0], row.pelvis_up_m * skeleton.scale, middle[2]])
    tries = replace(
        tries,
        pelvis=np.tile(pelvis, (len(leans), 1)),
        hips=upright(yaw, row.hips_share * leans),
        spine=np.stack([bend(row.spine_share * float(lean)) for lean in leans]),
    )
    places = shoulders(tries, skeleton)
    gap = np.linalg.norm(places[:, index] - goal, axis=1)
    arm = ARM_LENGTH * skeleton.scale
    miss = np.maximum(gap - row.arm_max_share * arm, 0.0) + np.maximum(row.arm_min_share * arm - gap, 0.0)
    best = int(np.argmin(miss + row.unusual_m * np.abs(leans - np.radians(row.usual_lean_deg))))
    pose = replace(tries.at(best), head=bend(row.head_pitch_rad))
    bearing = 1 - index
    room = float((goal - places[best, bearing]) @ ahead) - HAND * skeleton.scale
    palm = places[best, bearing] + min(row.bearing_ahead_m * skeleton.scale, room) * ahead
    palm[1] = HAND_REST
    reach, reaching, palms, elbows = pose.reach.copy(), np.zeros(2), pose.palms.copy(), pose.elbows.copy()
    reach[bearing], reaching[bearing] = palm, 1.0
    elbows[bearing] = row.bearing_elbow.of(bearing)
    palms[bearing] = palm_on(UP, yaw, ("left", "right")[bearing])
    return replace(pose, reach=reach, reaching=reaching, palms=palms, elbows=elbows, pressing=reaching.copy())


def _ahead(pose: Pose) -> Array:
    yaw = float(yaw_of(pose.hips))
    return np.array([np.sin(yaw), 0.0, np.cos(yaw)])


def _crouched(pose: Pose, row: KneelPose, body: KneelingBody, skeleton: Skeleton) -> Pose:
    """The pelvis behind the standing feet and lowered, the trunk bent forwards, as a row says."""
    yaw = float(yaw_of(pose.hips))
    pelvis = pose.pelvis - row.pelvis_back_m * skeleton.scale * _ahead(pose)
    pelvis[1] = row.pelvis_up_m * skeleton.scale
    hips, spine = upright(yaw, body.hips_share * row.lean_rad), bend(body.spine_share * row.lean_rad)
    return replace(pose, pelvis=pelvis, hips=hips, spine=spine, head=bend(body.head_forward_rad))


def foot_back(pose: Pose, index: int, behind: Array, body: KneelingBody) -> Pose:
    """One foot (0 left, 1 right) on its curled toes behind."""
    ankles, feet, toes, knees = pose.ankles.copy(), pose.feet.copy(), pose.toes.copy(), pose.knees.copy()
    ankles[index] = behind[index]
    pitched = rotations.rotvec_to_quat(np.array([body.foot_pitch_rad, 0.0, 0.0]))
    feet[index] = rotations.compose(pose.feet[index], pitched)
    toes[index] = body.toes_rad
    knees[index] = _ahead(pose) - body.knee_down_ratio * UP
    return replace(pose, ankles=ankles, feet=feet, toes=toes, knees=knees)


def foot_in_the_air(pose: Pose, index: int, behind: Array, body: KneelingBody) -> Pose:
    """A foot half-way back, off the floor."""
    lifted = foot_back(pose, index, behind, body)
    ankles, planted = pose.ankles.copy(), pose.planted.copy()
    ankles[index] = 0.5 * (pose.ankles[index] + behind[index]) + body.lifted_m * UP
    planted[index] = 0.0
    feet = lifted.feet.copy()
    feet[index] = rotations.slerp(pose.feet[index], lifted.feet[index], 0.5)
    return replace(lifted, ankles=ankles, feet=feet, toes=0.5 * (pose.toes + lifted.toes), planted=planted)
