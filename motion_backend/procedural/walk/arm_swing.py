"""Arms of a walking body: those that hang swing against the legs, others keep the pose they are held in.

The numbers are in data/gait/arm_swing.toml.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import arm_arrays, arm_poses
from motion_backend.procedural.pose import smooth
from motion_backend.procedural.touch.hand_captions import CARRYING
from motion_backend.procedural.walk.footsteps import Steps
from motion_backend.procedural.walk.root_path import Route
from motion_backend.procedural.walk.stride import Stride
from motion_backend.procedural.walk.walk_styles import Walk
from motion_backend.rotations import Array
from motion_backend.skeleton import ARM_LENGTH
from scene_graphs.data_tables import read_table, table

Depth = Callable[[Array], Array]


@table
class ArmSwing:
    """Arms that hang."""

    early_phase: float
    """So much earlier than half-way through the other side's step an arm is farthest forward,"""
    folds_late_phase: float
    """and so much later its elbow is bent most."""
    beat_deg: float
    """How far arms go back and forth with every step besides, and"""
    beat_at_phase: float
    folds_beat_deg: float
    """how far elbows bend with it."""
    folds_beat_at_phase: float
    usual_mps: float
    """Arms swing as far as the style says."""
    min_ratio: float
    max_ratio: float
    swing_max_deg: float
    """But no farther than this."""
    hangs_deg: float
    """How far forward of an upright trunk an arm hangs."""
    free_share: float
    """Of the trunk's bend, that it does not follow."""
    elbow_deg: dict[str, float]
    """How much more than the style's an elbow is bent in each of the arm poses that swing."""
    elbow_in_ratio: float
    """How much further in elbows point that swing, against back."""
    straight_deg: float
    """The elbow of an arm that hangs still."""
    still_share: float
    """Of the style's bend, standing,"""
    moving_share: float
    """and this much more in full stride."""
    folds_ratio: float
    """How much the elbow bends for every radian forward of where the arm is farthest back,"""
    folds_less_deg: tuple[float, float]
    """less and less from one bend of the style's to the other."""
    shoulder_share: float
    """Of the elbow's bend, that the upper arm goes back for,"""
    forearm_share: float
    """and the forearm forward."""
    upper_arms: float
    lower_arms: float
    aside_arms: float
    aside_min_arms: float
    inwards_arms: float
    """How much a hand comes in before the body."""
    stretched_max_arms: float
    held_arms: float
    """How far wrists of arms that are held swing."""


@table
class ArmSpread:
    """Arms that take room wait until the body is under way."""

    takes_room: tuple[str, ...]
    after_s: float
    within_s: float
    down_s: float
    """They come down again over the last of the way,"""
    comes_down_s: float
    """and so long before they would be nearer to something than"""
    room_m: float
    shoulder_m: float
    """from a shoulder so high, at 1.70 m, and"""
    shoulder_aside_m: float
    looked_at_arms: tuple[float, ...]
    """at these shares of the way out to the wrist."""


@table
class ArmDance:
    """Both swing together from side to side before the body."""

    aside_arms: float
    over_arms: float
    up_arms: float
    up_outwards_arms: float
    ahead_arms: float
    back_sideways_arms: float


@table
class ArmTable:
    """data/gait/arm_swing.toml: arm lengths."""

    swing: ArmSwing
    spread: ArmSpread
    dance: ArmDance


def arm_table() -> ArmTable:
    """The numbers of walking arms."""
    rows: ArmTable = read_table("motion_backend", "gait/arm_swing.toml", ArmTable)
    return rows


def swing_arms(style: Walk, steps: Steps, speed: Array, spread: Array, wander: Array) -> tuple[Array, Array]:
    """Wrists and elbow directions of T frames walked at `speed` (T,), `spread` (T, 2) into poses. (T, 2, 3) each.

    `wander` (T, 2, 2) is how far each arm is off its swing, forwards and aside (radians).
    """
    row, frames = arm_table().swing, len(steps.phase)
    fixed, poles = arm_arrays(*style.bearing.arms)
    wrists, elbows = np.repeat(fixed[None], frames, axis=0), np.repeat(poles[None], frames, axis=0)
    # An arm is farthest forward as the heel of the other side comes down, before that foot is flat.
    for index, side in ((0, 1), (1, -1)):
        early = row.early_phase - style.character.of_side("lag", "phase", side)
        cycle, folded = (
            side * steps.first * np.cos(np.pi * (steps.phase + early - late)) * steps.moving
            for late in (0.0, row.folds_late_phase)
        )
        if style.bearing.arms[index] in row.elbow_deg:
            wrists[:, index] = _hanging(style, index, (cycle, folded, wander[:, index]), steps, speed)
            elbows[:, index, 0] -= side * row.elbow_in_ratio * steps.moving
        else:
            wrists[:, index] = _held(index, wrists[:, index], spread[:, index])
            wrists[:, index, 2] += row.held_arms * cycle
        if style.across:
            wrists[:, index] = _across(style, side, steps, wrists[:, index])
    return wrists, elbows


