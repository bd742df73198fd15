"""Who stands for a while stands on one leg and then on the other, and now and then sets the free foot anew.

The numbers are in data/contrapposto.toml.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from motion_backend import rotations
from motion_backend.motion import FPS
from motion_backend.procedural.pose import Pose, smooth
from motion_backend.procedural.walk.foot_trajectory import Feet, Swing
from motion_backend.procedural.walk.footsteps import yaw_of
from motion_backend.rotations import Array
from motion_backend.skeleton import Skeleton
from scene_graphs.data_tables import read_table, table

LEAST_RESTLESS: Final = 0.5
"""The calmest shift their weight no less often than this."""


@table
class FreeStep:
    """A step on the spot, of the foot that does not carry."""

    share: float
    late_s: float
    take_s: float
    air_share: float
    ahead_m: float
    outwards_m: float
    turn_rad: float
    clearance_m: float
    heel_off_rad: float


@table
class Contrapposto:
    """data/contrapposto.toml: metres at 1.70 m."""

    first_max_s: float
    last_s: float
    wait_min_s: float
    wait_max_s: float
    take_s: float
    aside_m: float
    uneven_share: float
    lower_m: float
    tip_rad: float
    shoulders_ratio: float
    step: FreeStep


class _Shift(NamedTuple):
    """The weight goes over a leg."""

    at: float
    """Seconds."""
    aside: float
    """1 wholly over the left leg, -1 over the right one."""


def contrapposto_table() -> Contrapposto:
    """How weight goes from leg to leg."""
    rows: Contrapposto = read_table("motion_backend", "contrapposto.toml", Contrapposto)
    return rows


def contrapposto(
    pose: Pose, skeleton: Skeleton, restless: float, rng: np.random.Generator, *, goes_on: bool, steps: bool
) -> Pose:
    """T frames of a body on both feet with its weight on one leg and then on the other, at first on neither.

    In the end it `goes_on` standing so, else the weight is on both again. It `steps` on the spot where there is room.
    """
    row, scale, time = contrapposto_table(), skeleton.scale, np.arange(len(pose)) / FPS
    shifts = list(_shifts(float(time[-1]), restless, rng))
    aside, before = np.zeros(len(pose)), 0.0
    for shift in shifts:
        aside, before = aside + (shift.aside - before) * smooth((time - shift.at) / row.take_s), shift.aside
    if not goes_on:
        aside = aside * smooth((time[-1] - time) / row.take_s)
    stood = _stepped(pose, shifts if steps else [], time, skeleton, rng)
    yaw, tipped = yaw_of(pose.hips), row.tip_rad * aside
    left = np.stack([np.cos(yaw), np.zeros(len(pose)), -np.sin(yaw)], axis=-1)
    goes = row.aside_m * scale * aside[:, None] * left + (stood.ankles - pose.ankles).mean(axis=1) * [1.0, 0.0, 1.0]
    goes[:, 1] -= row.lower_m * scale * np.abs(aside)
    spine = pose.spine.copy()
    spine[:, 2] -= row.shoulders_ratio * tipped
    hips = rotations.compose(pose.hips, rotations.axis_to_quat("z", tipped))
    return replace(stood, pelvis=pose.pelvis + goes, hips=hips, spine=spine)


def _shifts(seconds: float, restless: float, rng: np.random.Generator) -> Iterator[_Shift]:
    """When the weight goes where, in so many seconds: from the one leg to the other."""
    row, side = contrapposto_table(), float(rng.choice((-1.0, 1.0)))
    at = rng.uniform(0.0, row.first_max_s)
    while at < seconds - row.last_s:
        yield _Shift(at, side * (1.0 + row.uneven_share * rng.uniform(-1.0, 1.0)))
        at += row.take_s + rng.uniform(row.wait_min_s, row.wait_max_s) / max(restless, LEAST_RESTLESS)
        side = -side


def _stepped(pose: Pose, shifts: list[_Shift], time: Array, skeleton: Skeleton, rng: np.random.Generator) -> Pose:
    """The same frames with steps of the foot that is free after some of the shifts."""
    row, scale, home = contrapposto_table().step, skeleton.scale, pose.ankles[0]
    yaws = yaw_of(pose.feet[0])
    feet, heading = Feet.standing(home, yaws, len(pose)), rotations.yaw_to_quat(float(yaw_of(pose.hips[0])))
    place, turned = home.copy(), yaws.copy()
    for at, aside in shifts:
        free, lift = int(aside > 0), (at + row.late_s) / row.take_s
        if rng.random() > row.share or lift + 1.0 > time[-1] / row.take_s:
            continue
        outwards = 1 - 2 * free
        off = [outwards * rng.uniform(0.0, row.outwards_m), 0.0, rng.uniform(-row.ahead_m, row.ahead_m)]
        end = home[free] + scale * rotations.rotate(heading, np.array(off))
        yaw = float(yaws[free] + outwards * rng.uniform(0.0, row.turn_rad))
        swing = Swing(
            start=place[free].copy(),
            end=end,
            start_yaw=float(turned[free]),
            end_yaw=yaw,
            side=outwards,
            window=(lift, lift + row.air_share),
            clearance=row.clearance_m,
            heel_off=row.heel_off_rad,
            heel_strike=0.0,
            scale=scale,
        )
        feet.add(swing, time / row.take_s, free)
        place[free], turned[free] = end, yaw
    if feet.planted.all():
        return pose
    rolled, toes = feet.rolled(np.zeros((len(pose), 2)), skeleton)
    return replace(pose, ankles=feet.ankles, feet=rolled, toes=toes, planted=np.minimum(pose.planted, feet.planted))
