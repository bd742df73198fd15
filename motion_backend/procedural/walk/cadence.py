"""Cadence: the phase of a walk, which grows by one with every step, from its speed and turning.

The numbers are in data/gait/cadence.toml.
"""

from __future__ import annotations

import numpy as np

from motion_backend.procedural.pose import smooth
from motion_backend.procedural.walk.footsteps import LEAD, SIDEWAYS, drift, footstep_table
from motion_backend.procedural.walk.root_path import Route
from motion_backend.procedural.walk.stride import BEATS, Stride
from motion_backend.procedural.walk.walk_styles import Walk
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton
from scene_graphs.data_tables import read_table, table


@table
class Cadence:
    """data/gait/cadence.toml: metres at 1.70 m."""

    speed_min_mps: float
    usual_mps_per_hz2: float
    """Usual speed over the square of the steps a second,"""
    size_power: float
    """which grows so with the body's size."""
    uneven_share: float
    uneven_hz: float
    step_max_m: float
    """Of a usual stride."""
    any_step_max_m: float
    side_step_max_ratio: float
    """Of the width."""
    turn_rad: float
    """A turn takes a step every so far,"""
    turn_max_hz: float
    """but no quicker than this."""
    min_hz: float
    spot_hz: float
    """Who turns on the spot steps round at this,"""
    spot_m: float
    """and goes no farther than this."""
    run_hz: float
    """Who runs does so at this whatever the speed, of a usual stride: fast is whose steps are long."""
    skip_max_hz: float
    start_m: float
    """So far the first steps are short,"""
    start_within_m: float
    """and less so up to here."""
    start_step_m: float
    start_max_hz: float
    taken_up_steps: float
    """Who goes on from another walk comes to the steps of this one over so many."""
    hurry_ratios: tuple[float, ...]
    """And so much quicker at first, the least that leaves no foot farther behind than"""
    left_behind_m: float
    hurries_after_s: float
    standing_steps: float
    """What is left for standing still after the last step."""
    end_hz: float


def cadence() -> Cadence:
    """When steps are made."""
    rows: Cadence = read_table("motion_backend", "gait/cadence.toml", Cadence)
    return rows


def plan_phase(
    route: Route,
    style: Walk,
    skeleton: Skeleton,
    fps: int,
    rng: np.random.Generator,
    stride: Stride | None = None,
    hurry: float = 1.0,
) -> tuple[Route, Array]:
    """Cadence from speed and turning, then enough standing frames for both feet to come home.

    The first frame of a body in its stride is the one it has already made; its next steps `hurry` so many times.
    """
    row, scale = cadence(), skeleton.scale
    turning = np.abs(np.gradient(route.heading)) * fps
    usual = np.sqrt(np.maximum(route.speed, row.speed_min_mps) / (row.usual_mps_per_hz2 * scale**row.size_power))
    usual = usual / style.stride
    usual = usual * (1 + (row.uneven_share + style.uneven) * drift(len(usual), row.uneven_hz, fps, rng))
    longest = route.speed / (min(row.step_max_m * style.stride, row.any_step_max_m) * scale)
    if style.aside == SIDEWAYS:
        # Feet that are brought together and apart again must not cross.
        longest = route.speed / (row.side_step_max_ratio * style.width * scale)
    # A turn takes a step every third of a half turn or so, a spin fewer: nobody trips along at five steps a second.
    turned = np.minimum(turning / row.turn_rad, row.turn_max_hz)
    on_the_spot = (
        float(route.speed.sum()) / fps < row.spot_m * scale and float(np.ptp(route.heading)) > row.turn_rad / 2
    )
    least = row.spot_hz if on_the_spot else row.min_hz
    rate = np.maximum.reduce([usual, turned * (not on_the_spot), longest, np.full_like(usual, least)])
    if style.double < 0:
        # No leg has to reach as far as a step in flight goes.
        rate = np.maximum(turned, row.run_hz / (style.stride * scale ** (row.size_power / 2)))
    if style.skips:
        rate = np.where(route.speed > footstep_table().beat.skip_from_mps, np.minimum(rate, row.skip_max_hz), rate)
    if stride is None:
        # The first steps are short: the foot that stays behind must not be left too far.
        walked = np.cumsum(route.speed) / fps
        starting = np.clip((row.start_m * scale - walked) / row.start_within_m, 0.0, 1.0)
        rate = np.maximum(rate, np.minimum(route.speed / (row.start_step_m * scale), row.start_max_hz) * starting)
        # A third of a step goes by before the first foot lifts: the weight shifts and the heel rises.
        phase, begun = np.cumsum(rate) / fps - LEAD, -1
    else:
        rate = _taken_up(rate, np.maximum(turned, row.min_hz), route.speed, stride, (fps, hurry))
        phase, begun = stride.phase + (np.cumsum(rate) - rate[0]) / fps, stride.begun
    # Both feet step at least once, and a last step in flight comes down before the end.
    total = max(np.ceil(phase[-1] + 0.5), begun + 1.0 + BEATS) + max(0.0, -style.double / 2) + row.standing_steps
    end = row.spot_hz if on_the_spot else row.end_hz
    extra = max(int(np.ceil((total - phase[-1]) / end * fps)), 1)
    tail = phase[-1] + (total - phase[-1]) * np.arange(1, extra + 1) / extra
    longer = Route(
        np.concatenate([route.position, np.repeat(route.position[-1:], extra, axis=0)]),
        np.concatenate([route.heading, np.repeat(route.heading[-1:], extra)]),
        np.concatenate([route.speed, np.zeros(extra)]),
    )
    return longer, np.concatenate([phase, tail])


def _taken_up(rate: Array, slowest: Array, speed: Array, stride: Stride, pace: tuple[int, float]) -> Array:
    """Steps a second (T,) of a walk that goes on from another: their length changes little by little, since feet that
    are on their way come down where the steps before had them to. No rate comes below `slowest` (T,)."""
    row, (fps, hurry) = cadence(), pace
    speed, share = np.maximum(speed, row.speed_min_mps), smooth(np.cumsum(rate) / fps / row.taken_up_steps)
    length = (1 - share) * stride.step_m + share * speed / rate
    hurried = 1 + (hurry - 1) * smooth(np.arange(len(rate)) / fps / row.hurries_after_s) * (1 - share)
    return np.asarray(hurried * np.maximum(speed / length, np.minimum(slowest, rate)))
