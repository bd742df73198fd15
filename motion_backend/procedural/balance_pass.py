"""The weight shift of a body on its feet: the pelvis moves over what carries, so that nothing would have to fall.

While soles alone carry, the zero-moment point has to be in their hull (Vukobratovic and Borovac 2004). Where a segment
has it elsewhere, its pelvis is shifted level, as little and as smoothly as will do, as the cart on a table of Kajita et
al. (ICRA 2003) would be: e - e''/g of its height moves that point. Feet, and hands that are on things, stay where they
are, since handles hold them in the world; the trunk goes with the pelvis, and legs are bent by inverse kinematics.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motion_backend import rotations
from motion_backend.backend_protocol import History
from motion_backend.body.capsules import SOLE
from motion_backend.body.segment_masses import centres_of_mass
from motion_backend.body.zero_moment import GRAVITY, LEAST_WEIGHT, accelerations, nearest_in_hull
from motion_backend.motion import FPS, Phase, PhaseKind
from motion_backend.procedural.pose import Pose, concatenate, smooth
from motion_backend.procedural.pose_solver import solve
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton

FLOOR: Final = [0, 2]
"""The axes of the floor, x and z."""
FOLLOWS: Final = 0.85
"""Of a level shift of the pelvis the centre of mass does as much: ankles stay, knees go half the way."""
INSIDE: Final = 0.5
"""The zero-moment point is led into so much of each sole, about its middle: who stands on an edge tips at once."""
ROUNDS: Final = 4
"""Where a point is nearest to the soles changes as it is moved: so often it is looked for again."""
STILL, SMOOTH = 0.3, 3e-6
"""What a shift (m²) and the jerk of the shifted pelvis ((m/s³)²) cost against a point (m²) outside."""
JERK: Final = np.array([1.0, -3.0, 3.0, -1.0])
"""The third difference of a lone shift."""
HELD: Final = 1e8
"""What a shift costs where the pelvis rests on something."""
LEFT: Final = 0.01
"""Thighs are off a seat when the pelvis is so much higher than at rest (metres)."""
SEATS: Final = 0.35
"""Who rests lower than so much of the standing height is on the floor, and has hands and knees on it in getting up."""
ON_FLOOR: Final = 0.1
"""A wrist lower than this (metres) is of a hand that bears."""
KNEELS: Final = 0.15
"""A knee lower than this may be knelt on (metres at 1.70 m)."""
BENT: Final = 0.985
"""A bent leg may be stretched to so much of its length, no leg beyond what it was: knees near straight snap."""
SINKS: Final = (4, 2.0)
"""A pelvis sinks for a leg so many frames before and after it has to, in a bell so wide (frames)."""
RISES: Final = 10
"""Within so many frames it has gone over from how low it was before."""


class Before(NamedTuple):
    """The frames before a segment, as they would have been without a shift of weight, and how far that goes in them."""

    centres: Array
    """(K, 3) of mass; K may be 0."""
    pelvis: Array
    """(K, 3)."""
    shift: Array
    """(K, 3) of the pelvis: nothing but in a walk that goes on."""

    @staticmethod
    def of(history: History, shift: Array, skeleton: Skeleton) -> Before:
        """From the frames that were shown, of the last of which it is known how far they were shifted: of none that
        another body made, whose pelvis goes otherwise."""
        if not len(shift):
            return NOTHING
        last = slice(-len(shift), None)
        root, local = history.root_positions[last], history.local_rotations[last]
        positions, world = skeleton.forward_kinematics(root, local)
        shift = shift[-len(root) :]
        centres = centres_of_mass(skeleton, positions.astype(np.float64), world)
        return Before(centres - FOLLOWS * shift, root - shift, shift)


NOTHING: Final = Before(*np.zeros((3, 0, 3)))
"""Of a body that begins to be."""


def balanced(
    pose: Pose, phases: Sequence[Phase], skeleton: Skeleton, before: Before = NOTHING, beyond: Pose | None = None
) -> Pose:
    """A segment of T frames with its zero-moment point in, or nearer to, the soles that are planted.

    It goes on from the shift that it had `before`. The shift dies away towards its end, or where a walk goes on towards
    the end of what that was to be, `beyond` it. Frames in which the pelvis rests on something or a knee on the floor
    stay.
    """
    frames, pose = len(pose), pose if beyond is None else concatenate([pose, beyond])
    free = on_its_feet(pose, phases, skeleton)
    if not (free & pose.planted.any(axis=1)).any() and not before.shift.any():
        return pose.at(slice(0, frames))
    root, local = solve(pose, skeleton)
    positions, world = skeleton.forward_kinematics(root, local)
    knees = positions[:, [INDEX["left_knee"], INDEX["right_knee"]], 1]
    free &= knees.min(axis=1) > KNEELS * skeleton.scale
    centres = centres_of_mass(skeleton, positions.astype(np.float64), world)
    cart = _Cart.of(np.concatenate([before.centres, centres]))
    support = _Support(_soles(pose, skeleton), np.repeat(pose.planted > 0, len(SOLE), axis=1), free)
    moved = pose.pelvis.copy()
    shift = _shift(cart, support, moved[:, FLOOR], before)
    moved[:, FLOOR] += shift
    hips = positions[:, [INDEX["left_hip"], INDEX["right_hip"]]]
    moved[:, 1] -= _sinking(hips - pose.ankles, shift, skeleton, before)
    return replace(pose, pelvis=moved).at(slice(0, frames))


def on_its_feet(pose: Pose, phases: Sequence[Phase], skeleton: Skeleton) -> NDArray[np.bool_]:
    """Frames in which the pelvis rests on nothing, as far as phases, height and palms say. (T,)."""
    free = ~((pose.pressing > 0) & (pose.reaching > 0) & (pose.reach[..., 1] < ON_FLOOR)).any(axis=1)
    height = pose.pelvis[:, 1]
    for phase in phases:
        frames = slice(phase.start, len(pose) if phase is phases[-1] else phase.stop)
        if phase.kind in (PhaseKind.LIEDOWN, PhaseKind.GETUP):
            free[frames] = False
        elif phase.kind in (PhaseKind.SITDOWN, PhaseKind.EDGE):
            free[frames] = _above(height[frames][::-1], skeleton)[::-1]
        elif phase.kind is PhaseKind.STANDUP:
            free[frames] = _above(height[frames], skeleton)
    return free


def _above(height: Array, skeleton: Skeleton) -> NDArray[np.bool_]:
    """Frames from the last one on in which a pelvis, at rest in the first, is no higher than there. (T,)."""
    standing = skeleton.standing_height
    left = height[0] + LEFT if height[0] > SEATS * standing else standing / 2
    rests = height <= left
    return np.asarray(~np.maximum.accumulate(rests[::-1])[::-1])


def _soles(pose: Pose, skeleton: Skeleton) -> Array:
    """What of both soles the zero-moment point is led into. (T, 8, 2) x and z."""
    middle = SOLE.mean(axis=0)
    corners = (middle + INSIDE * (SOLE - middle)) * skeleton.scale
    placed = pose.ankles[:, :, None] + rotations.rotate(pose.feet[:, :, None], corners)
    return np.asarray(placed[..., FLOOR].reshape(len(pose), -1, 2))


class _Cart(NamedTuple):
    """The body as one mass on its way."""

    points: Array
    """Where its zero-moment point is on the floor. (T, 2)."""
    lever: Array
    """How far an acceleration to the side moves it (m per m/s²). (T,)."""

    @staticmethod
    def of(centres: Array) -> _Cart:
        smooth, rate = accelerations(centres, FPS)
        lever = smooth[:, 1] / np.maximum(rate[:, 1] + GRAVITY, LEAST_WEIGHT)
        return _Cart(smooth[:, FLOOR] - lever[:, None] * rate[:, FLOOR], lever)

    def moved(self, shift: Array) -> Array:
        """By how much a shift (T, 2) of the pelvis moves the zero-moment point. (T, 2)."""
        beyond = np.pad(shift, ((1, 1), (0, 0)))
        rate = np.diff(beyond, n=2, axis=0) * FPS**2
        return np.asarray(FOLLOWS * (shift - self.lever[:, None] * rate))


class _Support(NamedTuple):
    """What carries a body."""

    soles: Array
    """Corners to be within. (T, 8, 2)."""
    carries: NDArray[np.bool_]
    """Which of them are of a planted foot. (T, 8)."""
    free: NDArray[np.bool_]
    """Frames in which nothing else carries. (T,)."""


def _shift(cart: _Cart, support: _Support, pelvis: Array, before: Before) -> Array:
    """The least shift of a pelvis on its way (T, 2) that takes the zero-moment point into the soles, and the smoothest
    pelvis; nothing is shifted afterwards. The cart has the frames before it as well. (T, 2)."""
    from scipy.linalg import cho_solve_banded, cholesky_banded

    came, past = len(before.shift), ((len(before.shift), 0), (0, 0))
    free = np.concatenate([np.zeros(came, dtype=bool), support.free])
    judged = np.concatenate([np.zeros(came), support.free & support.carries.any(axis=1)])
    factor = cholesky_banded(_normal_equations(cart.lever, judged, free), lower=True)
    known = _smoother(np.concatenate([before.pelvis[:, FLOOR], pelvis]))
    known[:came] += HELD * before.shift[:, FLOOR]
    shift = np.pad(np.zeros_like(pelvis), past)
    for _ in range(ROUNDS):
        now = cart.points + cart.moved(shift)
        nearest = np.pad(nearest_in_hull(now[came:], support.soles, support.carries), past)
        wanted = np.where(judged[:, None] > 0, nearest - cart.points, 0.0)
        shift = cho_solve_banded((factor, True), _turned_back(cart.lever, judged, wanted) + known)
    return np.asarray(shift[came:])


def _normal_equations(lever: Array, judged: Array, free: NDArray[np.bool_]) -> Array:
    """Of least squares over points, shifts and jerks, as the lower bands of a symmetric matrix. (4, T)."""
    frames = len(lever)
    beside = -lever * FPS**2
    middle = 1 - 2 * beside
    weight = FOLLOWS**2 * judged
    bands = np.zeros((4, frames))
    bands[0] = STILL + HELD * ~free + weight * middle**2
    bands[0, 1:] += (weight * beside**2)[:-1]
    bands[0, :-1] += (weight * beside**2)[1:]
    bands[1, :-1] = (weight * middle * beside)[:-1] + (weight * middle * beside)[1:]
    bands[2, :-2] = (weight * beside**2)[1:-1]
    # Third differences with themselves; beyond both ends nothing is shifted.
    bands += SMOOTH * FPS**6 * np.correlate(JERK, JERK, mode="full")[len(JERK) - 1 :, None]
    return bands


def _smoother(pelvis: Array) -> Array:
    """What the jerk that the pelvis has by itself on its way (T, 2) adds to the right side of the least squares."""
    rate = np.diff(pelvis, n=3, axis=0)
    found = np.zeros_like(pelvis)
    for late, share in enumerate(-JERK):
        found[late : late + len(rate)] -= share * rate
    return np.asarray(SMOOTH * FPS**6 * found)


def _turned_back(lever: Array, judged: Array, wanted: Array) -> Array:
    """The right side of the least squares: what is wanted of points (T, 2), by what each shift does to them."""
    beside = (-lever * FPS**2)[:, None]
    weighed = FOLLOWS * judged[:, None] * wanted
    found = (1 - 2 * beside) * weighed
    found[1:] += (beside * weighed)[:-1]
    found[:-1] += (beside * weighed)[1:]
    return np.asarray(found)


def _sinking(legs: Array, shift: Array, skeleton: Skeleton, before: Before) -> Array:
    """How far the pelvis sinks so that no leg is overstretched, from ankles to hips (T, 2, 3) as they were. (T,)."""
    from scipy.ndimage import gaussian_filter1d, maximum_filter1d

    longest = -BENT * float(skeleton.offsets[INDEX["left_knee"], 1] + skeleton.offsets[INDEX["left_ankle"], 1])
    length = np.maximum(np.linalg.norm(legs, axis=-1), longest)
    level = legs[..., FLOOR] + shift[:, None]
    height = np.sqrt(np.maximum(length**2 - (level**2).sum(axis=-1), 0.0))
    needed = np.maximum(legs[..., 1] - height, 0.0).max(axis=1)
    reach, width = SINKS
    early = maximum_filter1d(needed, 2 * reach + 1, mode="constant")
    sinks = np.asarray(gaussian_filter1d(early, width, mode="constant"))
    if not len(before.shift):
        return sinks
    fade = 1 - smooth(np.arange(1, len(sinks) + 1) / RISES)
    return np.asarray(sinks + fade * (-before.shift[-1, 1] - sinks[0]))
