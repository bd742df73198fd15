"""The stride that a walking body is in, whoever moved it, for the procedural body to go on with.

It is taken up as a heel comes down: the foot in front lands, the heel of the one behind has risen and lifts next.
What is left between the two bodies then, in pose and in speed, dies away.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.backend_protocol import History
from motion_backend.motion import FPS, Motion
from motion_backend.procedural.walk.foot_trajectory import TIP_UP, Swing
from motion_backend.procedural.walk.footsteps import footstep_table
from motion_backend.procedural.walk.stride import BEATS, Step, Stride
from motion_backend.procedural.walk.walk_styles import Walk
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

HALF_LIFE: Final = 0.09
"""Seconds in which what is left between two bodies is half gone: nothing of it is seen after 0.3 s."""
ARMS_HALF_LIFE: Final = 0.2
"""The same of arms, where those of two bodies may be half a metre apart: in less they are flung."""
LONGER: Final = (1.0, 1.5, 2.25, 3.4)
"""Times as long as that where a joint would be flung."""
FLUNG: Final = 0.8
"""Metres a second from frame to frame by which a joint may change its speed at a seam: half of what jumps."""
ONSET: Final = 3
"""Frames in which what dies away does so fastest."""
STEP_ON: Final = 1.5
"""Steps from where a body is, as a foot of it comes down, to where the other one will."""
LONGEST: Final = 0.52
"""Metres of a step by which that is reckoned at most: a body that is about to slow down would sink between its feet."""
WIDEST: Final = 0.09
"""Metres that a foot lands beside the way at most."""
_SIDES: Final = ("left", "right")
_ARMS: Final = [INDEX[f"{side}_{joint}"] for side in _SIDES for joint in ("shoulder", "elbow", "wrist")]


def strides_landing(positions: Array) -> NDArray[np.int64]:
    """Frames in which a heel comes down: the feet are farthest apart along the way. (T, 22, 3) to (N,)."""
    if len(positions) < 3:
        return np.zeros(0, dtype=np.int64)
    ahead = _ahead(positions[:, 0])
    apart = np.einsum("tc,tc->t", (_ankle(positions, "left") - _ankle(positions, "right"))[:, [0, 2]], ahead)
    wide = np.abs(apart)
    middle = wide[1:-1]
    return 1 + np.flatnonzero((middle >= wide[:-2]) & (middle > wide[2:]) & (middle > 0.5 * wide.max()))


def stride_of(history: History, skeleton: Skeleton, style: Walk, rest: Array) -> Stride:
    """The stride of a body whose foot has just come down, which goes on by `rest` (N, 2)."""
    positions = skeleton.forward_kinematics(history.root_positions, history.local_rotations)[0].astype(np.float64)
    ankles, yaw = _flat_feet(positions[-1], skeleton)
    velocity = (positions[-1, 0] - positions[0, 0])[[0, 2]] * FPS / max(len(positions) - 1, 1)
    ahead = rotations.normalize(velocity)
    left_ahead = float((ankles[0] - ankles[1])[[0, 2]] @ ahead) > 0
    front, behind = (0, 1) if left_ahead else (1, 0)
    gap = float((ankles[front] - ankles[behind])[[0, 2]] @ ahead)
    forward = 2 * gap * np.array([ahead[0], 0.0, ahead[1]])
    half, heading = style.double / 2, float(np.arctan2(*ahead))
    # Feet turn the shorter way round: all yaws are told within half a turn of where the body goes.
    yaw = heading + np.asarray(rotations.wrap(yaw - heading))
    now = BEATS - half  # the foot of the step before this beat's first comes down
    landing = _step(BEATS - 1, front, (ankles[front] - forward, ankles[front]), yaw[front], style, skeleton)
    onto, leads = _landing(np.concatenate([positions[-1:, 0, [0, 2]], rest]), ankles, behind, gap)
    leads = heading + float(rotations.wrap(leads - heading))
    lifting = _step(BEATS, behind, (ankles[behind], onto), yaw[behind], style, skeleton)
    lifting = replace(lifting, swing=replace(lifting.swing, end_yaw=leads))
    before = np.stack([ankles[0], ankles[1]])
    before[front] = landing.swing.start
    place = positions[-1, 0, [0, 2]]
    return Stride(
        phase=now,
        begun=BEATS,
        first=1 if behind == 0 else -1,
        speed=float(np.linalg.norm(velocity)),
        step_m=gap,
        place=place,
        heading=heading,
        moving=1.0,
        ankles=before,
        yaw=yaw,
        steps=(landing, lifting),
        tiptoe=np.zeros(2),
        spread=np.zeros(2),
        arms_onward=None,
        shift=np.zeros((0, 3)),
        rest=np.concatenate([place[None], rest]),
        borrowed=True,
    )


def _landing(way: Array, ankles: Array, index: int, gap: float) -> tuple[Array, float]:
    """Where a foot that lifts will come down beside a way (N, 2), (3,), and the yaw of the way there.

    The body is between its feet now, and half a step behind the foot when that lands: a step and a half on from here.
    """
    step = min(gap, LONGEST)
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1))])
    place, before = (
        np.array([np.interp(at, arc, way[:, axis]) for axis in (0, 1)])
        for at in (STEP_ON * step, (STEP_ON - 0.5) * step)
    )
    along = rotations.normalize(place - before)
    if not along.any():
        along = rotations.normalize(way[-1] - way[0])
    left = np.array([along[1], -along[0]])
    apart = abs(float((ankles[0] - ankles[1])[[0, 2]] @ left)) / 2
    place = place + left * (1 if index == 0 else -1) * min(apart, WIDEST)
    return np.array([place[0], ankles[index, 1], place[1]]), float(np.arctan2(*along))


def _step(number: int, index: int, way: tuple[Array, Array], yaw: float, style: Walk, skeleton: Skeleton) -> Step:
    """A foot's full step from place to place."""
    shape, half, (start, end) = footstep_table().swing, style.double / 2, way
    size = min(float(np.linalg.norm(end - start)) / (shape.full_stride_m * skeleton.scale), 1.0)
    swing = Swing(
        start,
        end,
        yaw,
        yaw,
        1 if index == 0 else -1,
        (number + half, number + 1 - half),
        clearance=style.clearance,
        heel_off=float(np.radians(shape.heel_off_deg) * style.roll * size**shape.heel_off_power),
        heel_strike=float(TIP_UP * style.strike * size),
        scale=skeleton.scale,
    )
    return Step(number, index, swing)


