"""What hands, trunk and legs do while a pose is held: write, play, drink, clap, laugh, stretch, squat (LINGO Table A1).

The numbers are rows of data/gestures.toml.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Final, Literal, NamedTuple

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import arm_arrays
from motion_backend.procedural.own_time import own_time
from motion_backend.procedural.pose import ROTATIONS, Pose, interpolate, smooth, spline
from motion_backend.procedural.touch.bursts import Burst
from motion_backend.procedural.touch.hand_contacts import palm_on
from motion_backend.procedural.touch.kneel import feet_behind, foot_back, foot_in_the_air
from motion_backend.procedural.touch.touch_keys import KneelTable
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.rotations import Array
from motion_backend.skeleton import ARM_LENGTH, HAND_REST
from scene_graphs.data_tables import read_table, table

Leg = Literal["stands", "lifted", "kneels"]
STANDS: Final = 0.895
"""A standing pelvis (metres at 1.70 m)."""
_FINGERS: Final = np.array([[0.6, 0.0, 0.8], [0.6, 0.0, -0.8]])
_BACKS: Final = np.array([[0.0, -1.0, 0.0], [0.0, -1.0, 0.0]])
_UPRIGHT: Final = np.array([[0.0, 0.88, 0.475], [0.0, -0.88, -0.475]])
_ASIDE: Final = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
PALMS: Final = {
    "up": rotations.basis_to_quat(_FINGERS, _BACKS, rotations.cross(_FINGERS, _BACKS)),
    "together": rotations.basis_to_quat(_UPRIGHT, _ASIDE, rotations.cross(_UPRIGHT, _ASIDE)),
}
"""Both hands against where the body faces: palms up, fingers ahead and outwards; or palm to palm, fingers up."""
ARMS_CATCH_UP: Final = 0.5
"""Seconds in which arms fall behind, and catch up in the end."""
BALL: Final = np.array([0.0, -0.035, 0.12])
"""The ball of a foot from its ankle (metres at 1.70 m)."""


@table
class HandWave:
    """One wave that a hand is moved by."""

    rate_hz: float | None = None
    """Without one the hand goes there and stays."""
    hand: Literal["left", "right", "raised", "both"] = "right"
    """Both of them go as in a mirror."""
    left_arms: float = 0.0
    """How far to the left, up and ahead it goes (arm lengths)."""
    up_arms: float = 0.0
    ahead_arms: float = 0.0
    phase_share: float = 0.0
    """Where in its period it begins."""
    taps: bool = False
    """Whether only its upper half is gone through: up between strokes and down on them."""
    burst: Burst | None = None

    def offsets(self, time: Array) -> Array:
        """At times (T,): to the left, up and ahead. (T, 3)."""
        wave = wave_of(self.rate_hz, time, self.phase_share, self.burst)
        return (np.maximum(wave, 0.0) if self.taps else wave)[:, None] * [self.left_arms, self.up_arms, self.ahead_arms]

    def of_hand(self, index: int, raised: Array) -> Array | float:
        """How much of it the left (0) or right hand (1) goes, to the left, up and ahead; `raised` says when it is."""
        if self.hand == "raised":
            return raised[:, None]
        if self.hand == "both":
            return np.array([1.0 - 2.0 * index, 1.0, 1.0])
        return float(self.hand == ("left", "right")[index])


@table
class TrunkWave:
    """One wave that trunk or head bends in."""

    part: Literal["spine", "head", "hips"]
    """Hips take the pelvis with them, and the trunk on it."""
    rate_hz: float | None = None
    forward_rad: float = 0.0
    turn_rad: float = 0.0
    side_rad: float = 0.0
    up_m: float = 0.0
    """Of hips, at 1.70 m."""
    phase_share: float = 0.0
    burst: Burst | None = None

    def bent(self, pose: Pose, time: Array, ease: Array) -> Pose:
        """T frames with it at times (T,), as far as `ease` (T,) has it."""
        size = ease * wave_of(self.rate_hz, time, self.phase_share, self.burst)
        bends = size[:, None] * [self.forward_rad, self.turn_rad, self.side_rad]
        if self.part != "hips":
            part = getattr(pose, self.part) + bends
            return replace(pose, spine=part) if self.part == "spine" else replace(pose, head=part)
        up = size[:, None] * [0.0, self.up_m, 0.0] * pose.pelvis[:1, 1:2] / STANDS
        return replace(
            pose, pelvis=pose.pelvis + up, hips=rotations.compose(pose.hips, rotations.rotvec_to_quat(bends))
        )


@table
class MoveKey:
    """A key pose of what is done again and again, against the pose that is held."""

    at_share: float
    """When in its time."""
    arms: tuple[str, str] = ("", "")
    """Poses of styles/arms.toml for the left and the right; as they are held where that is empty."""
    palms: Literal["", "up", "together"] = ""
    """One of `PALMS`; as they come where that is empty."""
    spine_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Forwards, to the left, to the side."""
    head_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)
    hips_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Forwards, to the left, to the side: the left side up."""
    pelvis_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """To the left, up, ahead, at 1.70 m."""
    left_foot_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    right_foot_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Where they are against where they stood; they stand there where they are not off the floor."""
    left_foot_down_rad: float = 0.0
    right_foot_down_rad: float = 0.0
    """How far its tip points down."""
    turn_rad: float = 0.0
    """How far to the left the body has turned by then about where it stood,"""
    feet_turn_rad: tuple[float, float] = (0.0, 0.0)
    """and its left and its right foot."""
    flight_m: float = 0.0
    """How high the balls of both feet are off the floor; the pelvis is as high as `pelvis_m` says."""
    heels_up_rad: float = 0.0
    """How far the soles of both are tipped up on their balls."""
    legs: tuple[Leg, Leg] = ("stands", "stands")
    """What the left and the right do: stand, are on the way back and off the floor, or kneel on toes and knee."""
    palms_floor_m: tuple[float, float] | None = None
    """How far out to either side and ahead of where one stood both palms are flat on the floor."""

    @property
    def steps(self) -> bool:
        """Whether a foot goes anywhere."""
        return any((*self.left_foot_m, *self.right_foot_m, self.flight_m)) or self.legs != ("stands", "stands")

    def pose(self, held: Pose, spread: float = 1.0) -> Pose:
        """That key of a single held pose; level ways of feet and pelvis are such a share of what it says."""
        stood, held, wide = held, self._knelt(held), np.array([spread, 1.0, spread])
        heading, scale = rotations.yaw_to_quat(yaw_of(held.hips)), float(held.pelvis[1]) / STANDS
        named = np.array([bool(name) for name in self.arms])
        wrists, poles = arm_arrays(*(name or "hang" for name in self.arms))
        off = wide * np.array([self.left_foot_m, self.right_foot_m]) + [0.0, self.flight_m, 0.0]
        down = rotations.axis_to_quat(
            "x", self.heels_up_rad + np.array([self.left_foot_down_rad, self.right_foot_down_rad])
        )
        tipped = rotations.axis_to_quat("x", np.asarray(self.heels_up_rad))
        rolled = BALL - rotations.rotate(tipped, BALL)
        done = replace(
            held,
            pelvis=held.pelvis + scale * rotations.rotate(heading, wide * self.pelvis_m),
            hips=rotations.compose(held.hips, rotations.rotvec_to_quat(np.array(self.hips_rad))),
            spine=held.spine + self.spine_rad,
            head=held.head + self.head_rad,
            ankles=held.ankles + scale * (rotations.rotate(heading, off) + rotations.rotate(held.feet, rolled)),
            feet=rotations.compose(held.feet, down),
            toes=held.toes + (0.0 if self.flight_m else self.heels_up_rad),
            arms=np.where(named[:, None], wrists, held.arms),
            elbows=np.where(named[:, None], poles, held.elbows),
            # A hand that goes elsewhere leaves what it may have been laid on.
            reaching=np.where(named, 0.0, held.reaching),
            palms=rotations.compose(heading, PALMS[self.palms]) if self.palms else held.palms,
            pressing=np.where(named, float(bool(self.palms)), held.pressing),
            planted=np.where(off[:, 1] > 0.0, 0.0, held.planted),
        )
        return done if self.palms_floor_m is None else self._on_palms(done, stood, scale, heading)

    def _on_palms(self, pose: Pose, stood: Pose, scale: float, heading: Array) -> Pose:
        """A pose with both palms on the floor before where the body stood."""
        out, ahead = self.palms_floor_m or (0.0, 0.0)
        way = rotations.rotate(heading, np.array([[out, 0.0, ahead], [-out, 0.0, ahead]]))
        places = stood.ankles.mean(axis=0) * [1.0, 0.0, 1.0] + scale * way + [0.0, HAND_REST, 0.0]
        yaw = float(yaw_of(stood.hips))
        palms = np.stack([palm_on(np.array([0.0, 1.0, 0.0]), yaw, side) for side in ("left", "right")])
        return replace(pose, reach=places, palms=palms, reaching=np.ones(2), pressing=np.ones(2))

    def _knelt(self, held: Pose) -> Pose:
        """The same pose with the legs that do not stand."""
        if self.legs == ("stands", "stands"):
            return held
        rows: KneelTable = read_table("motion_backend", "transitions/kneel_to_touch.toml", KneelTable)
        body = replace(rows.body, behind_m=gesture_table().kneels_behind_m)
        behind = feet_behind(held, body, float(held.pelvis[1]) / STANDS)
        ways = {"lifted": foot_in_the_air, "kneels": foot_back}
        for index, leg in enumerate(self.legs):
            held = ways[leg](held, index, behind, body) if leg in ways else held
        return held


