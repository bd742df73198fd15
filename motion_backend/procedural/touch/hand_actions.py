"""What is done once a hand is at a thing: rest, press, wipe, turn, pick up, put down, slam, pull; there and back.

Key poses and the way through them are rows of data/transitions/touch_*.toml, what a hand does that stays of
touch_held.toml.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.pose import Pose, concatenate, interpolate, smooth
from motion_backend.procedural.touch.gestures import wave_of
from motion_backend.procedural.touch.hand_captions import Laid, with_arms
from motion_backend.procedural.touch.hand_contacts import is_top
from motion_backend.procedural.touch.hand_placement import Grip, gripped
from motion_backend.procedural.touch.touch_keys import (
    HeldTouches,
    Rotate,
    Stroke,
    TouchKey,
    TouchKeys,
    TouchPose,
    TouchTable,
)
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.rotations import Array
from motion_backend.skeleton import ARM_LENGTH

Keys = list[tuple[Pose, float]]
"""Key poses, each with the seconds it takes to get to it."""
STAGES: Final = ("come", "do", "leave", "after")
"""What a touch consists of; motion comes to rest at the end of each."""


@dataclass(frozen=True)
class Way:
    """The poses a touch goes through, as the body that does it has found them."""

    away: Pose
    """Standing."""
    lead: Pose
    """Standing, with the eyes on the thing."""
    down: tuple[Pose, ...]
    """On the way down to one's knees, if one kneels."""
    hand: Callable[[float, float], Pose]
    """Bent to it, the hand so far off the surface (metres) and its fingers turned into it so far (radians)."""
    laid: Laid
    hold: float
    """Seconds to stay."""
    tempo: float
    """Speed of the hands against neutral."""
    bending: float
    """Seconds for what takes the whole body a second."""
    kneel_step: float
    """For each pose of `down`, of such seconds."""
    doing: str = ""
    looks: float = 1.0
    """How much of the time for looking at the thing it needs."""
    grip: Callable[[Pose], Grip] | None = None
    """How far the hand turns what it holds in such a pose, of who turns something."""
    step: Callable[[Pose, tuple[int, int, int]], Pose] = lambda whole, _lengths: whole
    """A foot that steps up to the thing and back, in frames of coming, doing and leaving."""
    speeds_up: float = 3.0
    """The power of the time that a hand is given over to the thing with."""
    luck: float = 0.0
    """How much harder than usual it strikes, in standard deviations."""

    @property
    def hands(self) -> list[int]:
        """Which hands are laid on the thing (0 left, 1 right)."""
        return [index for index, *_ in self.laid.hands]

    def through(self, start: Pose, keys: Keys) -> Pose:
        """Frames from a pose through others."""
        times = np.concatenate([[0.0], np.cumsum([wait for _, wait in keys])]) / self.tempo
        return interpolate([float(time) for time in times], [start, *(key for key, _ in keys)], FPS)

    def pose(self, row: TouchPose) -> Pose:
        """The body in a key pose."""
        if row.body == "at it":
            return _drawn(self, _bent(self, self.hand(row.off_m, row.fingers_rad), row), row)
        pose = self.away if row.body == "standing" else self.lead
        if row.arms:
            pose = with_arms(pose, self.hands, row.arms)
        if row.arms_up_arms:
            arms = pose.arms.copy()
            arms[self.hands, 1] += row.arms_up_arms
            pose = replace(pose, arms=arms)
        return _bent(self, pose, row)

    def seconds(self, key: TouchKey, busy: float) -> float:
        """What a key takes, in the hands' own seconds."""
        match key.pace:
            case "hands":
                return key.wait_s
            case "body":
                return key.wait_s * self.bending * self.tempo
            case "clock":
                return key.wait_s * self.tempo
            case "hold":
                return max(self.hold - busy, key.wait_s) * self.tempo

    def keys(self, rows: TouchTable, stage: str, poses: dict[str, Pose]) -> Keys:
        """The key poses of a stage; who kneels gets down before being at the thing, and up again after it."""
        found: Keys = []
        bodies = {row.name: row.body for row in rows.pose}
        there, step = stage in ("do", "leave"), self.kneel_step * self.bending * self.tempo
        for key in (key for key in rows.key if key.stage == stage):
            if there != (bodies[key.pose] == "at it"):
                found += [(knelt, step) for knelt in (self.down[::-1] if there else self.down)]
                there = not there
            looks = self.looks if bodies[key.pose] == "looking" else 1.0
            found.append((poses[key.pose], looks * self.seconds(key, rows.busy_s)))
        return found

    def turned(self) -> tuple[Array, Array]:
        """World directions to the body's left and ahead, along the surface. (3,), (3,)."""
        yaw = float(yaw_of(self.away.hips))
        left = np.array([np.cos(yaw), 0.0, -np.sin(yaw)])
        left = rotations.normalize(left - (left @ self.laid.normal) * self.laid.normal)
        return left, rotations.cross(left, self.laid.normal)


