"""Arms of a walking body: those that hang swing against the legs, others keep the pose they are held in."""

from __future__ import annotations

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.emotion_style import arm_arrays, arm_poses
from motion_backend.procedural.pose import smooth
from motion_backend.procedural.walk.footsteps import Steps
from motion_backend.procedural.walk.walk_styles import Walk
from motion_backend.rotations import Array

UPPER, LOWER = 0.541, 0.459
"""Upper arm and forearm in arm lengths."""
USUAL = 1.25
"""Speed at which arms swing as far as the style says (metres a second)."""
FOLDS = 0.6
"""How much the elbow bends for every radian that the arm is forward of where it is farthest back."""
HANGS, FREE = 6.0, 0.6
"""How far forward of an upright trunk an arm hangs (degrees), and the share of the trunk's bend it does not follow."""
TAPS = 1.6
"""Taps on the chest a second, of each hand."""
SWINGING = ("hang", "bent", "fists")


def swing_arms(style: Walk, steps: Steps, speed: Array) -> tuple[Array, Array]:
    """Wrists and elbow directions of T frames walked at `speed` (T,). (T, 2, 3) each."""
    frames = len(steps.phase)
    fixed, poles = arm_arrays(*style.bearing.arms)
    wrists, elbows = np.repeat(fixed[None], frames, axis=0), np.repeat(poles[None], frames, axis=0)
    # An arm is farthest forward as the heel of the other side comes down, before that foot is flat.
    cycle = steps.first * np.cos(np.pi * (steps.phase + 0.05)) * steps.moving
    for index, side in ((0, 1), (1, -1)):
        if style.bearing.arms[index] in SWINGING:
            wrists[:, index] = _hanging(style, index, side * cycle, steps.moving, speed)
        else:
            wrists[:, index] = _held(style, index, wrists[:, index], frames)
            wrists[:, index, 2] += 0.015 * side * cycle
        if style.across:
            wrists[:, index] = _across(style, side, steps, wrists[:, index])
        if style.tap:
            wrists[:, index] += _tapping(side, frames)
    return wrists, elbows


def _hanging(style: Walk, index: int, beat: Array, moving: Array, speed: Array) -> Array:
    """A wrist that swings: shoulder and elbow turn forward together, and further forward than back. (T, 3)."""
    side = 1 if index == 0 else -1
    bent = style.elbow + {"bent": 25, "fists": 4}.get(style.bearing.arms[index], 0)
    reach = np.radians(style.swing) * np.clip(speed / USUAL, 0.35, 1.3)
    # Arms hang down from a bent trunk.
    swing = reach * beat + np.radians(HANGS + FREE * style.bearing.lean)
    bend = np.radians(8 + (bent - 8) * (0.35 + 0.65 * moving)) + FOLDS * (swing + reach * moving)
    shoulder, fore = swing - 0.25 * bend, swing + 0.75 * bend
    wrist = np.stack(
        [
            side * (0.15 - 0.10 * np.maximum(np.sin(swing), 0) + style.splay),
            -UPPER * np.cos(shoulder) - LOWER * np.cos(fore),
            UPPER * np.sin(shoulder) + LOWER * np.sin(fore),
        ],
        axis=1,
    )
    return np.asarray(wrist * np.minimum(1, 0.985 / np.linalg.norm(wrist, axis=1))[:, None])


def _held(style: Walk, index: int, wrist: Array, frames: int) -> Array:
    """A wrist on its way from hanging into the pose it is held in, and back where something is begun. (T, 3)."""
    spread = _spread(frames, style.bearing.arms[index], style.release)
    hang = np.asarray(arm_poses()["hang"].wrist_arm_lengths) * [1 if index == 0 else -1, 1, 1]
    between = hang + spread[:, None] * (wrist - hang)
    length = np.linalg.norm(hang) + spread * (np.linalg.norm(wrist, axis=1) - np.linalg.norm(hang))
    return np.asarray(rotations.normalize(between) * length[:, None])


def _spread(frames: int, arms: str, release: bool) -> Array:
    """Share of an arm pose: open arms wait until the body is under way, and all but those that carry something
    come down where something is begun."""
    at = np.arange(frames) / FPS
    takes_room = arms in ("open", "balance")
    begun = smooth((at - 0.25) / 0.8) if takes_room else np.ones(frames)
    comes_down = takes_room or (release and arms != "carry")
    return begun * smooth((at[-1] - at) / 0.7) if comes_down else begun


def _across(style: Walk, side: int, steps: Steps, wrist: Array) -> Array:
    """Arms that swing together from side to side before the body, as in a dance. (T, 3)."""
    over = steps.first * np.sin(np.pi * steps.phase) * steps.moving
    outward = side * over
    danced = np.stack(
        [side * 0.28 + 0.36 * over, -0.52 + 0.24 * np.maximum(outward, 0), 0.44 - 0.16 * np.abs(over)], axis=1
    )
    return np.asarray(wrist + (style.across * steps.moving)[:, None] * (danced - wrist))


def _tapping(side: int, frames: int) -> Array:
    """Hands leave the chest in turn and come back to it. (T, 3)."""
    beating = np.maximum(np.sin(2 * np.pi * TAPS * np.arange(frames) / FPS + (0 if side > 0 else np.pi)), 0)
    away = np.tile([0.14 * side, 0.06 * side, 0.02], (frames, 1))
    away[:, 2] += 0.16 * beating
    return away