@table
class Move:
    """A gesture that is waves, each added to the ones before, and key poses that are gone through."""

    hands: tuple[HandWave, ...] = ()
    trunk: tuple[TrunkWave, ...] = ()
    every_s: float = 1.0
    """About how long it takes to go through the keys and back to the pose that is held."""
    keys: tuple[MoveKey, ...] = ()
    lingers_at_share: float | None = None
    """From the key at this share on there is time left, where there is more of it: what comes before keeps its pace.
    Without one all of it is slower."""
    arms_late_s: float = 0.0
    """So much later than hips and feet arms come to each key."""
    room_m: float = 0.0
    """How far about the body the floor is to be free, beyond what standing there needs (at 1.70 m)."""
    goes_for_room: bool = False
    """Whether who has not so much of it goes to where there is more; else all is done nearer to the spot."""
    lane_m: tuple[float, float] | None = None
    """How far behind and ahead of where one stood who is down on the floor for it needs that free (at 1.70 m)."""

    def times(self, seconds: float) -> Array:
        """When the keys are reached in so many seconds, first of them the pose that is held. (turns, 1 + keys)."""
        paced = self.lingers_at_share is not None
        turns = max(int(seconds / self.every_s) if paced else round(seconds / self.every_s), 1)
        once = min(self.every_s, seconds) if paced else seconds / turns
        shares = np.array([0.0, *(key.at_share for key in self.keys)])
        found = once * (np.arange(turns)[:, None] + shares)
        if self.lingers_at_share is not None:
            found[-1, shares > self.lingers_at_share] += seconds - turns * once
        return np.asarray(found)