def deed(way: Way, keys: TouchKeys) -> Pose:
    """A touch from standing to standing, with what is done there (see `hand_captions.Handled`)."""
    doing = way.doing
    rows = keys.of(doing)
    poses = {row.name: way.pose(row) for row in rows.pose}
    frames: dict[str, Pose] = {}
    last = way.away
    for stage in STAGES:
        if stage == "do" and (held := _HELD.get(doing, _busy if doing in keys.held.busy else None)):
            frames[stage] = held(way, last, max(way.hold, rows.hold_min_s), keys.held)
        elif following := way.keys(rows, stage, poses):
            frames[stage] = _come(way, last, following, rows.stroke if stage == "come" else None)
            last, _ = following[-1]
    come, do, leave = (len(frames[stage]) for stage in STAGES[:3])
    return way.step(concatenate(list(frames.values())), (come, do, leave))


def pulled(first: Way, last: Way, way: Array, back: bool, keys: TouchKeys) -> Pose:
    """Frames from standing to standing: a hand laid as it is `first`, taken along a way of wrists (N, 3) to where it is
    `last`, kept there, and `back` by the same way or not; body and palm go along."""
    rows, row = keys.pull, keys.held.pull
    poses = [{one.name: end.pose(one) for one in rows.pose} for end in (first, last)]
    come = first.through(first.away, first.keys(rows, "come", poses[0]))
    there, stays = poses[0]["there"], poses[1]["there"]
    steps = np.diff(way, axis=0)
    length = float(np.linalg.norm(steps, axis=1).sum())
    sets_off, gets_there = rotations.normalize(steps[[0, -1]])
    turn = float(np.arccos(np.clip(sets_off @ gets_there, -1.0, 1.0)))
    takes = round(max(length / row.speed_mps, turn / row.rate_radps, row.swing_min_s) / first.tempo * FPS)
    time = np.arange(1, takes + 1) / takes
    grips, waits = there.repeat(round(row.grips_s * FPS)), round(max(first.hold, row.least_s) * FPS)
    swing = _carried(there, stays, way, time * time * (3 - 2 * time), first.hands[0])
    parts = [come, grips, swing, swing.at(takes - 1).repeat(waits)]
    ends = last
    if back:
        parts += [swing.at(slice(None, None, -1)), grips]
        ends, stays = first, there
    leave = ends.through(stays, ends.keys(rows, "leave", poses[0 if ends is first else 1]))
    return concatenate([*parts, leave])


def _carried(there: Pose, stays: Pose, way: Array, share: Array, hand: int) -> Pose:
    """Frames between two poses at shares (T,) of the time, a hand (0 left, 1 right) along a way of wrists (N, 3)."""
    frames = interpolate([0.0, 1.0], [there, stays], 120)
    eased = smooth(np.arange(1, len(frames) + 1) / len(frames))
    chosen = frames.at(np.clip(np.searchsorted(eased, share), 0, len(frames) - 1))
    reach = chosen.reach.copy()
    along = np.linspace(0.0, 1.0, len(way))
    reach[:, hand] = np.stack([np.interp(share, along, axis) for axis in way.T], axis=1)
    palms = chosen.palms.copy()
    palms[:, hand] = rotations.slerp(there.palms[hand], stays.palms[hand], share)
    return replace(chosen, reach=reach, palms=palms)


def _come(way: Way, last: Pose, keys: Keys, stroke: Stroke | None) -> Pose:
    """Frames through key poses, to the last one with a blow where there is a stroke."""
    if stroke is None:
        return way.through(last, keys)
    (drawn, _), (there, _) = keys[-2:]
    return concatenate([way.through(last, keys[:-1]), _struck(way, drawn, there, stroke)])


def _struck(way: Way, drawn: Pose, there: Pose, row: Stroke) -> Pose:
    """The hand flies faster and faster from where it is drawn back until it is at the thing, the trunk with it."""
    hand = way.hands[0]
    far = ARM_LENGTH * float(np.linalg.norm(there.arms[hand] - drawn.arms[hand]))
    speed = np.clip(row.speed_mps * (1 + row.speed_share * way.luck), row.speed_min_mps, row.speed_max_mps)
    frames = max(round(way.speeds_up * far / float(speed) * FPS), 2)
    whole = np.arange(1, frames + 1) / frames
    flying = interpolate([0.0, frames / FPS], [drawn, there], FPS)
    reach, reaching, pressing = flying.reach.copy(), flying.reaching.copy(), flying.pressing.copy()
    arms, palms = flying.arms.copy(), flying.palms.copy()
    arms[:, hand], reach[:, hand], palms[:, hand] = drawn.arms[hand], there.reach[hand], there.palms[hand]
    reaching[:, hand], pressing[:, hand] = whole, smooth(whole / row.palm_share)
    return replace(flying, arms=arms, reach=reach, reaching=reaching, palms=palms, pressing=pressing)


