"""How high the pelvis of a walking body is: what its legs allow, and the bounce of its steps.

The numbers are in data/gait/pelvis_height.toml.
"""

from __future__ import annotations

import numpy as np

from motion_backend import rotations
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.walk.footsteps import Steps
from motion_backend.procedural.walk.root_path import Route
from motion_backend.procedural.walk.walk_styles import Walk
from motion_backend.rotations import Array
from motion_backend.skeleton import INDEX, Skeleton
from scene_graphs.data_tables import read_table, table

LOWEST_OF, SMOOTHED, SMOOTHED_OVER = 5, 1.0, 2
"""Frames of which the lowest pelvis counts, the width of the bell it is smoothed by then, and how far that reaches."""


@table
class Landing:
    """Just after a foot comes down (shares of a step)."""

    at_phase: float
    wide_share: float


@table
class Height:
    """Of the pelvis."""

    standing_share: float
    """Of the standing height."""
    standing_lower_m: float
    standing_crouch_share: float
    walking_share: float
    walking_lower_m: float
    usual_lower_m: float
    """Long steps need bent knees: so much lower at"""
    usual_mps: float
    fast_lower_m_per_mps: float
    fast_from_mps: float
    fast_within_mps: float
    moving_ratio: float
    """How soon it is under way."""
    first_steps: float
    last_steps: float
    """The bounce fades, and legs straighten, over the last of this many steps."""
    tiptoe_m: float
    """From the ankle to the ball of the foot, and a little more, that tiptoes lift."""
    leg_share: float
    """Of its length, that a leg is stretched to."""
    leg_min_m2: float
    """Square of the least height of a pelvis over its ankle."""
    in_air_m: float
    """Feet in the air hold the body down no lower than this."""


@table
class Bounce:
    """Up and down with the steps."""

    usual_mps: float
    min_ratio: float
    max_ratio: float
    at_phase: float
    """Phase at which a walking body is lowest."""
    run_lower_ratio: float
    """How much of a runner's bounce is downwards."""
    seen_from_m: float
    """From here on a walk is seen to bounce,"""
    seen_within_m: float
    """wholly so from so much more,"""
    seen_min_ratio: float
    """and does so however slow it is."""
    grows_steps: float
    skip_m: float
    skip_at_phase: float
    skip_lower_ratio: float
    skip_share: float


@table
class PelvisTable:
    """data/gait/pelvis_height.toml: metres at 1.70 m."""

    height: Height
    bounce: Bounce
    landing: Landing


def pelvis_table() -> PelvisTable:
    """How high a walking body is carried."""
    rows: PelvisTable = read_table("motion_backend", "gait/pelvis_height.toml", PelvisTable)
    return rows


def lifted(pose: Pose, route: Route, steps: Steps, style: Walk, skeleton: Skeleton, in_stride: bool) -> Array:
    """Pelvis positions with the height that the bounce asks for and the legs allow. (T, 3)."""
    from scipy.ndimage import gaussian_filter1d, minimum_filter1d

    row, pelvis = pelvis_table().height, pose.pelvis.copy()
    carried, ending = _carried(route, steps, style, skeleton, in_stride)
    # Who goes on from another walk comes to bounce more than one is seen to over the first steps.
    grown = smooth((steps.phase - steps.phase[0]) / pelvis_table().bounce.grows_steps) if in_stride else 1.0
    wanted = carried + skeleton.scale * ending * _bounce(route, steps, style, grown)
    leg = -float(skeleton.offsets[INDEX["left_knee"], 1] + skeleton.offsets[INDEX["left_ankle"], 1]) * row.leg_share
    limits = []
    for index, name in enumerate(("left", "right")):
        hip = rotations.rotate(pose.hips, skeleton.offsets[INDEX[f"{name}_hip"]])
        gap = np.hypot(*(pelvis + hip - pose.ankles[:, index])[:, [0, 2]].T)
        top = pose.ankles[:, index, 1] + np.sqrt(np.maximum(leg**2 - gap**2, row.leg_min_m2)) - hip[:, 1]
        # Feet in the air do not hold the body down.
        limits.append(np.where(pose.planted[:, index] > 0, top, np.maximum(top, carried - row.in_air_m)))
    # The least of a few frames, then smoothed over no more than these: never above what the legs allow, and no corner.
    # Of who runs or bounces only what the legs take off: the least of a few frames of a bounce is flat below and leaves
    # nothing of a flight.
    flies = (1.0 if style.double < 0 else _bounces(style)) * wanted
    low = minimum_filter1d(np.minimum(wanted, np.minimum(*limits)) - flies, LOWEST_OF, mode="nearest")
    pelvis[:, 1] = flies + gaussian_filter1d(low, SMOOTHED, radius=SMOOTHED_OVER, mode="nearest")
    return pelvis


