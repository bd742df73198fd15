"""Where the eyes go: to what is done next, to what the hand does, now and then to a window or a thing nearby.

Head and, a little, trunk turn towards places in the world, within what they can and as far as nothing says otherwise:
a caption that names how the head is held is obeyed. The numbers are rows of data/gaze.toml.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from motion_backend import rotations
from motion_backend.backend_protocol import Part, PartKind
from motion_backend.motion import FPS, Emotion, Posture, Skill
from motion_backend.procedural.body_state import Body, Point
from motion_backend.procedural.emotion_style import bearing_of
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.pose_solver import chest_frame
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton
from scene_graphs.data_tables import read_table, table

CONTACTS: Final = (PartKind.REACH, PartKind.SIT, PartKind.LIE)
WALKS: Final = (PartKind.WALK, PartKind.TURN)
WAITS: Final = re.compile(r"\bwaiting\b", re.IGNORECASE)
"""Captions of who waits for somebody."""
ON_A_SIDE: Final = 0.5
"""Who lies has one hip higher than the other by more than this share of the way between them."""
PRESSED: Final = 0.9
"""A hand that presses more than this is at its thing."""


@table
class Lead:
    """A look at the end of something."""

    lead_s: float
    """Begins so long before its end,"""
    take_s: float
    """and takes so long."""
    eyes_m: float = 0.0
    """How high above the floor one looks at a place."""


@table
class Touching:
    """The eyes on what a hand does."""

    take_s: float
    leave_s: float


@table
class Waiting:
    """Looks at the door, of who waits."""

    from_share: tuple[float, ...]
    """They begin at these shares of the time,"""
    stay_share: tuple[float, ...]
    """and last so long."""


@table
class Glance:
    """Looks at something aside, now and then, and back: bounds that chance keeps."""

    first_min_s: float
    first_max_s: float
    stay_min_s: float
    stay_max_s: float
    turn_s: float
    wait_min_s: float
    wait_max_s: float
    last_s: float
    """None begins later than this before the end."""
    near_m: float
    far_m: float
    share: float
    """Of the way there, that the head goes."""
    aside_rad: float
    """How far aside at most where there is nothing to look at."""


@table
class Gaze:
    """data/gaze.toml."""

    told: str
    """The pattern of captions that say themselves where the head is."""
    kept: str
    """Of those of them in which it stays there until the end."""
    begin_s: float
    turn_max_rad: float
    lost_rad: float
    """From so far aside on nothing is seen any more."""
    nod_min_rad: float
    nod_max_rad: float
    trunk_share: float
    """Of a turn aside, in the trunk."""
    lying_turn_max_rad: float
    eyes_up_m: float
    eyes_ahead_m: float
    smoothed_s: float
    arriving: Lead
    touching: Touching
    onward: Lead
    waiting: Waiting
    glance: Glance


class Look(NamedTuple):
    """What is looked at."""

    target: Array
    """(3,) world."""
    share: Array
    """How far the head goes there, 0 to 1. (T,)."""
    trunk: bool = True
    """Whether the trunk turns with it: not while hands work."""


def gaze_table() -> Gaze:
    """The numbers of looking."""
    rows: Gaze = read_table("motion_backend", "gaze.toml", Gaze)
    return rows


def gazing(pose: Pose, body: Body, part: Part) -> Pose:
    """T frames of a part with the eyes on what it is about; as they were where the caption says where they are."""
    row = gaze_table()
    held = any(hold is not None and hold.part == "head" for hold in body.holds)
    # Who walks to a seat is not yet in the pose that its caption names.
    named = part.kind not in WALKS or part.action.skill is Skill.LOCO
    told = named and re.search(row.told, part.action.caption.lower())
    if (
        held
        or _sleeps(pose, body, part)
        or (told and (part.kind is not PartKind.HOLD or re.search(row.kept, part.action.caption.lower())))
    ):
        return pose
    looks = _beside_what_is_told(pose, body, part, row) if told else _looks(pose, body, part, row)
    return turned_to(pose, list(looks), body.posture, body.skeleton, row)


def _sleeps(pose: Pose, body: Body, part: Part) -> bool:
    """Whether the head stays on its pillow: of who lies tired, or on a side, where to turn it would be to lift it."""
    across = abs(float(rotations.rotate(pose.hips[-1], np.array([1.0, 0.0, 0.0]))[1]))
    lies = part.kind in (PartKind.LIE, PartKind.HOLD) and body.posture is Posture.LYING
    return lies and (part.action.emotion is Emotion.TIRED or across > ON_A_SIDE)


def _beside_what_is_told(pose: Pose, body: Body, part: Part, row: Gaze) -> Iterator[Look]:
    """What is looked at by who does what says where the head is: the door that is waited for, and what comes next."""
    if WAITS.search(part.action.caption):
        doors = body.scene.doors(body.scene.home.room_at(body.place))
        near = _before(pose, doors, body, row.lost_rad)
        if len(near):
            door, at = near[np.argmin(np.linalg.norm(near - pose.pelvis[0], axis=1))], np.linspace(0.0, 1.0, len(pose))
            turn = row.glance.turn_s * FPS / len(pose)
            for start, stay in zip(row.waiting.from_share, row.waiting.stay_share, strict=True):
                yield Look(door, smooth((at - start) / turn) * smooth((start + stay + turn - at) / turn))
    yield from _at_what_comes(pose, body, part, row)


def _looks(pose: Pose, body: Body, part: Part, row: Gaze) -> Iterator[Look]:
    """What a body looks at in a part."""
    left = np.arange(len(pose))[::-1] / FPS
    following = body.upcoming[0] if body.upcoming else None
    if part.kind in WALKS:
        target = _contact(following) if following is not None else None
        if target is not None:
            yield Look(target, smooth((row.arriving.lead_s - left) / row.arriving.take_s))
        return
    if part.kind is PartKind.REACH:
        yield from _at_the_hand(pose, part, row)
    if part.kind is PartKind.HOLD:
        yield from _glances(pose, body, part, row)
    yield from _at_what_comes(pose, body, part, row)


def _at_what_comes(pose: Pose, body: Body, part: Part, row: Gaze) -> Iterator[Look]:
    """In the end the eyes are on what is done after this."""
    target = _onward(body, row)
    if target is not None and part.kind not in (PartKind.SIT, PartKind.LIE) and body.posture is not Posture.LYING:
        left = np.arange(len(pose))[::-1] / FPS
        yield Look(target, smooth((row.onward.lead_s - left) / row.onward.take_s))


def _at_the_hand(pose: Pose, part: Part, row: Gaze) -> Iterator[Look]:
    """The eyes on what is touched, from the beginning until the hand leaves it."""
    there = np.flatnonzero((pose.pressing.max(axis=1) > PRESSED) & (pose.reaching.max(axis=1) > PRESSED))
    target = _contact(part)
    if target is not None and len(there):
        at = np.arange(len(pose)) / FPS
        yield Look(
            target, smooth(at / row.touching.take_s) * smooth((at[there[-1]] - at) / row.touching.leave_s), False
        )


def _contact(part: Part) -> Array | None:
    """The place on a piece that a part gets to."""
    return np.asarray(part.action.spot.point) if part.kind in CONTACTS and part.action.spot is not None else None


def _onward(body: Body, row: Gaze) -> Array | None:
    """What is done after this: the thing of the next contact, or where the next walk leads, if in the same room."""
    home, here = body.scene.home, body.scene.home.room_at(body.place)
    for later in body.upcoming:
        spot = later.action.spot if later.kind in CONTACTS else None
        place: Point | None = spot.standing if spot is not None else later.goal
        if place is not None and home.room_at(place) == here:
            return np.array(spot.point if spot is not None else (place[0], row.onward.eyes_m, place[1]))
    return None


def _glances(pose: Pose, body: Body, part: Part, row: Gaze) -> Iterator[Look]:
    """Looks at things aside, now and then, and back; the restless more often."""
    way, rng, frames = row.glance, body.rng, len(pose)
    restless = max(bearing_of(part.action.emotion, part.action.caption).restless, 0.5)
    at = rng.uniform(way.first_min_s, way.first_max_s) * FPS / restless
    seen = _in_sight(pose, body, way)
    while at + way.last_s * FPS < frames:
        stay, turn = rng.uniform(way.stay_min_s, way.stay_max_s) * FPS, way.turn_s * FPS
        time = np.arange(frames) - at
        target = seen[int(rng.integers(len(seen)))] if len(seen) else _aside(pose, body, way)
        yield Look(target, way.share * smooth(time / turn) * smooth((stay + turn - time) / turn))
        at += stay + 2 * turn + rng.uniform(way.wait_min_s, way.wait_max_s) * FPS / restless


def _in_sight(pose: Pose, body: Body, way: Glance) -> Array:
    """Things and windows of the room before the body. (N, 3)."""
    if body.posture is Posture.LYING:
        return np.zeros((0, 3))
    sights = body.scene.sights(body.scene.home.room_at(body.place))
    seen = _before(pose, sights, body, gaze_table().turn_max_rad)
    far = np.linalg.norm((seen - pose.pelvis[0])[:, [0, 2]], axis=1)
    return np.asarray(seen[(far > way.near_m) & (far < way.far_m)])


def _before(pose: Pose, points: Array, body: Body, most: float) -> Array:
    """Those of N points that are no farther aside than this (radians) of where the chest looks at first. (M, 3)."""
    chest, place = chest_frame(pose.at(slice(0, 1)), body.skeleton)
    local = rotations.rotate(rotations.inverse(chest), points - place)
    return np.asarray(points[np.abs(np.arctan2(local[:, 0], local[:, 2])) < most])


def _aside(pose: Pose, body: Body, way: Glance) -> Array:
    """A place somewhere aside, where there is nothing to look at. (3,)."""
    chest, place = chest_frame(pose.at(slice(0, 1)), body.skeleton)
    angle = float(body.rng.uniform(-way.aside_rad, way.aside_rad))
    ahead = np.array([np.sin(angle), 0.0, np.cos(angle)])
    head = body.skeleton.offsets[INDEX["neck"]] + body.skeleton.offsets[INDEX["head"]]
    return np.asarray(place[0] + rotations.rotate(chest[0], head + way.far_m * ahead))


def turned_to(pose: Pose, looks: list[Look], posture: Posture, skeleton: Skeleton, row: Gaze) -> Pose:
    """T frames with head and trunk turned to what is looked at, from not at all at the first frame."""
    from scipy.ndimage import gaussian_filter1d

    if not looks:
        return pose
    chest, place = chest_frame(pose, skeleton)
    eyes = skeleton.offsets[INDEX["neck"]] + skeleton.offsets[INDEX["head"]]
    eyes = eyes + skeleton.scale * np.array([0.0, row.eyes_up_m, row.eyes_ahead_m])
    seen_from = place + rotations.rotate(chest, eyes)
    lies = posture is Posture.LYING
    most = row.lying_turn_max_rad if lies else row.turn_max_rad
    head, spine = np.zeros((len(pose), 3)), np.zeros((len(pose), 3))
    for look in looks:
        x, y, z = rotations.rotate(rotations.inverse(chest), look.target - seen_from).T
        turn = np.arctan2(x, z)
        share = look.share * smooth((row.lost_rad - np.abs(turn)) / (row.lost_rad - row.turn_max_rad))
        turn = np.clip(turn, -most, most)
        nod = np.clip(np.arctan2(-y, np.hypot(x, z)), row.nod_min_rad, row.nod_max_rad)
        trunk = row.trunk_share * turn if look.trunk and not lies else np.zeros_like(turn)
        nod = pose.head[:, 0] if lies else nod
        wanted = rotations.compose(rotations.yaw_to_quat(turn - trunk), rotations.axis_to_quat("x", nod))
        head += share[:, None] * (rotations.quat_to_rotvec(wanted) - pose.head)
        spine[:, 1] += share * trunk
    begun = smooth(np.arange(len(pose)) / (row.begin_s * FPS))[:, None]
    head, spine = (
        begun * gaussian_filter1d(way, row.smoothed_s * FPS, axis=0, mode="nearest") for way in (head, spine)
    )
    return replace(pose, head=pose.head + head, spine=pose.spine + spine)