def _bent(way: Way, pose: Pose, row: TouchPose) -> Pose:
    """Trunk and head bent as a row says, the pelvis back."""
    turn = row.spine_turn_rad * (1.0 if way.laid.hand == "left" else -1.0)
    if row.spine_forward_rad or turn:
        pose = replace(pose, spine=pose.spine + np.array([row.spine_forward_rad, turn, 0.0]))
    if row.pelvis_back_m:
        ahead = rotations.rotate(rotations.yaw_to_quat(yaw_of(way.away.hips)), np.array([0.0, 0.0, 1.0]))
        pose = replace(pose, pelvis=pose.pelvis - row.pelvis_back_m * ahead)
    if row.head_forward_rad:
        pose = replace(pose, head=pose.head + np.array([row.head_forward_rad, 0.0, 0.0]))
    if row.head_pitch_rad is not None:
        pose = replace(pose, head=np.array([row.head_pitch_rad, 0.0, 0.0]))
    return pose


def _drawn(way: Way, pose: Pose, row: TouchPose) -> Pose:
    """The hands out from the surface and back over it, as a row says."""
    if not row.drawn_out_m and not row.drawn_back_m:
        return pose
    _, ahead = way.turned()
    reach = pose.reach.copy()
    back = row.drawn_back_m * ahead * float(is_top(way.laid.normal))
    reach[way.hands] += row.drawn_out_m * way.laid.normal - back
    return replace(pose, reach=reach)


def _rest(way: Way, there: Pose, seconds: float, keys: HeldTouches) -> Pose:
    """The hand stays, alive: it breathes, slides a little, and the eyes wander about it."""
    row = keys.rest
    time, ease, held = _held(there, seconds, keys.ease_s)
    left, _ = way.turned()
    reach = held.reach.copy()
    reach[:, way.hands[0]] += (row.slide_m * ease * _wave(row.slide_hz, time))[:, None] * left
    still = np.zeros_like(time)
    breath = row.breath_rad * _wave(row.breath_hz, time)
    glance = row.glance_rad * _wave(row.glance_hz, time)
    look = smooth(time / row.glance_ease_s)[:, None] * np.stack([row.nod_ratio * breath, glance, still], axis=1)
    spine = held.spine + np.stack([breath, still, still], axis=1)
    return replace(held, reach=reach, spine=spine, head=held.head + look)


def _recoil(way: Way, there: Pose, seconds: float, keys: HeldTouches) -> Pose:
    """The hand bounces off what stopped it and the trunk goes on; then it leans there, out of breath."""
    row = keys.recoil
    rest = replace(keys.rest, breath_rad=row.breath_ratio * keys.rest.breath_rad)
    held = _rest(way, there, seconds, replace(keys, rest=rest))
    time = np.arange(1, len(held) + 1) / FPS
    off, follows = (
        size * np.sin(np.pi * np.minimum(time / lasts, 1.0))
        for size, lasts in ((row.off_m, row.off_s), (row.follows_rad, row.follows_s))
    )
    reach = held.reach.copy()
    reach[:, way.hands[0]] += off[:, None] * way.laid.normal
    return replace(held, reach=reach, spine=held.spine + follows[:, None] * [1.0, 0.0, 0.0])


def _wash(way: Way, there: Pose, seconds: float, keys: HeldTouches) -> Pose:
    """Wide circles; trunk, hips and eyes go along."""
    row = keys.wash
    time, ease, held = _held(there, seconds, row.grows_s)
    around = 2 * np.pi * row.stroke_hz * time
    aside, forth = ease * np.sin(around), ease * np.cos(around)
    along = way.laid.stroke
    across = rotations.cross(along, way.laid.normal)
    reach, palms = held.reach.copy(), held.palms.copy()
    swing = rotations.rotvec_to_quat((row.palm_rad * aside)[:, None] * way.laid.normal)
    for index in way.hands:
        reach[:, index] += aside[:, None] * along + row.forth_share * forth[:, None] * across
        palms[:, index] = rotations.compose(swing, held.palms[:, index])
    left, ahead = way.turned()
    still, far = np.zeros_like(aside), 1 / row.usual_m
    turn, lean = far * float(along @ left) * aside, far * float(along @ ahead) * aside
    bend = np.stack([row.spine_forth_rad * forth + row.spine_lean_rad * lean, row.spine_turn_rad * turn, still], axis=1)
    look = np.stack([row.head_lean_rad * lean, row.head_turn_rad * turn, still], axis=1)
    return replace(
        held,
        reach=reach,
        palms=palms,
        pelvis=held.pelvis + row.pelvis_share * aside[:, None] * np.array([along[0], 0.0, along[2]]),
        spine=held.spine + bend,
        head=held.head + look,
    )