class Room(NamedTuple):
    """Free floor about a standing body (metres at 1.70 m)."""

    about_m: float
    """Beyond what standing there needs."""
    gone_for: bool
    """Whether it is gone to."""
    lane_m: tuple[float, float] | None
    """Behind and ahead, of who is down on it."""


@table
class Writing:
    """A line written, and the way back to the next."""

    line_s: float
    written_share: float
    """Of its time spent along the line."""
    returned_share: float
    line_arms: float
    start_arms: float
    """So far to the right of where the hand was a line begins."""
    across: HandWave
    along: HandWave


@table
class Reading:
    """A page read, and its leaf turned."""

    page_s: float
    leaf_at_share: float
    """When in a page's time its leaf is taken."""
    leaf_share: float
    leaf_left_arms: float
    leaf_up_arms: float
    leaf_ahead_arms: float
    down_rad: float
    """How far the head sinks from the first line to the last."""
    scan_rad: float
    scan_hz: float


@table
class Music:
    """The beat kept; hands stay at the ears."""

    nod_rad: float
    nod_hz: float
    spine_nod_share: float
    """Of the nod, in the trunk."""
    sway_rad: float
    sway_hz: float


@table
class Gestures:
    """data/gestures.toml."""

    kneels_behind_m: float
    """How far behind where they stood the ankles are of who kneels."""
    ease_s: float
    """A gesture grows out of the held pose, and back into it, over this long."""
    write: Writing
    read: Reading
    music: Music
    moves: dict[str, Move]


def gesture_table() -> Gestures:
    """The numbers of every gesture."""
    rows: Gestures = read_table("motion_backend", "gestures.toml", Gestures)
    return rows