def _carried(route: Route, steps: Steps, style: Walk, skeleton: Skeleton, in_stride: bool) -> tuple[Array, Array]:
    """The height of the pelvis without its bounce, and a share that ends with the last step. (T,) each."""
    row = pelvis_table().height
    lower_standing = row.standing_lower_m + row.standing_crouch_share * style.crouch
    at_rest = skeleton.standing_height * row.standing_share - lower_standing * skeleton.scale
    # Long steps need bent knees, or the body would fall into each of them.
    usual = row.usual_lower_m * np.clip(route.speed / row.usual_mps, 0.0, 1.0)
    fast = row.fast_lower_m_per_mps * np.clip(route.speed - row.fast_from_mps, 0.0, row.fast_within_mps)
    lower = row.walking_lower_m + (usual + fast) * (style.double > 0)
    walking = skeleton.standing_height * row.walking_share - (style.crouch + lower) * skeleton.scale
    # The last step ends upright: legs straighten as the feet come together.
    left = steps.phase[-1] - steps.phase
    ending = smooth(left / row.last_steps)
    starting = 1.0 if in_stride else smooth((steps.phase - steps.phase[0]) / row.first_steps)
    carried = at_rest + np.clip(row.moving_ratio * steps.moving, 0.0, 1.0) * ending * starting * (walking - at_rest)
    return carried + row.tiptoe_m * skeleton.scale * np.sin(steps.tiptoe.min(axis=1)), ending


def _bounces(style: Walk) -> float:
    """How much a walk is one that bounces."""
    row = pelvis_table().bounce
    return float(smooth((style.bounce - row.seen_from_m) / row.seen_within_m))


def _bounce(route: Route, steps: Steps, style: Walk, grown: Array | float) -> Array:
    """Up and down with the steps: highest over the standing leg, in running and skipping in the air. (T,)."""
    row = pelvis_table().bounce
    slowest = row.min_ratio + _bounces(style) * (row.seen_min_ratio - row.min_ratio)
    quick = np.clip(route.speed / row.usual_mps, slowest if style.double > 0 else row.min_ratio, row.max_ratio)
    if style.double > 0:
        beat = -steps.wave(row.at_phase)
        size = style.bounce - (1 - grown) * max(style.bounce - row.seen_from_m, 0.0)
        walked = size * quick * beat - style.stamp * landing(steps)
    else:
        walked = style.bounce * np.minimum(quick, 1.0) * (np.cos(2 * np.pi * steps.phase) - row.run_lower_ratio)
    skipped = row.skip_m * (steps.wave(row.skip_at_phase) - row.skip_lower_ratio) * row.skip_share
    return np.asarray(steps.moving * (walked + steps.hopping * (skipped - walked)))


def landing(steps: Steps) -> Array:
    """1 just after each foot comes down, 0 otherwise. (T,)."""
    row = pelvis_table().landing
    since = (steps.phase - row.at_phase + 0.5) % 1.0 - 0.5
    return np.asarray(np.exp(-((since / row.wide_share) ** 2)) * steps.moving)