def _flat_feet(positions: Array, skeleton: Skeleton) -> tuple[Array, Array]:
    """Where the ankles of both feet are, (2, 3), and where they point, (2,), if they stood flat on their balls."""
    found, yaws = [], []
    for side in _SIDES:
        ankle, ball = INDEX[f"{side}_ankle"], INDEX[f"{side}_foot"]
        toe = positions[ball] - positions[ankle]
        yaw = float(np.arctan2(toe[0], toe[2]))
        flat = positions[ball] - rotations.rotate(rotations.yaw_to_quat(yaw), skeleton.offsets[ball])
        found.append([flat[0], skeleton.ankle_height, flat[2]])
        yaws.append(yaw)
    return np.array(found), np.array(yaws)


def _ankle(positions: Array, side: str) -> Array:
    return np.asarray(positions[:, INDEX[f"{side}_ankle"]])


def _ahead(pelvis: Array) -> Array:
    """Unit vectors of where a pelvis (T, 3) goes over the floor. (T, 2)."""
    from scipy.ndimage import gaussian_filter1d

    steps = gaussian_filter1d(np.gradient(pelvis[:, [0, 2]], axis=0), FPS / 5, axis=0, mode="nearest")
    return rotations.normalize(steps)


def joined(history: History, motion: Motion, half_life: float = HALF_LIFE, of_arms: float | None = None) -> Motion:
    """A motion that begins as the frames before it ended, in place and in speed; what it is off dies away.

    In `half_life` seconds half of it is gone; of arms, which hang free and may be off by much, in `of_arms`. Where a
    joint would be flung at that, it takes longer.
    """
    for longer in LONGER:
        found = joined_within(history, motion, longer * half_life, longer * (half_life if of_arms is None else of_arms))
        if _flung(history, found) <= FLUNG:
            break
    return found


def _flung(history: History, motion: Motion) -> float:
    """By how many metres a second the fastest joint changes its speed from frame to frame as a motion begins."""
    roots = np.concatenate([history.root_positions[-2:], motion.root_positions[:ONSET]])
    local = np.concatenate([history.local_rotations[-2:], motion.local_rotations[:ONSET]])
    places = motion.skeleton.forward_kinematics(roots, local)[0].astype(np.float64)
    return float(np.linalg.norm(np.diff(places, 2, axis=0), axis=-1).max(initial=0.0)) * FPS


def joined_within(history: History, motion: Motion, half_life: float, of_arms: float) -> Motion:
    """The same in just these times, which a foot that has to land has no more of."""
    roots, local = history.root_positions[-2:], history.local_rotations[-2:]
    to, turned = motion.root_positions[:2].astype(np.float64), motion.local_rotations[:2].astype(np.float64)
    if len(roots) < 2 or len(to) < 2:
        return motion
    seconds = np.arange(1, len(motion) + 1)[:, None] / FPS
    pace = to[1] - to[0]
    off, drift = roots[1] - (to[0] - pace), FPS * (roots[1] - roots[0] - pace)
    root = motion.root_positions + _dying_away(off, drift, half_life, seconds)
    spin = rotations.quat_to_rotvec(rotations.compose(turned[1], rotations.inverse(turned[0])))
    before = rotations.compose(rotations.rotvec_to_quat(-spin), turned[0])
    apart = rotations.quat_to_rotvec(rotations.compose(local[1], rotations.inverse(before)))
    spun = rotations.quat_to_rotvec(rotations.compose(local[1], rotations.inverse(local[0])))
    lives = np.full((len(apart), 1), half_life)
    lives[_ARMS] = of_arms
    turns = _dying_away(apart, FPS * (spun - spin), lives, seconds[..., None])
    eased = rotations.compose(rotations.rotvec_to_quat(turns), motion.local_rotations.astype(np.float64))
    return replace(
        motion,
        root_positions=root.astype(np.float32),
        local_rotations=rotations.continuous(eased).astype(np.float32),
    )


def _dying_away(off: Array, drift: Array, half_life: Array | float, seconds: Array) -> Array:
    """What is off, and drifts, taken away by a critically damped spring."""
    damping = 2 * np.log(2) / half_life
    return np.asarray(np.exp(-damping * seconds) * (off + seconds * (drift + damping * off)))