def _rotate(way: Way, there: Pose, seconds: float, keys: HeldTouches) -> Pose:
    """A grip that is turned about what it holds, let go of it, and taken anew, again and again as a lid is unscrewed;
    the elbow goes up and down with it, and the trunk along."""
    row = keys.rotate
    time, ease, held = _held(there, seconds, keys.ease_s)
    if way.grip is None:
        return held
    grip = way.grip(there)
    wave, back = _ratchet(row, time)
    angle = ease * grip.swung(wave)
    held = gripped(held, way.hands[0], angle, way.laid.normal, grip, row)
    reach = held.reach.copy()
    reach[:, way.hands[0]] += (row.lets_go_m * ease * back)[:, None] * way.laid.normal
    held = replace(held, reach=reach)
    left, _ = way.turned()
    along = angle / row.turn_rad
    still = np.zeros_like(along)
    return replace(
        held,
        pelvis=held.pelvis + row.pelvis_m * along[:, None] * np.array([left[0], 0.0, left[2]]),
        spine=held.spine + np.stack([still, row.spine_turn_rad * along, row.spine_side_rad * along], axis=1),
        head=held.head + np.stack([still, row.head_turn_rad * along, row.head_side_rad * along], axis=1),
    )


def _ratchet(row: Rotate, time: Array) -> tuple[Array, Array]:
    """A turn of unit size at times (T,), slowly there and quickly back, from its middle on; and how far the hand has
    let go, 0 to 1, on the way back."""
    phase = (row.turn_hz * time + row.turning_share / 2) % 1.0
    back = np.clip((phase - row.turning_share) / (1 - row.turning_share), 0.0, 1.0)
    there = np.minimum(phase / row.turning_share, 1.0)
    return -np.cos(np.pi * np.where(back > 0, 1 - back, there)), np.sin(np.pi * back)


def _busy(way: Way, there: Pose, seconds: float, keys: HeldTouches) -> Pose:
    """The hand goes in the waves of what is done over the thing: it knocks, stirs, pours."""
    row = keys.busy[way.doing]
    time, ease, held = _held(there, seconds, keys.ease_s)
    left, ahead = way.turned()
    reach, palms, aside = held.reach.copy(), held.palms.copy(), np.zeros_like(time)
    for move in row.moves:
        wave = ease * wave_of(move.rate_hz, time, move.phase_share, move.burst)
        wave = np.maximum(wave, 0.0) if move.taps else wave
        aside += move.aside_m * wave
        for index in way.hands:
            side = (1.0, -1.0)[index]
            reach[:, index] += wave[:, None] * (
                move.aside_m * left + move.ahead_m * ahead + move.off_m * way.laid.normal
            )
            tilt = rotations.axis_to_quat("x", -side * move.tilt_rad * wave)
            bend = rotations.rotvec_to_quat(-move.bend_rad * wave[:, None] * left)
            palms[:, index] = rotations.compose(rotations.compose(bend, palms[:, index]), tilt)
    spine = held.spine + np.stack([0 * aside, row.spine_turn_rad / keys.wash.usual_m * aside, 0 * aside], axis=1)
    away = 1.0 if way.laid.hand == "right" else -1.0
    ear = ease[:, None] * away * np.array([0.0, row.ear_turn_rad, row.ear_side_rad])
    return replace(held, reach=reach, palms=palms, spine=spine, head=held.head + ear)


_HELD: Final[dict[str, Callable[[Way, Pose, float, HeldTouches], Pose]]] = {
    "": _rest,
    "wash": _wash,
    "rotate": _rotate,
    "strike": _recoil,
}
"""What a hand does for some seconds that stays on a thing in a pose."""


def _held(pose: Pose, seconds: float, grows: float) -> tuple[Array, Array, Pose]:
    """Times (T,), an ease that is 0 at both ends and grows so long (T,), and the pose held for all those seconds."""
    time = np.arange(1, max(round(seconds * FPS), 1) + 1) / FPS
    return time, smooth(time / grows) * smooth((time[-1] - time) / grows), pose.repeat(len(time))


def _wave(rate: float, time: Array) -> Array:
    return np.asarray(np.sin(2 * np.pi * rate * time))