def _hanging(style: Walk, index: int, swung: tuple[Array, Array, Array], steps: Steps, speed: Array) -> Array:
    """A wrist that swings: shoulder and elbow turn forward together, and further forward than back. (T, 3).

    `swung` is the beat of its swing and of its elbow's (T,) each, and how far the arm is off (T, 2).
    """
    row, side, (beat, folded, off), own = arm_table().swing, 1 if index == 0 else -1, swung, style.character
    bent = max(style.elbow + row.elbow_deg[style.bearing.arms[index]] + own.of_side("elbow", "deg", side), 0.0)
    pace, moving = np.clip(speed / row.usual_mps, row.min_ratio, row.max_ratio), steps.moving
    reach = np.minimum(
        np.radians(style.swing) * pace * own.of_side("swing", "ratio", side), np.radians(row.swing_max_deg)
    )
    # Arms hang down from a bent trunk.
    hangs = row.hangs_deg + row.free_share * style.bearing.lean + own.of_side("hang", "deg", side)
    with_step = np.radians(row.beat_deg) * steps.wave(row.beat_at_phase)
    swing = reach * beat + np.radians(hangs) + (pace * with_step + off[:, 0]) * moving
    more = (bent - row.straight_deg) * (row.still_share + row.moving_share * moving)
    folding = row.folds_ratio * own.folds_ratio * float(np.interp(bent, row.folds_less_deg, (1.0, 0.0)))
    folds = folding * (reach * (folded + moving) + np.radians(hangs))
    bend = np.radians(row.straight_deg + more) + folds
    bend = bend + np.radians(row.folds_beat_deg) * pace * moving * steps.wave(row.folds_beat_at_phase)
    shoulder, fore = swing - row.shoulder_share * bend, swing + row.forearm_share * bend
    aside = row.aside_arms + style.splay + own.of_side("splay", "arms", side) * moving
    aside = np.maximum(aside, row.aside_min_arms) + np.abs(off[:, 1]) * moving
    inwards = row.inwards_arms + own.of_side("inwards", "arms", side)
    wrist = np.stack(
        [
            side * (aside - inwards * np.sin(swing)),
            -row.upper_arms * np.cos(shoulder) - row.lower_arms * np.cos(fore),
            row.upper_arms * np.sin(shoulder) + row.lower_arms * np.sin(fore),
        ],
        axis=1,
    )
    return np.asarray(wrist * np.minimum(1, row.stretched_max_arms / np.linalg.norm(wrist, axis=1))[:, None])


def _held(index: int, wrist: Array, spread: Array) -> Array:
    """A wrist on its way from hanging into the pose it is held in, and back where something is begun. (T, 3)."""
    hang = np.asarray(arm_poses()["hang"].wrist_arm_lengths) * [1 if index == 0 else -1, 1, 1]
    between = hang + spread[:, None] * (wrist - hang)
    length = np.linalg.norm(hang) + spread * (np.linalg.norm(wrist, axis=1) - np.linalg.norm(hang))
    return np.asarray(rotations.normalize(between) * length[:, None])


def arm_spread(route: Route, style: Walk, scale: float, depth: Depth, stride: Stride | None = None) -> Array:
    """Share of its pose that each arm is in: open arms wait until the body is under way and come down where they would
    be in something, and all but those that carry something come down where something is begun. (T, 2).

    `depth` says how deep points (N, 3) are in what is solid.
    """
    frames = len(route.heading)
    row, at = arm_table().spread, np.arange(frames) / FPS
    spread = np.ones((frames, 2))
    for index, arms in enumerate(style.bearing.arms):
        takes_room = arms in row.takes_room
        if takes_room:
            begin = 0.0 if stride is None else float(stride.spread[index])
            spread[:, index] = begin + (1 - begin) * smooth((at - row.after_s * (stride is None)) / row.within_s)
            lacks = 1 - _free(route, index, arms, scale, depth)
            spread[:, index] *= 1 - lacks * (1.0 if stride is None else smooth(at / row.comes_down_s))
        if takes_room or (style.release and arms not in CARRYING):
            spread[:, index] *= smooth((at[-1] - at) / row.down_s)
    return spread


def _free(route: Route, index: int, arms: str, scale: float, depth: Depth) -> Array:
    """1 where a hand held out in an arm pose keeps off what is solid, 0 where it would not, in time. (T,)."""
    from scipy.ndimage import gaussian_filter1d, minimum_filter1d

    row, side = arm_table().spread, 1.0 if index == 0 else -1.0
    wrist = np.asarray(arm_poses()[arms].wrist_arm_lengths) * [side, 1.0, 1.0]
    out = np.array([side * row.shoulder_aside_m, row.shoulder_m, 0.0]) + ARM_LENGTH * np.outer(
        row.looked_at_arms, wrist
    )
    turned = rotations.rotate(rotations.yaw_to_quat(route.heading)[:, None], scale * out)
    turned[..., [0, 2]] += route.position[:, None]
    deep = depth(turned.reshape(-1, 3)).reshape(len(turned), -1).max(axis=1)
    early = round(row.comes_down_s * FPS)
    free = minimum_filter1d((deep < -row.room_m).astype(np.float64), 2 * early + 1, mode="nearest")
    return np.asarray(gaussian_filter1d(free, early / 2, mode="nearest"))


def _across(style: Walk, side: int, steps: Steps, wrist: Array) -> Array:
    """Arms that swing together from side to side before the body, as in a dance. (T, 3)."""
    row = arm_table().dance
    over = steps.first * np.sin(np.pi * steps.phase) * steps.moving
    outward = side * over
    aside, up = (
        side * row.aside_arms + row.over_arms * over,
        row.up_arms + row.up_outwards_arms * (0.5 + 0.5 * outward) ** 2,
    )
    danced = np.stack([aside, up, row.ahead_arms - row.back_sideways_arms * over**2], axis=1)
    return np.asarray(wrist + (style.across * steps.moving)[:, None] * (danced - wrist))