def gesture(held: Pose, doing: str, spread: float = 1.0, rng: np.random.Generator | None = None) -> Pose:
    """A held pose of T frames with hands that do something; as it was where `doing` is none of `gesture_names`.

    Feet and pelvis go such a share of their ways over the floor. By chance what is done again and again, without a
    beat, has a tempo of its own.
    """
    if doing not in gesture_names():
        return held
    time = np.arange(1, len(held) + 1) / FPS
    seconds = gesture_table().ease_s
    ease = smooth(time / seconds) * smooth((time[-1] - time) / seconds)
    if rng is not None and _is_free_of_beat(doing, float(time[-1])):
        time = own_time(time, rng)
    return _OWN.get(doing, partial(_move, doing=doing, spread=spread))(held, time, ease)


def _is_free_of_beat(doing: str, seconds: float) -> bool:
    """Whether it is done again and again in so many seconds, neither to a beat nor with steps."""
    move = gesture_table().moves.get(doing)
    if move is None or move.lingers_at_share is not None:
        return False
    return not move.keys or (len(move.times(seconds)) > 1 and not any(key.steps for key in move.keys))


def leaves_an_arm(doing: str) -> bool:
    """Whether it is nothing that both arms do."""
    move = gesture_table().moves.get(doing)
    one_hand = move is not None and all(row.hand in ("right", "raised") for row in move.hands)
    return move is not None and one_hand and not any(key.arms[0] for key in move.keys)


def room_for(doing: str) -> Room:
    """What free floor about a standing body it takes."""
    move = gesture_table().moves.get(doing, Move())
    return Room(move.room_m, move.goes_for_room, move.lane_m)


def wave_of(rate: float | None, time: Array, phase: float = 0.0, burst: Burst | None = None) -> Array:
    """A wave of unit size at times (T,), as far as a burst has it. (T,)."""
    wave = np.sin(2 * np.pi * (rate * time + phase)) if rate else np.ones_like(time)
    return np.asarray(wave if burst is None else burst.share(time) * wave)


def _moved(held: Pose, left: Array, right: Array, ease: Array) -> Pose:
    """Wrists moved by offsets (T, 3) in arm lengths, those of hands that lie somewhere as the body faces."""
    offsets = ease[:, None, None] * np.stack([left, right], axis=1)
    heading = rotations.yaw_to_quat(yaw_of(held.hips))[:, None]
    return replace(held, arms=held.arms + offsets, reach=held.reach + ARM_LENGTH * rotations.rotate(heading, offsets))


def _move(held: Pose, time: Array, ease: Array, doing: str, spread: float) -> Pose:
    """The key poses and the waves of that name."""
    rows = gesture_table().moves[doing]
    held = _through_keys(held, time, rows, spread) if rows.keys else held
    offsets, raised = np.zeros((2, len(time), 3)), np.where(held.arms[:, :, 1] > 0, 1.0, 0.0)
    for row in rows.hands:
        for index in (0, 1):
            offsets[index] += row.of_hand(index, raised[:, index]) * row.offsets(time)
    moved = _moved(held, offsets[0], offsets[1], ease)
    for bend in rows.trunk:
        moved = bend.bent(moved, time, ease)
    return moved


def _through_keys(held: Pose, time: Array, rows: Move, spread: float) -> Pose:
    """T frames of a held pose that go through the keys and back, as often as there is time for."""
    base, at = held.at(0), rows.times(float(time[-1]))
    keys = [MoveKey(at_share=0.0), *rows.keys]
    poses = [key.pose(base, spread) for key in keys]
    turned = np.array([[key.turn_rad, *key.feet_turn_rad] for key in keys])
    clock = np.arange(1, len(held) + 1) / FPS
    knots = np.interp(np.append(at, time[-1]), [0.0, *time], [0.0, *clock])
    way = interpolate(knots.tolist(), [*poses * len(at), base], FPS)
    way = _arms_later(way, rows.arms_late_s * FPS)
    added = ("pelvis", "spine", "head", "ankles", "toes", "knees", "arms", "elbows", "reach", "reaching", "pressing")
    moved = {name: getattr(held, name) + getattr(way, name) - getattr(base, name) for name in added}
    turns = {
        name: rotations.compose(getattr(held, name), rotations.compose(rotations.inverse(start), getattr(way, name)))
        for name in ROTATIONS
        for start in [getattr(base, name)]
    }
    done = replace(held, planted=np.minimum(held.planted, way.planted), **moved, **turns)
    if not turned.any():
        return done
    # Who turns about in it goes on from there in the next turn.
    by = np.concatenate([*(turned + turn * turned[-1] for turn in range(len(at))), len(at) * turned[-1:]])
    return _turned(done, base.ankles.mean(axis=0), spline(knots, by, clock))


def _arms_later(pose: Pose, frames: float) -> Pose:
    """T frames whose arms are so many frames behind, but not at either end."""
    if not frames:
        return pose
    place, ends = np.arange(len(pose)), np.minimum(np.arange(len(pose)), np.arange(len(pose))[::-1])
    then = place - frames * smooth(ends / (ARMS_CATCH_UP * FPS))
    before = np.clip(np.floor(then).astype(int), 0, len(pose) - 2)
    share = (then - before)[:, None, None]
    late = {name: one[before] + share * (one[before + 1] - one[before]) for name in ("arms", "elbows")
            for one in [getattr(pose, name)]}  # fmt: skip
    return replace(pose, **late)


def _turned(pose: Pose, about: Array, by: Array) -> Pose:
    """T frames turned to the left about a place (3,): the body, the left and the right foot by angles (T, 3)."""
    turns = rotations.yaw_to_quat(by)
    body, feet = turns[:, 0], turns[:, 1:]
    knees = rotations.yaw_to_quat(by.mean(axis=1))[:, None]
    return replace(
        pose,
        pelvis=about + rotations.rotate(body, pose.pelvis - about),
        hips=rotations.compose(body, pose.hips),
        knees=rotations.rotate(knees, pose.knees),
        ankles=about + rotations.rotate(feet, pose.ankles - about),
        feet=rotations.compose(feet, pose.feet),
        reach=about + rotations.rotate(body[:, None], pose.reach - about),
        palms=rotations.compose(body[:, None], pose.palms),
    )


def _write(held: Pose, time: Array, ease: Array) -> Pose:
    """The right hand goes along a line in small strokes, and back to the next; the left keeps the paper."""
    row = gesture_table().write
    line = (time / row.line_s) % 1.0
    across = np.where(line < row.written_share, line / row.written_share, (1.0 - line) / row.returned_share)
    strokes = row.along.offsets(time)
    strokes[:, 0] = row.line_arms * smooth(across) - row.start_arms + row.across.offsets(time)[:, 0]
    return _moved(held, np.zeros_like(strokes), strokes, ease)


def _read(held: Pose, time: Array, ease: Array) -> Pose:
    """The eyes go along the lines and down the page; now and then the right hand turns a leaf over."""
    row = gesture_table().read
    turns = max(round(float(time[-1]) / row.page_s), 1)
    page = time / time[-1] * turns % 1.0
    leaf = np.clip((page - row.leaf_at_share) / row.leaf_share, 0.0, 1.0)
    over = np.sin(np.pi * smooth(leaf))
    sweep = over[:, None] * [row.leaf_left_arms, row.leaf_up_arms, row.leaf_ahead_arms]
    head = held.head.copy()
    head[:, 0] += ease * row.down_rad * (page - 0.5)
    head[:, 1] += ease * row.scan_rad * wave_of(row.scan_hz, time)
    return _moved(replace(held, head=head), np.zeros_like(sweep), sweep, ease)


def _music(held: Pose, time: Array, ease: Array) -> Pose:
    """The head nods and the trunk sways with the beat; the hands stay at the ears."""
    row = gesture_table().music
    nod = ease * row.nod_rad * wave_of(row.nod_hz, time)
    sway, still = ease * row.sway_rad * wave_of(row.sway_hz, time), np.zeros_like(nod)
    spine = held.spine + np.stack([row.spine_nod_share * nod, still, sway], axis=1)
    return replace(held, head=held.head + np.stack([nod, still, still], axis=1), spine=spine)


_OWN: Final[dict[str, Callable[[Pose, Array, Array], Pose]]] = {"write": _write, "read": _read, "music": _music}
"""Gestures that are neither waves nor key poses alone."""


def gesture_names() -> tuple[str, ...]:
    """What hands and body can be told to do."""
    return (*_OWN, *gesture_table().moves)
